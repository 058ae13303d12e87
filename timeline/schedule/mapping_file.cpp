// The mapping as JSON, to run a plan again on a newer model.
#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "scene/limits.h"
#include "timeline/schedule/mapping.h"
#include "timeline/schedule/plan_values.h"

namespace scenegen::timeline {

namespace {

using nlohmann::json;
using nlohmann::ordered_json;  // looks keys up by walking: for writing only

constexpr std::string_view kSchema = "scenegen/mapping";

Result<SavedMapping::Object> parse_object(const json& value, const std::string& where) {
  SavedMapping::Object out;
  if (value.is_string()) {
    out.name = value.get<std::string>();
    out.search = true;
  } else if (value.is_object()) {
    for (const auto& [key, member] : value.items()) {
      if (key != "name" && key != "guid") continue;
      if (!member.is_string())
        return fail(ErrorKind::bad_input, std::string(where).append("/").append(key), "wanted a string");
      (key == "name" ? out.name : out.guid) = member.get<std::string>();
    }
  }
  if (!out.name.empty() || !out.guid.empty()) return out;
  return fail(ErrorKind::bad_input, where,
              "wanted a name, an identifier or a selector, or an object with \"name\" or \"guid\"");
}

/// Tells whether an identifier is a task's alone. Objects of a storey share one: each is asked for once.
class WholeGuids {
 public:
  explicit WholeGuids(const ObjectFacts& facts) : facts_(facts) {}
  /// All that has `guid` is among `objects`, those of task `task`, ascending.
  bool within(std::string_view guid, std::size_t task, const std::vector<ObjectId>& objects) {
    const auto [at, fresh] = known_.try_emplace(guid);
    Known& known = at->second;
    if (fresh) {
      const std::vector<ObjectId> all = Selector::with_guid(guid).select(facts_);
      known.count = all.size();
      if (!all.empty()) known.first = all.front(), known.last = all.back();
    }
    if (known.task == task) return known.whole;
    known.task = task;
    const auto has = [&](ObjectId id) { return std::binary_search(objects.begin(), objects.end(), id); };
    known.whole = known.count <= objects.size() && has(known.first) && has(known.last);
    if (known.whole && known.count > 2) {  // not kept: identifiers on one node would each keep all below it
      const std::vector<ObjectId> all = Selector::with_guid(guid).select(facts_);
      known.whole = std::all_of(all.begin(), all.end(), has);
    }
    return known.whole;
  }

 private:
  struct Known {
    std::size_t count = 0;
    ObjectId first, last;
    std::size_t task = std::numeric_limits<std::size_t>::max();  ///< that `whole` is about
    bool whole = false;
  };
  const ObjectFacts& facts_;
  std::unordered_map<std::string_view, Known> known_;
};

}  // namespace

Result<SavedMapping> parse_mapping(std::string_view text, const std::string& name) {
  SavedMapping out;
  out.path = name;
  json document;
  try {
    document = json::parse(text);
  } catch (const json::exception& error) {
    std::string_view what = error.what();
    what.remove_prefix(std::min(what.size(), what.find("] ") + 2));  // nlohmann's own number
    return fail(ErrorKind::bad_input, name, "is not JSON: " + std::string(what.substr(0, what.find('\n'))));
  }
  if (!document.is_object() || document.value("schema", json()) != kSchema)
    return fail(ErrorKind::bad_input, name,
                "is no mapping: \"schema\" must be \"" + std::string(kSchema) + "\"");
  if (document.value("version", json()) != 1)
    return fail(ErrorKind::bad_input, name + ": /version", "this program reads version 1");
  const auto tasks = document.find("tasks");
  if (tasks == document.end() || !tasks->is_object())
    return fail(ErrorKind::bad_input, name + ": /tasks", "wanted an object of task ids");
  for (const auto& [id, entry] : tasks->items()) {
    const std::string where = name + ": /tasks/" + in_quotes(id);
    const json* list = &entry;
    if (entry.is_object() && entry.contains("objects")) list = &entry["objects"];
    if (!list->is_array()) return fail(ErrorKind::bad_input, where, "wanted a list of objects");
    SavedMapping::Entry& task = out.tasks.emplace_back();
    task.task_id = id;
    for (std::size_t i = 0; i < list->size(); ++i) {
      auto object = parse_object((*list)[i], where + "/" + std::to_string(i));
      if (!object) return forward_error(object);
      task.objects.push_back(std::move(*object));
    }
  }
  return out;
}

Result<SavedMapping> read_mapping(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return fail(ErrorKind::io, path, "cannot be read");
  std::string text;
  std::array<char, 65536> piece;
  while (file && text.size() <= limits::kMaxPlanBytes) {
    file.read(piece.data(), piece.size());
    text.append(piece.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (text.size() > limits::kMaxPlanBytes)
    return fail(ErrorKind::bad_input, path,
                "is larger than " + std::to_string(limits::kMaxPlanBytes >> 20) + " MiB");
  if (!file.eof()) return fail(ErrorKind::io, path, "cannot be read");
  return parse_mapping(text, path);
}

std::string write_mapping(const Plan& plan, const Mapping& mapping, const Scene& scene,
                          const ObjectFacts& facts) {
  ordered_json tasks = ordered_json::object();
  // Appended as to a vector: ids are unique, and to look each up among those before would take their square.
  std::vector<ordered_json::object_t::value_type>& entries = tasks.get_ref<ordered_json::object_t&>();
  entries.reserve(plan.tasks.size());
  WholeGuids guids(facts);
  for (std::size_t i = 0; i < plan.tasks.size(); ++i) {
    const std::vector<ObjectId>& objects = mapping.objects_of_task[i];
    if (objects.empty()) continue;
    ordered_json list = ordered_json::array();
    for (const ObjectId object : objects) {
      ordered_json entry{{"name", scene.objects.names[object.value]}};
      // An identifier stands for all that has it: it is kept where that is the task's alone, so that a wall
      // which is in more parts in the newer model is found whole, and a storey's does not stand for one wall.
      const std::string_view guid = facts.guid(object);
      if (!guid.empty() && guids.within(guid, i, objects)) entry["guid"] = guid;
      list.push_back(std::move(entry));
    }
    entries.emplace_back(plan.tasks[i].id,
                         ordered_json{{"name", plan.tasks[i].name}, {"objects", std::move(list)}});
  }
  const ordered_json document{{"schema", kSchema}, {"version", 1}, {"tasks", std::move(tasks)}};
  return document.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace scenegen::timeline
