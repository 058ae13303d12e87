#include "render/strategy/query_chooser.h"

#include <algorithm>
#include <cmath>

namespace scenegen::render {
namespace {

// A part is heavy when drawing it costs so many times what asking does: C of (3.5).
constexpr double kHeavy = 1.5;
// So many answers say enough for a fit.
constexpr double kGatherEnough = 2048;
// Or so many times what is left to ask.
constexpr double kGatherMost = 4;
// Frames after which a part that was visible may be asked again; doubled each time.
constexpr std::uint32_t kFirstWait = 8;
constexpr std::uint32_t kLongestWait = 256;
// What was out of the frustum for so long is not known any more.
constexpr std::uint32_t kForget = 64;
// Asking about what may be visible wastes queries: a share of the hidden parts, as long as it is also a share
// of the queries about them; some always.
constexpr std::size_t kAgainShare = 8, kAgainOfQueries = 2, kAgainLeast = 1;
constexpr std::size_t kJoinedShare = 2, kJoinedLeast = 8;
// So many known parts around say something.
constexpr float kAroundLeast = 3;
// Answers in a row after which a part that is hidden may share a query, how many more of them make it more
// certain to stay so, and how many parts share one.
constexpr std::uint32_t kSteady = 5, kSteadiest = 63;
constexpr std::uint32_t kMostTogether = 32;
// Of the octree's nodes: with the guesses, at most about a tenth is asked.
constexpr double kFewQueries = 0.07;
constexpr int kMostHalved = 4;
// How often parts that stayed hidden come into view, times their answers in a row: forgotten by so much a
// frame, and guessed, with so much weight, before it is known.
constexpr double kRiskMemory = 0.99;
constexpr double kRisk = 0.03, kRiskWeight = 30;
// Observations that are fitted.
constexpr std::size_t kWindow = 256;
// Frames in a row in which asking must not pay before it stops.
constexpr std::uint32_t kPatience = 16;
// Frames of resting, doubled each time; and what wakes it before: a change of all that is in the frustum.
constexpr std::uint32_t kFirstRest = 128, kLongestRest = 2048;
constexpr double kWakeChange = 0.5;
// A change of that from one frame to the next is a cut.
constexpr double kCutChange = 0.5;
// Answers are late by the frames in flight.
constexpr std::uint32_t kLateness = 4;

}  // namespace

QueryChooser::Part& QueryChooser::part_of(std::uint32_t key) {
  return (key & kNodeBit) != 0 ? nodes_[key & ~kNodeBit] : chunks_[key];
}

QueryChooser::Part& QueryChooser::visit_part(std::uint32_t key, std::uint32_t owner, std::uint64_t revision) {
  Part& part = part_of(key);
  // Exact: a verdict is checked in the frame in which it is used, so it may outlive changes in its place.
  // Late: nothing but the verdict keeps what appeared from being drawn.
  const bool stale = settings_.exact ? part.owner != owner : part.revision != revision;
  if (stale || part.age != epoch_ || frame_ - part.seen > kForget) {
    part.verdict = Verdict::unknown;
    part.wait = 0;
    part.kept = 0;
    part.age = epoch_;
  }
  part.owner = owner;
  part.revision = revision;
  part.seen = frame_;
  return part;
}

void QueryChooser::observe(const Sum& sum) {
  if (window_.size() < kWindow) {
    window_.push_back(sum);
  } else {
    window_[window_at_] = sum;
  }
  window_at_ = (window_at_ + 1) % kWindow;
}

void QueryChooser::learn_part(const Asked& asked, bool hidden, bool alone) {
  Part& part = part_of(asked.number);
  if (!settings_.exact && part.revision != asked.revision) return;
  part.age = epoch_;
  if (hidden) {
    part.verdict = Verdict::hidden;
    part.wait = 0;
    ++part.kept;
    return;
  }
  part.kept = 0;
  if (alone) {
    part.verdict = Verdict::visible;
    part.wait = std::clamp(2 * part.wait, kFirstWait, kLongestWait);
    part.due = frame_ + part.wait + asked.number % (part.wait / 2);
  } else if (!settings_.exact) {
    part.verdict = Verdict::unknown;  // nothing but the verdict keeps it from being drawn
  }
}

void QueryChooser::learn(std::span<const Asked> asked, std::span<const std::uint32_t> samples) {
  Sum sum;
  double believed = 0;
  double kept = 0;
  std::size_t end = 0;
  for (std::size_t first = 0; first < asked.size(); first = end) {
    const bool hidden = samples[first] == 0;
    double seconds = 0;
    double steady = 0;
    for (end = first; end == first || (end < asked.size() && asked[end].with_previous); ++end) {
      const Part& part = part_of(asked[end].number);
      seconds += part.seconds;
      steady += asked[end].believed_hidden && part.kept >= kSteady ? doubt(part) : 0;
      sum.chunks += hidden ? part.chunks : 0;
      sum.draws += hidden ? part.draws : 0;
    }
    sum.queries += 1;
    sum.seconds += hidden ? seconds : 0;
    if (asked[first].believed_hidden) {
      believed += seconds;
      kept += hidden ? seconds : 0.0;
    }
    guesses_.learn(asked[first], hidden);
    doubted_ += steady;
    revealed_ += steady > 0 && !hidden ? 1 : 0;
    const auto queries = static_cast<std::uint64_t>(sum.queries);
    const bool power_of_two = (queries & (queries - 1)) == 0;
    if (phase_ == Phase::asking && (power_of_two || end == asked.size())) observe(sum);
    for (std::size_t i = first; i < end; ++i) learn_part(asked[i], hidden, end - first == 1);
  }
  doubted_ *= kRiskMemory;
  revealed_ *= kRiskMemory;
  guesses_.forget();
  if (believed > 0) kept_share_ += 0.1 * (kept / believed - kept_share_);
  if (phase_ == Phase::gathering && !asked.empty()) {
    gathered_.queries += sum.queries;
    gathered_.chunks += sum.chunks;
    gathered_.draws += sum.draws;
    gathered_.seconds += sum.seconds;
    observe(gathered_);
  }
}

double QueryChooser::secondary_s(const Frame& frame, double draws) const {
  return settings_.indirect ? frame.costs.node_command_s : frame.costs.secondary_s.line_at(draws);
}

/// What the device saves when it has not to draw this: its commands and vertices, or its fragments, which
/// fail the depth test, since it is hidden.
double QueryChooser::seconds_of(const Frame& frame, const Octree::Content& content) const {
  const model::UnitCosts& c = frame.costs;
  const model::Curve& curve = c.draw_s[static_cast<std::size_t>(model::Shading::plain)];
  const double draws = std::max(1U, content.slots);
  double draw_s = curve.line_at(static_cast<double>(content.vertices) / draws);
  if (settings_.indirect) {
    draw_s += frame.commands_per_draw * c.indirect_draw_s - curve.line_at(0);
  } else if (settings_.exact) {
    draw_s -= c.skipped_draw_s;
  }
  double seconds = std::max({0.0, draws * draw_s, frame.screen.fragments(content) * c.hidden_fragment_s});
  // Skipped under a predicate, executing it still costs, with nothing to be beside.
  if (settings_.exact && !settings_.indirect)
    seconds = std::max(0.0, seconds - c.node_overlap * c.secondary_device_s);
  if (!settings_.exact) seconds += settings_.indirect ? c.node_command_device_s : c.secondary_device_s;
  return seconds;
}

void QueryChooser::measure(const Frame& frame) {
  nodes_.resize(std::max(nodes_.size(), frame.tree.node_numbers()));
  chunks_.resize(std::max(chunks_.size(), frame.tree.chunk_numbers()));
  seconds_of_chunk_.resize(chunks_.size());
  seconds_.resize(frame.chunks.size() + 1);
  draws_.resize(frame.chunks.size() + 1);
  for (std::size_t i = 0; i < frame.chunks.size(); ++i) {
    const std::uint32_t number = frame.chunks[i];
    const Octree::Chunk& chunk = frame.tree.chunk(number);
    const Part& before = chunks_[number];
    // Fragments change slowly with the view: an eighth of the chunks is looked at in each frame.
    if (before.revision != chunk.revision || before.seen + 1 != frame_ || (number + frame_) % 8 == 0)
      seconds_of_chunk_[number] = static_cast<float>(seconds_of(frame, chunk.content));
    visit_part(number, chunk.node, chunk.revision);
    seconds_[i + 1] = seconds_[i] + seconds_of_chunk_[number];
    draws_[i + 1] = draws_[i] + chunk.content.slots;
  }
}

void QueryChooser::summarize(const Frame& frame) {
  below_.assign(frame.visits.size(), {});
  for (std::size_t v = frame.visits.size(); v-- > 0;) {  // what is below comes first
    const OctreeVisit& visit = frame.visits[v];
    Below& sum = below_[v];
    for (std::uint32_t i = visit.first_chunk; i < visit.own_end; ++i) {
      const Part& part = chunks_[frame.chunks[i]];
      const Verdict verdict = part.verdict;
      sum.box_m.add(frame.tree.chunk(frame.chunks[i]).content.box_m);
      // One that is not worth a query of its own is never asked: it must not keep the rest from becoming one.
      const bool open = verdict == Verdict::unknown || (verdict == Verdict::visible && part.due <= frame_);
      sum.hidden = sum.hidden && (verdict == Verdict::hidden || (open && !heavy(frame, i, i + 1)));
      sum.known = sum.known || verdict != Verdict::unknown;
      sum.known_parts += verdict != Verdict::unknown ? 1.0F : 0.0F;
      sum.hidden_parts += verdict == Verdict::hidden ? 1.0F : 0.0F;
      sum.visible = sum.visible || verdict == Verdict::visible;
    }
    for (std::size_t child = v + 1; child < visit.end_visit; child = frame.visits[child].end_visit) {
      const Below& part = below_[child];
      if (part.box_m.empty()) continue;
      sum.box_m.add(part.box_m);
      sum.hidden = sum.hidden && part.hidden;
      sum.known = sum.known || part.known;
      sum.known_parts += part.known_parts;
      sum.hidden_parts += part.hidden_parts;
      sum.visible = sum.visible || part.visible;
    }
    if (visit.end_chunk - visit.first_chunk < 2) continue;  // a node that is one chunk is asked as that
    const Octree::Node& node = frame.tree.node(visit.node);
    const Verdict own = visit_part(visit.node | kNodeBit, node.parent, node.revision).verdict;
    sum.known = sum.known || own != Verdict::unknown;
    if (own == Verdict::hidden) {
      sum.hidden = true;
      sum.visible = false;
      sum.known_parts = sum.hidden_parts = static_cast<float>(visit.end_chunk - visit.first_chunk);
    }
  }
}

bool QueryChooser::heavy(const Frame& frame, std::uint32_t first, std::uint32_t end) const {
  const double chunks = end - first;
  const double draws = draws_[end] - draws_[first];
  model::NodeCosts node;
  if (!settings_.exact) node.secondary_s = chunks * secondary_s(frame, draws / chunks);
  node.vertices_s = seconds_[end] - seconds_[first];
  return model::heavy(node, {frame.costs.ask_s, frame.costs.query_s, frame.costs.receive_s}, kHeavy,
                      settings_.side_by_side);
}

bool QueryChooser::make_candidate(const Frame& frame, std::uint32_t key, std::uint32_t first,
                                  std::uint32_t end, const Box& box_m, Candidate& out) const {
  const Box grown = frame.boxes.grown(box_m);
  if (frame.boxes.touches_eye(grown)) return false;
  out = {};
  out.part = key;
  out.first = first;
  out.end = end;
  out.seconds = seconds_[end] - seconds_[first];
  out.box_m = grown;
  return true;
}

QueryChooser::Around QueryChooser::around_of(const Below& below, Around wider) {
  if (below.known_parts < kAroundLeast) return wider;
  const float hidden = below.hidden_parts / below.known_parts;
  if (hidden < 0.2F) return Around::fifth;
  if (hidden < 0.5F) return Around::half;
  return hidden < 0.75F ? Around::most : Around::nearly_all;
}

std::vector<QueryChooser::Candidate>& QueryChooser::list_of(Why why) {
  return why == Why::joined ? joined_ : why == Why::never_asked ? unknown_ : again_;
}

void QueryChooser::propose(Candidate candidate, Why why, Around around) {
  candidate.guess =
      static_cast<std::uint8_t>(static_cast<std::size_t>(why) * kArounds + static_cast<std::size_t>(around));
  candidate.wrong = guesses_.wrong(candidate.guess);
  std::vector<Candidate>& list = list_of(why);
  candidate.rank = static_cast<std::uint32_t>(list.size());
  list.push_back(candidate);
}

void QueryChooser::collect_chunk(const Frame& frame, std::uint32_t index, std::uint32_t level,
                                 Around around) {
  const std::uint32_t number = frame.chunks[index];
  const Part& part = chunks_[number];
  if (part.verdict == Verdict::visible && part.due > frame_) return;
  if (!heavy(frame, index, index + 1)) return;
  Candidate candidate;
  if (!make_candidate(frame, number, index, index + 1, frame.tree.chunk(number).content.box_m, candidate))
    return;
  candidate.level = level;
  if (part.verdict == Verdict::hidden) {
    candidate.rank = static_cast<std::uint32_t>(hidden_.size());
    hidden_.push_back(candidate);
  } else {
    propose(candidate, part.verdict == Verdict::unknown ? Why::never_asked : Why::again, around);
  }
}

void QueryChooser::collect(const Frame& frame, std::uint32_t v, Around around) {
  const OctreeVisit& visit = frame.visits[v];
  if (visit.first_chunk == visit.end_chunk || !heavy(frame, visit.first_chunk, visit.end_chunk)) return;
  const Below& below = below_[v];
  around = around_of(below, around);
  const std::uint32_t level = frame.tree.node(visit.node).level;
  if (visit.end_chunk - visit.first_chunk > 1) {
    const std::uint32_t key = visit.node | kNodeBit;
    const Part& part = nodes_[visit.node];
    Candidate candidate;
    const bool asks = part.verdict == Verdict::hidden || !below.known ||
                      (below.hidden && (part.verdict == Verdict::unknown || part.due <= frame_));
    if (asks && make_candidate(frame, key, visit.first_chunk, visit.end_chunk, below.box_m, candidate)) {
      candidate.level = level;
      if (part.verdict == Verdict::hidden) {
        candidate.rank = static_cast<std::uint32_t>(hidden_.size());
        hidden_.push_back(candidate);
      } else {
        propose(candidate, below.known ? Why::joined : Why::never_asked, around);
      }
      if (part.verdict == Verdict::hidden || !below.known) return;
    }
  }
  for (std::uint32_t i = visit.first_chunk; i < visit.own_end; ++i) collect_chunk(frame, i, level, around);
  for (std::uint32_t child = v + 1; child < visit.end_visit; child = frame.visits[child].end_visit)
    collect(frame, child, around);
}

void QueryChooser::ask(const Candidate& candidate, bool hidden, bool with_previous, QueryPlan& plan) {
  Part& part = part_of(candidate.part);
  part.seconds = static_cast<float>(candidate.seconds);
  part.draws = static_cast<float>(draws_[candidate.end] - draws_[candidate.first]);
  part.chunks = static_cast<float>(candidate.end - candidate.first);
  const std::uint32_t query = plan.ask({candidate.part, part.revision, hidden, candidate.box_m, with_previous,
                                        candidate.guess, static_cast<float>(candidate.wrong)});
  last_asked_ = frame_;
  if (!hidden) return;
  for (std::uint32_t i = candidate.first; i < candidate.end; ++i) query_of_[i] = query;
}

void QueryChooser::ask_some(std::vector<Candidate>& candidates, std::size_t most, QueryPlan& plan) {
  // Breadth-first; in a level what saves most.
  const auto before = [](const Candidate& a, const Candidate& b) {
    if (a.level != b.level) return a.level < b.level;
    return a.seconds != b.seconds ? a.seconds > b.seconds : a.rank < b.rank;
  };
  if (candidates.size() > most) {
    std::nth_element(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(most),
                     candidates.end(), before);
    candidates.resize(most);
  }
  std::sort(candidates.begin(), candidates.end(), before);
  for (const Candidate& candidate : candidates) ask(candidate, false, false, plan);
}

/// Asks what is wrong least often first, while there is room for that with `spare` left, and of those that
/// are rather wrong no more than `most`. What was asked is taken from the list.
void QueryChooser::guess(std::vector<Candidate>& candidates, std::size_t most, double spare,
                         QueryPlan& plan) {
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    if (a.wrong != b.wrong) return a.wrong < b.wrong;
    if (a.level != b.level) return a.level < b.level;
    return a.seconds != b.seconds ? a.seconds > b.seconds : a.rank < b.rank;
  });
  std::size_t count = 0;
  for (; count < std::min(candidates.size(), kGatheredAtOnce); ++count) {
    const Candidate& candidate = candidates[count];
    if (candidate.wrong > Guesses::kHopeless || (candidate.wrong > Guesses::kRatherWrong && count >= most))
      break;
    if (!guesses_.make(candidate.wrong, spare)) break;
    ask(candidate, false, false, plan);
    plan.asked.back().limited = true;
  }
  candidates.erase(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(count));
}

