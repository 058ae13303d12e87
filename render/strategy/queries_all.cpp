// The dissertation's baseline "Occlusion queries and FC": every chunk in the frustum is asked about in every
// frame.
#include <algorithm>
#include <utility>

#include "render/strategy/query_octree.h"

namespace scenegen::render {
namespace {

class QueriesAll final : public QueryOctree {
 public:
  using QueryOctree::QueryOctree;

  [[nodiscard]] model::FrameFacts facts() const override {
    model::FrameFacts facts = QueryOctree::facts();
    facts.all_asked_fragments = std::exchange(facts.asked_fragments, 0.0);
    facts.all_chunks_hidden = std::exchange(facts.chunks_hidden, 0.0);
    facts.all_hidden = std::exchange(facts.hidden, {});
    facts.asked = 0.0;
    return facts;
  }

  void add_memory(MemoryAccount& to) const override {
    QueryOctree::add_memory(to);
    for (const std::vector<Belief>& beliefs : beliefs_) to.add_host(MemoryKind::queries, held_bytes(beliefs));
  }

 private:
  /// Of a chunk, in one kind of pass; counts for the revision it was found out about.
  struct Belief {
    std::uint64_t revision = 0;
    bool hidden = false;
  };

  void learn(Kind kind, const Occlusion::Answers& answers) override {
    std::vector<Belief>& beliefs = beliefs_[kind];
    beliefs.resize(std::max(beliefs.size(), tree().chunk_numbers()));
    for (std::size_t i = 0; i < answers.asked.size(); ++i) {
      const Asked& asked = answers.asked[i];
      beliefs[asked.number] = {asked.revision, answers.samples[i] == 0};
    }
  }

  void choose(Kind kind, const QueryBoxes& boxes, QueryPlan& plan) override {
    for (const std::uint32_t number : chunks_) {
      const Octree::Chunk& chunk = tree().chunk(number);
      const Box box = boxes.grown(chunk.content.box_m);
      if (boxes.touches_eye(box)) {
        plan.first.push_back(number);
        continue;
      }
      const Belief& belief = beliefs_[kind][number];
      const bool hidden = belief.hidden && belief.revision == chunk.revision;
      const std::uint32_t query = plan.ask({number, chunk.revision, hidden, box});
      if (hidden) plan.governed.push_back({query, number});
      (hidden ? plan.second : plan.first).push_back(number);
    }
  }

  [[nodiscard]] bool known_visible(Kind kind, std::uint32_t chunk) const override {
    const Belief& belief = beliefs_[kind][chunk];
    return belief.revision == tree().chunk(chunk).revision && !belief.hidden;
  }

  std::array<std::vector<Belief>, kKinds> beliefs_;  // by chunk
};

}  // namespace

std::unique_ptr<Strategy> make_queries_all(const StrategyContext& context) {
  return std::make_unique<QueriesAll>(context);
}

}  // namespace scenegen::render
