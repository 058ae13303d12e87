// D 5.5's second method: as `inline`, with an occlusion query for every object in the frustum, read some
// frames later. What was hidden then is not drawn now, so what comes into view appears too late: for
// comparison only.
#include <array>
#include <memory>

#include "render/passes/occlusion.h"
#include "render/spatial/query_box.h"
#include "render/strategy/estimate_load.h"
#include "render/strategy/list_strategy.h"

namespace scenegen::render {
namespace {

class InlineQueries final : public ListStrategy {
 public:
  explicit InlineQueries(const StrategyContext& context)
      : ListStrategy(context), revisions_(context.scene.slot_count()) {
    for (Pass& pass : passes_) {
      pass.occlusion = std::make_unique<Occlusion>(context.device, Predicates::none);
      pass.verdicts.resize(context.scene.slot_count());
    }
  }

  void update(const timeline::ChangeSet& changes) override {
    ListStrategy::update(changes);
    // What is known of a slot that changed, or will be told of it, is of another picture.
    for (const std::span<const ObjectId> ids :
         {changes.shown, changes.hidden, changes.moved, changes.remeshed}) {
      for (const ObjectId id : ids) {
        for (const std::uint32_t slot : scene_.slots_of(id)) ++revisions_[slot];
      }
    }
  }

  void plan(const View& view) override {
    ++frame_;
    list_in_frustum(scene_, cull_planes(frustum_of(view.clip_from_world), scene_.bounds_m()), list_);
    finish_plan(view);
  }

  void draw_solid(PassRecording& recording) override {
    const PassContext& context = recording.context();
    const bool color = recording.target().pass == vkr::PassKind::color;
    Pass& pass = passes_[color ? 0 : 1];
    {
      const StageTimer timer(counters_.receive_ms);
      learn(pass, pass.occlusion->take_answers(context));
    }
    ask(pass, recording);
    counters_.queries += pass.asked.size();
    counters_.believed_hidden += pass.hidden.size();
    if (color) counters_.drawn -= pass.hidden.size();
    DrawRecorder& recorder = recording.draws();
    for (const std::uint32_t slot : pass.drawn) recorder.draw(slot);
    const StageTimer timer(counters_.ask_ms);
    pass.occlusion->draw_boxes(recording);
  }

  [[nodiscard]] model::FrameFacts facts() const override {
    model::FrameFacts facts = ListStrategy::facts();
    const Pass& pass = passes_[passes_[0].drawn.empty() && passes_[0].hidden.empty() ? 1 : 0];
    const ScreenArea screen(view_, size_);
    facts.in_frustum = load();
    facts.slots_hidden = load_of_slots(scene_, pass.hidden, screen);
    facts.exact_inline = true;
    facts.exact_queries = true;
    return facts;
  }

  void add_memory(MemoryAccount& to) const override {
    ListStrategy::add_memory(to);
    std::uint64_t bytes = held_bytes(revisions_);
    for (const Pass& pass : passes_)
      bytes +=
          held_bytes(pass.verdicts, pass.asked, pass.drawn, pass.hidden) + pass.occlusion->memory_bytes();
    to.add_host(MemoryKind::queries, bytes);
  }

 private:
  /// Frames after which an answer is too old: the slot was out of the frustum in between.
  static constexpr std::uint32_t kOld = 8;

  struct Verdict {
    std::uint32_t revision = 0;
    std::uint32_t asked = 0;  // frame; 0: never found hidden
  };
  struct Pass {
    std::unique_ptr<Occlusion> occlusion;
    std::vector<Verdict> verdicts;  // by slot
    std::vector<Asked> asked;
    std::vector<std::uint32_t> drawn, hidden;
  };

  void ask(Pass& pass, const PassRecording& recording) {
    const StageTimer timer(counters_.ask_ms);
    const PassContext& context = recording.context();
    choose(pass, {recording.target().extent.width, recording.target().extent.height});
    pass.occlusion->reserve(context, pass.asked.size(), 0);
    pass.occlusion->begin_frame(context, pass.asked, {});
  }

  void learn(Pass& pass, const Occlusion::Answers& answers) {
    counters_.answers += answers.asked.size();
    for (std::size_t i = 0; i < answers.asked.size(); ++i) {
      const Asked& asked = answers.asked[i];
      const bool hidden = answers.samples[i] == 0;
      counters_.found_hidden += hidden ? 1 : 0;
      counters_.reveals += !hidden && asked.believed_hidden ? 1 : 0;
      const auto revision = static_cast<std::uint32_t>(asked.revision);
      if (revision == revisions_[asked.number]) pass.verdicts[asked.number] = {revision, hidden ? frame_ : 0};
    }
  }

  void choose(Pass& pass, glm::uvec2 size) const {
    const QueryBoxes boxes(view_, size);
    pass.asked.clear();
    pass.drawn.clear();
    pass.hidden.clear();
    for (const std::uint32_t slot : list_.solid) {
      const Box box = boxes.grown(scene_.boxes().get(slot));
      if (boxes.touches_eye(box)) {
        pass.drawn.push_back(slot);
        continue;
      }
      const Verdict& verdict = pass.verdicts[slot];
      const bool hidden =
          verdict.asked != 0 && verdict.revision == revisions_[slot] && frame_ - verdict.asked < kOld;
      (hidden ? pass.hidden : pass.drawn).push_back(slot);
      pass.asked.push_back({slot, revisions_[slot], hidden, box});
    }
  }

  std::uint32_t frame_ = 0;
  std::vector<std::uint32_t> revisions_;  // by slot
  std::array<Pass, 2> passes_;            // colour, ids
};

}  // namespace

std::unique_ptr<Strategy> make_inline_queries(const StrategyContext& context) {
  return std::make_unique<InlineQueries>(context);
}

}  // namespace scenegen::render
