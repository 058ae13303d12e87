// Channels of animation 0 -> tracks.
#include <algorithm>
#include <cmath>

#include "scene/gltf/build.h"

namespace scenegen::gltf::reading {

namespace {

constexpr std::uint32_t kUnread = kNone;

struct Keys {
  Interpolation interpolation = Interpolation::step;
  std::vector<float> times_s;
  std::vector<float> values;
  std::uint32_t width = 1;  ///< floats a key, tangents included
};

class MotionBuilder {
 public:
  MotionBuilder(Document& document, Data& data, VisibilityTable& visibility, Scene& scene)
      : document_(document), data_(data), visibility_(visibility), scene_(scene) {}
  Motions build();

 private:
  /// What a sampler means as a scale track.
  struct ScaleMeaning {
    bool known = false;
    std::uint32_t visibility = VisibilityTable::kAlways;  ///< of a visibility track
    std::uint32_t track = kNone;                          ///< of a moving scale
    bool constant = false;  ///< visibility or constant: `shown` is the node's scale
    bool has_shown = false;
    glm::vec3 shown{1.0F};
  };

  void add_channel(const Channel& channel, const Place& at);
  void add_node_channel(const Channel& channel, const Place& at);
  void add_material_channel(const Channel& channel, const Place& at);
  Keys read_keys(const Channel& channel, std::uint32_t components, const Place& at);
  void drop_added_keys(Keys& keys) const;
  const ScaleMeaning& scale_of(const Channel& channel, const Place& at);
  std::uint32_t visibility_of(const Channel& channel, const Place& at);
  std::uint32_t track_of(const Channel& channel, Property property, std::vector<std::uint32_t>& memo,
                         const Place& at);
  std::uint32_t add_track(Property property, const Keys& keys) {
    return scene_.add_track(property, keys.interpolation, keys.times_s, keys.values).value;
  }
  NodeMotion& motion_of(std::uint32_t node) {
    if (out_.of_node[node] == kNone) {
      out_.of_node[node] = static_cast<std::uint32_t>(out_.motions.size());
      out_.motions.emplace_back();
    }
    return out_.motions[out_.of_node[node]];
  }

  Document& document_;
  Data& data_;
  VisibilityTable& visibility_;
  Scene& scene_;
  Motions out_;
  double end_s_ = 0;
  std::vector<std::uint32_t> as_translation_, as_rotation_, as_visibility_;  ///< by sampler; kUnread
  std::vector<ScaleMeaning> scales_;
  std::vector<std::uint32_t> as_scale_;      ///< by sampler, into scales_
  std::vector<std::uint8_t> material_seen_;  ///< bit 0 base colour, bit 1 emissive
};

void check_times(const std::vector<float>& times, const Place& at) {
  if (!(times.front() >= 0.0F)) reject(at, "the first time is negative");
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] > times[i - 1]) continue;
    reject(at, "times do not increase at element " + std::to_string(i));
  }
}

Keys MotionBuilder::read_keys(const Channel& channel, std::uint32_t components, const Place& at) {
  const AnimationSampler& sampler = document_.animation_samplers[channel.sampler];
  const Place root;
  const Place list = root.key("animations");
  const Place animation = list.at(0);
  const Place samplers = animation.key("samplers");
  const Place here = samplers.at(channel.sampler);
  Keys keys;
  keys.interpolation = sampler.interpolation;
  keys.width = components * (sampler.interpolation == Interpolation::cubic_spline ? 3 : 1);
  const Accessor& output = data_.accessor(sampler.output, here.key("output"));
  if (output.components != components) {
    reject(at, "the output has " + std::to_string(output.components) + " components; this target wants " +
                   std::to_string(components));
  }
  keys.times_s = data_.floats(sampler.input, 1, here.key("input"));
  check_times(keys.times_s, here.key("input"));
  keys.values = data_.floats(sampler.output, components, here.key("output"));
  if (keys.values.size() != keys.times_s.size() * keys.width) {
    reject(here, std::to_string(keys.times_s.size()) + " times, but " +
                     std::to_string(keys.values.size() / components) + " values" +
                     (sampler.interpolation == Interpolation::cubic_spline ? " (three a time)" : ""));
  }
  end_s_ = std::max(end_s_, double{keys.times_s.back()});
  return keys;
}

