// What there is to draw, on the processor: slots, their boxes and the visible set, kept up to date from
// ChangeSets.
#pragma once

#include <compare>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/draw_geometry.h"
#include "render/draw_optimize.h"
#include "render/shaders/shared_types.h"
#include "render/spatial/slot_boxes.h"
#include "scene/held_bytes.h"
#include "scene/scene.h"
#include "timeline/player.h"

namespace scenegen::render {

/// Everything that decides which pipeline and descriptor set a draw needs. Ordered: opaque first, blended
/// last.
struct DrawState {
  AlphaMode alpha = AlphaMode::opaque;
  PrimitiveKind kind = PrimitiveKind::triangles;
  bool double_sided = false;
  std::uint32_t texture_set = 0;  ///< 0: no textures
  bool tangents = false;          ///< the geometry has them
  friend auto operator<=>(const DrawState&, const DrawState&) = default;
};

/// Where a geometry lies in the one vertex and index buffer.
struct GeometryRange {
  std::uint32_t first_index = 0;
  std::uint32_t index_count = 0;
  std::int32_t vertex_offset = 0;
  PrimitiveKind kind = PrimitiveKind::triangles;
};

/// A primitive of a mesh, ready to draw.
struct DrawPrimitive {
  GeometryId geometry;
  MaterialId material;
  MeshId mesh;
  std::uint32_t batch = 0;
  DrawWork work;
  Box bounds_m;  ///< in the mesh's coordinates
};

/// Slots [first, end) share a state.
struct Batch {
  DrawState state;
  std::uint32_t first = 0;
  std::uint32_t end = 0;
};

/// Solid slots [first, end) that take the same: a sample is taken of each such part.
struct Stratum {
  std::uint32_t first = 0;
  std::uint32_t end = 0;
  DrawWork work;
  bool textured = false;
};

/// One bit a slot, 64 slots a word.
class BitSet {
 public:
  explicit BitSet(std::size_t bits = 0) : words_((bits + 63) / 64) {}
  void set(std::size_t i) { words_[i / 64] |= std::uint64_t{1} << (i % 64); }
  void reset(std::size_t i) { words_[i / 64] &= ~(std::uint64_t{1} << (i % 64)); }
  [[nodiscard]] bool test(std::size_t i) const { return ((words_[i / 64] >> (i % 64)) & 1U) != 0; }
  [[nodiscard]] std::span<const std::uint64_t> words() const { return words_; }
  [[nodiscard]] std::uint64_t memory_bytes() const { return held_bytes(words_); }

 private:
  std::vector<std::uint64_t> words_;
};

/// A *slot* is one draw: one primitive of one mesh that an object shows (or may show later, when a track
/// swaps its mesh). Slots are sorted once by state, geometry and object, so that walking the visible bits in
/// order gives draws in a good order without sorting, the same order for every strategy; `firstInstance` of a
/// draw is its slot, which indexes the object array on the device. Costs 32 B a slot and 9 B an object here,
/// 64 B a slot on the device.
class DrawScene {
 public:
  /// `texture_set_of_material` has one entry per material and one more for glTF's default material. Takes the
  /// state of `player`, whatever its time.
  DrawScene(const Scene& scene, const timeline::Player& player,
            std::span<const std::uint32_t> texture_set_of_material);

  /// What drawing each geometry takes, once that is known; until then by what the scene says of it.
  void set_work(std::span<const DrawWork> of_geometry);

  /// Brings visible set, boxes and records up to the player's state. O(changes), and O(objects that ever
  /// move) when one of them did.
  void apply(const timeline::ChangeSet& changes, const timeline::Player& player);

