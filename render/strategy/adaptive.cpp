// D 3.3: in each frame the cheapest of `inline`, `octree`, `queries` and `hi-z` by the model, corrected by
// what frames took. `octree` is `queries` with nothing asked: one object, which keeps one octree and its
// commands.
#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <cmath>
#include <utility>

#include "render/model/choice.h"
#include "render/model/experience.h"
#include "render/passes/pass_recording.h"
#include "render/strategy/cached_octree.h"
#include "render/strategy/device_culled.h"
#include "render/strategy/estimate_load.h"
#include "render/strategy/octree_choice.h"
#include "render/strategy/picture.h"
#include "render/strategy/query_chooser.h"
#include "render/strategy/touched_chunks.h"

namespace scenegen::render {

std::unique_ptr<Strategy> make_inline(const StrategyContext& context);
std::unique_ptr<Strategy> make_queries(const StrategyContext& context);

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The choice may take this share of a frame, of a frame of a trial (which has to be judged soon), and of
/// what the processor would only wait for the device.
constexpr double kChooseShare = 0.008;
constexpr double kChooseShareInTrial = 0.04;
constexpr double kChooseIdleShare = 0.15;
/// While the octree is built or brought up to date, this share of a frame is spent on that, and of what the
/// processor would only wait for the device.
constexpr double kPrepareShare = 0.2;
constexpr double kIdleShare = 0.7;
constexpr std::size_t kSlice = 512;  ///< slots between two looks at the clock: some 0.1 ms
/// No more slots than these are behind: the rest is done at once when the octree is taken.
constexpr std::size_t kNearlyDone = 4096;
/// Frames are not all alike, and where the processor takes about as long as the device now one is late, now
/// the other: the 12-norm of both. (25 000 draws on H200s, `inline`: 2.55 and 2.61 ms in means, frames
/// of 2.64 to 2.74; this says 2.73.)
constexpr double kUneven = 12;
/// Fewer levels of changes in a frame say nothing of what one takes.
constexpr double kFewLevels = 500;
/// Of frames in which something changes, one in so many counts the chunks that are touched.
constexpr std::uint32_t kTouchedFrames = 3;
/// Fewer changes in a frame than these are no reason to decide anew.
constexpr double kManyChanges = 256;
/// So near to being cheaper, the octree is built and kept up to date though it is not taken.
constexpr double kNear = 1.2;
/// Frames after a change that say nothing about steady state: commands are recorded for the first time.
constexpr std::uint32_t kSettling = 2;
/// So many frames after a cut say nothing of how long the processor waits in what is shown now.
constexpr std::uint32_t kAfterCut = 8;
/// So many times the usual changes are a burst: a seek, or a phase that ends. What it costs the octree at
/// once is weighed against so many frames without it, until it has followed in slices.
constexpr double kBurst = 4;
constexpr double kBurstFrames = 20;
/// So many frames it may take until queries have found out what is hidden, of which a guess holds meanwhile;
/// but no longer than this, once answers are in: a guess that is wrong is lost time.
constexpr std::uint32_t kGathering = 40;
constexpr double kGatheringS = 0.25;
/// The octree is taken with queries when they are to save this share. It asks nothing at first when
/// `hi-z` saw this share of what is in the frustum, since the last cut: gathering took 25 % longer for ten
/// frames where nothing was hidden, and lost the octree its trial (25 000 draws on an H200).
constexpr double kAskingGains = 0.02, kAllSeen = 0.85;

class Adaptive final : public Strategy {
 public:
  explicit Adaptive(const StrategyContext& context);
  void update(const timeline::ChangeSet& changes) override;
  void plan(const View& view) override;
  void draw_solid(PassRecording& pass) override;
  void draw_blended(DrawRecorder& recorder) override;
  void resized(glm::uvec2 size) override;
  void finished(const FrameTimes& measured) override;
  [[nodiscard]] model::FrameFacts facts() const override { return taken().facts(); }
  [[nodiscard]] DeviceCounts device_counts(std::uint64_t serial) const override {
    return device_->device_counts(serial);
  }
  [[nodiscard]] std::vector<ChunkBox> chunk_boxes() const override { return taken().chunk_boxes(); }
  [[nodiscard]] const ChoiceReport* choice() const override { return &report_; }
  void add_memory(MemoryAccount& to) const override {
    flat_->add_memory(to);
    tree_->add_memory(to);
    device_->add_memory(to);
  }

