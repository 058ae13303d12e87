// D 5.7: against a renderer that merges all meshes, for scenes that stand still and for animations, from
// several camera paths.
#include <algorithm>
#include <cmath>

#include "timeline/timeline.h"
#include "tools/experiments/all.h"
#include "tools/experiments/measures.h"
#include "tools/experiments/merged_renderer.h"
#include "tools/experiments/paper.h"
#include "tools/experiments/scenes.h"
#include "tools/frame_fields.h"

namespace scenegen::tools {
namespace {

/// A scene, the renderer that merges it, and what it is seen from.
struct Subject {
  std::string name;
  int set = 0;
  const Scene& scene;
  MergedRenderer& merged;
  [[nodiscard]] double end_s() const { return static_cast<double>(scene.duration_s); }
};
struct Viewpoint {
  std::string path;  ///< as --camera-path names it
  CameraMan camera;
  bool of_still = false, of_animation = false;  ///< what the dissertation's figures stand beside
};

/// The dissertation looks at still scenes from one place (it does not say which), and at animations along a
/// path.
Result<std::vector<Viewpoint>> viewpoints_of(const ExperimentContext& context, const Scene& scene) {
  const std::vector<std::string> usual{"fixed", "fly"};
  std::vector<Viewpoint> out;
  for (const std::string& path : context.camera_paths.empty() ? usual : context.camera_paths) {
    auto camera = CameraMan::of_path(path, scene, {context.width, context.height});
    if (!camera) return forward_error(camera);
    out.push_back({path, std::move(*camera)});
  }
  out.front().of_still = true;
  out.back().of_animation = true;
  return out;
}

struct Figures {
  DocumentTable still{"library-static",
                      "A scene that stands still: time of a frame",
                      {{"scene", "scene", ""},
                       {"camera", "camera path", ""},
                       {"plainMs", "every object drawn", "ms", Origin::ours, Better::lower, "plainPaper"},
                       {"plainPaper", "library, plain", "ms", Origin::paper, Better::lower},
                       {"mergedMs", "merged", "ms", Origin::ours, Better::lower, "mergedPaper"},
                       {"mergedPaper", "library, optimized", "ms", Origin::paper, Better::lower},
                       {"ownMs", "adaptive", "ms", Origin::ours, Better::lower, "ownPaper"},
                       {"ownPaper", "dissertation's", "ms", Origin::paper, Better::lower},
                       {"spread", "spread, most", "%"},
                       {"ratio", "adaptive / merged", "", Origin::ours, Better::lower, "ratioPaper"},
                       {"ratioPaper", "own / library", "", Origin::paper, Better::lower},
                       {"mergedMb", "merged geometry", "MB", Origin::ours, Better::lower}},
                      {},
                      {}};
  DocumentTable animation{"library-animation",
                          "A whole animation",
                          {{"scene", "scene", ""},
                           {"camera", "camera path", ""},
                           {"frames", "frames", "", Origin::ours, Better::none, {}, 6},
                           {"mergedS", "merged", "s", Origin::ours, Better::lower},
                           {"mergingS", "of it merging", "s", Origin::ours, Better::lower},
                           {"ownS", "adaptive", "s", Origin::ours, Better::lower},
                           {"spread", "spread", "%"},
                           {"gain", "merged / adaptive", "", Origin::ours, Better::higher, "gainPaper"},
                           {"gainPaper", "library / own", "", Origin::paper, Better::higher},
                           {"mergedPaper", "library", "s", Origin::paper, Better::lower},
                           {"ownPaper", "own", "s", Origin::paper, Better::lower}},
                          {},
                          {}};
  std::vector<double> still_ratios, gains;
  std::vector<Verdict> still_verdicts, animation_verdicts;
  std::vector<Failure> failures;
};

/// A frame's, mean over the frames.
double mean_count(const BenchRun& run, std::string_view name) {
  for (std::size_t i = 0; i < run.counters.size(); ++i) {
    if (counter_fields()[i].name == name)
      return static_cast<double>(run.counters[i]) / static_cast<double>(run.frame_ms.size());
  }
  return 0;
}

/// All moments with the merged renderer: each changes something.
struct MergedRun {
  double whole_s = 0, merging_s = 0;
};
Result<MergedRun> play_merged(const Subject& subject, const CameraMan& camera,
                              const std::vector<double>& moments) {
  timeline::Player player(timeline::compile(subject.scene));
  MergedRun out;
  for (const double moment : moments) {
    const Stopwatch watch;
    const bool changed = player.seek(moment).count() > 0 || &moment == &moments.front();
    subject.merged.stage().look(camera.view(player, moment));
    auto frame = subject.merged.frame(player, changed);
    if (!frame) return forward_error(frame);
    out.whole_s += watch.seconds();
    out.merging_s += frame->merge_ms * 1e-3;
  }
  return out;
}

/// Mean milliseconds of frames that draw again what was merged.
Result<double> draw_merged(const Subject& subject, const timeline::Player& player, const CameraMan& camera,
                           const std::vector<double>& moments) {
  constexpr std::size_t kWarm = 2;
  std::vector<double> times;
  for (std::size_t f = 0; f < moments.size() + kWarm; ++f) {
    subject.merged.stage().look(camera.view(player, moments[f < kWarm ? 0 : f - kWarm]));
    auto frame = subject.merged.frame(player, false);
    if (!frame) return forward_error(frame);
    if (f >= kWarm) times.push_back(frame->whole_ms());
  }
  return mean_of(times);
}

Result<void> add_still(const ExperimentContext& context, const Subject& subject, const Viewpoint& from,
                       Figures& out) {
  timeline::Player player(timeline::compile(subject.scene));
  player.seek(subject.end_s());
  if (auto first = subject.merged.frame(player, true); !first) return forward_error(first);
  // Time goes on behind the end, where nothing changes, and the path begins there.
  CameraMan camera = from.camera;
  camera.begin_at(subject.end_s());
  Turns turns{moments_between(subject.end_s(), subject.end_s() + camera.played_s(0), context.quick ? 4 : 30),
              context.quick ? 4U : 30U, 1, 1, camera};
  std::vector<double> merged_ms;
  std::vector<WayRuns> ways{{{"plain", "brute", false}, {}}, {{"adaptive", "adaptive", false}, {}}};
  for (std::uint32_t r = 0; r < repetitions(context, 3, 1); ++r) {
    auto mean_ms = draw_merged(subject, player, camera, turns.moments);
    if (!mean_ms) return forward_error(mean_ms);
    merged_ms.push_back(*mean_ms);
    for (WayRuns& way : ways) {
      // Only what chooses has something to learn first.
      turns.warm_up = way.way.strategy == "adaptive" && !context.quick ? 30 : 4;
      auto runs = compare_ways(context, subject.scene, {way.way}, turns);
      if (!runs) return forward_error(runs);
      way.runs.push_back(std::move(runs->front().runs.front()));
    }
  }
  const PaperTable paper("library_static");
  const PaperTable::Where row{{"scene", std::to_string(subject.set)}};
  const auto theirs = [&](const Cell& cell) { return from.of_still ? cell : Cell(); };
  const Spread plain = ways[0].frame_ms();
  const Spread own = ways[1].frame_ms();
  const Spread at_once = spread_of(merged_ms);
  const double ratio = own.median / at_once.median;
  if (from.of_still) {
    const BenchRun& run = ways[1].runs.back();
    const double drawn = 100 * mean_count(run, "drawn") / static_cast<double>(run.objects);
    out.still_ratios.push_back(ratio);
    out.still_verdicts.push_back(judged(
        {"D table 33",
         sized(context, "still scene " + std::to_string(subject.set) + ", adaptive over merged"), "", "",
         Finding::level,
         "merged draws all in " + std::to_string(subject.merged.draws()) + " commands; adaptive draws " +
             with_unit(drawn, "%") + " of the objects, as the rest is out of sight or hidden"},
        ratio, *paper.number(row, "own_ms") / *paper.number(row, "library_optimised_ms"), "\u00D7",
        Better::lower));
  }
  out.still.rows.push_back({subject.name, base_name(from.path), plain.median,
                            theirs(paper.cell(row, "library_plain_ms")), at_once.median,
                            theirs(paper.cell(row, "library_optimised_ms")), own.median,
                            theirs(paper.cell(row, "own_ms")), spread_cell({plain, own, at_once}), ratio,
                            theirs(*paper.number(row, "own_ms") / *paper.number(row, "library_optimised_ms")),
                            static_cast<double>(subject.merged.geometry_bytes()) * 1e-6});
  return {};
}

Result<void> add_animation(const ExperimentContext& context, const Subject& subject, const Viewpoint& from,
                           Figures& out) {
  const std::uint32_t frames = context.quick ? 8 : 16;
  Turns turns{moments_between(0.02 * subject.end_s(), subject.end_s(), frames), 1, 1, 1, from.camera};
  std::vector<double> merged_s;
  std::vector<double> merging_s;
  std::vector<double> own_s;
  for (std::uint32_t r = 0; r < repetitions(context, 2, 1); ++r) {
    auto run = play_merged(subject, from.camera, turns.moments);
    if (!run) return forward_error(run);
    merged_s.push_back(run->whole_s);
    merging_s.push_back(run->merging_s);
    auto own = compare_ways(context, subject.scene, {{"adaptive", "adaptive", false}}, turns);
    if (!own) return forward_error(own);
    own_s.push_back(mean_of(own->front().runs.front().frame_ms) * frames * 1e-3);
  }
  const PaperTable paper("library_animation");
  const PaperTable::Where row{{"scene", std::to_string(subject.set)}};
  const auto theirs = [&](const Cell& cell) { return from.of_animation ? cell : Cell(); };
  const Spread at_once = spread_of(merged_s);
  const Spread own = spread_of(own_s);
  const double gain = at_once.median / own.median;
  if (from.of_animation) {
    out.gains.push_back(gain);
    out.animation_verdicts.push_back(judged(
        {"D table 34", sized(context, "animation " + std::to_string(subject.set) + ", merged over adaptive"),
         "", "", Finding::level,
         with_unit(100 * spread_of(merging_s).median / at_once.median, "%") +
             " of the merged renderer's time is merging anew, in every frame; adaptive updates what changed"},
        gain, *paper.number(row, "library_s") / *paper.number(row, "own_s"), "\u00D7", Better::higher));
  }
  out.animation.rows.push_back({subject.name, base_name(from.path), static_cast<double>(frames),
                                at_once.median, spread_of(merging_s).median, own.median,
                                spread_cell({at_once, own}), gain,
                                theirs(*paper.number(row, "library_s") / *paper.number(row, "own_s")),
                                theirs(paper.cell(row, "library_s")), theirs(paper.cell(row, "own_s"))});
  return {};
}

/// A stand-in from all cameras, and a picture of the first.
Result<void> add_set(const ExperimentContext& context, int set, Figures& out,
                     std::vector<Picture>& pictures) {
  const std::string name = stand_in_name(set) + (context.quick ? ", small" : "");
  begin_step(context, "merged-batch: " + name);
  auto made = stand_in(set, context.quick ? 0.02 : 1.0, context.seed);
  if (!made) return forward_error(made);
  if (auto animated = animate_as_project(*made, context.seed); !animated) return forward_error(animated);
  const Scene& scene = made->scene;
  auto merged = MergedRenderer::make(context, scene, first_camera(context, scene));
  if (!merged) return forward_error(merged);
  auto viewpoints = viewpoints_of(context, scene);
  if (!viewpoints) return forward_error(viewpoints);
  const Subject subject{name, set, scene, **merged};
  for (const Viewpoint& from : *viewpoints) {
    begin_step(context, "merged-batch: " + name + ", " + base_name(from.path));
    if (auto done = add_still(context, subject, from, out); !done) return done;
  }
  for (const Viewpoint& from : *viewpoints) {
    if (auto done = add_animation(context, subject, from, out); !done) return done;
  }
  if (!pictures.empty()) return {};
  keep_picture(
      take_picture(context, scene, scene.duration_s, "merged-batch", name + ", at the end of its time"),
      pictures, out.failures);
  return {};
}

std::string range_of(const std::vector<double>& values) {
  return in_words(*std::min_element(values.begin(), values.end())) + " to " +
         in_words(*std::max_element(values.begin(), values.end()));
}

}  // namespace

Result<DocumentSection> merged_batch(const ExperimentContext& context) {
  Figures figures;
  std::vector<Picture> pictures;
  for (int set = 1; set <= 4; ++set) {
    if (context.quick && set != 1 && set != 3) continue;
    // The larger ones need not fit where the smaller do.
    if (auto done = attempt([&] { return add_set(context, set, figures, pictures); }); !done)
      figures.failures.push_back({"merged-batch, " + stand_in_name(set), done.error().str()});
  }
  if (figures.still_ratios.empty() || figures.gains.empty())
    return fail(ErrorKind::no_device, "device '" + context.device_info.name + "'",
                "no scene could be drawn; the first: " + figures.failures.front().why);
  figures.still.note =
      "D table 33: a commercial library of the time without and with its optimizations, on scenes 1 to 4. In "
      "its place "
      "stands a renderer written for this: everything visible merged into one mesh a material, one kept "
      "command buffer, "
      "no culling. 'every object drawn' has neither culling nor kept commands (brute). One frame in flight. "
      "D does not say where its camera stands; its figures are beside the first camera path. Other machines "
      "and "
      "stand-ins for the scenes: look at the ratios.";
  figures.animation.note =
      "D table 34: the whole of its project's animations, of a length and number of frames that it does not "
      "give, along a camera path; its figures are beside the last camera path. Here every frame changes "
      "something, so the merged renderer merges for each, by all processors. Compare the ratios, not the "
      "seconds.";
  DocumentSection out{"merged-batch", "Against a renderer that merges meshes", {}, {}};
  out.paragraphs.push_back(
      "Standing still, adaptive takes " + range_of(figures.still_ratios) +
      " times the time of the merged renderer (the dissertation: 1.6 to 3.0); while the animation plays it "
      "is " +
      range_of(figures.gains) + " times as fast (the dissertation: 1.6 to 8.8).");
  out.blocks.emplace_back(std::move(figures.still));
  out.blocks.emplace_back(std::move(figures.animation));
  for (Picture& picture : pictures) out.blocks.emplace_back(std::move(picture));
  out.verdicts = std::move(figures.still_verdicts);
  out.verdicts.insert(out.verdicts.end(), figures.animation_verdicts.begin(),
                      figures.animation_verdicts.end());
  out.failures = std::move(figures.failures);
  return out;
}

}  // namespace scenegen::tools
