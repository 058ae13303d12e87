#include "timeline/schedule/mapping.h"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "scene/limits.h"
#include "timeline/schedule/plan_values.h"

namespace scenegen::timeline {

namespace {

struct Claim {
  std::uint32_t task;
  ObjectId object;
  MatchRule rule;
};

MatchRule rule_of(const Selector& selector) {
  switch (selector.kind()) {
    case Selector::Kind::guid:
      return MatchRule::guid;
    case Selector::Kind::name:
      return selector.is_literal() ? MatchRule::name : MatchRule::pattern;
    case Selector::Kind::extras:
      return MatchRule::extras;
    case Selector::Kind::material:
      return MatchRule::material;
    case Selector::Kind::subtree:
      return MatchRule::subtree;
  }
  return MatchRule::subtree;
}

class Mapper {
 public:
  Mapper(const Plan& plan, const Scene& scene, ObjectFacts& facts, const MappingOptions& options)
      : plan_(plan), scene_(scene), facts_(facts), options_(options) {}
  Result<Mapping> run();

 private:
  /// Adds what `selector` finds; whether that was anything.
  bool take(std::uint32_t task, const Selector& selector) { return take(task, selector, rule_of(selector)); }
  bool take(std::uint32_t task, const Selector& selector, MatchRule rule) {
    if (claims_.size() > limits::kMaxClaims) return true;  // an error anyway, when the task is done
    const std::vector<ObjectId> found = selector.select(facts_);
    for (const ObjectId object : found) claims_.push_back({task, object, rule});
    return !found.empty();
  }
  Result<void> take_entry(std::uint32_t task, const std::string& text, bool only_selector);
  void take_implied(std::uint32_t task);
  Result<void> take_task(std::uint32_t task);
  Result<void> take_saved(std::uint32_t task, const SavedMapping::Entry& entry);
  void note(const std::string& where, const std::string& what) { out_.notes.push_back(where + ": " + what); }
  [[nodiscard]] std::unordered_map<std::uint32_t, MatchRule> surest_below_summaries(
      std::span<const Claim> claims) const;
  void settle_object(std::span<Claim> claims);
  void settle();

