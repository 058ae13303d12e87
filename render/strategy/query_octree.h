// What strategies that ask whether parts of the octree are hidden have in common.
#pragma once

#include <array>
#include <memory>

#include "render/spatial/query_box.h"
#include "render/strategy/cached_octree.h"
#include "render/strategy/query_plan.h"

namespace scenegen::render {

/// Exact, unlike the dissertation: what is believed hidden is drawn in a second part of the pass, under
/// predicates that this frame's own queries set, so nothing is ever missing and nobody waits for a result.
/// With late visibility it is not drawn at all. Derived classes say what to ask.
class QueryOctree : public CachedOctree {
 public:
  explicit QueryOctree(const StrategyContext& context);
  [[nodiscard]] model::FrameFacts facts() const override;
  [[nodiscard]] std::vector<ChunkBox> chunk_boxes() const override;
  void add_memory(MemoryAccount& to) const override;

 protected:
  /// Passes have a depth each, so each asks for itself.
  enum Kind : std::size_t { color, ids };
  static constexpr std::size_t kKinds = 2;
  void receive(Kind kind, const PassContext& context);

  /// Answers to what was asked some frames ago.
  virtual void learn(Kind kind, const Occlusion::Answers& answers) = 0;
  /// Divides chunks_. The plan is empty.
  virtual void choose(Kind kind, const QueryBoxes& boxes, QueryPlan& plan) = 0;

  /// Was it visible when it was asked about?
  [[nodiscard]] virtual bool known_visible(Kind kind, std::uint32_t chunk) const = 0;

  /// Nothing that is hidden is drawn too late.
  [[nodiscard]] bool exact() const { return exact_; }

 private:
  void draw_chunks(PassRecording& pass) final;
  [[nodiscard]] Predicates predicates() const;
  /// What facts and boxes are about.
  [[nodiscard]] Kind main_kind() const {
    return plans_[color].first.empty() && plans_[color].second.empty() ? ids : color;
  }

  bool exact_ = true;
  std::array<std::unique_ptr<Occlusion>, kKinds> occlusion_;
  std::array<QueryPlan, kKinds> plans_;  // of the last frame
};

}  // namespace scenegen::render
