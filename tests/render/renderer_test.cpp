// Whole frames on whatever device there is, with the validation layer watching.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "render/image_file.h"
#include "tests/render/render_support.h"

using namespace scenegen;
using namespace scenegen::render;
using namespace scenegen::render::test;

namespace {

bool same_bits(const FrameResult& a, const FrameResult& b) {
  return a.rgba == b.rgba && a.ids == b.ids && a.depth.size() == b.depth.size() &&
         std::memcmp(a.depth.data(), b.depth.data(), a.depth.size() * sizeof(float)) == 0;
}

const std::vector<double> kTimes{0.0, 1.55, 3.0, 5.0, 0.75, 5.0};

}  // namespace

TEST_CASE("brute and inline give the same bits, at several times, from inside and outside") {
  const Scene scene = wall_scene();
  RendererOptions options = test_options();
  options.shadows = true;
  for (const glm::vec3 eye : {glm::vec3(4, 3, 8), glm::vec3(0.3F, 1.2F, 2.0F), glm::vec3(-1, 0.4F, 0.9F)}) {
    const View view = look(eye, {0.5F, 1, 0}, options.size);
    options.strategy = "brute";
    const auto brute = render::test::render(scene, kTimes, view, options);
    options.strategy = "inline";
    const auto culled = render::test::render(scene, kTimes, view, options);
    bool something_culled = false;
    for (std::size_t i = 0; i < kTimes.size(); ++i) {
      INFO("time " << kTimes[i]);
      CHECK(same_bits(brute[i], culled[i]));
      something_culled = something_culled || culled[i].report.drawn < brute[i].report.drawn;
    }
    CHECK(something_culled == (eye.z < 5.0F));
    CHECK(same_bits(culled[3], culled[5]));  // the same time again, after going back
    CHECK_FALSE(same_bits(culled[1], culled[3]));
  }
}

TEST_CASE("the same frames twice, and with a full barrier everywhere, give the same bits") {
  const Scene scene = wall_scene();
  RendererOptions options = test_options();
  options.shadows = true;
  const View view = look({4, 3, 8}, {0.5F, 1, 0}, options.size);
  const auto once = render::test::render(scene, kTimes, view, options);
  const auto twice = render::test::render(scene, kTimes, view, options);
  options.full_barriers = true;
  const auto careful = render::test::render(scene, kTimes, view, options);
  for (std::size_t i = 0; i < kTimes.size(); ++i) {
    CHECK(same_bits(once[i], twice[i]));
    CHECK(same_bits(once[i], careful[i]));
  }
}

TEST_CASE("drawn in reverse order, solid objects give the same depth, and the same ids but for ties") {
  const Scene scene = wall_scene();
  RendererOptions options = test_options();
  const View view = look({4, 3, 8}, {0.5F, 1, 0}, options.size);
  const FrameResult forwards = render_one(scene, view, options, 9);
  options.how.reversed = true;
  const FrameResult backwards = render_one(scene, view, options, 9);
  CHECK(forwards.depth == backwards.depth);
  std::size_t ties = 0;
  for (std::size_t i = 0; i < forwards.ids.size(); ++i) ties += forwards.ids[i] != backwards.ids[i] ? 1 : 0;
  CHECK(ties <= forwards.ids.size() / 1000);
}

TEST_CASE("the report counts what was done") {
  const Scene scene = wall_scene();
  RendererOptions options = test_options();
  const View view = look({4, 3, 8}, {0.5F, 1, 0}, options.size);
  const auto frames = render::test::render(scene, {0.0, 9.0}, view, options);
  CHECK(frames[0].report.objects == 48);
  CHECK(frames[0].report.visible == 4);
  CHECK(frames[1].report.visible == 48);
  CHECK(frames[1].report.changed == 44);
  CHECK(frames[1].report.drawn == 48);
  CHECK(frames[1].report.tested == 48);
  CHECK(frames[1].report.draws == 48);
  CHECK(frames[1].report.triangles == 12 * 48);
  CHECK(frames[1].report.ids_draws == 46);  // the solid ones
  CHECK(frames[1].report.ids_triangles == 12 * 46);
  CHECK(frames[1].report.gpu_ms > 0);
}

