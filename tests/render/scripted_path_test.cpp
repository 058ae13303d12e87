// Paths that are made from a scene: what they promise, for scenes of every shape.
#include "render/scripted_path.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "gen/generate.h"

using namespace scenegen;
using namespace scenegen::render;

namespace {

std::vector<Box> town_boxes() {
  gen::TownOptions town;
  town.grid = {3, 2};
  auto made = gen::generate_town(town);
  REQUIRE(made);
  return object_bounds(made->scene);
}

bool in_picture(const View& view, const glm::vec3& p) {
  const glm::vec4 c = view.clip_from_world * glm::vec4(p, 1.0F);
  return c.w > 0 && std::abs(c.x) <= c.w && std::abs(c.y) <= c.w && c.z <= c.w;
}

bool shows_all(const View& view, const Box& b) {
  for (int k = 0; k < 8; ++k) {
    const glm::vec3 p((k & 1) != 0 ? b.lo.x : b.hi.x, (k & 2) != 0 ? b.lo.y : b.hi.y,
                      (k & 4) != 0 ? b.lo.z : b.hi.z);
    if (!in_picture(view, p)) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("scripted paths are files, last as long as the timeline, and are the same every time") {
  const std::vector<std::vector<Box>> scenes{
      town_boxes(),
      {},
      {{{0, 0, 0}, {0, 0, 0}}},
      {{{-1e-3F, 0, -1e-3F}, {1e-3F, 1e-3F, 1e-3F}}},
      {{{1e5F, 3, 1e5F}, {1.2e5F, 3, 1.4e5F}}},
      {{{-1, 0, -1}, {1, 500, 1}}},
  };
  for (const auto& boxes : scenes) {
    for (const std::string_view name : scripted_path_names()) {
      INFO(name << ", scene " << &boxes - scenes.data());
      const auto path = scripted_path(name, boxes, 37.5);
      REQUIRE(path);
      CHECK(path->keys.front().time_s == 0);
      CHECK((path->keys.size() == 1 || path->keys.back().time_s <= 37.5));
      const std::string text = camera_path_json(*path);
      const auto read = parse_camera_path(text, "p");
      INFO(text);
      REQUIRE(read);
      CHECK(camera_path_json(*read) == text);
      CHECK(camera_path_json(*scripted_path(name, boxes, 37.5)) == text);
      for (double t = 0; t < 37.5; t += 0.37) REQUIRE(read->at(t).eye_m == path->at(t).eye_m);
    }
  }
  CHECK_FALSE(scripted_path("orbi", scenes[0], 10));
  CHECK(scripted_path("orbit", scenes[0], 0)->keys.back().time_s == kStillPathS);
}

TEST_CASE("fixed and orbit show the whole scene at every moment") {
  const std::vector<Box> boxes = town_boxes();
  const Box framed = framed_bounds(boxes);
  for (const char* name : {"fixed", "orbit"}) {
    const auto path = scripted_path(name, boxes, 20);
    for (double t = 0; t <= 20; t += 0.1) REQUIRE(shows_all(path->view(t, 16.0F / 9.0F), framed));
  }
  const auto orbit = scripted_path("orbit", boxes, 20);
  CHECK(orbit->keys.front().eye_m == orbit->keys.back().eye_m);  // a whole turn
  CHECK(glm::distance(orbit->at(0).eye_m, orbit->at(10).eye_m) >
        0.8 * 2 * glm::distance(orbit->at(0).eye_m, orbit->at(0).target_m));
}

TEST_CASE("walk goes along a street, through no wall, there and back") {
  const std::vector<Box> boxes = town_boxes();
  const auto path = scripted_path("walk", boxes, 100);
  REQUIRE(path);
  for (double t = 0; t <= 100; t += 0.05) {
    const glm::vec3 eye(path->at(t).eye_m);
    const bool inside = std::any_of(boxes.begin(), boxes.end(), [&](const Box& b) {
      return glm::all(glm::lessThan(b.lo, eye)) && glm::all(glm::lessThan(eye, b.hi));
    });
    REQUIRE_FALSE(inside);
  }
  CHECK(path->at(0).eye_m.y == path->at(80).eye_m.y);
  const auto forward = [&](double t) { return glm::normalize(path->at(t).target_m - path->at(t).eye_m); };
  CHECK(glm::dot(forward(10), forward(90)) < -0.8);
}

TEST_CASE("cuts hold each view and jump to the next") {
  const auto path = scripted_path("cuts", town_boxes(), 60);
  REQUIRE(path);
  REQUIRE(path->interpolation == PathInterpolation::step);
  for (int i = 0; i < 6; ++i) {
    CHECK(path->at(10.0 * i).eye_m == path->at(10.0 * i + 9.99).eye_m);
    if (i > 0) CHECK(glm::distance(path->at(10.0 * i).eye_m, path->at(10.0 * i - 0.01).eye_m) > 1);
  }
}
