#include "gen/machine_shapes.h"

#include <array>
#include <cmath>

#include "gen/primitives.h"

namespace scenegen::gen {
namespace {

/// A builder whose lengths are all scaled.
class Scaled {
 public:
  explicit Scaled(float scale) : scale_(scale) {}
  void box(const glm::vec3& lo, const glm::vec3& hi) { shape_.box(scale_ * lo, scale_ * hi); }
  void beam(const glm::vec3& from, const glm::vec3& to, float width) {
    shape_.beam(scale_ * from, scale_ * to, scale_ * width);
  }
  void cylinder(const glm::vec3& centre, float radius, float length, bool upright) {
    shape_.cylinder(scale_ * centre, scale_ * radius, scale_ * length, upright);
  }
  Geometry take() { return shape_.take(); }

 private:
  float scale_;
  ShapeBuilder shape_;
};

constexpr float kJibY = 0.95F, kJibTopY = 2.05F, kJibHalfZ = 0.55F, kJibFrom = 0.75F;

/// Panels of a lattice as near to `wish` long as divides `length` evenly.
int panels(float length, float wish) {
  return std::max(2, static_cast<int>(std::lround(length / wish)));
}

}  // namespace

void ShapeBuilder::solid(const glm::vec3& centre, const glm::vec3& x, const glm::vec3& y,
                         const glm::vec3& z) {
  const std::array<glm::vec3, 3> axes{x, y, z};
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {1.0F, -1.0F}) {
      const glm::vec3 out = axes[static_cast<std::size_t>(axis)] * side;
      const glm::vec3 u = axes[static_cast<std::size_t>((axis + 1) % 3)];
      const glm::vec3 v = axes[static_cast<std::size_t>((axis + 2) % 3)] * side;
      const auto first = static_cast<std::uint32_t>(geometry_.positions_m.size());
      static constexpr std::array<std::array<float, 2>, 4> kCorners{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
      for (const auto& corner : kCorners) {
        geometry_.positions_m.push_back(centre + out + u * corner[0] + v * corner[1]);
        geometry_.normals.push_back(glm::normalize(out));
      }
      for (const std::uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U}) geometry_.indices.push_back(first + k);
    }
  }
}

void ShapeBuilder::box(const glm::vec3& lo, const glm::vec3& hi) {
  const glm::vec3 half = 0.5F * (hi - lo);
  solid(0.5F * (lo + hi), {half.x, 0, 0}, {0, half.y, 0}, {0, 0, half.z});
}

void ShapeBuilder::beam(const glm::vec3& from, const glm::vec3& to, float width) {
  const glm::vec3 along = 0.5F * (to - from);
  const glm::vec3 direction = glm::normalize(along);
  const glm::vec3 other = std::abs(direction.y) > 0.9F ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
  const glm::vec3 side = glm::normalize(glm::cross(other, direction));
  solid(0.5F * (from + to), along, 0.5F * width * side, 0.5F * width * glm::cross(direction, side));
}

void ShapeBuilder::cylinder(const glm::vec3& centre, float radius, float length, bool upright,
                            std::uint32_t slices) {
  const auto place = [&](float a, float b, float along) {
    return upright ? glm::vec3(a, along, -b) : glm::vec3(a, b, along);
  };
  const auto first = static_cast<std::uint32_t>(geometry_.positions_m.size());
  const float half = 0.5F * length;
  // Twice the two rims: for the side, and for the ends. Then the middles of the ends.
  for (std::uint32_t i = 0; i < slices; ++i) {
    const SineCosine turn = of_turn(i, slices);
    const auto c = static_cast<float>(turn.cosine), s = static_cast<float>(turn.sine);
    for (const float side : {1.0F, -1.0F}) {
      for (const bool of_end : {false, true}) {
        geometry_.positions_m.push_back(centre + place(radius * c, radius * s, side * half));
        geometry_.normals.push_back(of_end ? place(0, 0, side) : place(c, s, 0));
      }
    }
  }
  const auto middle = static_cast<std::uint32_t>(geometry_.positions_m.size());
  for (const float side : {1.0F, -1.0F}) {
    geometry_.positions_m.push_back(centre + place(0, 0, side * half));
    geometry_.normals.push_back(place(0, 0, side));
  }
  for (std::uint32_t i = 0; i < slices; ++i) {
    const std::uint32_t here = first + 4 * i, next = first + 4 * ((i + 1) % slices);
    for (const std::uint32_t v : {here, here + 2, next + 2, here, next + 2, next})
      geometry_.indices.push_back(v);
    for (const std::uint32_t v : {middle, here + 1, next + 1, middle + 1, next + 3, here + 3})
      geometry_.indices.push_back(v);
  }
}