  [[nodiscard]] std::size_t object_count() const { return visible_object_.size(); }
  [[nodiscard]] std::size_t visible_object_count() const { return visible_objects_; }
  [[nodiscard]] std::size_t slot_count() const { return object_of_slot_.size(); }
  [[nodiscard]] std::span<const Batch> batches() const { return batches_; }
  [[nodiscard]] const DrawPrimitive& primitive(std::uint32_t slot) const {
    return primitives_[primitive_of_slot_[slot]];
  }
  [[nodiscard]] ObjectId object(std::uint32_t slot) const { return ObjectId(object_of_slot_[slot]); }
  /// Ascending only within a mesh.
  [[nodiscard]] std::span<const std::uint32_t> slots_of(ObjectId id) const;
  /// Opaque and masked slots stand before this one, blended ones from here on.
  [[nodiscard]] std::uint32_t solid_end() const { return solid_end_; }
  [[nodiscard]] const BitSet& visible() const { return visible_; }
  [[nodiscard]] const SlotBoxes& boxes() const { return boxes_; }
  /// Its transform turns the object inside out: front faces wind the other way.
  [[nodiscard]] bool mirrored(std::uint32_t slot) const { return mirrored_.test(slot); }
  [[nodiscard]] const BitSet& mirrored_slots() const { return mirrored_; }
  /// The few solid slots that are much larger than most: ground, streets. Ascending; a sample of others says
  /// nothing of them. By their boxes at the first moment.
  [[nodiscard]] std::span<const std::uint32_t> large_slots() const { return large_slots_; }
  [[nodiscard]] bool large(std::uint32_t slot) const;
  /// All solid slots, in order. None, where there would be more than kMostStrata: many different geometries.
  [[nodiscard]] std::span<const Stratum> strata() const { return strata_; }
  static constexpr std::size_t kMostStrata = 64;
  /// Box round everything where it is now, hidden or not: what shadows must reach. Like all state here it
  /// depends on the time alone, not on the frames drawn before, so that a picture does not either.
  [[nodiscard]] const Box& bounds_m() const { return bounds_m_; }

  /// Records for the device of all slots, in slot order; used once.
  [[nodiscard]] std::vector<ObjectRecord> all_records(const timeline::Player& player) const;
  /// Slots whose record changed since the last clear_dirty(), ascending, with their new records.
  [[nodiscard]] std::span<const std::uint32_t> dirty_slots() const { return dirty_slots_; }
  [[nodiscard]] std::span<const ObjectRecord> dirty_records() const { return dirty_records_; }
  void clear_dirty();

  /// Host memory held.
  [[nodiscard]] std::uint64_t memory_bytes() const;

 private:
  void build_primitives(const Scene& scene, std::span<const std::uint32_t> texture_set_of_material);
  void build_slots(const Scene& scene);
  void find_large_slots();
  void find_strata();
  void place(ObjectId id, const glm::mat4& world_from_object);
  void refresh_visibility(ObjectId id, const timeline::Player& player);
  void add_boxes_of(ObjectId id, Box& bounds_m) const;
  void refresh_bounds();
  [[nodiscard]] ObjectRecord record(std::uint32_t slot, const glm::mat4& world_from_object) const;

  std::vector<DrawPrimitive> primitives_;  // in draw order
  std::vector<std::vector<std::uint32_t>> primitives_of_mesh_;
  std::vector<Batch> batches_;
  std::vector<std::uint32_t> primitive_of_slot_;
  std::vector<std::uint32_t> object_of_slot_;
  std::vector<std::uint32_t> first_slot_of_object_;  // into slots_by_object_; one more than objects
  std::vector<std::uint32_t> slots_by_object_;
  std::vector<std::uint32_t> large_slots_;
  std::vector<Stratum> strata_;
  SlotBoxes boxes_;
  BitSet visible_;
  BitSet mirrored_;
  std::vector<std::uint8_t> visible_object_;
  std::size_t visible_objects_ = 0;
  std::uint32_t default_material_ = 0;
  std::uint32_t solid_end_ = 0;
  std::vector<ObjectId> moving_objects_;
  Box resting_bounds_m_;  // of the objects that never move
  Box bounds_m_;
  std::vector<std::uint32_t> dirty_slots_;
  std::vector<ObjectRecord> dirty_records_;
};

}  // namespace scenegen::render
