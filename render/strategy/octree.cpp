// D method 2: chunks in the frustum are executed from kept commands.
#include "render/strategy/cached_octree.h"

namespace scenegen::render {
namespace {

class OctreeStrategy final : public CachedOctree {
 public:
  using CachedOctree::CachedOctree;

 private:
  void draw_chunks(PassRecording& pass) override {
    buffers_.clear();
    std::uint64_t draws = 0;
    std::uint64_t triangles = 0;
    for (const std::uint32_t chunk : chunks_) {
      const CommandCache::Entry& entry = commands(pass, chunk);
      buffers_.push_back(entry.commands);
      draws += entry.draws;
      triangles += entry.triangles;
    }
    pass.execute(buffers_, draws, triangles);
  }

  std::vector<vk::CommandBuffer> buffers_;
};

}  // namespace

std::unique_ptr<Strategy> make_octree(const StrategyContext& context) {
  return std::make_unique<OctreeStrategy>(context);
}

}  // namespace scenegen::render
