// The calendar of a scene in its file.
#include <catch2/catch.hpp>
#include <map>

#include "scene/gltf/read.h"
#include "scene/gltf/write.h"
#include "tests/support/synthetic_scene.h"

using namespace scenegen;

TEST_CASE("a calendar comes back as it was written") {
  Scene scene = testing::town_scene(3, 1);
  Calendar calendar;
  calendar.start = "2024-03-01T08:00:00";
  calendar.seconds_per_day = 0.1;
  calendar.tasks = {{"1", "walls \"all\"", "construct", 0, 1.0 / 3}, {"", "", "", 2.5, 2.5}};
  scene.info.calendar = calendar;
  const std::string path = "calendar_test.glb";
  REQUIRE(gltf::write(scene, path, {}));
  const auto read = gltf::read(path);
  REQUIRE(read);
  REQUIRE(read->scene.info.calendar);
  const Calendar& back = *read->scene.info.calendar;
  CHECK(back.start == calendar.start);
  CHECK(back.seconds_per_day == calendar.seconds_per_day);
  REQUIRE(back.tasks.size() == 2);
  CHECK(back.tasks[0].id == "1");
  CHECK(back.tasks[0].name == "walls \"all\"");
  CHECK(back.tasks[0].type == "construct");
  CHECK(back.tasks[0].finish_s == 1.0 / 3);
  CHECK(back.tasks[1].start_s == 2.5);
  (void)std::remove(path.c_str());
}

TEST_CASE("a calendar that says nothing sensible is refused") {
  const std::map<std::string, std::string> wrong{
      {R"({})", "/start: missing"},
      {R"({"start":"2024-03-01"})", "/secondsPerDay: must be above 0"},
      {R"({"start":"2024-03-01","secondsPerDay":0})", "/secondsPerDay: must be above 0"},
      {R"({"start":"2024-02-30","secondsPerDay":1})",
       "/start: wanted a date YYYY-MM-DD or YYYY-MM-DDTHH:MM:SS"},
      {R"({"start":"2024-02-03T25:00:00","secondsPerDay":1})",
       "/start: wanted a date YYYY-MM-DD or YYYY-MM-DDTHH:MM:SS"},
      {R"({"start":"1.3.2024","secondsPerDay":1})",
       "/start: wanted a date YYYY-MM-DD or YYYY-MM-DDTHH:MM:SS"},
      {R"({"start":"2024-03-01","secondsPerDay":1,"tasks":[{"start":2,"finish":1}]})",
       "/tasks/0: must start at 0 or later, and not finish before"}};
  for (const auto& [calendar, line] : wrong) {
    const std::string text =
        R"({"asset":{"version":"2.0","extras":{"scenegen":{"format":1,"calendar":)" + calendar + "}}}}";
    const auto read = gltf::read_memory({text.begin(), text.end()}, "x.gltf", "");
    REQUIRE_FALSE(read);
    CHECK(read.error().str() == "x.gltf: /asset/extras/scenegen/calendar" + line);
  }
}
