// The steps of optimize(). Private to scene/optimize.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/optimize/optimize.h"

namespace scenegen::optimizing {

constexpr std::uint32_t kNone = 0xFFFFFFFFU;

/// Keys at which nothing changes go, constant tracks become values at rest, equal tracks become one; tracks
/// that nothing names go.
void simplify_tracks(Scene& scene, OptimizeReport& report);

/// Equal images, textures, materials (with equal tracks), geometries and meshes become one each.
void join_equal_content(Scene& scene, OptimizeReport& report);

/// Objects of stretched copies of a mesh show that mesh, stretched.
void join_stretched_meshes(Scene& scene, OptimizeReport& report);

/// Objects leave frames that do not move; frames that hold nothing go.
void leave_still_frames(Scene& scene, OptimizeReport& report);

/// What no object shows goes.
void prune_content(Scene& scene);

/// Gives every use of mesh i the number to[i]; keys of mesh tracks must not overlap in the pools.
void renumber_meshes(Scene& scene, const std::vector<std::uint32_t>& to);

/// Drops the entries of `items` whose `keep` is 0; where the others are now, kNone for those that went.
template <class T>
std::vector<std::uint32_t> keep_only(std::vector<T>& items, const std::vector<std::uint8_t>& keep) {
  std::vector<std::uint32_t> moved_to(items.size(), kNone);
  std::size_t next = 0;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (keep[i] == 0) continue;
    moved_to[i] = static_cast<std::uint32_t>(next);
    if (next != i) items[next] = std::move(items[i]);
    ++next;
  }
  items.erase(items.begin() + static_cast<std::ptrdiff_t>(next), items.end());
  return moved_to;
}

template <class IdType>
void renumber(IdType& id, const std::vector<std::uint32_t>& to) {
  if (id.valid()) id.value = to[id.value];
}

}  // namespace scenegen::optimizing
