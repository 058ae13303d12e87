#include "tools/bench_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <vector>

#include "tools/bench_names.h"
#include "tools/report/report.h"
#include "tools/text.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;

ordered_json at(const ordered_json& object, const std::string& path) {
  return bench_member(object, path);
}

std::string text(const ordered_json& object, const std::string& path) {
  const ordered_json value = at(object, path);
  return value.is_string() ? value.get<std::string>() : "";
}

Cell cell(const ordered_json& value) {
  if (value.is_number()) return value.get<double>();
  if (value.is_string()) return value.get<std::string>();
  return {};
}

/// A case and the file that it is from.
struct Row {
  const ordered_json* json;
  const ordered_json* results;
  std::string label;  ///< the way of drawing, with what else tells it from the others of its view
};
/// What is seen from one camera of one scene.
struct BenchView {
  std::string scene, camera;  ///< titles
  std::vector<Row> rows;
  double best_ms = 0;

  [[nodiscard]] std::string title() const { return scene + (camera.empty() ? "" : ", " + camera); }
};

std::size_t number_of(const ordered_json* results, std::span<const ordered_json> all) {
  return static_cast<std::size_t>(results - all.data()) + 1;
}

/// The strategy, or the other renderer and its version.
std::string way_of(const ordered_json& c) {
  const std::string version = text(c, "version");
  return text(c, "strategy") + (version.empty() ? "" : " " + version);
}

/// Devices that a way of drawing was measured on, over all results.
using DevicesOfWays = std::map<std::string, std::set<std::string>>;

/// Labels that say what differs: device, frames in flight and results only where they do. A browser's device
/// has a long name and draws nothing of ours, so it is left out beside the device that draws ours.
void label(BenchView& view, std::span<const ordered_json> results, const DevicesOfWays& devices) {
  std::set<std::string> in_flight;
  for (const Row& row : view.rows) in_flight.insert(at(*row.json, "framesInFlight").dump());
  std::map<std::string, int> known;
  for (Row& row : view.rows) {
    const std::string way = way_of(*row.json);
    row.label = way;
    if (in_flight.size() > 1) row.label += ", " + at(*row.json, "framesInFlight").dump() + " in flight";
    if (devices.at(way).size() > 1) row.label += ", " + text(*row.json, "device");
    ++known[row.label];
  }
  for (Row& row : view.rows) {
    if (known[row.label] > 1) row.label += ", results " + std::to_string(number_of(row.results, results));
  }
}

std::vector<BenchView> views_of(std::span<const ordered_json> results) {
  const BenchNames scenes(results, "file");
  const BenchNames cameras(results, "camera");
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> known;
  std::vector<BenchView> out;
  DevicesOfWays devices;
  for (const ordered_json& result : results) {
    const auto cases = result.find("cases");
    if (cases == result.end() || !cases->is_array()) continue;
    for (const ordered_json& c : *cases) {
      const std::size_t scene = scenes.find(result, text(c, "file"));
      const std::size_t camera = cameras.find(result, text(c, "camera"));
      const auto [place, added] = known.emplace(std::pair(scene, camera), out.size());
      if (added) out.push_back({scenes.title(scene), cameras.title(camera), {}, 0});
      devices[way_of(c)].insert(text(c, "device"));
      BenchView& view = out[place->second];
      view.rows.push_back({&c, &result, {}});
      const ordered_json mean = at(c, "frameMs/mean");
      if (mean.is_number() && (view.best_ms <= 0 || mean.get<double>() < view.best_ms))
        view.best_ms = mean.get<double>();
    }
  }
  for (BenchView& view : out) label(view, results, devices);
  return out;
}

/// Loading and the first frame. A viewer's own time of loading goes before that of the scene, which is ours.
Cell load_ms(const Row& row) {
  const ordered_json start = at(*row.json, "startMs");
  ordered_json load = at(*row.json, "loadMs");
  const ordered_json scenes = at(*row.results, "scenes");
  for (const ordered_json& scene : scenes) {
    if (!load.is_number() && text(scene, "file") == text(*row.json, "file")) load = at(scene, "loadMs");
  }
  if (load.is_number() && start.is_number()) return load.get<double>() + start.get<double>();
  return cell(load);
}

Cell memory_bytes(const Row& row) {
  const ordered_json own = at(*row.json, "memoryBytes");
  return cell(own.is_number() ? own : at(*row.json, "deviceBytes"));
}