TEST_CASE("ids name exactly the object at a pixel, the background is all ones") {
  Scene scene;
  const MeshId red = add_mesh(scene, quad_geometry(), plain({1, 0, 0, 1}));
  add_object(scene, "left", red, {-2, 0, 0});
  add_object(scene, "right", red, {2, 0, 0});
  add_object(scene, "front", red, {2.25F, 0, 1}, glm::vec3(0.25F));
  Material glass = plain({1, 1, 1, 0.5F});
  glass.alpha_mode = AlphaMode::blend;
  const MeshId pane = add_mesh(scene, quad_geometry(), glass);
  add_object(scene, "pane", pane, {-2, 0, 2});
  RendererOptions options = test_options();
  options.size = {80, 40};
  Lens lens;
  lens.orthographic = true;
  lens.xmag_m = 4;
  lens.ymag_m = 2;
  lens.near_m = 0;
  lens.far_m = 20;
  const View view = make_view(look_at({0, 0, 10}, {0, 0, 0}), lens, 2.0F);
  const FrameResult frame = render_one(scene, view, options);
  for (std::uint32_t y = 0; y < 40; ++y) {
    for (std::uint32_t x = 0; x < 80; ++x) {
      const glm::vec2 p((static_cast<float>(x) + 0.5F) / 10 - 4, 2 - (static_cast<float>(y) + 0.5F) / 10);
      std::uint32_t expected = 0xFFFFFFFF;
      const auto inside = [&](glm::vec2 c, float half) {
        return std::abs(p.x - c.x) < half && std::abs(p.y - c.y) < half;
      };
      if (inside({-2, 0}, 0.5F)) expected = 0;  // the pane before it is blended and leaves no id
      if (inside({2, 0}, 0.5F)) expected = 1;
      if (inside({2.25F, 0}, 0.125F)) expected = 2;
      INFO(x << " " << y);
      REQUIRE(frame.ids[80 * y + x] == expected);
      const float metres = view.distance_m(frame.depth[80 * y + x]);
      REQUIRE(metres == Approx(expected == 0xFFFFFFFF ? 20.0F : expected == 2 ? 9.0F : 10.0F).epsilon(1e-5));
    }
  }
}

TEST_CASE("depth of a box in perspective is the distance along the view direction") {
  Scene scene;
  const MeshId box = add_mesh(scene, box_geometry(), plain({1, 0, 0, 1}));
  add_object(scene, "box", box, {0, 0, 0}, {2, 2, 2});
  RendererOptions options = test_options();
  const View view = look({0.4F, 0.2F, 6}, {0.4F, 0.2F, 0}, options.size);
  const FrameResult frame = render_one(scene, view, options);
  CHECK(view.distance_m(frame.depth[160 * 45 + 80]) == Approx(5.0F).epsilon(1e-5));
  CHECK(view.distance_m(frame.depth[160 * 45 + 70]) == Approx(5.0F).epsilon(1e-5));
  CHECK(frame.depth[0] == 0.0F);
}

