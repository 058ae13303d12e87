#include "render/model/memory.h"

#include <algorithm>
#include <numeric>

namespace scenegen::render::model {
namespace {

std::uint64_t sum_of(std::span<const Share> shares) {
  return std::accumulate(shares.begin(), shares.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const Share& s) { return sum + s.count * s.bytes_each; });
}

}  // namespace

std::uint64_t geometry_bytes(const GeometryCounts& n, const GeometryUnits& u) {
  return n.vertices * u.vertex + n.indices * u.index + n.texcoords * u.texcoord + n.normals * u.normal;
}

std::uint64_t texture_bytes(std::span<const TextureSize> textures) {
  return std::accumulate(
      textures.begin(), textures.end(), std::uint64_t{0},
      [](std::uint64_t sum, const TextureSize& t) { return sum + t.width * t.height * t.bytes_per_pixel; });
}

std::uint64_t uniform_bytes(std::span<const Share> objects_by_material) {
  return sum_of(objects_by_material);
}

std::uint64_t command_bytes(std::span<const Share> objects_by_material) {
  return sum_of(objects_by_material);
}

std::uint64_t grouped_command_bytes(std::span<const std::uint64_t> groups, std::uint64_t secondary) {
  return std::accumulate(
      groups.begin(), groups.end(), std::uint64_t{0},
      [&](std::uint64_t sum, std::uint64_t group) { return sum + std::max(secondary, group); });
}

double kept_command_bytes(double buffers, double draws, const UnitCosts& units) {
  return buffers * units.secondary_bytes + draws * units.command_bytes;
}

std::uint64_t pipeline_bytes(std::span<const Share> pipelines) {
  return sum_of(pipelines);
}

std::uint64_t instance_bytes(const Share& objects, const Share& materials) {
  return objects.count * objects.bytes_each + materials.count * materials.bytes_each;
}

std::uint64_t hierarchy_bytes(const Share& nodes) {
  return nodes.count * nodes.bytes_each;
}

}  // namespace scenegen::render::model
