#include "tools/experiments/software_depth.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/spatial/query_box.h"

namespace scenegen::tools {

SoftwareDepth::SoftwareDepth(glm::uvec2 size, const render::View& view)
    : size_(size),
      view_(view),
      depth_(std::size_t{size.x} * size.y, 0.0F),
      ids_(std::size_t{size.x} * size.y, kNone) {}

SoftwareDepth::Corner SoftwareDepth::project(const glm::vec3& world_m) const {
  const glm::vec4 clip = view_.clip_from_world * glm::vec4(world_m, 1.0F);
  if (clip.w <= 0 || clip.z > clip.w) return {glm::vec3(0), true};
  const glm::vec3 ndc = glm::vec3(clip) / clip.w;
  return {{(ndc.x * 0.5F + 0.5F) * static_cast<float>(size_.x),
           (ndc.y * 0.5F + 0.5F) * static_cast<float>(size_.y), ndc.z},
          false};
}

/// `pixel(index, depth)` says whether to go on.
template <class Pixel>
void SoftwareDepth::rasterize(const Corner& a, const Corner& b, const Corner& c, const Pixel& pixel) const {
  if (a.before_near || b.before_near || c.before_near) return;
  const glm::vec2 pa(a.pixel), pb(b.pixel), pc(c.pixel);
  const float area = (pb.x - pa.x) * (pc.y - pa.y) - (pb.y - pa.y) * (pc.x - pa.x);
  if (area == 0.0F || !std::isfinite(area)) return;
  const glm::vec2 lo = glm::max(glm::min(glm::min(pa, pb), pc), glm::vec2(0));
  const glm::vec2 hi = glm::min(glm::max(glm::max(pa, pb), pc), glm::vec2(size_));
  if (!(lo.x < hi.x) || !(lo.y < hi.y)) return;
  const auto first_x = static_cast<int>(std::ceil(lo.x - 0.5F));
  const auto first_y = static_cast<int>(std::ceil(lo.y - 0.5F));
  const auto last_x = std::min(static_cast<int>(std::floor(hi.x - 0.5F)), static_cast<int>(size_.x) - 1);
  const auto last_y = std::min(static_cast<int>(std::floor(hi.y - 0.5F)), static_cast<int>(size_.y) - 1);
  const float inverse = 1.0F / area;
  for (int y = first_y; y <= last_y; ++y) {
    for (int x = first_x; x <= last_x; ++x) {
      const glm::vec2 p(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
      const float u = ((pb.x - p.x) * (pc.y - p.y) - (pb.y - p.y) * (pc.x - p.x)) * inverse;
      const float v = ((pc.x - p.x) * (pa.y - p.y) - (pc.y - p.y) * (pa.x - p.x)) * inverse;
      const float w = 1.0F - u - v;
      if (u < 0 || v < 0 || w < 0) continue;
      const float depth = u * a.pixel.z + v * b.pixel.z + w * c.pixel.z;
      if (!pixel(static_cast<std::size_t>(y) * size_.x + static_cast<std::size_t>(x), depth)) return;
    }
  }
}

void SoftwareDepth::draw(const Geometry& geometry, const glm::mat4& world_from_mesh, std::uint32_t object) {
  if (geometry.topology != Topology::triangles) return;
  corners_.clear();
  for (const glm::vec3& p : geometry.positions_m)
    corners_.push_back(project(glm::vec3(world_from_mesh * glm::vec4(p, 1.0F))));
  const bool indexed = !geometry.indices.empty();
  const std::size_t count = geometry.drawn_vertex_count();
  const auto corner = [&](std::size_t i) -> const Corner& {
    return corners_[indexed ? geometry.indices[i] : i];
  };
  for (std::size_t i = 0; i + 2 < count; i += 3) {
    rasterize(corner(i), corner(i + 1), corner(i + 2), [&](std::size_t at, float depth) {
      if (depth > depth_[at]) {
        depth_[at] = depth;
        ids_[at] = object;
      }
      return true;
    });
  }
}

bool SoftwareDepth::visible(const Box& box) const {
  const render::QueryBoxes boxes(view_, size_);
  const Box grown = boxes.grown(box);
  if (boxes.touches_eye(grown)) return true;
  std::array<Corner, 8> corners;
  for (unsigned k = 0; k < 8; ++k) {
    corners[k] = project({(k & 1U) != 0 ? grown.hi.x : grown.lo.x, (k & 2U) != 0 ? grown.hi.y : grown.lo.y,
                          (k & 4U) != 0 ? grown.hi.z : grown.lo.z});
    if (corners[k].before_near) return true;
  }
  bool found = false;
  constexpr std::array<std::array<std::uint8_t, 4>, 6> kFaces{
      {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
  const auto test = [&](std::size_t at, float depth) {
    found = depth >= depth_[at];
    return !found;
  };
  for (const auto& f : kFaces) {
    rasterize(corners[f[0]], corners[f[1]], corners[f[2]], test);
    if (!found) rasterize(corners[f[0]], corners[f[2]], corners[f[3]], test);
    if (found) return true;
  }
  return false;
}

std::vector<std::uint32_t> SoftwareDepth::visible_objects() const {
  std::vector<std::uint32_t> out(ids_);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  if (!out.empty() && out.back() == kNone) out.pop_back();
  return out;
}

SoftwareDepth draw_depths(const Scene& scene, std::span<const std::uint32_t> objects,
                          const render::View& view, glm::uvec2 size) {
  SoftwareDepth out(size, view);
  const std::vector<Box> bounds = mesh_bounds(scene);
  const std::vector<glm::mat4> frames = rest_frame_matrices(scene);
  const render::Frustum frustum = render::frustum_of(view.clip_from_world);
  for (const std::uint32_t o : objects) {
    const glm::mat4 world_from_mesh = rest_world_from_object(scene, frames, ObjectId(o));
    const MeshId mesh = scene.objects.mesh[o];
    if (!mesh.valid() || !render::intersects(frustum, transformed(bounds[mesh.value], world_from_mesh)))
      continue;
    for (const Primitive& p : scene.meshes[mesh.value].primitives) {
      // Glass hides nothing.
      if (p.material.valid() && scene.materials[p.material.value].alpha_mode == AlphaMode::blend) continue;
      out.draw(scene.geometries[p.geometry.value], world_from_mesh, o);
    }
  }
  return out;
}

}  // namespace scenegen::tools
