// Comparing what meshes are made of: geometry, materials, textures, images, all by content.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "timeline/compare.h"

namespace scenegen::timeline {

/// One thing in which two meshes differ.
struct ContentFault {
  enum class Kind : std::uint8_t { primitive_count, geometry, material };
  Kind kind = Kind::geometry;
  std::uint32_t a = 0, b = 0;  ///< meshes, geometries or materials (kNone: the default material), by kind
};

/// Remembers every pair that it has looked at, so that shared content is compared once. Colours are not
/// looked at here: they can change with time.
class ContentComparer {
 public:
  ContentComparer(const Scene& a, const Scene& b, const CompareOptions& options)
      : a_(a), b_(b), options_(options) {}

  /// The reference holds until the next call.
  [[nodiscard]] const std::vector<ContentFault>& mesh_faults(MeshId a, MeshId b);
  /// Where mesh b is mesh a stretched along its axes and shifted (scene/axis_affine.h): b_from_a. That is no
  /// fault of the meshes; placements have to make up for it. Null: the same shape, or another one.
  struct Stretch {
    glm::mat4 b_from_a;
    bool rounded = false;  ///< known within the geometry tolerance only
  };
  [[nodiscard]] const Stretch* stretch(MeshId a, MeshId b);
  [[nodiscard]] std::string where(const ContentFault& fault) const;
  [[nodiscard]] std::string what(const ContentFault& fault) const;

 private:
  [[nodiscard]] std::string content_difference(const Geometry& a, const Geometry& b) const;
  [[nodiscard]] bool same_geometry(GeometryId a, GeometryId b);
  [[nodiscard]] bool same_material(MaterialId a, MaterialId b);
  [[nodiscard]] std::string material_difference(MaterialId a, MaterialId b) const;
  [[nodiscard]] std::string texture_difference(const TextureUse& a, const TextureUse& b) const;
  [[nodiscard]] bool close(float a, float b) const;

  const Scene& a_;
  const Scene& b_;
  CompareOptions options_;
  struct MeshPair {
    std::vector<ContentFault> faults;
    std::optional<Stretch> stretch;
  };
  MeshPair& mesh_pair(MeshId a, MeshId b);
  [[nodiscard]] std::optional<Stretch> find_stretch(const Mesh& a, const Mesh& b) const;
  [[nodiscard]] bool exact() const;

  std::unordered_map<std::uint64_t, MeshPair> mesh_pairs_;
  std::unordered_map<std::uint64_t, bool> geometry_pairs_, material_pairs_;
};

/// Key of a pair of ids in a hash map.
constexpr std::uint64_t pair_key(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::uint64_t>(a) << 32 | b;
}

/// The material itself, or glTF's default material for none.
[[nodiscard]] const Material& material_of(const Scene& scene, MaterialId id);

}  // namespace scenegen::timeline
