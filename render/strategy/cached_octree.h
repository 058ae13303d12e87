// What strategies that keep the commands of octree chunks have in common.
#pragma once

#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/passes/command_cache.h"
#include "render/passes/indirect_nodes.h"
#include "render/passes/occlusion.h"
#include "render/spatial/scene_octree.h"
#include "render/strategy/draw_list.h"
#include "render/strategy/strategy.h"

namespace scenegen::render {

/// Chunks of the octree are culled, and the draw commands of each are kept until its slots change: in a
/// secondary command buffer, or in device memory for indirect draws (NodeForm). Without memory for that it
/// goes on as `inline`. Derived classes say what is done with the chunks in the frustum.
class CachedOctree : public Strategy {
 public:
  explicit CachedOctree(const StrategyContext& context);
  void update(const timeline::ChangeSet& changes) override;
  void plan(const View& view) override;
  void draw_solid(PassRecording& pass) override;
  void draw_blended(DrawRecorder& recorder) override;
  void resized(glm::uvec2 size) override;
  [[nodiscard]] model::FrameFacts facts() const override;
  [[nodiscard]] std::vector<ChunkBox> chunk_boxes() const override;
  void add_memory(MemoryAccount& to) const override;

  // For a strategy that draws some frames in another way; in the others it calls update() and plan() as
  // usual.
  /// Instead of update(), in a frame that is drawn otherwise: the changes are put off.
  void note(const timeline::ChangeSet& changes);
  /// Does about `slots` slots' worth of what was put off, or of building the tree; true when nothing is left.
  /// Only then may plan() be called. Also true when memory ran out: see available().
  bool catch_up(std::size_t slots);
  /// False: there was no memory for it, plan() goes on as `inline`.
  [[nodiscard]] bool available() const { return !inline_; }
  /// Objects a node holds.
  [[nodiscard]] std::uint32_t objects_per_node() const { return objects_per_node_; }
  [[nodiscard]] bool behind() const { return octree_ && octree_->behind(); }
  [[nodiscard]] std::size_t pending() const { return octree_ ? octree_->pending() : 0; }
  /// What bringing chunks up to date did since the beginning.
  [[nodiscard]] Octree::Refreshed refreshed() const {
    return octree_ ? octree_->tree().refreshed() : Octree::Refreshed{};
  }
  /// Queries, if it asks any, are put off for about 128 frames, or until far more or less is in the frustum;
  /// or no longer.
  virtual void put_off_queries(bool /*yes*/) {}
  /// After plan(), before anything is drawn: what drawing the octree would find. All of it is exact but the
  /// fragments. Fills the octree's part of `facts`.
  void foresee(model::FrameFacts& facts) const;
  /// Of indirect draws, as far as they are kept: commands a slot, and commands of the processor a chunk; 0:
  /// not known.
  struct PerDraw {
    double commands = 0, runs = 0;
  };
  [[nodiscard]] PerDraw per_draw() const;
  /// Draws recorded anew in the last frame, for one pass.
  [[nodiscard]] double rerecorded_draws() const {
    return static_cast<double>(counters_.recorded_draws) / recordings();
  }

 protected:
  /// Draws the chunks in the frustum, `chunks_`. What needs memory comes first: when it throws for want of
  /// it, the pass must not have begun.
  virtual void draw_chunks(PassRecording& pass) = 0;

  /// Runs `body`. When memory of the host or the device runs out in it, the octree is let go, `inline` takes
  /// over with a warning, and false comes back; but what has begun of `pass` cannot be taken back, then it
  /// throws.
  template <class Body>
  bool unless_out_of_memory(const Body& body, const PassRecording* pass = nullptr) {
    try {
      body();
      return true;
    } catch (const std::exception& e) {
      if (!out_of_memory(e) || (pass != nullptr && pass->begun())) throw;
      octree_.reset();  // what is kept may still be running: it stays until the end
      give_up(std::string("no memory for kept commands (") + e.what() + ")");
      return false;
    }
  }

  /// Before a pass begins: makes the commands of these chunks ready. With `predicates` they can be drawn
  /// under them.
  void prepare(PassRecording& pass, std::span<const std::uint32_t> chunks, vk::Buffer predicates = {});
  /// Draws prepared chunks, then boxes if something is to be asked.
  void draw(PassRecording& pass, std::span<const std::uint32_t> chunks, Occlusion* ask = nullptr);
  /// The same in the second part of a pass, where its predicates say so.
  void draw_under(PassRecording& pass, std::span<const std::uint32_t> chunks, const Occlusion& predicates);

  /// Share of the chunks in the frustum that had to be recorded in the last frame: alpha_n.
  [[nodiscard]] double changed_share() const { return changed_share_; }
  /// Chunks are drawn by indirect draws, else from secondaries.
  [[nodiscard]] bool indirect() const { return indirect_form_; }
  [[nodiscard]] const Octree& tree() const { return octree_->tree(); }
  [[nodiscard]] const View& view() const { return view_; }

  StrategyContext context_;
  const DrawScene& scene_;
  std::vector<std::uint32_t> chunks_;  ///< in the frustum; nearer ones first, roughly
  std::vector<OctreeVisit> visits_;    ///< nodes they are in

 private:
  [[nodiscard]] static bool out_of_memory(const std::exception& error);
  void choose_form();
  /// How often a chunk was recorded that changed: secondaries once a pass, indirect draws once a frame.
  [[nodiscard]] double recordings() const { return indirect_form_ || passes_ < 2 ? 1.0 : passes_; }
  void give_up(const std::string& why);
  void plan_chunks();
  void plan_inline();
  void keep_secondaries(PassRecording& pass, std::span<const std::uint32_t> chunks, vk::Buffer predicates);
  void execute(PassRecording& pass, std::span<const std::uint32_t> chunks, vk::CommandBuffer last);
  [[nodiscard]] std::uint32_t in_order(std::span<const std::uint32_t> chunks, std::size_t i) const {
    return chunks[context_.options.reversed ? chunks.size() - 1 - i : i];
  }

  View view_;
  std::uint32_t objects_per_node_ = 0;
  OctreeCounters found_;
  double changed_share_ = 0;
  std::size_t changed_ = 0;  // in the last update
  Octree::Refreshed refreshed_;
  std::uint32_t passes_ = 0;  // drawn since the plan
  bool indirect_form_ = false;
  std::optional<SceneOctree> octree_;
  std::optional<CommandCache> cache_;
  std::optional<IndirectNodes> nodes_;
  std::unique_ptr<Strategy> inline_;  // when there is no memory for the rest
  DrawList list_;                     // blended only
  std::vector<std::uint32_t> reversed_;
  std::vector<CommandCache::Entry> kept_;  // by chunk, of this pass
  std::vector<vk::CommandBuffer> buffers_;
  std::int64_t process_growth_ = 0;  // while commands were recorded, bytes
};

}  // namespace scenegen::render
