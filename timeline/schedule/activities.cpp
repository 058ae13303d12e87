// Tasks and their objects -> activities in seconds, and the calendar that turns seconds into dates.
#include <algorithm>
#include <numeric>

#include "timeline/cell_grid.h"
#include "timeline/schedule/mapping.h"
#include "timeline/schedule/plan_values.h"

namespace scenegen::timeline {

namespace {

bool staggers(Profile profile) {
  return profile != Profile::temporary && profile != Profile::move && profile != Profile::operate;
}

/// Place along the curve of every object's cell, over the box of all objects.
std::vector<std::uint32_t> curve_places(const Scene& scene, const ActivityOptions& options) {
  const std::vector<Box> boxes = placed_bounds(scene, options.threads);
  Box all;
  for (const Box& box : boxes) all.add(box);
  if (all.empty()) return std::vector<std::uint32_t>(boxes.size());
  const CellGrid grid(options.cells, z_up_from_y_up(all));
  const std::vector<std::uint32_t> ranks = cell_ranks(options.curve, options.cells, options.order);
  std::vector<std::uint32_t> out(boxes.size());
  std::transform(boxes.begin(), boxes.end(), out.begin(),
                 [&](const Box& box) { return ranks[grid.cell(box)]; });
  return out;
}

class ActivityMaker {
 public:
  ActivityMaker(const Plan& plan, const ActivityOptions& options, std::vector<std::uint32_t> places)
      : options_(options), places_(std::move(places)) {
    CivilSeconds first = *plan.tasks.front().start_s;
    for (const Task& task : plan.tasks) first = std::min(first, *task.start_s);
    zero_ = first >= 0 ? first / kDay * kDay : -((kDay - 1 - first) / kDay) * kDay;
  }
  [[nodiscard]] double seconds(CivilSeconds at) const {
    return static_cast<double>(at - zero_) / static_cast<double>(kDay) * options_.seconds_per_day;
  }
  [[nodiscard]] CivilSeconds zero() const { return zero_; }

  void add(const Task& task, std::vector<ObjectId> objects, std::vector<Activity>& out) const {
    const double start_s = seconds(*task.start_s), finish_s = seconds(*task.finish_s);
    const bool staggered = options_.stagger && staggers(task.profile) && objects.size() > 1;
    if (staggered) sort_along_curve(task.profile, objects);
    const std::size_t count = objects.size();
    const std::size_t steps = staggered ? std::min<std::size_t>(count, options_.steps) : 1;
    const double span_s = finish_s - start_s;
    const bool instant = task.profile == Profile::appear || task.profile == Profile::neutral;
    const double share = instant ? 0.0 : options_.share;
    const double work_s = std::max(span_s / static_cast<double>(steps), share * span_s);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t step = i * steps / count;
      Activity activity{objects[i], task.profile, start_s, finish_s, {}};
      if (steps > 1) {
        activity.start_s =
            start_s + (span_s - work_s) * static_cast<double>(step) / static_cast<double>(steps - 1);
        activity.finish_s = step + 1 == steps ? finish_s : std::min(finish_s, activity.start_s + work_s);
      }
      if (task.profile == Profile::move) {
        const bool own = task.offset_z_up_m != glm::vec3(0.0F);
        activity.offset_m = own ? y_up_from_z_up(task.offset_z_up_m) : options_.move_offset_m;
      }
      out.push_back(activity);
    }
  }

 private:
  void sort_along_curve(Profile profile, std::vector<ObjectId>& objects) const {
    std::stable_sort(objects.begin(), objects.end(),
                     [&](ObjectId a, ObjectId b) { return places_[a.value] < places_[b.value]; });
    if (profile == Profile::demolish) std::reverse(objects.begin(), objects.end());
  }

  const ActivityOptions& options_;
  std::vector<std::uint32_t> places_;
  CivilSeconds zero_ = 0;
};

}  // namespace

Schedule make_activities(const Plan& plan, const Mapping& mapping, const Scene& scene,
                         const ActivityOptions& options) {
  Schedule out;
  std::vector<std::uint32_t> places;
  if (options.stagger) places = curve_places(scene, options);
  const ActivityMaker maker(plan, options, std::move(places));
  out.calendar.start = moment_text(maker.zero());
  out.calendar.seconds_per_day = options.seconds_per_day;
  for (std::size_t i = 0; i < plan.tasks.size(); ++i) {
    const Task& task = plan.tasks[i];
    maker.add(task, mapping.objects_of_task[i], out.activities);
    const double start_s = maker.seconds(*task.start_s), finish_s = maker.seconds(*task.finish_s);
    out.end_s = std::max(out.end_s, finish_s);
    if (task.summary && !options.summary_tasks) continue;
    out.calendar.tasks.push_back({task.id, task.name, std::string(name(task.profile)), start_s, finish_s});
  }
  return out;
}

}  // namespace scenegen::timeline
