#include "scene/gltf/build.h"
#include "scene/limits.h"

namespace scenegen::gltf::reading {

namespace {

void find_parents(const Document& document, const Place& nodes, std::vector<std::uint32_t>& parent) {
  parent.assign(document.nodes.size(), kNone);
  for (std::size_t i = 0; i < document.nodes.size(); ++i) {
    const Node& node = document.nodes[i];
    for (std::uint32_t k = 0; k < node.child_count; ++k) {
      const std::uint32_t child = document.children[node.first_child + k];
      const Place here = nodes.at(i);
      const Place list = here.key("children");
      check_index(child, document.nodes.size(), "nodes", list.at(k));
      if (child == i) reject(list.at(k), "the node is its own child");
      if (parent[child] != kNone) {
        reject(list.at(k), "node " + std::to_string(child) + " is already a child of node " +
                               std::to_string(parent[child]));
      }
      parent[child] = static_cast<std::uint32_t>(i);
    }
  }
}

/// Appends everything below order[begin …], level by level.
void descend(const Document& document, const Place& nodes, std::size_t begin,
             std::vector<std::uint32_t>& order) {
  std::size_t level_end = order.size();
  std::uint32_t depth = 1;
  for (std::size_t i = begin; i < order.size(); ++i) {
    if (i == level_end) {
      level_end = order.size();
      if (++depth > limits::kMaxNodeDepth) {
        reject(nodes.at(order[i]), "nodes nested deeper than " + std::to_string(limits::kMaxNodeDepth));
      }
    }
    const Node& node = document.nodes[order[i]];
    for (std::uint32_t k = 0; k < node.child_count; ++k)
      order.push_back(document.children[node.first_child + k]);
  }
}

}  // namespace

Hierarchy build_hierarchy(Document& document) {
  const Place root;
  const Place nodes = root.key("nodes");
  const Place scenes = root.key("scenes");
  Hierarchy out;
  find_parents(document, nodes, out.parent);
  const std::size_t count = document.nodes.size();
  if (document.scene != kNone)
    check_index(document.scene, document.scenes.size(), "scenes", root.key("scene"));
  std::vector<bool> listed(count, document.scenes.empty());
  out.order.reserve(count);
  if (document.scenes.empty()) {
    for (std::size_t i = 0; i < count; ++i) {
      if (out.parent[i] == kNone) out.order.push_back(static_cast<std::uint32_t>(i));
    }
  } else {
    const std::uint32_t shown = document.scene == kNone ? 0 : document.scene;
    const SceneRecord& scene = document.scenes[shown];
    const Place here = scenes.at(shown);
    const Place list = here.key("nodes");
    for (std::uint32_t k = 0; k < scene.root_count; ++k) {
      const std::uint32_t node = document.scene_roots[scene.first_root + k];
      check_index(node, count, "nodes", list.at(k));
      if (out.parent[node] != kNone) reject(list.at(k), "node " + std::to_string(node) + " is not a root");
      if (listed[node]) reject(list.at(k), "node " + std::to_string(node) + " is listed twice");
      listed[node] = true;
      out.order.push_back(node);
    }
    if (document.scenes.size() > 1) {
      document.ignored.add(scenes.at(shown == 0 ? 1 : 0), "scenes other than the one shown",
                           document.scenes.size() - 1);
    }
  }
  descend(document, nodes, 0, out.order);
  if (out.order.size() == count) return out;

  // What is left is outside the scene, or in a cycle.
  const std::size_t inside = out.order.size();
  std::uint32_t first_outside = kNone;
  for (std::size_t i = 0; i < count; ++i) {
    if (out.parent[i] != kNone || listed[i]) continue;
    if (first_outside == kNone) first_outside = static_cast<std::uint32_t>(i);
    out.order.push_back(static_cast<std::uint32_t>(i));
  }
  descend(document, nodes, inside, out.order);
  if (out.order.size() < count) {
    std::vector<bool> reached(count);
    for (const std::uint32_t node : out.order) reached[node] = true;
    std::size_t i = 0;
    while (reached[i]) ++i;
    reject(nodes.at(i), "the node is its own ancestor");
  }
  document.ignored.add(nodes.at(first_outside), "nodes outside the scene", count - inside);
  out.order.resize(inside);
  return out;
}

}  // namespace scenegen::gltf::reading
