// What lists of slots and chunks give the device to do, as the model counts it: pure processor code.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "render/draw_scene.h"
#include "render/model/frame_time.h"
#include "render/model/prediction.h"
#include "render/spatial/octree.h"
#include "render/view.h"

namespace scenegen::render {

struct DrawList;

/// How many pixels boxes cover in a picture: (2.23), and its like for orthographic views.
class ScreenArea {
 public:
  ScreenArea(const View& view, glm::uvec2 size);
  /// `occupied`: 1 for an object, occupied_share() for a chunk or node. At most pixels().
  [[nodiscard]] double fragments(const Box& box, double occupied = 1.0) const;
  [[nodiscard]] double fragments(const Octree::Content& content) const;
  [[nodiscard]] double pixels() const { return screen_.width * screen_.height; }
  /// Where a box is seen, as a rectangle of the size and the proportions of its outline: seen from that side,
  /// not by its mean face as (2.23) has it. Boxes that reach round the eye are taken by (2.23).
  struct Spot {
    glm::dvec2 middle{0};  ///< pixels
    glm::dvec2 sides{0};   ///< pixels
    [[nodiscard]] double fragments() const { return sides.x * sides.y; }
  };
  [[nodiscard]] Spot spot(const Box& box) const;
  [[nodiscard]] glm::dvec2 size() const { return {screen_.width, screen_.height}; }

 private:
  model::Screen screen_;
  glm::dmat4 clip_from_world_{1};
  glm::dvec3 right_{1, 0, 0}, up_{0, 1, 0};
  double per_m_ = 0;   // perspective: pixels a metre, a metre away
  double per_m2_ = 0;  // orthographic: pixels a square metre
};

/// Slots looked at for one estimate; longer lists are sampled at equal steps and scaled.
constexpr std::size_t kSampledSlots = 512;
constexpr std::size_t kSampledWords = 128;

/// Of slots in order (either way). Draws are exact, vertices and triangles too where there are strata; the
/// rest by kSampledSlots.
[[nodiscard]] model::Load load_of_slots(const DrawScene& scene, std::span<const std::uint32_t> slots,
                                        const ScreenArea& screen);
/// Of solid slots that are visible by timeline and in the frustum, by a sample of about kSampledWords words
/// of slots (64 neighbours). Each of DrawScene::strata() is sampled by itself: a few heavy things among many
/// light ones are neither missed nor met too often. `scratch` holds memory from call to call.
[[nodiscard]] model::Load estimated_in_frustum(const DrawScene& scene, const CullPlanes& planes,
                                               const ScreenArea& screen, DrawList& scratch);
/// Of opaque and masked slots that are visible by timeline. O(slots / 64).
[[nodiscard]] model::Load load_of_visible(const DrawScene& scene, const ScreenArea& screen);
/// Draws, vertices and triangles are exact, the rest by kSampledSlots.
[[nodiscard]] model::Load load_of_chunks(const DrawScene& scene, const Octree& tree,
                                         std::span<const std::uint32_t> chunks, const ScreenArea& screen);
/// Of the slots of these chunks, those in the frustum: shares of the chunks' exact sums by a sample.
[[nodiscard]] model::Load load_in_frustum(const DrawScene& scene, const Octree& tree,
                                          std::span<const std::uint32_t> chunks, const CullPlanes& planes,
                                          const ScreenArea& screen);

/// What all ways of drawing know of the scene, but not FrameFacts::visible: who wants that looks at all of
/// it.
void add_scene_facts(const DrawScene& scene, const ScreenArea& screen, model::FrameFacts& facts);

}  // namespace scenegen::render
