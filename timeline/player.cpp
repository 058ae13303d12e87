#include "timeline/player.h"

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include "scene/held_bytes.h"
#include "timeline/keys.h"
#include "timeline/ordered_marks.h"
#include "timeline/timeline_data.h"

namespace scenegen::timeline {

namespace {

template <class T>
bool same_bits(const T& a, const T& b) {
  using Words = std::array<std::uint32_t, sizeof(T) / 4>;
  const auto words_a = std::bit_cast<Words>(a);
  const auto words_b = std::bit_cast<Words>(b);
  std::uint32_t different = 0;
  for (std::size_t i = 0; i < words_a.size(); ++i) different |= words_a[i] ^ words_b[i];
  return different == 0;
}

/// True if `to` took the place of other bits.
template <class T>
bool replace(T& to, const T& value) {
  if (same_bits(to, value)) return false;
  to = value;
  return true;
}

/// Number of events with time <= time_s, searched outwards from `from`: O(log distance).
std::size_t events_until(const std::vector<float>& times_s, std::size_t from, double time_s) {
  const auto passed = [&](std::size_t i) { return static_cast<double>(times_s[i]) <= time_s; };
  std::size_t lo = from;
  std::size_t hi = from;
  if (from < times_s.size() && passed(from)) {
    for (std::size_t step = 1; hi < times_s.size() && passed(hi); step *= 2) {
      lo = hi;
      hi = std::min(times_s.size(), hi + step);
    }
  } else {
    for (std::size_t step = 1; lo > 0 && !passed(lo - 1); step *= 2) {
      hi = lo - 1;
      lo = lo > step ? lo - step : 0;
    }
  }
  const auto begin = times_s.begin();
  const auto after =
      std::upper_bound(begin + static_cast<std::ptrdiff_t>(lo), begin + static_cast<std::ptrdiff_t>(hi),
                       time_s, [](double t, float e) { return t < static_cast<double>(e); });
  return static_cast<std::size_t>(after - begin);
}

std::size_t distance(std::size_t a, std::size_t b) {
  return a < b ? b - a : a - b;
}

}  // namespace

struct Player::State {
  explicit State(std::shared_ptr<const Timeline> t);

  void seek(double time_s);
  void seek_visibility(double time_s);
  void flip_track(std::uint32_t track);
  void report_visibility();
  void seek_keys(double time_s);
  void enter(std::uint32_t track, std::int32_t new_segment, bool changes);
  void update_active(std::uint32_t track);
  void apply_all(const std::vector<std::uint32_t>& list, double time_s);
  void prefetch(const std::vector<std::uint32_t>& list, std::size_t at) const;
  void update_frames();
  void update_objects_of(const MovingFrame& moving, const glm::mat4& frame);
  [[nodiscard]] glm::mat4 world_from_frame(FrameId frame) const;

  std::shared_ptr<const Timeline> timeline;
  const TimelineData& data;
  double time_s = 0;
  ChangeSet changes;

  std::size_t visibility_passed = 0, keys_passed = 0;  ///< events with time <= the present

  std::vector<std::uint64_t> visible;  ///< a bit an object
  std::size_t visible_count = 0;
  std::vector<std::uint8_t> track_on;  ///< by visibility track
  OrderedMarks flipped_tracks, flipped_objects;
  std::vector<ObjectId> shown, hidden;

  // Tracks with keys: those whose segment changes with time are active.
  struct TrackState {
    std::int32_t segment = -1;
    std::uint32_t active_place = kNone;
    bool changes = false;
    bool is_entered = false;
  };
  void apply(const KeyEvents::KeyTrack& track, const TrackState& state, double time_s);
  std::vector<TrackState> tracks;
  std::vector<std::uint32_t> active, entered;

  // Motion: by slot of moving frame, by slot of moving object. Two cache lines each.
  struct alignas(64) FrameState {
    glm::mat4 world;
    Transform local;
  };
  struct alignas(64) ObjectState {
    glm::mat4 world, local;
  };
  std::vector<FrameState> frames;
  std::vector<ObjectState> objects;
  OrderedMarks dirty_frames, moved_objects;
  std::vector<ObjectId> moved;

  std::vector<MeshId> mesh;  ///< empty if no mesh is ever swapped
  OrderedMarks remeshed_objects;
  std::vector<ObjectId> remeshed;

