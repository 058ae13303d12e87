#include "timeline/player.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "timeline/keys.h"
#include "timeline/ordered_marks.h"
#include "timeline/timeline_data.h"

namespace scenegen::timeline {

namespace {

constexpr std::uint32_t kNone = MovingFrame::kNone;

template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
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
  void enter(std::uint32_t track, std::int32_t new_segment);
  void update_active(std::uint32_t track);
  void apply(std::uint32_t track, double time_s);
  void update_frames();
  void update_objects_of(std::uint32_t frame_slot);
  [[nodiscard]] glm::mat4 world_from_frame(FrameId frame) const;

  std::shared_ptr<const Timeline> timeline;
  const TimelineData& data;
  double time_s = 0;
  ChangeSet changes;

  std::size_t visibility_passed = 0, keys_passed = 0;  ///< events with time <= time_s

  std::vector<std::uint64_t> visible;  ///< a bit an object
  std::size_t visible_count = 0;
  std::vector<std::uint8_t> track_on;  ///< by visibility track
  OrderedMarks flipped_tracks, flipped_objects;
  std::vector<ObjectId> shown, hidden;

  // Key tracks: in which segment each is, and those whose segment changes with time.
  std::vector<std::int32_t> segment;
  std::vector<std::uint32_t> active, active_place;
  std::vector<std::uint32_t> entered;
  std::vector<std::uint8_t> is_entered;

  // Motion: by slot of moving frame, by slot of moving object.
  std::vector<Transform> local;
  std::vector<glm::mat4> frame_world;
  std::vector<glm::mat4> object_local, object_world;
  OrderedMarks dirty_frames, moved_slots;
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
      segment(data.keys.track_count(), -1),
      active_place(data.keys.track_count(), kNone),
      is_entered(data.keys.track_count(), 0),
      dirty_frames(data.moving_frames.size()),
      moved_slots(data.moving_objects.size()),
      remeshed_objects(data.meshes_change ? data.object_mesh.size() : 0),
      base_color(data.base_color),
      emissive(data.emissive),
      recolored_materials(data.base_color.size()) {
  for (const MovingFrame& f : data.moving_frames) {
    local.push_back(f.local);
    frame_world.push_back(data.world_from_frame[f.frame.value]);
  }
  for (const ObjectId o : data.moving_objects) {
    object_local.push_back(data.frame_from_object[o.value].matrix());
    object_world.push_back(world_from_frame(data.object_frame[o.value]) * object_local.back());
  }
  if (data.meshes_change) mesh = data.object_mesh;
  // The most that one step can report: nothing is allocated from here on.
  const std::size_t most_flips = data.visibility.objects.items.size();
  shown.reserve(most_flips);
  hidden.reserve(most_flips);
  moved.reserve(data.moving_objects.size());
  remeshed.reserve(data.meshes_change ? data.keys.targets.items.size() : 0);
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
      const std::int32_t now = segment_at(k.keys(track).times_s, t);
      if (now != segment[track]) enter(track, now);
    }
  } else {
    for (std::size_t i = keys_passed; i < passed; ++i) enter(k.track[i], k.segment[i]);
    for (std::size_t i = keys_passed; i > passed; --i) enter(k.track[i - 1], k.segment[i - 1] - 1);
  }
  keys_passed = passed;

  for (const std::uint32_t track : entered) update_active(track);
  for (const std::uint32_t track : active) apply(track, t);
  for (const std::uint32_t track : entered) {
    if (active_place[track] == kNone) apply(track, t);
    is_entered[track] = 0;
  }
  entered.clear();

  update_frames();
  moved_slots.drain([this](std::uint32_t slot) { moved.push_back(data.moving_objects[slot]); });
  remeshed_objects.drain([this](std::uint32_t o) { remeshed.emplace_back(o); });
  recolored_materials.drain([this](std::uint32_t m) { recolored.emplace_back(m); });
}

void Player::State::enter(std::uint32_t track, std::int32_t new_segment) {
  segment[track] = new_segment;
  if (is_entered[track] != 0) return;
  is_entered[track] = 1;
  entered.push_back(track);
}

void Player::State::update_active(std::uint32_t track) {
  const bool changes_now = data.keys.changes(track, segment[track]);
  const std::uint32_t place = active_place[track];
  if (changes_now == (place != kNone)) return;
  if (changes_now) {
    active_place[track] = static_cast<std::uint32_t>(active.size());
    active.push_back(track);
  } else {
    active[place] = active.back();
    active_place[active[place]] = place;
    active.pop_back();
    active_place[track] = kNone;
  }
}

void Player::State::apply(std::uint32_t track, double t) {
  const Keys keys = data.keys.keys(track);
  const glm::vec4 value = evaluate(keys, segment[track], t);
  const std::span<const std::uint32_t> targets = data.keys.targets[track];
  switch (keys.property) {
    case Property::translation:
      for (const std::uint32_t f : targets) {
        if (replace(local[f].translation_m, glm::vec3(value))) dirty_frames.set(f);
      }
      break;
    case Property::rotation:
      for (const std::uint32_t f : targets) {
        if (replace(local[f].rotation, glm::quat(value.w, value.x, value.y, value.z))) dirty_frames.set(f);
      }
      break;
    case Property::scale:
      for (const std::uint32_t f : targets) {
        if (replace(local[f].scale, glm::vec3(value))) dirty_frames.set(f);
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
    const MovingFrame& f = data.moving_frames[slot];
    const glm::mat4 m = f.has_matrix ? f.matrix : local[slot].matrix();
    const glm::mat4& parent = f.parent != kNone ? frame_world[f.parent] : f.parent_world;
    if (!replace(frame_world[slot], f.has_parent ? parent * m : m)) return;
    for (const std::uint32_t child : data.children[slot]) dirty_frames.set(child);
    update_objects_of(slot);
  });
}

void Player::State::update_objects_of(std::uint32_t frame_slot) {
  const glm::mat4& frame = frame_world[frame_slot];
  for (const std::uint32_t slot : data.frame_objects[frame_slot]) {
    if (replace(object_world[slot], frame * object_local[slot])) moved_slots.set(slot);
  }
}

glm::mat4 Player::State::world_from_frame(FrameId frame) const {
  const std::uint32_t slot = data.frame_slot[frame.value];
  return slot != kNone ? frame_world[slot] : data.world_from_frame[frame.value];
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
    return state_->object_world[data.object_slot[id.value]];
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

}  // namespace scenegen::timeline
