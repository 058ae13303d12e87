// Shapes of cranes and lorries: boxes, beams and cylinders in one geometry. Metres, Y up, without textures.
#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "scene/scene.h"

namespace scenegen::gen {

/// Puts simple solids together into one triangle list with normals.
class ShapeBuilder {
 public:
  void box(const glm::vec3& lo, const glm::vec3& hi);
  /// A square bar from `from` to `to`.
  void beam(const glm::vec3& from, const glm::vec3& to, float width);
  /// Round about an axis through `centre` along z (or y), closed at both ends.
  void cylinder(const glm::vec3& centre, float radius, float length, bool upright, std::uint32_t slices = 24);
  [[nodiscard]] Geometry take() { return std::move(geometry_); }

 private:
  /// Corner -1 … 1 along each axis: centre + x * corner.x + …
  void solid(const glm::vec3& centre, const glm::vec3& x, const glm::vec3& y, const glm::vec3& z);

  Geometry geometry_;
};

/// A tower crane, jib along +x. The upper works turn about y; their origin is the top of the mast.
/// `scale` multiplies every length but those given.
[[nodiscard]] Geometry crane_base(float scale);
/// One lattice section, 1.4 m wide, `height_m` high, foot at y = 0.
[[nodiscard]] Geometry crane_mast(float scale, float height_m);
[[nodiscard]] Geometry crane_head(float scale, float reach_m);  ///< turntable, tower head and ties
[[nodiscard]] Geometry crane_cab(float scale);
[[nodiscard]] Geometry crane_cab_glass(float scale);
[[nodiscard]] Geometry crane_jib(float scale, float reach_m);
[[nodiscard]] Geometry crane_counter_jib(float scale, float reach_m);
[[nodiscard]] Geometry crane_counterweight(float scale, float reach_m);
[[nodiscard]] Geometry crane_trolley(float scale);  ///< origin where the cable hangs from
[[nodiscard]] Geometry crane_cable(float scale);    ///< from y = 0 down to y = -1, to be stretched
[[nodiscard]] Geometry crane_hook(float scale);     ///< hangs from y = 0
constexpr float kCraneCounterReach = 0.36F;         ///< of the jib's reach
constexpr float kCraneTrolleyY = 0.72F;             ///< of the trolley's origin above the top of the mast
constexpr float kCraneHeadY = 5.6F;                 ///< of the highest point above the top of the mast

/// A lorry that drives along +x, its middle over the origin, on the ground y = 0.
[[nodiscard]] Geometry lorry_chassis(float scale);
[[nodiscard]] Geometry lorry_cab(float scale);
[[nodiscard]] Geometry lorry_glass(float scale);
[[nodiscard]] Geometry lorry_bed(float scale);
[[nodiscard]] Geometry lorry_load(float scale);
[[nodiscard]] Geometry lorry_tyre(float scale);  ///< about the origin, axle along z
[[nodiscard]] Geometry lorry_hub(float scale);
constexpr float kWheelRadius = 0.48F;
constexpr float kLorryLength = 6.7F, kLorryWidth = 2.4F;
constexpr float kWheelZ = 0.98F;
constexpr std::array<float, 3> kAxleX{2.35F, -1.2F, -2.35F};

}  // namespace scenegen::gen