void QueryChooser::begin_gathering() {
  phase_ = Phase::gathering;
  told_to_rest_ = false;
  ++epoch_;
  gathered_ = {};
  window_.clear();
  window_at_ = 0;
  kept_share_ = 1;
  useless_ = 0;
  guesses_.begin();
}

/// What was seen of another view says little of what is hidden in this one. (H200: a street after a view from
/// above took 4.8 ms a frame instead of 2.9.)
void QueryChooser::cut() {
  guesses_.begin_anew();
  for (std::vector<Part>* parts : {&chunks_, &nodes_}) {
    for (Part& part : *parts) part.due = part.wait = 0;
  }
}

void QueryChooser::rest(bool yes) {
  rest_next_ = yes;
  if (!yes && told_to_rest_) wake_ = 0;
}

void QueryChooser::begin_resting() {
  phase_ = Phase::resting;
  rest_ = std::clamp(2 * rest_, kFirstRest, kLongestRest);
  wake_ = frame_ + rest_;
  seconds_at_rest_ = seconds_.back();
  best_ = 0;
}

model::QueryProblem QueryChooser::problem(const Frame& frame) const {
  const model::UnitCosts& c = frame.costs;
  model::QueryProblem p;
  p.all_objects = draws_.back();
  p.all_nodes = static_cast<double>(frame.chunks.size());
  p.all_elements = seconds_.back();
  p.element_s = 1.0;  // elements are seconds of the device already
  p.rerecorded_share = frame.rerecorded_share;
  p.record_s = settings_.indirect ? c.write_indirect_s : c.record_kept_s;
  p.secondary_s = secondary_s(frame, p.all_objects / std::max(1.0, p.all_nodes));
  p.ask_s = c.ask_s + c.receive_s;
  p.query_s = c.query_s;
  p.exact = settings_.exact;
  p.second_part_s = c.second_part_device_s + (settings_.side_by_side ? 0.0 : c.second_part_cpu_s);
  // What else the frame costs decides which of processor and device waits for the other.
  p.other_cpu_s = c.empty_cpu_s + p.all_nodes * (c.visit_node_s + 2.0 * c.cull_node_s);
  p.other_gpu_s =
      c.empty_device_s + p.all_nodes * (settings_.indirect ? c.node_command_device_s : c.secondary_device_s);
  return p;
}