TEST_CASE("a texture stands the right way round and its sRGB values come out as they went in") {
  // Top left red, top right green; bottom left blue, bottom right grey 188.
  const std::vector<std::uint8_t> texels{255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 188, 188, 188, 255};
  Scene scene;
  const std::string png = encode_ids({2, 2}, {reinterpret_cast<const std::uint32_t*>(texels.data()), 4});
  scene.images.push_back({"four", "image/png", {png.begin(), png.end()}});
  Texture texture;
  texture.image = ImageId(0);
  texture.sampler.mag_filter = texture.sampler.min_filter = 9728;
  texture.sampler.wrap_s = texture.sampler.wrap_t = 33071;
  scene.textures.push_back(texture);
  Material material = plain(glm::vec4(1), true);
  material.base_color_texture.texture = TextureId(0);
  const MeshId quad = add_mesh(scene, quad_geometry(), material);
  Material turned = material;  // a quarter turn: what was right is now up (KHR_texture_transform)
  turned.base_color_texture.uv_rotation_rad = glm::half_pi<float>();
  turned.base_color_texture.uv_offset = {0.0F, 1.0F};
  const MeshId turned_quad = add_mesh(scene, quad_geometry(), turned);
  add_object(scene, "straight", quad, {-1, 0, 0});
  add_object(scene, "turned", turned_quad, {1, 0, 0});
  RendererOptions options = test_options();
  options.size = {80, 40};
  Lens lens;
  lens.orthographic = true;
  lens.xmag_m = 2;
  lens.ymag_m = 1;
  lens.near_m = 0;
  lens.far_m = 20;
  const FrameResult frame = render_one(scene, make_view(look_at({0, 0, 10}, {0, 0, 0}), lens, 2.0F), options);
  CHECK(pixel(frame, options.size, 15, 15) == glm::ivec3(255, 0, 0));
  CHECK(pixel(frame, options.size, 25, 15) == glm::ivec3(0, 255, 0));
  CHECK(pixel(frame, options.size, 15, 25) == glm::ivec3(0, 0, 255));
  const glm::ivec3 grey = pixel(frame, options.size, 25, 25);
  CHECK(std::abs(grey.x - 188) <= 1);
  CHECK(grey.x == grey.y);
  // uv' = offset + R uv with R = [0 1; -1 0]: (0, 0) of the quad reads (0, 1), (1, 0) reads (0, 0).
  CHECK(pixel(frame, options.size, 55, 15) == glm::ivec3(0, 0, 255));
  CHECK(pixel(frame, options.size, 65, 15) == glm::ivec3(255, 0, 0));
  CHECK(pixel(frame, options.size, 65, 25) == glm::ivec3(0, 255, 0));
}

TEST_CASE("blending: the nearer pane lies over the farther one, whatever their order in the scene") {
  for (const bool swapped : {false, true}) {
    Scene scene;
    const auto pane = [&](const glm::vec4& color) {
      Material m = plain(color, true);
      m.alpha_mode = AlphaMode::blend;
      return add_mesh(scene, quad_geometry(), m);
    };
    const MeshId red = pane({1, 0, 0, 0.5F});
    const MeshId green = pane({0, 1, 0, 0.5F});
    const MeshId back = add_mesh(scene, quad_geometry(), plain({0, 0, 0, 1}, true));
    if (swapped) add_object(scene, "near", green, {0, 0, 1});
    add_object(scene, "far", red, {0, 0, 0});
    if (!swapped) add_object(scene, "near", green, {0, 0, 1});
    add_object(scene, "back", back, {0, 0, -1}, {9, 9, 1});
    RendererOptions options = test_options();
    const FrameResult frame = render_one(scene, look({0, 0, 3}, {0, 0, 0}, options.size), options);
    // Linear: red 0.25, green 0.5 -> sRGB 137, 188.
    const glm::ivec3 p = pixel(frame, options.size, 80, 45);
    CHECK(std::abs(p.x - 137) <= 1);
    CHECK(std::abs(p.y - 188) <= 1);
    CHECK(p.z == 0);
  }
}

TEST_CASE("a mask cuts holes into colour, ids and depth") {
  Scene scene;
  const std::vector<std::uint32_t> texels{0xFFFFFFFF, 0x00FFFFFF};  // left opaque, right transparent
  const std::string png = encode_ids({2, 1}, texels);
  scene.images.push_back({"", "image/png", {png.begin(), png.end()}});
  Texture texture;
  texture.image = ImageId(0);
  texture.sampler.mag_filter = texture.sampler.min_filter = 9728;
  scene.textures.push_back(texture);
  Material leaf = plain({0, 1, 0, 1}, true);
  leaf.alpha_mode = AlphaMode::mask;
  leaf.base_color_texture.texture = TextureId(0);
  const MeshId quad = add_mesh(scene, quad_geometry(), leaf);
  add_object(scene, "leaf", quad, {0, 0, 0});
  add_object(scene, "behind", add_mesh(scene, quad_geometry(), plain({1, 0, 0, 1}, true)), {0, 0, -1},
             {4, 4, 1});
  RendererOptions options = test_options();
  const FrameResult frame = render_one(scene, look({0, 0, 2}, {0, 0, 0}, options.size), options);
  CHECK(frame.ids[160 * 45 + 70] == 0);
  CHECK(frame.ids[160 * 45 + 90] == 1);
  CHECK(pixel(frame, options.size, 70, 45) == glm::ivec3(0, 255, 0));
  CHECK(pixel(frame, options.size, 90, 45) == glm::ivec3(255, 0, 0));
  CHECK(frame.depth[160 * 45 + 70] > frame.depth[160 * 45 + 90]);
}

