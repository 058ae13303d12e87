#include "scene/gltf/write_instances.h"

#include <cstring>
#include <unordered_map>

#include "scene/gltf/write_names.h"

namespace scenegen::gltf {

namespace {

/// Finds sets with equal values of one member of their objects' transforms; nothing is copied.
template <class Member>
class SharedValues {
 public:
  SharedValues(const Scene& scene, const NodePlan& nodes, Member Transform::*member)
      : scene_(scene), nodes_(nodes), member_(member) {}

  /// The first set with the values of `set`: itself, if none before it has them.
  std::uint32_t first_with(std::uint32_t set) {
    std::vector<std::uint32_t>& candidates = known_[hash(nodes_.sets[set])];
    for (const std::uint32_t candidate : candidates) {
      if (equal(nodes_.sets[candidate], nodes_.sets[set])) return candidate;
    }
    candidates.push_back(set);
    return set;
  }

 private:
  [[nodiscard]] const Member& value(const InstanceSet& set, std::uint32_t k) const {
    return scene_.objects.frame_from_object[nodes_.grouped[set.first + k]].*member_;
  }
  [[nodiscard]] std::uint64_t hash(const InstanceSet& set) const {
    std::uint64_t hash = 0xCBF29CE484222325ULL;  // FNV-1a, by words
    for (std::uint32_t k = 0; k < set.count; ++k) {
      std::uint32_t words[sizeof(Member) / 4];
      std::memcpy(words, &value(set, k), sizeof words);
      for (const std::uint32_t word : words) hash = (hash ^ word) * 0x100000001B3ULL;
    }
    return hash;
  }
  [[nodiscard]] bool equal(const InstanceSet& a, const InstanceSet& b) const {
    if (a.count != b.count) return false;
    for (std::uint32_t k = 0; k < a.count; ++k) {
      if (std::memcmp(&value(a, k), &value(b, k), sizeof(Member)) != 0) return false;
    }
    return true;
  }

  const Scene& scene_;
  const NodePlan& nodes_;
  Member Transform::*member_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> known_;
};

}  // namespace

std::vector<InstanceAccessors> number_instance_accessors(const Scene& scene, const NodePlan& nodes,
                                                         std::uint32_t& first) {
  std::vector<InstanceAccessors> out(nodes.sets.size());
  SharedValues<glm::quat> rotations(scene, nodes, &Transform::rotation);
  SharedValues<glm::vec3> scales(scene, nodes, &Transform::scale);
  for (std::uint32_t s = 0; s < out.size(); ++s) {
    const InstanceSet& set = nodes.sets[s];
    out[s].translation = first++;
    if (set.rotated) {
      const std::uint32_t other = rotations.first_with(s);
      out[s].own_rotation = other == s;
      out[s].rotation = other == s ? first++ : out[other].rotation;
    }
    if (set.scaled) {
      const std::uint32_t other = scales.first_with(s);
      out[s].own_scale = other == s;
      out[s].scale = other == s ? first++ : out[other].scale;
    }
    if (!nodes.id_table) out[s].object_id = first++;
  }
  return out;
}

void write_id_table(const NodePlan& nodes, ByteSink& sink) {
  std::int64_t before = 0;
  for (const std::uint32_t object : nodes.grouped) {
    const std::int64_t difference = std::int64_t{object} - before;
    write_leb128(static_cast<std::uint64_t>((difference << 1) ^ (difference >> 63)), sink);
    before = object;
  }
}

}  // namespace scenegen::gltf
