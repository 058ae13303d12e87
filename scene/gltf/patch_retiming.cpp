#include <algorithm>

#include "scene/gltf/patch_plan.h"

namespace scenegen::gltf::patching {

using reading::Path;

Retiming find_retiming(const PatchInput& input) {
  const reading::Document& document = input.document;
  const Scene& scene = input.scene;
  Retiming out;
  const auto& before = input.source.visibility_of_object;
  const std::size_t count = scene.objects.size();
  out.retimed.assign(count, 0);
  bool any = false;
  for (std::size_t i = 0; i < count; ++i) {
    const TrackId former = before.empty() ? TrackId() : before[i];
    out.retimed[i] = scene.objects.visibility[i] != former ? 1 : 0;
    any = any || out.retimed[i] != 0;
  }
  if (!any) return out;
  std::vector<std::uint8_t> hides(document.nodes.size(), 0);
  bool file_hides = false;
  const auto hide = [&](std::uint32_t node) { hides[node] = 1, file_hides = true; };
  for (const auto& scaled : input.source.scale_visibility) hide(scaled.node);
  for (const reading::Channel& channel : document.channels) {
    if (channel.path == Path::visibility) hide(channel.target);
  }
  for (std::uint32_t n = 0; n < document.nodes.size(); ++n) {
    if (!document.nodes[n].visible) hide(n);
  }
  if (!file_hides) return out;

  std::vector<std::uint8_t> touched(document.nodes.size(), 0);  // at or above an object with new times
  for (std::size_t i = 0; i < count; ++i) {
    if (out.retimed[i] == 0) continue;
    for (std::uint32_t n = input.source.node_of_object[i]; n != kNone && touched[n] == 0;
         n = input.hierarchy.parent[n])
      touched[n] = 1;
  }
  std::vector<std::uint8_t> below(document.nodes.size(), 0);
  for (const std::uint32_t n : input.hierarchy.order) {
    const std::uint32_t parent = input.hierarchy.parent[n];
    const bool dropped = hides[n] != 0 && touched[n] != 0;
    below[n] = dropped || (parent != kNone && below[parent] != 0) ? 1 : 0;
    if (!dropped) continue;
    out.dropped.push_back(n);
    if (!document.nodes[n].visible) out.invisible.push_back(n);
  }
  std::sort(out.dropped.begin(), out.dropped.end());
  out.pushed.assign(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    if (out.retimed[i] == 0 && scene.objects.visibility[i].valid())
      out.pushed[i] = below[input.source.node_of_object[i]];
  }
  return out;
}

std::span<const std::pair<std::uint32_t, std::uint32_t>> NodePatch::added_to(std::uint32_t parent) const {
  const auto before = [](const auto& a, std::uint32_t p) { return a.first < p; };
  const auto first = std::lower_bound(added.begin(), added.end(), parent, before);
  auto last = first;
  while (last != added.end() && last->first == parent) ++last;
  return {first, last};
}

}  // namespace scenegen::gltf::patching