 private:
  enum Way : std::size_t { flat, tree, device };
  static constexpr std::size_t kWays = 3;
  /// A frame on its way.
  struct Drawn {
    std::uint64_t frame = 0;
    Way way = flat;
    model::Method method = model::Method::inline_frustum;
    std::uint32_t since_change = 0;
    bool usual = false;  ///< says something about steady state
    model::Sides predicted;
    double aside_s = 0;  ///< of the processor's time: choosing, preparing and changing
  };

  [[nodiscard]] Strategy& strategy_of(Way way) const {
    if (way == tree) return *tree_;
    return way == device ? static_cast<Strategy&>(*device_) : *flat_;
  }
  [[nodiscard]] Strategy& taken() const { return strategy_of(way_); }
  [[nodiscard]] model::Method method_of(Way way, const model::FrameFacts& facts) const;
  [[nodiscard]] double idle_s() const;
  [[nodiscard]] bool due() const;
  void learn_of_last_frame();
  void learn_update(double measured_s, double levels, double chunks, double slots, bool many = false);
  [[nodiscard]] double units_of_update_s(double levels, double chunks, double slots) const;
  void leave_in_burst(const model::TouchedChunks& touched);
  [[nodiscard]] model::Sides sides_of(model::Method method, const model::FrameFacts& facts) const;
  void gather(const View& view);
  void make_offers();
  [[nodiscard]] double frame_s(const model::Sides& sides) const;
  [[nodiscard]] double change_to_tree_s() const;
  void decide(const View& view);
  void force(const View& view);
  void take(Way way, const View& view);
  [[nodiscard]] bool nearly_done() const { return tree_->pending() <= kNearlyDone; }
  /// Is the octree built, and nearly worth being taken?
  [[nodiscard]] bool near() const {
    return built_ && tree_->available() && offers_[tree].frame_s < kNear * offers_[way_].frame_s;
  }
  /// May queries still find out what is hidden? The first answers come after the frames in flight.
  [[nodiscard]] bool gathering() const {
    return asking_frames_ < kGathering &&
           (asking_frames_ <= context_.frames_in_flight || asking_s_ <= kGatheringS);
  }
  void prepare();
  void expect();
  void forward();

  StrategyContext context_;
  std::unique_ptr<Strategy> flat_;
  std::unique_ptr<CachedOctree> tree_;
  std::unique_ptr<DeviceCulled> device_;
  std::uint32_t per_node_;
  Way way_ = flat;
  model::PredictionOptions predicting_;

  model::Choice choice_;
  model::Correction correction_;  // a software device shares its processors with everything else
  model::Experience experience_;
  ChunksTouched touched_;
  model::SlowMean changed_{64}, recorded_chunks_{4}, changed_chunks_{4}, left_chunks_{4};
  // By the tree, while it draws.
  model::SlowMean rerecorded_draws_{256}, refreshed_chunks_{4}, refreshed_slots_{256};
  double last_changed_ = 0;
  double update_tree_s_ = 0;                           // in this frame
  double planned_update_s_ = 0, planned_changed_ = 0;  // in the last one
  double update_ln_ = 0;                               // T_upd(H), measured / by its units
  std::uint32_t touched_turn_ = 0;                     // frames in which something changed

  model::FrameFacts exact_;  // at the last decision: what the present way found
  model::FrameFacts facts_;  // the same in steady state, with guesses for the other
  double stale_draws_ = 0;   // of kept commands in the frustum, at the last decision
  std::array<model::Offer, kWays> offers_;
  ChoiceReport report_;

