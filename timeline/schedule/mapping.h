// Which objects a task is about, and what becomes of them when.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/selector.h"
#include "timeline/curves.h"
#include "timeline/schedule/plan.h"

namespace scenegen::timeline {

/// How a task found an object; the smaller one wins where tasks that let things appear (or that demolish
/// them) claim the same object.
enum class MatchRule : std::uint8_t { saved, guid, name, pattern, extras, material, subtree };
[[nodiscard]] std::string_view name(MatchRule rule);

/// The objects of tasks as they were in another model: from write_mapping(), or by hand.
struct SavedMapping {
  struct Object {
    std::string name, guid;  ///< one of them may be empty
    bool search = false;     ///< written by hand as one text: `name` may also be an identifier or a selector
  };
  struct Entry {
    std::string task_id;
    std::vector<Object> objects;
  };
  std::string path;
  std::vector<Entry> tasks;
};
[[nodiscard]] Result<SavedMapping> read_mapping(const std::string& path);
[[nodiscard]] Result<SavedMapping> parse_mapping(std::string_view json, const std::string& name);

struct MappingOptions {
  bool summary_tasks = false;           ///< summary tasks may have objects
  std::string task_key = "task";        ///< extras.<key> of an object that names its task's id or name
  const SavedMapping* saved = nullptr;  ///< decides about the tasks that it names
};

struct Mapping {
  struct Shared {
    ObjectId object;
    std::vector<std::uint32_t> tasks;   ///< that it takes part in, by start
    std::vector<std::uint32_t> losers;  ///< that claimed it by a weaker rule
    bool equals = false;                ///< several of `tasks` in a row let it appear, or take it away
  };
  std::vector<std::vector<ObjectId>> objects_of_task;  ///< by task; ascending
  std::vector<std::optional<MatchRule>> rule_of_task;  ///< the strongest that found something
  std::vector<std::uint32_t> tasks_without_objects;    ///< that should have some
  std::vector<ObjectId> objects_without_tasks;
  std::vector<Shared> claimed_twice;
  std::vector<std::string> notes;  ///< entries that match nothing, one line each
};

/// A task's `objects` and `selectors` say what it is about: each entry is an identifier, else an exact name,
/// else a selector. A task without them is about the object whose identifier is its id or name, else the one
/// of its name, else (with wildcards in its name) those that match, else those whose extras.<task_key> is its
/// id or name, else what is below the node of its name. Errors (bad_input): a selector that does not parse,
/// with its task. Calls facts.index().
[[nodiscard]] Result<Mapping> map_tasks(const Plan& plan, const Scene& scene, ObjectFacts& facts,
                                        const MappingOptions& options = {});

/// What read_mapping() reads: task ids, and names and identifiers of their objects.
[[nodiscard]] std::string write_mapping(const Plan& plan, const Mapping& mapping, const Scene& scene,
                                        const ObjectFacts& facts);

struct ActivityOptions {
  double seconds_per_day = 1;
  bool stagger = true;  ///< objects of one task follow each other along the curve
  CurveKind curve = CurveKind::hilbert;
  AxisOrder order;
  glm::uvec3 cells{64, 64, 64};
  double share = 0.25;            ///< of a task's span that one object takes, at least span / objects
  std::uint32_t steps = 100;      ///< most different times within a task: objects of one step share them
  glm::vec3 move_offset_m{0.0F};  ///< of moves without an offset of their own; Y up
  bool summary_tasks = false;     ///< in the calendar too
  unsigned threads = 1;
};

struct Schedule {
  std::vector<Activity> activities;
  Calendar calendar;
  double end_s = 0;  ///< of the last task
};
/// Second 0 is the midnight before the first task starts. Objects of a task that lets appear, drops or
/// demolishes follow each other along the curve (to demolish: from its end), those of others share its span.
[[nodiscard]] Schedule make_activities(const Plan& plan, const Mapping& mapping, const Scene& scene,
                                       const ActivityOptions& options);

}  // namespace scenegen::timeline
