// Colours as people write them (sRGB, "#rrggbb") and as scenes hold them (linear).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <string_view>

#include "scene/result.h"

namespace scenegen {

/// IEC 61966-2-1, by arithmetic that gives the same bits with every library.
[[nodiscard]] float linear_from_srgb(std::uint8_t value);
/// The byte whose linear value is nearest.
[[nodiscard]] std::uint8_t srgb_from_linear(float linear);

/// "#rrggbb" or "#rrggbbaa" (any case) to linear RGBA; alpha is not encoded. The error's `where` is empty.
[[nodiscard]] Result<glm::vec4> parse_color(std::string_view text);
/// "#rrggbb", with "aa" behind it unless alpha is 1.
[[nodiscard]] std::string spell_color(const glm::vec4& linear);

}  // namespace scenegen
