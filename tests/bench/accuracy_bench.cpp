// How far predictions of the model are from what frames take (D 5.1, tables 7 to 22): the public test sets,
// drawn in four ways. Unit costs come from a calibration file, which saw none of these scenes; nothing is
// corrected from what is measured here.
//
//   bench_accuracy CALIBRATION.json [--sets 5,8,14-22] [--seconds S] [--device NAME] [--csv FILE] [--explain]
//                  [--dump FILE]
//
// --dump: a line of JSON for each set and way: medians of measured stages in ms, what the model was told, and
// what it said.
// Each set runs in a process of its own (some drivers refuse more than a few dozen instances in one).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "gen/generate.h"
#include "render/calibration/calibration_file.h"
#include "render/renderer.h"
#include "scene/scene.h"
#include "tests/support/facts_json.h"
#include "tools/experiments/accuracy.h"
#include "tools/output.h"

using namespace scenegen;
using render::model::Method;
using render::model::Prediction;

namespace {

struct Request {
  std::string calibration, device, csv, dump;
  std::vector<int> sets;
  double seconds = 1.0;  // of measuring each
  int one = 0;           // child: this set only
  bool explain = false;
};

struct Row {
  int set = 0;
  std::uint64_t objects = 0;
  std::string method;
  std::array<double, 2> measured_ms{}, predicted_ms{};  // one frame in flight, two
  double empty_ms = 0;                                  // T_0, one in flight
  [[nodiscard]] double deviation(std::size_t i) const {
    return tools::deviation_percent(predicted_ms[i], measured_ms[i]);
  }
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Stages of measured frames, ms.
class StageSamples {
 public:
  void add(const render::FrameReport& r) {
    const std::array values{r.update_ms, r.plan_ms,     r.record_ms, r.submit_ms,
                            r.wait_ms,   r.readback_ms, r.gpu_ms,    r.choose_ms};
    samples_.resize(values.size() + render::kGpuStages);
    for (std::size_t i = 0; i < values.size(); ++i) samples_[i].push_back(values[i]);
    for (std::size_t i = 0; i < render::kGpuStages; ++i)
      samples_[values.size() + i].push_back(r.gpu_stages_ms[i]);
  }
  [[nodiscard]] nlohmann::ordered_json medians() const {
    std::vector<std::string> names{"update", "plan", "record", "submit", "wait", "readback", "gpu", "choose"};
    for (const std::string_view name : render::kGpuStageNames) names.push_back("gpu." + std::string(name));
    nlohmann::ordered_json out;
    for (std::size_t i = 0; i < samples_.size(); ++i) out[names[i]] = median(samples_[i]);
    return out;
  }

