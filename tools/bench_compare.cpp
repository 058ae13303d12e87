#include "tools/bench_compare.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <numeric>

#include "tools/output.h"
#include "tools/text.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;
namespace fs = std::filesystem;

struct Moments {
  double mean = 0, variance = 0, count = 0;
};

Moments moments_of(const std::vector<double>& values) {
  Moments m;
  m.count = static_cast<double>(values.size());
  m.mean = std::accumulate(values.begin(), values.end(), 0.0) / m.count;
  for (const double v : values) m.variance += (v - m.mean) * (v - m.mean);
  m.variance /= m.count - 1;
  return m;
}

/// A case as it stands in a file.
struct Entry {
  BenchCase what;
  const ordered_json* json;
};

struct Results {
  std::vector<Entry> entries;
  std::size_t devices = 0;  ///< that have cases
};

Results results_of(const ordered_json& bench) {
  Results out;
  std::vector<std::string> devices;
  for (const ordered_json& c : bench.at("cases")) {
    Entry e;
    e.what.file = c.at("file").get<std::string>();
    e.what.device = c.at("device").get<std::string>();
    e.what.camera = c.at("camera").get<std::string>();
    e.what.frames_in_flight = c.at("framesInFlight").get<std::uint32_t>();
    e.what.way.label = c.at("strategy").get<std::string>();
    e.json = &c;
    if (std::find(devices.begin(), devices.end(), e.what.device) == devices.end())
      devices.push_back(e.what.device);
    out.entries.push_back(std::move(e));
  }
  out.devices = devices.size();
  return out;
}

/// What of a case must be equal for it to be the same in both results.
struct Likeness {
  bool device = false;       ///< else there is one in each, and they are compared
  bool whole_paths = false;  ///< else results of other folders can be compared too

  [[nodiscard]] std::string key(BenchCase what) const {
    if (!whole_paths) {
      what.file = base_name(what.file);
      what.camera = base_name(what.camera);
    }
    if (!device) what.device.clear();
    return what.key();
  }
};

/// Whether scenes or cameras of several folders have one name.
bool names_clash(const Results& results) {
  std::map<std::string, std::string> scenes;
  std::map<std::string, std::string> cameras;
  const auto clash = [](std::map<std::string, std::string>& path_of, const std::string& path) {
    return path_of.emplace(base_name(path), path).first->second != path;
  };
  return std::any_of(results.entries.begin(), results.entries.end(), [&](const Entry& e) {
    return clash(scenes, e.what.file) || clash(cameras, e.what.camera);
  });
}

std::string case_name(const BenchCase& what) {
  std::string out = base_name(what.file) + ", " + what.device;
  if (!what.camera.empty()) out += ", " + base_name(what.camera);
  return out + ", " + std::to_string(what.frames_in_flight) + " in flight, " + what.way.label;
}

void compare_counters(const ordered_json& a, const ordered_json& b, CaseChange& out) {
  out.counters_vary = !a.value("sameCounters", true) || !b.value("sameCounters", true);
  if (out.counters_vary || !a.contains("counters") || !b.contains("counters")) return;
  for (const auto& [name, value] : a.at("counters").items()) {
    const auto other = b.at("counters").find(name);
    if (other == b.at("counters").end()) continue;  // another version's
    const auto was = value.get<double>();
    const auto is = other->get<double>();
    if (was != is) out.counters.push_back({name, was, is});
  }
}

CaseChange compare_case(const Entry& a, const Entry& b, double least_share) {
  CaseChange out;
  out.what = a.what;
  const ordered_json& frame_a = a.json->at("frameMs");
  const ordered_json& frame_b = b.json->at("frameMs");
  out.mean_a_ms = frame_a.at("mean").get<double>();
  out.mean_b_ms = frame_b.at("mean").get<double>();
  out.median_a_ms = frame_a.at("median").get<double>();
  out.median_b_ms = frame_b.at("median").get<double>();
  out.difference_ms =
      welch95(frame_a.at("runs").get<std::vector<double>>(), frame_b.at("runs").get<std::vector<double>>());
  if (out.difference_ms) {
    const bool enough = std::abs(out.mean_b_ms - out.mean_a_ms) >= least_share * out.mean_a_ms;
    out.change = enough && out.difference_ms->low > 0    ? Change::slower
                 : enough && out.difference_ms->high < 0 ? Change::faster
                                                         : Change::same;
  }
  compare_counters(*a.json, *b.json, out);
  return out;
}

