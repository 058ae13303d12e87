// D method 3: occlusion queries where they pay, as many as pay (D 3.2).
#include "render/strategy/query_chooser.h"
#include "render/strategy/query_octree.h"

namespace scenegen::render {
namespace {

// Weight of a frame in alpha_n, a mean over the last ones.
constexpr double kNewest = 0.1;

class Queries final : public QueryOctree {
 public:
  explicit Queries(const StrategyContext& context) : QueryOctree(context) {
    const QueryChooser::Settings settings{exact(), indirect(), context.frames_in_flight > 1,
                                          context.frames_in_flight};
    for (std::size_t kind = 0; kind < kKinds; ++kind) choosers_.emplace_back(settings);
  }

  void put_off_queries(bool yes) override {
    for (QueryChooser& chooser : choosers_) chooser.rest(yes);
  }

  void add_memory(MemoryAccount& to) const override {
    QueryOctree::add_memory(to);
    for (const QueryChooser& chooser : choosers_) to.add_host(MemoryKind::queries, chooser.memory_bytes());
  }

 private:
  void learn(Kind kind, const Occlusion::Answers& answers) override {
    choosers_[kind].learn(answers.asked, answers.samples);
  }

  void choose(Kind kind, const QueryBoxes& boxes, QueryPlan& plan) override {
    rerecorded_share_ += kNewest * (changed_share() - rerecorded_share_);
    // Changes slowly: looked at now and then.
    if (plans_made_++ % 16 == 1) commands_per_draw_ = per_draw().commands > 0.0 ? per_draw().commands : 1.0;
    const ScreenArea screen(view(), context_.size);
    choosers_[kind].choose(
        {tree(), visits_, chunks_, boxes, screen, context_.costs, rerecorded_share_, commands_per_draw_},
        plan);
  }

  [[nodiscard]] bool known_visible(Kind kind, std::uint32_t chunk) const override {
    return choosers_[kind].known_visible(chunk);
  }

  std::vector<QueryChooser> choosers_;  // by kind of pass
  double rerecorded_share_ = 0;         // alpha_n
  double commands_per_draw_ = 1;
  std::uint64_t plans_made_ = 0;
};

}  // namespace

std::unique_ptr<Strategy> make_queries(const StrategyContext& context) {
  return std::make_unique<Queries>(context);
}

}  // namespace scenegen::render