  std::uint64_t frame_ = 0;
  std::uint64_t decided_frame_ = 0;
  double decided_changed_ = 0;  // changes a frame it was about
  Picture picture_;             // of the last frame planned
  bool cut_ = false;            // it shows something else than the one before
  std::uint32_t since_cut_ = 0;
  std::uint32_t since_change_ = 1000;
  std::uint32_t asking_frames_ = 1000;  // since the tree was taken, or began to ask
  double asking_s_ = 0;                 // about
  bool left_in_burst_ = false;          // since the last plan
  bool queries_put_off_ = false;        // since the tree was taken
  double seen_share_ = -1;  // of draws in the frustum, by `hi-z` since the last cut; below 0: unknown
  double choose_s_ = 0;     // mean
  double cpu_s_ = 2e-3, gpu_s_ = 2e-3;  // means of what frames took
  std::uint32_t passes_ = 0;
  bool preparing_ = false;
  bool built_ = false;
  std::array<Drawn, 8> drawn_;
  std::array<std::size_t, kWays> warned_{};
};

Adaptive::Adaptive(const StrategyContext& context)
    : context_(context),
      flat_(make_inline(context)),
      per_node_(choose_objects_per_node(context).value_or(kObjectsPerNode)),
      correction_(context.device.info.type == "CPU"),
      touched_(context.scene, per_node_) {
  StrategyContext in_slices = context;
  in_slices.octree_in_slices = true;
  std::unique_ptr<Strategy> made = make_queries(in_slices);
  assert(dynamic_cast<CachedOctree*>(made.get()) != nullptr);
  tree_.reset(static_cast<CachedOctree*>(made.release()));
  device_ = make_device_culled(context);
  warned_[device] =
      device_->warnings().size();  // that the device cannot is no news here: there are other ways
  predicting_.frames_in_flight = context.frames_in_flight;
  predicting_.indirect_nodes = indirect_nodes(context);
  predicting_.exact = !context.options.late_visibility;
  predicting_.readback = context.readback;
  report_.used = "inline";
  forward();
}

void Adaptive::update(const timeline::ChangeSet& changes) {
  flat_->update(changes);
  device_->update(changes);
  last_changed_ = static_cast<double>(changes.count());
  // Far from being taken, some do (counting is a fifth of what the processor takes for 5500 changes a frame).
  const bool far = way_ != tree && !near();
  if (!far || last_changed_ == 0.0 || touched_turn_++ % kTouchedFrames == 0) {
    const model::TouchedChunks touched = touched_.count(changes);
    if (way_ == tree && last_changed_ > kBurst * changed_.value()) leave_in_burst(touched);
    recorded_chunks_.add(touched.recorded);
    changed_chunks_.add(touched.changed);
    left_chunks_.add(touched.left);
  }
  changed_.add(last_changed_);
  const auto start = Clock::now();
  way_ == tree ? tree_->update(changes) : tree_->note(changes);
  update_tree_s_ = way_ == tree ? seconds_since(start) : 0.0;
}

/// More changes at once than the octree can follow in a frame are put off and another way draws, where that
/// costs less. (Town of 370 000 objects on the H200: 8 ms for a jump of two seconds, beside frames of 2.7
/// that are 0.1 longer by `hi-z`.)
void Adaptive::leave_in_burst(const model::TouchedChunks& touched) {
  const Way other =
      offers_[device].possible && offers_[device].frame_s < offers_[flat].frame_s ? device : flat;
  const double now_s = offers_[tree].frame_s, other_s = offers_[other].frame_s;
  if (context_.options.change_every != 0 || now_s <= 0.0 || other_s <= 0.0) return;
  const double follow_s = std::exp(update_ln_) *
                          units_of_update_s(last_changed_ * std::max(1.0, facts_.height), touched.changed,
                                            std::min(facts_.visible_slots, touched.left * 0.7 * per_node_));
  if (follow_s <= 0.5 * now_s || follow_s <= kBurstFrames * (other_s - now_s)) return;
  way_ = other;
  left_in_burst_ = true;
  decided_frame_ = frame_;
  report_.verdict = {offers_[other].method, offers_[tree].method, other_s, now_s, model::Reason::trial};
  choice_.left();
}

/// So long the processor would only wait for the device. A device that is the processor leaves nothing idle.
double Adaptive::idle_s() const {
  if (context_.frames_in_flight <= 1 || context_.device.info.type == "CPU") return 0.0;
  return std::max(0.0, gpu_s_ - cpu_s_);
}

/// As often as the choice keeps to its share of a frame; at once after a seek or a cut, and when far more or
/// less changes than at the last decision.
bool Adaptive::due() const {
  if (frame_ <= 2 || cut_) return true;
  const double changed = changed_.value();
  const auto [less, more] = std::minmax(changed, decided_changed_);
  if (more > kManyChanges && more > 2.0 * less) return true;
  const double share_s =
      (choice_.in_trial() ? kChooseShareInTrial : kChooseShare) * std::max(1e-6, frame_s({cpu_s_, gpu_s_}));
  return static_cast<double>(frame_ - decided_frame_) >=
         std::min(60.0, choose_s_ / std::max(share_s, kChooseIdleShare * idle_s()));
}

void Adaptive::plan(const View& view) {
  ++frame_;
  ++since_change_;
  if (std::exchange(left_in_burst_, false)) since_change_ = 0;
  ++asking_frames_;
  asking_s_ += frame_s({cpu_s_, gpu_s_});
  learn_of_last_frame();
  planned_update_s_ = update_tree_s_;
  planned_changed_ = last_changed_;
  const Picture picture = picture_of(view, context_.scene);
  cut_ = !alike(picture_, picture, context_.scene.bounds_m());
  since_cut_ = cut_ ? 0 : since_cut_ + 1;
  picture_ = picture;
  // Memory ran out while it drew.
  if ((way_ == tree && !tree_->available()) || (way_ == device && !device_->available())) way_ = flat;
  taken().plan(view);
  const auto aside = Clock::now();
  report_.choose_s = 0;
  if (context_.options.change_every != 0) {
    force(view);
  } else {
    if (way_ != tree && (preparing_ || near())) prepare();
    if (due() || (preparing_ && nearly_done())) {
      const auto start = Clock::now();
      gather(view);
      make_offers();
      report_.choose_s = seconds_since(start);
      decide(view);
      choose_s_ += 0.2 * (report_.choose_s - choose_s_);
    }
  }
  Drawn& drawn = drawn_[frame_ % drawn_.size()];
  if (drawn.frame != frame_) drawn = {frame_, way_, method_of(way_, {}), since_change_, false, {}};
  drawn.aside_s = seconds_since(aside);
  passes_ = 0;
  counters_ = taken().counters();
  forward();
}

void Adaptive::learn_of_last_frame() {
  if (way_ != tree || passes_ == 0 || since_change_ <= kSettling) return;
  const PlanCounters& counted = tree_->counters();
  learn_update(planned_update_s_, planned_changed_ * std::max(1.0, facts_.height),
               static_cast<double>(counted.refreshed_chunks), static_cast<double>(counted.refreshed_slots));
  rerecorded_draws_.add(tree_->rerecorded_draws());
  refreshed_chunks_.add(static_cast<double>(counted.refreshed_chunks));
  refreshed_slots_.add(static_cast<double>(counted.refreshed_slots));
}

/// T_upd(H) against what its units say. They come from boxes that appear in order; in a town whose bricks
/// appear anywhere, out of the processor's caches, it is four times as much, and no other stage is (H200's
/// machine: 5500 changes a frame, 2.0 ms instead of 0.5).
/// `many` changes at a time take less each than those of a frame: it is at least as much.
void Adaptive::learn_update(double measured_s, double levels, double chunks, double slots, bool many) {
  const double predicted_s = units_of_update_s(levels, chunks, slots);
  if (levels < kFewLevels || predicted_s <= 0.0 || measured_s <= 0.0) return;
  const double ln = std::log(std::clamp(measured_s / predicted_s, 0.25, 16.0));
  if (context_.options.correction && (!many || ln > update_ln_)) update_ln_ += 0.2 * (ln - update_ln_);
}

double Adaptive::units_of_update_s(double levels, double chunks, double slots) const {
  const model::UnitCosts& costs = context_.costs;
  return levels * costs.intersect_s + chunks * costs.refresh_chunk_s + slots * costs.refresh_slot_s;
}

/// What there is to do in this frame, in all ways. The present way has planned it.
void Adaptive::gather(const View& view) {
  facts_ = {};
  stale_draws_ = 0;
  if (way_ != tree) {
    facts_ = way_ == device ? device_->estimated_facts() : flat_->facts();
    if (near() && !tree_->behind()) {  // far from worth it, a guess will do
      tree_->plan(view);
      model::FrameFacts kept;
      tree_->foresee(kept);
      kept.visible_slots = facts_.visible_slots;
      kept.screen_pixels = facts_.screen_pixels;
      kept.in_frustum = facts_.in_frustum;
      kept.blended = facts_.blended;
      kept.exact_inline = kept.exact_octree = true;
      facts_ = kept;
      stale_draws_ = facts_.draws_rerecorded;
    }
  } else {
    facts_ = tree_->facts();
  }
  if (way_ == device) {
    device_->add_seen(facts_);
    // What is seen after a change to it says nothing yet.
    if (since_change_ < kSettling + context_.frames_in_flight) facts_.exact_seen = false;
  }
  if (cut_) seen_share_ = -1;
  if (way_ == device && facts_.exact_seen && facts_.in_frustum.draws > 0.0)
    seen_share_ = facts_.seen.draws / facts_.in_frustum.draws;
  facts_.hi_z_blocks = device_->blocks();
  facts_.changed = changed_.value();
  if (context_.shadows) {
    facts_.visible = load_of_visible(context_.scene, ScreenArea(view, context_.size));
    facts_.shadow_slots = facts_.visible.draws;
    facts_.shadow_vertices = facts_.visible.vertices;
  }
  exact_ = facts_;
  // As long as answers are being gathered they say nothing yet: what was known or guessed before still holds.
  if (queries_put_off_ && (way_ != tree || facts_.asked > 0.0)) {
    queries_put_off_ = false;
    asking_frames_ = 0, asking_s_ = 0;
  }
  const bool unasked = queries_put_off_ || (gathering() && facts_.hidden.draws <= 0.0);
  const bool exact_queries = facts_.exact_queries;
  if (way_ == tree && unasked) facts_.exact_queries = false;
  experience_.learn(facts_);
  if (queries_put_off_) facts_.exact_queries = exact_queries;
  const model::TouchedChunks touched{recorded_chunks_.value(), changed_chunks_.value(), left_chunks_.value()};
  experience_.fill_unknown(facts_, per_node_, touched);
  if (way_ == tree) {
    facts_.draws_rerecorded = rerecorded_draws_.value();
    facts_.chunks_refreshed = refreshed_chunks_.value();
    facts_.slots_refreshed = refreshed_slots_.value();
  } else if (facts_.exact_octree) {
    const double seen = facts_.in_chunks.draws / std::max(1.0, facts_.visible_slots);
    facts_.draws_rerecorded = std::min(facts_.in_chunks.draws, touched.recorded * seen * 0.7 * per_node_);
    facts_.chunks_refreshed = touched.changed;
    facts_.slots_refreshed = std::min(facts_.visible_slots, touched.left * 0.7 * per_node_);
  } else {
    stale_draws_ = facts_.in_chunks.draws;
  }
}

double Adaptive::frame_s(const model::Sides& sides) const {
  model::TimeUnits units;
  units.empty_frame = context_.frames_in_flight <= 1 ? context_.costs.latency_s : 0.0;
  units.overlap = context_.costs.frame_overlap;
  const double even_s = model::frame_s(sides.cpu_s, sides.gpu_s, context_.frames_in_flight, units);
  if (context_.frames_in_flight <= 1 || context_.device.info.type == "CPU") return even_s;
  const auto [less, more] = std::minmax(sides.cpu_s, sides.gpu_s);
  return more <= 0.0 ? even_s : even_s * std::pow(1.0 + std::pow(less / more, kUneven), 1.0 / kUneven);
}

/// What is put off is done, and what is not fresh in the frustum recorded.
double Adaptive::change_to_tree_s() const {
  const model::UnitCosts& costs = context_.costs;
  const auto pending = static_cast<double>(tree_->pending());
  return std::exp(update_ln_) *
             (pending * std::max(1.0, facts_.height) * costs.intersect_s +
              std::min(facts_.visible_slots, 0.7 * per_node_ * pending) * costs.refresh_slot_s) +
         stale_draws_ * costs.record_kept_s;
}

model::Sides Adaptive::sides_of(model::Method method, const model::FrameFacts& facts) const {
  const model::Prediction p = model::predict(method, facts, context_.costs, predicting_);
  return {p.cpu_s + (std::exp(update_ln_) - 1.0) * p.update_octree_s, p.gpu_s};
}

void Adaptive::make_offers() {
  using model::Method;
  const auto corrected = [&](Method method, const model::Sides& raw) {
    return frame_s(context_.options.correction ? correction_.corrected(method, raw) : raw);
  };
  const auto offered_s = [&](Method method) { return corrected(method, sides_of(method, facts_)); };
  offers_[flat] = {Method::inline_frustum, offered_s(Method::inline_frustum), 0.0, true, true};
  // The tree's strategy asks as many queries as pay, none if none does.
  Method method = Method::octree;
  double tree_s = offered_s(method);
  double change_s = way_ == tree ? 0.0 : change_to_tree_s();
  const double asking_s = offered_s(Method::queries);
  const bool pays = seen_share_ < kAllSeen && asking_s < (1.0 - kAskingGains) * tree_s;
  if (way_ == tree ? facts_.asked > 0.0 : pays) {
    // Until its parts are asked about it draws all that the octree does.
    const double frames =
        context_.frames_in_flight + facts_.chunks / static_cast<double>(QueryChooser::kGatheredAtOnce);
    if (way_ != tree) change_s += std::min<double>(kGathering, frames) * (tree_s - asking_s);
    method = Method::queries;
    tree_s = asking_s;
  }
  offers_[device] = {Method::hi_z, offered_s(Method::hi_z), 0.0, device_->available(), true};
  const bool ready = built_ && nearly_done();
  offers_[tree] = {method, tree_s, change_s, tree_->available(), ready};
}

void Adaptive::decide(const View& view) {
  const auto elapsed = static_cast<std::uint32_t>(frame_ - decided_frame_);
  decided_frame_ = frame_;
  decided_changed_ = changed_.value();
  const auto start = Clock::now();
  const model::Choice::Decision decision =
      choice_.decide(offers_, way_, elapsed, context_.options.correction ? &correction_ : nullptr, cut_);
  report_.verdict = decision.verdict;
  report_.choose_s += seconds_since(start);
  const auto wanted = static_cast<Way>(decision.take);
  preparing_ = wanted == tree && way_ != tree && !offers_[tree].ready;
  if (wanted != way_ && !preparing_) {
    take(wanted, view);
    choice_.changed(decision);
  }
  expect();
}

/// A slice of what was put off, while something else draws.
void Adaptive::prepare() {
  const double idle_share_s = since_cut_ < kAfterCut ? 0.0 : kIdleShare * idle_s();
  const double budget_s = std::max(kPrepareShare * frame_s({cpu_s_, gpu_s_}), idle_share_s);
  const auto start = Clock::now();
  const std::size_t pending = tree_->pending();
  const Octree::Refreshed before = tree_->refreshed();
  while (!tree_->catch_up(kSlice) && seconds_since(start) < budget_s) {
  }
  if (built_ && tree_->available()) {
    const Octree::Refreshed done = tree_->refreshed().since(before);
    learn_update(seconds_since(start),
                 static_cast<double>(pending - tree_->pending()) * std::max(1.0, facts_.height),
                 static_cast<double>(done.chunks), static_cast<double>(done.slots), pending > kNearlyDone);
  }
  built_ = built_ || nearly_done();
}

void Adaptive::take(Way way, const View& view) {
  way_ = way;
  since_change_ = 0;
  asking_frames_ = 0, asking_s_ = 0;
  preparing_ = false;
  if (way == tree) {
    while (!tree_->catch_up(std::size_t{1} << 30)) {
    }
    built_ = true;
    queries_put_off_ = offers_[tree].method == model::Method::octree && seen_share_ >= kAllSeen;
    tree_->put_off_queries(queries_put_off_);
  }
  taken().plan(view);
}

/// For tests: round all ways there are.
void Adaptive::force(const View& view) {
  if (frame_ % context_.options.change_every == 0) {
    auto next = static_cast<Way>((way_ + 1) % kWays);
    if (next == tree && !tree_->available()) next = device;
    if (next == device && !device_->available()) next = flat;
    if (next != way_) take(next, view);
  } else if (way_ != tree && frame_ % 2 == 0) {
    (void)tree_->catch_up(100);
  }
  const model::Method method = method_of(way_, {});
  report_.verdict = {method, method, 0, 0, model::Reason::forced};
}

model::Method Adaptive::method_of(Way way, const model::FrameFacts& facts) const {
  if (way == flat) return model::Method::inline_frustum;
  if (way == device) return model::Method::hi_z;
  return facts.asked > 0.0 ? model::Method::queries : model::Method::octree;
}

/// Remembers what this frame should take, to compare it with what it took.
void Adaptive::expect() {
  model::FrameFacts now = exact_;
  now.changed = last_changed_;
  const model::Method method = method_of(way_, now);
  if (way_ == device) now.seen = facts_.seen;  // of which a part is always guessed
  // A guess of what is seen that is wrong is no fault of the unit costs: Experience learns it.
  const bool guessed = way_ == device && !facts_.exact_seen && facts_.in_frustum.draws > 0.0;
  drawn_[frame_ % drawn_.size()] = {
      frame_,
      way_,
      method,
      since_change_,
      since_change_ >= kSettling && !preparing_ && frame_ > kSettling && !guessed,
      sides_of(method, now)};
}

void Adaptive::draw_solid(PassRecording& pass) {
  assert(pass.context().frame.serial == frame_);
  ++passes_;
  taken().draw_solid(pass);
  counters_ = taken().counters();
  if (way_ == tree) report_.used = counters_.queries > 0 ? "queries" : "octree";
  if (way_ == device && device_->available()) report_.used = "hi-z";
  if (way_ == flat || (way_ == tree && !tree_->available()) || (way_ == device && !device_->available()))
    report_.used = "inline";
  forward();
}

void Adaptive::draw_blended(DrawRecorder& recorder) {
  taken().draw_blended(recorder);
  counters_ = taken().counters();
}

void Adaptive::resized(glm::uvec2 size) {
  context_.size = size;
  flat_->resized(size);
  tree_->resized(size);
  device_->resized(size);
}

void Adaptive::finished(const FrameTimes& measured) {
  const Drawn& drawn = drawn_[measured.serial % drawn_.size()];
  if (drawn.frame != measured.serial) return;
  // As slow as to outlast a hitch, as fast as to know a scene after some frames.
  constexpr double kNewest = 0.2;
  const double cpu_s = std::max(0.0, measured.cpu_s - drawn.aside_s);
  cpu_s_ += kNewest * (std::min(cpu_s, 4.0 * cpu_s_) - cpu_s_);
  if (measured.gpu_s > 0.0) gpu_s_ += kNewest * (std::min(measured.gpu_s, 4.0 * gpu_s_) - gpu_s_);
  strategy_of(drawn.way).finished(measured);
  if (drawn.usual)
    correction_.measured(drawn.method, drawn.since_change, drawn.predicted, {cpu_s, measured.gpu_s});
}

void Adaptive::forward() {
  const std::array<const Strategy*, kWays> ways{flat_.get(), tree_.get(), device_.get()};
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const std::vector<std::string>& all = ways[i]->warnings();
    for (; warned_[i] < all.size(); ++warned_[i]) warnings_.push_back(all[warned_[i]]);
  }
}

}  // namespace

std::unique_ptr<Strategy> make_adaptive(const StrategyContext& context) {
  return std::make_unique<Adaptive>(context);
}

}  // namespace scenegen::render