/// A part that was hidden for i answers comes into view in the next frame with a probability of about a / i
/// (seen on test set 32 for i from 2 to 64): this is 1 / i, ...
double QueryChooser::doubt(const Part& part) {
  return 1.0 / (1.0 + std::min(part.kept, kSteadiest));
}

/// ... and this a.
double QueryChooser::risk() const {
  return (revealed_ + kRisk * kRiskWeight) / (doubted_ + kRiskWeight);
}

/// Divides hidden_ into batches. One of n parts costs a query, and as often as one of them comes into view, n
/// times as often as with one part, all are drawn until it is known which: per part that is least where both
/// are the same, `risk` being how often a part comes into view, times how long it takes to know which it was.
/// Neighbours in the walk are together, which come into view together.
void QueryChooser::divide(double risk, double query_s) {
  for (Candidate& c : hidden_) {
    const Part& part = part_of(c.part);
    c.doubt = doubt(part);
    c.shares = part.kept >= kSteady && 4.0 * c.seconds * c.doubt * risk <= query_s;  // with one like itself
  }
  const auto age = [](const Candidate& c) { return c.shares ? std::ilogb(c.doubt) : 0; };
  std::sort(hidden_.begin(), hidden_.end(), [&](const Candidate& a, const Candidate& b) {
    return age(a) != age(b) ? age(a) < age(b) : a.rank < b.rank;
  });
  batches_.clear();
  for (std::uint32_t i = 0; i < hidden_.size(); ++i) {
    const Candidate& c = hidden_[i];
    if (!batches_.empty() && c.shares) {
      Batch& batch = batches_.back();
      const double doubt = batch.doubt + c.doubt;
      const double seconds = batch.seconds + c.seconds;
      if (batch.count < kMostTogether && doubt * seconds * risk <= query_s) {
        batch = {batch.first, batch.count + 1, seconds, doubt};
        continue;
      }
    }
    batches_.push_back({i, 1, c.seconds, c.doubt});
  }
}

