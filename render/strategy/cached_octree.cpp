#include "render/strategy/cached_octree.h"

#include <algorithm>
#include <new>

#include "render/strategy/estimate_load.h"
#include "render/strategy/octree_choice.h"

namespace scenegen::render {

std::unique_ptr<Strategy> make_inline(const StrategyContext& context);

CachedOctree::CachedOctree(const StrategyContext& context) : context_(context), scene_(context.scene) {
  choose_form();
  if (const auto fitting = choose_objects_per_node(context)) {
    objects_per_node_ = *fitting;
    (void)unless_out_of_memory([&] {
      octree_.emplace(scene_, *fitting,
                      context.octree_in_slices ? SceneOctree::Build::in_slices : SceneOctree::Build::at_once);
      if (indirect_form_) {
        nodes_.emplace(*fitting, context.options.fail_after_buffers, context.options.single_draws);
      } else {
        cache_.emplace(context.device, context.options.fail_after_buffers);
      }
    });
  } else {
    give_up("an octree with kept commands does not fit into " +
            std::to_string(context.options.octree_bytes >> 20) + " MiB (--octree-memory)");
  }
}

void CachedOctree::choose_form() {
  indirect_form_ = indirect_nodes(context_);
  if (context_.options.node_form == NodeForm::indirect && !indirect_form_)
    warnings_.emplace_back(
        "the device has no indirect draws with a count and a first instance; chunks are drawn as with "
        "--node-form secondaries");
}

void CachedOctree::update(const timeline::ChangeSet& changes) {
  changed_ = changes.count();
  refreshed_ = {};
  const auto update = [&] {
    const Octree::Refreshed before = tree().refreshed();
    octree_->update(changes);
    refreshed_ = tree().refreshed().since(before);
  };
  if (!inline_ && unless_out_of_memory(update)) return;
  inline_->update(changes);
}

void CachedOctree::note(const timeline::ChangeSet& changes) {
  if (!inline_ && unless_out_of_memory([&] { octree_->note(changes); })) return;
  inline_->update(changes);
}

bool CachedOctree::catch_up(std::size_t slots) {
  if (inline_) return true;
  bool done = true;
  return !unless_out_of_memory([&] { done = octree_->catch_up(slots); }) || done;
}

void CachedOctree::plan(const View& view) {
  view_ = view;
  const double could_be_recorded = static_cast<double>(chunks_.size()) * recordings();
  changed_share_ = could_be_recorded > 0 ? static_cast<double>(counters_.recorded) / could_be_recorded : 0.0;
  counters_ = {};
  if (inline_ || !unless_out_of_memory([&] { plan_chunks(); })) plan_inline();
}

void CachedOctree::plan_chunks() {
  const CullPlanes planes = cull_planes(frustum_of(view_.clip_from_world), scene_.bounds_m());
  list_blended_in_frustum(scene_, planes, list_);
  sort_back_to_front(scene_, view_, list_.blended);
  chunks_.clear();
  visits_.clear();
  found_ = {};
  tree().cull(planes, view_.eye_m(), chunks_, found_, &visits_);
  passes_ = 0;
  counters_.nodes = found_.nodes;
  counters_.tree_nodes = tree().node_count();
  counters_.refreshed_chunks = refreshed_.chunks;
  counters_.refreshed_slots = refreshed_.slots;
  counters_.tested = list_.tested + found_.tests;
  counters_.drawn = list_.blended.size();
  counters_.chunks = chunks_.size();
  for (const std::uint32_t chunk : chunks_) counters_.drawn += tree().chunk(chunk).slots.size();
}

CachedOctree::PerDraw CachedOctree::per_draw() const {
  if (inline_ || !nodes_) return {};
  const IndirectNodes::Kinds kinds = nodes_->kinds(tree(), chunks_);
  if (kinds.slots == 0) return {};
  return {static_cast<double>(kinds.commands) / static_cast<double>(kinds.slots),
          static_cast<double>(kinds.runs) / static_cast<double>(kinds.chunks)};
}

void CachedOctree::foresee(model::FrameFacts& facts) const {
  if (inline_) return;
  facts.visible_slots = tree().root().content.slots;
  facts.height = model::octree_height(tree().root().content.slots, objects_per_node_);
  facts.nodes_visited = static_cast<double>(found_.nodes);
  facts.boxes_tested = static_cast<double>(found_.tests);
  facts.chunks = static_cast<double>(chunks_.size());
  facts.in_chunks = load_of_chunks(scene_, tree(), chunks_, ScreenArea(view_, context_.size));
  const PerDraw each = per_draw();
  facts.commands_per_draw = each.commands;
  facts.runs_per_chunk = each.runs;
  facts.chunks_rerecorded = facts.draws_rerecorded = 0;
  for (const std::uint32_t number : chunks_) {
    const Octree::Chunk& chunk = tree().chunk(number);
    if (indirect_form_ ? nodes_->fresh(number, chunk.revision) : cache_->fresh(number, chunk.revision))
      continue;
    facts.chunks_rerecorded += 1;
    facts.draws_rerecorded += static_cast<double>(chunk.slots.size());
  }
}

void CachedOctree::draw_solid(PassRecording& pass) {
  if (!inline_) {
    ++passes_;
    if (unless_out_of_memory([&] { draw_chunks(pass); }, &pass)) return;
    pass.in_one_part();
    plan_inline();
  }
  inline_->draw_solid(pass);
}

void CachedOctree::draw_blended(DrawRecorder& recorder) {
  if (inline_) return inline_->draw_blended(recorder);
  for (const std::uint32_t slot : list_.blended) recorder.draw(slot);
}

void CachedOctree::resized(glm::uvec2 size) {
  context_.size = size;
  if (cache_) cache_->forget();
  if (inline_) inline_->resized(size);
}

bool CachedOctree::out_of_memory(const std::exception& error) {
  return dynamic_cast<const vk::OutOfHostMemoryError*>(&error) != nullptr ||
         dynamic_cast<const vk::OutOfDeviceMemoryError*>(&error) != nullptr ||
         dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
}

void CachedOctree::give_up(const std::string& why) {
  inline_ = make_inline(context_);
  warnings_.push_back(why + "; drawn as --strategy inline");
}

void CachedOctree::plan_inline() {
  inline_->plan(view_);
  counters_ = inline_->counters();
}

model::FrameFacts CachedOctree::facts() const {
  if (inline_) return inline_->facts();
  model::FrameFacts facts;
  const ScreenArea screen(view_, context_.size);
  facts.blended = load_of_slots(scene_, list_.blended, screen);
  add_scene_facts(scene_, screen, facts);
  facts.changed = static_cast<double>(changed_);
  facts.chunks_refreshed = static_cast<double>(refreshed_.chunks);
  facts.slots_refreshed = static_cast<double>(refreshed_.slots);
  facts.in_frustum = load_in_frustum(
      scene_, tree(), chunks_, cull_planes(frustum_of(view_.clip_from_world), scene_.bounds_m()), screen);
  foresee(facts);
  if (passes_ > 0) {  // otherwise what was foreseen stands
    facts.chunks_rerecorded = static_cast<double>(counters_.recorded) / recordings();
    facts.draws_rerecorded = rerecorded_draws();
  }
  facts.exact_octree = true;
  return facts;
}

void CachedOctree::add_memory(MemoryAccount& to) const {
  if (inline_) inline_->add_memory(to);
  if (octree_) to.add_host(MemoryKind::octree, octree_->memory_bytes());
  to.add_host(MemoryKind::lists, held_bytes(chunks_, visits_, reversed_, buffers_) + list_.memory_bytes());
  if (cache_) {
    to.add_host(MemoryKind::commands, held_bytes(kept_));
    cache_->add_memory(to);
    to.commands.process += process_growth_;
  }
  if (nodes_) to.add_host(MemoryKind::indirect, nodes_->memory_bytes());
}

std::vector<ChunkBox> CachedOctree::chunk_boxes() const {
  std::vector<ChunkBox> out;
  if (inline_) return out;
  for (const std::uint32_t chunk : chunks_) out.push_back({tree().chunk(chunk).content.box_m, {}});
  return out;
}

void CachedOctree::keep_secondaries(PassRecording& pass, std::span<const std::uint32_t> chunks,
                                    vk::Buffer predicates) {
  if (kept_.size() < tree().chunk_numbers()) kept_.resize(tree().chunk_numbers());
  const std::uint64_t before = context_.options.measure_commands ? vkr::process_bytes() : 0;
  for (const std::uint32_t number : chunks) {
    const Octree::Chunk& chunk = tree().chunk(number);
    std::span<const std::uint32_t> slots = chunk.slots;
    if (context_.options.reversed) {
      reversed_.assign(slots.rbegin(), slots.rend());
      slots = reversed_;
    }
    kept_[number] = cache_->get(pass, number, chunk.revision, slots, predicates);
  }
  const CommandCache::Counters recorded = cache_->take_counters();
  counters_.recorded += recorded.recorded;
  counters_.recorded_draws += recorded.recorded_draws;
  if (context_.options.measure_commands && recorded.recorded > 0)
    process_growth_ += static_cast<std::int64_t>(vkr::process_bytes() - before);
}

void CachedOctree::prepare(PassRecording& pass, std::span<const std::uint32_t> chunks,
                           vk::Buffer predicates) {
  const StageTimer timer(counters_.keep_ms);
  if (!indirect_form_) return keep_secondaries(pass, chunks, predicates);
  // All at once, for all passes of the frame: staging memory is written once a frame.
  nodes_->update(pass.context(), tree(), chunks_, context_.options.reversed);
  const IndirectNodes::Counters written = nodes_->take_counters();
  counters_.recorded += written.written;
  counters_.recorded_draws += written.written_draws;
}

void CachedOctree::execute(PassRecording& pass, std::span<const std::uint32_t> chunks,
                           vk::CommandBuffer last) {
  const StageTimer timer(counters_.secondaries_ms);
  buffers_.clear();
  Recorded held;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    const CommandCache::Entry& entry = kept_[in_order(chunks, i)];
    buffers_.push_back(entry.commands);
    held.add(entry.held);
  }
  counters_.secondaries += chunks.size();
  if (last) buffers_.push_back(last);
  pass.execute(buffers_, held);
}

void CachedOctree::draw(PassRecording& pass, std::span<const std::uint32_t> chunks, Occlusion* ask) {
  if (!indirect_form_) {
    vk::CommandBuffer boxes;
    if (ask != nullptr) {
      const StageTimer timer(counters_.ask_ms);
      boxes = ask->boxes(pass);
    }
    return execute(pass, chunks, boxes);
  }
  DrawRecorder& recorder = pass.draws();
  const vk::Buffer counts = ask != nullptr ? ask->predicates() : vk::Buffer{};
  {
    const StageTimer timer(counters_.secondaries_ms);
    counters_.indirect_commands += nodes_->draw(recorder, {chunks, counts, false, context_.options.reversed});
  }
  if (ask == nullptr) return;
  const StageTimer timer(counters_.ask_ms);
  ask->draw_boxes(pass);
}

void CachedOctree::draw_under(PassRecording& pass, std::span<const std::uint32_t> chunks,
                              const Occlusion& predicates) {
  if (!indirect_form_) return execute(pass, chunks, {});
  const StageTimer timer(counters_.secondaries_ms);
  counters_.indirect_commands +=
      nodes_->draw(pass.draws(), {chunks, predicates.predicates(), true, context_.options.reversed});
}

}  // namespace scenegen::render
