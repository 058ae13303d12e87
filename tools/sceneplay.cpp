// sceneplay: shows dynamic scenes. See docs/CLI.md.
#include "tools/sceneplay.h"

#include <array>

#include "render/device_options.h"
#include "tools/cli.h"
#include "tools/output.h"

namespace scenegen::tools {

int list_devices_verb() {
  const auto devices = render::list_devices();
  if (!devices) return report_error(devices.error());
  std::string out;
  for (const render::DeviceInfo& d : *devices) {
    out += std::to_string(d.index) + "  " + d.name + "  " + d.type + "  " + d.driver;
    out += d.lacks.empty() ? "\n" : "  (not usable: lacks " + d.lacks + ")\n";
  }
  if (devices->empty()) return report_error({ErrorKind::no_device, "Vulkan", "no device found"});
  const auto written = write_stdout(out);
  return written ? 0 : report_error(written.error());
}

namespace {

constexpr std::string_view kShortHelp =
    "sceneplay " SCENEGEN_VERSION
    ": plays dynamic scenes (glTF 2.0)\n"
    "\n"
    "  sceneplay frames FILE -o DIR      draws FILE to pictures, one file a frame\n"
    "  sceneplay bench FILE... -o DIR    measures how long frames take in several ways of drawing\n"
    "  sceneplay experiment NAME -o DIR  repeats an experiment of the papers\n"
    "  sceneplay calibrate               measures what drawing costs on this machine\n"
    "  sceneplay camera-path FILE PATH   writes a camera path that is made from FILE\n"
    "  sceneplay report RESULTS -o FILE  makes a page of what was measured\n"
    "  sceneplay --list-devices          the Vulkan devices there are\n"
    "\n"
    "Example: sceneplay frames town.glb -o frames --times 25%,50%,100%\n"
    "All options: sceneplay frames --help\n";

int print(std::string_view text) {
  const auto written = write_stdout(text);
  return written ? 0 : report_error(written.error());
}

int run(std::span<const std::string> arguments) {
  if (arguments.empty()) return print(kShortHelp);
  const std::string& first = arguments.front();
  if (first == "calibrate") return calibrate_verb(arguments.subspan(1));
  if (first == "frames") return frames_verb(arguments.subspan(1));
  if (first == "camera-path") return camera_path_verb(arguments.subspan(1));
  if (first == "bench") return bench_verb(arguments.subspan(1));
  if (first == "experiment") return experiment_verb(arguments.subspan(1));
  if (first == "report") return report_verb(arguments.subspan(1));
  if (first == "--help" || first == "-h") return print(kShortHelp);
  if (first == "--version") return print("sceneplay " SCENEGEN_VERSION "\n");
  if (first == "--list-devices") return list_devices_verb();
  const std::array<std::string, 6> verbs{"frames",    "bench",       "experiment",
                                         "calibrate", "camera-path", "report"};
  if (first.starts_with('-')) {
    const std::array<std::string, 3> options{"--help", "--version", "--list-devices"};
    return report_error({ErrorKind::usage, "", unknown_word("option", first, options)});
  }
  if (first.find_first_of("./\\") == std::string::npos)
    return report_error({ErrorKind::usage, "", unknown_word("command", first, verbs)});
  return report_error(
      {ErrorKind::usage, "",
       "this build opens no window; pictures without one: sceneplay frames " + first + " -o DIR"});
}

}  // namespace

}  // namespace scenegen::tools

int main(int argc, char** argv) {
  return scenegen::tools::guarded_main(argc, argv, scenegen::tools::run);
}
