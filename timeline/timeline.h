// The immutable runtime form of a scene's tracks. Compile once, play with any number of players
// (ozz-animation's split of raw animation, builder and sampling job).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "scene/result.h"
#include "scene/scene.h"

namespace scenegen::timeline {

/// H 2: static = always visible, never moves; pseudo-dynamic = appears, disappears or changes its look;
/// dynamic = moves.
enum class ObjectClass : std::uint8_t { constant, pseudo_dynamic, dynamic };

struct ClassCounts {
  std::uint64_t constant = 0, pseudo_dynamic = 0, dynamic = 0;
};

class Timeline;  // see timeline.cpp; immutable, shareable between threads

/// Scene must pass validate(). The timeline keeps no reference to the scene.
[[nodiscard]] std::shared_ptr<const Timeline> compile(const Scene& scene);

/// What one step changed, and nothing else: an object that was toggled twice is not in it. The spans point
/// into the player and hold until its next seek or advance. Object lists are free of duplicates and in
/// ascending order.
struct ChangeSet {
  double time_s = 0;
  std::span<const ObjectId> shown;        ///< visible now, not before
  std::span<const ObjectId> hidden;       ///< visible before, not now
  std::span<const ObjectId> moved;        ///< world_from_object differs
  std::span<const ObjectId> remeshed;     ///< shows another mesh (swapped look)
  std::span<const MaterialId> recolored;  ///< base_color or emissive differs
  [[nodiscard]] std::size_t count() const {
    return shown.size() + hidden.size() + moved.size() + remeshed.size() + recolored.size();
  }
};

}  // namespace scenegen::timeline
