#include "render/view.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "render/camera_path.h"
#include "scene/random.h"

using namespace scenegen;
using namespace scenegen::render;

namespace {

glm::vec4 clip(const View& view, const glm::vec3& p) {
  return view.clip_from_world * glm::vec4(p, 1.0F);
}

Box box_at(const glm::vec3& centre, const glm::vec3& size) {
  return {centre - 0.5F * size, centre + 0.5F * size};
}

std::vector<glm::vec3> corners(const Box& b) {
  std::vector<glm::vec3> out;
  for (const float x : {b.lo.x, b.hi.x})
    for (const float y : {b.lo.y, b.hi.y})
      for (const float z : {b.lo.z, b.hi.z}) out.emplace_back(x, y, z);
  return out;
}

}  // namespace

TEST_CASE("depth is 1 at the near plane, falls to 0, and turns back into metres") {
  Lens lens;
  lens.near_m = 0.25F;
  for (const float far_m : {0.0F, 100.0F}) {
    lens.far_m = far_m;
    const View view = make_view(look_at({0, 0, 5}, {0, 0, 0}), lens, 1.5F);
    for (const float d : {0.25F, 1.0F, 7.5F, 60.0F}) {
      const glm::vec4 c = clip(view, {0, 0, 5 - d});
      CHECK(c.w == Approx(d));
      CHECK(view.distance_m(c.z / c.w) == Approx(d).epsilon(1e-4));
    }
    const glm::vec4 near = clip(view, {0, 0, 4.75F});
    CHECK(near.z / near.w == Approx(1.0F));
    CHECK(view.distance_m(0.0F) ==
          (far_m > 0 ? Approx(100.0F) : Approx(std::numeric_limits<float>::infinity())));
  }
  lens.orthographic = true;
  const View view = make_view(look_at({0, 0, 5}, {0, 0, 0}), lens, 1.5F);
  const glm::vec4 c = clip(view, {0, 0, -15});
  CHECK(c.w == 1.0F);
  CHECK(view.distance_m(c.z) == Approx(20.0F));
}

TEST_CASE("right is right and up is up (clip y runs down)") {
  const View view = make_view(look_at({0, 0, 5}, {0, 0, 0}), Lens{}, 1.0F);
  CHECK(clip(view, {1, 0, 0}).x > 0.0F);
  CHECK(clip(view, {0, 1, 0}).y < 0.0F);
  const View down = make_view(look_at({0, 5, 0}, {0, 0, 0}), Lens{}, 1.0F);
  CHECK(std::isfinite(down.clip_from_world[0][0]));
  CHECK(clip(down, {0, 0, 0}).w == Approx(5.0F));
}

TEST_CASE("framing shows every corner, as large as the margin allows, whatever the shape") {
  for (const glm::vec3 size :
       {glm::vec3(1), glm::vec3(100, 1, 1), glm::vec3(1, 80, 2), glm::vec3(3, 2, 500)}) {
    for (const float aspect : {0.5F, 1.0F, 1.78F}) {
      const std::vector<Box> boxes{box_at({10, 20, -30}, size)};
      const View view = frame_boxes(boxes, aspect);
      float widest = 0;
      for (const glm::vec3& p : corners(boxes[0])) {
        const glm::vec4 c = clip(view, p);
        REQUIRE(c.w > view.lens.near_m);
        CHECK(std::abs(c.x) <= 0.94F * c.w);
        CHECK(std::abs(c.y) <= 0.94F * c.w);
        widest = std::max({widest, std::abs(c.x) / c.w, std::abs(c.y) / c.w});
      }
      CHECK(widest > 0.6F);
    }
  }
  CHECK(std::isfinite(frame_boxes({}, 1.0F).clip_from_world[0][0]));
}

TEST_CASE("framing does not step back for a ground") {
  std::vector<Box> boxes{box_at({0, 5, 0}, {10, 10, 10}), box_at({0, 0, 0}, {0, 0, 0})};
  const View alone = frame_boxes(boxes, 1.5F);
  boxes.push_back(box_at({0, -0.1F, 0}, {200, 0.2F, 200}));
  const View with_ground = frame_boxes(boxes, 1.5F);
  CHECK(with_ground.clip_from_world == alone.clip_from_world);
  CHECK(framed_bounds(boxes) == framed_bounds(std::span(boxes).first(2)));
}

TEST_CASE("the frustum test never rejects a box with a point inside") {
  const Random random(7, "frustum");
  const View view = make_view(look_at({3, 2, 9}, {0, 1, 0}), Lens{}, 1.6F);
  const Frustum frustum = frustum_of(view.clip_from_world);
  std::uint64_t rejected = 0;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const glm::vec3 at(random.unit(6 * i) * 40 - 20, random.unit(6 * i + 1) * 40 - 20,
                       random.unit(6 * i + 2) * 40 - 20);
    const glm::vec3 size(random.unit(6 * i + 3), random.unit(6 * i + 4), random.unit(6 * i + 5));
    const Box box = box_at(at, size);
    const bool touches = intersects(frustum, box);
    for (const glm::vec3& p : corners(box)) {
      const glm::vec4 c = clip(view, p);
      const bool inside = std::abs(c.x) <= c.w && std::abs(c.y) <= c.w && c.z >= 0 && c.z <= c.w;
      if (inside) REQUIRE(touches);
    }
    if (!touches) ++rejected;
  }
  CHECK(rejected > 10000);
  CHECK_FALSE(intersects(frustum, Box{}));
}

