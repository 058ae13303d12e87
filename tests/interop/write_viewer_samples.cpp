// write_viewer_samples FOLDER: one scene in every layout and visibility encoding, with looks that are swapped
// (grid_swap_LAYOUT_VISIBILITY.glb) and with colours that are pointed at (grid_pointer_...), for other
// people's viewers; and camera.json, which shows all of it. Objects stand apart on a grid, so that every
// pixel belongs to one of them; their names begin with what they ask of a viewer: visibility, motion, look
// (swapped materials), passing look (one that comes or goes), or color.
#include <array>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iostream>
#include <string>

#include "scene/gltf/write.h"
#include "scene/scene.h"

namespace {

using namespace scenegen;
using gltf::Layout;
using gltf::VisibilityEncoding;
using Keys = std::initializer_list<float>;

constexpr float kDurationS = 4.0F;
constexpr float kSpacingM = 2.0F;

/// Box of side 1 round the origin; front and back with normals, which is all that is seen.
Geometry box() {
  Geometry g;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0F, 1.0F}) {
      glm::vec3 normal(0.0F), u(0.0F), v(0.0F);
      normal[axis] = side;
      u[(axis + 1) % 3] = side;
      v[(axis + 2) % 3] = 1.0F;
      const auto first = static_cast<std::uint32_t>(g.positions_m.size());
      for (const glm::vec2& c : {glm::vec2{-1, -1}, glm::vec2{1, -1}, glm::vec2{1, 1}, glm::vec2{-1, 1}}) {
        g.positions_m.push_back(0.5F * (normal + c.x * u + c.y * v));
        g.normals.push_back(normal);
      }
      for (const std::uint32_t corner : {0U, 1U, 2U, 0U, 2U, 3U}) g.indices.push_back(first + corner);
    }
  }
  return g;
}

/// Builds the scene row by row, from the top.
class Grid {
 public:
  Grid() {
    scene_.geometries = {box()};
    scene_.duration_s = kDurationS;
    mesh("clay", {0.55F, 0.12F, 0.06F, 1});
    mesh("slate", {0.1F, 0.2F, 0.4F, 1});
    mesh("green", {0.05F, 0.6F, 0.1F, 1});
    mesh("red", {0.8F, 0.02F, 0.02F, 1});
  }

  MeshId mesh(const std::string& name, glm::vec4 color) {
    Material m;
    m.name = name;
    m.base_color = color;
    m.metallic = 0.0F;
    m.roughness = 1.0F;
    scene_.materials.push_back(m);
    scene_.meshes.push_back({name, {{GeometryId(0), MaterialId(scene_.materials.size() - 1)}}});
    return MeshId(scene_.meshes.size() - 1);
  }

  TrackId track(Property property, Interpolation interpolation, Keys times, Keys values) {
    return scene_.add_track(property, interpolation, {times.begin(), times.size()},
                            {values.begin(), values.size()});
  }
  TrackId visibility(Keys times, Keys values) {
    return track(Property::visibility, Interpolation::step, times, values);
  }

  /// The next place of the grid.
  glm::vec3 place() {
    const int row = next_ / 8, column = next_ % 8;
    const glm::vec3 at(kSpacingM * (static_cast<float>(column) - 3.5F),
                       kSpacingM * (2.0F - static_cast<float>(row)), 0.0F);
    ++next_;
    return at;
  }

  ObjectId still(const std::string& name, MeshId mesh_id, const glm::quat& rotation, glm::vec3 scale,
                 TrackId visible = {}) {
    const ObjectId id = scene_.objects.add(name, mesh_id, {place(), rotation, scale});
    scene_.objects.visibility[id.value] = visible;
    return id;
  }

  FrameId frame(const std::string& name, FrameId parent, glm::vec3 at) {
    Frame f;
    f.name = name;
    f.parent = parent;
    f.local.translation_m = at;
    scene_.frames.push_back(f);
    return FrameId(scene_.frames.size() - 1);
  }

  Scene& scene() { return scene_; }

 private:
  Scene scene_;
  int next_ = 0;
};

const glm::quat kUpright(1, 0, 0, 0);
const glm::quat kLeaning(0.92387953F, 0, 0, 0.38268343F);  // 45 degrees round z
constexpr glm::vec3 kCube(1.0F), kSlab(0.6F, 1.2F, 0.5F), kMirrored(-1.1F, 0.7F, 0.4F);

