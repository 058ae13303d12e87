// Start and finish of every task: given, or the earliest that predecessors allow; summaries span what is
// below.
#include <algorithm>
#include <chrono>
#include <limits>

#include "timeline/schedule/plan_build.h"
#include "timeline/schedule/plan_values.h"

namespace scenegen::timeline {

namespace {

constexpr CivilSeconds kLeast = -62135596800;  // 0001-01-01
constexpr CivilSeconds kMost = 253402300800;   // 10000-01-01
constexpr std::uint32_t kMostNesting = 512;    // what is inherited is looked for task by task upwards

tl::unexpected<Error> bad(const Task& task, std::string what) {
  return fail(ErrorKind::bad_input, task.where, std::move(what));
}

std::string named(const Task& task) {
  return task.name == task.id || task.name.empty() ? in_quotes(task.id)
                                                   : in_quotes(task.id) + " (" + in_quotes(task.name) + ")";
}

class Dates {
 public:
  explicit Dates(Plan& plan)
      : tasks_(plan.tasks),
        count_(static_cast<std::uint32_t>(plan.tasks.size())),
        state_(2 * tasks_.size()) {}

  Result<void> run() {
    if (auto tree = make_tree(); !tree) return tree;
    for (std::uint32_t i = 0; i < count_; ++i) {
      if (auto done = visit(i); !done) return done;
    }
    return {};
  }

 private:
  // A step is a task, or (from count_ on) the earliest start that the predecessors of a summary leave to the
  // tasks below it: they inherit it, and many of them share it.
  struct Frame {
    std::uint32_t step;
    std::vector<std::uint32_t> needs;
    std::size_t next = 0;
  };
  static constexpr std::uint8_t kUntouched = 0, kOpen = 1, kDone = 2;

  [[nodiscard]] const Task& task_of(std::uint32_t step) const {
    return tasks_[step < count_ ? step : step - count_];
  }
  [[nodiscard]] bool has_children(std::uint32_t task) const { return first_child_[task] != Task::kNone; }
  Result<void> make_tree();
  [[nodiscard]] std::uint32_t inherited(std::uint32_t task) const;
  [[nodiscard]] std::vector<std::uint32_t> needs(std::uint32_t step) const;
  Result<void> visit(std::uint32_t root);
  Result<void> settle(std::uint32_t step);
  Result<void> settle_task(std::uint32_t index);
  Result<CivilSeconds> start_from_links(std::uint32_t index) const;
  Result<void> settle_bound(std::uint32_t index);
  Result<void> settle_summary(std::uint32_t index);
  Result<void> check(const Task& task) const;
  [[nodiscard]] tl::unexpected<Error> cycle(const std::vector<Frame>& stack, std::uint32_t step) const;

