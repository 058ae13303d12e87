// Pictures against the ones in tests/golden, with a tolerance: drivers round differently. A missing golden is
// a failure; the new picture lies beside as <name>.new.png. SCENEGEN_UPDATE_GOLDEN=1 writes them anew.
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "render/image_decode.h"
#include "render/image_file.h"
#include "tests/render/render_support.h"

using namespace scenegen;
using namespace scenegen::render;
using namespace scenegen::render::test;

namespace {

constexpr glm::uvec2 kSize{320, 180};

/// A ball of `slices` x 2 `slices` faces, radius 0.5.
Geometry ball_geometry(std::uint32_t slices) {
  Geometry g;
  for (std::uint32_t i = 0; i <= slices; ++i) {
    for (std::uint32_t j = 0; j <= 2 * slices; ++j) {
      const float v = static_cast<float>(i) / static_cast<float>(slices);
      const float u = static_cast<float>(j) / static_cast<float>(2 * slices);
      const float theta = v * glm::pi<float>();
      const float phi = u * glm::two_pi<float>();
      const glm::vec3 n(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
      g.positions_m.push_back(0.5F * n);
      g.normals.push_back(n);
      g.texcoords[0].emplace_back(u, v);
    }
  }
  const std::uint32_t row = 2 * slices + 1;
  for (std::uint32_t i = 0; i < slices; ++i)
    for (std::uint32_t j = 0; j < 2 * slices; ++j)
      for (const std::uint32_t k : {0U, row, row + 1, 0U, row + 1, 1U}) g.indices.push_back(i * row + j + k);
  return g;
}

TextureId add_texture(Scene& scene, glm::uvec2 size, const std::vector<std::uint32_t>& texels) {
  const std::string png = encode_ids(size, texels);
  scene.images.push_back({"", "image/png", {png.begin(), png.end()}});
  Texture texture;
  texture.image = ImageId(scene.images.size() - 1);
  scene.textures.push_back(texture);
  return TextureId(scene.textures.size() - 1);
}

/// Balls of falling roughness, above metal, below not.
Scene balls_scene() {
  Scene scene;
  const Geometry ball = ball_geometry(24);
  for (int metallic = 0; metallic < 2; ++metallic) {
    for (int i = 0; i < 5; ++i) {
      Material m = plain(metallic == 1 ? glm::vec4(0.9F, 0.6F, 0.3F, 1) : glm::vec4(0.7F, 0.1F, 0.1F, 1));
      m.metallic = static_cast<float>(metallic);
      m.roughness = 0.05F + 0.2F * static_cast<float>(i);
      const MeshId mesh = add_mesh(scene, ball, m);
      add_object(scene, "ball_" + std::to_string(scene.objects.size()), mesh,
                 {1.2F * static_cast<float>(i - 2), 0.6F + 1.2F * static_cast<float>(metallic), 0});
    }
  }
  add_object(scene, "ground", add_mesh(scene, box_geometry(), plain({0.4F, 0.4F, 0.4F, 1})), {0, -0.05F, 0},
             {12, 0.1F, 12});
  return scene;
}

/// Normal, occlusion, emissive and masked textures, with mipmaps, on balls and boxes.
Scene textures_scene() {
  Scene scene;
  std::vector<std::uint32_t> checker, bumps, spots;
  for (std::uint32_t y = 0; y < 64; ++y) {
    for (std::uint32_t x = 0; x < 64; ++x) {
      checker.push_back(((x / 8 + y / 8) % 2) != 0 ? 0xFFFFFFFF : 0xFF205080);
      const float a = std::sin(static_cast<float>(x) * glm::two_pi<float>() / 16);
      const float b = std::sin(static_cast<float>(y) * glm::two_pi<float>() / 16);
      const auto byte = [](float v) { return static_cast<std::uint32_t>(128 + 90 * v); };
      bumps.push_back(0xFFE00000 | byte(b) << 8 | byte(a));
      const bool spot = (x % 16 - 8) * (x % 16 - 8) + (y % 16 - 8) * (y % 16 - 8) < 20;
      spots.push_back(spot ? 0xFF40C0FF : 0x00000000);
    }
  }
  const TextureId color = add_texture(scene, {64, 64}, checker);
  const TextureId normal = add_texture(scene, {64, 64}, bumps);
  const TextureId glow = add_texture(scene, {64, 64}, spots);
  const auto add = [&](const Material& m, const Geometry& g, const glm::vec3& at) {
    add_object(scene, "thing_" + std::to_string(scene.objects.size()), add_mesh(scene, g, m), at,
               glm::vec3(1.4F));
  };
  Material m = plain(glm::vec4(1));
  m.base_color_texture.texture = color;
  add(m, ball_geometry(24), {-3, 0.7F, 0});
  m = plain({0.8F, 0.8F, 0.8F, 1});
  m.roughness = 0.35F;
  m.normal_texture.texture = normal;
  m.occlusion_texture.texture = normal;
  add(m, ball_geometry(24), {-1, 0.7F, 0});
  m = plain({0.05F, 0.05F, 0.05F, 1});
  m.emissive = glm::vec3(1);
  m.emissive_texture.texture = glow;
  add(m, box_geometry(), {1, 0.7F, 0});
  m = plain(glm::vec4(1));
  m.base_color_texture.texture = glow;
  m.alpha_mode = AlphaMode::mask;
  m.double_sided = true;
  add(m, box_geometry(), {3, 0.7F, 0});
  Material ground = plain(glm::vec4(1));
  ground.base_color_texture.texture = color;
  ground.base_color_texture.uv_scale = {12, 12};
  add_object(scene, "ground", add_mesh(scene, box_geometry(), ground), {0, -0.05F, 0}, {14, 0.1F, 14});
  return scene;
}

std::string read(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void check_golden(const std::string& name, const FrameResult& frame) {
  const std::string path = std::string(SCENEGEN_GOLDEN_FOLDER) + "/" + name + ".png";
  const std::string png = encode_picture(PictureFormat::png, kSize, frame.rgba);
  if (std::getenv("SCENEGEN_UPDATE_GOLDEN") != nullptr) std::ofstream(path, std::ios::binary) << png;
  const std::string golden = read(path);
  const auto wanted =
      decode_image({reinterpret_cast<const std::uint8_t*>(golden.data()), golden.size()}, path);
  std::size_t off = 0;
  double sum = 0;
  if (wanted && wanted->rgba.size() == frame.rgba.size()) {
    for (std::size_t i = 0; i < frame.rgba.size(); ++i) {
      const int d = std::abs(int{wanted->rgba[i]} - int{frame.rgba[i]});
      sum += d;
      off += d > 12 ? 1 : 0;
    }
  }
  // Edges may fall a sample to the other side, flat parts may round by one.
  const bool good = wanted && wanted->rgba.size() == frame.rgba.size() && off * 200 <= frame.rgba.size() &&
                    sum <= 0.35 * static_cast<double>(frame.rgba.size());
  if (!good) std::ofstream(name + ".new.png", std::ios::binary) << png;
  INFO(path << ": " << off << " values off, mean difference "
            << sum / static_cast<double>(frame.rgba.size()));
  REQUIRE(wanted);
  CHECK(good);
}

RendererOptions golden_options() {
  RendererOptions o = test_options();
  o.size = kSize;
  o.outputs = {true, false, false};
  o.shadows = true;
  return o;
}

}  // namespace

TEST_CASE("golden: a wall being built, with glass and shadows") {
  const auto frames = render::test::render(wall_scene(), {2.05, 9.0}, look({5, 4, 8}, {0.5F, 1.2F, 0}, kSize),
                                           golden_options());
  check_golden("wall_half", frames[0]);
  check_golden("wall_whole", frames[1]);
}

TEST_CASE("golden: metal and not, rough and smooth") {
  check_golden("balls", render_one(balls_scene(), look({0, 2.2F, 7}, {0, 1.1F, 0}, kSize), golden_options()));
}

TEST_CASE("golden: textures of every kind") {
  check_golden("textures",
               render_one(textures_scene(), look({1, 3, 8}, {0, 0.6F, 0}, kSize), golden_options()));
}