/// Two neighbouring keys between which nothing changes.
bool still(const Keys& keys, std::size_t first) {
  const bool cubic = keys.interpolation == Interpolation::cubic_spline;
  const std::size_t width = cubic ? keys.width / 3 : keys.width;
  const std::size_t value = cubic ? width : 0;  // in-tangent, value, out-tangent
  const float* const a = &keys.values[first * keys.width];
  const float* const b = a + keys.width;
  for (std::size_t i = 0; i < width; ++i) {
    if (a[value + i] != b[value + i]) return false;
    if (cubic && (a[2 * width + i] != 0 || b[i] != 0)) return false;
  }
  return true;
}

/// Our writer begins every sampler at 0 and ends it at the timeline's end (docs/FORMAT.md 3): keys there that
/// change nothing are not the track's own.
void MotionBuilder::drop_added_keys(Keys& keys) const {
  if (!document_.ours) return;
  const std::size_t n = keys.times_s.size();
  if (n >= 2 && double{keys.times_s.back()} == document_.end_s && still(keys, n - 2)) {
    keys.times_s.pop_back();
    keys.values.resize(keys.values.size() - keys.width);
  }
  if (keys.times_s.size() >= 2 && keys.times_s.front() == 0 && still(keys, 0)) {
    keys.times_s.erase(keys.times_s.begin());
    keys.values.erase(keys.values.begin(), keys.values.begin() + keys.width);
  }
}

const MotionBuilder::ScaleMeaning& MotionBuilder::scale_of(const Channel& channel, const Place& at) {
  if (as_scale_.empty()) as_scale_.assign(document_.animation_samplers.size(), kUnread);
  std::uint32_t& slot = as_scale_[channel.sampler];
  if (slot != kUnread) return scales_[slot];
  slot = static_cast<std::uint32_t>(scales_.size());
  ScaleMeaning out;
  Keys keys = read_keys(channel, 3, at);
  drop_added_keys(keys);
  std::vector<std::uint8_t> shown(keys.times_s.size());
  bool binary = keys.interpolation == Interpolation::step;
  for (std::size_t i = 0; i < keys.times_s.size() && binary; ++i) {
    const glm::vec3 value(keys.values[3 * i], keys.values[3 * i + 1], keys.values[3 * i + 2]);
    if (value == glm::vec3(0.0F)) continue;
    shown[i] = 1;
    binary = !out.has_shown || value == out.shown;
    out.shown = value;
    out.has_shown = true;
  }
  if (binary) {
    out.constant = true;
    out.visibility = visibility_.intern(keys.times_s, shown);
  } else {
    out.track = add_track(Property::scale, keys);
  }
  scales_.push_back(out);
  return scales_.back();
}

std::uint32_t MotionBuilder::visibility_of(const Channel& channel, const Place& at) {
  if (as_visibility_.empty()) as_visibility_.assign(document_.animation_samplers.size(), kUnread);
  std::uint32_t& slot = as_visibility_[channel.sampler];
  if (slot != kUnread) return slot;
  if (document_.animation_samplers[channel.sampler].interpolation != Interpolation::step) {
    reject(at, "visibility is a boolean: its interpolation must be STEP");
  }
  Keys keys = read_keys(channel, 1, at);
  drop_added_keys(keys);
  std::vector<std::uint8_t> shown(keys.times_s.size());
  for (std::size_t i = 0; i < shown.size(); ++i) shown[i] = keys.values[i] != 0.0F ? 1 : 0;
  slot = visibility_.intern(keys.times_s, shown);
  return slot;
}

/// Within float32 of unit length a quaternion stays as it is.
void normalise_rotations(Keys& keys, const Place& at) {
  const std::size_t value = keys.interpolation == Interpolation::cubic_spline ? 4 : 0;
  for (std::size_t i = 0; i < keys.times_s.size(); ++i) {
    float* const q = &keys.values[i * keys.width + value];
    const double length2 =
        double{q[0]} * q[0] + double{q[1]} * q[1] + double{q[2]} * q[2] + double{q[3]} * q[3];
    if (std::abs(length2 - 1.0) <= 1e-4) continue;
    if (!(length2 > 1e-6 && length2 < 1e6)) reject(at, "key " + std::to_string(i) + " is not a rotation");
    for (int c = 0; c < 4; ++c) q[c] = static_cast<float>(q[c] / std::sqrt(length2));
  }
}

