#include "timeline/timeline.h"

#include <algorithm>
#include <iterator>

#include "scene/held_bytes.h"
#include "timeline/timeline_data.h"

namespace scenegen::timeline {

Timeline::Timeline(std::unique_ptr<const TimelineData> data) : data_(std::move(data)) {}
Timeline::~Timeline() = default;

double Timeline::duration_s() const {
  return data_->duration_s;
}
std::size_t Timeline::object_count() const {
  return data_->object_mesh.size();
}
std::size_t Timeline::material_count() const {
  return data_->base_color.size();
}
std::size_t Timeline::camera_count() const {
  return data_->cameras.size();
}
ObjectClass Timeline::object_class(ObjectId id) const {
  return data_->object_class[id.value];
}
const ClassCounts& Timeline::class_counts() const {
  return data_->classes;
}
std::span<const ObjectId> Timeline::moving_objects() const {
  return data_->moving_objects;
}
std::span<const float> Timeline::event_times_s() const {
  return data_->event_times_s;
}
std::span<const float> Timeline::visibility_times_s() const {
  return data_->visibility_times_s;
}
std::span<const std::uint64_t> Timeline::visibility_changes() const {
  return data_->visibility_changes;
}

std::uint64_t Timeline::memory_bytes() const {
  const TimelineData& d = *data_;
  const VisibilityEvents& v = d.visibility;
  const KeyEvents& k = d.keys;
  return sizeof(TimelineData) +
         held_bytes(d.frame_from_object, d.object_frame, d.object_mesh, d.object_class, d.visible_at_start) +
         held_bytes(d.world_from_frame, d.frame_slot, d.moving_frames, d.moving_local, d.matrices, d.children,
                    d.frame_objects, d.moving_objects, d.object_slot) +
         held_bytes(d.base_color, d.emissive, d.cameras, d.event_times_s, d.visibility_times_s,
                    d.visibility_changes) +
         held_bytes(v.time_s, v.track, v.first_flip, v.flip_s, v.on_at_start, v.objects.first,
                    v.objects.items) +
         held_bytes(k.time_s, k.track, k.segment, k.changes, k.tracks, k.pool, k.targets);
}

}  // namespace scenegen::timeline
