// Materials of generated scenes, and the meshes (one geometry x one material) made of them, added to the
// scene when first used.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>

#include "gen/layout.h"
#include "scene/scene.h"

namespace scenegen::gen {

enum class Look : std::uint8_t {
  brick_red,
  brick_dark,
  brick_pale,
  plaster,
  stone,
  paint,
  glass,
  door,
  tile_red,
  tile_brown,
  gravel,
  pavement,
  street,
  grass,
  cargo,
  crane_yellow,
  lorry_red,
  lorry_blue,
  steel,
  rubber,
  cab_glass,  ///< of machines: dark and not see-through, there is nobody inside
};
constexpr std::size_t kLooks = 21;

/// What a part of a kind is made of; bricks and tiles have several looks, of which this is the first.
[[nodiscard]] Look look_of(PartKind kind);

class Palette {
 public:
  Palette(Scene& scene, Geometry box, const glm::ivec3& brick_mm);

  /// Mesh of the unit box (or of `geometry`) in a look.
  MeshId box(Look look);
  MeshId mesh(GeometryId geometry, Look look, const char* name);
  /// Mesh of several geometries, each in its look.
  MeshId mesh(std::span<const std::pair<GeometryId, Look>> parts, const char* name);
  /// A unit box of its own for ground and streets: scaled to `size_m` the noise texture repeats every
  /// `repeat_m`. The tiling is in the texture coordinates: not every viewer knows KHR_texture_transform.
  MeshId ground(Look look, const glm::dvec3& size_m, double repeat_m);

 private:
  MaterialId material(Look look);
  TextureId texture(Image image, int wrap);
  void add_brick_textures();

  Scene& scene_;
  glm::ivec3 brick_mm_;
  GeometryId box_;
  std::array<MaterialId, kLooks> materials_;
  std::array<MeshId, kLooks> boxes_;
  TextureId brick_color_, brick_normal_, noise_;
};

}  // namespace scenegen::gen
