#include "tools/experiments/merged_renderer.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "render/draw_optimize.h"
#include "render/gpu_scene.h"
#include "tools/output.h"

namespace scenegen::tools {

using render::vkr::MemoryUse;
using render::vkr::Use;
using Usage = vk::BufferUsageFlagBits;

namespace {

constexpr std::uint64_t kPiece = 64ULL << 20;  // of what is uploaded at once

/// The scene's materials, and an object of one small triangle in each: records, textures and states to draw
/// with.
Scene palette_of(const Scene& scene) {
  Scene out;
  out.images = scene.images;
  out.textures = scene.textures;
  out.materials = scene.materials;
  out.materials.emplace_back();  // glTF's default
  Geometry& triangle = out.geometries.emplace_back();
  triangle.positions_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (std::uint32_t m = 0; m < out.materials.size(); ++m) {
    out.meshes.push_back({"", {{GeometryId(0), MaterialId(m)}}});
    out.objects.add(std::to_string(m), MeshId(m), {});
  }
  return out;
}

glm::i16vec4 turned(const glm::i16vec4& v, const glm::mat3& rotation) {
  const glm::vec3 r = rotation * glm::vec3(v);
  const float length = glm::length(r);
  if (length == 0.0F) return v;
  const glm::vec3 n = r * (32767.0F / length);
  return {static_cast<std::int16_t>(std::lround(n.x)), static_cast<std::int16_t>(std::lround(n.y)),
          static_cast<std::int16_t>(std::lround(n.z)), v.w};
}

/// Fills device memory through a mapped buffer, a piece at a time.
class Uploading {
 public:
  Uploading(DrawStage& stage, const render::vkr::Buffer& from, const render::vkr::Buffer& to)
      : stage_(stage), from_(from), to_(to) {}
  template <class T>
  void add(const T& value) {
    if (used_ + sizeof(T) > from_.bytes) flush();
    std::memcpy(from_.mapped() + used_, &value, sizeof(T));
    used_ += sizeof(T);
  }
  void flush() {
    if (used_ == 0) return;
    render::vkr::run_once(stage_.device(), [&](const vk::raii::CommandBuffer& c) {
      c.copyBuffer(*from_.buffer, *to_.buffer, vk::BufferCopy(0, done_, used_));
      render::vkr::Barriers().buffer(*to_.buffer, Use::transfer_write, Use::shader_data).flush(c);
    });
    done_ += used_;
    used_ = 0;
  }