void add_visibility_rows(Grid& grid) {
  const std::array<TrackId, 4> tracks{grid.visibility({0, 1}, {0, 1}), grid.visibility({0, 2}, {0, 1}),
                                      grid.visibility({0, 2}, {1, 0}), grid.visibility({0, 1, 3}, {0, 1, 0})};
  const std::array<const char*, 4> names{"appears at 1", "appears at 2", "vanishes at 2", "there 1 to 3"};
  for (std::size_t i = 0; i < 8; ++i) {
    grid.still("visibility: " + std::string(names[i / 2]) + ", " + (i % 2 == 0 ? "left" : "right"), MeshId(0),
               kUpright, kCube, tracks[i / 2]);
  }
  for (std::size_t i = 0; i < 8; ++i) {  // with a scale of their own, which comes back
    grid.still("visibility: " + std::string(names[i / 2]) + (i % 2 == 0 ? ", leaning" : ", mirrored"),
               MeshId(1), kLeaning, i % 2 == 0 ? kSlab : kMirrored, tracks[i / 2]);
  }
  grid.still("visibility: always, left", MeshId(0), kUpright, kCube);
  grid.still("visibility: always, right", MeshId(0), kUpright, kSlab);
  const TrackId never = grid.visibility({0}, {0});
  grid.still("visibility: never, left", MeshId(0), kUpright, kCube, never);
  grid.still("visibility: never, right", MeshId(0), kUpright, kCube, never);
  const TrackId blinks = grid.visibility({0, 0.5F, 1, 1.5F, 2, 2.5F, 3, 3.5F}, {0, 1, 0, 1, 0, 1, 0, 1});
  grid.still("visibility: blinks, left", MeshId(1), kUpright, kCube, blinks);
  grid.still("visibility: blinks, right", MeshId(1), kUpright, kCube, blinks);
  const TrackId late = grid.visibility({0, 3.5F}, {0, 1});
  grid.still("visibility: late, left", MeshId(0), kUpright, kCube, late);
  grid.still("visibility: late, right", MeshId(0), kUpright, kCube, late);
}

/// Each object moves inside its own cell of the grid.
void add_motion_row(Grid& grid) {
  Scene& scene = grid.scene();
  const auto mover = [&](const std::string& name, glm::vec3 pivot, TrackId visible = {}) {
    const FrameId frame = grid.frame(name + " frame", {}, pivot);
    const ObjectId id = scene.objects.add((visible.valid() ? "visibility: " : "motion: ") + name, MeshId(1),
                                          {{}, kUpright, {0.8F, 0.8F, 0.4F}}, frame);
    scene.objects.visibility[id.value] = visible;
    return frame;
  };
  const auto drive = [&](FrameId frame, Property property, Interpolation interpolation, Keys times,
                         Keys values) {
    scene.frame_tracks.push_back({frame, grid.track(property, interpolation, times, values)});
  };
  const auto slide = [&](FrameId frame, Interpolation interpolation, glm::vec3 p) {
    drive(frame, Property::translation, interpolation, {0.5F, 2, 3.5F},
          {p.x - 0.5F, p.y, 0, p.x + 0.5F, p.y, 0, p.x, p.y - 0.5F, 0});
  };
  constexpr float kHalf = 0.70710678F;
  const Keys turn{0, 0, 0, 1, 0, 0, kHalf, kHalf};
  glm::vec3 p = grid.place();
  slide(mover("slides", p), Interpolation::linear, p);
  p = grid.place();
  slide(mover("jumps", p), Interpolation::step, p);
  p = grid.place();
  slide(mover("slides, there 1 to 3", p, grid.visibility({0, 1, 3}, {0, 1, 0})), Interpolation::linear, p);
  drive(mover("turns", grid.place()), Property::rotation, Interpolation::linear, {1, 3}, turn);
  drive(mover("turns at 2", grid.place()), Property::rotation, Interpolation::step, {0, 2}, turn);
  p = grid.place();
  drive(
      mover("swings", p), Property::translation, Interpolation::cubic_spline, {0, 2, 4},
      {0, 0, 0, p.x, p.y, 0, 0, 1, 0, 0, 1, 0, p.x, p.y + 0.4F, 0, 0, -1, 0, 0, -1, 0, p.x, p.y, 0, 0, 0, 0});
  drive(mover("grows", grid.place()), Property::scale, Interpolation::linear, {0.5F, 3},
        {0.4F, 0.4F, 0.4F, 1.2F, 1.2F, 1.2F});
  p = grid.place();
  const FrameId carriage = grid.frame("carriage", {}, p);
  slide(carriage, Interpolation::linear, p);
  const FrameId arm = grid.frame("arm", carriage, {});
  drive(arm, Property::rotation, Interpolation::linear, {1, 3}, turn);
  scene.objects.add("motion: rides and turns", MeshId(0), {{}, kUpright, {1.0F, 0.5F, 0.4F}}, arm);
}

