// D 5.7: against a renderer that merges all meshes, for scenes that stand still and for animations.
#include <algorithm>
#include <cmath>

#include "timeline/timeline.h"
#include "tools/experiments/all.h"
#include "tools/experiments/measures.h"
#include "tools/experiments/merged_renderer.h"
#include "tools/experiments/paper.h"
#include "tools/experiments/scenes.h"

namespace scenegen::tools {
namespace {

render::View first_camera(const ExperimentContext& context, const Scene& scene) {
  const float aspect = static_cast<float>(context.width) / static_cast<float>(context.height);
  return render::view_of_camera(scene.cameras.front(), scene.cameras.front().frame_from_camera.matrix(),
                                aspect);
}

struct Figures {
  DocumentTable still{"library-static",
                      "A scene that stands still: time of a frame",
                      {{"scene", "scene", ""},
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
};

/// All moments with the merged renderer: each changes something.
struct MergedRun {
  double whole_s = 0, merging_s = 0;
};
Result<MergedRun> play_merged(MergedRenderer& merged, const Scene& scene,
                              const std::vector<double>& moments) {
  timeline::Player player(timeline::compile(scene));
  MergedRun out;
  for (const double moment : moments) {
    const Stopwatch watch;
    const bool changed = player.seek(moment).count() > 0 || &moment == &moments.front();
    auto frame = merged.frame(player, changed);
    if (!frame) return forward_error(frame);
    out.whole_s += watch.seconds();
    out.merging_s += frame->merge_ms * 1e-3;
  }
  return out;
}

Result<void> add_still(const ExperimentContext& context, const std::string& name, int set, const Scene& scene,
                       MergedRenderer& merged, Figures& out) {
  const auto end_s = static_cast<double>(scene.duration_s);
  timeline::Player player(timeline::compile(scene));
  player.seek(end_s);
  if (auto first = merged.frame(player, true); !first) return forward_error(first);
  const std::size_t frames = context.quick ? 4 : 30;
  const std::uint32_t repeat = repetitions(context, 3, 1);
  const Turns turns{std::vector<double>(frames, end_s), context.quick ? 4U : 30U, 1, 1};
  std::vector<double> merged_ms;
  std::vector<WayRuns> ways{{{"plain", "brute", false}, {}}, {{"adaptive", "adaptive", false}, {}}};
  for (std::uint32_t r = 0; r < repeat; ++r) {
    std::vector<double> times;
    for (std::size_t f = 0; f < frames + 2; ++f) {
      auto frame = merged.frame(player, false);
      if (!frame) return forward_error(frame);
      if (f >= 2) times.push_back(frame->whole_ms());
    }
    merged_ms.push_back(mean_of(times));
    for (WayRuns& way : ways) {
      auto runs = compare_ways(context, scene, {way.way}, turns);
      if (!runs) return forward_error(runs);
      way.runs.push_back(std::move(runs->front().runs.front()));
    }
  }
  const PaperTable paper("library_static");
  const PaperTable::Where row{{"scene", std::to_string(set)}};
  const Spread plain = ways[0].frame_ms();
  const Spread own = ways[1].frame_ms();
  const Spread at_once = spread_of(merged_ms);
  const double ratio = own.median / at_once.median;
  out.still_ratios.push_back(ratio);
  out.still.rows.push_back({name, plain.median, paper.cell(row, "library_plain_ms"), at_once.median,
                            paper.cell(row, "library_optimised_ms"), own.median, paper.cell(row, "own_ms"),
                            spread_cell({plain, own, at_once}), ratio,
                            *paper.number(row, "own_ms") / *paper.number(row, "library_optimised_ms"),
                            static_cast<double>(merged.geometry_bytes()) * 1e-6});
  return {};
}

Result<void> add_animation(const ExperimentContext& context, const std::string& name, int set,
                           const Scene& scene, MergedRenderer& merged, Figures& out) {
  const auto end_s = static_cast<double>(scene.duration_s);
  const std::uint32_t frames = context.quick ? 8 : 16;
  const Turns turns{moments_between(0.02 * end_s, end_s, frames), 1, repetitions(context, 2, 1), 1};
  std::vector<double> merged_s;
  std::vector<double> merging_s;
  std::vector<double> own_s;
  for (std::uint32_t r = 0; r < turns.repeat; ++r) {
    auto run = play_merged(merged, scene, turns.moments);
    if (!run) return forward_error(run);
    merged_s.push_back(run->whole_s);
    merging_s.push_back(run->merging_s);
    Turns once = turns;
    once.repeat = 1;
    auto own = compare_ways(context, scene, {{"adaptive", "adaptive", false}}, once);
    if (!own) return forward_error(own);
    own_s.push_back(mean_of(own->front().runs.front().frame_ms) * frames * 1e-3);
  }
  const PaperTable paper("library_animation");
  const PaperTable::Where row{{"scene", std::to_string(set)}};
  const Spread at_once = spread_of(merged_s);
  const Spread own = spread_of(own_s);
  out.gains.push_back(at_once.median / own.median);
  out.animation.rows.push_back({name, static_cast<double>(frames), at_once.median,
                                spread_of(merging_s).median, own.median, spread_cell({at_once, own}),
                                out.gains.back(),
                                *paper.number(row, "library_s") / *paper.number(row, "own_s"),
                                paper.cell(row, "library_s"), paper.cell(row, "own_s")});
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
    const std::string name = stand_in_name(set) + (context.quick ? ", small" : "");
    begin_step(context, "merged-batch: " + name);
    auto made = stand_in(set, context.quick ? 0.02 : 1.0, context.seed);
    if (!made) return forward_error(made);
    if (auto animated = animate_as_project(*made, context.seed); !animated) return forward_error(animated);
    const Scene& scene = made->scene;
    auto merged = MergedRenderer::make(context, scene, first_camera(context, scene));
    if (!merged) return forward_error(merged);
    if (auto done = add_still(context, name, set, scene, **merged, figures); !done)
      return forward_error(done);
    if (auto done = add_animation(context, name, set, scene, **merged, figures); !done)
      return forward_error(done);
    if (!pictures.empty()) continue;
    auto picture =
        take_picture(context, scene, scene.duration_s, "merged-batch", name + ", at the end of its time");
    if (!picture) return forward_error(picture);
    pictures.push_back(std::move(*picture));
  }
  figures.still.note =
      "D table 33: a commercial library of the time without and with its optimizations, on scenes 1 to 4. In "
      "its place "
      "stands a renderer written for this: everything visible merged into one mesh a material, one kept "
      "command buffer, "
      "no culling. 'every object drawn' has neither culling nor kept commands (brute). One frame in flight. "
      "Other "
      "machines and stand-ins for the scenes: look at the ratios.";
  figures.animation.note =
      "D table 34: the whole of its project's animations, of a length and number of frames that it does not "
      "give, along a "
      "camera path; here the camera stands still and every frame changes something, so the merged renderer "
      "merges for "
      "each. Compare the ratios, not the seconds.";
  DocumentSection out{"merged-batch", "Against a renderer that merges meshes", {}, {}};
  out.paragraphs.push_back(
      "Standing still, adaptive takes " + range_of(figures.still_ratios) +
      " times the time of the merged renderer (the dissertation: 1.6 to 3.0); while the animation plays it "
      "is " +
      range_of(figures.gains) + " times as fast (the dissertation: 1.6 to 8.8).");
  out.blocks.emplace_back(std::move(figures.still));
  out.blocks.emplace_back(std::move(figures.animation));
  for (Picture& picture : pictures) out.blocks.emplace_back(std::move(picture));
  return out;
}

}  // namespace scenegen::tools
