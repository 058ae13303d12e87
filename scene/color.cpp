#include "scene/color.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace scenegen {
namespace {

/// a^(1/5) for a in (0, 1], by Newton's method from above: std::pow may differ in its last bit.
double fifth_root(double a) {
  double x = 1.0;
  for (int i = 0; i < 60; ++i) x -= (x - a / (x * x * x * x)) / 5.0;
  return x;
}

const std::array<float, 256>& linear_values() {
  static const std::array<float, 256> values = [] {
    std::array<float, 256> out{};
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double encoded = static_cast<double>(i) / 255.0;
      const double v = (encoded + 0.055) / 1.055;
      out[i] = static_cast<float>(encoded <= 0.04045 ? encoded / 12.92 : v * v * fifth_root(v * v));
    }
    return out;
  }();
  return values;
}

int digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

float linear_from_srgb(std::uint8_t value) {
  return linear_values()[value];
}

std::uint8_t srgb_from_linear(float linear) {
  const std::array<float, 256>& values = linear_values();
  const auto above = std::lower_bound(values.begin(), values.end(), linear);
  if (above == values.begin()) return 0;
  if (above == values.end()) return 255;
  const auto i = above - values.begin();
  return static_cast<std::uint8_t>(*above - linear < linear - *(above - 1) ? i : i - 1);
}

Result<glm::vec4> parse_color(std::string_view text) {
  const auto wrong = [&] {
    return fail(ErrorKind::usage, "", "'" + std::string(text) + "' is not a color like #40b060");
  };
  if ((text.size() != 7 && text.size() != 9) || text[0] != '#') return wrong();
  glm::vec4 color(1.0F);
  for (std::size_t i = 1; i < text.size(); i += 2) {
    const int high = digit(text[i]), low = digit(text[i + 1]);
    if (high < 0 || low < 0) return wrong();
    const auto byte = static_cast<std::uint8_t>(16 * high + low);
    const auto component = static_cast<int>(i / 2);
    color[component] = component == 3 ? static_cast<float>(byte) / 255.0F : linear_from_srgb(byte);
  }
  return color;
}

std::string spell_color(const glm::vec4& linear) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out = "#";
  const auto add = [&](std::uint8_t byte) {
    out += kDigits[byte >> 4];
    out += kDigits[byte & 15];
  };
  for (int i = 0; i < 3; ++i) add(srgb_from_linear(linear[i]));
  const float alpha = std::clamp(linear.w, 0.0F, 1.0F);
  if (alpha < 1.0F) add(static_cast<std::uint8_t>(std::lround(alpha * 255.0F)));
  return out;
}

}  // namespace scenegen
