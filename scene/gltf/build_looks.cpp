// Visibility of the nodes that show an object's looks -> its mesh track (and its own visibility).
#include <algorithm>

#include "scene/gltf/build.h"

namespace scenegen::gltf::reading {

namespace {

/// Value of a step track with `times` at `time_s`; the first holds before its key.
template <class Values>
std::uint32_t value_at(std::span<const float> times, const Values& values, float time_s) {
  const auto after = std::upper_bound(times.begin(), times.end(), time_s);
  const auto key = static_cast<std::size_t>(after - times.begin());
  return values[key == 0 ? 0 : key - 1];
}

}  // namespace

LookTable::LookTable(const Document& document, Data& data, VisibilityTable& visibility, Scene& scene)
    : document_(document), data_(data), visibility_(visibility), scene_(scene) {}

/// The first state is the one before all keys, with its time 0; then one for every time at which a look has a
/// key.
std::vector<LookTable::State> LookTable::states_of(const std::vector<Look>& looks, const Place& at) {
  struct Event {
    float time_s;
    std::uint32_t look;
    std::uint8_t shown;
  };
  std::vector<Event> events;
  std::vector<bool> showing(looks.size());
  std::uint64_t count = 0;
  std::uint64_t sum = 0;  // of look numbers: the look, when one is shown
  const auto set = [&](std::uint32_t look, bool shown) {
    if (shown == showing[look]) return;
    showing[look] = shown;
    count += shown ? 1 : -1;
    sum += shown ? look : -std::uint64_t{look};
  };
  std::uint64_t keys = 0;
  for (const Look& look : looks) keys += visibility_.times_s(look.visible).size();
  data_.budget().take((keys + looks.size()) * sizeof(Event), at);
  for (std::uint32_t k = 0; k < looks.size(); ++k) {
    const auto times = visibility_.times_s(looks[k].visible);
    const auto values = visibility_.shown(looks[k].visible);
    for (std::size_t i = 0; i < times.size(); ++i) events.push_back({times[i], k, values[i]});
    set(k, looks[k].visible == VisibilityTable::kAlways || values.front() != 0);
  }
  std::stable_sort(events.begin(), events.end(),
                   [](const Event& a, const Event& b) { return a.time_s < b.time_s; });
  std::vector<State> states;
  const auto add_state = [&](float time_s) {
    if (count > 1) {
      reject(at, std::to_string(count) + " looks are shown at " + std::to_string(time_s) +
                     " s; wanted at most one");
    }
    states.push_back({time_s, count == 1 ? static_cast<std::uint32_t>(sum) : kNone});
  };
  add_state(0.0F);
  for (std::size_t i = 0; i < events.size();) {
    const float now = events[i].time_s;
    for (; i < events.size() && events[i].time_s == now; ++i) set(events[i].look, events[i].shown != 0);
    add_state(now);
  }
  return states;
}

TrackId LookTable::track_of(Course& course, const std::vector<Look>& looks, const Place& at) {
  std::vector<std::uint32_t> meshes;
  meshes.reserve(looks.size());
  for (const Look& look : looks) meshes.push_back(look.mesh);
  const auto [known, fresh] = course.tracks.emplace(std::move(meshes), TrackId());
  if (!fresh) return known->second;
  const std::size_t keys = course.times_s.size();
  data_.budget().take(keys * 4 * sizeof(float), at);
  std::vector<float> values;
  for (const std::uint32_t look : course.looks) values.push_back(static_cast<float>(looks[look].mesh));
  std::vector<float> content = course.times_s;
  content.insert(content.end(), values.begin(), values.end());
  const auto [track, is_new] = tracks_.emplace(std::move(content), TrackId());
  if (is_new) track->second = scene_.add_track(Property::mesh, Interpolation::step, course.times_s, values);
  return known->second = track->second;
}

TrackId LookTable::always_one(const std::vector<Look>& looks, const Place& at) {
  if (looks.empty()) return {};
  std::vector<std::uint32_t> key{kNone, kNone, 0};
  for (const Look& look : looks) key.push_back(look.visible);
  const auto [entry, fresh] = courses_.emplace(std::move(key), Course());
  Course& course = entry->second;
  if (fresh) {
    const std::vector<State> states = states_of(looks, at);
    for (std::size_t i = states.size() == 1 ? 0 : 1; i < states.size(); ++i) {
      if (states[i].look == kNone)
        reject(at, "no look is shown at " + std::to_string(states[i].time_s) + " s; wanted exactly one");
      course.times_s.push_back(states[i].time_s);
      course.looks.push_back(states[i].look);
    }
  }
  return track_of(course, looks, at);
}

/// The least that says the same: what hidden objects look like is not in the animation.
LookTable::Course LookTable::from_states(const std::vector<State>& states) {
  Course out;
  std::vector<float> times;
  std::vector<std::uint8_t> shown;
  for (std::size_t i = states.size() > 1 && states[1].time_s == 0.0F ? 1 : 0; i < states.size(); ++i) {
    const std::uint8_t visible = states[i].look == kNone ? 0 : 1;
    if (shown.empty() || shown.back() != visible) {
      times.push_back(states[i].time_s);
      shown.push_back(visible);
    }
    if (visible == 0 || (!out.looks.empty() && out.looks.back() == states[i].look)) continue;
    out.times_s.push_back(states[i].time_s);
    out.looks.push_back(states[i].look);
  }
  if (out.looks.empty()) {
    out.times_s.push_back(0.0F);
    out.looks.push_back(0);
  }
  out.visible = visibility_.intern(times, shown);
  return out;
}

const Timeline* LookTable::timeline(std::uint32_t index, bool is_looks) const {
  if (document_.scenes.empty()) return nullptr;
  const SceneExtras& extras = document_.scene_extras[document_.scene == kNone ? 0 : document_.scene];
  if (index >= extras.timeline_count) return nullptr;
  const Timeline& out = document_.timelines[extras.first_timeline + index];
  return out.is_looks == is_looks ? &out : nullptr;
}

/// False when they say something else than `states`.
bool LookTable::from_timelines(const std::vector<State>& states, std::uint32_t visibility,
                               std::uint32_t meshes, std::size_t look_count, Course& out) {
  const Timeline* const when = timeline(visibility, false);
  const Timeline* const what = timeline(meshes, true);
  if (what == nullptr || (when == nullptr && visibility != kNone)) return false;
  const auto times_of = [&](const Timeline* t) {
    return t == nullptr ? std::span<const float>()
                        : std::span(document_.timeline_times_s).subspan(t->first, t->count);
  };
  const auto values_of = [&](const Timeline* t) {
    return t == nullptr ? std::span<const std::uint32_t>()
                        : std::span(document_.timeline_values).subspan(t->first, t->count);
  };
  const auto when_times = times_of(when), what_times = times_of(what);
  const auto when_values = values_of(when), what_values = values_of(what);
  if (std::ranges::any_of(what_values, [&](std::uint32_t v) { return v >= look_count; })) return false;
  for (const std::span<const float> times : {when_times, what_times}) {
    if (!times.empty() && times.back() > scene_.duration_s) return false;
  }
  std::vector<float> state_times;
  std::vector<std::uint32_t> state_looks;
  for (std::size_t i = states.size() > 1 ? 1 : 0; i < states.size(); ++i) {
    state_times.push_back(states[i].time_s);
    state_looks.push_back(states[i].look);
  }
  const auto agrees = [&](float time_s) {
    const bool shown = when == nullptr || value_at(when_times, when_values, time_s) != 0;
    const std::uint32_t look = shown ? value_at(what_times, what_values, time_s) : kNone;
    return look ==
           (time_s < state_times.front() ? states.front().look : value_at(state_times, state_looks, time_s));
  };
  for (const std::span<const float> times : {when_times, what_times, std::span<const float>(state_times)}) {
    if (!std::ranges::all_of(times, agrees)) return false;
  }
  if (!agrees(0.0F)) return false;
  std::vector<std::uint8_t> shown(when_values.begin(), when_values.end());
  out.visible = when == nullptr ? VisibilityTable::kAlways : visibility_.intern(when_times, shown);
  out.times_s.assign(what_times.begin(), what_times.end());
  out.looks.assign(what_values.begin(), what_values.end());
  return true;
}

LookTable::Resolved LookTable::at_most_one(const std::vector<Look>& looks, std::uint32_t visibility,
                                           std::uint32_t meshes, const Place& at) {
  std::vector<std::uint32_t> key{visibility, meshes, 1};
  for (const Look& look : looks) key.push_back(look.visible);
  const auto [entry, fresh] = courses_.emplace(std::move(key), Course());
  Course& course = entry->second;
  if (fresh) {
    const std::vector<State> states = states_of(looks, at);
    std::uint64_t keys = states.size();
    for (const Timeline* const t : {timeline(visibility, false), timeline(meshes, true)})
      keys += t == nullptr ? 0 : t->count;
    data_.budget().take(keys * 2 * sizeof(State), at);
    if (!from_timelines(states, visibility, meshes, looks.size(), course)) {
      course = from_states(states);
      ++disagreements_;
    }
  }
  return {course.visible, track_of(course, looks, at)};
}

}  // namespace scenegen::gltf::reading
