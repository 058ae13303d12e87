// D method 2: chunks in the frustum are drawn from kept commands.
#include "render/strategy/cached_octree.h"

namespace scenegen::render {
namespace {

class OctreeStrategy final : public CachedOctree {
 public:
  using CachedOctree::CachedOctree;

 private:
  void draw_chunks(PassRecording& pass) override {
    prepare(pass, chunks_);
    draw(pass, chunks_);
  }
};

}  // namespace

std::unique_ptr<Strategy> make_octree(const StrategyContext& context) {
  return std::make_unique<OctreeStrategy>(context);
}

}  // namespace scenegen::render
