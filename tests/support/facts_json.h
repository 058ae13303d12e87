// What the model is told of a frame, as JSON: for programs that measure it, and for tests that read what they
// wrote.
#pragma once

#include <nlohmann/json.hpp>

#include "render/model/prediction.h"

namespace scenegen::test {

/// All counts; which of them are exact is left out.
[[nodiscard]] nlohmann::ordered_json facts_json(const render::model::FrameFacts& facts);
/// Throws nlohmann::json::exception, with its name, when a count is missing or no number.
[[nodiscard]] render::model::FrameFacts facts_from_json(const nlohmann::ordered_json& json);

}  // namespace scenegen::test