 private:
  std::vector<std::vector<double>> samples_;
};

nlohmann::ordered_json json_of(const Prediction& p) {
  return {{"update", p.update_s * 1e3},
          {"updateOctree", p.update_octree_s * 1e3},
          {"cull", p.cull_s * 1e3},
          {"record", p.record_s * 1e3},
          {"secondaries", p.secondaries_s * 1e3},
          {"queriesCpu", p.queries_cpu_s * 1e3},
          {"draw", p.draw_device_s * 1e3},
          {"queries", p.query_device_s * 1e3},
          {"cpu", p.cpu_s * 1e3},
          {"gpu", p.gpu_s * 1e3},
          {"frame", p.frame_s * 1e3}};
}

struct Times {
  double one_s = 0, two_s = 0;
  double predicted_one_s = 0;
  Prediction predicted;
  nlohmann::ordered_json dump;
};

Result<Times> measure(const Scene& scene, Method method, const render::RendererOptions& options,
                      const Request& request) {
  StageSamples one_stages, two_stages;
  tools::AccuracyRequest how;
  how.seconds = request.seconds;
  how.two_in_flight = true;
  how.on_frame = [&](const render::FrameReport& report, bool two) {
    (two ? two_stages : one_stages).add(report);
  };
  auto run = tools::measure_accuracy(scene, method, options, how);
  if (!run) return forward_error(run);
  const render::FrameReport& r = run->last;
  if (request.explain) {
    const Prediction& p = r.predicted[static_cast<std::size_t>(method)];
    std::fprintf(stderr,
                 "  %-14s cpu %.3f/%.3f gpu %.3f/%.3f | upd %.3f/%.3f cull %.3f/%.3f rec %.3f/%.3f sec %.3f "
                 "q %.3f | draw %.3f "
                 "query %.3f | drawn %lu chunks %lu queries %lu hidden %lu\n",
                 std::string(name_of(method)).c_str(), p.cpu_s * 1e3,
                 r.update_ms + r.plan_ms + r.record_ms + r.submit_ms + r.readback_ms, p.gpu_s * 1e3, r.gpu_ms,
                 (p.update_s + p.update_octree_s) * 1e3, r.update_ms, p.cull_s * 1e3, r.plan_ms,
                 (p.record_s + p.secondaries_s + p.queries_cpu_s) * 1e3, r.record_ms + r.submit_ms,
                 p.secondaries_s * 1e3, p.queries_cpu_s * 1e3, p.draw_device_s * 1e3, p.query_device_s * 1e3,
                 r.drawn, r.secondaries, r.queries, r.believed_hidden);
  }
  Times out{median(run->one_ms) * 1e-3,
            median(run->two_ms) * 1e-3,
            run->predicted_one_ms * 1e-3,
            r.predicted[static_cast<std::size_t>(method)],
            {}};
  if (request.dump.empty()) return out;
  out.dump["one"] = one_stages.medians();
  out.dump["two"] = two_stages.medians();
  out.dump["oneMs"] = out.one_s * 1e3;
  out.dump["twoMs"] = out.two_s * 1e3;
  out.dump["counts"] = {{"draws", r.draws},     {"secondaries", r.secondaries},
                        {"queries", r.queries}, {"hidden", r.believed_hidden},
                        {"drawn", r.drawn},     {"triangles", r.triangles}};
  out.dump["facts"] = test::facts_json(r.facts);
  out.dump["predicted"] = json_of(out.predicted);
  return out;
}

Result<void> one_set(const Request& request, const render::Calibration& calibration) {
  Result<gen::Generated> made = gen::generate_test_set(request.one, 1);
  if (!made) return forward_error(made);
  const Scene& scene = made->scene;
  auto device = render::share_device({.wanted = request.device});
  if (!device) return forward_error(device);
  for (const Method method : tools::kAccuracyMethods) {
    render::RendererOptions o;
    o.shared_device = *device;
    o.size = calibration.key.size;
    o.samples = calibration.key.samples;
    o.shadows = calibration.key.shadows;
    o.costs = calibration.costs;
    o = tools::accuracy_options(o, method);
    const Result<Times> t = measure(scene, method, o, request);
    if (!t) {
      std::fprintf(stderr, "set %d, %s: %s\n", request.one, o.strategy.c_str(), t.error().str().c_str());
      continue;
    }
    const render::model::UnitCosts& c = calibration.costs;
    const double one_s = t->predicted_one_s;
    std::printf("%d %zu %s %.6f %.6f %.6f %.6f %.6f\n", request.one, scene.objects.size(), o.strategy.c_str(),
                t->one_s * 1e3, one_s * 1e3, t->two_s * 1e3, t->predicted.frame_s * 1e3,
                (c.empty_cpu_s + c.empty_device_s + c.latency_s) * 1e3);
    std::fflush(stdout);
    if (request.dump.empty()) continue;
    nlohmann::ordered_json line{{"set", request.one}, {"objects", scene.objects.size()}, {"way", o.strategy}};
    line.update(t->dump);
    std::ofstream(request.dump, std::ios::app) << line.dump() << '\n';
  }
  return {};
}

void print_summaries(const std::vector<Row>& rows) {
  std::printf("\ndeviation, %%                          scenes x ways   mean  median    p90   worst\n");
  const auto line = [&](const char* name, const auto& wanted) {
    for (const std::size_t flight : {0U, 1U}) {
      std::vector<double> deviations;
      for (const Row& r : rows) {
        if (wanted(r)) deviations.push_back(r.deviation(flight));
      }
      const tools::DeviationSummary s = tools::summarize_deviations(deviations);
      if (s.count > 0)
        std::printf("%-30s %u in flight  %5zu  %5.1f  %6.1f  %5.1f  %6.1f\n", name,
                    static_cast<unsigned>(flight + 1), s.count, s.mean, s.median, s.p90, s.worst);
    }
  };
  line("all", [](const Row&) { return true; });
  line("more than 384 objects", [](const Row& r) { return r.objects > 384; });
  line("at most 384 objects", [](const Row& r) { return r.objects <= 384; });
  line("frames of at least 5 T_0", [](const Row& r) { return r.measured_ms[0] >= 5 * r.empty_ms; });
  for (const Method m : tools::kAccuracyMethods)
    line(std::string(name_of(m)).c_str(), [&](const Row& r) { return r.method == name_of(m); });
  std::printf("the dissertation's, 1 - 48                     192   12.4    10.0   26.0    40.0\n");
}

std::vector<int> parse_sets(const std::string& text) {
  std::vector<int> out;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = std::min(text.find(',', at), text.size());
    const std::string part = text.substr(at, end - at);
    const std::size_t dash = part.find('-');
    const int first = std::atoi(part.c_str());
    const int last = dash == std::string::npos ? first : std::atoi(part.c_str() + dash + 1);
    for (int s = first; s <= last; ++s) out.push_back(s);
    at = end + 1;
  }
  return out;
}

int run_all(const Request& request, const std::string& self) {
  std::vector<Row> rows;
  std::printf(
      "set  objects  way             measured   predicted     dev   | two in flight     predicted     dev\n");
  for (const int set : request.sets) {
    std::string command = "'" + self + "' '" + request.calibration + "' --one " + std::to_string(set) +
                          " --seconds " + std::to_string(request.seconds);
    if (!request.device.empty()) command += " --device '" + request.device + "'";
    if (request.explain) command += " --explain";
    if (!request.dump.empty()) command += " --dump '" + request.dump + "'";
    std::FILE* pipe = popen(command.c_str(), "r");
    if (pipe == nullptr) return 3;
    std::array<char, 256> line{};
    while (std::fgets(line.data(), line.size(), pipe) != nullptr) {
      Row r;
      std::array<char, 32> name{};
      if (std::sscanf(line.data(), "%d %lu %31s %lf %lf %lf %lf %lf", &r.set, &r.objects, name.data(),
                      &r.measured_ms[0], &r.predicted_ms[0], &r.measured_ms[1], &r.predicted_ms[1],
                      &r.empty_ms) != 8)
        continue;
      r.method = name.data();
      std::printf("%3d  %7lu  %-14s %8.2f ms %8.2f ms  %5.1f %%  | %8.2f ms %8.2f ms  %5.1f %%\n", r.set,
                  r.objects, r.method.c_str(), r.measured_ms[0], r.predicted_ms[0], r.deviation(0),
                  r.measured_ms[1], r.predicted_ms[1], r.deviation(1));
      std::fflush(stdout);
      rows.push_back(r);
    }
    pclose(pipe);
  }
  if (!request.csv.empty()) {
    std::string csv = "set,objects,method,measured1_ms,predicted1_ms,measured2_ms,predicted2_ms\n";
    for (const Row& r : rows) {
      std::array<char, 160> text{};
      std::snprintf(text.data(), text.size(), "%d,%lu,%s,%.4f,%.4f,%.4f,%.4f\n", r.set, r.objects,
                    r.method.c_str(), r.measured_ms[0], r.predicted_ms[0], r.measured_ms[1],
                    r.predicted_ms[1]);
      csv += text.data();
    }
    if (const auto written = tools::write_file(request.csv, csv); !written)
      return tools::report_error(written.error());
  }
  print_summaries(rows);
  return rows.empty() ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  Request request;
  request.sets = parse_sets("5-48");
  for (int i = 1; i < argc; ++i) {
    const std::string_view a = argv[i];
    const char* value = i + 1 < argc ? argv[i + 1] : "";
    if (a == "--explain")
      request.explain = true;
    else if (a == "--sets")
      request.sets = parse_sets(value), ++i;
    else if (a == "--seconds")
      request.seconds = std::atof(value), ++i;
    else if (a == "--device")
      request.device = value, ++i;
    else if (a == "--csv")
      request.csv = value, ++i;
    else if (a == "--dump")
      request.dump = value, ++i;
    else if (a == "--one")
      request.one = std::atoi(value), ++i;
    else
      request.calibration = a;
  }
  std::ifstream in(request.calibration, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  const Result<render::Calibration> calibration = render::parse_calibration(text, request.calibration);
  if (!calibration) return tools::report_error(calibration.error());
  if (request.one == 0) return run_all(request, argv[0]);
  const Result<void> done = one_set(request, *calibration);
  return done ? 0 : tools::report_error(done.error());
}
