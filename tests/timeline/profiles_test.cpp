#include "timeline/profiles.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "scene/color.h"
#include "scene/random.h"
#include "scene/validate.h"
#include "timeline/appearance.h"
#include "timeline/compare.h"
#include "timeline/player.h"

namespace scenegen::timeline {
namespace {

constexpr std::uint32_t kOpaque = 0, kGlass = 1, kLeaves = 2;

Material material(const char* name, const glm::vec4& color) {
  Material m;
  m.name = name;
  m.base_color = color;
  return m;
}

/// `count` boxes of 2 m in a row, each of two primitives (opaque and glass), the last one of leaves.
Scene row_of_boxes(std::size_t count) {
  Scene s;
  s.duration_s = 1.0F;
  s.geometries.resize(1);
  s.geometries[0].positions_m = {{-1, -1, -1}, {1, 1, 1}, {0, 1, 0}};
  s.images.resize(1);
  s.textures = {{ImageId(0), {}}};
  s.materials.resize(3);
  s.materials[kOpaque] = material("opaque", {0.5F, 0.4F, 0.3F, 1});
  s.materials[kOpaque].double_sided = true;
  s.materials[kOpaque].base_color_texture.texture = TextureId(0);
  s.materials[kOpaque].normal_texture.texture = TextureId(0);
  s.materials[kGlass] = material("glass", {0.1F, 0.2F, 0.3F, 0.5F});
  s.materials[kGlass].alpha_mode = AlphaMode::blend;
  s.materials[kLeaves] = material("leaves", {0.1F, 0.5F, 0.1F, 1});
  s.materials[kLeaves].alpha_mode = AlphaMode::mask;
  s.materials[kLeaves].alpha_cutoff = 0.25F;
  s.materials[kLeaves].base_color_texture.texture = TextureId(0);
  s.meshes = {{"box", {{GeometryId(0), MaterialId(kOpaque)}, {GeometryId(0), MaterialId(kGlass)}}},
              {"leaf", {{GeometryId(0), MaterialId(kLeaves)}}}};
  for (std::size_t i = 0; i < count; ++i) {
    Transform t;
    t.translation_m = {3.0F * static_cast<float>(i), 0, 0};
    s.objects.add("box_" + std::to_string(i), MeshId(i + 1 == count && count > 1 ? 1 : 0), t);
  }
  return s;
}

Activity act(std::uint32_t object, Profile profile, double start_s, double finish_s,
             glm::vec3 offset_m = glm::vec3(0)) {
  return {ObjectId(object), profile, start_s, finish_s, offset_m};
}

ProfileResult applied(Scene& scene, const std::vector<Activity>& activities,
                      const ProfileOptions& options = {}) {
  const auto result = apply_profiles(scene, activities, options);
  if (!result) FAIL(result.error().str());
  const auto findings = validate(scene);
  if (!findings.empty()) FAIL(findings.front().where << ": " << findings.front().what);
  return *result;
}

std::string failure(const std::vector<Activity>& activities) {
  Scene scene = row_of_boxes(2);
  const auto result = apply_profiles(scene, activities, {});
  REQUIRE_FALSE(result);
  CHECK(result.error().kind == ErrorKind::usage);
  CHECK(compare(scene, row_of_boxes(2)).equal());  // as it was
  CHECK(scene.tracks.empty());
  return result.error().str();
}

/// What is seen of an object: "-" when hidden, else "own" or the name of its first material, and its height
/// or place along x when it is off its place at rest.
std::string seen(Player& player, const Scene& scene, std::uint32_t object, double time_s) {
  player.seek(time_s);
  const ObjectId id(object);
  if (!player.visible(id)) return "-";
  const Primitive& primitive = scene.meshes[player.mesh(id).value].primitives[0];
  const glm::vec4 color = player.base_color(primitive.material);
  const std::string& paint = scene.materials[primitive.material.value].name;
  std::string out = paint.starts_with("highlight_") ? paint.substr(10) : "own";
  if (out == "own" && color != scene.materials[kOpaque].base_color) out = spell_color(color);
  const glm::vec3 off =
      glm::vec3(player.world_from_object(id)[3]) - scene.objects.frame_from_object[object].translation_m;
  const auto say = [&](const char* axis, float value) {
    if (std::abs(value) < 1e-5F) return;
    char text[32];
    (void)std::snprintf(text, sizeof text, " %s%+.2f", axis, static_cast<double>(value));
    out += text;
  };
  say("x", off.x), say("y", off.y), say("z", off.z);
  return out;
}

std::vector<std::string> seen_at(const Scene& scene, std::uint32_t object,
                                 const std::vector<double>& times_s) {
  Player player(compile(scene));
  std::vector<std::string> out;
  out.reserve(times_s.size());
  for (const double time_s : times_s) out.push_back(seen(player, scene, object, time_s));
  return out;
}

using Seen = std::vector<std::string>;

}  // namespace

TEST_CASE("colors are read, spelt and turned to linear") {
  CHECK(linear_from_srgb(0) == 0.0F);
  CHECK(linear_from_srgb(255) == 1.0F);
  for (int i = 0; i < 256; ++i) {
    const double v = i / 255.0;
    const double linear = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    CHECK(linear_from_srgb(static_cast<std::uint8_t>(i)) == Approx(linear).epsilon(1e-6));
    CHECK(srgb_from_linear(linear_from_srgb(static_cast<std::uint8_t>(i))) == i);
  }
  CHECK(srgb_from_linear(-1.0F) == 0);
  CHECK(srgb_from_linear(2.0F) == 255);
  CHECK(spell_color(parse_color("#43b05c").value()) == "#43b05c");
  CHECK(spell_color(parse_color("#43B05C80").value()) == "#43b05c80");
  for (const char* bad : {"", "#", "#12345", "#1234567", "43b05c", "#43b05g", "#43b05c8", "green"}) {
    CHECK_FALSE(parse_color(bad));
  }
}

TEST_CASE("profiles have names") {
  for (std::size_t i = 0; i < kProfileCount; ++i) {
    const auto profile = static_cast<Profile>(i);
    CHECK(parse_profile(name(profile)).value() == profile);
  }
  CHECK_THAT(parse_profile("constuct").error().what,
             Catch::Matchers::Contains("'constuct' (did you mean 'construct'? one of: appear, "));
}

TEST_CASE("each profile shows what it says") {
  const std::vector<double> times_s{0, 1.99, 2, 3, 4, 4.01, 9};
  const auto alone = [&](Profile profile) {
    Scene scene = row_of_boxes(1);
    applied(scene, {act(0, profile, 2, 4, {0, 0, 3})});
    CHECK(scene.duration_s == (profile == Profile::appear || profile == Profile::neutral ? 2.0F : 4.0F));
    scene.duration_s = 9;
    return seen_at(scene, 0, times_s);
  };
  CHECK(alone(Profile::appear) == Seen{"-", "-", "own", "own", "own", "own", "own"});
  CHECK(alone(Profile::neutral) == Seen{"-", "-", "own", "own", "own", "own", "own"});
  CHECK(alone(Profile::construct) == Seen{"-", "-", "construct", "construct", "own", "own", "own"});
  CHECK(alone(Profile::demolish) == Seen{"own", "own", "demolish", "demolish", "-", "-", "-"});
  CHECK(alone(Profile::temporary) == Seen{"-", "-", "temporary", "temporary", "-", "-", "-"});
  CHECK(alone(Profile::operate) == Seen{"own", "own", "operate", "operate", "own", "own", "own"});
  // Half way a drop has an eighth of its height left, a move has half of its way.
  CHECK(alone(Profile::drop) == Seen{"-", "-", "own y+1.00", "own y+0.12", "own", "own", "own"});
  CHECK(alone(Profile::move) ==
        Seen{"own", "own", "move", "move z+1.50", "own z+3.00", "own z+3.00", "own z+3.00"});
}

TEST_CASE("ways are eased: slow at the end, and a move at its beginning too") {
  Scene scene = row_of_boxes(2);
  ProfileOptions options;
  options.drop_height_m = 8;
  applied(scene, {act(0, Profile::drop, 1, 2), act(1, Profile::move, 1, 2, {8, 0, 0})}, options);
  Player player(compile(scene));
  const auto height = [&](double t) { return player.seek(t), player.world_from_object(ObjectId(0))[3].y; };
  const auto way = [&](double t) { return player.seek(t), player.world_from_object(ObjectId(1))[3].x - 3; };
  CHECK(height(1) == 8);
  CHECK(height(2) == 0);
  CHECK(height(1) - height(1.1) > 5 * (height(1.9) - height(2)));
  CHECK(way(1.5) == Approx(4));
  CHECK(way(1.1) - way(1) < 0.5F * (way(1.55) - way(1.45)));
  CHECK(way(2) - way(1.9) < 0.5F * (way(1.55) - way(1.45)));
  for (int i = 0; i < 100; ++i) {
    CHECK(height(1 + 0.01 * i) > height(1.01 + 0.01 * i));
    CHECK(way(1 + 0.01 * i) < way(1.01 + 0.01 * i));
  }
}

TEST_CASE("what happens to one object several times ends up right") {
  Scene scene = row_of_boxes(4);
  // In any order of mention.
  applied(scene,
          {
              act(0, Profile::demolish, 8, 9), act(0, Profile::construct, 1, 2),
              act(0, Profile::move, 4, 6, {0, 0, 5}), act(1, Profile::temporary, 1, 2),
              act(1, Profile::temporary, 5, 7), act(2, Profile::demolish, 1, 2),  // of what stood there
              act(2, Profile::construct, 4, 5),                                   // built again
          });
  scene.duration_s = 10;
  CHECK(seen_at(scene, 0, {0, 1.5, 3, 5, 7, 8.5, 9}) ==
        Seen{"-", "construct", "own", "move z+2.50", "own z+5.00", "demolish z+5.00", "-"});
  CHECK(seen_at(scene, 1, {0, 1, 3, 5, 6, 7}) == Seen{"-", "temporary", "-", "temporary", "temporary", "-"});
  CHECK(seen_at(scene, 2, {0, 1, 3, 4, 5}) == Seen{"own", "demolish", "-", "construct", "own"});
  CHECK(seen_at(scene, 3, {0, 10})[0] != "-");  // not named
}

TEST_CASE("activities that overlap or touch") {
  const auto of = [](const std::vector<Activity>& activities, const std::vector<double>& times_s) {
    Scene scene = row_of_boxes(2);
    applied(scene, activities);
    scene.duration_s = 20;
    return seen_at(scene, 0, times_s);
  };
  // The later start is on top; what is under way below shows again.
  CHECK(of({act(0, Profile::construct, 1, 9), act(0, Profile::operate, 3, 5)}, {0, 1, 3, 5, 9}) ==
        Seen{"-", "construct", "operate", "construct", "own"});
  CHECK(of({act(0, Profile::construct, 1, 4), act(0, Profile::construct, 3, 6)}, {0, 1, 5, 6}) ==
        Seen{"-", "construct", "construct", "own"});
  CHECK(of({act(0, Profile::temporary, 1, 4), act(0, Profile::temporary, 3, 6)}, {0, 1, 5, 6}) ==
        Seen{"-", "temporary", "temporary", "-"});
  CHECK(of({act(0, Profile::temporary, 1, 3), act(0, Profile::temporary, 3, 6)}, {0, 2.99, 3, 5, 6}) ==
        Seen{"-", "temporary", "temporary", "temporary", "-"});
  CHECK(of({act(0, Profile::temporary, 1, 3), act(0, Profile::construct, 3, 6)}, {0, 2.99, 3, 6}) ==
        Seen{"-", "temporary", "construct", "own"});
  CHECK(of({act(0, Profile::temporary, 1, 9), act(0, Profile::demolish, 4, 5)}, {0, 3, 4, 5, 8}) ==
        Seen{"-", "temporary", "demolish", "-", "-"});
  CHECK(of({act(0, Profile::demolish, 1, 5), act(0, Profile::demolish, 2, 4)}, {0, 1, 4.5, 5}) ==
        Seen{"own", "demolish", "demolish", "-"});
  CHECK(of({act(0, Profile::move, 1, 2, {1, 0, 0}), act(0, Profile::move, 2, 3, {1, 0, 0})}, {0, 2, 3}) ==
        Seen{"own", "move x+1.00", "own x+2.00"});
  CHECK(of({act(0, Profile::drop, 1, 2), act(0, Profile::demolish, 3, 4), act(0, Profile::drop, 6, 7)},
           {0, 1, 2, 5, 6, 7}) == Seen{"-", "own y+1.00", "own", "-", "own y+1.00", "own"});
}

TEST_CASE("activities that take no time") {
  const auto of = [](const std::vector<Activity>& activities, const std::vector<double>& times_s) {
    Scene scene = row_of_boxes(2);
    applied(scene, activities);
    scene.duration_s = 20;
    return seen_at(scene, 0, times_s);
  };
  CHECK(of({act(0, Profile::construct, 3, 3)}, {0, 2.99, 3}) == Seen{"-", "-", "own"});
  CHECK(of({act(0, Profile::demolish, 3, 3)}, {0, 2.99, 3}) == Seen{"own", "own", "-"});
  CHECK(of({act(0, Profile::temporary, 3, 3)}, {0, 3, 4}) == Seen{"-", "-", "-"});
  CHECK(of({act(0, Profile::drop, 3, 3)}, {0, 3, 4}) == Seen{"-", "own", "own"});
  CHECK(of({act(0, Profile::move, 3, 3, {2, 0, 0})}, {0, 2.99, 3, 4}) ==
        Seen{"own", "own", "own x+2.00", "own x+2.00"});
  CHECK(of({act(0, Profile::move, 1, 3, {2, 0, 0}), act(0, Profile::move, 3, 3, {0, 0, 4})},
           {1, 2, 2.99, 3}) == Seen{"move", "move x+1.00", "move x+2.00", "own x+2.00 z+4.00"});
  CHECK(of({act(0, Profile::appear, 0, 0)}, {0}) == Seen{"own"});
  CHECK(of({act(0, Profile::construct, 0, 1)}, {0, 1}) == Seen{"construct", "own"});
  CHECK(of({act(0, Profile::move, 0, 0, {2, 0, 0})}, {0, 4}) == Seen{"own x+2.00", "own x+2.00"});
  // So short that float32 cannot tell the keys apart.
  CHECK(of({act(0, Profile::move, 8, 8.000001, {2, 0, 0})}, {7, 9}) == Seen{"own", "own x+2.00"});
}

TEST_CASE("contradictions are errors that name the object") {
  using Catch::Matchers::Contains;
  CHECK_THAT(failure({act(1, Profile::construct, 2, 4), act(1, Profile::demolish, 2, 5)}),
             Contains("'box_1'") && Contains("demolish at 2 s: construct starts at the same time"));
  CHECK_THAT(failure({act(0, Profile::demolish, 2, 4), act(0, Profile::move, 6, 7)}),
             Contains("move at 6 s: it is not there then"));
  CHECK_THAT(failure({act(0, Profile::temporary, 2, 4), act(0, Profile::demolish, 4, 7)}),
             Contains("demolish at 4 s: it is not there then"));
  CHECK_THAT(failure({act(0, Profile::construct, 2, 4), act(0, Profile::temporary, 3, 7)}),
             Contains("temporary at 3 s: it is there already"));
  CHECK_THAT(failure({act(0, Profile::construct, 2, 4), act(0, Profile::drop, 5, 7)}),
             Contains("drop at 5 s: it is there already"));
  CHECK_THAT(failure({act(0, Profile::demolish, 2, 9), act(0, Profile::construct, 5, 7)}),
             Contains("construct at 5 s: it is going away until 9 s"));
  CHECK_THAT(failure({act(0, Profile::move, 2, 5, {1, 0, 0}), act(0, Profile::move, 4, 7, {1, 0, 0})}),
             Contains("move at 4 s: it is still on its way until 5 s"));
  CHECK_THAT(failure({act(0, Profile::construct, 2, 1)}), Contains("construct from 2"));
  CHECK_THAT(failure({act(0, Profile::construct, -1, 1)}), Contains("times must be"));
  CHECK_THAT(failure({act(0, Profile::construct, 0, NAN)}), Contains("times must be"));
  CHECK_THAT(failure({act(0, Profile::construct, INFINITY, INFINITY)}), Contains("times must be"));
  CHECK_THAT(failure({act(0, Profile::move, 0, 1, {NAN, 0, 0})}), Contains("offsets finite"));
  CHECK_THAT(failure({act(9, Profile::construct, 0, 1)}), Contains("no object 9 of 2"));
}

TEST_CASE("a swapped highlight keeps what its material must") {
  Scene scene = row_of_boxes(2);
  const ProfileResult result =
      applied(scene, {act(0, Profile::construct, 1, 2), act(1, Profile::construct, 1, 2)});
  CHECK(result.first_new_material == 3);
  CHECK(result.copy_of.size() == scene.materials.size() - 3);
  CHECK(std::none_of(result.copy_of.begin(), result.copy_of.end(), [](MaterialId id) { return id.valid(); }));
  REQUIRE(scene.meshes.size() == 4);
  const auto highlight = [&](std::size_t mesh, std::size_t primitive) {
    CHECK(scene.meshes[mesh].primitives[primitive].geometry == GeometryId(0));
    return scene.materials[scene.meshes[mesh].primitives[primitive].material.value];
  };
  const Material opaque = highlight(2, 0), glass = highlight(2, 1), leaves = highlight(3, 0);
  CHECK(opaque.double_sided);
  CHECK_FALSE(opaque.base_color_texture.texture.valid());
  CHECK_FALSE(opaque.normal_texture.texture.valid());
  CHECK(opaque.alpha_mode == AlphaMode::opaque);
  CHECK(spell_color(opaque.base_color) == "#43b05c");
  CHECK(glass.alpha_mode == AlphaMode::blend);
  CHECK(glass.base_color.w == 0.5F);
  CHECK_FALSE(glass.double_sided);
  CHECK(leaves.alpha_mode == AlphaMode::mask);
  CHECK(leaves.alpha_cutoff == 0.25F);
  CHECK(leaves.base_color_texture.texture == TextureId(0));
}

TEST_CASE("what is never seen in its own look needs no track") {
  Scene scene = row_of_boxes(1);
  applied(scene, {act(0, Profile::temporary, 1, 2)});
  CHECK(scene.object_mesh_tracks.empty());
  CHECK(seen_at(scene, 0, {0, 1, 2}) == Seen{"-", "temporary", "-"});
}

TEST_CASE("pointer animates a copy of the material") {
  Scene scene = row_of_boxes(3);
  ProfileOptions options;
  options.color = ColorForm::pointer;
  const ProfileResult result = applied(
      scene,
      {act(0, Profile::construct, 1, 2), act(1, Profile::construct, 1, 2), act(2, Profile::operate, 1, 2)},
      options);
  CHECK(result.first_new_material == 3);
  // One of each material and timeline.
  CHECK(result.copy_of ==
        std::vector<MaterialId>{MaterialId(kOpaque), MaterialId(kGlass), MaterialId(kLeaves)});
  CHECK(scene.objects.mesh[0] == scene.objects.mesh[1]);
  CHECK(scene.object_mesh_tracks.empty());
  CHECK(scene.materials[3].base_color_texture.texture == TextureId(0));
  scene.duration_s = 9;
  CHECK(seen_at(scene, 0, {0, 1, 2}) == Seen{"-", "#43b05c", "own"});
  Player player(compile(scene));
  player.seek(1.5);
  CHECK(player.base_color(MaterialId(4)).w == 0.5F);  // glass stays see-through
}

TEST_CASE("no highlight where its alpha is 0, see-through where it is below 1") {
  Scene scene = row_of_boxes(2);
  ProfileOptions options;
  options.highlight[static_cast<std::size_t>(Profile::construct)].w = 0;
  options.highlight[static_cast<std::size_t>(Profile::drop)] = {1, 0, 0, 0.25F};
  applied(scene, {act(0, Profile::construct, 1, 2), act(1, Profile::drop, 1, 2)}, options);
  CHECK(seen_at(scene, 0, {1.5}) == Seen{"own"});
  REQUIRE(scene.object_mesh_tracks.size() == 1);
  CHECK(scene.object_mesh_tracks[0].object == ObjectId(1));
  CHECK(scene.materials.back().base_color.w == 0.25F);
}

TEST_CASE("offsets are of the world whatever frame an object hangs on") {
  Scene scene = row_of_boxes(2);
  scene.frames.resize(2);
  scene.frames[0].name = "turned";
  scene.frames[0].local.rotation = glm::quat(0.70710678F, 0, 0, 0.70710678F);  // 90 degrees about z
  scene.frames[0].local.scale = {2, 4, 8};
  scene.frames[1].name = "sheared";
  scene.frames[1].parent = FrameId(0);
  scene.frames[1].has_matrix = true;
  scene.frames[1].matrix[1][0] = 0.5F;
  scene.objects.frame[0] = FrameId(0);
  scene.objects.frame[1] = FrameId(1);
  const glm::vec3 offset(1, 2, 3);
  const auto frames = rest_frame_matrices(scene);
  const glm::mat4 before[2] = {rest_world_from_object(scene, frames, ObjectId(0)),
                               rest_world_from_object(scene, frames, ObjectId(1))};
  applied(scene, {act(0, Profile::move, 1, 2, offset), act(1, Profile::move, 1, 2, offset)});
  CHECK(scene.frames.size() == 4);
  Player player(compile(scene));
  for (std::uint32_t i = 0; i < 2; ++i) {
    player.seek(0);
    CHECK(glm::vec3(player.world_from_object(ObjectId(i))[3]) == glm::vec3(before[i][3]));
    player.seek(2);
    const glm::vec3 moved = glm::vec3(player.world_from_object(ObjectId(i))[3] - before[i][3]);
    CHECK(glm::length(moved - offset) < 1e-4F);
  }
}

TEST_CASE("a frame that offsets cannot be expressed in is an error") {
  Scene scene = row_of_boxes(1);
  scene.frames.resize(1);
  scene.frames[0].name = "flat";
  scene.frames[0].local.scale = {1, 0, 1};
  scene.objects.frame[0] = FrameId(0);
  const std::vector<Activity> drop{act(0, Profile::drop, 1, 2)};
  const auto result = apply_profiles(scene, drop, {});
  REQUIRE_FALSE(result);
  CHECK(result.error().kind == ErrorKind::bad_input);
  CHECK_THAT(result.error().str(), Catch::Matchers::Contains("'flat'"));
  const std::vector<Activity> construct{act(0, Profile::construct, 1, 2)};
  CHECK(apply_profiles(scene, construct, {}));  // moves nothing
}

TEST_CASE("what an object's look is driven by already is an error") {
  Scene scene = row_of_boxes(2);
  const std::vector<Activity> construct{act(0, Profile::construct, 1, 2)};
  applied(scene, construct);
  const auto again = apply_profiles(scene, construct, {});
  REQUIRE_FALSE(again);
  CHECK_THAT(again.error().str(), Catch::Matchers::Contains("'box_0'") && Catch::Matchers::Contains("look"));
  scene = row_of_boxes(2);
  scene.material_tracks.push_back(
      {MaterialId(kGlass), scene.add_track(Property::base_color, Interpolation::step, std::vector{0.0F},
                                           std::vector{1.F, 1.F, 1.F, 1.F})});
  ProfileOptions options;
  options.color = ColorForm::pointer;
  CHECK_THAT(apply_profiles(scene, construct, options).error().str(), Catch::Matchers::Contains("'glass'"));
  CHECK(apply_profiles(scene, construct, {}));  // swap leaves the material alone
}

TEST_CASE("visibility that was there stays under move and operate only") {
  Scene scene = row_of_boxes(3);
  const TrackId track = scene.add_track(Property::visibility, Interpolation::step, std::vector{0.0F, 0.5F},
                                        std::vector{0.0F, 1.0F});
  for (TrackId& id : scene.objects.visibility) id = track;
  applied(scene, {act(0, Profile::move, 1, 2, {1, 0, 0}), act(1, Profile::appear, 0.75, 0.75)});
  CHECK(scene.objects.visibility[0] == track);
  CHECK(seen_at(scene, 0, {0, 0.5})[1] == "own");
  CHECK(seen_at(scene, 1, {0.5, 0.75}) == Seen{"-", "own"});
}

TEST_CASE("objects with equal timelines share everything") {
  constexpr std::size_t kCount = 4000;
  constexpr std::size_t kMoments = 40;
  Scene scene = row_of_boxes(kCount);
  std::vector<Activity> activities;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const double start_s = 1 + static_cast<double>(i % kMoments);
    activities.push_back(act(i, i % 2 == 0 ? Profile::drop : Profile::construct, start_s, start_s + 2));
  }
  applied(scene, activities);
  CHECK(scene.frames.size() == kMoments / 2);
  CHECK(scene.meshes.size() == 4);
  // Visibility and way or look (of the one object of leaves, which is odd, too) for each moment.
  CHECK(scene.tracks.size() == kMoments + kMoments / 2 + kMoments / 2 + 1);
  CHECK(scene.object_mesh_tracks.size() == kCount / 2);
}

