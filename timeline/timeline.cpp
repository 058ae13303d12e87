#include "timeline/timeline.h"

#include <algorithm>
#include <iterator>

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

}  // namespace scenegen::timeline
