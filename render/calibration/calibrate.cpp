#include <algorithm>
#include <utility>

#include "render/calibration/calibration.h"
#include "render/calibration/fit.h"
#include "render/calibration/measure.h"
#include "render/calibration/test_scene.h"

namespace scenegen::render {
namespace {

using calibration::Fit;
using calibration::MeasureOptions;
using calibration::Run;
using calibration::Step;
using calibration::TestScene;
using calibration::Trial;

/// The runs of a calibration, one renderer each, with a share of the time.
class Runs {
 public:
  Runs(const CalibrationOptions& options, std::shared_ptr<vkr::Device> device, bool software)
      : options_(options), device_(std::move(device)) {
    const calibration::TestSizes sizes = calibration::test_sizes(software, options.quick);
    test_ = calibration::make_test_scene(sizes, options.size);
    only_boxes_ = calibration::make_test_scene(sizes, options.size, calibration::TestContents::only_boxes);
    calibration::TestSizes few;
    few.boxes = {1, 2};
    few_ = calibration::make_test_scene(few, options.size);
    budget_s_ = options.budget_s > 0.0 ? options.budget_s : options.quick ? 8.0 : software ? 75.0 : 11.0;
    how_.longest_frame_s = software ? 0.5 : 0.05;
    // A round of large pictures takes a software device half of the budget.
    if (software) how_.least_rounds = 1;
    if (options.quick) how_.least_rounds = 1, how_.frames = 1;
    // Rasterizing goes on as it began; what the processor does takes a frame to get going.
    settle_ = options.quick ? 0 : 1;
    settle_flat_ = software ? 0 : settle_;
  }

  /// From now on.
  void use(NodeForm form) { form_ = form; }
  void only_boxes(bool only) { scene_ = only ? &only_boxes_ : &test_; }

  template <class Wanted>
  Result<Run> run(const char* strategy, std::uint32_t per_node, bool shadows, double share,
                  const Wanted& wanted) {
    return run_on(*scene_, strategy, per_node, shadows, share, wanted);
  }
  /// Of a scene of two boxes.
  template <class Wanted>
  Result<Run> run_few(const char* strategy, double share, const Wanted& wanted) {
    return run_on(few_, strategy, 0, false, share, wanted);
  }

 private:
  template <class Wanted>
  Result<Run> run_on(const TestScene& test, const char* strategy, std::uint32_t per_node, bool shadows,
                     double share, const Wanted& wanted) {
    RendererOptions o;
    o.shared_device = device_;
    o.size = options_.size;
    o.samples = options_.samples;
    o.strategy = strategy;
    o.how.objects_per_node = per_node;
    o.how.node_form = form_;
    o.how.single_draws = true;  // units are of a draw
    o.shadows = shadows;
    o.predictions = std::string_view(strategy) == "inline";  // for what the model is told of the scenes
    MeasureOptions how = how_;
    how.budget_s = budget_s_ * share;
    const std::string_view name(strategy);
    how.settle = name.find("queries") != std::string_view::npos ? 3
                 : name == "hi-z"                               ? 2
                 : name == "inline"                             ? settle_flat_
                                                                : settle_;
    // Twice instead of three times each step where a round takes an H200 more than a second: with a third one
    // a calibration at 1920x1080 with shadows took 22.5 s (aim 20).
    if (shadows || name == "inline-queries") how.least_rounds = std::min<std::size_t>(how.least_rounds, 2);
    how.progress = [&](double part) {
      if (options_.progress) options_.progress(std::min(1.0, done_ + share * part));
    };
    auto results = calibration::measure(test, o, how, wanted);
    done_ += share;
    if (options_.progress) options_.progress(std::min(1.0, done_));
    if (!results) return forward_error(results);
    return Run{&test, std::move(*results)};
  }