 private:
  DrawStage& stage_;
  const render::vkr::Buffer& from_;
  const render::vkr::Buffer& to_;
  std::uint64_t used_ = 0, done_ = 0;
};

}  // namespace

Result<std::unique_ptr<MergedRenderer>> MergedRenderer::make(const ExperimentContext& context,
                                                             const Scene& scene, const render::View& view) {
  auto out = std::unique_ptr<MergedRenderer>(new MergedRenderer(scene));
  auto stage = DrawStage::make(context, palette_of(scene), view, render::vkr::PassKind::color);
  if (!stage) return forward_error(stage);
  out->stage_ = std::move(*stage);
  auto done = out->stage_->guarded([&] {
    DrawStage& s = *out->stage_;
    out->slot_of_material_.resize(scene.materials.size() + 1);
    for (std::uint32_t slot = 0; slot < s.scene().slot_count(); ++slot)
      out->slot_of_material_[s.scene().object(slot).value] = slot;
    for (const Geometry& g : scene.geometries) {
      out->geometries_.push_back(render::make_draw_geometry(g));
      render::share_vertices(out->geometries_.back(), render::TriangleOrder::free);  // as the renderer does
    }
    out->upload_ =
        s.memory().buffer(kPiece, Usage::eTransferSrc, MemoryUse::upload, render::MemoryKind::staging);
    out->pool_ = vk::raii::CommandPool(
        s.device().device, {vk::CommandPoolCreateFlagBits::eResetCommandBuffer, s.device().queue_family});
    out->commands_ = std::move(
        vk::raii::CommandBuffers(s.device().device, {*out->pool_, vk::CommandBufferLevel::eSecondary, 1})
            .front());
  });
  if (!done) return forward_error(done);
  return out;
}

void MergedRenderer::gather(const timeline::Player& player) {
  pieces_.clear();
  for (std::uint32_t o = 0; o < scene_.objects.size(); ++o) {
    const ObjectId id(o);
    const MeshId mesh = player.mesh(id);
    if (!mesh.valid() || !player.visible(id)) continue;
    const glm::mat4 world_from_object = player.world_from_object(id);
    for (const Primitive& p : scene_.meshes[mesh.value].primitives) {
      const std::size_t material = p.material.valid() ? p.material.value : scene_.materials.size();
      pieces_.push_back({slot_of_material_[material], p.geometry.value, world_from_object});
    }
  }
  // In the order of states, blended ones last.
  std::stable_sort(pieces_.begin(), pieces_.end(),
                   [](const Piece& a, const Piece& b) { return a.slot < b.slot; });
}

void MergedRenderer::lay_out() {
  draws_.clear();
  vertices_ = 0;
  indices_count_ = 0;
  for (const Piece& piece : pieces_) {
    const render::DrawGeometry& g = geometries_[piece.geometry];
    if (draws_.empty() || draws_.back().slot != piece.slot)
      draws_.push_back({piece.slot, static_cast<std::uint32_t>(indices_count_), 0});
    draws_.back().index_count += static_cast<std::uint32_t>(g.indices.size());
    vertices_ += g.positions_m.size();
    indices_count_ += g.indices.size();
  }
  if (vertices_ > 0x7FFFFFFFU || indices_count_ > 0xFFFFFFFFU)
    throw render::LimitError("merged, the scene has more than 2^31 vertices or 2^32 indices");
}

void MergedRenderer::reserve() {
  const auto grown = [&](render::vkr::Buffer& buffer, std::uint64_t bytes, vk::BufferUsageFlags usage) {
    if (buffer.bytes >= bytes && buffer.bytes > 0) return;
    buffer = {};
    buffer =
        stage_->memory().buffer(std::max<std::uint64_t>(bytes + bytes / 4, 4096), usage | Usage::eTransferDst,
                                MemoryUse::scene, render::MemoryKind::geometry);
  };
  grown(positions_, vertices_ * sizeof(glm::vec3), Usage::eVertexBuffer);
  grown(attributes_, vertices_ * sizeof(render::VertexAttributes), Usage::eVertexBuffer);
  grown(indices_, indices_count_ * sizeof(std::uint32_t), Usage::eIndexBuffer);
}

void MergedRenderer::write_vertices() {
  Uploading positions(*stage_, upload_, positions_);
  for (const Piece& piece : pieces_) {
    for (const glm::vec3& p : geometries_[piece.geometry].positions_m)
      positions.add(glm::vec3(piece.world_from_object * glm::vec4(p, 1.0F)));
  }
  positions.flush();
  Uploading attributes(*stage_, upload_, attributes_);
  for (const Piece& piece : pieces_) {
    const glm::mat3 rotation = glm::transpose(glm::inverse(glm::mat3(piece.world_from_object)));
    for (render::VertexAttributes a : geometries_[piece.geometry].attributes) {
      a.normal = turned(a.normal, rotation);
      a.tangent = turned(a.tangent, glm::mat3(piece.world_from_object));
      attributes.add(a);
    }
  }
  attributes.flush();
}

void MergedRenderer::write_indices() {
  Uploading indices(*stage_, upload_, indices_);
  std::uint32_t first = 0;
  for (const Piece& piece : pieces_) {
    const render::DrawGeometry& g = geometries_[piece.geometry];
    for (const std::uint32_t i : g.indices) indices.add(first + i);
    first += static_cast<std::uint32_t>(g.positions_m.size());
  }
  indices.flush();
}

void MergedRenderer::record() {
  using Bind = vk::PipelineBindPoint;
  const vk::raii::CommandBuffer& c = commands_;
  render::vkr::Pipelines& pipelines = stage_->pipelines();
  render::begin_secondary(c, pipelines, stage_->target(), {});
  c.bindVertexBuffers(0, {*positions_.buffer, *attributes_.buffer}, {0, 0});
  c.bindIndexBuffer(*indices_.buffer, 0, vk::IndexType::eUint32);
  stage_->gpu().bind_frame_set(c, pipelines.layout());
  c.setFrontFace(vk::FrontFace::eCounterClockwise);
  const auto sky = [&] {
    c.setCullMode(vk::CullModeFlagBits::eNone);
    c.bindPipeline(Bind::eGraphics, pipelines.sky());
    c.draw(3, 1, 0, 0);
  };
  bool sky_drawn = false;
  for (const Draw& d : draws_) {
    const render::DrawState& state = stage_->scene().batches()[stage_->scene().primitive(d.slot).batch].state;
    if (state.alpha == AlphaMode::blend && !std::exchange(sky_drawn, true)) sky();
    const std::uint32_t mask = stage_->gpu().texture_mask(state.texture_set);
    c.bindPipeline(Bind::eGraphics,
                   pipelines.get({render::vkr::PassKind::color, state.alpha, state.kind, mask}));
    stage_->gpu().bind_texture_set(c, pipelines.layout(), mask != 0 ? state.texture_set : 0);
    c.setCullMode(state.double_sided ? vk::CullModeFlagBits::eNone : vk::CullModeFlagBits::eBack);
    c.drawIndexed(d.index_count, 1, d.first_index, 0, d.slot);
  }
  if (!sky_drawn) {
    stage_->gpu().bind_texture_set(c, pipelines.layout(), 0);
    sky();
  }
  c.end();
}

void MergedRenderer::merge(const timeline::Player& player) {
  gather(player);
  lay_out();
  reserve();
  write_vertices();
  write_indices();
  record();
}

Result<MergedFrame> MergedRenderer::frame(const timeline::Player& player, bool changed) {
  MergedFrame out;
  auto done = stage_->guarded([&] {
    if (changed) {
      const Stopwatch watch;
      merge(player);
      out.merge_ms = watch.seconds() * 1e3;
    }
    out.drawing = stage_->frame([&](const render::PassContext& context) {
      render::PassRecording pass(context, stage_->target());
      const vk::CommandBuffer kept = *commands_;
      pass.execute({&kept, 1}, {.draws = draws_.size()});
      pass.end();
    });
  });
  if (!done) return forward_error(done);
  return out;
}

}  // namespace scenegen::tools
