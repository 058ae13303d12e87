// sceneplay bench FILE... -o DIR: how long frames take, drawn in several ways.
#include <algorithm>

#include "render/strategy_names.h"
#include "scene/limits.h"
#include "tools/bench_run.h"
#include "tools/camera_paths.h"
#include "tools/sceneplay.h"
#include "tools/verb.h"

namespace scenegen::tools {
namespace {

std::string spell_ways(const std::vector<BenchWay>& ways) {
  std::vector<std::string> labels;
  labels.reserve(ways.size());
  for (const BenchWay& way : ways) labels.push_back(way.label);
  return join(labels, ",");
}

Value ways_value(std::vector<BenchWay>& target) {
  return {Value::Kind::text,
          "LIST",
          {},
          [&target](std::string_view text) -> Result<void> {
            auto ways = parse_ways(text);
            if (!ways) return forward_error(ways);
            target = std::move(*ways);
            return {};
          },
          [&target] { return spell_ways(target); }};
}

Value in_flight_value(std::vector<std::uint32_t>& target) {
  return {Value::Kind::text, "LIST", "1, 2, 3; separated by commas",
          [&target](std::string_view text) -> Result<void> {
            std::vector<std::uint32_t> out;
            for (std::size_t begin = 0; begin <= text.size();) {
              const std::size_t end = std::min(text.find(',', begin), text.size());
              auto n = parse_whole(text.substr(begin, end - begin), 1, 3);
              if (!n) return forward_error(n);
              const auto number = static_cast<std::uint32_t>(*n);
              if (std::find(out.begin(), out.end(), number) == out.end()) out.push_back(number);
              begin = end + 1;
            }
            target = std::move(out);
            return {};
          },
          [&target] {
            std::vector<std::string> words;
            words.reserve(target.size());
            for (const std::uint32_t n : target) words.push_back(std::to_string(n));
            return join(words, ",");
          }};
}

/// Every strategy that there is: one that is new must not be forgotten.
std::vector<BenchWay> all_ways() {
  std::vector<std::string> names;
  for (const auto& [name, value] : render::strategy_choices()) names.push_back(name);
  return *parse_ways(join(names, ","));
}

/// What --quick sets, as if it had been given.
void be_quick(const Options& options, BenchRequest& r) {
  const auto set = [&](std::string_view name, auto& target, auto value) {
    if (!options.given(name)) target = std::move(value);
  };
  set("--strategy", r.ways, all_ways());
  if (!options.given("--camera"))
    set("--camera-path", r.camera_paths, std::vector<std::string>{"fixed", "orbit", "walk"});
  set("--size", r.drawing.size, glm::uvec2(320, 180));
  set("--samples", r.drawing.samples, 1U);
  set("--shadows", r.drawing.shadows, false);
  if (!options.given("--times")) set("--frames", r.frames, 40U);
  set("--warm-up", r.warm_up, 10U);
  set("--repeat", r.repeat, 2U);
}

void add_options(Options& options, BenchRequest& r) {
  options.positional("FILE...", r.files, "scenes: .glb or .gltf files; none with --quick", true);
  options.group("Output");
  options.add("-o,--output", text_value(r.folder, "DIR"),
              "folder for bench.json, bench.csv and the single runs; made when missing");
  options.flag("--resume", r.resume,
               "keep the runs that DIR holds already, and measure only what is missing");
  options.add("--trace", text_value(r.trace, "FILE"),
              "one row a frame that counts, of the runs measured now: camera, choice, predictions (some 50 "
              "us a frame), "
              "counts, stage times; .csv or .json");
  options.group("Measuring");
  options.flag(
      "--quick", r.quick,
      "small scenes that are made here (towns and test sets), in all ways of drawing, from three camera "
      "paths (fixed, orbit, walk): some minutes on a software device. Sets --strategy, --camera-path, "
      "--size, --samples, --shadows, --frames, "
      "--warm-up and --repeat unless they are given",
      Role::run);
  options.add("--repeat", whole_value(r.repeat, 1U, 1000U),
              "runs of each case; those of one scene and camera take turns");
  options.add("--frames", whole_value(r.frames, 1U, 1000000U), "frames of a run, evenly over the timeline");
  options.add("--times", text_value(r.times, "LIST", "as of sceneplay frames"), "moments of a run instead");
  options.add("--warm-up", whole_value(r.warm_up, 1U, 100000U), "frames before each run that do not count");
  options.add("--renderers", choice_value<bool>(r.keep_renderers, {{"fresh", false}, {"kept", true}}),
              "fresh: each run begins with a new one, so that none knows what others found; kept: a case "
              "keeps its own, as a "
              "program that runs for long");
  options.add("--size",
              size2_value(r.drawing.size, {1, 1}, {limits::kMaxFrameSide, limits::kMaxFrameSide}, "WxH"),
              "size of the pictures in pixels");
  options.flag("--readback", r.readback, "read the pixels of every frame; else they stay on the device",
               Role::run);
  options.group("View");
  options.add("--camera", text_value(r.camera, "NAME|INDEX", "a camera of the file, or auto"), "camera",
              Role::run, "the file's first, else auto");
  options.add("--camera-path", texts_value(r.camera_paths, "FILE|NAME", camera_path_range(), not_empty),
              "camera path: as JSON, or made from the scene (docs/CAMERA_PATH.md); may be given several "
              "times");
  add_drawing_options(options, r.drawing, ways_value(r.ways), in_flight_value(r.frames_in_flight));
  add_device_options(options, r.drawing, texts_value(r.devices, "NAME|INDEX", {}, not_empty));
  options.group("General");
  options.add_general(r.quiet);
}

}  // namespace

int bench_verb(std::span<const std::string> arguments) {
  if (std::find(arguments.begin(), arguments.end(), "--list-devices") != arguments.end())
    return list_devices_verb();
  if (!arguments.empty() && arguments.front() == "compare") return bench_compare_verb(arguments.subspan(1));
  BenchRequest request;
  request.arguments.assign(arguments.begin(), arguments.end());
  Options options("sceneplay bench",
                  {"sceneplay bench FILE... -o DIR [options]", "sceneplay bench --quick -o DIR [options]",
                   "sceneplay bench compare A B [options]"},
                  "measures how long frames take in several ways of drawing: --strategy A,B,C. "
                  "A:late is A with --late-visibility (where that means something), A:n=100 with --octree-n "
                  "100, A:indirect and A:secondaries "
                  "with that --node-form.");
  add_options(options, request);
  const auto check = [&]() -> Result<void> {
    if (request.files.empty() && !request.quick)
      return fail(ErrorKind::usage, "", "missing FILE... or --quick (usage: sceneplay bench FILE... -o DIR)");
    if (request.folder.empty())
      return fail(ErrorKind::usage, "--output", "missing (usage: sceneplay bench FILE... -o DIR)");
    if (options.given("--times") && options.given("--frames"))
      return fail(ErrorKind::usage, "--times", "has no place beside --frames");
    if (options.given("--camera") && options.given("--camera-path"))
      return fail(ErrorKind::usage, "--camera", "has no place beside --camera-path");
    if (request.quick) be_quick(options, request);
    std::vector<std::string> strategies;
    for (const BenchWay& way : request.ways) strategies.push_back(way.strategy);
    if (auto known = check_strategies(strategies, false, request.drawing.late_visibility); !known)
      return known;
    return {};
  };
  return run_verb(options, arguments, {.check = check, .work = [&]() -> Result<int> {
                                         Result<void> measured = run_bench(request);
                                         return measured ? Result<int>(0) : forward_error(measured);
                                       }});
}

}  // namespace scenegen::tools