void warn_if_differs(const ordered_json& a, const ordered_json& b, const std::string& name,
                     std::vector<std::string>& warnings) {
  if (a == b) return;
  const auto text = [](const ordered_json& v) {
    return v.is_null() ? std::string("not given") : v.is_string() ? v.get<std::string>() : v.dump();
  };
  warnings.push_back(name + ": " + text(a) + " in A, " + text(b) + " in B");
}

ordered_json member(const ordered_json& object, const std::string& name) {
  return object.is_object() && object.contains(name) ? object.at(name) : ordered_json();
}

std::vector<std::string> warnings_of(const ordered_json& a, const ordered_json& b, bool same_devices) {
  std::vector<std::string> out;
  for (const char* name : {"processor", "cores", "memoryBytes", "system"})
    warn_if_differs(member(member(a, "machine"), name), member(member(b, "machine"), name),
                    std::string("machine, ") + name, out);
  for (const char* name : {"name", "version", "compiler"})
    warn_if_differs(member(member(a, "program"), name), member(member(b, "program"), name),
                    std::string("program, ") + name, out);
  const ordered_json devices_a = member(a, "devices");
  const ordered_json devices_b = member(b, "devices");
  for (const ordered_json& d : devices_a) {
    for (const ordered_json& e : devices_b) {
      if (member(d, "error").is_string() || member(e, "error").is_string()) continue;
      if (same_devices && member(d, "name") != member(e, "name")) continue;
      warn_if_differs(member(d, "name"), member(e, "name"), "device", out);
      warn_if_differs(member(d, "driver"), member(e, "driver"), "driver", out);
    }
  }
  const ordered_json settings_a = member(a, "settings");
  const ordered_json settings_b = member(b, "settings");
  for (const auto& [name, value] : settings_a.items()) {
    if (name != "version") warn_if_differs(value, member(settings_b, name), name, out);
  }
  for (const auto& [name, value] : settings_b.items()) {
    if (!settings_a.contains(name)) warn_if_differs(ordered_json(), value, name, out);
  }
  return out;
}

std::string failure(const Entry& e) {
  return case_name(e.what) + ": " + e.json->at("error").get<std::string>();
}

}  // namespace

std::string_view name_of(Change change) {
  switch (change) {
    case Change::same:
      return "same";
    case Change::faster:
      return "faster";
    case Change::slower:
      return "slower";
    case Change::unknown:
      break;
  }
  return "unknown";
}

Result<ordered_json> read_bench(const std::string& path) {
  std::error_code error;
  const std::string file = fs::is_directory(path, error) ? (fs::path(path) / "bench.json").string() : path;
  std::ifstream in(file, std::ios::binary);
  if (!in) return fail(ErrorKind::io, file, "cannot be read");
  constexpr std::uintmax_t kMost = 1U << 28U;  // 1000 cases of ten runs of 1000 frames are some 200 MB
  if (const auto bytes = fs::file_size(file, error); !error && bytes > kMost)
    return fail(ErrorKind::bad_input, file, "is above 256 MiB");
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  ordered_json out = json_excess(text).empty() ? ordered_json::parse(text, nullptr, false) : ordered_json();
  if (!out.is_object() || member(out, "schema") != kBenchSchema)
    return fail(ErrorKind::bad_input, file, "is no result of sceneplay bench");
  if (const ordered_json version = member(out, "version"); version != kBenchVersion)
    return fail(ErrorKind::bad_input, file,
                "is of version " + version.dump() + " of the results; this program reads version " +
                    std::to_string(kBenchVersion) + ": measure anew");
  if (!member(out, "cases").is_array()) return fail(ErrorKind::bad_input, file + ": /cases", "is missing");
  return out;
}

