#include "scene/append.h"

#include <string>

namespace scenegen {
namespace {

template <class Tag>
Id<Tag> moved(Id<Tag> id, std::size_t by) {
  return id.valid() ? Id<Tag>(id.value + by) : id;
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

Appended append_resources(Scene& into, const Scene& from) {
  const std::size_t geometries = into.geometries.size(), images = into.images.size();
  const std::size_t textures = into.textures.size(), materials = into.materials.size(),
                    meshes = into.meshes.size();
  append(into.geometries, from.geometries);
  append(into.images, from.images);
  append(into.textures, from.textures);
  append(into.materials, from.materials);
  append(into.meshes, from.meshes);
  for (std::size_t i = textures; i < into.textures.size(); ++i)
    into.textures[i].image = moved(into.textures[i].image, images);
  for (std::size_t i = materials; i < into.materials.size(); ++i) {
    Material& m = into.materials[i];
    for (TextureUse* use : {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture,
                            &m.occlusion_texture, &m.emissive_texture}) {
      use->texture = moved(use->texture, textures);
    }
  }
  for (std::size_t i = meshes; i < into.meshes.size(); ++i) {
    for (Primitive& p : into.meshes[i].primitives) {
      p.geometry = moved(p.geometry, geometries);
      p.material = moved(p.material, materials);
    }
  }
  return {static_cast<std::uint32_t>(meshes)};
}

void append_objects(Scene& into, const Scene& from, Appended resources, const Transform& world_from_scene,
                    std::string_view prefix) {
  const std::vector<glm::mat4> frames = rest_frame_matrices(from);
  const glm::mat4 place = world_from_scene.matrix();
  std::string name;
  for (std::size_t i = 0; i < from.objects.size(); ++i) {
    const glm::mat4 world = place * rest_world_from_object(from, frames, ObjectId(i));
    name.assign(prefix).append(from.objects.names[i]);
    const MeshId mesh = moved(from.objects.mesh[i], resources.first_mesh);
    Transform flat;
    if (decompose(world, flat)) {
      into.objects.add(name, mesh, flat);
      continue;
    }
    Frame frame;
    frame.name = name + "/frame";
    frame.has_matrix = true;
    frame.matrix = world;
    into.frames.push_back(std::move(frame));
    into.objects.add(name, mesh, {}, FrameId(into.frames.size() - 1));
  }
}

}  // namespace scenegen