std::uint32_t MotionBuilder::track_of(const Channel& channel, Property property,
                                      std::vector<std::uint32_t>& memo, const Place& at) {
  if (memo.empty()) memo.assign(document_.animation_samplers.size(), kUnread);
  std::uint32_t& slot = memo[channel.sampler];
  if (slot != kUnread) return slot;
  Keys keys = read_keys(channel, width(property), at);
  if (property == Property::rotation) normalise_rotations(keys, at);
  drop_added_keys(keys);
  slot = add_track(property, keys);
  return slot;
}

void MotionBuilder::add_node_channel(const Channel& channel, const Place& at) {
  check_index(channel.target, document_.nodes.size(), "nodes", at.key("target"));
  Node& node = document_.nodes[channel.target];
  NodeMotion& motion = motion_of(channel.target);
  const auto once = [&](bool taken) {
    if (taken) reject(at, "a second channel on the same property of node " + std::to_string(channel.target));
  };
  if (channel.path == Path::visibility) {
    if (!node.has_visibility) {
      reject(at, "points into node " + std::to_string(channel.target) +
                     ", which has no extensions.KHR_node_visibility");
    }
    once(motion.pointer_visibility != kNone);
    motion.pointer_visibility = visibility_of(channel, at);
    return;
  }
  if (node.detail != kNone && document_.node_details[node.detail].has_matrix) {
    reject(at, "node " + std::to_string(channel.target) + " has a matrix: it cannot be animated");
  }
  if (channel.path == Path::translation) {
    once(motion.translation != kNone);
    motion.translation = track_of(channel, Property::translation, as_translation_, at);
  } else if (channel.path == Path::rotation) {
    once(motion.rotation != kNone);
    motion.rotation = track_of(channel, Property::rotation, as_rotation_, at);
  } else {
    once(motion.scale != kNone);
    const ScaleMeaning& meaning = scale_of(channel, at);
    motion.scale = meaning.constant ? NodeMotion::kConstant : meaning.track;
    motion.scale_visibility = meaning.visibility;
    if (meaning.constant)
      out_.scale_visibility.push_back({channel.target, meaning.has_shown ? meaning.shown : node.local.scale});
    if (meaning.has_shown && meaning.constant) node.local.scale = meaning.shown;
  }
}

void MotionBuilder::add_material_channel(const Channel& channel, const Place& at) {
  check_index(channel.target, scene_.materials.size(), "materials", at.key("target"));
  const bool base = channel.path == Path::base_color;
  if (material_seen_.empty()) material_seen_.assign(scene_.materials.size(), 0);
  std::uint8_t& seen = material_seen_[channel.target];
  const std::uint8_t bit = base ? 1 : 2;
  if ((seen & bit) != 0)
    reject(at, "a second channel on the same property of material " + std::to_string(channel.target));
  seen = static_cast<std::uint8_t>(seen | bit);
  Keys keys = read_keys(channel, base ? 4 : 3, at);
  if (!base) {
    for (float& value : keys.values) {
      value *= document_.emissive_strength[channel.target];
      if (!std::isfinite(value)) reject(at, "times emissiveStrength is not finite");
    }
  }
  drop_added_keys(keys);
  const std::uint32_t track = add_track(base ? Property::base_color : Property::emissive, keys);
  scene_.material_tracks.push_back({MaterialId(channel.target), TrackId(track)});
}

void MotionBuilder::add_channel(const Channel& channel, const Place& at) {
  check_index(channel.sampler, document_.animation_samplers.size(), "samplers", at.key("sampler"));
  if (channel.path == Path::none) return;
  if (channel.path == Path::base_color || channel.path == Path::emissive) {
    add_material_channel(channel, at);
  } else {
    add_node_channel(channel, at);
  }
}

Motions MotionBuilder::build() {
  if (!document_.channels.empty()) out_.of_node.assign(document_.nodes.size(), kNone);
  const Place root;
  const Place list = root.key("animations");
  const Place animation = list.at(0);
  const Place channels = animation.key("channels");
  for (std::size_t i = 0; i < document_.channels.size(); ++i)
    add_channel(document_.channels[i], channels.at(i));
  std::sort(out_.scale_visibility.begin(), out_.scale_visibility.end(),
            [](const auto& a, const auto& b) { return a.node < b.node; });
  scene_.duration_s = static_cast<float>(std::max(end_s_, document_.end_s));
  return std::move(out_);
}

}  // namespace

Motions build_motions(Document& document, Data& data, VisibilityTable& visibility, Scene& scene) {
  return MotionBuilder(document, data, visibility, scene).build();
}

}  // namespace scenegen::gltf::reading