// ---- Crane

Geometry crane_base(float scale) {
  Scaled s(scale);
  s.box({-1.3F, 0, -1.3F}, {1.3F, 0.45F, 1.3F});
  s.box({-0.95F, 0.45F, -0.95F}, {0.95F, 0.75F, 0.95F});
  return s.take();
}

Geometry crane_mast(float scale, float height_m) {
  Scaled s(scale);
  const float h = height_m / scale, w = 0.7F;
  for (const float x : {-w, w}) {
    for (const float z : {-w, w}) s.beam({x, 0, z}, {x, h, z}, 0.15F);
  }
  const std::array<glm::vec3, 4> corners{{{-w, 0, -w}, {w, 0, -w}, {w, 0, w}, {-w, 0, w}}};
  for (std::size_t i = 0; i < 4; ++i) {
    const glm::vec3 a = corners[i], b = corners[(i + 1) % 4];
    const glm::vec3 up(0, h, 0), middle(0, 0.5F * h, 0);
    s.beam(a, b, 0.09F);
    s.beam(a, b + middle, 0.07F);
    s.beam(b + middle, a + up, 0.07F);
  }
  return s.take();
}

Geometry crane_head(float scale, float reach_m) {
  Scaled s(scale);
  const float reach = reach_m / scale;
  s.cylinder({0, 0.15F, 0}, 0.95F, 0.3F, true);
  s.box({-1.0F, 0.3F, -0.75F}, {1.0F, 0.6F, 0.75F});
  const glm::vec3 top(-0.1F, kCraneHeadY - 0.1F, 0);
  const auto at = [&](float x, float z, float u) {
    return glm::mix(glm::vec3(x, 0.6F, z), top + glm::vec3(0, 0, 0.25F * z), u);
  };
  for (const float x : {-0.6F, 0.6F}) {
    for (const float z : {-0.55F, 0.55F}) s.beam(at(x, z, 0), at(x, z, 1), 0.13F);
    for (const float u : {0.3F, 0.55F, 0.78F}) s.beam(at(x, -0.55F, u), at(x, 0.55F, u), 0.08F);
  }
  for (const float z : {-0.55F, 0.55F}) {
    for (const float u : {0.3F, 0.55F, 0.78F}) s.beam(at(-0.6F, z, u), at(0.6F, z, u), 0.08F);
  }
  s.beam(top, {0.34F * reach, kJibTopY, 0}, 0.07F);
  s.beam(top, {0.72F * reach, kJibTopY, 0}, 0.07F);
  for (const float z : {-0.45F, 0.45F})
    s.beam(top, {0.9F - kCraneCounterReach * reach, kJibY + 0.1F, z}, 0.07F);
  return s.take();
}

Geometry crane_cab(float scale) {
  Scaled s(scale);
  s.box({0.2F, -1.1F, 0.85F}, {1.75F, -0.35F, 1.95F});
  s.box({0.2F, -0.35F, 0.85F}, {0.6F, 0.75F, 1.95F});
  s.box({0.15F, 0.75F, 0.8F}, {1.8F, 0.87F, 2.0F});
  s.box({-0.4F, 0.3F, 0.6F}, {0.6F, 0.5F, 1.2F});  // what it hangs from
  return s.take();
}

Geometry crane_cab_glass(float scale) {
  Scaled s(scale);
  s.box({0.6F, -0.35F, 0.87F}, {1.72F, 0.75F, 1.93F});
  return s.take();
}

