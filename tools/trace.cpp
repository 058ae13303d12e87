#include "tools/trace.h"

#include <set>
#include <vector>

#include "tools/frame_fields.h"
#include "tools/output.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;

void flatten(const std::string& name, const ordered_json& value, ordered_json& out) {
  const std::string prefix = name.empty() ? "" : name + ".";
  if (value.is_array()) {
    for (const ordered_json& entry : value) {
      if (!entry.is_object() || !entry.contains("name")) continue;
      ordered_json rest = entry;
      rest.erase("name");
      flatten(prefix + entry["name"].get<std::string>(), rest, out);
    }
  } else if (value.is_object()) {
    for (const auto& [key, member] : value.items()) flatten(prefix + key, member, out);
  } else {
    out[name] = value;
  }
}

ordered_json vector_json(const glm::vec3& v) {
  return {{"x", v.x}, {"y", v.y}, {"z", v.z}};
}

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

std::string flat_csv(const ordered_json& rows) {
  std::vector<ordered_json> flat;
  std::vector<Table::Column> columns;
  std::set<std::string> known;
  for (const ordered_json& row : rows) {
    flatten("", row, flat.emplace_back(ordered_json::object()));
    for (const auto& [name, value] : flat.back().items()) {
      if (known.insert(name).second) columns.push_back({name, name});
    }
  }
  Table table(columns);
  for (const ordered_json& row : flat) {
    std::vector<ordered_json> values;
    for (const Table::Column& column : columns) {
      const auto found = row.find(column.name);
      values.push_back(found == row.end() ? ordered_json() : *found);
    }
    table.row(std::move(values));
  }
  return table.str(Format::csv);
}

ordered_json trace_row(const render::FrameReport& r, const render::View& view, const std::string& strategy,
                       double seek_ms, std::uint32_t passes) {
  // Kept command buffers are one a pass, indirect draws are written once for all.
  const std::uint64_t kept = r.chunks * (r.secondaries > 0 ? passes : 1);
  ordered_json out{
      {"timeS", r.time_s},    {"eyeM", vector_json(view.eye_m())}, {"forward", vector_json(view.forward())},
      {"strategy", strategy}, {"alphaN", share(r.recorded, kept)}, {"dAnim", share(r.changed, r.objects)}};
  add_choice(r, out);
  const bool chosen = r.verdict.used_s > 0.0;
  out["choiceLeftMs"] = chosen ? ordered_json(r.verdict.used_s * 1e3) : ordered_json();
  out["choiceRightMs"] = chosen ? ordered_json(r.verdict.rival_s * 1e3) : ordered_json();
  for (const CounterField& field : counter_fields()) out[std::string(field.name)] = r.*field.value;
  ordered_json& stages = out["stagesMs"] = {{"seek", seek_ms}};
  for (const StageField& field : stage_fields()) {
    const double ms = r.*field.value;
    stages[std::string(field.name)] = ms < 0 ? ordered_json() : ordered_json(ms);
  }
  ordered_json& gpu = out["gpuStagesMs"];
  for (std::size_t i = 0; i < render::kGpuStages; ++i) {
    const double ms = r.gpu_stages_ms[i];
    gpu[std::string(render::kGpuStageNames[i])] = ms < 0 ? ordered_json() : ordered_json(ms);
  }
  return out;
}

Result<void> check_trace_name(const std::string& path) {
  if (path.empty() || path.ends_with(".csv") || path.ends_with(".json")) return {};
  return fail(ErrorKind::usage, "--trace", "'" + path + "' ends with neither .csv nor .json");
}

Result<void> write_trace(const std::string& path, const ordered_json& rows) {
  if (path.ends_with(".csv")) return write_file(path, flat_csv(rows));
  return write_file(path, pretty({{"schema", "sceneplay/trace"}, {"version", 1}, {"frames", rows}}));
}

}  // namespace scenegen::tools
