#include "render/renderer.h"

#include <cassert>
#include <chrono>
#include <cstring>
#include <new>
#include <optional>

#include "render/camera_block.h"
#include "render/config.h"
#include "render/draw_scene.h"
#include "render/gpu_scene.h"
#include "render/model/experience.h"
#include "render/model/memory.h"
#include "render/passes/draw_recorder.h"
#include "render/passes/pass_recording.h"
#include "render/passes/targets.h"
#include "render/strategy/estimate_load.h"
#include "render/strategy/octree_choice.h"
#include "render/strategy/strategy.h"
#include "render/strategy/touched_chunks.h"

namespace scenegen::render {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

struct Renderer::State {
  // In order of construction; destroyed backwards.
  RendererOptions options;
  std::shared_ptr<vkr::Device> device;
  std::optional<vkr::Memory> memory;
  std::optional<vkr::Pipelines> pipelines;
  std::optional<DrawScene> scene;
  std::optional<GpuScene> gpu;
  model::UnitCosts costs;
  std::unique_ptr<Strategy> strategy;
  std::optional<Target> color, ids, shadow;
  std::optional<vkr::FrameRing> ring;
  vkr::Barriers barriers;  // empty between frames; kept for its room
  struct Unfinished {
    vkr::Frame* frame = nullptr;
    FrameReport report;
    std::vector<ChunkBox> chunk_boxes;
  };
  std::array<Unfinished, kMostFramesInFlight> unfinished;  // a ring
  std::size_t oldest = 0, unfinished_count = 0;
  std::optional<Error> failed;  // then what is half done is good for nothing but being destroyed