TEST_CASE("back faces are culled, of mirrored objects too, and not of double-sided ones") {
  Scene scene;
  Material both = plain({0, 0, 1, 1});
  both.double_sided = true;
  const MeshId one_sided = add_mesh(scene, quad_geometry(), plain({1, 0, 0, 1}));
  const MeshId two_sided = add_mesh(scene, quad_geometry(), both);
  const glm::vec3 size(1);
  add_object(scene, "front", one_sided, {-3, 0, 0}, size);
  add_object(scene, "mirrored", one_sided, {-1, 0, 0}, {-1, 1, 1});
  Transform back;
  back.rotation = glm::quat(0, 0, 1, 0);  // half a turn about y
  back.translation_m = {1, 0, 0};
  scene.objects.add("back", one_sided, back);
  back.translation_m = {3, 0, 0};
  scene.objects.add("back of a double-sided one", two_sided, back);
  RendererOptions options = test_options();
  const FrameResult frame = render_one(scene, look({0, 0, 10}, {0, 0, 0}, options.size), options);
  std::vector<int> seen(5, 0);
  for (const std::uint32_t id : frame.ids) ++seen[std::min(id, 4U)];
  CHECK(seen[0] > 10);
  CHECK(std::abs(seen[1] - seen[0]) < seen[0] / 5);  // edges fall on other pixels
  CHECK(seen[2] == 0);
  CHECK(std::abs(seen[3] - seen[0]) < seen[0] / 5);
}

TEST_CASE("moving, recoloured and swapped objects are drawn as they are now") {
  Scene scene;
  const MeshId red = add_mesh(scene, quad_geometry(), plain({1, 0, 0, 1}, true));
  const MeshId green = add_mesh(scene, quad_geometry(), plain({0, 1, 0, 1}, true));
  scene.frames.push_back({});
  scene.frames[0].name = "lift";
  scene.objects.add("lift", red, Transform{}, FrameId(0));
  const ObjectId swap = add_object(scene, "swap", red, {-1.2F, 0, 0});
  const std::array times{0.0F, 1.0F};
  const std::array up{0.0F, 0.0F, 0.0F, 1.2F, 0.0F, 0.0F};
  scene.frame_tracks.push_back(
      {FrameId(0), scene.add_track(Property::translation, Interpolation::linear, times, up)});
  const std::array looks{static_cast<float>(red.value), static_cast<float>(green.value)};
  scene.object_mesh_tracks.push_back(
      {swap, scene.add_track(Property::mesh, Interpolation::step, times, looks)});
  const std::array colors{1.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 1.0F, 1.0F};
  scene.material_tracks.push_back(
      {MaterialId(0), scene.add_track(Property::base_color, Interpolation::linear, times, colors)});
  scene.duration_s = 1;
  RendererOptions options = test_options();
  options.size = {120, 40};
  Lens lens;
  lens.orthographic = true;
  lens.xmag_m = 1.8F;
  lens.ymag_m = 0.6F;
  lens.near_m = 0;
  lens.far_m = 20;
  const View view = make_view(look_at({0, 0, 10}, {0, 0, 0}), lens, 3.0F);
  const auto frames = render::test::render(scene, {0.0, 1.0, 0.0}, view, options);
  for (const std::size_t i : {0U, 2U}) {
    CHECK(pixel(frames[i], options.size, 20, 20) == glm::ivec3(255, 0, 0));
    CHECK(pixel(frames[i], options.size, 60, 20) == glm::ivec3(255, 0, 0));
    CHECK(frames[i].ids[120 * 20 + 100] == 0xFFFFFFFF);
  }
  CHECK(pixel(frames[1], options.size, 20, 20) == glm::ivec3(0, 255, 0));
  CHECK(frames[1].ids[120 * 20 + 60] == 0xFFFFFFFF);
  CHECK(pixel(frames[1], options.size, 100, 20) == glm::ivec3(0, 0, 255));
  CHECK(same_bits(frames[0], frames[2]));
}