DocumentTable frame_table(const BenchView& view, const std::string& id) {
  using enum Better;
  DocumentTable out;
  out.id = id;
  out.title = "Frame time: " + view.title();
  out.columns = {{"strategy", "way of drawing", ""},
                 {"frameMs", "frame", "ms", Origin::ours, lower},
                 {"low", "95 % from", "ms"},
                 {"high", "to", "ms"},
                 {"median", "median", "ms", Origin::ours, lower},
                 {"p25", "25 %", "ms"},
                 {"p75", "75 %", "ms"},
                 {"p95", "95 %", "ms", Origin::ours, lower},
                 {"cpuMs", "processor", "ms", Origin::ours, lower},
                 {"processCpuMs", "processor, all threads", "ms", Origin::ours, lower},
                 {"gpuMs", "device", "ms", Origin::ours, lower},
                 {"vsBest", "over the best", "", Origin::ours, lower},
                 {"loadMs", "load to first frame", "ms", Origin::ours, lower},
                 {"memoryBytes", "memory", "B", Origin::ours, lower},
                 {"correctness", "pixels as ours", "%", Origin::ours, higher}};
  for (const Row& row : view.rows) {
    const ordered_json& c = *row.json;
    const ordered_json mean = at(c, "frameMs/mean");
    out.rows.push_back({row.label, cell(mean), cell(at(c, "frameMs/low")), cell(at(c, "frameMs/high")),
                        cell(at(c, "frameMs/median")), cell(at(c, "frameMs/p25")), cell(at(c, "frameMs/p75")),
                        cell(at(c, "frameMs/p95")), cell(at(c, "cpuMs/mean")),
                        cell(at(c, "processCpuMs/mean")), cell(at(c, "stagesMs/gpu/mean")),
                        mean.is_number() ? Cell(mean.get<double>() / view.best_ms) : Cell(), load_ms(row),
                        memory_bytes(row), cell(at(c, "correctness"))});
  }
  out.note =
      "Mean with its 95 % interval over the runs (Student), median, quartiles and 95th percentile over all "
      "frames. Processor: what the renderer works for a frame, not waiting; all threads: processor time of "
      "all that "
      "loads and draws (a software device too, and a browser's processes), whose sum over the cores may be "
      "above the "
      "frame's time. Without figures: what failed.";
  return out;
}

