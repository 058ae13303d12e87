// libFuzzer target: any bytes give an error of one line, or a plan that keeps what plan.h promises.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <set>

#include "timeline/schedule/plan.h"

namespace {

using scenegen::timeline::Task;

[[noreturn]] void broken(const char* what, const Task& task) {
  std::fprintf(stderr, "%s: task %s, %s\n", what, task.id.c_str(), task.where.c_str());
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace timeline = scenegen::timeline;
  timeline::PlanOptions options;
  options.date_order = static_cast<timeline::DateOrder>(size % 3);
  const auto plan = timeline::parse_plan({reinterpret_cast<const char*>(data), size}, "fuzz", options);
  if (!plan) {
    if (!plan.error().what.empty() && plan.error().str().find('\n') == std::string::npos) return 0;
    std::fprintf(stderr, "error that is not one line: %s\n", plan.error().str().c_str());
    std::abort();
  }
  std::set<std::string> ids;
  for (const Task& task : plan->tasks) {
    if (!ids.insert(task.id).second) broken("an id twice", task);
    if (!task.start_s || !task.finish_s || *task.start_s > *task.finish_s) broken("dates", task);
    if (timeline::moment_text(*task.start_s).size() < 10) broken("a year that is none", task);
    if (task.parent != Task::kNone && task.parent >= plan->tasks.size()) broken("its parent", task);
    for (const timeline::Link& link : task.predecessors) {
      if (link.task >= plan->tasks.size()) broken("a predecessor", task);
    }
  }
  return 0;
}
