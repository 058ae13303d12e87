#include "tools/experiments/late_queries.h"

#include <algorithm>
#include <deque>

namespace scenegen::tools {
namespace {

struct Answer {
  std::uint32_t node;
  bool hidden;
};

void believe(const FlatTree& tree, const std::vector<Answer>& answers, std::vector<std::uint8_t>& hidden) {
  for (const Answer& a : answers) {
    hidden[a.node] = a.hidden ? 1 : 0;
    if (!a.hidden) continue;
    // What is below is asked afresh once this is seen again.
    std::fill(hidden.begin() + a.node + 1, hidden.begin() + tree.nodes[a.node].end, std::uint8_t{0});
  }
}

}  // namespace

LateWalk walk_with_late_queries(const FlatTree& tree, std::span<const render::View> views,
                                std::span<const SoftwareDepth> depths, std::size_t objects,
                                const LateWalkOptions& options) {
  LateWalk sum;
  std::vector<std::uint8_t> hidden(tree.nodes.size(), 0);
  std::vector<std::uint8_t> shown(objects, 0);
  std::deque<std::vector<Answer>> pending;
  double counted = 0;
  const Box all = tree.nodes.empty() ? Box{} : tree.nodes.front().box_m;
  for (std::size_t frame = 0; frame < views.size(); ++frame) {
    if (pending.size() > options.latency) {
      believe(tree, pending.front(), hidden);
      pending.pop_front();
    }
    const render::CullPlanes planes =
        render::cull_planes(render::frustum_of(views[frame].clip_from_world), all);
    std::vector<Answer>& asked = pending.emplace_back();
    std::fill(shown.begin(), shown.end(), std::uint8_t{0});
    std::uint64_t objects_shown = 0;
    walk(
        tree,
        [&](std::uint32_t i) {
          const FlatTree::Node& node = tree.nodes[i];
          if (!in_frustum(planes, node.box_m)) return false;
          asked.push_back({i, !depths[frame].visible(node.box_m)});
          return hidden[i] == 0;
        },
        [&](std::uint32_t i) {
          const FlatTree::Node& node = tree.nodes[i];
          objects_shown += node.own_end - node.first;
          for (std::uint32_t k = node.first; k < node.own_end; ++k) shown[tree.objects[k]] = 1;
        });
    if (frame < options.warm_up) continue;
    ++counted;
    sum.shown += static_cast<double>(objects_shown);
    sum.queries += static_cast<double>(asked.size());
    for (const std::uint32_t o : depths[frame].visible_objects()) sum.missed += shown[o] == 0 ? 1 : 0;
  }
  if (counted > 0) sum = {sum.shown / counted, sum.missed / counted, sum.queries / counted};
  return sum;
}

}  // namespace scenegen::tools
