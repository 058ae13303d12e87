#include "tools/experiments/merged_renderer.h"

#include <algorithm>
#include <cmath>

#include "render/draw_optimize.h"
#include "render/gpu_scene.h"
#include "scene/parallel.h"
#include "tools/output.h"

namespace scenegen::tools {

using render::vkr::MemoryUse;
using render::vkr::Use;
using Usage = vk::BufferUsageFlagBits;

namespace {

constexpr std::uint64_t kUpload = 64ULL << 20;  // of what is uploaded at once

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
    std::uint64_t largest = kUpload;
    for (const Geometry& g : scene.geometries) {
      render::DrawGeometry& own = out->geometries_.emplace_back(render::make_draw_geometry(g));
      render::share_vertices(own, render::TriangleOrder::free);  // as the renderer does
      largest = std::max({largest, own.positions_m.size() * sizeof(glm::vec3),
                          own.attributes.size() * sizeof(render::VertexAttributes),
                          own.indices.size() * sizeof(std::uint32_t)});
    }
    out->upload_ =
        s.memory().buffer(largest, Usage::eTransferSrc, MemoryUse::upload, render::MemoryKind::staging);
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
      pieces_.push_back({slot_of_material_[material], p.geometry.value, 0, 0, world_from_object});
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
  for (Piece& piece : pieces_) {
    const render::DrawGeometry& g = geometries_[piece.geometry];
    piece.first_vertex = static_cast<std::uint32_t>(vertices_);
    piece.first_index = static_cast<std::uint32_t>(indices_count_);
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

/// Fills `to` through the mapped upload buffer, as many whole pieces at a time as fit, by all processors: a
/// renderer that optimizes scenes would. `count`: of all elements; `first`: a piece's; write(piece, T* of its
/// first).
template <class T, class Write>
void MergedRenderer::upload(const render::vkr::Buffer& to, std::uint32_t Piece::*first, std::uint64_t count,
                            const Write& write) {
  const auto begin_of = [&](std::size_t piece) -> std::uint64_t {
    return piece < pieces_.size() ? pieces_[piece].*first : count;
  };
  const std::uint64_t room = upload_.bytes / sizeof(T);  // at least for the largest geometry
  auto* const mapped = reinterpret_cast<T*>(upload_.mapped());
  for (std::size_t from = 0; from < pieces_.size();) {
    const std::uint64_t start = begin_of(from);
    std::size_t end = from;
    while (end < pieces_.size() && begin_of(end + 1) - start <= room) ++end;
    const auto bound = [&](std::uint64_t element) {
      return std::lower_bound(pieces_.begin() + static_cast<std::ptrdiff_t>(from),
                              pieces_.begin() + static_cast<std::ptrdiff_t>(end), element,
                              [&](const Piece& piece, std::uint64_t at) { return piece.*first < at; });
    };
    const std::uint64_t elements = begin_of(end) - start;
    parallel_for(elements, 0, [&](std::size_t low, std::size_t high) {
      const auto last = bound(start + high);
      for (auto piece = bound(start + low); piece != last; ++piece)
        write(*piece, mapped + (*piece.*first - start));
    });
    if (elements > 0) {
      render::vkr::run_once(stage_->device(), [&](const vk::raii::CommandBuffer& c) {
        c.copyBuffer(*upload_.buffer, *to.buffer, vk::BufferCopy(0, start * sizeof(T), elements * sizeof(T)));
        render::vkr::Barriers().buffer(*to.buffer, Use::transfer_write, Use::shader_data).flush(c);
      });
    }
    from = end;
  }
}

void MergedRenderer::write_vertices() {
  upload<glm::vec3>(positions_, &Piece::first_vertex, vertices_, [&](const Piece& piece, glm::vec3* out) {
    for (const glm::vec3& p : geometries_[piece.geometry].positions_m)
      *out++ = glm::vec3(piece.world_from_object * glm::vec4(p, 1.0F));
  });
  upload<render::VertexAttributes>(
      attributes_, &Piece::first_vertex, vertices_, [&](const Piece& piece, render::VertexAttributes* out) {
        const glm::mat3 rotation = glm::transpose(glm::inverse(glm::mat3(piece.world_from_object)));
        for (render::VertexAttributes a : geometries_[piece.geometry].attributes) {
          a.normal = turned(a.normal, rotation);
          a.tangent = turned(a.tangent, glm::mat3(piece.world_from_object));
          *out++ = a;
        }
      });
}

void MergedRenderer::write_indices() {
  upload<std::uint32_t>(indices_, &Piece::first_index, indices_count_,
                        [&](const Piece& piece, std::uint32_t* out) {
                          for (const std::uint32_t i : geometries_[piece.geometry].indices)
                            *out++ = piece.first_vertex + i;
                        });
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