  std::vector<glm::vec4> base_color;
  std::vector<glm::vec3> emissive;
  OrderedMarks recolored_materials;
  std::vector<MaterialId> recolored;
};

Player::State::State(std::shared_ptr<const Timeline> t)
    : timeline(std::move(t)),
      data(timeline->data()),
      visible(data.visible_at_start),
      visible_count(data.visible_count_at_start),
      track_on(data.visibility.on_at_start),
      flipped_tracks(data.visibility.track_count()),
      flipped_objects(data.visibility.track_count() == 0 ? 0 : data.object_mesh.size()),
      tracks(data.keys.track_count()),
      dirty_frames(data.moving_frames.size()),
      moved_objects(data.object_slot.size()),
      remeshed_objects(data.meshes_change ? data.object_mesh.size() : 0),
      base_color(data.base_color),
      emissive(data.emissive),
      recolored_materials(data.base_color.size()) {
  frames.reserve(data.moving_frames.size());
  for (std::size_t i = 0; i < data.moving_frames.size(); ++i) {
    frames.push_back({data.world_from_frame[data.moving_frames[i].frame.value], data.moving_local[i]});
  }
  objects.reserve(data.frame_objects.size());
  for (const ObjectId o : data.frame_objects) {
    const glm::mat4 local = data.frame_from_object[o.value].matrix();
    objects.push_back({world_from_frame(data.object_frame[o.value]) * local, local});
  }
  if (data.meshes_change) mesh = data.object_mesh;
  // The most that one step can report: nothing is allocated from here on.
  const std::size_t most_flips = data.visibility.objects.items.size();
  shown.reserve(most_flips);
  hidden.reserve(most_flips);
  moved.reserve(data.moving_objects.size());
  remeshed.reserve(data.meshes_change ? data.keys.targets.size() : 0);
  recolored.reserve(data.base_color.size());
  active.reserve(data.keys.track_count());
  entered.reserve(data.keys.track_count());
}

void Player::State::seek(double to_s) {
  const double t = to_s > 0.0 ? std::min(to_s, data.duration_s) : 0.0;  // NaN is 0
  shown.clear();
  hidden.clear();
  moved.clear();
  remeshed.clear();
  recolored.clear();
  seek_visibility(t);
  seek_keys(t);
  time_s = t;
  changes = {t, shown, hidden, moved, remeshed, recolored};
}

// ---- Visibility

void Player::State::seek_visibility(double t) {
  const VisibilityEvents& v = data.visibility;
  const std::size_t passed = events_until(v.time_s, visibility_passed, t);
  if (distance(passed, visibility_passed) <= v.all_tracks_cost) {
    // Every event flips its track, whichever way it is passed; two passes leave no mark.
    const std::size_t end = std::max(passed, visibility_passed);
    for (std::size_t i = std::min(passed, visibility_passed); i < end; ++i) flipped_tracks.flip(v.track[i]);
  } else {
    for (std::uint32_t track = 0; track < v.track_count(); ++track) {
      const auto flips =
          std::span(v.flip_s).subspan(v.first_flip[track], v.first_flip[track + 1] - v.first_flip[track]);
      const bool odd = ((segment_at(flips, t) + 1) & 1) != 0;
      if (odd != (track_on[track] != v.on_at_start[track])) flipped_tracks.set(track);
    }
  }
  if (passed == visibility_passed) return;
  visibility_passed = passed;
  flipped_tracks.drain([this](std::uint32_t track) { flip_track(track); });
  report_visibility();
}

void Player::State::flip_track(std::uint32_t track) {
  track_on[track] ^= 1U;
  for (const std::uint32_t o : data.visibility.objects[track]) flipped_objects.set(o);
}

void Player::State::report_visibility() {
  const auto emit = [](std::vector<ObjectId>& out, std::size_t word, std::uint64_t bits) {
    for (; bits != 0; bits &= bits - 1) {
      out.emplace_back(word * 64 + static_cast<unsigned>(std::countr_zero(bits)));
    }
  };
  flipped_objects.drain_words([&](std::size_t word, std::uint64_t bits) {
    visible[word] ^= bits;
    emit(shown, word, bits & visible[word]);
    emit(hidden, word, bits & ~visible[word]);
  });
  visible_count = visible_count + shown.size() - hidden.size();
}

// ---- Tracks with keys

void Player::State::seek_keys(double t) {
  const KeyEvents& k = data.keys;
  const std::size_t passed = events_until(k.time_s, keys_passed, t);
  if (distance(passed, keys_passed) > k.all_tracks_cost) {
    for (std::uint32_t track = 0; track < k.track_count(); ++track) {
      const Keys keys = k.keys(k.tracks[track]);
      const std::int32_t now = segment_at(keys.times_s, t);
      if (now != tracks[track].segment) enter(track, now, segment_changes(keys, now));
    }
  } else {
    for (std::size_t i = keys_passed; i < passed; ++i) {
      enter(k.track[i], k.segment[i], (k.changes[i] & KeyEvents::after) != 0);
    }
    for (std::size_t i = keys_passed; i-- > passed;) {
      enter(k.track[i], k.segment[i] - 1, (k.changes[i] & KeyEvents::before) != 0);
    }
  }
  keys_passed = passed;

  for (const std::uint32_t track : entered) {
    tracks[track].is_entered = false;
    update_active(track);
  }
  apply_all(active, t);
  // What is active has been applied; the others hold the value of a key.
  std::erase_if(entered, [this](std::uint32_t track) { return tracks[track].changes; });
  apply_all(entered, t);
  entered.clear();

  update_frames();
  moved_objects.drain([this](std::uint32_t o) { moved.emplace_back(o); });
  remeshed_objects.drain([this](std::uint32_t o) { remeshed.emplace_back(o); });
  recolored_materials.drain([this](std::uint32_t m) { recolored.emplace_back(m); });
}

void Player::State::enter(std::uint32_t track, std::int32_t new_segment, bool changes_there) {
  TrackState& state = tracks[track];
  state.segment = new_segment;
  state.changes = changes_there;
  if (state.is_entered) return;
  state.is_entered = true;
  entered.push_back(track);
}

void Player::State::update_active(std::uint32_t track) {
  TrackState& state = tracks[track];
  if (state.changes == (state.active_place != kNone)) return;
  if (state.changes) {
    state.active_place = static_cast<std::uint32_t>(active.size());
    active.push_back(track);
  } else {
    const std::uint32_t last = active.back();
    active[state.active_place] = last;
    tracks[last].active_place = state.active_place;
    active.pop_back();
    state.active_place = kNone;
  }
}

void Player::State::apply_all(const std::vector<std::uint32_t>& list, double t) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    prefetch(list, i);
    apply(data.keys.tracks[list[i]], tracks[list[i]], t);
  }
}