  const CalibrationOptions& options_;
  std::shared_ptr<vkr::Device> device_;
  TestScene test_, only_boxes_, few_;
  const TestScene* scene_ = &test_;
  MeasureOptions how_;
  std::size_t settle_ = 1, settle_flat_ = 1;
  NodeForm form_ = NodeForm::secondaries;
  double budget_s_ = 0;
  double done_ = 0;
};

/// Costs of queries and of what is kept, as differences to drawing without. `all`: where walls were drawn.
Result<void> measure_octrees(Runs& runs, const Run& flat, const Run& all, bool quick, Fit& fit) {
  const auto boxes = [](const Step& s) {
    return s.trial == Trial::empty || s.trial == Trial::boxes || s.trial == Trial::halved_boxes;
  };
  std::vector<std::pair<std::uint32_t, Run>> kept;
  constexpr std::uint32_t kAsked = 100;  // objects a node where queries are measured
  const std::vector<std::uint32_t> sizes =
      quick ? std::vector<std::uint32_t>{kAsked} : std::vector<std::uint32_t>{10, kAsked, 1000};
  for (const std::uint32_t n : sizes) {
    Result<Run> run = runs.run("octree", n, false, quick ? 0.2 : 0.09, [&](const Step& s) {
      return boxes(s) || (n == kAsked && calibration::few_change(s)) ||
             (n == kAsked && s.trial == Trial::hidden_boxes);
    });
    if (!run) return forward_error(run);
    kept.emplace_back(n, std::move(*run));
  }
  fit.kept(flat, kept);
  const auto same = std::find_if(kept.begin(), kept.end(), [](const auto& k) { return k.first == kAsked; });
  fit.octree_updates(kept.front(), *same);
  fit.command_memory(kept);
  Result<Run> each = runs.run("inline-queries", 0, false, quick ? 0.1 : 0.06,
                              [&](const Step& s) { return boxes(s) || s.trial == Trial::hidden_boxes; });
  if (!each) return forward_error(each);
  Result<Run> asking = runs.run("queries-all", kAsked, false, quick ? 0.1 : 0.07, [](const Step& s) {
    return s.trial == Trial::empty || s.trial == Trial::hidden_boxes;
  });
  if (!asking) return forward_error(asking);
  fit.queries(flat, *each, all);
  fit.second_part(same->second, *asking);
  if (quick) return {};
  runs.use(NodeForm::indirect);
  Result<Run> fine = runs.run("octree", 10, false, 0.05, boxes);
  if (!fine) return forward_error(fine);
  Result<Run> coarse = runs.run("octree", 1000, false, 0.05, boxes);
  if (!coarse) return forward_error(coarse);
  fit.indirect(flat, *fine, *coarse);
  Result<Run> recorded = runs.run("octree-record", kAsked, false, 0.04, boxes);
  if (!recorded) return forward_error(recorded);
  fit.listed(*recorded);
  return {};
}

Result<void> measure_hi_z(Runs& runs, const Run& flat, Fit& fit) {
  Result<Run> all = runs.run("hi-z", 0, false, 0.03, [](const Step& s) {
    return s.trial == Trial::empty || s.trial == Trial::boxes || s.trial == Trial::hidden_boxes;
  });
  if (!all) return forward_error(all);
  Result<Run> few = runs.run_few("hi-z", 0.01, [](const Step& s) { return s.trial == Trial::empty; });
  if (!few) return forward_error(few);
  fit.hi_z(flat, *all, *few);
  return {};
}

}  // namespace

CalibrationKey calibration_key(const DeviceInfo& device, glm::uvec2 size, std::uint32_t samples,
                               bool shadows) {
  return {device.uuid, device.name, device.driver, size, samples, shadows};
}

Result<Calibration> calibrate(const CalibrationOptions& options) {
  Result<std::shared_ptr<vkr::Device>> device =
      options.shared_device ? options.shared_device : share_device(options.device);
  if (!device) return forward_error(device);
  const DeviceInfo& info = info_of(**device);
  const bool software = info.type == "CPU";
  Calibration out;
  out.key = calibration_key(info, options.size, options.samples, options.shadows);
  out.quick = options.quick;
  out.costs = model::rough_costs(software);  // triangle_overlap stays: it is the kind of device
  Runs runs(options, *device, software);
  Fit fit(out, static_cast<double>(options.size.x) * options.size.y);

  const auto drawn = [](const Step& s) {
    return s.trial != Trial::hidden_boxes && !calibration::few_change(s);
  };
  const auto boxes = [](const Step& s) { return s.trial == Trial::empty || s.trial == Trial::boxes; };
  const double flat_share = !options.shadows ? 0.0 : options.quick ? 0.1 : software ? 0.11 : 0.06;
  const double first = (options.quick ? 0.56 : 0.42) - flat_share;
  Result<Run> with = runs.run("inline", 0, options.shadows, first, drawn);
  if (!with) return forward_error(with);
  runs.only_boxes(true);
  // Differences to the other strategies are taken without shadows.
  Result<Run> flat = options.shadows ? runs.run("inline", 0, false, flat_share, boxes) : Result<Run>(*with);
  if (!flat) return forward_error(flat);
  out.costs.shadow_slot_s = out.costs.shadow_vertex_s = 0.0;
  if (options.shadows) fit.shadows(*with, *flat);
  fit.inline_run(*with);
  // Recording is what it is without the shadows' pass, which has a cost of its own.
  if (options.shadows) out.costs.record_s = std::max(0.0, out.costs.record_s - out.costs.shadow_slot_s);
  runs.only_boxes(false);  // as many blocks as there are
  if (Result<void> done = measure_hi_z(runs, *flat, fit); !done) return forward_error(done);
  runs.only_boxes(true);
  if (Result<void> done = measure_octrees(runs, *flat, *with, options.quick, fit); !done)
    return forward_error(done);
  fit.finish();
  return out;
}

}  // namespace scenegen::render
