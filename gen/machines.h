// Moving equipment: tower cranes that turn to where objects appear, and lorries that drive round blocks (the
// *dynamic* objects of paper H). Planned before the town is built, placed with it at rest, driven when the
// objects have their times.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gen/palette.h"
#include "scene/result.h"
#include "scene/scene.h"

namespace scenegen::gen {

struct Prediction;
struct TownRecipe;

struct CraneSite {
  glm::dvec2 at_m{0};  ///< author's frame
  double top_m = 0;    ///< of the mast
};

/// A rectangle with rounded corners in the middle of streets, author's frame.
struct LorryLoop {
  glm::dvec2 lo_m{0}, hi_m{0};
  double radius_m = 0;
  bool clockwise = false;
  std::uint32_t lorries = 0;

  [[nodiscard]] double straight_m() const { return hi_m.x - lo_m.x + hi_m.y - lo_m.y; }
};

/// Every third machine is a crane, beginning with the first. Cranes stand in streets between buildings where
/// no lorry drives, else outside the town; a jib reaches no other crane, and stays above every building.
struct MachinePlan {
  float scale = 1;
  float reach_m = 0;  ///< of all jibs
  float mast_section_m = 0;
  std::vector<CraneSite> cranes;
  std::vector<LorryLoop> loops;  ///< that lorries drive on

  [[nodiscard]] bool empty() const { return cranes.empty() && loops.empty(); }
  [[nodiscard]] std::uint32_t mast_sections(const CraneSite& crane) const;
};

/// `height_m` of the buildings. Errors (usage, --machines or --spacing): no room.
[[nodiscard]] Result<MachinePlan> plan_machines(const TownRecipe& recipe, std::uint32_t count,
                                                double height_m);
/// Objects and drawn vertices and triangles of what place_machines adds.
[[nodiscard]] Prediction predict(const MachinePlan& plan);
/// Box over all machines wherever they drive, with half of the jibs' reach; Y up. For the camera.
[[nodiscard]] Box bounds(const MachinePlan& plan);

/// What moves, in the scene.
struct Crane {
  glm::vec3 top_m{0};  ///< of the mast
  FrameId slew, trolley, cable, hook;
};
struct Lorry {
  FrameId body;
  std::array<FrameId, 3> axles;
  std::uint32_t loop = 0;
  double start = 0;  ///< share of the loop that lies behind it at t = 0
};
struct Machines {
  MachinePlan plan;
  std::vector<Crane> cranes;
  std::vector<Lorry> lorries;
};

/// Adds objects and frames: "crane_00/jib" on "crane_00/slew", "lorry_03/cab" on "lorry_03".
[[nodiscard]] Machines place_machines(Scene& scene, Palette& palette, const MachinePlan& plan);

/// Adds the tracks, over the scene's whole duration. Cranes look where things start (timeline ObjectStarts),
/// so the other objects must have their tracks.
void drive_machines(Scene& scene, const Machines& machines, unsigned threads);

}  // namespace scenegen::gen
