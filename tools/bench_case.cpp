#include "tools/bench_case.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>

#include "render/strategy_names.h"
#include "tools/frame_fields.h"
#include "tools/memory_fields.h"
#include "tools/output.h"
#include "tools/trace.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> out;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    out.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

Result<BenchWay> parse_way(std::string_view text) {
  BenchWay way;
  way.label = text;
  const std::vector<std::string_view> parts = split(text, ':');
  std::vector<std::string> names;
  for (const auto& [name, value] : render::strategy_choices()) names.push_back(name);
  way.strategy = parts.front();
  if (std::find(names.begin(), names.end(), way.strategy) == names.end())
    return fail(ErrorKind::usage, "", unknown_word("strategy", way.strategy, names));
  for (std::size_t i = 1; i < parts.size(); ++i) {
    if (parts[i] == "late") {
      if (!render::strategy_traits(way.strategy).can_be_late)
        return fail(ErrorKind::usage, "",
                    "'" + way.strategy + "' draws the same with and without ':late'; allowed for: " +
                        join(render::strategies_that(&render::StrategyTraits::can_be_late), ", "));
      way.late = true;
    } else if (parts[i] == "secondaries") {
      way.form = render::NodeForm::secondaries;
    } else if (parts[i] == "indirect") {
      way.form = render::NodeForm::indirect;
    } else if (parts[i].starts_with("n=")) {
      auto n = parse_whole(parts[i].substr(2), 1, 100000);
      if (!n) return forward_error(n);
      way.octree_n = static_cast<std::uint32_t>(*n);
    } else {
      const std::vector<std::string> known{"late", "n=N", "secondaries", "indirect"};
      return fail(ErrorKind::usage, "", unknown_word("modifier", parts[i], known));
    }
  }
  return way;
}

/// "gpuSolid".
std::string gpu_stage(std::string_view name) {
  std::string out = "gpu" + std::string(name);
  out[3] = static_cast<char>(out[3] - 'a' + 'A');
  return out;
}

/// Five digits behind the point: 10 ns.
ordered_json rounded(const std::vector<double>& values) {
  ordered_json out = ordered_json::array();
  for (const double v : values) out.push_back(v < 0 ? -1.0 : std::round(v * 1e5) / 1e5);
  return out;
}

