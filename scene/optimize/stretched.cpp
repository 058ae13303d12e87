#include <algorithm>

#include "scene/axis_affine.h"
#include "scene/optimize/equal.h"
#include "scene/optimize/steps.h"

namespace scenegen::optimizing {

namespace {

/// Shapes that share everything but positions, say tiles of a terrain, are tried against this many others.
constexpr std::size_t kMostCandidates = 64;

/// The same for all meshes that may be stretched copies of each other.
std::uint64_t signature(const Scene& scene, const Mesh& mesh) {
  ContentHash hash;
  for (const Primitive& p : mesh.primitives) {
    const Geometry& g = scene.geometries[p.geometry.value];
    hash.mix(std::uint64_t{p.material.value} << 8 | static_cast<std::uint64_t>(g.topology));
    hash.mix(g.positions_m.size());
    hash.add(g.indices);
    hash.add(g.normals);
    hash.add(g.texcoords[0]);
  }
  return hash.value();
}

bool same_materials(const Mesh& a, const Mesh& b) {
  return std::equal(a.primitives.begin(), a.primitives.end(), b.primitives.begin(), b.primitives.end(),
                    [](const Primitive& x, const Primitive& y) { return x.material == y.material; });
}

/// frame_from_object * affine: stretching comes first, so that it is a translation, rotation and scale again.
Transform stretched(const Transform& t, const AxisAffine& affine) {
  Transform out = t;
  const glm::dvec3 offset = glm::dvec3(t.scale) * glm::dvec3(affine.offset_m);
  const glm::dquat rotation(t.rotation.w, t.rotation.x, t.rotation.y, t.rotation.z);
  out.translation_m = glm::vec3(glm::dvec3(t.translation_m) + rotation * offset);
  out.scale = glm::vec3(glm::dvec3(t.scale) * glm::dvec3(affine.scale));
  return out;
}

struct Copy {
  std::uint32_t of = kNone;  ///< mesh that it is a stretched copy of
  AxisAffine affine;
};

std::vector<Copy> find_copies(const Scene& scene, const std::vector<std::uint8_t>& candidate) {
  std::vector<Copy> copies(scene.meshes.size());
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> shapes;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    if (candidate[m] == 0) continue;
    std::vector<std::uint32_t>& known = shapes[signature(scene, scene.meshes[m])];
    for (const std::uint32_t shape : known) {
      if (!same_materials(scene.meshes[shape], scene.meshes[m])) continue;
      if (const auto affine = axis_affine(scene, scene.meshes[shape], scene, scene.meshes[m])) {
        copies[m] = {shape, *affine};
        break;
      }
    }
    if (copies[m].of == kNone && known.size() < kMostCandidates) known.push_back(m);
  }
  return copies;
}

}  // namespace

void join_stretched_meshes(Scene& scene, OptimizeReport& report) {
  // An object with looks has one placement for all of them, so its meshes stay as they are.
  std::vector<std::uint8_t> has_looks(scene.objects.size(), 0), candidate(scene.meshes.size(), 0);
  for (const ObjectMeshTrack& t : scene.object_mesh_tracks) has_looks[t.object.value] = 1;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (has_looks[i] == 0) candidate[scene.objects.mesh[i].value] = 1;
  }
  const std::vector<Copy> copies = find_copies(scene, candidate);
  report.stretched_meshes += static_cast<std::uint64_t>(
      std::count_if(copies.begin(), copies.end(), [](const Copy& c) { return c.of != kNone; }));
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Copy& copy = copies[scene.objects.mesh[i].value];
    if (has_looks[i] != 0 || copy.of == kNone) continue;
    scene.objects.frame_from_object[i] = stretched(scene.objects.frame_from_object[i], copy.affine);
    scene.objects.mesh[i] = MeshId(copy.of);
    ++report.stretched_objects;
  }
}

}  // namespace scenegen::optimizing
