// What a scene and its commands take in memory (D 2.4); bytes. Unit sizes come from the caller: they depend
// on device and driver.
#pragma once

#include <cstdint>
#include <span>

#include "render/model/unit_costs.h"

namespace scenegen::render::model {

struct GeometryCounts {
  std::uint64_t vertices = 0, indices = 0, texcoords = 0, normals = 0;
};
/// Bytes of one of each.
struct GeometryUnits {
  std::uint64_t vertex = 0, index = 0, texcoord = 0, normal = 0;
};
struct TextureSize {
  std::uint64_t width = 0, height = 0, bytes_per_pixel = 0;
};
/// So many things of one size: objects of one material, say.
struct Share {
  std::uint64_t count = 0;
  std::uint64_t bytes_each = 0;
};

/// (2.2) |Vert| M(v) + |Idx| M(i) + |TC| M(tc) + |Norm| M(n).
[[nodiscard]] std::uint64_t geometry_bytes(const GeometryCounts& counts, const GeometryUnits& units);
/// (2.3) sum of W H BPP.
[[nodiscard]] std::uint64_t texture_bytes(std::span<const TextureSize> textures);
/// (2.4) sum over objects of M_ubo(material).
[[nodiscard]] std::uint64_t uniform_bytes(std::span<const Share> objects_by_material);
/// (2.5) sum over objects of M_cmd(material).
[[nodiscard]] std::uint64_t command_bytes(std::span<const Share> objects_by_material);
/// (2.6) sum over groups of max(M_sec, M_cmds(group)); `groups` are their command bytes.
[[nodiscard]] std::uint64_t grouped_command_bytes(std::span<const std::uint64_t> groups,
                                                  std::uint64_t secondary);
/// The same for so many buffers with so many draws in all. Unlike (2.6) a buffer's own part is not hidden
/// behind its draws: lavapipe takes M_sec for every buffer and M_cmd for every draw.
[[nodiscard]] double kept_command_bytes(double buffers, double draws, const UnitCosts& units);
/// (2.7) sum over materials of M_pipeline; several materials may share one.
[[nodiscard]] std::uint64_t pipeline_bytes(std::span<const Share> pipelines);
/// (2.8) |objects| M(object) + |materials| M(material).
[[nodiscard]] std::uint64_t instance_bytes(const Share& objects, const Share& materials);
/// (2.9) |H| M(node).
[[nodiscard]] std::uint64_t hierarchy_bytes(const Share& nodes);

}  // namespace scenegen::render::model