Geometry crane_jib(float scale, float reach_m) {
  Scaled s(scale);
  const float to = reach_m / scale;
  for (const float z : {-kJibHalfZ, kJibHalfZ}) s.beam({kJibFrom, kJibY, z}, {to, kJibY, z}, 0.13F);
  const int count = panels(to - kJibFrom, 1.5F);
  const float step = (to - kJibFrom) / static_cast<float>(count);
  s.beam({kJibFrom + 0.5F * step, kJibTopY, 0}, {to - 0.5F * step, kJibTopY, 0}, 0.13F);
  for (int i = 0; i < count; ++i) {
    const float x = kJibFrom + step * static_cast<float>(i);
    const glm::vec3 top(x + 0.5F * step, kJibTopY, 0);
    s.beam({x, kJibY, -kJibHalfZ}, {x, kJibY, kJibHalfZ}, 0.07F);
    for (const float z : {-kJibHalfZ, kJibHalfZ}) {
      s.beam({x, kJibY, z}, top, 0.07F);
      s.beam(top, {x + step, kJibY, z}, 0.07F);
    }
  }
  s.box({to - 0.12F, kJibY - 0.12F, -kJibHalfZ - 0.07F}, {to + 0.06F, kJibY + 0.12F, kJibHalfZ + 0.07F});
  return s.take();
}

Geometry crane_counter_jib(float scale, float reach_m) {
  Scaled s(scale);
  const float to = -kCraneCounterReach * reach_m / scale;
  for (const float z : {-0.6F, 0.6F}) {
    s.box({to, kJibY - 0.15F, z - 0.08F}, {-0.7F, kJibY + 0.1F, z + 0.08F});
    s.beam({to + 0.1F, kJibY + 1.0F, z}, {-0.9F, kJibY + 1.0F, z}, 0.05F);  // handrail
    const int count = panels(-0.9F - to, 1.3F);
    for (int i = 0; i <= count; ++i) {
      const float x = glm::mix(to + 0.1F, -0.9F, static_cast<float>(i) / static_cast<float>(count));
      s.beam({x, kJibY, z}, {x, kJibY + 1.0F, z}, 0.05F);
    }
  }
  s.box({to, kJibY - 0.02F, -0.6F}, {-0.7F, kJibY + 0.05F, 0.6F});
  s.box({0.42F * to - 0.7F, kJibY + 0.05F, -0.4F}, {0.42F * to + 0.7F, kJibY + 0.85F, 0.4F});  // winch
  return s.take();
}

Geometry crane_counterweight(float scale, float reach_m) {
  Scaled s(scale);
  const float to = -kCraneCounterReach * reach_m / scale;
  for (int i = 0; i < 3; ++i) {
    const float x = to + 0.12F + 0.52F * static_cast<float>(i);
    s.box({x, kJibY - 1.5F, -0.5F}, {x + 0.48F, kJibY + 0.75F, 0.5F});
  }
  return s.take();
}

Geometry crane_trolley(float scale) {
  Scaled s(scale);
  s.box({-0.5F, 0.06F, -0.62F}, {0.5F, 0.16F, 0.62F});
  s.box({-0.3F, -0.1F, -0.3F}, {0.3F, 0.06F, 0.3F});
  for (const float x : {-0.38F, 0.38F}) {
    for (const float z : {-0.62F, 0.62F}) s.cylinder({x, 0.2F, z}, 0.11F, 0.1F, false);
  }
  return s.take();
}

Geometry crane_cable(float scale) {
  ShapeBuilder shape;
  const float half = 0.03F * scale;
  for (const float x : {-0.14F * scale, 0.14F * scale}) {
    shape.box({x - half, -1.0F, -half}, {x + half, 0.0F, half});
  }
  return shape.take();
}

Geometry crane_hook(float scale) {
  Scaled s(scale);
  s.box({-0.28F, -0.45F, -0.14F}, {0.28F, 0, 0.14F});
  s.box({-0.05F, -0.65F, -0.05F}, {0.05F, -0.45F, 0.05F});
  s.beam({0, -0.62F, 0}, {0.17F, -0.76F, 0}, 0.1F);
  s.beam({0.16F, -0.74F, 0}, {0.14F, -0.93F, 0}, 0.1F);
  s.beam({0.16F, -0.92F, 0}, {-0.06F, -1.02F, 0}, 0.1F);
  s.beam({-0.05F, -1.02F, 0}, {-0.17F, -0.86F, 0}, 0.1F);
  return s.take();
}

// ---- Lorry