/// A table with a row a case and a column for each name of `member` that is above 0 anywhere.
DocumentTable member_table(const BenchView& view, const std::string& id, const std::string& member,
                           const std::string& suffix, const std::string& unit) {
  DocumentTable out;
  out.id = id;
  out.columns = {{"strategy", "way of drawing", ""}};
  std::vector<std::string> names;
  for (const Row& row : view.rows) {
    const ordered_json all = at(*row.json, member);
    if (!all.is_object()) continue;
    for (const auto& [name, value] : all.items()) {
      const ordered_json figure = suffix.empty() ? value : at(value, suffix);
      const bool counts = figure.is_number() && figure.get<double>() > 0;
      if (counts && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  for (const std::string& name : names) out.columns.push_back({name, name, unit});
  for (const Row& row : view.rows) {
    std::vector<Cell>& cells = out.rows.emplace_back(std::vector<Cell>{row.label});
    for (const std::string& name : names) {
      const ordered_json value = at(at(*row.json, member), name);
      cells.push_back(cell(suffix.empty() ? value : at(value, suffix)));
    }
  }
  return out;
}

DocumentTable stage_table(const BenchView& view, const std::string& id) {
  DocumentTable out = member_table(view, id, "stagesMs", "mean", "ms");
  out.title = "Where the time goes: " + view.title();
  out.note =
      "Means a frame. The processor seeks, updates, culls, records and submits; updateOctree is part of "
      "update, "
      "choose of cull, upload to receive of record. wait: the processor waits for the device. Those that "
      "begin with gpu are the "
      "device's.";
  return out;
}

DocumentTable counter_table(const BenchView& view, const std::string& id) {
  DocumentTable out = member_table(view, id, "counters", "", "");
  out.title = "What was done: " + view.title();
  out.note = "Exact counts, mean of a frame.";
  return out;
}

Chart time_chart(const BenchView& view, const std::string& id) {
  Chart out;
  out.id = id;
  out.title = "Frame time over the animation: " + view.title();
  out.x_title = "time, s";
  out.y_title = "frame time, ms";
  for (const Row& row : view.rows) {
    const ordered_json times = at(*row.json, "overTime/timeS");
    const ordered_json values = at(*row.json, "overTime/frameMs");
    if (!times.is_array() || !values.is_array() || times.size() != values.size()) continue;
    Series series;
    series.name = row.label;
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (times[i].is_number() && values[i].is_number())
        series.points.push_back({times[i].get<double>(), values[i].get<double>()});
    }
    if (series.points.size() > 1) out.series.push_back(std::move(series));
  }
  out.note = "Median over the runs.";
  return out;
}

/// Frame times of all views, a line a way of drawing.
Chart overview_chart(const std::vector<BenchView>& views, const std::string& id) {
  Chart out;
  out.id = id;
  out.title = "Frame time by view";
  out.x_title = "view";
  out.y_title = "frame time, ms";
  out.log_y = true;
  std::map<std::string, std::size_t> known;
  for (std::size_t v = 0; v < views.size(); ++v) {
    out.note += (v == 0 ? "" : "; ") + std::to_string(v + 1) + ": " + views[v].title();
    for (const Row& row : views[v].rows) {
      const ordered_json mean = at(*row.json, "frameMs/mean");
      if (!mean.is_number() || mean.get<double>() <= 0) continue;
      const auto [place, added] = known.emplace(row.label, out.series.size());
      if (added) out.series.push_back({row.label, {}});
      ChartPoint point{static_cast<double>(v + 1), mean.get<double>()};
      const ordered_json low = at(*row.json, "frameMs/p25");
      const ordered_json high = at(*row.json, "frameMs/p75");
      if (low.is_number() && high.is_number()) {
        // Quartiles need not lie round a mean; the bar does.
        point.low = std::min(point.y, low.get<double>());
        point.high = std::max(point.y, high.get<double>());
      }
      out.series[place->second].points.push_back(point);
    }
  }
  out.note += ". Means; bars span the middle half of the frames.";
  return out;
}

/// "Frames of three.js 187 take 5.8 to 6.9 times as long as those of the fastest, of inline 1.4 to 1.5
/// times."
std::string behind(const std::vector<BenchView>& views) {
  std::map<std::string, std::pair<double, double>> ranges;
  for (const BenchView& view : views) {
    for (const Row& row : view.rows) {
      const ordered_json mean = at(*row.json, "frameMs/mean");
      if (!mean.is_number() || view.best_ms <= 0) continue;
      const double factor = mean.get<double>() / view.best_ms;
      const auto [place, added] = ranges.emplace(row.label, std::pair(factor, factor));
      if (added) continue;
      place->second.first = std::min(place->second.first, factor);
      place->second.second = std::max(place->second.second, factor);
    }
  }
  using Range = std::pair<double, double>;
  std::vector<std::pair<std::string, Range>> order;
  for (const auto& [name, range] : ranges) {
    if (factor_text(range.second) != factor_text(1)) order.emplace_back(name, range);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.second.second > b.second.second; });
  std::string out;
  for (const auto& [name, range] : order) {
    const std::string low = factor_text(range.first);
    const std::string high = factor_text(range.second);
    const bool first = out.empty();
    out.append(first ? " Frames of " : ", of ").append(name).append(first ? " take " : " ");
    out += low;
    if (high != low) out.append(" to ").append(high);
    if (first) out += " times as long as those of the fastest";
  }
  return out.empty() ? out : out + ".";
}

/// "adaptive is fastest in 6 of 10 views, inline in 4."
std::string summary(const std::vector<BenchView>& views, std::size_t failed) {
  std::map<std::string, int> wins;
  int counted_views = 0;
  for (const BenchView& view : views) {
    for (const Row& row : view.rows) {
      const ordered_json mean = at(*row.json, "frameMs/mean");
      if (!mean.is_number() || mean.get<double>() > view.best_ms) continue;
      ++wins[row.label];
      ++counted_views;
      break;
    }
  }
  std::vector<std::pair<int, std::string>> order;
  order.reserve(wins.size());
  for (const auto& [name, count] : wins) order.emplace_back(-count, name);
  std::sort(order.begin(), order.end());
  std::string out;
  for (const auto& [count, name] : order) {
    out += out.empty() ? name + " is fastest in " + std::to_string(-count) + " of " +
                             counted(static_cast<std::uint64_t>(counted_views), "view")
                       : ", " + name + " in " + std::to_string(-count);
  }
  out = out.empty() ? "Nothing was measured" : out;
  if (failed > 0) out += "; " + counted(failed, "case") + " failed";
  return out + "." + behind(views);
}

std::string machine_line(const ordered_json& results) {
  std::string out = text(results, "program/name");
  if (const std::string version = text(results, "program/version"); !version.empty()) out += " " + version;
  for (const ordered_json& device : at(results, "devices")) {
    out += ", " + text(device, "name");
    const std::string driver = text(device, "driver");
    out += !driver.empty() ? " (" + driver + ")" : text(device, "error").empty() ? "" : " (missing)";
  }
  if (const std::string processor = text(results, "machine/processor"); !processor.empty())
    out += ", " + at(results, "machine/cores").dump() + " cores of " + processor;
  const ordered_json size = at(results, "settings/size");
  if (size.is_array() && size.size() == 2) out += ", " + size[0].dump() + "x" + size[1].dump() + " pixels";
  const ordered_json samples = at(results, "settings/samples");
  if (samples.is_number()) out += ", " + samples.dump() + (samples == 1 ? " sample" : " samples");
  const ordered_json readback = at(results, "settings/readback");
  if (readback.is_boolean())
    out += readback.get<bool>() ? ", pixels read back" : ", pixels stay on the device";
  return out + ".";
}

/// "Results 1, 3: ...": one line for all that were measured alike.
std::vector<std::string> machine_lines(std::span<const ordered_json> results) {
  std::vector<std::pair<std::string, std::string>> lines;  // what was measured with, whose numbers
  for (const ordered_json& result : results) {
    const std::string line = machine_line(result);
    const std::string number = std::to_string(number_of(&result, results));
    const auto known =
        std::find_if(lines.begin(), lines.end(), [&](const auto& other) { return other.first == line; });
    if (known == lines.end()) {
      lines.emplace_back(line, number);
    } else {
      known->second += ", " + number;
    }
  }
  std::vector<std::string> out;
  out.reserve(lines.size());
  for (const auto& [line, numbers] : lines) {
    std::string& own = out.emplace_back(results.size() > 1 ? "Results " : "");
    if (results.size() > 1) own.append(numbers).append(": ");
    own += line;
  }
  return out;
}

}  // namespace