TEST_CASE("the same activities in any order give the same scene") {
  const Random random(3, "profiles");
  std::vector<Activity> activities;
  for (std::uint32_t i = 0; i < 300; ++i) {
    const double start_s = 1 + static_cast<double>(random.below(2 * i, 20));
    const auto profile = static_cast<Profile>(random.below(2 * i + 1, kProfileCount));
    activities.push_back(act(i, profile, start_s, start_s + 2, {1, 2, 3}));
  }
  Scene a = row_of_boxes(300), b = row_of_boxes(300);
  applied(a, activities);
  std::reverse(activities.begin(), activities.end());
  applied(b, activities);
  CHECK(a.track_times_s == b.track_times_s);
  CHECK(a.track_values == b.track_values);
  CHECK(a.objects.frame == b.objects.frame);
  CHECK(a.objects.visibility == b.objects.visibility);
}

TEST_CASE("appearance along a curve under every profile") {
  for (std::size_t i = 0; i < kProfileCount; ++i) {
    const auto profile = static_cast<Profile>(i);
    for (const ColorForm color : {ColorForm::swap, ColorForm::pointer}) {
      INFO(name(profile) << (color == ColorForm::swap ? " swap" : " pointer"));
      Scene scene = row_of_boxes(100);
      AppearanceOptions appearance;
      appearance.cells = {50, 1, 1};
      appearance.interval_s = 0.5;
      appearance.coherence = 0.8;
      const auto info = assign_appearance(scene, appearance);
      REQUIRE(info);
      const std::vector<Activity> activities = activities_of_appearance(scene, {profile, 0, {0, 5, 0}});
      REQUIRE(activities.size() == 100);
      ProfileOptions options;
      options.color = color;
      REQUIRE(apply_curve_profiles(scene, activities, options));
      CHECK(validate(scene).empty());
      CHECK(measure_coherence(scene).value() == info->coherence_measured);
      CHECK(info->coherence_measured == Approx(0.8));
      float last_s = 0;
      for (const Activity& a : activities) {
        const bool lasts = profile != Profile::appear && profile != Profile::neutral;
        last_s = std::max(last_s, static_cast<float>(lasts ? a.finish_s : a.start_s));
      }
      CHECK(scene.duration_s == Approx(last_s + 1.0F));
      // Nothing is left over of the appearance before.
      std::set<std::uint32_t> used;
      for (const TrackId id : scene.objects.visibility) used.insert(id.value);
      for (const auto& use : scene.frame_tracks) used.insert(use.track.value);
      for (const auto& use : scene.object_mesh_tracks) used.insert(use.track.value);
      for (const auto& use : scene.material_tracks) used.insert(use.track.value);
      used.erase(TrackId().value);
      CHECK(used.size() == scene.tracks.size());
    }
  }
}

}  // namespace scenegen::timeline
