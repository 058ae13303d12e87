// The dissertation's baseline "Frustum Culling": chunks of the octree are culled, and what is left of them is
// recorded each frame.
#include "render/spatial/scene_octree.h"
#include "render/strategy/estimate_load.h"
#include "render/strategy/list_strategy.h"
#include "render/strategy/octree_choice.h"

namespace scenegen::render {
namespace {

class OctreeRecord final : public ListStrategy {
 public:
  OctreeRecord(const StrategyContext& context, std::uint32_t objects_per_node)
      : ListStrategy(context), octree_(context.scene, objects_per_node) {}

  void update(const timeline::ChangeSet& changes) override {
    ListStrategy::update(changes);
    const Octree::Refreshed before = octree_.tree().refreshed();
    octree_.update(changes);
    refreshed_ = octree_.tree().refreshed().since(before);
  }

  void plan(const View& view) override {
    const CullPlanes planes = cull_planes(frustum_of(view.clip_from_world), scene_.bounds_m());
    const Octree& tree = octree_.tree();
    list_blended_in_frustum(scene_, planes, list_);
    chunks_.clear();
    OctreeCounters found;
    tree.cull(planes, view.eye_m(), chunks_, found);
    // Recorded in order of slots, as every strategy that records does: state changes least often then.
    inside_.assign((scene_.slot_count() + 63) / 64, 0);
    for (const std::uint32_t chunk : chunks_) {
      for (const std::uint32_t slot : tree.chunk(chunk).slots)
        inside_[slot / 64] |= std::uint64_t{1} << (slot % 64);
    }
    list_solid(scene_, inside_, list_);
    list_.tested += found.tests;
    finish_plan(view);
    counters_.nodes = found.nodes;
    counters_.chunks = chunks_.size();
    counters_.tree_nodes = tree.node_count();
    counters_.refreshed_chunks = refreshed_.chunks;
    counters_.refreshed_slots = refreshed_.slots;
    boxes_tested_ = found.tests;
  }

  [[nodiscard]] model::FrameFacts facts() const override {
    model::FrameFacts facts = ListStrategy::facts();
    const Octree& tree = octree_.tree();
    facts.height = model::octree_height(tree.root().content.slots, tree.slots_per_node());
    facts.chunks_refreshed = static_cast<double>(refreshed_.chunks);
    facts.slots_refreshed = static_cast<double>(refreshed_.slots);
    facts.nodes_visited = static_cast<double>(counters_.nodes);
    facts.boxes_tested = static_cast<double>(boxes_tested_);
    facts.chunks = static_cast<double>(chunks_.size());
    facts.in_chunks = load_of_chunks(scene_, tree, chunks_, ScreenArea(view_, size_));
    // Nothing is kept: what keeping would have recorded is not known.
    facts.exact_octree = true;
    return facts;
  }

  void add_memory(MemoryAccount& to) const override {
    ListStrategy::add_memory(to);
    to.add_host(MemoryKind::octree, octree_.memory_bytes());
    to.add_host(MemoryKind::lists, held_bytes(chunks_, inside_));
  }

 private:
  SceneOctree octree_;
  std::vector<std::uint32_t> chunks_;
  std::vector<std::uint64_t> inside_;
  std::uint64_t boxes_tested_ = 0;
  Octree::Refreshed refreshed_;
};

}  // namespace

std::unique_ptr<Strategy> make_octree_record(const StrategyContext& context) {
  // Nothing is cached, so nothing has to fit but the tree.
  const std::uint32_t wanted = context.options.objects_per_node;
  return std::make_unique<OctreeRecord>(context, wanted != 0 ? wanted : kObjectsPerNode);
}

}  // namespace scenegen::render
