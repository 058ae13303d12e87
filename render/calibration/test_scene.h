// The scene that unit costs are measured on (D 2.5.4): one scene whose visibility timeline chooses among many
// small test scenes, so that one renderer measures them all.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "render/view.h"
#include "scene/scene.h"

namespace scenegen::render::calibration {

enum class Trial : std::uint8_t {
  empty,            ///< nothing
  boxes,            ///< `draws` boxes of less than a pixel, all in view (D: boxes in growing number)
  speck_boxes,      ///< `draws` boxes so small that they have no fragments
  textured_boxes,   ///< the same with textures: base colour and normals
  unshared_meshes,  ///< a triangle; spheres of `vertices` each whose triangles share none (D: growing
                    ///< batchSize)
  meshes,           ///< the same, sharing
  speck_meshes,     ///< these so small that hardly any triangle covers anything
  textured_meshes,  ///< `unshared_meshes` with textures
  layers,           ///< `layers` quads over `share` of the picture, every one in front of those before
  textured_layers,  ///< the same with textures
  piles,            ///< `draws` boxes over `share` of the picture, `layers` deep, in any order or in groups
  textured_piles,   ///< the same with textures
  hidden_boxes,     ///< a wall over the whole picture with `draws` boxes behind it
  halved_boxes,     ///< `draws` boxes, half of them beside the picture
  thinned_boxes,    ///< the most `boxes` without every kThinned-th; come to from them
  refilled_boxes,   ///< these again; come to from thinned_boxes
};

/// Of boxes that are taken away: one in each chunk or so.
constexpr std::uint32_t kThinned = 64;

/// A test scene: visible from `time_s` until the next one's.
struct Step {
  Trial trial = Trial::empty;
  std::uint32_t draws = 0;     ///< objects
  std::uint32_t vertices = 0;  ///< of each, drawn
  double layers = 0;
  double share = 0;  ///< of the picture that is covered
  double time_s = 0;
  std::uint32_t from = 0;  ///< step that it is come to from; 0: the empty one
};

/// One in kThinned boxes does.
[[nodiscard]] inline bool few_change(const Step& step) {
  return step.trial == Trial::thinned_boxes || step.trial == Trial::refilled_boxes;
}

struct TestScene {
  Scene scene;
  View view;
  std::vector<Step> steps;

  [[nodiscard]] double end_s() const { return static_cast<double>(steps.size()); }
};

struct TestSizes {
  std::vector<std::uint32_t> boxes;     ///< numbers of boxes, ascending
  std::vector<std::uint32_t> specks;    ///< numbers of speck_boxes, ascending from the middle one of `boxes`
  std::vector<std::uint32_t> vertices;  ///< of a mesh, ascending; about, spheres come in steps
  std::uint32_t mesh_vertices = 0;      ///< of all meshes of a step together
  std::vector<double> shares;           ///< of the picture, as D: 1, 3/4, 1/2, 1/4, 1/8, 1/16
  std::uint32_t layers = 4;
  std::vector<double> piles, textured_piles;  ///< in any order: how deep, ascending
  std::vector<double> grouped_piles;          ///< both, in groups of neighbours
};

/// What 2.5.4 and 4.2 ask for, for pictures of `size`. `quick`: fewer sizes.
[[nodiscard]] TestSizes test_sizes(bool software_device, bool quick);
/// `only_boxes`: the same steps, of which those of other things are empty: a smaller scene to set up.
enum class TestContents : std::uint8_t { all, only_boxes };
[[nodiscard]] TestScene make_test_scene(const TestSizes& sizes, glm::uvec2 size,
                                        TestContents contents = TestContents::all);

}  // namespace scenegen::render::calibration
