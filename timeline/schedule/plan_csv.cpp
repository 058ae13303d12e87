// CSV -> Plan.
#include <algorithm>

#include "scene/limits.h"
#include "timeline/schedule/csv_rows.h"
#include "timeline/schedule/plan_build.h"
#include "timeline/schedule/plan_values.h"

namespace scenegen::timeline {

namespace {

constexpr std::size_t kMostColumns = 1000;
constexpr std::string_view kColumnList =
    "id, name, start, finish, duration, type, parent, predecessors, objects, selector, offset";

class CsvPlan {
 public:
  CsvPlan(const std::string& name, const PlanOptions& options) : name_(name), options_(options) {
    columns_.fill(kAbsent);
  }
  Result<void> take(CsvRow& row) { return titles_.empty() ? take_header(row) : take_task(row); }
  Result<Plan> finish();

 private:
  static constexpr std::size_t kAbsent = static_cast<std::size_t>(-1);
  [[nodiscard]] std::size_t column(Column c) const { return columns_[static_cast<std::size_t>(c)]; }
  [[nodiscard]] std::string_view cell(const CsvRow& row, Column c) const {
    return column(c) == kAbsent ? std::string_view() : trimmed(row.cells[column(c)]);
  }
  [[nodiscard]] std::string at(std::uint64_t line, Column c) const {
    return at_line(name_, line) + ", column " + in_quotes(titles_[column(c)]);
  }
  Result<void> take_header(CsvRow& row);
  Result<void> take_task(CsvRow& row);
  Result<void> resolve(std::uint32_t task);

  const std::string& name_;
  const PlanOptions& options_;
  std::vector<std::string> titles_;
  std::array<std::size_t, kColumnCount> columns_{};
  Plan plan_;
  std::unordered_map<std::string, std::uint32_t> ids_;
  std::vector<std::uint64_t> lines_;                 ///< by task
  std::vector<std::string> parents_, predecessors_;  ///< by task, as written
};

Result<void> CsvPlan::take_header(CsvRow& row) {
  if (row.cells.size() > kMostColumns)
    return fail(ErrorKind::bad_input, at_line(name_, row.line),
                "more than " + std::to_string(kMostColumns) + " columns");
  titles_ = std::move(row.cells);
  std::string ignored;
  for (std::size_t i = 0; i < titles_.size(); ++i) {
    const Column c = column_of(titles_[i]);
    if (c == Column::none) {
      if (!trimmed(titles_[i]).empty())
        ignored.append(ignored.empty() ? "" : ", ").append(in_quotes(titles_[i]));
      continue;
    }
    std::size_t& place = columns_[static_cast<std::size_t>(c)];
    if (place != kAbsent) {
      return fail(
          ErrorKind::bad_input, at_line(name_, row.line),
          "columns " + in_quotes(titles_[place]) + " and " + in_quotes(titles_[i]) + " mean the same");
    }
    place = i;
  }
  if (column(Column::id) == kAbsent && column(Column::name) == kAbsent) {
    return fail(ErrorKind::bad_input, at_line(name_, row.line),
                "no column 'id' or 'name' (columns: " + std::string(kColumnList) + ")");
  }
  if (column(Column::start) == kAbsent && column(Column::finish) == kAbsent)
    return fail(ErrorKind::bad_input, at_line(name_, row.line), "no column 'start' or 'finish'");
  if (!ignored.empty()) plan_.notes.push_back(name_ + ": columns without a meaning here: " + ignored);
  return {};
}

Result<void> CsvPlan::take_task(CsvRow& row) {
  while (row.cells.size() > titles_.size() && trimmed(row.cells.back()).empty()) row.cells.pop_back();
  if (std::all_of(row.cells.begin(), row.cells.end(), [](const auto& c) { return trimmed(c).empty(); }))
    return {};
  if (row.cells.size() != titles_.size()) {
    return fail(ErrorKind::bad_input, at_line(name_, row.line),
                std::to_string(row.cells.size()) + (row.cells.size() == 1 ? " cell; " : " cells; ") +
                    "the first line has " + std::to_string(titles_.size()));
  }
  if (plan_.tasks.size() == limits::kMaxTasks) {
    return fail(ErrorKind::bad_input, at_line(name_, row.line),
                "more than " + std::to_string(limits::kMaxTasks) + " tasks");
  }
  const auto index = static_cast<std::uint32_t>(plan_.tasks.size());
  Task& task = plan_.tasks.emplace_back();
  task.where = at_line(name_, row.line);
  task.profile = options_.default_profile;
  for (std::size_t c = 0; c < kColumnCount; ++c) {
    if (columns_[c] == kAbsent) continue;
    const auto which = static_cast<Column>(c);
    if (auto taken = take_cell(task, which, row.cells[columns_[c]], options_); !taken)
      return fail(taken.error().kind, at(row.line, which), std::move(taken.error().what));
  }
  task.id = cell(row, Column::id);
  if (task.id.empty()) {
    if (column(Column::id) != kAbsent)
      return fail(ErrorKind::bad_input, at(row.line, Column::id), "is empty");
    task.id = std::to_string(index + 1);  // without the column, tasks are numbered as MS Project does
  }
  if (task.name.empty()) task.name = task.id;
  const auto [other, fresh] = ids_.emplace(task.id, index);
  if (!fresh) {
    return fail(
        ErrorKind::bad_input, at(row.line, Column::id),
        in_quotes(task.id) + " is taken by the task on line " + std::to_string(lines_[other->second]));
  }
  lines_.push_back(row.line);
  parents_.emplace_back(cell(row, Column::parent));
  predecessors_.emplace_back(cell(row, Column::predecessors));
  return {};
}

Result<void> CsvPlan::resolve(std::uint32_t index) {
  Task& task = plan_.tasks[index];
  if (!parents_[index].empty()) {
    const auto found = ids_.find(parents_[index]);
    if (found == ids_.end()) {
      return fail(ErrorKind::bad_input, at(lines_[index], Column::parent),
                  "no task has the id " + in_quotes(parents_[index]));
    }
    task.parent = found->second;
    plan_.tasks[found->second].summary = true;
  }
  if (auto taken = take_predecessors(task, index, predecessors_[index], ids_); !taken) {
    return fail(taken.error().kind, at(lines_[index], Column::predecessors), std::move(taken.error().what));
  }
  return {};
}

Result<Plan> CsvPlan::finish() {
  if (titles_.empty()) {
    return fail(ErrorKind::bad_input, name_,
                "is empty; wanted CSV with a first line of columns (" + std::string(kColumnList) +
                    "), or MS Project XML");
  }
  if (plan_.tasks.empty()) return fail(ErrorKind::bad_input, name_, "has no tasks below its first line");
  for (std::uint32_t i = 0; i < plan_.tasks.size(); ++i) {
    if (auto resolved = resolve(i); !resolved) return forward_error(resolved);
  }
  return std::move(plan_);
}

}  // namespace

Result<Plan> parse_plan_csv(std::string_view bytes, const std::string& name, const PlanOptions& options) {
  CsvPlan plan(name, options);
  if (auto read = read_csv(bytes, name, [&](CsvRow& row) { return plan.take(row); }); !read)
    return forward_error(read);
  return plan.finish();
}

}  // namespace scenegen::timeline