  void build(const Scene& source, const timeline::Player& player);
  [[nodiscard]] Result<void> check_size(glm::uvec2 size) const;
  void make_targets();
  [[nodiscard]] PassContext context(vkr::Frame& frame);
  vkr::Buffer& readback(vkr::Buffer& buffer);
  void update(const timeline::ChangeSet& changes, const timeline::Player& player, FrameReport& report);
  void record_shadows(vkr::Frame& frame, FrameReport& report);
  void record_color(vkr::Frame& frame, FrameReport& report);
  void record_ids(vkr::Frame& frame, FrameReport& report);
  void submit(const timeline::ChangeSet& changes, const timeline::Player& player, const View& view);
  [[nodiscard]] StrategyContext strategy_context() const {
    return {*scene,
            *device,
            options.how,
            costs,
            options.frames_in_flight,
            options.size,
            false,
            options.shadows && options.outputs.color,
            options.outputs.readback};
  }
  void predict(const timeline::ChangeSet& changes, const View& view, FrameReport& report) const;
  void finish(FrameResult& out);
  /// Runs `body`; what it throws becomes an error, now and in every later call.
  template <class Body>
  Result<void> guarded(const Body& body);
};

Result<void> Renderer::State::check_size(glm::uvec2 size) const {
  const auto& limits = device->properties.limits;
  if (size.x == 0 || size.y == 0 || size.x > limits.maxFramebufferWidth ||
      size.y > limits.maxFramebufferHeight)
    return fail(ErrorKind::usage, "--size",
                "each side must be 1 to " + std::to_string(limits.maxFramebufferWidth) + " on this device");
  return {};
}

template <class Body>
Result<void> Renderer::State::guarded(const Body& body) {
  if (failed) return tl::unexpected(*failed);
  const auto failure = [&](std::string what) {
    failed = Error{ErrorKind::no_device, "device '" + device->info.name + "'", std::move(what)};
    return tl::unexpected(*failed);
  };
  try {
    body();
    return {};
  } catch (const vk::DeviceLostError& e) {
    return failure(std::string("was lost: ") + e.what());
  } catch (const LimitError& e) {
    return failure(e.what());
  } catch (const vk::OutOfDeviceMemoryError& e) {
    return failure(std::string(e.what()) + "; smaller pictures, fewer samples or a smaller scene need less");
  } catch (const vk::OutOfHostMemoryError& e) {
    return failure(std::string(e.what()) + "; a smaller scene needs less");
  } catch (const vk::SystemError& e) {
    return failure(e.what());
  } catch (const std::bad_alloc&) {
    return failure("out of host memory; a smaller scene needs less");
  }
}

void Renderer::State::build(const Scene& source, const timeline::Player& player) {
  const auto samples = options.samples == 4 ? vk::SampleCountFlagBits::e4 : vk::SampleCountFlagBits::e1;
  const TextureSets sets = texture_sets(source);
  barriers = vkr::Barriers(options.full_barriers);
  memory.emplace(*device, options.memory_faults);
  pipelines.emplace(*device, samples, options.shadows);
  // Before the scene, which may lie in memory of the host where targets may not.
  make_targets();
  // Without shadows the map is one texel: every descriptor must name something.
  const std::uint32_t side = options.shadows && options.outputs.color ? kShadowMapSide : 1;
  shadow = make_target(*device, *memory, *pipelines, vkr::PassKind::shadow, {side, side},
                       vk::SampleCountFlagBits::e1);
  scene.emplace(source, player, sets.of_material);
  gpu.emplace(*device, *memory, *pipelines, source, sets);
  scene->set_work(gpu->work());
  gpu->upload_records(scene->all_records(player));
  for (std::uint32_t i = 0; i < source.materials.size(); ++i) {
    const MaterialId id(i);
    if (player.base_color(id) != source.materials[i].base_color ||
        player.emissive(id) != source.materials[i].emissive)
      gpu->set_material_colors(id, player.base_color(id), player.emissive(id));
  }
  gpu->bind_shadow_map(shadow->depth);
  costs = options.costs ? *options.costs : model::rough_costs(device->info.type == "CPU");
  strategy = find_strategy(options.strategy)->make(strategy_context());
  const bool stages = device->info.type != "CPU" || options.gpu_stages_on_cpu;
  ring.emplace(*device, options.frames_in_flight, stages);
}

void Renderer::State::make_targets() {
  const vk::Extent2D extent(options.size.x, options.size.y);
  const auto samples = options.samples == 4 ? vk::SampleCountFlagBits::e4 : vk::SampleCountFlagBits::e1;
  color.reset();  // before the new ones are made: both may not fit
  ids.reset();
  if (options.outputs.color)
    color = make_target(*device, *memory, *pipelines, vkr::PassKind::color, extent, samples);
  if (options.outputs.ids || options.outputs.depth)
    ids = make_target(*device, *memory, *pipelines, vkr::PassKind::ids, extent, vk::SampleCountFlagBits::e1);
}

PassContext Renderer::State::context(vkr::Frame& frame) {
  return {*device,
          *memory,
          *pipelines,
          *gpu,
          *scene,
          frame,
          barriers,
          ring->completed(),
          options.frames_in_flight};
}

vkr::Buffer& Renderer::State::readback(vkr::Buffer& buffer) {
  const std::uint64_t bytes = std::uint64_t{4} * options.size.x * options.size.y;
  if (buffer.bytes < bytes)
    buffer = memory->buffer(bytes, vk::BufferUsageFlagBits::eTransferDst, vkr::MemoryUse::readback,
                            MemoryKind::readback);
  return buffer;
}

void Renderer::State::update(const timeline::ChangeSet& changes, const timeline::Player& player,
                             FrameReport& report) {
  const StageTimer whole(report.update_ms);
  scene->apply(changes, player);
  {
    const StageTimer timer(report.update_octree_ms);
    strategy->update(changes);
  }
  for (const MaterialId id : changes.recolored)
    gpu->set_material_colors(id, player.base_color(id), player.emissive(id));
}

void Renderer::State::record_shadows(vkr::Frame& frame, FrameReport& report) {
  begin_pass(frame.commands, *pipelines, *shadow, barriers);
  if (options.shadows) {
    DrawRecorder recorder(frame.commands, *pipelines, *gpu, *scene, vkr::PassKind::shadow);
    record_all_solid(recorder, *scene);
    report.shadow_draws = recorder.recorded().draws;
    report.shadow_triangles = recorder.recorded().triangles;
  }
  frame.commands.endRenderPass();
  barriers.image(shadow->depth, vkr::Use::sampled).flush(frame.commands);
  frame.mark(frame.commands, GpuStage::shadows);
}

void Renderer::State::record_color(vkr::Frame& frame, FrameReport& report) {
  PassRecording pass(context(frame), *color);
  strategy->draw_solid(pass);
  const vk::raii::CommandBuffer& rest = pass.rest();
  frame.mark(rest, pass.in_second_part() ? GpuStage::second_part : GpuStage::solid);
  DrawRecorder blended(rest, *pipelines, *gpu, *scene, vkr::PassKind::color);  // binds what the sky needs too
  rest.bindPipeline(vk::PipelineBindPoint::eGraphics, pipelines->sky());
  rest.draw(3, 1, 0, 0);
  strategy->draw_blended(blended);
  pass.end();
  frame.mark(frame.commands, GpuStage::rest);
  if (options.outputs.readback) {
    record_readback(frame.commands, color->result(), readback(frame.color), barriers);
    frame.mark(frame.commands, GpuStage::readback);
  }
  Recorded all = pass.solid();
  all.add(blended.recorded());
  report.draws = all.draws;
  report.triangles = all.triangles;
  report.state_changes = all.state_changes;
}

void Renderer::State::record_ids(vkr::Frame& frame, FrameReport& report) {
  PassRecording pass(context(frame), *ids);
  strategy->draw_solid(pass);
  pass.end();
  frame.mark(frame.commands, GpuStage::ids);
  const Outputs& wanted = options.outputs;
  if (wanted.ids && wanted.readback)
    record_readback(frame.commands, ids->color, readback(frame.ids), barriers);
  if (wanted.depth && wanted.readback)
    record_readback(frame.commands, ids->depth, readback(frame.depth), barriers);
  if (wanted.readback) frame.mark(frame.commands, GpuStage::readback);
  report.ids_draws = pass.solid().draws;
  report.ids_triangles = pass.solid().triangles;
}

void Renderer::State::submit(const timeline::ChangeSet& changes, const timeline::Player& player,
                             const View& view) {
  FrameReport report;
  report.time_s = changes.time_s;
  report.changed = changes.count();

  update(changes, player, report);
  auto start = Clock::now();
  strategy->plan(view);
  report.plan_ms = ms_since(start);

  start = Clock::now();
  vkr::Frame& frame = ring->begin();
  const CameraBlock camera = camera_block(view, scene->bounds_m());
  {
    const StageTimer timer(report.upload_ms);
    report.uploaded_bytes = gpu->record_updates(frame, barriers, camera, *scene);
    scene->clear_dirty();
  }
  frame.mark(frame.commands, GpuStage::updates);
  if (options.outputs.color) {
    record_shadows(frame, report);
    record_color(frame, report);
  }
  if (options.outputs.ids || options.outputs.depth) record_ids(frame, report);
  report.record_ms = ms_since(start);
  if (options.predictions) {  // before the device begins: it must not work meanwhile
    const StageTimer timer(report.predict_ms);
    predict(changes, view, report);
  }

  start = Clock::now();
  ring->submit(frame);
  report.submit_ms = ms_since(start);
  report.objects = scene->object_count();
  report.visible = scene->visible_object_count();
  static_cast<PlanCounters&>(report) = strategy->counters();
  report.uploaded_bytes += report.list_bytes;
  report.strategy_used = find_strategy(options.strategy)->name;
  if (const ChoiceReport* choice = strategy->choice()) {
    report.strategy_used = choice->used;
    report.verdict = choice->verdict;
    report.choose_ms = choice->choose_s * 1e3;
  }
  Unfinished& kept = unfinished[(oldest + unfinished_count++) % unfinished.size()];
  kept.frame = &frame;
  kept.report = report;
  if (options.chunk_boxes) kept.chunk_boxes = strategy->chunk_boxes();
}

/// What every way of drawing would have cost; what the one that was taken did not find out is estimated.
void Renderer::State::predict(const timeline::ChangeSet& changes, const View& view,
                              FrameReport& report) const {
  model::FrameFacts facts = strategy->facts();
  facts.changed = static_cast<double>(report.changed);
  facts.visible = load_of_visible(*scene, ScreenArea(view, options.size));
  if (options.shadows && options.outputs.color) {
    facts.shadow_slots = facts.visible.draws;
    facts.shadow_vertices = facts.visible.vertices;
  }
  const StrategyContext context = strategy_context();
  const std::uint32_t per_node = choose_objects_per_node(context).value_or(kObjectsPerNode);
  model::Experience{}.fill_unknown(facts, per_node, ChunksTouched(*scene, per_node).count(changes));
  model::PredictionOptions how;
  how.frames_in_flight = options.frames_in_flight;
  how.indirect_nodes = indirect_nodes(context);
  how.exact = !options.how.late_visibility;
  how.readback = options.outputs.readback;
  for (std::size_t m = 0; m < model::kMethods; ++m)
    report.predicted[m] = model::predict(static_cast<model::Method>(m), facts, costs, how);
  report.facts = facts;
}

void Renderer::State::finish(FrameResult& out) {
  assert(unfinished_count > 0);
  Unfinished& kept = unfinished[oldest];
  oldest = (oldest + 1) % unfinished.size();
  --unfinished_count;
  vkr::Frame* const frame = kept.frame;
  FrameReport report = kept.report;
  out.chunk_boxes = std::move(kept.chunk_boxes);
  auto start = Clock::now();
  ring->wait(*frame);
  report.wait_ms = ms_since(start);
  if (const auto gpu_times = ring->gpu_times(*frame)) {
    report.gpu_ms = gpu_times->frame_ms;
    if (gpu_times->stages_ms) report.gpu_stages_ms = *gpu_times->stages_ms;
  }
  start = Clock::now();
  const std::size_t pixels = std::size_t{options.size.x} * options.size.y;
  const auto copy = [&](auto& to, const vkr::Buffer& from, bool drawn) {
    const bool wanted = drawn && options.outputs.readback;
    to.resize(wanted ? pixels * 4 / sizeof(to[0]) : 0);
    if (wanted) std::memcpy(to.data(), from.mapped(), pixels * 4);
  };
  copy(out.rgba, frame->color, options.outputs.color);
  copy(out.ids, frame->ids, options.outputs.ids);
  copy(out.depth, frame->depth, options.outputs.depth);
  report.readback_ms = ms_since(start);
  const DeviceCounts counted = strategy->device_counts(frame->serial);
  report.drawn += counted.drawn;
  report.reveals += counted.reveals;
  report.triangles += counted.triangles;
  report.ids_triangles += counted.ids_triangles;
  out.report = report;
  strategy->finished(
      {frame->serial,
       (report.update_ms + report.plan_ms + report.record_ms + report.submit_ms + report.readback_ms) * 1e-3,
       report.gpu_ms * 1e-3});
}

Result<Renderer> Renderer::create(const Scene& scene, const timeline::Player& player,
                                  const RendererOptions& options) try {
  if (options.samples != 1 && options.samples != 4)
    return fail(ErrorKind::usage, "--samples", std::to_string(options.samples) + "; 1 or 4");
  if (options.frames_in_flight < 1 || options.frames_in_flight > kMostFramesInFlight)
    return fail(ErrorKind::usage, "--frames-in-flight",
                std::to_string(options.frames_in_flight) + "; 1 to " + std::to_string(kMostFramesInFlight));
  if (find_strategy(options.strategy) == nullptr)
    return fail(ErrorKind::usage, "--strategy", "unknown value '" + options.strategy + "'");
  auto state = std::make_unique<State>();
  state->options = options;
  state->device = options.shared_device;
  if (!state->device) {
    auto device = share_device(options.device);
    if (!device) return forward_error(device);
    state->device = std::move(*device);
  }
  if (Result<void> fits = state->check_size(options.size); !fits) return forward_error(fits);
  Result<void> built = state->guarded([&] { state->build(scene, player); });
  if (!built) return forward_error(built);
  return Renderer(std::move(state));
} catch (const std::bad_alloc&) {
  return fail(ErrorKind::no_device, "renderer", "out of host memory; a smaller scene needs less");
}

Renderer::Renderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

std::uint32_t Renderer::most_in_flight() const {
  return state_->options.frames_in_flight;
}
std::uint32_t Renderer::in_flight() const {
  return static_cast<std::uint32_t>(state_->unfinished_count);
}

Result<void> Renderer::submit(const timeline::ChangeSet& changes, const timeline::Player& player,
                              const View& view) {
  assert(in_flight() < most_in_flight());
  return state_->guarded([&] { state_->submit(changes, player, view); });
}

Result<void> Renderer::finish(FrameResult& out) {
  return state_->guarded([&] { state_->finish(out); });
}

void Renderer::set_predictions(bool wanted) {
  state_->options.predictions = wanted;
}

Result<void> Renderer::resize(glm::uvec2 size) {
  assert(in_flight() == 0);
  if (Result<void> fits = state_->check_size(size); !fits) return fits;
  return state_->guarded([&] {
    state_->ring->wait_all();
    state_->options.size = size;
    state_->make_targets();
    state_->strategy->resized(size);
  });
}

const DeviceInfo& Renderer::device() const {
  return state_->device->info;
}
glm::uvec2 Renderer::size() const {
  return state_->options.size;
}
std::vector<std::string> Renderer::warnings() const {
  std::vector<std::string> out = state_->gpu->warnings();
  const std::vector<std::string>& more = state_->strategy->warnings();
  out.insert(out.end(), more.begin(), more.end());
  return out;
}
std::uint64_t Renderer::device_bytes() const {
  return state_->memory->block_bytes();
}
MemoryAccount Renderer::memory(const timeline::Player& player) const {
  MemoryAccount out;
  state_->memory->add_to(out);
  state_->gpu->add_memory(out);
  state_->strategy->add_memory(out);
  out.add_host(MemoryKind::timeline, player.memory_bytes() + player.timeline().memory_bytes());
  out.add_host(MemoryKind::slots, state_->scene->memory_bytes());
  out.objects = state_->scene->object_count();
  CommandMemoryReport& commands = out.commands;
  commands.predicted = model::kept_command_bytes(static_cast<double>(commands.buffers),
                                                 static_cast<double>(commands.draws), state_->costs);
  const bool software = state_->device->info.type == "CPU";
  commands.measured =
      software ? commands.driver : static_cast<std::uint64_t>(std::max<std::int64_t>(0, commands.process));
  return out;
}
std::vector<std::string> Renderer::take_validation_messages() {
  return state_->device->take_messages();
}

}  // namespace scenegen::render
