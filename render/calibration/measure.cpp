#include "render/calibration/measure.h"

#include <algorithm>
#include <chrono>

#include "timeline/timeline.h"

namespace scenegen::render::calibration {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// All samples of one stage, until the median is taken.
struct Samples {
  std::vector<Stages> steady, first;
  std::vector<double> periods, leave;
};

/// What the first frame takes is of interest, or what is left for the empty one after them.
bool from_empty(Trial trial) {
  switch (trial) {
    case Trial::empty:
    case Trial::boxes:
    case Trial::hidden_boxes:
    case Trial::halved_boxes:
    case Trial::thinned_boxes:
    case Trial::refilled_boxes:
      return true;
    case Trial::speck_boxes:
    case Trial::textured_boxes:
    case Trial::unshared_meshes:
    case Trial::meshes:
    case Trial::speck_meshes:
    case Trial::textured_meshes:
    case Trial::layers:
    case Trial::textured_layers:
    case Trial::piles:
    case Trial::textured_piles:
      break;
  }
  return false;
}

Stages medians(const std::vector<Stages>& all, double (*middle)(std::vector<double>)) {
  const auto of = [&](double Stages::*stage) {
    std::vector<double> values(all.size());
    std::transform(all.begin(), all.end(), values.begin(), [&](const Stages& s) { return s.*stage; });
    return middle(std::move(values));
  };
  return {of(&Stages::update_s), of(&Stages::update_octree_s), of(&Stages::plan_s),     of(&Stages::record_s),
          of(&Stages::keep_s),   of(&Stages::device_s),        of(&Stages::readback_s), of(&Stages::gpu_s)};
}

class Measuring {
 public:
  Measuring(const TestScene& test, const MeasureOptions& how, Clock::time_point start,
            timeline::Player player, Renderer renderer, bool facts)
      : test_(test),
        how_(how),
        facts_(facts),
        start_(start),
        player_(std::move(player)),
        renderer_(std::move(renderer)),
        samples_(test.steps.size()),
        results_(test.steps.size()) {}

  Result<std::vector<Measured>> run(const std::function<bool(const Step&)>& wanted) {
    for (std::size_t round = 0; round < how_.most_rounds; ++round) {
      for (std::size_t i = 0; i < test_.steps.size(); ++i) {
        if (round >= how_.least_rounds && spent() >= 1.0) break;
        if (!wanted(test_.steps[i]) || too_long(i)) continue;
        if (Result<void> done = visit(i); !done) return forward_error(done);
      }
      if (how_.progress)
        how_.progress(std::min(
            1.0, std::max(spent(), static_cast<double>(round + 1) / static_cast<double>(how_.most_rounds))));
      if (round + 1 >= how_.least_rounds && spent() >= 1.0) break;
    }
    for (const std::string& message : renderer_.take_validation_messages())
      return fail(ErrorKind::no_device, "validation", message);
    const CommandMemoryReport commands = renderer_.memory(player_).commands;
    for (std::size_t i = 0; i < results_.size(); ++i) {
      results_[i].commands = commands;
      results_[i].steady = medians(samples_[i].steady, median);
      results_[i].first = medians(samples_[i].first, lower_median);
      results_[i].leave_record_s = lower_median(samples_[i].leave);
      results_[i].period_s = lower_median(samples_[i].periods);
      results_[i].samples = samples_[i].steady.size();
    }
    return std::move(results_);
  }

 private:
  /// Share of the budget.
  [[nodiscard]] double spent() const { return seconds_since(start_) / how_.budget_s; }

  /// By the step of the same trial before it, which has about a quarter of the work.
  [[nodiscard]] bool too_long(std::size_t i) const {
    const Step& step = test_.steps[i];
    if (step.from != 0 && samples_[step.from].steady.empty()) return true;
    for (std::size_t k = i; k-- > 0;) {
      const Step& other = test_.steps[k];
      if (other.trial != step.trial || other.draws >= step.draws || other.vertices != step.vertices) continue;
      if (samples_[k].steady.empty()) return true;
      const double growth = static_cast<double>(step.draws) / static_cast<double>(other.draws);
      return samples_[k].steady.front().device_s * growth > how_.longest_frame_s;
    }
    return false;
  }