/// ... and where that makes more than few queries, as if less came into view, which is mostly so: the risk is
/// remembered of something else.
void QueryChooser::share_queries(const Frame& frame) {
  const double query_s = frame.costs.ask_s + frame.costs.receive_s + frame.costs.query_s;
  const auto few = static_cast<std::size_t>(kFewQueries * static_cast<double>(frame.tree.node_count()));
  double lost = risk() * settings_.late_frames;
  for (int halved = 0;; ++halved, lost *= 0.5) {
    divide(lost, query_s);
    if (batches_.size() <= few || halved == kMostHalved) break;
  }
  std::sort(batches_.begin(), batches_.end(), [](const Batch& a, const Batch& b) {
    return a.seconds != b.seconds ? a.seconds > b.seconds : a.first < b.first;
  });
}

/// How many of batches_, best first, to ask about: D's x* by the fit, but also what the present answers say
/// of that number, of none and of all, since they are known and a logarithm is only near.
std::size_t QueryChooser::decide(const Frame& frame) {
  share_queries(frame);
  curve_.assign(1, {});
  for (const Batch& batch : batches_) {
    Sum sum = curve_.back();
    sum.queries += 1;
    sum.seconds += batch.seconds;
    for (std::uint32_t i = batch.first; i < batch.first + batch.count; ++i) {
      sum.chunks += hidden_[i].end - hidden_[i].first;
      sum.draws += draws_[hidden_[i].end] - draws_[hidden_[i].first];
    }
    curve_.push_back(sum);
  }
  model::QueryProblem p = problem(frame);
  const auto fit = [&](double Sum::*hidden) {
    points_.clear();
    for (const Sum& sum : window_) points_.push_back({sum.queries, sum.*hidden});
    return model::fit_log(points_);
  };
  p.nodes = fit(&Sum::chunks);
  p.objects = fit(&Sum::draws);
  p.elements = fit(&Sum::seconds);
  const double fitted = model::best_queries(p, settings_.side_by_side);
  const auto known = [&](std::size_t x) {
    p.nodes = {kept_share_ * curve_[x].chunks, 0};
    p.objects = {kept_share_ * curve_[x].draws, 0};
    p.elements = {kept_share_ * curve_[x].seconds, 0};
    return model::query_time_s(p, static_cast<double>(x), settings_.side_by_side);
  };
  std::size_t best = 0;
  for (const std::size_t x :
       {std::min(batches_.size(), static_cast<std::size_t>(std::lround(fitted))), batches_.size()}) {
    if (known(x) < known(best)) best = x;
  }
  best_ = static_cast<double>(best);
  return best;
}

