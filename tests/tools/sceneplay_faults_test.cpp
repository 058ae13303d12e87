// sceneplay on devices that fail, lack something or are not there: one line and exit code 4, or a slower way
// with a warning. A layer (tests/support/fault_layer.h) makes them of the device that there is.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "scene/gltf/write.h"
#include "tests/render/render_support.h"
#include "tests/support/fault_layer.h"
#include "tests/tools/process.h"

using namespace scenegen;
using namespace scenegen::test;

namespace {

/// sceneplay, with a fault or without some things.
ProcessResult play(const std::string& line, const std::string& fault, const std::string& lacks) {
  const std::filesystem::path layer = SCENEGEN_FAULT_LAYER;
  ::setenv("VK_ADD_LAYER_PATH", layer.parent_path().c_str(), 1);
  ::setenv("VK_INSTANCE_LAYERS", "VK_LAYER_SCENEGEN_faults", 1);
  ::setenv("NODEVICE_SELECT", "1", 1);  // Mesa's layer ends by a signal when there is no device
  ::setenv(kFaultVariable, fault.c_str(), 1);
  ::setenv(kLacksVariable, lacks.c_str(), 1);
  if (fault.empty()) ::unsetenv(kFaultVariable);
  const ProcessResult result = run(SCENEPLAY_PROGRAM, words(line));
  for (const char* name :
       {"VK_ADD_LAYER_PATH", "VK_INSTANCE_LAYERS", "NODEVICE_SELECT", kFaultVariable, kLacksVariable})
    ::unsetenv(name);
  return result;
}

std::string wall_file(const TemporaryFolder& folder) {
  const std::string path = folder.file("wall.glb");
  REQUIRE(gltf::write(render::test::wall_scene(), path, {}));
  return path;
}

/// One line on stderr that says all of `parts`, exit code 4.
void check_no_device(const ProcessResult& result, const std::vector<std::string>& parts) {
  INFO(result.err);
  CHECK(result.signal == 0);
  CHECK(result.code == 4);
  CHECK(result.out.empty());
  CHECK(result.err.starts_with("error: "));
  CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  for (const std::string& part : parts) CHECK_THAT(result.err, Catch::Matchers::Contains(part));
}

std::vector<std::string> files_in(const std::string& folder) {
  std::vector<std::string> out;
  if (!std::filesystem::exists(folder)) return out;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) out.push_back(entry.path().filename().string());
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

TEST_CASE("a device that is lost ends the program with a line; whole pictures stay, halves do not") {
  const TemporaryFolder folder;
  const std::string out = folder.file("out");
  const std::string call = "frames " + wall_file(folder) + " -o " + out +
                           " --size 32x18 --fps 10 --duration 2 --quiet --report " + folder.file("r.json");
  const ProcessResult all = play(call, "", "");
  INFO(all.err);
  REQUIRE(all.code == 0);
  const std::vector<std::string> names = files_in(out);
  REQUIRE(names.size() == 21);
  std::filesystem::remove_all(out);
  std::filesystem::remove(folder.file("r.json"));
  // Uploads submit before the first frame.
  check_no_device(play(call, "vkQueueSubmit:2:-4", ""), {"device '", "was lost", "ubmit"});
  CHECK(files_in(folder.path()) == std::vector<std::string>{"wall.glb"});
  for (const char* fault : {"vkQueueSubmit:20:-4", "vkWaitForFences:20:-4"}) {
    INFO(fault);
    check_no_device(play(call, fault, ""), {"device '", "was lost"});
    const std::vector<std::string> left = files_in(out);
    CHECK(!left.empty());
    CHECK(left.size() < names.size());
    CHECK(std::equal(left.begin(), left.end(), names.begin()));
    CHECK_FALSE(std::filesystem::exists(folder.file("r.json")));
    std::filesystem::remove_all(out);
  }
  check_no_device(play(call, "any:40:-2", ""), {"device '", "OutOfDeviceMemory", "need less"});
  check_no_device(play(call, "any:41:-1", ""), {"device '", "OutOfHostMemory", "needs less"});
  check_no_device(play(call, "vkCreateDevice:1:-3", ""), {"Vulkan: ", "InitializationFailed"});
  check_no_device(play(call, "vkCreateShaderModule:3:-3", ""),
                  {"device '", "ShaderModule", "InitializationFailed"});
  ::setenv("XDG_CACHE_HOME", folder.file("cache").c_str(), 1);
  check_no_device(play("calibrate --quick --size 32x18 --quiet", "vkQueueSubmit:60:-4", ""), {"was lost"});
  ::unsetenv("XDG_CACHE_HOME");
  CHECK(files_in(folder.file("cache/scenegen")).empty());  // beside it the driver may keep things of its own
}

TEST_CASE("a device that cannot be used is named with what it lacks") {
  const TemporaryFolder folder;
  const std::string call = "frames " + wall_file(folder) + " -o " + folder.file("out") + " --size 32x18";
  check_no_device(play(call, "", "devices"), {"no device found"});
  check_no_device(play(call, "", "vulkan13"), {"device '", "lacks Vulkan 1.3"});
  check_no_device(play(call, "", "synchronization2"), {"lacks synchronization2"});
  check_no_device(play(call, "", "graphics"), {"lacks a graphics queue"});
  const ProcessResult listed = play("--list-devices", "", "vulkan13");
  CHECK(listed.code == 0);
  CHECK_THAT(listed.out, Catch::Matchers::Contains("Vulkan 1.3"));
  CHECK(files_in(folder.path()) == std::vector<std::string>{"wall.glb"});
}

TEST_CASE("what a device lacks and can be done without is done without, with a warning where it costs") {
  const TemporaryFolder folder;
  const std::string report = folder.file("r.json");
  const std::string call =
      "frames " + wall_file(folder) + " -o " + folder.file("out") +
      " --size 32x18 --times 50%,100% --calibration none --octree-n 8 --validation on --report " + report +
      " --strategy ";
  const std::string conditional = "VK_EXT_conditional_rendering";
  const auto frame = [&] { return nlohmann::json::parse(read_file(report))["frames"][1]; };
  const auto check_good = [&](const ProcessResult& result, const std::string& warning) {
    INFO(result.err);
    REQUIRE(result.code == 0);
    if (warning.empty()) CHECK(result.err.empty());
    if (!warning.empty())
      CHECK_THAT(result.err, Catch::Matchers::Contains("warning: ") && Catch::Matchers::Contains(warning));
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == (warning.empty() ? 0 : 1));
  };
  check_good(play(call + "queries-all", "", conditional), "");
  CHECK(frame()["indirectCommands"].get<int>() > 0);
  check_good(play(call + "queries-all --node-form secondaries", "", conditional), "--late-visibility");
  for (const char* feature : {"drawIndirectCount", "multiDrawIndirect"}) {
    INFO(feature);
    check_good(play(call + "octree --node-form indirect", "", feature), "--node-form secondaries");
    CHECK(frame()["secondaries"].get<int>() > 0);
  }
  check_good(play(call + "queries-all", "", conditional + ",drawIndirectCount"), "--late-visibility");
  CHECK(frame()["secondaries"].get<int>() > 0);
  check_good(play(call + "adaptive", "", "timestamps"), "");
  CHECK(frame()["stagesMs"]["gpu"].is_null());
}