  const Plan& plan_;
  const Scene& scene_;
  ObjectFacts& facts_;
  const MappingOptions& options_;
  std::vector<Claim> claims_;
  Mapping out_;
};

Result<void> Mapper::take_entry(std::uint32_t index, const std::string& text, bool only_selector) {
  const Task& task = plan_.tasks[index];
  if (!only_selector) {
    if (take(index, Selector::with_guid(text))) return {};
    if (take(index, Selector::with_name(text))) return {};
  }
  auto selector = Selector::parse(text);
  if (!selector) return fail(ErrorKind::bad_input, task.where, selector.error().what);
  if (!take(index, *selector)) note(task.where, in_quotes(text) + " matches no object");
  return {};
}

void Mapper::take_implied(std::uint32_t index) {
  const Task& task = plan_.tasks[index];
  if (take(index, Selector::with_guid(task.id)) || take(index, Selector::with_guid(task.name))) return;
  if (take(index, Selector::with_name(task.name))) return;
  if (task.name.find_first_of("*?[") != std::string::npos) {
    const auto glob = Selector::parse("name=" + task.name);
    if (glob && take(index, *glob)) return;
  }
  if (take(index, Selector::with_extra(options_.task_key, task.id))) return;
  if (take(index, Selector::with_extra(options_.task_key, task.name))) return;
  (void)take(index, Selector::with_subtree(task.name));
}

Result<void> Mapper::take_task(std::uint32_t index) {
  const Task& task = plan_.tasks[index];
  if (task.summary && !options_.summary_tasks) {
    if (!task.objects.empty() || !task.selectors.empty())
      note(task.where, "is a summary task: its objects are left out (--summary-tasks takes them)");
    return {};
  }
  if (task.objects.empty() && task.selectors.empty()) {
    take_implied(index);
    return {};
  }
  for (const std::string& entry : task.objects) {
    if (auto taken = take_entry(index, entry, false); !taken) return taken;
  }
  for (const std::string& entry : task.selectors) {
    if (auto taken = take_entry(index, entry, true); !taken) return taken;
  }
  return {};
}

Result<void> Mapper::take_saved(std::uint32_t index, const SavedMapping::Entry& entry) {
  const std::string where = options_.saved->path + ": task " + in_quotes(entry.task_id);
  for (const SavedMapping::Object& object : entry.objects) {
    if (!object.guid.empty() && take(index, Selector::with_guid(object.guid), MatchRule::saved)) continue;
    if (!object.name.empty() && take(index, Selector::with_name(object.name), MatchRule::saved)) continue;
    if (object.search) {
      if (take(index, Selector::with_guid(object.name), MatchRule::saved)) continue;
      auto selector = Selector::parse(object.name);
      if (!selector) return fail(ErrorKind::bad_input, where, selector.error().what);
      if (take(index, *selector, MatchRule::saved)) continue;
    }
    note(where,
         in_quotes(object.name.empty() ? object.guid : object.name) + " is no object of this model any more");
  }
  return {};
}

/// By summary task: the surest rule of the claims of tasks below it. Empty where no summary claims the
/// object.
std::unordered_map<std::uint32_t, MatchRule> Mapper::surest_below_summaries(
    std::span<const Claim> claims) const {
  std::unordered_map<std::uint32_t, MatchRule> out;
  const bool any = std::any_of(claims.begin(), claims.end(),
                               [&](const Claim& claim) { return plan_.tasks[claim.task].summary; });
  if (!any) return out;
  for (const Claim& claim : claims) {
    for (std::uint32_t up = plan_.tasks[claim.task].parent; up != Task::kNone; up = plan_.tasks[up].parent) {
      const auto entry = out.emplace(up, claim.rule).first;
      entry->second = std::min(entry->second, claim.rule);
    }
  }
  return out;
}

enum class Group : std::uint8_t { appears, goes, other };
Group group_of(Profile profile) {
  switch (profile) {
    case Profile::appear:
    case Profile::construct:
    case Profile::drop:
    case Profile::neutral:
      return Group::appears;
    case Profile::demolish:
      return Group::goes;
    default:
      return Group::other;
  }
}

/// Claims of one object by several tasks. Among those in a row that do the same to it (let it appear, take it
/// away) only the strongest rule counts, and a task rather than the summary above it; of equals, all do.
void Mapper::settle_object(std::span<Claim> claims) {
  std::sort(claims.begin(), claims.end(), [&](const Claim& a, const Claim& b) {
    const CivilSeconds sa = *plan_.tasks[a.task].start_s, sb = *plan_.tasks[b.task].start_s;
    return sa != sb ? sa < sb : a.task < b.task;
  });
  Mapping::Shared shared{claims.front().object, {}, {}, false};
  const std::unordered_map<std::uint32_t, MatchRule> surest_below = surest_below_summaries(claims);
  std::array<MatchRule, 2> strongest{};  // by Group, of the run that begins here
  bool settled = false;                  // a task of this run lets it appear, or takes it away
  std::size_t run_end = 0;
  for (std::size_t i = 0; i < claims.size(); ++i) {
    if (i == run_end) {
      strongest.fill(MatchRule::subtree);
      settled = false;
      Group kind = Group::other;  // a run goes on over activities that leave the object where it is
      for (; run_end < claims.size(); ++run_end) {
        const Group g = group_of(plan_.tasks[claims[run_end].task].profile);
        if (g == Group::other) continue;
        if (kind != Group::other && g != kind) break;
        kind = g;
        auto& least = strongest[static_cast<std::size_t>(g)];
        least = std::min(least, claims[run_end].rule);
      }
    }
    const Claim& claim = claims[i];
    const Group g = group_of(plan_.tasks[claim.task].profile);
    const bool weaker = g != Group::other && claim.rule > strongest[static_cast<std::size_t>(g)];
    const auto below = surest_below.find(claim.task);
    const bool summary = below != surest_below.end() && below->second <= claim.rule;
    (weaker || summary ? shared.losers : shared.tasks).push_back(claim.task);
    if (!weaker && !summary && g != Group::other) {
      shared.equals = shared.equals || settled;
      settled = true;
    }
    if (!weaker && !summary) out_.objects_of_task[claim.task].push_back(claim.object);
  }
  if (claims.size() > 1) out_.claimed_twice.push_back(std::move(shared));
}

void Mapper::settle() {
  std::sort(claims_.begin(), claims_.end(), [](const Claim& a, const Claim& b) {
    return std::tuple(a.object, a.task, a.rule) < std::tuple(b.object, b.task, b.rule);
  });
  claims_.erase(
      std::unique(claims_.begin(), claims_.end(),
                  [](const Claim& a, const Claim& b) { return a.object == b.object && a.task == b.task; }),
      claims_.end());
  out_.objects_of_task.resize(plan_.tasks.size());
  out_.rule_of_task.resize(plan_.tasks.size());
  for (const Claim& claim : claims_) {
    auto& rule = out_.rule_of_task[claim.task];
    rule = rule ? std::min(*rule, claim.rule) : claim.rule;
  }
  std::vector<bool> claimed(scene_.objects.size());
  for (std::size_t begin = 0; begin < claims_.size();) {
    std::size_t end = begin;
    while (end < claims_.size() && claims_[end].object == claims_[begin].object) ++end;
    claimed[claims_[begin].object.value] = true;
    settle_object(std::span(claims_).subspan(begin, end - begin));
    begin = end;
  }
  for (std::uint32_t i = 0; i < plan_.tasks.size(); ++i) {
    const bool wanted = !plan_.tasks[i].summary || options_.summary_tasks;
    if (wanted && out_.objects_of_task[i].empty()) out_.tasks_without_objects.push_back(i);
  }
  for (std::size_t i = 0; i < claimed.size(); ++i) {
    if (!claimed[i]) out_.objects_without_tasks.emplace_back(i);
  }
}

Result<Mapping> Mapper::run() {
  facts_.index();
  std::unordered_map<std::string, const SavedMapping::Entry*> saved;
  if (options_.saved != nullptr) {
    for (const SavedMapping::Entry& entry : options_.saved->tasks) saved.emplace(entry.task_id, &entry);
  }
  for (std::uint32_t i = 0; i < plan_.tasks.size(); ++i) {
    const auto entry = saved.find(plan_.tasks[i].id);
    auto taken = entry == saved.end() ? take_task(i) : take_saved(i, *entry->second);
    if (!taken) return forward_error(taken);
    if (claims_.size() > limits::kMaxClaims) {
      return fail(ErrorKind::bad_input, plan_.tasks[i].where,
                  "more than " + std::to_string(limits::kMaxClaims) + " pairs of a task and an object");
    }
    if (entry != saved.end()) saved.erase(entry);
  }
  if (options_.saved != nullptr && !saved.empty()) {
    for (const SavedMapping::Entry& entry : options_.saved->tasks) {
      if (saved.contains(entry.task_id))
        note(options_.saved->path, "task " + in_quotes(entry.task_id) + " is not in the plan any more");
    }
  }
  settle();
  return std::move(out_);
}

}  // namespace

std::string_view name(MatchRule rule) {
  constexpr std::array<std::string_view, 7> kNames{"mapping", "guid",     "name",   "pattern",
                                                   "extras",  "material", "subtree"};
  return kNames[static_cast<std::size_t>(rule)];
}

Result<Mapping> map_tasks(const Plan& plan, const Scene& scene, ObjectFacts& facts,
                          const MappingOptions& options) {
  return Mapper(plan, scene, facts, options).run();
}

}  // namespace scenegen::timeline