void QueryChooser::gather(const Frame& frame, QueryPlan& plan) {
  ask_some(unknown_, kGatheredAtOnce, plan);
  // With a camera that moves there is always something new: most of it is enough to begin with.
  const bool most_asked = static_cast<double>(plan.asked.size()) * kGatherMost <= gathered_.queries;
  const bool all_asked = plan.asked.empty() && frame_ > last_asked_ + kLateness;
  if (!most_asked && gathered_.queries < kGatherEnough) return;
  if (decide(frame) > 0) {
    phase_ = Phase::asking;
    rest_ = 0;
  } else if (all_asked || gathered_.queries >= kGatherEnough) {
    begin_resting();
  }
}

void QueryChooser::ask_best(const Frame& frame, QueryPlan& plan) {
  std::size_t most = decide(frame);
  if (most == 0) {
    if (++useless_ > kPatience) return begin_resting();
    most = batches_.size();
  } else {
    useless_ = 0;
  }
  for (std::size_t b = 0; b < most; ++b) {
    for (std::uint32_t i = 0; i < batches_[b].count; ++i)
      ask(hidden_[batches_[b].first + i], true, i > 0, plan);
  }
  const std::size_t parts = plan.asked.size();
  const std::size_t again =
      std::max(kAgainLeast, std::min(parts / kAgainShare, std::size_t{plan.queries} / kAgainOfQueries));
  if (!settings_.exact) {  // which is there for comparison: D limits nothing
    ask_some(joined_, std::max(kJoinedLeast, parts / kJoinedShare), plan);
    ask_some(again_, again, plan);
    return ask_some(unknown_, kGatheredAtOnce, plan);
  }
  guesses_.begin_frame(plan.queries);
  guess(joined_, std::max(kJoinedLeast, parts / kJoinedShare), 0.0, plan);
  guess(again_, again, 0.0, plan);
  guess(unknown_, kGatheredAtOnce, 0.0, plan);
  guess(again_, kGatheredAtOnce, Guesses::kSpare, plan);
}