std::optional<Interval> welch95(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() < 2 || b.size() < 2) return std::nullopt;
  const Moments ma = moments_of(a);
  const Moments mb = moments_of(b);
  const double va = ma.variance / ma.count;
  const double vb = mb.variance / mb.count;
  const double difference = mb.mean - ma.mean;
  if (va + vb <= 0) return Interval{difference, difference};
  const double degrees = (va + vb) * (va + vb) / (va * va / (ma.count - 1) + vb * vb / (mb.count - 1));
  const double half = student95(static_cast<std::size_t>(std::max(1.0, degrees))) * std::sqrt(va + vb);
  return Interval{difference - half, difference + half};
}

bool BenchComparison::any_slower() const {
  return count(Change::slower) > 0;
}

bool BenchComparison::any_counters() const {
  return std::any_of(cases.begin(), cases.end(), [](const CaseChange& c) { return !c.counters.empty(); });
}

std::uint64_t BenchComparison::count(Change change) const {
  return static_cast<std::uint64_t>(
      std::count_if(cases.begin(), cases.end(), [&](const CaseChange& c) { return c.change == change; }));
}

Result<BenchComparison> compare_bench(const ordered_json& a, const ordered_json& b, double least_share) {
  try {
    BenchComparison out;
    const Results before = results_of(a);
    const Results after = results_of(b);
    const bool by_device = before.devices > 1 || after.devices > 1;
    const Likeness like{by_device, names_clash(before) || names_clash(after)};
    std::map<std::string, const Entry*> others;
    for (const Entry& e : after.entries) others.emplace(like.key(e.what), &e);
    for (const Entry& e : before.entries) {
      const auto found = others.find(like.key(e.what));
      const bool good = !e.json->contains("error");
      if (!good) out.failed_a.push_back(failure(e));
      if (found == others.end()) {
        if (good) out.only_a.push_back(case_name(e.what));
        continue;
      }
      const bool other_good = !found->second->json->contains("error");
      if (good && other_good) out.cases.push_back(compare_case(e, *found->second, least_share));
      if (!other_good) out.failed_b.push_back(failure(*found->second));
      if (good && !other_good) out.only_a.push_back(case_name(e.what));
      if (!good && other_good) out.only_b.push_back(case_name(found->second->what));
      others.erase(found);
    }
    for (const Entry& e : after.entries) {
      const auto left = others.find(like.key(e.what));
      if (left == others.end() || left->second != &e) continue;
      const bool good = !e.json->contains("error");
      (good ? out.only_b : out.failed_b).push_back(good ? case_name(e.what) : failure(e));
    }
    out.warnings = warnings_of(a, b, by_device);
    return out;
  } catch (const nlohmann::json::exception& e) {
    return fail(ErrorKind::bad_input, "", std::string("a member is missing or of another kind: ") + e.what());
  }
}

ordered_json comparison_json(const BenchComparison& comparison) {
  ordered_json out = ordered_json::array();
  for (const CaseChange& c : comparison.cases) {
    ordered_json row{{"file", c.what.file},
                     {"device", c.what.device},
                     {"camera", c.what.camera},
                     {"framesInFlight", c.what.frames_in_flight},
                     {"strategy", c.what.way.label},
                     {"meanAMs", c.mean_a_ms},
                     {"meanBMs", c.mean_b_ms},
                     {"medianAMs", c.median_a_ms},
                     {"medianBMs", c.median_b_ms},
                     {"differenceMs", c.mean_b_ms - c.mean_a_ms},
                     {"lowMs", c.difference_ms ? ordered_json(c.difference_ms->low) : ordered_json()},
                     {"highMs", c.difference_ms ? ordered_json(c.difference_ms->high) : ordered_json()},
                     {"ratio", c.mean_b_ms / c.mean_a_ms},
                     {"change", name_of(c.change)},
                     {"countersVary", c.counters_vary}};
    ordered_json& counters = row["counters"] = ordered_json::array();
    for (const CounterChange& k : c.counters) counters.push_back({{"name", k.name}, {"a", k.a}, {"b", k.b}});
    out.push_back(std::move(row));
  }
  return out;
}

}  // namespace scenegen::tools