  Result<void> frame(double time_s, std::vector<Stages>* keep, FrameReport* report) {
    const timeline::ChangeSet& changes = player_.seek(time_s);
    if (Result<void> done = renderer_.submit(changes, player_, test_.view); !done) return done;
    if (Result<void> done = renderer_.finish(result_); !done) return done;
    const FrameReport& r = result_.report;
    if (keep != nullptr)
      keep->push_back({r.update_ms * 1e-3, r.update_octree_ms * 1e-3, r.plan_ms * 1e-3,
                       (r.record_ms + r.submit_ms) * 1e-3, r.keep_ms * 1e-3, r.wait_ms * 1e-3,
                       r.readback_ms * 1e-3, r.gpu_ms < 0.0 ? -1.0 : r.gpu_ms * 1e-3});
    if (report != nullptr) *report = r;
    return {};
  }

  /// Time from frame to frame with two in flight, from the end of the first on.
  Result<void> pipelined(double time_s, std::vector<double>& periods) {
    constexpr int kFrames = 5;
    if (Result<void> done = renderer_.submit(player_.seek(time_s), player_, test_.view); !done) return done;
    Clock::time_point start;
    for (int i = 0; i <= kFrames; ++i) {
      if (i == 1) start = Clock::now();
      if (Result<void> done = renderer_.submit(player_.seek(time_s), player_, test_.view); !done) return done;
      if (Result<void> done = renderer_.finish(result_); !done) return done;
    }
    periods.push_back(seconds_since(start) / kFrames);
    return renderer_.finish(result_);
  }

  Result<void> visit(std::size_t i) {
    const double time_s = test_.steps[i].time_s;
    if (from_empty(test_.steps[i].trial)) {
      empty_.clear();
      if (Result<void> done = frame(test_.steps.front().time_s, &empty_, nullptr); !done) return done;
      if (last_) samples_[*last_].leave.push_back(empty_.front().record_s);
    }
    last_ = i;
    if (const std::uint32_t from = test_.steps[i].from; from != 0) {
      if (Result<void> done = frame(test_.steps[from].time_s, nullptr, nullptr); !done) return done;
    }
    Result<void> done = frame(time_s, &samples_[i].first, &results_[i].first_report);
    for (std::size_t k = 0; done && k < how_.settle; ++k) done = frame(time_s, nullptr, nullptr);
    for (std::size_t k = 0; done && k < how_.frames; ++k) {
      // The last one of the first visit says what the model is told. To predict, the processor reads all
      // boxes after it recorded a frame, so all the others are drawn without, as they are by people.
      const bool told = facts_ && samples_[i].steady.size() + 1 == how_.frames;
      renderer_.set_predictions(told);
      done = frame(time_s, &samples_[i].steady, told || !facts_ ? &results_[i].report : nullptr);
    }
    renderer_.set_predictions(false);
    const Trial trial = test_.steps[i].trial;
    if (done && renderer_.most_in_flight() > 1 && (trial == Trial::empty || trial == Trial::boxes))
      done = pipelined(time_s, samples_[i].periods);
    return done;
  }

  const TestScene& test_;
  const MeasureOptions& how_;
  bool facts_;
  Clock::time_point start_;
  timeline::Player player_;
  Renderer renderer_;
  std::vector<Samples> samples_;
  std::vector<Measured> results_;
  std::vector<Stages> empty_;
  std::optional<std::size_t> last_;
  FrameResult result_;
};

}  // namespace

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return values.size() % 2 == 1 ? *middle : 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

double lower_median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Result<std::vector<Measured>> measure(const TestScene& test, const RendererOptions& options,
                                      const MeasureOptions& how,
                                      const std::function<bool(const Step&)>& wanted) {
  const auto start = Clock::now();
  timeline::Player player(timeline::compile(test.scene));
  player.seek(0.0);
  Result<Renderer> renderer = Renderer::create(test.scene, player, options);
  if (!renderer) return forward_error(renderer);
  renderer->set_predictions(false);
  return Measuring(test, how, start, std::move(player), std::move(*renderer), options.predictions)
      .run(wanted);
}

Line fit_line(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  if (x.empty()) return {};
  double mean_x = 0.0;
  double mean_y = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) mean_x += x[i] / n, mean_y += y[i] / n;
  double xx = 0.0;
  double xy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  const double slope = xx > 0.0 ? xy / xx : 0.0;
  return {mean_y - slope * mean_x, slope};
}

}  // namespace scenegen::render::calibration