void QueryChooser::choose(const Frame& frame, QueryPlan& plan) {
  ++frame_;
  const double before_s = std::exchange(seconds_before_, 0.0);
  if (frame.chunks.empty()) return;
  measure(frame);
  seconds_before_ = seconds_.back();
  if (std::abs(seconds_.back() - before_s) > kCutChange * std::max(seconds_.back(), before_s)) cut();
  query_of_.assign(frame.chunks.size(), kNone);
  if (std::exchange(rest_next_, false)) {
    // After resting in vain the next rest is longer, whoever told.
    if (phase_ != Phase::resting) begin_resting();
    wake_ = std::max(wake_, frame_ + kFirstRest);
    told_to_rest_ = true;
  }
  if (phase_ == Phase::resting) {
    const double change = std::abs(seconds_.back() - seconds_at_rest_);
    if (frame_ >= wake_ || change > kWakeChange * seconds_at_rest_) {
      begin_gathering();
      measure(frame);  // with nothing known
    }
  }
  if (phase_ != Phase::resting) {
    summarize(frame);
    for (std::vector<Candidate>* list : {&hidden_, &unknown_, &joined_, &again_}) {
      make_room(*list, frame.chunks.size());
      list->clear();
    }
    make_room(batches_, frame.chunks.size());
    make_room(curve_, frame.chunks.size() + 1);
    make_room(window_, kWindow);
    make_room(points_, kWindow);
    collect(frame, 0, Around::unknown);
    phase_ == Phase::gathering ? gather(frame, plan) : ask_best(frame, plan);
  }
  for (std::uint32_t i = 0; i < frame.chunks.size(); ++i) {
    if (query_of_[i] == kNone) {
      plan.first.push_back(frame.chunks[i]);
    } else {
      plan.second.push_back(frame.chunks[i]);
      plan.governed.push_back({query_of_[i], frame.chunks[i]});
    }
  }
}

}  // namespace scenegen::render
