// Calibration files: what is written is read, what is damaged is named, what is for something else refused.
// And a measurement in a small picture: units that are costs.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <nlohmann/json.hpp>

#include "render/calibration/calibration_file.h"
#include "render/calibration/fit.h"
#include "render/calibration/measure.h"
#include "render/calibration/unit_names.h"

using namespace scenegen;
using namespace scenegen::render;
using nlohmann::json;

namespace {

/// Every unit another value.
Calibration sample() {
  Calibration c;
  c.key = {"00112233445566778899aabbccddeeff", "A GPU", "driver 1.2", {640, 360}, 4, true};
  c.quick = true;
  c.not_measured = {"nodeCommandS"};
  c.clamped = {"queryS"};
  double next = 1e-9;
  for (const UnitName& unit : unit_names()) {
    if (unit.value != nullptr) c.costs.*unit.value = unit.share ? 0.25 : next *= 1.125;
    if (unit.curve != nullptr) c.costs.*unit.curve = {{1, 10, 100}, {next *= 1.5, next * 2, next * 3}};
    if (unit.curves != nullptr) {
      for (model::Curve& curve : c.costs.*unit.curves) curve = {{0.5, 1}, {next *= 1.5, next / 3}};
    }
  }
  return c;
}

/// The error of the sample's file after a change.
std::string error_after(const std::function<void(json&)>& change) {
  json document = json::parse(calibration_json(sample()));
  change(document);
  const Result<Calibration> read = parse_calibration(document.dump(), "c.json");
  REQUIRE_FALSE(read);
  CHECK(read.error().kind == ErrorKind::bad_input);
  return read.error().str();
}

bool holds(const std::string& text, const std::string& part) {
  INFO(text);
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("calibration: what is written is read back, bit for bit") {
  const Calibration written = sample();
  const std::string text = calibration_json(written);
  const Result<Calibration> read = parse_calibration(text, "c.json");
  REQUIRE(read);
  CHECK(read->key == written.key);
  CHECK(read->quick);
  CHECK(read->not_measured == written.not_measured);
  CHECK(read->clamped == written.clamped);
  for (const UnitName& unit : unit_names()) {
    INFO(unit.name);
    if (unit.value != nullptr) CHECK(read->costs.*unit.value == written.costs.*unit.value);
    if (unit.curve != nullptr) {
      CHECK((read->costs.*unit.curve).x == (written.costs.*unit.curve).x);
      CHECK((read->costs.*unit.curve).y == (written.costs.*unit.curve).y);
    }
    if (unit.curves != nullptr) {
      for (std::size_t i = 0; i < model::kShadings; ++i)
        CHECK((read->costs.*unit.curves)[i].y == (written.costs.*unit.curves)[i].y);
    }
  }
  CHECK(calibration_json(*read) == text);
}

TEST_CASE("calibration: a damaged file is named with what is wrong in it") {
  const auto units = [](json& d) -> json& { return d["units"]; };
  CHECK(
      holds(error_after([&](json& d) { units(d).erase("recordS"); }), "c.json: /units/recordS: is missing"));
  CHECK(holds(error_after([&](json& d) { units(d)["recordS"] = -1e-9; }), "/units/recordS"));
  CHECK(holds(error_after([&](json& d) { units(d)["recordS"] = 1e9; }), "0.0 to 100.0"));
  CHECK(holds(error_after([&](json& d) { units(d)["recordS"] = "fast"; }), "must be a number"));
  CHECK(holds(error_after([&](json& d) { units(d)["frameOverlap"] = 1.5; }), "/units/frameOverlap"));
  CHECK(holds(error_after([&](json& d) { units(d)["secondaryS"]["x"] = {1, 1, 2}; }), "ascending"));
  CHECK(holds(error_after([&](json& d) { units(d)["secondaryS"]["x"] = {0, 1, 2}; }), "positive"));
  CHECK(holds(error_after([&](json& d) { units(d)["secondaryS"]["y"] = {1e-6}; }), "x has 3 values, y 1"));
  CHECK(holds(error_after([&](json& d) { units(d)["secondaryS"]["y"][1] = nullptr; }), "/secondaryS/y/1"));
  CHECK(holds(error_after([&](json& d) { units(d)["secondaryS"]["x"] = json::array(); }), "1 to 64"));
  CHECK(
      holds(error_after([&](json& d) { units(d)["secondaryS"]["x"] = std::vector<int>(65, 1); }), "1 to 64"));
  CHECK(holds(error_after([&](json& d) { units(d)["drawS"].erase("textured"); }), "/units/drawS/textured"));
  CHECK(holds(error_after([&](json& d) { units(d)["drawS"] = 3; }), "/units/drawS: must be an object"));
  CHECK(holds(error_after([](json& d) { d["units"] = nullptr; }), "/units: must be an object"));
  CHECK(holds(error_after([](json& d) { d["version"] = 3; }),
              "/version: this program reads version 8, not 3; run"));
  CHECK(holds(error_after([](json& d) { d["schema"] = "sceneplay/frames"; }), "no calibration"));
  CHECK(holds(error_after([](json& d) { d["size"] = {0, 10}; }), "/size"));
  CHECK(holds(error_after([](json& d) { d["size"] = {-5, 10}; }), "/size"));
  CHECK(holds(error_after([](json& d) { d["shadows"] = "yes"; }), "/shadows"));
  CHECK(holds(error_after([](json& d) { d = json::array(); }), "c.json: must be a JSON object"));
  const std::string text = calibration_json(sample());
  CHECK(holds(parse_calibration(text.substr(0, text.size() / 2), "c.json").error().str(),
              "c.json: is damaged"));
  CHECK(holds(parse_calibration("", "c.json").error().str(), "is damaged"));
  CHECK(holds(parse_calibration(std::string(2 << 20, ' '), "c.json").error().str(), "above 1 MiB"));
}

TEST_CASE("calibration: one for something else is refused with what differs") {
  const Calibration c = sample();
  CHECK(check_calibration(c, c.key, "c.json"));
  const auto refused = [&](const std::function<void(CalibrationKey&)>& change, const std::string& why) {
    CalibrationKey wanted = c.key;
    change(wanted);
    const Result<void> fits = check_calibration(c, wanted, "c.json");
    REQUIRE_FALSE(fits);
    CHECK(holds(fits.error().str(), why));
  };
  refused([](CalibrationKey& k) { k.device_uuid[0] = 'f'; }, "another UUID");
  refused([](CalibrationKey& k) { k.device_uuid[0] = 'f', k.device = "B"; }, "'A GPU', this is 'B'");
  refused([](CalibrationKey& k) { k.driver = "driver 1.3"; }, "'driver 1.2', this is 'driver 1.3'");
  refused([](CalibrationKey& k) { k.size.x = 641; }, "640x360, this is 641x360");
  refused([](CalibrationKey& k) { k.samples = 1; }, "--samples 4, this is --samples 1");
  refused([](CalibrationKey& k) { k.shadows = false; }, "--shadows on, this is --shadows off");
}

TEST_CASE("calibration: its place in the cache tells sizes, samples and shadows apart") {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string(value != nullptr ? value : "");
  };
  const std::string cache = variable("XDG_CACHE_HOME");
  const std::string home = variable("HOME");
  ::setenv("XDG_CACHE_HOME", "/cache", 1);
  CalibrationKey key = sample().key;
  CHECK(calibration_path(key) ==
        "/cache/scenegen/calibration-00112233445566778899aabbccddeeff-640x360-4-shadows.json");
  key.shadows = false;
  CHECK(calibration_path(key) ==
        "/cache/scenegen/calibration-00112233445566778899aabbccddeeff-640x360-4.json");
  ::setenv("XDG_CACHE_HOME", "not/absolute", 1);
  ::setenv("HOME", "/home/somebody", 1);
  CHECK(holds(*calibration_path(key), "/home/somebody/.cache/scenegen/"));
  ::unsetenv("HOME");
  const Result<std::string> nowhere = calibration_path(key);
  ::setenv("HOME", home.c_str(), 1);  // drivers look for it
  cache.empty() ? ::unsetenv("XDG_CACHE_HOME") : ::setenv("XDG_CACHE_HOME", cache.c_str(), 1);
  REQUIRE_FALSE(nowhere);
  CHECK(nowhere.error().kind == ErrorKind::io);
}

TEST_CASE("calibration: a line through points") {
  const calibration::Line exact = calibration::fit_line({1, 2, 5}, {5, 7, 13});
  CHECK(exact.slope == Approx(2));
  CHECK(exact.offset == Approx(3));
  CHECK(calibration::fit_line({0, 1, 2}, {0, 1, 5}).slope == Approx(2.5));
  CHECK(calibration::fit_line({3, 3}, {1, 2}).slope == 0);
}

TEST_CASE("calibration: the middle of few times") {
  CHECK(calibration::median({}) == 0.0);
  CHECK(calibration::median({3, 1, 2}) == 2.0);
  CHECK(calibration::median({4, 1, 3, 2}) == 2.5);
  CHECK(calibration::lower_median({}) == 0.0);
  CHECK(calibration::lower_median({9, 1}) == 1.0);
  CHECK(calibration::lower_median({3, 1, 2}) == 2.0);
  CHECK(calibration::lower_median({4, 1, 3, 2}) == 2.0);
}

TEST_CASE("calibration: the test scene shows at each step what it says") {
  const calibration::TestSizes sizes = calibration::test_sizes(true, true);
  const calibration::TestScene test = calibration::make_test_scene(sizes, {320, 180});
  timeline::Player player(timeline::compile(test.scene));
  for (const calibration::Step& step : test.steps) {
    player.seek(step.time_s);
    INFO(static_cast<int>(step.trial) << " at " << step.time_s);
    std::size_t expected = step.draws;
    if (step.trial == calibration::Trial::hidden_boxes) expected += 1;  // the wall
    CHECK(player.visible_count() == expected);
    for (std::uint32_t i = 0; i < test.scene.objects.size(); ++i) {
      if (!player.visible(ObjectId(i))) continue;
      const Mesh& mesh = test.scene.meshes[test.scene.objects.mesh[i].value];
      const Geometry& g = test.scene.geometries[mesh.primitives[0].geometry.value];
      if (g.drawn_vertex_count() == 6) continue;  // walls and layers
      REQUIRE(g.drawn_vertex_count() == step.vertices);
    }
  }
}

TEST_CASE("calibration: what took too long to be measured stays rough, and the file can be read") {
  // On a busy machine all layers over the picture may be left out.
  const calibration::TestScene test =
      calibration::make_test_scene(calibration::test_sizes(true, true), {64, 36});
  std::vector<calibration::Measured> results(test.steps.size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    const calibration::Step& step = test.steps[i];
    const bool left_out =
        step.trial == calibration::Trial::layers || step.trial == calibration::Trial::textured_layers;
    calibration::Measured& m = results[i];
    m.samples = left_out ? 0 : 1;
    m.steady.device_s = m.steady.gpu_s = left_out ? 0.0 : 1e-3 + 1e-8 * step.draws * (1 + step.vertices);
    m.report.facts.in_frustum = {static_cast<double>(step.draws),
                                 static_cast<double>(step.draws) * step.vertices,
                                 10,
                                 0,
                                 0.1,
                                 static_cast<double>(step.draws) * step.vertices / 3};
  }
  Calibration out = sample();
  out.not_measured.clear();
  out.costs = model::rough_costs(true);
  const model::Curve rough = out.costs.fragment_s[0];
  REQUIRE(!rough.x.empty());
  calibration::Fit fit(out, 64.0 * 36.0);
  fit.inline_run({&test, results});
  fit.finish();
  CHECK(out.costs.fragment_s[0].x == rough.x);
  CHECK(std::count(out.not_measured.begin(), out.not_measured.end(), "fragmentS") == 1);
  CHECK(std::count(out.not_measured.begin(), out.not_measured.end(), "drawS") == 0);
  const Result<Calibration> read = parse_calibration(calibration_json(out), "c.json");
  if (!read) FAIL(read.error().str());
}

TEST_CASE("calibration: tests, triangles, those between samples, and large frames come out as put in") {
  using calibration::Trial;
  const calibration::TestScene test =
      calibration::make_test_scene(calibration::test_sizes(true, true), {320, 180});
  // `many_s`: of each of the most boxes of next to no size.
  const auto fitted = [&](double many_s) {
    std::vector<calibration::Measured> results(test.steps.size());
    std::uint32_t few = 0;
    for (std::size_t i = 0; i < results.size(); ++i) {
      const calibration::Step& step = test.steps[i];
      const bool shared = step.trial == Trial::meshes || step.trial == Trial::speck_meshes;
      const double triangles = step.draws * step.vertices / 3.0;
      const double vertices = shared ? 0.5 * triangles : 3.0 * triangles;
      const double triangle_s = step.trial == Trial::speck_meshes ? 100e-9 : 200e-9;
      if (step.trial == Trial::speck_boxes && few == 0) few = step.draws;
      const bool many = step.trial == Trial::speck_boxes && step.draws > few;
      const bool box = step.trial == Trial::speck_boxes || step.trial == Trial::boxes;
      calibration::Measured& m = results[i];
      m.samples = 1;
      m.steady.device_s = m.steady.gpu_s =
          1e-3 + (box ? step.draws * (many ? many_s : 5e-6) : triangles * triangle_s + vertices * 40e-9);
      const double seen = step.draws * (step.trial == Trial::halved_boxes ? 0.5 : 1.0);
      m.report.facts.in_frustum = {seen, vertices, 0, 0, 0, triangles};
      m.steady.plan_s = 1e-4 + step.draws * 2e-9 + seen * 6e-9;
    }
    Calibration out = sample();
    out.costs = model::rough_costs(true);
    calibration::Fit(out, 320.0 * 180.0).inline_run({&test, results});
    return out.costs;
  };
  const model::UnitCosts level = fitted(5e-6);
  CHECK(level.triangle_s == Approx(200e-9).epsilon(0.01));
  CHECK(level.speck_triangle_s == Approx(100e-9).epsilon(0.01));
  CHECK(level.cull_slot_s == Approx(2e-9));
  CHECK(level.list_draw_s == Approx(6e-9));
  CHECK(level.bulk.y.back() == Approx(1));
  CHECK(fitted(4e-6).bulk.y.back() == Approx(0.8));
  CHECK(fitted(6e-6).bulk.y.back() == 1);  // more never take longer each
}

TEST_CASE("calibration: measured in a small picture, units are costs") {
  CalibrationOptions options;
  options.device.validation = true;
  options.size = {96, 54};
  options.quick = true;
  options.budget_s = 0.5;
  double last = 0;
  options.progress = [&](double share) {
    CHECK(share >= last);
    CHECK(share <= 1.0 + 1e-9);
    last = share;
  };
  const Result<Calibration> measured = calibrate(options);
  REQUIRE(measured);
  CHECK(last == Approx(1.0));
  const model::UnitCosts& c = measured->costs;
  // Those that no noise of a busy machine hides.
  CHECK(c.empty_cpu_s > 0.0);
  CHECK(c.empty_device_s > 0.0);
  CHECK(c.draw_s[0].line_at(3000) > 0.0);
  for (const UnitName& unit : unit_names()) {
    INFO(unit.name);
    if (unit.value != nullptr) CHECK((std::isfinite(c.*unit.value) && c.*unit.value >= 0.0));
  }
  // What is written of it is good, for itself.
  const Result<Calibration> read = parse_calibration(calibration_json(*measured), "c.json");
  if (!read) FAIL(read.error().str());
  CHECK(check_calibration(*read, measured->key, "c.json"));
  const std::vector<std::string>& rough = measured->not_measured;
  CHECK(std::find(rough.begin(), rough.end(), "recordS") == rough.end());
  CHECK(std::find(rough.begin(), rough.end(), "listSlotS") != rough.end());
}