/// Own look, green while it is built, red while it is taken down: other materials on the same geometry.
void add_look_row(Grid& grid) {
  Scene& scene = grid.scene();
  const TrackId built = grid.track(Property::mesh, Interpolation::step, {0, 2}, {2, 0});
  const TrackId taken = grid.track(Property::mesh, Interpolation::step, {0, 1, 3}, {1, 3, 1});
  const TrackId from_1 = grid.visibility({0, 1}, {0, 1}), until_3 = grid.visibility({0, 3}, {1, 0});
  const auto add = [&](const std::string& name, bool upright, TrackId visible, TrackId looks) {
    const ObjectId id =
        grid.still(name, MeshId(0), upright ? kUpright : kLeaning, upright ? kCube : kSlab, visible);
    scene.object_mesh_tracks.push_back({id, looks});
  };
  for (const bool upright : {true, false}) {
    const std::string how = upright ? "upright" : "leaning";
    add("look: green until 2, " + how, upright, {}, built);
    add("look: red 1 to 3, " + how, upright, {}, taken);
    add("passing look: constructed, " + how, upright, from_1, built);
    add("passing look: demolished, " + how, upright, until_3, taken);
  }
}

void add_color_row(Grid& grid) {
  const auto changing = [&](const std::string& name, Interpolation interpolation, Keys times, Keys values) {
    const MeshId mesh = grid.mesh(name, {0.05F, 0.6F, 0.1F, 1});
    grid.still("color: " + name, mesh, kUpright, kCube);
    grid.scene().material_tracks.push_back({MaterialId(grid.scene().materials.size() - 1),
                                            grid.track(Property::base_color, interpolation, times, values)});
  };
  const Keys colors{0.05F, 0.6F, 0.1F, 1, 0.8F, 0.02F, 0.02F, 1, 0.1F, 0.2F, 0.4F, 1};
  changing("fades", Interpolation::linear, {0.5F, 2, 3.5F}, colors);
  changing("switches", Interpolation::step, {0, 1, 3}, colors);
  changing("fades later", Interpolation::linear, {1, 2, 3}, colors);
  changing("switches later", Interpolation::step, {0, 2, 3}, colors);
}

bool write_all(const Scene& scene, const std::filesystem::path& folder, const std::string& name) {
  const std::pair<Layout, const char*> layouts[] = {{Layout::nodes, "nodes"},
                                                    {Layout::groups, "groups"},
                                                    {Layout::instances, "instances"},
                                                    {Layout::merged, "merged"}};
  const std::pair<VisibilityEncoding, const char*> encodings[] = {{VisibilityEncoding::scale, "scale"},
                                                                  {VisibilityEncoding::pointer, "pointer"},
                                                                  {VisibilityEncoding::both, "both"}};
  for (const auto& [layout, layout_name] : layouts) {
    for (const auto& [encoding, encoding_name] : encodings) {
      const std::filesystem::path path = folder / (name + "_" + layout_name + "_" + encoding_name + ".glb");
      const auto report = gltf::write(scene, path.string(), {layout, encoding, 1});
      if (!report) return std::cerr << "error: " << report.error().str() << '\n', false;
      if (report->layout != layout)
        return std::cerr << "error: " << path << ": written in another layout\n", false;
    }
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::cerr << "usage: write_viewer_samples FOLDER\n", 2;
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  Grid swap, pointer;
  for (Grid* grid : {&swap, &pointer}) {
    add_visibility_rows(*grid);
    add_motion_row(*grid);
  }
  add_look_row(swap);
  add_color_row(pointer);
  std::ofstream(folder / "camera.json")
      << R"({"keys": [{"time_s": 0, "eye_m": [0, 0, 40], "target_m": [0, 0, 0], "yfov_rad": 0.3}]})" << '\n';
  return write_all(swap.scene(), folder, "grid_swap") && write_all(pointer.scene(), folder, "grid_pointer")
             ? 0
             : 1;
}
