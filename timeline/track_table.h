// Upkeep of a scene's table of tracks.
#pragma once

#include <optional>

#include "scene/scene.h"

namespace scenegen::timeline {

/// Makes every object always visible: forgets all visibility tracks, drops them from the table with the keys
/// that no other track uses, and renumbers what names the tracks that stay.
void remove_visibility_tracks(Scene& scene);

/// When the object is first visible: none if never; 0 if it is visible before its first key (also without a
/// visibility track).
[[nodiscard]] std::optional<float> first_appearance_s(const Scene& scene, ObjectId object);

}  // namespace scenegen::timeline