/// Tracks, keys, frames and objects of one list lie all over memory, one behind the other: each stage is
/// asked for some tracks ahead of the stage that needs it (three times faster at 1 M moving objects).
void Player::State::prefetch(const std::vector<std::uint32_t>& list, std::size_t at) const {
  constexpr std::size_t kAhead = 8;
  const auto track = [&](std::size_t stage) {
    return at + stage * kAhead < list.size() ? &data.keys.tracks[list[at + stage * kAhead]] : nullptr;
  };
  const auto frame_of = [](const KeyEvents::KeyTrack* t) {
    const bool is_one_frame = t != nullptr && t->target_count == 1 &&
                              (t->property == Property::translation || t->property == Property::rotation ||
                               t->property == Property::scale);
    return is_one_frame ? t->target : kNone;
  };
  if (const auto* t = track(4)) __builtin_prefetch(t);
  if (const auto* t = track(3)) {
    __builtin_prefetch(data.keys.pool.data() + t->floats);
    if (const std::uint32_t f = frame_of(t); f != kNone) __builtin_prefetch(&data.moving_frames[f]);
  }
  if (const std::uint32_t f = frame_of(track(2)); f != kNone) {
    __builtin_prefetch(&frames[f].world);
    __builtin_prefetch(&frames[f].local);
  }
  if (const std::uint32_t f = frame_of(track(1)); f != kNone && !objects.empty()) {
    const std::size_t first = std::min<std::size_t>(data.moving_frames[f].first_object, objects.size() - 1);
    __builtin_prefetch(&objects[first].world);
    __builtin_prefetch(&objects[first].local);
  }
}

void Player::State::apply(const KeyEvents::KeyTrack& track, const TrackState& state, double t) {
  const Keys keys = data.keys.keys(track);
  const glm::vec4 value =
      state.changes ? interpolate(keys, state.segment, t) : key_value(keys, state.segment);
  const std::span<const std::uint32_t> targets = data.keys.target_list(track);
  switch (keys.property) {
    case Property::translation:
      for (const std::uint32_t f : targets) {
        if (replace(frames[f].local.translation_m, glm::vec3(value))) dirty_frames.set(f);
      }
      break;
    case Property::rotation:
      for (const std::uint32_t f : targets) {
        if (replace(frames[f].local.rotation, glm::quat(value.w, value.x, value.y, value.z)))
          dirty_frames.set(f);
      }
      break;
    case Property::scale:
      for (const std::uint32_t f : targets) {
        if (replace(frames[f].local.scale, glm::vec3(value))) dirty_frames.set(f);
      }
      break;
    case Property::mesh:
      for (const std::uint32_t o : targets) {
        if (replace(mesh[o], MeshId(static_cast<std::uint64_t>(value.x)))) remeshed_objects.set(o);
      }
      break;
    case Property::base_color:
      for (const std::uint32_t m : targets) {
        if (replace(base_color[m], value)) recolored_materials.set(m);
      }
      break;
    case Property::emissive:
      for (const std::uint32_t m : targets) {
        if (replace(emissive[m], glm::vec3(value))) recolored_materials.set(m);
      }
      break;
    case Property::visibility:
      break;  // has its own events
  }
}

