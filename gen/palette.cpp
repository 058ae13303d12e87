#include "gen/palette.h"

#include <utility>

#include "gen/primitives.h"
#include "gen/textures.h"

namespace scenegen::gen {
namespace {

struct Paint {
  const char* name;
  glm::vec4 color;  // linear
  float roughness;
  float metallic = 0.0F;
};

const Paint& paint_of(Look look) {
  // Bricks multiply the texture's colour: three firings of one clay.
  static const std::array<Paint, kLooks> paints{{
      {"brick_red", {0.72F, 0.47F, 0.40F, 1.0F}, 0.9F},
      {"brick_dark", {0.46F, 0.31F, 0.28F, 1.0F}, 0.9F},
      {"brick_pale", {0.92F, 0.77F, 0.60F, 1.0F}, 0.9F},
      {"plaster", {0.62F, 0.58F, 0.51F, 1.0F}, 0.95F},
      {"stone", {0.55F, 0.50F, 0.42F, 1.0F}, 0.85F},
      {"paint", {0.72F, 0.71F, 0.68F, 1.0F}, 0.5F},
      {"glass", {0.10F, 0.16F, 0.21F, 0.72F}, 0.05F},
      {"door", {0.025F, 0.09F, 0.075F, 1.0F}, 0.4F},
      {"tile_red", {0.38F, 0.115F, 0.065F, 1.0F}, 0.75F},
      {"tile_brown", {0.29F, 0.088F, 0.053F, 1.0F}, 0.75F},
      {"gravel", {0.28F, 0.265F, 0.24F, 1.0F}, 1.0F},
      {"pavement", {0.40F, 0.375F, 0.335F, 1.0F}, 0.95F},
      {"street", {0.19F, 0.185F, 0.18F, 1.0F}, 0.95F},
      {"grass", {0.16F, 0.265F, 0.07F, 1.0F}, 1.0F},
      {"cargo", {0.62F, 0.36F, 0.12F, 1.0F}, 0.8F},
      {"crane_yellow", {0.85F, 0.48F, 0.03F, 1.0F}, 0.5F},
      {"lorry_red", {0.48F, 0.035F, 0.025F, 1.0F}, 0.35F},
      {"lorry_blue", {0.03F, 0.12F, 0.36F, 1.0F}, 0.35F},
      {"steel", {0.13F, 0.135F, 0.14F, 1.0F}, 0.6F},
      {"rubber", {0.02F, 0.02F, 0.02F, 1.0F}, 0.9F},
      {"cab_glass", {0.02F, 0.035F, 0.05F, 1.0F}, 0.1F},
  }};
  return paints[static_cast<std::size_t>(look)];
}

bool is_brick(Look look) {
  return look == Look::brick_red || look == Look::brick_dark || look == Look::brick_pale;
}

constexpr int kRepeat = 10497, kClampToEdge = 33071;

}  // namespace

Look look_of(PartKind kind) {
  static constexpr std::array<Look, kPartKinds> kLooksOf{
      Look::brick_red, Look::plaster,    Look::stone,  Look::stone,   Look::paint,
      Look::glass,     Look::door,       Look::stone,  Look::stone,   Look::stone,
      Look::tile_red,  Look::tile_brown, Look::gravel, Look::pavement};
  return kLooksOf[static_cast<std::size_t>(kind)];
}

Palette::Palette(Scene& scene, Geometry box, const glm::ivec3& brick_mm)
    : scene_(scene), brick_mm_(brick_mm) {
  scene_.geometries.push_back(std::move(box));
  box_ = GeometryId(scene_.geometries.size() - 1);
}

TextureId Palette::texture(Image image, int wrap) {
  scene_.images.push_back(std::move(image));
  scene_.textures.push_back({ImageId(scene_.images.size() - 1), {9729, 9987, wrap, wrap}});
  return TextureId(scene_.textures.size() - 1);
}

void Palette::add_brick_textures() {
  if (brick_color_.valid()) return;
  BrickImages images = brick_images(brick_mm_);
  brick_color_ = texture(std::move(images.base_color), kClampToEdge);
  brick_normal_ = texture(std::move(images.normal), kClampToEdge);
}

MaterialId Palette::material(Look look) {
  MaterialId& id = materials_[static_cast<std::size_t>(look)];
  if (id.valid()) return id;
  const Paint& paint = paint_of(look);
  Material m;
  m.name = paint.name;
  m.base_color = paint.color;
  m.metallic = paint.metallic;
  m.roughness = paint.roughness;
  if (look == Look::glass) m.alpha_mode = AlphaMode::blend;
  if (is_brick(look)) {
    add_brick_textures();
    m.base_color_texture.texture = brick_color_;
    m.normal_texture.texture = brick_normal_;
  }
  scene_.materials.push_back(std::move(m));
  id = MaterialId(scene_.materials.size() - 1);
  return id;
}

MeshId Palette::mesh(GeometryId geometry, Look look, const char* name) {
  const MaterialId paint = material(look);
  scene_.meshes.push_back({name, {{geometry, paint}}});
  return MeshId(scene_.meshes.size() - 1);
}

MeshId Palette::mesh(std::span<const std::pair<GeometryId, Look>> parts, const char* name) {
  Mesh mesh{name, {}};
  for (const auto& [geometry, look] : parts) mesh.primitives.push_back({geometry, material(look)});
  scene_.meshes.push_back(std::move(mesh));
  return MeshId(scene_.meshes.size() - 1);
}

MeshId Palette::box(Look look) {
  MeshId& id = boxes_[static_cast<std::size_t>(look)];
  if (!id.valid()) id = mesh(box_, look, paint_of(look).name);
  return id;
}

MeshId Palette::ground(Look look, const glm::dvec3& size_m, double repeat_m) {
  if (!noise_.valid()) noise_ = texture(noise_image(), kRepeat);
  scene_.materials[material(look).value].base_color_texture.texture = noise_;
  scene_.geometries.push_back(tiled_unit_box(size_m, repeat_m));
  return mesh(GeometryId(scene_.geometries.size() - 1), look, paint_of(look).name);
}

}  // namespace scenegen::gen