TEST_CASE("a shadow falls away from the sun, and only with shadows on") {
  Scene scene;
  add_object(scene, "ground", add_mesh(scene, box_geometry(), plain({0.5F, 0.5F, 0.5F, 1})), {0, -0.05F, 0},
             {40, 0.1F, 40});
  add_object(scene, "tower", add_mesh(scene, box_geometry(), plain({0.5F, 0.5F, 0.5F, 1})), {0, 2, 0},
             {1, 4, 1});
  RendererOptions options = test_options();
  const View view = look({0, 20, 0.1F}, {0, 0, 0}, options.size);
  const FrameResult without = render_one(scene, view, options);
  options.shadows = true;
  const FrameResult with = render_one(scene, view, options);
  std::size_t darker = 0, elsewhere = 0;
  for (std::uint32_t y = 0; y < 90; ++y) {
    for (std::uint32_t x = 0; x < 160; ++x) {
      const int change = pixel(without, options.size, x, y).y - pixel(with, options.size, x, y).y;
      // The sun stands at (-x, +z): seen from above the shadow lies to the right and up.
      (x >= 78 && y <= 48 ? darker : elsewhere) += change > 20 ? 1 : 0;
      REQUIRE(change >= -1);
    }
  }
  CHECK(darker > 50);
  CHECK(elsewhere == 0);
}

TEST_CASE("points, lines and triangles without normals are drawn; a broken image is white, with a warning") {
  Scene scene;
  Geometry line;
  line.topology = Topology::line_strip;
  line.positions_m = {{-3, 0.02F, 0}, {-2, 0.02F, 0}, {-2, 1, 0}};
  Geometry point;
  point.topology = Topology::points;
  point.positions_m = {{0, 0.02F, 0}};
  Geometry flat = box_geometry();
  flat.normals.clear();
  scene.images.push_back({"broken", "image/png", {1, 2, 3}});
  Texture texture;
  texture.image = ImageId(0);
  scene.textures.push_back(texture);
  Material white = plain({1, 1, 1, 1}, true);
  white.base_color_texture.texture = TextureId(0);
  add_object(scene, "line", add_mesh(scene, line, plain({1, 0, 0, 1})), {});
  add_object(scene, "point", add_mesh(scene, point, plain({0, 1, 0, 1})), {});
  add_object(scene, "flat", add_mesh(scene, flat, plain({0, 0, 1, 1})), {2, 0, 0});
  add_object(scene, "white", add_mesh(scene, quad_geometry(), white), {4, 0, 0});
  RendererOptions options = test_options();
  const View view = look({0.5F, 0, 8}, {0.5F, 0, 0}, options.size);
  timeline::Player player(timeline::compile(scene));
  Result<Renderer> renderer = Renderer::create(scene, player, options);
  REQUIRE(renderer);
  REQUIRE(renderer->warnings().size() == 1);
  CHECK(renderer->warnings()[0].find("'broken'") != std::string::npos);
  REQUIRE(renderer->submit(player.seek(0), player, view));
  FrameResult frame;
  REQUIRE(renderer->finish(frame));
  for (const std::string& message : renderer->take_validation_messages()) FAIL_CHECK(message);
  std::vector<int> seen(5, 0);
  for (const std::uint32_t id : frame.ids) ++seen[std::min(id, 4U)];
  CHECK(seen[0] > 10);
  CHECK(seen[1] == 1);
  CHECK(seen[2] > 100);
  CHECK(seen[3] > 100);
  const auto at = [&](std::uint32_t id) {
    const auto found =
        static_cast<std::uint32_t>(std::find(frame.ids.begin(), frame.ids.end(), id) - frame.ids.begin());
    return pixel(frame, options.size, found % 160 + 5, found / 160 + 5);
  };
  CHECK(at(3) == glm::ivec3(255));
  CHECK(at(2).z > at(2).x);
}

