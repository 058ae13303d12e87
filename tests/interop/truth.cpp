// truth FILE TIME_S...: what our player says of a file, as JSON on stdout: names of the objects, and at every
// time, of each visible one, the linear base colour (null where a texture or transparency makes it another)
// and the matrix that puts it into the world, column by column. Before that, the mesh of each object and the
// vertices of each mesh.
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "scene/gltf/read.h"
#include "timeline/player.h"

namespace {

using namespace scenegen;

nlohmann::json color_of(const Scene& scene, const timeline::Player& player, ObjectId id) {
  const Mesh& mesh = scene.meshes[player.mesh(id).value];
  const MaterialId material = mesh.primitives.empty() ? MaterialId() : mesh.primitives.front().material;
  if (mesh.primitives.size() != 1 || !material.valid()) return nullptr;
  const Material& m = scene.materials[material.value];
  if (m.base_color_texture.texture.valid() || m.alpha_mode != AlphaMode::opaque || m.metallic > 0.0F)
    return nullptr;
  const glm::vec4 color = player.base_color(material);
  return {color.x, color.y, color.z};
}

nlohmann::json matrix_of(const timeline::Player& player, ObjectId id) {
  const glm::mat4 world_from_object = player.world_from_object(id);
  nlohmann::json out = nlohmann::json::array();
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) out.push_back(world_from_object[column][row]);
  }
  return out;
}

nlohmann::json vertices_of(const Scene& scene, const Mesh& mesh) {
  nlohmann::json out = nlohmann::json::array();
  for (const Primitive& primitive : mesh.primitives) {
    for (const glm::vec3& p : scene.geometries[primitive.geometry.value].positions_m)
      out.push_back({p.x, p.y, p.z});
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return std::cerr << "usage: truth FILE TIME_S...\n", 2;
  const auto file = gltf::read(argv[1]);
  if (!file) return std::cerr << "error: " << file.error().str() << '\n', 1;
  const Scene& scene = file->scene;
  timeline::Player player(timeline::compile(scene));
  nlohmann::json out;
  out["duration_s"] = scene.duration_s;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    out["objects"].push_back(std::string(scene.objects.names[i]));
    out["meshes"].push_back(scene.objects.mesh[i].value);
  }
  for (const Mesh& mesh : scene.meshes) out["vertices"].push_back(vertices_of(scene, mesh));
  for (int i = 2; i < argc; ++i) {
    const double time_s = std::atof(argv[i]);
    player.seek(time_s);
    nlohmann::json colors = nlohmann::json::object(), matrices = nlohmann::json::object();
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
      if (!player.visible(ObjectId(o))) continue;
      colors[std::to_string(o)] = color_of(scene, player, ObjectId(o));
      matrices[std::to_string(o)] = matrix_of(player, ObjectId(o));
    }
    out["frames"].push_back({{"time_s", time_s}, {"colors", colors}, {"matrices", matrices}});
  }
  std::cout << out << '\n';
  return 0;
}