TEST_CASE("the shadow map covers what is seen, with all casters between near and far") {
  const Box scene{{-50, 0, -50}, {50, 20, 50}};
  const View view = make_view(look_at({10, 5, 20}, {0, 2, 0}), Lens{}, 1.6F);
  const glm::vec3 to_sun = glm::normalize(glm::vec3(-0.4F, 0.6F, 0.7F));
  const glm::mat4 m = shadow_clip_from_world(view, scene, to_sun, 1024);
  for (const glm::vec3& p : corners(scene)) {
    const glm::vec4 c = m * glm::vec4(p, 1);
    CHECK(c.z >= 0.0F);
    CHECK(c.z <= 1.0F);
  }
  const glm::vec4 seen = m * glm::vec4(0, 2, 0, 1);
  CHECK(std::abs(seen.x) <= 1.0F);
  CHECK(std::abs(seen.y) <= 1.0F);
  // Nearer to the sun is a greater depth.
  const glm::vec4 above = m * glm::vec4(glm::vec3(0, 2, 0) + to_sun, 1);
  CHECK(above.z > seen.z);
  CHECK(above.x == Approx(seen.x).margin(1e-4));
}

TEST_CASE("a camera path passes through its keys and holds at its ends") {
  const auto path = parse_camera_path(
      R"({"version":1,"keys":[{"time_s":1,"eye_m":[0,0,10],"target_m":[0,0,0],"yfov_rad":0.5},
          {"time_s":3,"eye_m":[10,0,0],"target_m":[0,1,0],"yfov_rad":0.7},
          {"time_s":4,"eye_m":[10,5,-10],"target_m":[0,2,0]}]})",
      "path.json");
  REQUIRE(path);
  CHECK(path->at(-5).eye_m == glm::dvec3(0, 0, 10));
  CHECK(path->at(1).eye_m == glm::dvec3(0, 0, 10));
  CHECK(path->at(3).eye_m == glm::dvec3(10, 0, 0));
  CHECK(path->at(3).yfov_rad == Approx(0.7));
  CHECK(path->at(99).target_m == glm::dvec3(0, 2, 0));
  CHECK(path->at(99).yfov_rad == Approx(0.6));
  // Smooth at the middle key: equal slopes on both sides.
  const double h = 1e-5;
  const double before = (path->at(3).eye_m.x - path->at(3 - h).eye_m.x) / h;
  const double after = (path->at(3 + h).eye_m.x - path->at(3).eye_m.x) / h;
  CHECK(before == Approx(after).margin(1e-3));
  CHECK(before == Approx(10.0 / 3.0).margin(1e-3));
}

TEST_CASE("a linear camera path is straight") {
  const auto path = parse_camera_path(
      R"({"interpolation":"linear","keys":[{"time_s":0,"eye_m":[0,0,8],"target_m":[0,0,0]},
          {"time_s":2,"eye_m":[4,0,8],"target_m":[0,2,0]},{"time_s":9,"eye_m":[4,9,8],"target_m":[0,2,0]}]})",
      "path.json");
  REQUIRE(path);
  CHECK(path->at(0.5).eye_m.x == Approx(1.0));
  CHECK(path->at(1.0).target_m.y == Approx(1.0));
  CHECK(path->view(1.0, 1.5F).eye_m().x == Approx(2.0F));
}

TEST_CASE("damaged camera paths are refused and located") {
  const auto error = [](const char* text) {
    const auto path = parse_camera_path(text, "p");
    REQUIRE_FALSE(path);
    CHECK(path.error().kind == ErrorKind::bad_input);
    return path.error().where;
  };
  CHECK(error("{") == "p");
  CHECK(error("[]") == "p");
  CHECK(error(R"({"keys":[]})") == "p: /keys");
  CHECK(error(R"({"version":2,"keys":[]})") == "p: /version");
  CHECK(error(R"({"interpolation":"cubic","keys":[]})") == "p: /interpolation");
  CHECK(error(R"({"keys":[{"time_s":"a"}]})") == "p: /keys/0/time_s");
  CHECK(error(R"({"keys":[{"time_s":0,"eye_m":[0,1]}]})") == "p: /keys/0/eye_m");
  CHECK(error(R"({"keys":[{"time_s":0,"eye_m":[0,1,1e300],"target_m":[0,0,0]}]})") == "p: /keys/0/eye_m");
  CHECK(error(R"({"keys":[{"time_s":0,"eye_m":[0,1,1],"target_m":[0,1,1]}]})") == "p: /keys/0/target_m");
  CHECK(error(R"({"keys":[{"time_s":0,"eye_m":[0,1,1],"target_m":[0,1,0],"yfov_rad":4}]})") ==
        "p: /keys/0/yfov_rad");
  CHECK(error(R"({"keys":[{"time_s":0,"eye_m":[0,1,1],"target_m":[0,1,0]},
                          {"time_s":0,"eye_m":[0,1,1],"target_m":[0,1,0]}]})") == "p: /keys/1/time_s");
}