TEST_CASE("renderers share a device and take turns; without readback there are no pictures") {
  const Scene scene = wall_scene();
  RendererOptions options = test_options();
  auto device = share_device(options.device);
  REQUIRE(device);
  options.shared_device = *device;
  CHECK_FALSE(info_of(**device).driver.empty());
  const View view = look({0, 2, 9}, {0, 1, 0}, options.size);
  const std::vector<double> times{1, 3, 2, 5};
  const auto alone = render::test::render(scene, times, view, test_options());
  std::vector<Renderer> renderers;
  std::vector<timeline::Player> players;
  const auto timeline = timeline::compile(scene);
  for (const bool readback : {true, false, true}) {
    players.emplace_back(timeline);
    options.outputs.readback = readback;
    options.strategy = renderers.empty() ? "inline" : "octree";
    auto made = Renderer::create(scene, players.back(), options);
    REQUIRE(made);
    renderers.push_back(std::move(*made));
  }
  for (std::size_t i = 0; i < times.size(); ++i) {
    for (std::size_t r = 0; r < renderers.size(); ++r)
      REQUIRE(renderers[r].submit(players[r].seek(times[i]), players[r], view));
    for (std::size_t r = 0; r < renderers.size(); ++r) {
      FrameResult frame;
      REQUIRE(renderers[r].finish(frame));
      CHECK(frame.report.draws > 0);
      if (r != 1) {
        CHECK(same_bits(frame, alone[i]));
      } else {
        CHECK(frame.rgba.empty());
        CHECK(frame.ids.empty());
        CHECK(frame.depth.empty());
      }
    }
  }
  renderers.pop_back();  // the others go on
  REQUIRE(renderers[0].submit(players[0].seek(0), players[0], view));
  FrameResult frame;
  REQUIRE(renderers[0].finish(frame));
  for (const std::string& message : renderers[0].take_validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("a scene that does not fit device memory lies in the host's, and looks the same") {
  Scene scene = wall_scene();
  Geometry large = box_geometry();  // boxes in boxes, no vertex twice: about a megabyte
  const Geometry box = large;
  for (std::uint32_t i = 1; i < 800; ++i) {
    const auto first = static_cast<std::uint32_t>(large.positions_m.size());
    for (const std::uint32_t index : box.indices) large.indices.push_back(first + index);
    for (const glm::vec3& p : box.positions_m)
      large.positions_m.push_back(p * (1.0F - 1e-3F * static_cast<float>(i)));
    large.normals.insert(large.normals.end(), box.normals.begin(), box.normals.end());
    large.texcoords[0].insert(large.texcoords[0].end(), box.texcoords[0].begin(), box.texcoords[0].end());
  }
  add_object(scene, "large", add_mesh(scene, large, plain({0.2F, 0.3F, 0.9F, 1})), {-3, 0.5F, 2});
  RendererOptions options = test_options();
  const View view = look({0, 2, 9}, {0, 1, 0}, options.size);
  const FrameResult wanted = render_one(scene, view, options, 3);
  bool spilled = false, refused = false;
  for (std::uint64_t bytes = 100'000; bytes <= 3'200'000; bytes += 100'000) {
    options.memory_faults.device_bytes = bytes;
    timeline::Player again(timeline::compile(scene));
    auto renderer = Renderer::create(scene, again, options);
    if (!renderer) {  // not even the pictures fit
      refused = true;
      CHECK(renderer.error().kind == ErrorKind::no_device);
      continue;
    }
    if (renderer->warnings().empty()) continue;
    spilled = true;
    CHECK(renderer->warnings()[0].find("memory of the host") != std::string::npos);
    REQUIRE(renderer->submit(again.seek(3), again, view));
    FrameResult frame;
    REQUIRE(renderer->finish(frame));
    CHECK(same_bits(frame, wanted));
  }
  CHECK(refused);
  CHECK(spilled);
}

TEST_CASE("an empty scene is sky; one sample works; wrong options are errors") {
  Scene empty;
  RendererOptions options = test_options();
  options.samples = 1;
  options.shadows = true;
  const View view = look({0, 1, 8}, {0, 1, 0}, options.size);
  const FrameResult frame = render_one(empty, view, options);
  CHECK(std::all_of(frame.ids.begin(), frame.ids.end(), [](std::uint32_t id) { return id == 0xFFFFFFFF; }));
  CHECK(pixel(frame, options.size, 80, 2).z > pixel(frame, options.size, 80, 2).x);
  timeline::Player player(timeline::compile(empty));
  const auto kind = [&](const RendererOptions& o) {
    const auto renderer = Renderer::create(empty, player, o);
    REQUIRE_FALSE(renderer);
    return renderer.error().kind;
  };
  RendererOptions wrong = options;
  wrong.device.wanted = "no such device";
  CHECK(kind(wrong) == ErrorKind::usage);
  wrong = options;
  wrong.samples = 3;
  CHECK(kind(wrong) == ErrorKind::usage);
  wrong = options;
  wrong.frames_in_flight = 0;
  CHECK(kind(wrong) == ErrorKind::usage);
  wrong.frames_in_flight = 4;
  CHECK(kind(wrong) == ErrorKind::usage);
  wrong = options;
  wrong.strategy = "magic";
  CHECK(kind(wrong) == ErrorKind::usage);
  wrong = options;
  wrong.size = {0, 10};
  CHECK(kind(wrong) == ErrorKind::usage);
}

TEST_CASE("normal maps look the same with tangents and without") {
  Scene scene;
  std::vector<std::uint32_t> tilted;  // left half leans left, right half down
  for (int i = 0; i < 16; ++i) tilted.push_back(i % 4 < 2 ? 0xFFE08040 : 0xFFE040A0);
  const std::string png = encode_ids({4, 4}, tilted);
  scene.images.push_back({"", "image/png", {png.begin(), png.end()}});
  Texture texture;
  texture.image = ImageId(0);
  scene.textures.push_back(texture);
  Material material = plain({0.6F, 0.6F, 0.6F, 1});
  material.normal_texture.texture = TextureId(0);
  Geometry with = quad_geometry();
  with.tangents.assign(4, glm::vec4(1, 0, 0, 1));
  const std::array meshes{add_mesh(scene, quad_geometry(), material), add_mesh(scene, with, material)};
  add_object(scene, "derived", meshes[0], {-0.6F, 0, 0});
  add_object(scene, "given", meshes[1], {0.6F, 0, 0});
  Material no_map = plain({0.6F, 0.6F, 0.6F, 1});
  add_object(scene, "flat", add_mesh(scene, quad_geometry(), no_map), {0, 2, 0});
  RendererOptions options = test_options();
  options.size = {120, 60};
  Lens lens;
  lens.orthographic = true;
  lens.xmag_m = 1.2F;
  lens.ymag_m = 0.6F;
  lens.near_m = 0;
  lens.far_m = 20;
  const FrameResult frame = render_one(scene, make_view(look_at({0, 0, 10}, {0, 0, 0}), lens, 2.0F), options);
  const glm::ivec3 left = pixel(frame, options.size, 15, 30);
  const glm::ivec3 right = pixel(frame, options.size, 45, 30);
  CHECK(left.y - right.y > 20);  // the sun stands to the left and above
  for (const std::uint32_t x : {10U, 20U, 30U, 40U, 50U}) {
    const glm::ivec3 difference =
        glm::abs(pixel(frame, options.size, x, 30) - pixel(frame, options.size, x + 60, 30));
    CHECK(std::max({difference.x, difference.y, difference.z}) <= 2);
  }
}
