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
  friend bool operator==(const ClassCounts&, const ClassCounts&) = default;
};

struct TimelineData;  // timeline/timeline_data.h: what players walk; not for other rooms

/// Events in order of time and what they fan out to; immutable, shareable between threads. About 54 B an
/// object, 4 B more if anything moves, and 8 B an event.
class Timeline {
 public:
  explicit Timeline(std::unique_ptr<const TimelineData> data);
  ~Timeline();
  Timeline(const Timeline&) = delete;
  Timeline& operator=(const Timeline&) = delete;

  [[nodiscard]] double duration_s() const;
  [[nodiscard]] std::size_t object_count() const;
  [[nodiscard]] std::size_t material_count() const;
  [[nodiscard]] std::size_t camera_count() const;

  /// "Changes its look" = its mesh is swapped, or a material that one of its meshes uses changes colour. An
  /// object that is hidden all the time is pseudo-dynamic (it is not always visible).
  [[nodiscard]] ObjectClass object_class(ObjectId id) const;
  [[nodiscard]] const ClassCounts& class_counts() const;
  /// Objects of class dynamic, ascending.
  [[nodiscard]] std::span<const ObjectId> moving_objects() const;

  /// Distinct times at which anything switches, or begins or ends to move; ascending. Keys that change
  /// nothing are not among them.
  [[nodiscard]] std::span<const float> event_times_s() const;
  /// Distinct times at which the visibility of some object changes, and how many objects change at each.
  [[nodiscard]] std::span<const float> visibility_times_s() const;
  [[nodiscard]] std::span<const std::uint64_t> visibility_changes() const;

  [[nodiscard]] const TimelineData& data() const { return *data_; }
  /// Host memory held.
  [[nodiscard]] std::uint64_t memory_bytes() const;

 private:
  std::unique_ptr<const TimelineData> data_;
};

/// Scene must pass validate(). The timeline keeps no reference to the scene. O(objects + keys).
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