Geometry lorry_chassis(float scale) {
  Scaled s(scale);
  for (const float z : {-0.42F, 0.42F}) s.box({-3.2F, 0.6F, z - 0.08F}, {3.1F, 0.86F, z + 0.08F});
  for (const float x : kAxleX) s.box({x - 0.08F, 0.4F, -0.95F}, {x + 0.08F, 0.56F, 0.95F});
  s.box({3.05F, 0.42F, -1.12F}, {3.3F, 0.78F, 1.12F});  // bumper
  s.box({0.2F, 0.42F, 0.5F}, {1.3F, 0.86F, 1.05F});     // tank
  s.box({0.5F, 0.5F, -1.0F}, {1.2F, 0.86F, -0.5F});
  s.box({1.48F, 0.86F, -0.95F}, {1.66F, 2.6F, -0.8F});  // exhaust
  s.box({-3.3F, 0.5F, -1.0F}, {-3.2F, 0.7F, 1.0F});
  for (const float z : {-1.0F, 1.0F}) {  // mudguards
    s.box({-3.0F, 1.0F, z - 0.17F}, {-0.6F, 1.05F, z + 0.17F});
  }
  return s.take();
}

Geometry lorry_cab(float scale) {
  Scaled s(scale);
  s.box({1.72F, 1.02F, -1.12F}, {3.2F, 1.62F, 1.12F});
  s.box({1.72F, 0.72F, -0.8F}, {3.2F, 1.02F, 0.8F});
  s.box({2.9F, 0.72F, -1.12F}, {3.2F, 1.02F, 1.12F});
  s.box({1.72F, 1.62F, -1.12F}, {2.0F, 2.45F, 1.12F});  // back wall
  s.box({1.72F, 2.45F, -1.12F}, {3.08F, 2.62F, 1.12F});
  for (const float z : {-1.08F, 1.08F}) {  // posts, mirrors
    s.beam({3.14F, 1.6F, z}, {3.0F, 2.47F, z}, 0.09F);
    s.box({2.95F, 1.75F, z - 0.05F + (z > 0 ? 0.15F : -0.15F)},
          {3.03F, 2.15F, z + 0.05F + (z > 0 ? 0.15F : -0.15F)});
  }
  return s.take();
}

Geometry lorry_glass(float scale) {
  Scaled s(scale);
  s.box({2.0F, 1.62F, -1.08F}, {3.02F, 2.45F, 1.08F});
  return s.take();
}

Geometry lorry_bed(float scale) {
  Scaled s(scale);
  s.box({-3.3F, 1.08F, -1.18F}, {1.4F, 1.2F, 1.18F});
  s.box({-3.3F, 1.2F, -1.18F}, {-3.22F, 1.8F, 1.18F});
  s.box({1.3F, 1.2F, -1.18F}, {1.4F, 2.35F, 1.18F});
  for (const float z : {-1.18F, 1.1F}) s.box({-3.22F, 1.2F, z}, {1.3F, 1.8F, z + 0.08F});
  for (const float z : {-1.24F, 1.18F}) {  // stakes
    for (const float x : {-3.2F, -2.1F, -1.0F, 0.1F, 1.2F}) s.box({x, 1.1F, z}, {x + 0.1F, 1.84F, z + 0.06F});
  }
  return s.take();
}

Geometry lorry_load(float scale) {
  Scaled s(scale);
  // Stacks of bricks on pallets.
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 2; ++j) {
      const glm::vec3 lo(-3.05F + 1.45F * static_cast<float>(i), 1.28F,
                         -1.0F + 1.05F * static_cast<float>(j));
      s.box(lo, lo + glm::vec3(1.25F, i == 1 ? 0.95F : 0.75F, 0.92F));
    }
  }
  return s.take();
}

Geometry lorry_tyre(float scale) {
  Scaled s(scale);
  s.cylinder({0, 0, 0}, kWheelRadius, 0.34F, false);
  return s.take();
}

Geometry lorry_hub(float scale) {
  Scaled s(scale);
  s.cylinder({0, 0, 0}, 0.25F, 0.37F, false);
  // Bolts, so that one sees it turn.
  for (std::uint64_t i = 0; i < 5; ++i) {
    const SineCosine turn = of_turn(i, 5);
    const glm::vec3 at(0.17F * static_cast<float>(turn.cosine), 0.17F * static_cast<float>(turn.sine), 0);
    s.box(at - glm::vec3(0.035F, 0.035F, 0.21F), at + glm::vec3(0.035F, 0.035F, 0.21F));
  }
  return s.take();
}

}  // namespace scenegen::gen
