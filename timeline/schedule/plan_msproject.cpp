// MS Project XML (MSPDI) -> Plan.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <pugixml.hpp>
#include <unordered_map>

#include "scene/limits.h"
#include "timeline/schedule/plan_build.h"
#include "timeline/schedule/plan_values.h"

namespace scenegen::timeline {

namespace {

struct Fault {
  Error error;
};

[[noreturn]] void reject(std::string where, std::string what) {
  throw Fault{Error{ErrorKind::bad_input, std::move(where), std::move(what)}};
}

std::string_view local_name(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  const std::size_t colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

/// What prefixes stand for. Attributes of an element are walked once, however many elements are below it.
class Namespaces {
 public:
  /// The namespace that the prefix of an element's name stands for; "" where none is declared.
  std::string_view of(const pugi::xml_node& node) {
    const std::string_view name = node.name();
    const std::size_t colon = name.find(':');
    const std::string_view prefix = colon == std::string_view::npos ? "" : name.substr(0, colon);
    for (pugi::xml_node up = node; up.type() == pugi::node_element; up = up.parent()) {
      if (!up.first_attribute()) continue;
      const Declared& declared = declared_by(up);
      if (const auto found = declared.find(prefix); found != declared.end()) return found->second;
    }
    return {};
  }

 private:
  using Declared = std::map<std::string_view, std::string_view>;  ///< by prefix

  const Declared& declared_by(const pugi::xml_node& node) {
    const auto [at, fresh] = by_node_.try_emplace(node.internal_object());
    if (!fresh) return at->second;
    for (const pugi::xml_attribute& attribute : node.attributes()) {
      const std::string_view name = attribute.name();
      if (name == "xmlns") at->second.emplace("", attribute.value());
      if (name.starts_with("xmlns:")) at->second.emplace(name.substr(6), attribute.value());
    }
    return at->second;
  }

  std::unordered_map<const void*, Declared> by_node_;
};

class ProjectReader {
 public:
  ProjectReader(std::string_view bytes, const std::string& name, const PlanOptions& options)
      : bytes_(bytes), name_(name), options_(options) {}
  Plan read();

 private:
  /// Where each outline level stands: the task that the next deeper one is below.
  struct Outline {
    std::int64_t level;
    std::uint32_t task;
  };
  struct LinkRecord {
    std::uint32_t task;
    std::int64_t uid;
    Link link;
    bool percent;
  };

  void find_lines();
  [[nodiscard]] std::string place(const pugi::xml_node& node) const;
  [[nodiscard]] bool is(const pugi::xml_node& node, std::string_view name) const {
    return node.type() == pugi::node_element && local_name(node) == name &&
           namespaces_.of(node) == namespace_;
  }
  [[nodiscard]] pugi::xml_node child(const pugi::xml_node& node, std::string_view name) const {
    return node.find_child([&](const pugi::xml_node& c) { return is(c, name); });
  }
  [[nodiscard]] std::string_view text(const pugi::xml_node& node, std::string_view name) const {
    return trimmed(child(node, name).child_value());
  }
  [[nodiscard]] std::int64_t whole(const pugi::xml_node& node, std::string_view name, std::int64_t otherwise,
                                   const std::string& where) const;
  [[nodiscard]] bool flag(const pugi::xml_node& node, std::string_view name, const std::string& where) const;
  [[nodiscard]] std::optional<CivilSeconds> date(const pugi::xml_node& node, std::string_view name,
                                                 const std::string& where) const;
  [[nodiscard]] CivilSeconds working(double minutes, std::int64_t format, const std::string& where) const;
  void read_fields(const pugi::xml_node& project);
  void read_task(const pugi::xml_node& node);
  void read_dates(const pugi::xml_node& node, Task& task);
  void read_links(const pugi::xml_node& node, std::uint32_t index);
  void read_extended(const pugi::xml_node& node, Task& task);
  void resolve_links();
  void add_defaults(const pugi::xml_node& project);

  std::string_view bytes_;
  const std::string& name_;
  const PlanOptions& options_;
  mutable Namespaces namespaces_;  ///< remembers
  std::string namespace_;
  bool has_lines_ = false;
  std::vector<std::size_t> line_ends_;
  double minutes_per_day_ = 480;
  std::map<std::string, Column, std::less<>> fields_;  ///< of extended attributes, by FieldID
  std::vector<Outline> outline_;
  std::map<std::int64_t, std::uint32_t> by_uid_;
  std::vector<LinkRecord> links_;
  std::uint64_t inactive_ = 0;
  Plan plan_;
};

/// Offsets of nodes are offsets in the bytes only where those were UTF-8.
void ProjectReader::find_lines() {
  has_lines_ = bytes_.substr(0, 4).find('\0') == std::string_view::npos;
  for (std::size_t i = 0; i < bytes_.size(); ++i) {
    if (bytes_[i] == '\n') line_ends_.push_back(i);
  }
}

std::string ProjectReader::place(const pugi::xml_node& node) const {
  const std::ptrdiff_t offset = node.offset_debug();
  if (!has_lines_ || offset < 0) return name_;
  const auto line = std::lower_bound(line_ends_.begin(), line_ends_.end(), static_cast<std::size_t>(offset)) -
                    line_ends_.begin();
  return name_ + ": line " + std::to_string(line + 1);
}

std::int64_t ProjectReader::whole(const pugi::xml_node& node, std::string_view name, std::int64_t otherwise,
                                  const std::string& where) const {
  const std::string_view digits = text(node, name);
  if (digits.empty()) return otherwise;
  std::int64_t out = 0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), out);
  constexpr std::int64_t kMost = 0x7FFFFFFF;
  if (code != std::errc() || end != digits.data() + digits.size() || out > kMost || out < -kMost)
    reject(where, std::string(name) + " " + in_quotes(digits) + " is no whole number of 32 bits");
  return out;
}

bool ProjectReader::flag(const pugi::xml_node& node, std::string_view name, const std::string& where) const {
  const std::string_view value = text(node, name);
  if (value.empty() || value == "0" || value == "false") return false;
  if (value == "1" || value == "true") return true;
  reject(where, std::string(name) + " " + in_quotes(value) + " is none of 0, 1, false, true");
}

std::optional<CivilSeconds> ProjectReader::date(const pugi::xml_node& node, std::string_view name,
                                                const std::string& where) const {
  const std::string_view value = text(node, name);
  if (value.empty() || value == "NA") return std::nullopt;
  auto moment = parse_moment(value, options_.date_order);
  if (!moment) reject(where, std::string(name) + " " + moment.error().what);
  return moment->at_s;
}

/// Working time becomes calendar time: MinutesPerDay of work are a day. Elapsed formats (4, 6, 8, 10, 12; the
/// same, estimated: 36, 38, 40, 42, 44) are clock time already.
CivilSeconds ProjectReader::working(double minutes, std::int64_t format, const std::string& where) const {
  const bool elapsed = ((format >= 4 && format <= 12) || (format >= 36 && format <= 44)) && format % 2 == 0;
  const double days = minutes / (elapsed ? 1440.0 : minutes_per_day_);
  auto out = whole_seconds(days * static_cast<double>(kDay), std::to_string(minutes) + " minutes");
  if (!out) reject(where, out.error().what);
  return *out;
}

/// Custom fields count by their alias (or name), as columns of a CSV do.
void ProjectReader::read_fields(const pugi::xml_node& project) {
  for (const pugi::xml_node& field : child(project, "ExtendedAttributes")) {
    if (!is(field, "ExtendedAttribute")) continue;
    const std::string_view alias = text(field, "Alias");
    const Column column = column_of(alias.empty() ? text(field, "FieldName") : alias);
    const bool wanted = column == Column::type || column == Column::objects || column == Column::selector ||
                        column == Column::offset;
    if (wanted) fields_.emplace(text(field, "FieldID"), column);
  }
}

void ProjectReader::read_dates(const pugi::xml_node& node, Task& task) {
  const auto first = [&](std::string_view name, std::string_view manual) {
    const auto value = date(node, name, task.where);
    return value ? value : date(node, manual, task.where);
  };
  task.start_s = first("Start", "ManualStart");
  task.finish_s = first("Finish", "ManualFinish");
  std::string_view duration = text(node, "Duration");
  if (duration.empty()) duration = text(node, "ManualDuration");
  if (!duration.empty()) {
    auto seconds = parse_duration(duration);
    if (!seconds) reject(task.where, "Duration " + seconds.error().what);
    task.duration_s = working(static_cast<double>(*seconds) / 60.0,
                              whole(node, "DurationFormat", 7, task.where), task.where);
  }
  if (flag(node, "Milestone", task.where) && !task.duration_s) task.duration_s = 0;
}

void ProjectReader::read_links(const pugi::xml_node& node, std::uint32_t index) {
  constexpr std::array<LinkKind, 4> kKinds{LinkKind::finish_finish, LinkKind::finish_start,
                                           LinkKind::start_finish, LinkKind::start_start};
  const std::string& where = plan_.tasks[index].where;
  for (const pugi::xml_node& record : node) {
    if (!is(record, "PredecessorLink") || flag(record, "CrossProject", where)) continue;
    LinkRecord link{index, whole(record, "PredecessorUID", -1, where), {}, false};
    if (link.uid < 0) reject(where, "a PredecessorLink without a PredecessorUID");
    const std::int64_t type = whole(record, "Type", 1, where);
    if (type < 0 || type > 3) {
      reject(where,
             "PredecessorLink of Type " + std::to_string(type) + "; allowed 0 (FF), 1 (FS), 2 (SF), 3 (SS)");
    }
    link.link.kind = kKinds[static_cast<std::size_t>(type)];
    const std::int64_t format = whole(record, "LagFormat", 7, where);
    link.percent = format == 19 || format == 20 || format == 51 || format == 52;
    const std::int64_t lag = whole(record, "LinkLag", 0, where);  // tenths of a minute
    if (!link.percent) link.link.lag_s = working(static_cast<double>(lag) / 10.0, format, where);
    link.percent = link.percent && lag != 0;
    links_.push_back(link);
  }
}

void ProjectReader::read_extended(const pugi::xml_node& node, Task& task) {
  if (fields_.empty()) return;
  for (const pugi::xml_node& field : node) {
    if (!is(field, "ExtendedAttribute")) continue;
    const auto found = fields_.find(text(field, "FieldID"));
    if (found == fields_.end()) continue;
    if (auto taken = take_cell(task, found->second, text(field, "Value"), options_); !taken)
      reject(task.where, "ExtendedAttribute " + taken.error().what);
  }
}

void ProjectReader::read_task(const pugi::xml_node& node) {
  const std::string where = place(node);
  if (flag(node, "IsNull", where + ": a Task")) return;  // an empty line of the plan
  const std::int64_t uid = whole(node, "UID", -1, where + ": a Task");
  if (text(node, "UID").empty()) reject(where, "a Task without a UID");
  const std::string at = where + ": Task with UID " + std::to_string(uid);
  if (child(node, "Active") && !flag(node, "Active", at)) {
    ++inactive_;
    return;
  }
  if (plan_.tasks.size() == limits::kMaxTasks)
    reject(at, "more than " + std::to_string(limits::kMaxTasks) + " tasks");
  const auto index = static_cast<std::uint32_t>(plan_.tasks.size());
  const auto [other, fresh] = by_uid_.emplace(uid, index);
  if (!fresh) reject(at, "its UID is that of a task before (" + plan_.tasks[other->second].where + ")");
  Task& task = plan_.tasks.emplace_back();
  task.where = at;
  task.id = std::to_string(uid);
  task.name = text(node, "Name");
  if (task.name.empty()) task.name = task.id;
  task.profile = options_.default_profile;
  task.summary = flag(node, "Summary", at);
  read_dates(node, task);
  read_links(node, index);
  read_extended(node, task);
  if (!child(node, "OutlineLevel")) return;
  const std::int64_t level = whole(node, "OutlineLevel", 0, at);
  while (!outline_.empty() && outline_.back().level >= level) outline_.pop_back();
  if (!outline_.empty()) {
    task.parent = outline_.back().task;
    plan_.tasks[task.parent].summary = true;
  }
  outline_.push_back({level, index});
}

void ProjectReader::resolve_links() {
  std::uint64_t left_out = 0;
  for (const LinkRecord& record : links_) {
    Task& task = plan_.tasks[record.task];
    const auto found = by_uid_.find(record.uid);
    if (found == by_uid_.end()) {
      if (inactive_ == 0) reject(task.where, "no task has its PredecessorUID " + std::to_string(record.uid));
      ++left_out;  // of an inactive task, perhaps: MS Project lets such links be
      continue;
    }
    if (found->second == record.task) reject(task.where, "is its own predecessor");
    if (record.percent && !task.start_s)
      reject(task.where, "a lag in percent, and no Start; save the project with its dates");
    task.predecessors.push_back(record.link);
    task.predecessors.back().task = found->second;
  }
  if (inactive_ > 0) {
    plan_.notes.push_back(name_ + ": " + std::to_string(inactive_) + " inactive tasks left out, with " +
                          std::to_string(left_out) + " links to them");
  }
}

/// A task may say nothing but its UID: it is then a moment at the project's start.
void ProjectReader::add_defaults(const pugi::xml_node& project) {
  const std::optional<CivilSeconds> start = date(project, "StartDate", place(project) + ": Project");
  std::vector<bool> above(plan_.tasks.size());
  for (const Task& task : plan_.tasks) {
    if (task.parent != Task::kNone) above[task.parent] = true;
  }
  for (std::size_t i = 0; i < plan_.tasks.size(); ++i) {
    Task& task = plan_.tasks[i];
    if (above[i]) continue;
    if (!task.finish_s && !task.duration_s) task.duration_s = 0;
    if (task.start_s || (task.finish_s && task.duration_s) || !task.predecessors.empty()) continue;
    bool inherits = false;  // compute_dates() looks as far up, and refuses what is deeper
    std::uint32_t up = task.parent;
    for (int level = 0; level < 512 && up != Task::kNone && !inherits; ++level, up = plan_.tasks[up].parent)
      inherits = plan_.tasks[up].start_s || !plan_.tasks[up].predecessors.empty();
    if (inherits) continue;
    if (!start) reject(task.where, "has neither a Start nor a PredecessorLink, and the Project no StartDate");
    task.start_s = start;
  }
}

Plan ProjectReader::read() {
  find_lines();
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(bytes_.data(), bytes_.size());
  if (!parsed) {
    std::string where = name_;
    if (has_lines_ && parsed.offset >= 0) {
      const auto line =
          std::lower_bound(line_ends_.begin(), line_ends_.end(), static_cast<std::size_t>(parsed.offset)) -
          line_ends_.begin();
      where += ": line " + std::to_string(line + 1);
    }
    reject(where, std::string("is not well-formed XML: ") + parsed.description());
  }
  const pugi::xml_node project = document.document_element();
  if (local_name(project) != "Project") {
    reject(place(project), "the root element is " + in_quotes(local_name(project)) +
                               "; wanted the 'Project' of MS Project XML");
  }
  namespace_ = namespaces_.of(project);
  minutes_per_day_ = static_cast<double>(whole(project, "MinutesPerDay", 480, place(project) + ": Project"));
  if (minutes_per_day_ < 1 || minutes_per_day_ > 1440)
    reject(place(project) + ": Project", "MinutesPerDay goes from 1 to 1440");
  read_fields(project);
  for (const pugi::xml_node& node : child(project, "Tasks")) {
    if (is(node, "Task")) read_task(node);
  }
  if (plan_.tasks.empty()) reject(name_, "has no Task in its Tasks");
  resolve_links();
  add_defaults(project);
  return std::move(plan_);
}

}  // namespace

Result<Plan> parse_plan_msproject(std::string_view bytes, const std::string& name,
                                  const PlanOptions& options) {
  try {
    return ProjectReader(bytes, name, options).read();
  } catch (Fault& fault) {
    return tl::unexpected<Error>(std::move(fault.error));
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::bad_input, name, "not enough memory for what the file holds");
  }
}

}  // namespace scenegen::timeline
