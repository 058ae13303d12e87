#include "render/passes/draw_recorder.h"

#include <bit>

namespace scenegen::render {

DrawRecorder::DrawRecorder(const vk::raii::CommandBuffer& commands, vkr::Pipelines& pipelines,
                           const GpuScene& gpu, const DrawScene& scene, vkr::PassKind pass)
    : commands_(commands), pipelines_(pipelines), gpu_(gpu), scene_(scene), pass_(pass) {
  gpu_.bind_geometry(commands_);
  gpu_.bind_frame_set(commands_, pipelines_.layout());
  commands_.setCullMode(cull_);
  commands_.setFrontFace(front_);
}

void DrawRecorder::bind_batch(std::uint32_t batch, bool listed) {
  batch_ = batch;
  listed_ = listed;
  const DrawState& state = scene_.batches()[batch].state;
  // Depth passes read one texture at most, for the alpha of masked materials.
  std::uint32_t mask = gpu_.texture_mask(state.texture_set);
  if (state.tangents) mask |= kTangents;
  if (pass_ != vkr::PassKind::color) mask &= state.alpha == AlphaMode::mask ? 1U << kTextureBaseColor : 0U;
  const vk::Pipeline pipeline = pipelines_.get({pass_, state.alpha, state.kind, mask, listed});
  if (pipeline != pipeline_) {
    commands_.bindPipeline(vk::PipelineBindPoint::eGraphics, pipeline);
    pipeline_ = pipeline;
    ++recorded_.state_changes;
  }
  const std::uint32_t set = mask != 0 ? state.texture_set : 0;
  if (set == texture_set_) return;
  gpu_.bind_texture_set(commands_, pipelines_.layout(), set);
  texture_set_ = set;
  ++recorded_.state_changes;
}

void DrawRecorder::set_winding(bool mirrored, const DrawState& state) {
  using Cull = vk::CullModeFlagBits;
  // Both sides cast shadows: thin walls and open meshes leak no light.
  const bool both = state.double_sided || pass_ == vkr::PassKind::shadow;
  const vk::CullModeFlags cull = both ? vk::CullModeFlags{} : vk::CullModeFlags{Cull::eBack};
  if (cull != cull_) {
    commands_.setCullMode(cull_ = cull);
    ++recorded_.state_changes;
  }
  const vk::FrontFace front = mirrored ? vk::FrontFace::eClockwise : vk::FrontFace::eCounterClockwise;
  if (front == front_) return;
  commands_.setFrontFace(front_ = front);
  ++recorded_.state_changes;
}

void DrawRecorder::draw_instances(std::uint32_t slot, bool listed, std::uint32_t first, std::uint32_t count) {
  const DrawPrimitive& primitive = scene_.primitive(slot);
  if (primitive.batch != batch_ || listed_ != listed) bind_batch(primitive.batch, listed);
  set_winding(scene_.mirrored(slot), scene_.batches()[primitive.batch].state);
  const GeometryRange& range = gpu_.range(primitive.geometry);
  if (range.index_count == 0) return;
  commands_.drawIndexed(range.index_count, count, range.first_index, range.vertex_offset, first);
  ++recorded_.draws;
  if (range.kind == PrimitiveKind::triangles)
    recorded_.triangles += std::uint64_t{range.index_count / 3} * count;
}

void DrawRecorder::draw_indirect(const IndirectDraws& draws) {
  constexpr auto kStride = static_cast<std::uint32_t>(sizeof(VkDrawIndexedIndirectCommand));
  const DrawPrimitive& primitive = scene_.primitive(draws.slot);
  if (primitive.batch != batch_ || listed_) bind_batch(primitive.batch);
  set_winding(scene_.mirrored(draws.slot), scene_.batches()[primitive.batch].state);
  if (draws.counts) {
    commands_.drawIndexedIndirectCount(draws.commands, draws.offset, draws.counts, draws.counts_offset,
                                       draws.count, kStride);
  } else {
    commands_.drawIndexedIndirect(draws.commands, draws.offset, draws.count, kStride);
  }
  recorded_.draws += draws.count;
  recorded_.triangles += draws.triangles;
}

void DrawRecorder::draw_listed_indirect(const ListedIndirectDraws& draws) {
  if (draws.batch != batch_ || !listed_) bind_batch(draws.batch, true);
  set_winding(draws.mirrored, scene_.batches()[draws.batch].state);
  commands_.drawIndexedIndirect(draws.commands, draws.offset, draws.count,
                                static_cast<std::uint32_t>(sizeof(VkDrawIndexedIndirectCommand)));
  recorded_.draws += draws.count;
}

void DrawRecorder::read_slots_from(vk::Buffer list) {
  commands_.bindVertexBuffers(2, list, {0});
}

void record_all_solid(DrawRecorder& recorder, const DrawScene& scene) {
  std::uint32_t run = 0;
  std::uint32_t length = 0;
  const auto words = scene.visible().words();
  for (std::size_t w = 0; w < words.size(); ++w) {
    for (std::uint64_t bits = words[w]; bits != 0; bits &= bits - 1) {
      const auto slot = static_cast<std::uint32_t>(w * 64 + static_cast<unsigned>(std::countr_zero(bits)));
      const DrawPrimitive& primitive = scene.primitive(slot);
      if (scene.batches()[primitive.batch].state.alpha == AlphaMode::blend) continue;
      if (length > 0 && slot == run + length && &scene.primitive(run) == &primitive &&
          scene.mirrored(run) == scene.mirrored(slot)) {
        ++length;
        continue;
      }
      if (length > 0) recorder.draw_run(run, length);
      run = slot;
      length = 1;
    }
  }
  if (length > 0) recorder.draw_run(run, length);
}

}  // namespace scenegen::render
