#include "timeline/keys.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace scenegen::timeline {

namespace {

// Beyond this cosine the chord and the arc differ by less than float32 can show (angle 1.4 mrad, angle^3 / 24
// = 1e-10) and sin(angle) loses digits.
constexpr double kNearlyEqual = 0.999999;

glm::vec4 to_vec4(const float* v, std::size_t count) {
  switch (count) {
    case 3:
      return {v[0], v[1], v[2], 0.0F};
    case 4:
      return {v[0], v[1], v[2], v[3]};
    default:
      return {v[0], 0.0F, 0.0F, 0.0F};
  }
}

glm::vec4 to_float(const std::array<double, 4>& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]),
          static_cast<float>(v[3])};
}

/// `fallback` stands in where there is no direction to keep (a cubic spline that passes through zero).
glm::vec4 normalised(const std::array<double, 4>& q, const glm::vec4& fallback) {
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(length > 0.0) || !std::isfinite(length)) return fallback;
  const double scale = 1.0 / length;
  return to_float({q[0] * scale, q[1] * scale, q[2] * scale, q[3] * scale});
}

glm::vec4 mix(const glm::vec4& a, const glm::vec4& b, double u) {
  const auto between = [u](float x, float y) { return static_cast<float>((1.0 - u) * x + u * y); };
  return {between(a.x, b.x), between(a.y, b.y), between(a.z, b.z), between(a.w, b.w)};
}

glm::vec4 slerp(const glm::vec4& a, const glm::vec4& b, double u) {
  double cosine = 0;
  for (int i = 0; i < 4; ++i) cosine += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  const double sign = cosine < 0 ? -1.0 : 1.0;
  cosine *= sign;
  double of_a = 1.0 - u;
  double of_b = u;
  if (cosine < kNearlyEqual) {
    const double angle = std::acos(cosine);
    of_a = std::sin(of_a * angle);  // both over sin(angle), which normalising takes out
    of_b = std::sin(of_b * angle);
  }
  std::array<double, 4> q{};
  for (int i = 0; i < 4; ++i) q[static_cast<std::size_t>(i)] = of_a * a[i] + sign * of_b * b[i];
  return normalised(q, a);
}

}  // namespace

std::span<const float> Keys::value(std::size_t k) const {
  const std::size_t w = components;
  return interpolation == Interpolation::cubic_spline ? values.subspan((k * 3 + 1) * w, w)
                                                      : values.subspan(k * w, w);
}

std::int32_t segment_at(std::span<const float> times_s, double time_s) {
  const auto after = std::upper_bound(times_s.begin(), times_s.end(), time_s,
                                      [](double t, float key) { return t < static_cast<double>(key); });
  return static_cast<std::int32_t>(after - times_s.begin()) - 1;
}

bool segment_changes(const Keys& keys, std::int32_t k) {
  if (k < 0 || k + 1 >= static_cast<std::int32_t>(keys.times_s.size())) return false;
  if (keys.interpolation == Interpolation::step) return false;
  const auto i = static_cast<std::size_t>(k);
  const auto a = keys.value(i);
  if (std::memcmp(a.data(), keys.value(i + 1).data(), a.size_bytes()) != 0) return true;
  if (keys.interpolation == Interpolation::linear) return false;
  const auto tangents = keys.values.subspan((i * 3 + 2) * a.size(), 2 * a.size());  // out of k, into k + 1
  return std::any_of(tangents.begin(), tangents.end(), [](float v) { return v != 0.0F; });
}

glm::vec4 key_value(const Keys& keys, std::int32_t segment) {
  const std::span<const float> v = keys.value(static_cast<std::size_t>(std::max(segment, 0)));
  return to_vec4(v.data(), v.size());
}

glm::vec4 interpolate(const Keys& keys, std::int32_t segment, double time_s) {
  const auto k = static_cast<std::size_t>(segment);
  const glm::vec4 a = key_value(keys, segment);
  const double begin_s = keys.times_s[k];
  const double length_s = keys.times_s[k + 1] - begin_s;
  const double u = (time_s - begin_s) / length_s;
  if (u == 0.0) return a;

  const glm::vec4 b = key_value(keys, segment + 1);
  const bool spherical = keys.property == Property::rotation;
  if (keys.interpolation == Interpolation::linear) return spherical ? slerp(a, b, u) : mix(a, b, u);
  const std::size_t w = keys.components;
  const float* const out_of_k = keys.values.data() + (k * 3 + 2) * w;
  const glm::vec4 tangent_out = to_vec4(out_of_k, w);
  const glm::vec4 tangent_in = to_vec4(out_of_k + w, w);
  const double u2 = u * u;
  const double u3 = u2 * u;
  std::array<double, 4> p{};
  for (int i = 0; i < 4; ++i) {
    p[static_cast<std::size_t>(i)] = (2 * u3 - 3 * u2 + 1) * a[i] +
                                     length_s * (u3 - 2 * u2 + u) * tangent_out[i] +
                                     (3 * u2 - 2 * u3) * b[i] + length_s * (u3 - u2) * tangent_in[i];
  }
  return spherical ? normalised(p, a) : to_float(p);
}

}  // namespace scenegen::timeline
