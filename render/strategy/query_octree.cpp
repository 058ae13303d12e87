#include "render/strategy/query_octree.h"

#include "render/strategy/estimate_load.h"
#include "render/strategy/octree_choice.h"

namespace scenegen::render {

QueryOctree::QueryOctree(const StrategyContext& context) : CachedOctree(context) {
  exact_ = !context.options.late_visibility;
  const bool conditional = context.device.conditional_rendering && !context.options.no_conditional_rendering;
  if (exact_ && !indirect() && !conditional) {
    exact_ = false;
    warnings_.emplace_back(
        "the device has no conditional rendering, which --node-form secondaries needs; drawn as with "
        "--late-visibility: what comes into view may appear some frames too late");
  }
  if (!available()) return;
  (void)unless_out_of_memory([&] {
    for (std::unique_ptr<Occlusion>& of_pass : occlusion_)
      of_pass = std::make_unique<Occlusion>(context.device, predicates());
  });
}

Predicates QueryOctree::predicates() const {
  if (!exact_) return Predicates::none;
  return indirect() ? Predicates::counts : Predicates::conditional;
}

void QueryOctree::draw_chunks(PassRecording& pass) {
  const PassContext& context = pass.context();
  const Kind kind = pass.target().pass == vkr::PassKind::color ? color : ids;
  Occlusion& occlusion = *occlusion_[kind];
  receive(kind, context);
  QueryPlan& plan = plans_[kind];
  {
    const StageTimer timer(counters_.ask_ms);
    plan.clear(chunks_.size());
    choose(kind, QueryBoxes(view(), {pass.target().extent.width, pass.target().extent.height}), plan);
    occlusion.reserve(context, plan.asked.size(), tree().chunk_numbers());
  }
  counters_.queries += plan.queries;
  for (const Asked& asked : plan.asked) counters_.believed_hidden += asked.believed_hidden ? 1 : 0;
  if (!exact_ && kind == color) {
    for (const std::uint32_t chunk : plan.second) counters_.drawn -= tree().chunk(chunk).slots.size();
  }

  prepare(pass, plan.first, occlusion.predicates());
  if (exact_) prepare(pass, plan.second, occlusion.predicates());
  {
    const StageTimer timer(counters_.ask_ms);
    occlusion.begin_frame(context, plan.asked, plan.governed);
  }
  const bool two_parts = exact_ && !plan.second.empty();
  if (two_parts) pass.in_two_parts();
  draw(pass, plan.first, &occlusion);
  if (!two_parts) return;
  pass.end_first_part();
  {
    const StageTimer timer(counters_.ask_ms);
    occlusion.set_predicates(context);
  }
  draw_under(pass, plan.second, occlusion);
}

void QueryOctree::receive(Kind kind, const PassContext& context) {
  const StageTimer timer(counters_.receive_ms);
  const Occlusion::Answers answers = occlusion_[kind]->take_answers(context);
  counters_.answers += query_count(answers.asked);
  for (std::size_t i = 0; i < answers.asked.size(); ++i) {
    if (answers.asked[i].with_previous) continue;
    const bool hidden = answers.samples[i] == 0;
    counters_.found_hidden += hidden ? 1 : 0;
    counters_.reveals += !hidden && answers.asked[i].believed_hidden ? 1 : 0;
  }
  learn(kind, answers);
}

std::vector<ChunkBox> QueryOctree::chunk_boxes() const {
  std::vector<ChunkBox> out = CachedOctree::chunk_boxes();
  if (out.empty()) return out;  // it may have given up
  out.clear();
  const Kind kind = main_kind();
  for (const std::uint32_t chunk : plans_[kind].first) {
    out.push_back({tree().chunk(chunk).content.box_m,
                   known_visible(kind, chunk) ? ChunkVerdict::visible : ChunkVerdict::not_asked});
  }
  for (const std::uint32_t chunk : plans_[kind].second)
    out.push_back({tree().chunk(chunk).content.box_m, ChunkVerdict::hidden});
  return out;
}

model::FrameFacts QueryOctree::facts() const {
  model::FrameFacts facts = CachedOctree::facts();
  if (!facts.exact_octree) return facts;  // it gave up
  const QueryPlan& plan = plans_[main_kind()];
  const ScreenArea screen(view(), context_.size);
  facts.asked = plan.queries;
  for (const Asked& asked : plan.asked) facts.asked_fragments += screen.fragments(asked.box_m);
  facts.chunks_hidden = static_cast<double>(plan.second.size());
  facts.hidden = load_of_chunks(scene_, tree(), plan.second, screen);
  facts.exact_queries = true;
  return facts;
}

void QueryOctree::add_memory(MemoryAccount& to) const {
  CachedOctree::add_memory(to);
  std::uint64_t bytes = 0;
  for (const std::unique_ptr<Occlusion>& of_pass : occlusion_) {
    if (of_pass) bytes += of_pass->memory_bytes();  // none once the tree was given up
  }
  for (const QueryPlan& plan : plans_)
    bytes += held_bytes(plan.first, plan.second, plan.asked, plan.governed);
  to.add_host(MemoryKind::queries, bytes);
}

}  // namespace scenegen::render
