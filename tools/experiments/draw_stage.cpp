#include "tools/experiments/draw_stage.h"

#include <unistd.h>

#include <fstream>

#include "render/camera_block.h"
#include "timeline/timeline.h"
#include "tools/output.h"

namespace scenegen::tools {

using render::vkr::PassKind;

DrawStage::DrawStage(const ExperimentContext& context, const Scene& scene, const render::View& view,
                     PassKind pass)
    : device_(context.device),
      view_(view),
      memory_(*device_),
      pipelines_(*device_, context.samples == 4 ? vk::SampleCountFlagBits::e4 : vk::SampleCountFlagBits::e1,
                 false),
      target_(render::make_target(*device_, memory_, pipelines_, pass, {context.width, context.height},
                                  pass == PassKind::color && context.samples == 4
                                      ? vk::SampleCountFlagBits::e4
                                      : vk::SampleCountFlagBits::e1)),
      shadow_(render::make_target(*device_, memory_, pipelines_, PassKind::shadow, {1, 1},
                                  vk::SampleCountFlagBits::e1)),
      ring_(*device_, 1) {
  const render::TextureSets sets = render::texture_sets(scene);
  timeline::Player player(timeline::compile(scene));
  player.seek(static_cast<double>(scene.duration_s));
  scene_.emplace(scene, player, sets.of_material);
  gpu_.emplace(*device_, memory_, pipelines_, scene, sets);
  gpu_->upload_records(scene_->all_records(player));
  gpu_->bind_shadow_map(shadow_.depth);
  // Every descriptor names an image in the layout that it will be read in.
  frame([&](const render::PassContext& c) {
    render::begin_pass(c.frame.commands, pipelines_, shadow_, c.barriers);
    c.frame.commands.endRenderPass();
    c.barriers.image(shadow_.depth, render::vkr::Use::sampled).flush(c.frame.commands);
  });
}

Result<std::unique_ptr<DrawStage>> DrawStage::make(const ExperimentContext& context, const Scene& scene,
                                                   const render::View& view, PassKind pass) {
  const std::string where = "device '" + context.device_info.name + "'";
  try {
    return std::unique_ptr<DrawStage>(new DrawStage(context, scene, view, pass));
  } catch (const render::LimitError& e) {
    return fail(ErrorKind::no_device, where, e.what());
  } catch (const vk::SystemError& e) {
    return fail(ErrorKind::no_device, where, e.what());
  }
}

Result<void> DrawStage::guarded(const std::function<void()>& body) const {
  try {
    body();
    const std::vector<std::string> messages = device_->take_messages();
    if (messages.empty()) return {};
    return fail(ErrorKind::no_device, "validation",
                std::to_string(messages.size()) + " messages, the first: " + messages.front());
  } catch (const vk::SystemError& e) {
    return fail(ErrorKind::no_device, "device '" + device_->info.name + "'", e.what());
  }
}

StageFrame DrawStage::frame(const std::function<void(const render::PassContext&)>& record) {
  StageFrame out;
  render::vkr::Frame& frame = ring_.begin();
  render::vkr::Barriers barriers;
  gpu_->record_updates(frame, barriers, render::camera_block(view_, scene_->bounds_m()), *scene_);
  const render::PassContext context{*device_, memory_,  pipelines_,        *gpu_, *scene_,
                                    frame,    barriers, ring_.completed(), 1};
  Stopwatch watch;
  record(context);
  out.record_ms = watch.seconds() * 1e3;
  watch = {};
  ring_.submit(frame);
  out.submit_ms = watch.seconds() * 1e3;
  watch = {};
  ring_.wait(frame);
  out.wait_ms = watch.seconds() * 1e3;
  if (const auto times = ring_.gpu_times(frame)) out.gpu_ms = times->frame_ms;
  return out;
}

std::vector<std::uint8_t> DrawStage::read_picture() {
  const std::uint64_t bytes = std::uint64_t{4} * target_.extent.width * target_.extent.height;
  const render::vkr::Buffer back =
      memory_.buffer(bytes, vk::BufferUsageFlagBits::eTransferDst, render::vkr::MemoryUse::readback,
                     render::MemoryKind::readback);
  frame([&](const render::PassContext& c) {
    render::record_readback(c.frame.commands, target_.result(), back, c.barriers);
  });
  const auto* first = reinterpret_cast<const std::uint8_t*>(back.mapped());
  return {first, first + bytes};
}

std::uint64_t resident_bytes() {
  std::ifstream in("/proc/self/statm");
  std::uint64_t whole = 0;
  std::uint64_t resident = 0;
  in >> whole >> resident;
  return in ? resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) : 0;
}

}  // namespace scenegen::tools