/// Of this process, all threads.
double process_cpu_ms() {
  timespec t{};
  (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

}  // namespace

Result<std::vector<BenchWay>> parse_ways(std::string_view text) {
  std::vector<BenchWay> out;
  for (const std::string_view part : split(text, ',')) {
    auto way = parse_way(part);
    if (!way) return forward_error(way);
    const bool twice =
        std::any_of(out.begin(), out.end(), [&](const BenchWay& w) { return w.label == way->label; });
    if (twice) return fail(ErrorKind::usage, "", "'" + way->label + "' stands there twice");
    out.push_back(std::move(*way));
  }
  return out;
}

std::string BenchCase::key() const {
  return file + "|" + device + "|" + camera + "|" + std::to_string(frames_in_flight) + "|" + way.label;
}

ordered_json BenchRun::json() const {
  ordered_json out{{"objects", objects}, {"frameMs", rounded(frame_ms)}, {"cpuMs", rounded(cpu_ms)}};
  for (std::size_t i = 0; i < stages.size(); ++i) out["stagesMs"][stages[i]] = rounded(stages_ms[i]);
  for (std::size_t i = 0; i < counters.size(); ++i)
    out["counters"][std::string(counter_fields()[i].name)] = counters[i];
  out["processCpuMs"] = process_cpu_ms ? ordered_json(*process_cpu_ms) : ordered_json();
  out["deviceBytes"] = device_bytes;
  out["startMs"] = start_ms ? ordered_json(*start_ms) : ordered_json();
  out["memory"] = memory;
  out["warnings"] = warnings;
  return out;
}

std::optional<BenchRun> BenchRun::from_json(const ordered_json& json) {
  try {
    BenchRun run;
    run.objects = json.at("objects").get<std::uint64_t>();
    run.frame_ms = json.at("frameMs").get<std::vector<double>>();
    run.cpu_ms = json.at("cpuMs").get<std::vector<double>>();
    for (const auto& [name, values] : json.at("stagesMs").items()) {
      run.stages.push_back(name);
      run.stages_ms.push_back(values.get<std::vector<double>>());
    }
    for (const CounterField& field : counter_fields())
      run.counters.push_back(json.at("counters").at(std::string(field.name)).get<std::uint64_t>());
    if (const auto cpu = json.find("processCpuMs"); cpu != json.end() && !cpu->is_null())
      run.process_cpu_ms = cpu->get<double>();
    run.device_bytes = json.at("deviceBytes").get<std::uint64_t>();
    if (!json.at("startMs").is_null()) run.start_ms = json.at("startMs").get<double>();
    run.memory = json.at("memory");
    run.warnings = json.at("warnings").get<std::vector<std::string>>();
    const auto complete = [&](const std::vector<double>& v) { return v.size() == run.frame_ms.size(); };
    if (run.frame_ms.empty() || !complete(run.cpu_ms) ||
        !std::all_of(run.stages_ms.begin(), run.stages_ms.end(), complete))
      return std::nullopt;
    return run;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

std::size_t moment_of_frame(std::int64_t frame, std::size_t moments) {
  if (moments <= 1) return 0;
  const auto last = static_cast<std::int64_t>(moments) - 1;
  const std::int64_t there = ((frame % (2 * last)) + 2 * last) % (2 * last);
  return static_cast<std::size_t>(std::min(there, 2 * last - there));
}

void BenchSeat::forget() {
  renderer_.reset();
  player_.reset();
}

Result<void> BenchSeat::make() {
  if (renderer_) return {};
  player_.emplace(timeline_);
  auto made = render::Renderer::create(scene_, *player_, options_);
  if (!made) return forward_error(made);
  renderer_.emplace(std::move(*made));
  return {};
}

/// What is collected while frames are finished.
struct BenchSeat::Pass {
  using Clock = std::chrono::steady_clock;

  explicit Pass(std::size_t moments) : frames(moments) {
    run.counters.assign(counter_fields().size(), 0);
    run.stages.emplace_back("seek");
    for (const StageField& field : stage_fields()) run.stages.emplace_back(field.name);
    for (const std::string_view name : render::kGpuStageNames) run.stages.push_back(gpu_stage(name));
    run.stages_ms.resize(run.stages.size());
    for (std::vector<double>& values : run.stages_ms) values.reserve(frames);
    run.frame_ms.reserve(frames);
    run.cpu_ms.reserve(frames);
  }

  /// False for a frame that does not count.
  bool finished(const render::FrameReport& report, double seek_ms) {
    const Clock::time_point now = Clock::now();
    const double frame_ms = std::chrono::duration<double, std::milli>(now - before).count();
    before = now;
    const std::int64_t number = next++;
    if (number == -1) cpu_before_ms = process_cpu_ms();
    if (number == static_cast<std::int64_t>(frames) - 1)
      run.process_cpu_ms = (process_cpu_ms() - cpu_before_ms) / static_cast<double>(frames);
    if (number < 0 || number >= static_cast<std::int64_t>(frames)) return false;
    run.frame_ms.push_back(frame_ms);
    run.stages_ms[0].push_back(seek_ms);
    double cpu_ms = seek_ms;
    for (std::size_t i = 0; i < stage_fields().size(); ++i) {
      const StageField& field = stage_fields()[i];
      run.stages_ms[i + 1].push_back(report.*field.value);
      if (field.cpu) cpu_ms += report.*field.value;
    }
    for (std::size_t i = 0; i < render::kGpuStages; ++i)
      run.stages_ms[1 + stage_fields().size() + i].push_back(report.gpu_stages_ms[i]);
    run.cpu_ms.push_back(cpu_ms);
    for (std::size_t i = 0; i < run.counters.size(); ++i)
      run.counters[i] += report.*counter_fields()[i].value;
    run.objects = report.objects;
    return true;
  }

  std::size_t frames;
  std::int64_t next = 0;  ///< number of the frame that is finished next; the warm-up's are negative
  Clock::time_point before = Clock::now();
  double cpu_before_ms = process_cpu_ms();  ///< at the end of the last frame that does not count
  BenchRun run;
};

Result<BenchRun> BenchSeat::run(const std::vector<double>& moments, std::uint32_t warm_up,
                                const std::function<void(std::size_t, std::size_t)>& on_frame,
                                nlohmann::ordered_json* trace) {
  const bool fresh = !renderer_;
  const Stopwatch since_scene;
  if (Result<void> made = make(); !made) return forward_error(made);
  Pass pass(moments.size());
  pass.next = -static_cast<std::int64_t>(warm_up);
  const std::int64_t end = static_cast<std::int64_t>(moments.size()) + renderer_->most_in_flight() - 1;
  const auto total = static_cast<std::size_t>(end - pass.next);
  // Of the frames at work, by their number: nothing here allocates once frames are measured.
  constexpr std::size_t kRing = 4;
  struct AtWork {
    double seek_ms = 0;
    render::View view;
  };
  std::array<AtWork, kRing> ring;
  std::size_t submitted = 0;
  std::size_t finished = 0;
  struct Traced {  // rows are made of them when nothing is measured any more
    render::FrameReport report;
    render::View view;
    double seek_ms;
  };
  std::vector<Traced> traced;
  if (trace != nullptr) traced.reserve(moments.size());
  render::FrameResult result;
  const auto finish_one = [&]() -> Result<void> {
    if (Result<void> done = renderer_->finish(result); !done) return done;
    if (fresh && !pass.run.start_ms) pass.run.start_ms = since_scene.seconds() * 1e3;
    const AtWork& frame = ring[finished++ % kRing];
    if (pass.finished(result.report, frame.seek_ms) && trace != nullptr)
      traced.push_back({result.report, frame.view, frame.seek_ms});
    on_frame(total - static_cast<std::size_t>(end - pass.next), total);
    return {};
  };
  for (std::int64_t i = pass.next; i < end; ++i) {
    if (renderer_->in_flight() == renderer_->most_in_flight()) {
      if (Result<void> done = finish_one(); !done) return forward_error(done);
    }
    const Stopwatch watch;
    const double time_s = moments[moment_of_frame(i, moments.size())];
    const timeline::ChangeSet& changes = player_->seek(time_s);
    AtWork& frame = ring[submitted++ % kRing];
    frame = {watch.seconds() * 1e3, camera_.view(*player_, time_s)};
    if (Result<void> done = renderer_->submit(changes, *player_, frame.view); !done)
      return forward_error(done);
  }
  while (renderer_->in_flight() > 0) {
    if (Result<void> done = finish_one(); !done) return forward_error(done);
  }
  for (const Traced& t : traced)
    trace->push_back(trace_row(t.report, t.view, options_.strategy, t.seek_ms, 1));
  pass.run.device_bytes = renderer_->device_bytes();
  pass.run.memory = memory_json(renderer_->memory(*player_));
  pass.run.warnings = renderer_->warnings();
  if (Result<void> clean = check_validation(*renderer_); !clean) return forward_error(clean);
  return std::move(pass.run);
}

}  // namespace scenegen::tools
