// The dissertation's baseline "Occlusion queries and FC": every chunk in the frustum is asked about in every
// frame. Exact, unlike there: what was hidden some frames ago is drawn in a second part of the pass, under a
// predicate that this frame's own queries set, so nothing is ever missing and nobody waits for a result.
#include <algorithm>

#include "render/passes/occlusion.h"
#include "render/spatial/query_box.h"
#include "render/strategy/cached_octree.h"

namespace scenegen::render {
namespace {

class QueriesAll final : public CachedOctree {
 public:
  explicit QueriesAll(const StrategyContext& context) : CachedOctree(context) {
    exact_ = !context.options.late_visibility;
    if (exact_ && (!context.device.conditional_rendering || context.options.no_conditional_rendering)) {
      exact_ = false;
      warnings_.emplace_back(
          "the device has no conditional rendering; drawn as with --late-visibility: what comes into view "
          "may "
          "appear some frames too late");
    }
    for (std::unique_ptr<Occlusion>& of_pass : occlusion_)
      of_pass = std::make_unique<Occlusion>(context.device, exact_);
  }

 private:
  /// Of a chunk, in one kind of pass; counts for the revision it was found out about.
  struct Belief {
    std::uint64_t revision = 0;
    bool hidden = false;
  };

  void learn(const Occlusion::Answers& answers, std::vector<Belief>& beliefs) {
    for (std::size_t i = 0; i < answers.asked.size(); ++i) {
      const Asked& asked = answers.asked[i];
      const bool hidden = answers.samples[i] == 0;
      beliefs[asked.chunk] = {asked.revision, hidden};
      counters_.found_hidden += hidden ? 1 : 0;
      counters_.reveals += !hidden && asked.believed_hidden ? 1 : 0;
    }
  }

  /// Divides the chunks into those drawn first and those believed hidden, and says what to ask.
  void divide(const PassRecording& pass, const std::vector<Belief>& beliefs) {
    const glm::uvec2 size(pass.target().extent.width, pass.target().extent.height);
    const QueryBoxes boxes(view(), size);
    first_.clear();
    second_.clear();
    asked_.clear();
    for (const std::uint32_t number : chunks_) {
      const Octree::Chunk& chunk = tree().chunk(number);
      const Box box = boxes.grown(chunk.content.box_m);
      if (boxes.touches_eye(box)) {
        first_.push_back(number);
        continue;
      }
      const bool hidden = beliefs[number].hidden && beliefs[number].revision == chunk.revision;
      (hidden ? second_ : first_).push_back(number);
      asked_.push_back({number, chunk.revision, hidden, box});
    }
  }

  void execute(PassRecording& pass, const std::vector<std::uint32_t>& chunks, vk::CommandBuffer last = {}) {
    buffers_.clear();
    std::uint64_t draws = 0;
    std::uint64_t triangles = 0;
    for (const std::uint32_t chunk : chunks) {
      const CommandCache::Entry& entry = kept_[chunk];
      buffers_.push_back(entry.commands);
      draws += entry.draws;
      triangles += entry.triangles;
    }
    if (last) buffers_.push_back(last);
    pass.execute(buffers_, draws, triangles);
  }

  void draw_chunks(PassRecording& pass) override {
    const std::size_t kind = pass.target().pass == vkr::PassKind::color ? 0 : 1;
    Occlusion& occlusion = *occlusion_[kind];
    std::vector<Belief>& beliefs = beliefs_[kind];
    beliefs.resize(std::max(beliefs.size(), tree().chunk_numbers()));
    learn(occlusion.take_answers(pass.context()), beliefs);
    divide(pass, beliefs);

    occlusion.reserve(pass.context(), asked_.size(), tree().chunk_numbers());
    kept_.resize(tree().chunk_numbers());
    const auto fetch = [&](std::uint32_t chunk) {
      kept_[chunk] = commands(pass, chunk, occlusion.predicates());
    };
    std::for_each(first_.begin(), first_.end(), fetch);
    if (exact_) std::for_each(second_.begin(), second_.end(), fetch);
    counters_.queries += asked_.size();
    counters_.believed_hidden += second_.size();
    if (!exact_ && kind == 0) {
      for (const std::uint32_t chunk : second_) counters_.drawn -= tree().chunk(chunk).slots.size();
    }

    occlusion.begin_frame(pass.context(), asked_);
    const bool two_parts = exact_ && !second_.empty();
    if (two_parts) pass.in_two_parts();
    const vk::CommandBuffer boxes = asked_.empty() ? vk::CommandBuffer{} : occlusion.boxes(pass);
    execute(pass, first_, boxes);
    if (!two_parts) return;
    pass.end_first_part();
    occlusion.set_predicates(pass.context());
    execute(pass, second_);
  }

  bool exact_ = true;
  std::unique_ptr<Occlusion> occlusion_[2];  // by pass: colour, ids
  std::vector<Belief> beliefs_[2];           // by chunk
  std::vector<std::uint32_t> first_, second_;
  std::vector<Asked> asked_;
  std::vector<CommandCache::Entry> kept_;  // by chunk, of this pass
  std::vector<vk::CommandBuffer> buffers_;
};

}  // namespace

std::unique_ptr<Strategy> make_queries_all(const StrategyContext& context) {
  return std::make_unique<QueriesAll>(context);
}

}  // namespace scenegen::render