// ---- Motion

void Player::State::update_frames() {
  dirty_frames.drain([this](std::uint32_t slot) {  // parents stand before children
    const MovingFrame& moving = data.moving_frames[slot];
    FrameState& frame = frames[slot];
    glm::mat4 world = moving.matrix != kNone ? data.matrices[moving.matrix] : frame.local.matrix();
    if (moving.parent != kNone) {
      world = frames[moving.parent].world * world;
    } else if (moving.still_parent.valid()) {
      world = data.world_from_frame[moving.still_parent.value] * world;
    }
    if (!replace(frame.world, world)) return;
    for (std::uint32_t i = moving.first_child; i < moving.end_child; ++i) dirty_frames.set(data.children[i]);
    update_objects_of(moving, world);
  });
}

void Player::State::update_objects_of(const MovingFrame& moving, const glm::mat4& frame) {
  for (std::uint32_t i = moving.first_object; i < moving.end_object; ++i) {
    if (replace(objects[i].world, frame * objects[i].local)) moved_objects.set(data.frame_objects[i].value);
  }
}

glm::mat4 Player::State::world_from_frame(FrameId frame) const {
  const std::uint32_t slot = data.frame_slot[frame.value];
  return slot != kNone ? frames[slot].world : data.world_from_frame[frame.value];
}

// ---- Player

Player::Player(std::shared_ptr<const Timeline> timeline)
    : state_(std::make_unique<State>(std::move(timeline))) {}
Player::~Player() = default;
Player::Player(Player&&) noexcept = default;
Player& Player::operator=(Player&&) noexcept = default;

const ChangeSet& Player::seek(double time_s) {
  state_->seek(time_s);
  return state_->changes;
}

const ChangeSet& Player::advance(double dt_s) {
  return seek(state_->time_s + dt_s);
}

double Player::time_s() const {
  return state_->time_s;
}

bool Player::visible(ObjectId id) const {
  return ((state_->visible[id.value / 64] >> (id.value % 64)) & 1) != 0;
}

std::size_t Player::visible_count() const {
  return state_->visible_count;
}

glm::mat4 Player::world_from_object(ObjectId id) const {
  const TimelineData& data = state_->data;
  if (!data.object_slot.empty() && data.object_slot[id.value] != kNone) {
    return state_->objects[data.object_slot[id.value]].world;
  }
  const glm::mat4 local = data.frame_from_object[id.value].matrix();
  const FrameId frame = data.object_frame[id.value];
  return frame.valid() ? data.world_from_frame[frame.value] * local : local;
}

MeshId Player::mesh(ObjectId id) const {
  return state_->mesh.empty() ? state_->data.object_mesh[id.value] : state_->mesh[id.value];
}

glm::vec4 Player::base_color(MaterialId id) const {
  return state_->base_color[id.value];
}

glm::vec3 Player::emissive(MaterialId id) const {
  return state_->emissive[id.value];
}

glm::mat4 Player::world_from_camera(CameraId id) const {
  const TimelineData::CameraPlace& place = state_->data.cameras[id.value];
  Transform rigid = place.frame_from_camera;
  rigid.scale = glm::vec3(1.0F);
  if (!place.frame.valid()) return rigid.matrix();
  glm::mat4 m = state_->world_from_frame(place.frame) * rigid.matrix();
  for (int axis = 0; axis < 3; ++axis) {
    const float length = glm::length(glm::vec3(m[axis]));
    if (length > 0.0F) m[axis] /= length;
  }
  return m;
}

const Timeline& Player::timeline() const {
  return *state_->timeline;
}

std::uint64_t Player::memory_bytes() const {
  const State& s = *state_;
  std::uint64_t sum = sizeof(State);
  for (const OrderedMarks* marks : {&s.flipped_tracks, &s.flipped_objects, &s.dirty_frames, &s.moved_objects,
                                    &s.remeshed_objects, &s.recolored_materials})
    sum += marks->memory_bytes();
  return sum + held_bytes(s.visible, s.track_on, s.shown, s.hidden, s.tracks, s.active, s.entered, s.frames,
                          s.objects, s.moved, s.mesh, s.remeshed, s.base_color, s.emissive, s.recolored);
}

}  // namespace scenegen::timeline