  std::vector<Task>& tasks_;
  std::uint32_t count_;
  std::vector<std::uint8_t> state_;
  std::vector<std::uint32_t> first_child_, next_sibling_;
  std::vector<CivilSeconds> bound_s_;
};

Result<void> Dates::make_tree() {
  first_child_.assign(count_, Task::kNone);
  next_sibling_.assign(count_, Task::kNone);
  bound_s_.assign(count_, 0);
  constexpr std::uint32_t kUnknown = 0, kOnTheWay = Task::kNone;
  std::vector<std::uint32_t> depth(count_, kUnknown), way;
  for (std::uint32_t i = count_; i-- > 0;) {
    if (tasks_[i].parent != Task::kNone) {
      next_sibling_[i] = first_child_[tasks_[i].parent];
      first_child_[tasks_[i].parent] = i;
    }
    std::uint32_t up = i;
    for (; up != Task::kNone && depth[up] == kUnknown; up = tasks_[up].parent) {
      depth[up] = kOnTheWay;
      way.push_back(up);
    }
    if (up != Task::kNone && depth[up] == kOnTheWay)
      return bad(tasks_[up], "task " + named(tasks_[up]) + " is below itself");
    for (std::uint32_t above = up == Task::kNone ? 0 : depth[up]; !way.empty(); way.pop_back()) {
      depth[way.back()] = ++above;
      if (above > kMostNesting) {
        return bad(tasks_[way.back()], "tasks are nested deeper than " + std::to_string(kMostNesting));
      }
    }
  }
  return {};
}

/// The summary whose start or predecessors decide when a task may start that says nothing itself.
std::uint32_t Dates::inherited(std::uint32_t task) const {
  for (std::uint32_t up = tasks_[task].parent; up != Task::kNone; up = tasks_[up].parent) {
    if (tasks_[up].start_s || !tasks_[up].predecessors.empty()) return up;
  }
  return Task::kNone;
}

std::vector<std::uint32_t> Dates::needs(std::uint32_t step) const {
  std::vector<std::uint32_t> out;
  const std::uint32_t index = step < count_ ? step : step - count_;
  const Task& task = tasks_[index];
  for (const Link& link : task.predecessors) out.push_back(link.task);
  if (step >= count_) return out;
  if (has_children(index)) {
    if (task.start_s && task.finish_s) return out;
    for (std::uint32_t child = first_child_[index]; child != Task::kNone; child = next_sibling_[child])
      out.push_back(child);
  } else if (!task.start_s && !(task.finish_s && task.duration_s) && task.predecessors.empty()) {
    const std::uint32_t from = inherited(index);
    if (from != Task::kNone && !tasks_[from].start_s) out.push_back(count_ + from);
  }
  return out;
}

tl::unexpected<Error> Dates::cycle(const std::vector<Frame>& stack, std::uint32_t step) const {
  constexpr std::size_t kMostNames = 8;
  std::size_t begin = stack.size();
  while (stack[begin - 1].step != step) --begin;
  --begin;
  std::string what = "tasks wait for each other: ";
  for (std::size_t i = begin; i < stack.size(); ++i) {
    if (i - begin == kMostNames) {
      what += "... (" + std::to_string(stack.size() - begin) + " tasks) -> ";
      break;
    }
    what += named(task_of(stack[i].step)) + " -> ";
  }
  return bad(task_of(step), what + named(task_of(step)));
}

Result<void> Dates::visit(std::uint32_t root) {
  if (state_[root] == kDone) return {};
  std::vector<Frame> stack;
  const auto open = [&](std::uint32_t step) {
    state_[step] = kOpen;
    stack.push_back({step, needs(step)});
  };
  open(root);
  while (!stack.empty()) {
    Frame& top = stack.back();
    if (top.next < top.needs.size()) {
      const std::uint32_t need = top.needs[top.next++];
      if (state_[need] == kOpen) return cycle(stack, need);
      if (state_[need] == kUntouched) open(need);
      continue;
    }
    if (auto settled = settle(top.step); !settled) return settled;
    state_[top.step] = kDone;
    stack.pop_back();
  }
  return {};
}

Result<void> Dates::settle(std::uint32_t step) {
  if (step >= count_) return settle_bound(step - count_);
  if (auto settled = has_children(step) ? settle_summary(step) : settle_task(step); !settled) return settled;
  return check(tasks_[step]);
}

Result<void> Dates::settle_bound(std::uint32_t index) {
  const Task& task = tasks_[index];
  CivilSeconds bound = kLeast;
  for (const Link& link : task.predecessors) {
    if (link.kind != LinkKind::finish_start && link.kind != LinkKind::start_start) {
      return bad(task,
                 "FF and SF to a summary task do not say when the tasks below it start; give their dates");
    }
    const Task& other = tasks_[link.task];
    bound = std::max(bound,
                     (link.kind == LinkKind::finish_start ? *other.finish_s : *other.start_s) + link.lag_s);
  }
  bound_s_[index] = bound;
  return {};
}

Result<void> Dates::settle_summary(std::uint32_t index) {
  Task& task = tasks_[index];
  task.summary = true;
  if (task.start_s && task.finish_s) return {};
  CivilSeconds first = std::numeric_limits<CivilSeconds>::max();
  CivilSeconds last = std::numeric_limits<CivilSeconds>::min();
  for (std::uint32_t child = first_child_[index]; child != Task::kNone; child = next_sibling_[child]) {
    first = std::min(first, *tasks_[child].start_s);
    last = std::max(last, *tasks_[child].finish_s);
  }
  if (!task.start_s) task.start_s = first;
  if (!task.finish_s) task.finish_s = std::max(last, *task.start_s);
  return {};
}

Result<CivilSeconds> Dates::start_from_links(std::uint32_t index) const {
  const Task& task = tasks_[index];
  CivilSeconds start = std::numeric_limits<CivilSeconds>::min();
  for (const Link& link : task.predecessors) {
    const Task& other = tasks_[link.task];
    const bool from_finish = link.kind == LinkKind::finish_start || link.kind == LinkKind::finish_finish;
    CivilSeconds at = (from_finish ? *other.finish_s : *other.start_s) + link.lag_s;
    if (link.kind == LinkKind::finish_finish || link.kind == LinkKind::start_finish) {
      if (!task.duration_s) continue;  // it says when the task finishes, and that is given
      at -= *task.duration_s;
    }
    start = std::max(start, at);
  }
  if (start == std::numeric_limits<CivilSeconds>::min())
    return bad(task, "task " + named(task) + " has neither a start nor a duration");
  return start;
}

Result<void> Dates::settle_task(std::uint32_t index) {
  Task& task = tasks_[index];
  if (!task.finish_s && !task.duration_s)
    return bad(task, "task " + named(task) + " has neither a finish nor a duration");
  if (!task.start_s && task.finish_s && task.duration_s) {
    task.start_s = *task.finish_s - *task.duration_s;
  } else if (!task.start_s && !task.predecessors.empty()) {
    auto start = start_from_links(index);
    if (!start) return forward_error(start);
    task.start_s = *start;
  } else if (!task.start_s) {
    const std::uint32_t from = inherited(index);
    if (from == Task::kNone)
      return bad(task, "task " + named(task) + " has neither a start nor predecessors");
    task.start_s = tasks_[from].start_s ? *tasks_[from].start_s : bound_s_[from];
  }
  if (!task.finish_s) task.finish_s = *task.start_s + *task.duration_s;
  return {};
}

Result<void> Dates::check(const Task& task) const {
  if (*task.start_s < kLeast || *task.start_s > kMost || *task.finish_s < kLeast || *task.finish_s > kMost)
    return bad(task, "task " + named(task) + " is not within the years 1 to 9999");
  if (*task.finish_s < *task.start_s) {
    return bad(task, "task " + named(task) + " finishes (" + moment_text(*task.finish_s) +
                         ") before it starts (" + moment_text(*task.start_s) + ")");
  }
  return {};
}

}  // namespace

Result<void> compute_dates(Plan& plan) {
  return Dates(plan).run();
}

}  // namespace scenegen::timeline
