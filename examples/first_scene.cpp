// Builds a dynamic scene by hand: ten boxes, each appearing 0.5 s after the one before, written as glTF.
//   first_scene OUT.glb
#include <array>
#include <cstdio>
#include <string>

#include "scene/gltf/write.h"
#include "scene/scene.h"
#include "scene/validate.h"

namespace {

/// A unit box, unindexed, so that every face has its own normals.
scenegen::Geometry unit_box() {
  scenegen::Geometry box;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const float side = face % 2 == 0 ? -0.5F : 0.5F;
    glm::vec3 normal(0.0F);
    normal[axis] = side < 0.0F ? -1.0F : 1.0F;
    // Corners of two triangles, counter-clockwise seen from outside.
    constexpr std::array<std::array<float, 2>, 6> kCorners{
        {{-0.5F, -0.5F}, {0.5F, -0.5F}, {0.5F, 0.5F}, {-0.5F, -0.5F}, {0.5F, 0.5F}, {-0.5F, 0.5F}}};
    for (const auto& corner : kCorners) {
      glm::vec3 p;
      p[axis] = side;
      p[(axis + 1) % 3] = side < 0.0F ? -corner[0] : corner[0];
      p[(axis + 2) % 3] = corner[1];
      box.positions_m.push_back(p);
      box.normals.push_back(normal);
    }
  }
  return box;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: first_scene OUT.glb\n"), 2;

  scenegen::Scene scene;
  scene.geometries.push_back(unit_box());
  scenegen::Material& clay = scene.materials.emplace_back();
  clay.name = "clay";
  clay.base_color = {0.7F, 0.3F, 0.2F, 1.0F};
  clay.metallic = 0.0F;
  scene.meshes.push_back({"box", {{scenegen::GeometryId(0), scenegen::MaterialId(0)}}});

  for (int i = 0; i < 10; ++i) {
    const float appears_s = 0.5F * static_cast<float>(i + 1);
    const scenegen::ObjectId box =
        scene.objects.add("box_" + std::to_string(i), scenegen::MeshId(0),
                          scenegen::Transform{.translation_m = {1.5F * static_cast<float>(i), 0.5F, 0.0F}});
    scene.objects.visibility[box.value] =
        scene.add_track(scenegen::Property::visibility, scenegen::Interpolation::step,
                        std::array{0.0F, appears_s}, std::array{0.0F, 1.0F});
    scene.duration_s = appears_s + 1.0F;
  }

  for (const scenegen::Finding& finding : scenegen::validate(scene)) {
    return std::fprintf(stderr, "%s: %s\n", finding.where.c_str(), finding.what.c_str()), 1;
  }
  const auto written = scenegen::gltf::write(scene, argv[1], {});
  if (!written) return std::fprintf(stderr, "error: %s\n", written.error().str().c_str()), 3;
  std::printf("%s: %llu bytes\n", argv[1], static_cast<unsigned long long>(written->bytes));
  return 0;
}