DocumentSection bench_section_of_all(std::span<const ordered_json> results, const std::string& id) {
  const std::vector<BenchView> views = views_of(results);
  DocumentSection out{id, "Benchmark", {}, {}};
  for (const BenchView& view : views) {
    for (const Row& row : view.rows) {
      if (const std::string why = text(*row.json, "error"); !why.empty())
        out.failures.push_back({view.title() + ": " + row.label, why});
    }
  }
  out.paragraphs.push_back(summary(views, out.failures.size()));
  for (std::string& line : machine_lines(results)) out.paragraphs.push_back(std::move(line));
  if (views.size() > 1) {
    if (Chart chart = overview_chart(views, id + "-views"); !chart.series.empty())
      out.blocks.emplace_back(std::move(chart));
  }
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto block = [&, number = std::to_string(v + 1)](const char* what) {
      std::string out_id = id;
      return out_id.append("-").append(what).append("-").append(number);
    };
    out.blocks.emplace_back(frame_table(views[v], block("frame")));
    if (Chart chart = time_chart(views[v], block("time")); !chart.series.empty())
      out.blocks.emplace_back(std::move(chart));
    for (DocumentTable table :
         {stage_table(views[v], block("stages")), counter_table(views[v], block("counters"))}) {
      if (table.columns.size() > 1) out.blocks.emplace_back(std::move(table));
    }
  }
  return out;
}

DocumentSection bench_section(const ordered_json& results) {
  return bench_section_of_all(std::span(&results, 1));
}

Document bench_document(std::span<const ordered_json> results) {
  Document out{"Benchmark", {}, {bench_section_of_all(results)}};
  const ordered_json& first = results.front();
  const auto add = [&out](const char* name, std::string value) {
    if (!value.empty()) out.facts.emplace_back(name, std::move(value));
  };
  const std::string version = text(first, "program/version");
  add("program", text(first, "program/name") + (version.empty() ? "" : " " + version));
  add("compiler", text(first, "program/compiler"));
  add("machine", text(first, "machine/processor"));
  add("system", text(first, "machine/system"));
  for (const ordered_json& device : at(first, "devices")) add("device", text(device, "name"));
  for (const ordered_json& device : at(first, "devices")) add("driver", text(device, "driver"));
  const ordered_json scenes = at(first, "scenes");
  for (const ordered_json& scene : scenes) {
    std::string line = base_name(text(scene, "file"));
    for (const char* name : {"objects", "seed"}) {
      const ordered_json value = at(scene, name);
      if (value.is_number()) line.append(", ").append(name).append(" ").append(value.dump());
    }
    add("scene", line);
  }
  std::vector<std::string> words;
  for (const ordered_json& word : at(first, "arguments"))
    words.push_back(word.is_string() ? word.get<std::string>() : "");
  add("arguments", join(words, " "));
  return out;
}

}  // namespace scenegen::tools
