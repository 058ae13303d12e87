#include "render/model/choice.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace scenegen::render::model {
namespace {

const double kMostLn = std::log(2.0);
/// Frames after a change whose surprises are the new way's own.
constexpr std::uint32_t kFresh = 12;
/// A change is soon when it comes within so many frames after another.
constexpr double kSoon = 240;
constexpr double kMostPenalty = 15;

double bounded(double ln) {
  return std::clamp(ln, -kMostLn, kMostLn);
}

std::size_t index(Method method) {
  return static_cast<std::size_t>(method);
}

/// The best of the others, of those that are `ready`; offers.size(): there is none.
std::size_t best_of(std::span<const Offer> offers, std::size_t present, bool ready) {
  std::size_t best = offers.size();
  for (std::size_t i = 0; i < offers.size(); ++i) {
    if (i == present || !offers[i].possible || (ready && !offers[i].ready)) continue;
    if (best == offers.size() || offers[i].frame_s < offers[best].frame_s) best = i;
  }
  return best;
}

}  // namespace

void Correction::learn(Side& side, Method method, bool fresh, bool machines, double predicted_s,
                       double taken_s) const {
  if (predicted_s <= 0.0 || taken_s <= 0.0) return;
  const double believed = factor(side, method, predicted_s);
  double& own = side.own[index(method)];
  if (trust(side, method, predicted_s) < 1.0) own = bounded(believed - side.machine);
  side.predicted_s[index(method)] = predicted_s;
  // A single frame that took ten times as long (somebody else's turn) says no more than one that took twice.
  const double surprise = bounded(std::log(taken_s / predicted_s) - believed);
  // Where the machine is not shared: fast enough to be 5 % behind when a ratio drifts by 60 % in 100 frames
  // (a growing town on an H200).
  if (fresh || !machines) own = bounded(own + (fresh ? 0.2 : 0.06) * surprise);
  side.machine = bounded(side.machine + (fresh ? 0.01 : 0.04) * surprise);
}

void Correction::measured(Method method, std::uint32_t since_change, const Sides& predicted,
                          const Sides& taken) {
  if (frames_[index(method)] == 0) {
    const Method relative = known_relative(method);
    cpu_.own[index(method)] = cpu_.own[index(relative)];
    gpu_.own[index(method)] = gpu_.own[index(relative)];
  }
  // With nothing to compare to, all surprise is the machine's.
  bool others = false;
  for (std::size_t m = 0; m < kMethods; ++m) others = others || (m != index(method) && frames_[m] > 0);
  const bool fresh = others && since_change < kFresh;
  learn(cpu_, method, fresh, true, predicted.cpu_s, taken.cpu_s);
  learn(gpu_, method, fresh, !others || device_shared_, predicted.gpu_s, taken.gpu_s);
  last_ = method;
  ++frames_[index(method)];
}

Method Correction::known_relative(Method method) const {
  static constexpr std::array kKin{Method::octree, Method::queries, Method::queries_all};
  if (frames_[index(method)] > 0 || std::find(kKin.begin(), kKin.end(), method) == kKin.end()) return method;
  for (const Method kin : kKin) {
    if (frames_[index(kin)] > 0) return kin;
  }
  return method;
}

bool Correction::knows(Method method) const {
  return frames_[index(known_relative(method))] > 0;
}

/// What two sides have in common differs: processors do other things in each way, a device the same work for
/// more or fewer objects. So only of a device is it told from the present way.
double Correction::trust(const Side& side, Method method, double predicted_s) const {
  if (&side != &gpu_ || device_shared_ || known_relative(method) == known_relative(last_)) return 1.0;
  const double then_s = side.predicted_s[index(known_relative(method))];
  if (then_s <= 0.0 || predicted_s <= 0.0) return 0.0;
  constexpr double kAlike = 0.15, kFade = 0.3;  // ln
  return std::exp(-std::max(0.0, std::abs(std::log(predicted_s / then_s)) - kAlike) / kFade);
}

double Correction::factor(const Side& side, Method method, double predicted_s) const {
  const double known = side.own[index(known_relative(method))];
  const double doubt = std::min(0.0, side.own[index(known_relative(last_))]);
  const double sure = trust(side, method, predicted_s);
  return bounded(side.machine + sure * known + (1.0 - sure) * doubt);
}

Sides Correction::corrected(Method method, const Sides& predicted) const {
  return {predicted.cpu_s * std::exp(factor(cpu_, method, predicted.cpu_s)),
          predicted.gpu_s * std::exp(factor(gpu_, method, predicted.gpu_s))};
}

std::string in_words(const Verdict& v) {
  std::string text;
  const auto add = [&](const char* format, double ms) {
    std::array<char, 64> buffer;
    (void)std::snprintf(buffer.data(), buffer.size(), format, ms);
    text += buffer.data();
  };
  text += name_of(v.used);
  add(": %.2f ms", v.used_s * 1e3);
  if (v.reason == Reason::alone) return text + ", no other way is possible";
  text += " against ";
  text += name_of(v.rival);
  add(" %.2f ms", v.rival_s * 1e3);
  switch (v.reason) {
    case Reason::too_near:
      return text + ", too near to change";
    case Reason::patience:
      return text + ", waiting whether that lasts";
    case Reason::no_pay:
      return text + ", changing would not pay";
    case Reason::preparing:
      return text + ", which is being prepared";
    case Reason::trial:
      return text + ", just taken";
    case Reason::forced:
      return text + ", forced";
    case Reason::cheaper:
    case Reason::alone:
      break;
  }
  return text;
}

void Choice::pass(double elapsed, std::size_t present, double frame_s) {
  since_change_ += elapsed;
  since_cut_ = cut_ ? 0.0 : since_cut_ + elapsed;
  for (double& frames : since_taken_) frames += elapsed;
  present_ = present;
  // One that is left at a cut has not drawn what is shown then.
  since_taken_[present] = cut_ ? 1.0 : 0.0;
  trial_left_ = std::max(0.0, trial_left_ - elapsed);
  penalty_ *= std::pow(0.995, elapsed);
  if (trial_purse_s_ < 0.0) trial_purse_s_ = std::min(options_.advance_frames * frame_s, options_.advance_s);
  // At a cut the frames before this one were of something else, as they were predicted then.
  if (usual_s_ < 0.0) usual_s_ = frame_s;
  usual_s_ += (1.0 - std::pow(0.9, cut_ ? 1.0 : elapsed)) * (frame_s - usual_s_);
  trial_purse_s_ += options_.trial_share * elapsed * frame_s;
}

/// What trying costs: changing, and 20 frames that turn out to take a tenth more than the present way's, a
/// twentieth when it was measured before.
double Choice::trial_cost_s(const Offer& now, const Offer& other, bool known) const {
  const double worse_s = (known ? 0.05 : 0.1) * now.frame_s;
  return other.change_s + options_.trial_frames * std::max(worse_s, other.frame_s - now.frame_s);
}

bool Choice::in_reach(const Offer& now, const Offer& other, std::size_t number, bool known) const {
  if (options_.trial_share <= 0.0) return false;
  // What was measured before the cut was of something else, and may be off by more than lies between them.
  const bool stale = since_cut_ >= options_.near_frames && since_taken_[number] > since_cut_ &&
                     other.frame_s <= (1.0 + options_.near_share) * now.frame_s;
  if (known && !stale && since_taken_[number] < options_.trial_again_frames) return false;
  const double reach = known ? 0.5 * (1.0 + options_.trial_reach) : options_.trial_reach;
  return other.frame_s <= reach * now.frame_s;
}

std::size_t Choice::to_try(std::span<const Offer> offers, std::size_t present, bool preparing,
                           const Correction& correction) const {
  // Not the best alone: a way that is guessed too dear would never be measured beside one that is guessed too
  // cheap. While one that was never measured is saved up for, none that was is tried.
  std::size_t found = offers.size();
  bool only_unknown = preparing;
  for (const bool known : {false, true}) {
    if (known && only_unknown) break;
    for (std::size_t i = 0; i < offers.size(); ++i) {
      const Offer& offer = offers[i];
      if (i == present || !offer.possible || (preparing && !offer.ready)) continue;
      if (correction.knows(offer.method) != known || !in_reach(offers[present], offer, i, known)) continue;
      only_unknown = only_unknown || !known;
      if (trial_cost_s(offers[present], offer, known) > trial_purse_s_) continue;
      if (found == offers.size() || offer.frame_s < offers[found].frame_s) found = i;
    }
  }
  return found;
}

/// As far as what each way takes is known, it was measured not long ago, so no margin keeps what is worse.
bool Choice::regretted(std::span<const Offer> offers, const Offer& now) {
  if (cut_) before_trial_.reset();
  if (!before_trial_ || trial_left_ > 0.0) return false;
  const Offer& before = offers[*before_trial_];
  const double saved_s = now.frame_s - before.frame_s;
  const bool best = std::none_of(offers.begin(), offers.end(), [&](const Offer& o) {
    return o.possible && o.ready && o.frame_s < before.frame_s;
  });
  if (before.possible && before.ready && best && saved_s > options_.regret_share * now.frame_s &&
      saved_s * options_.horizon_frames >= before.change_s)
    return true;
  before_trial_.reset();
  return false;
}

std::optional<Reason> Choice::objection(const Offer& now, const Offer& other, std::size_t number,
                                        double elapsed) {
  const double saved_s = now.frame_s - other.frame_s;
  const double margin_s = options_.margin * now.frame_s;
  if (saved_s <= margin_s || wanted_ != number || first_cut_) {
    wanted_ = number;
    wanted_frames_ = 0;
    missed_s_ = 0;
    elapsed = std::min(elapsed, 1.0);  // frames before were of something else
  }
  if (saved_s <= 0.0) return Reason::cheaper;
  if (saved_s <= margin_s) return Reason::too_near;
  wanted_frames_ += elapsed;
  missed_s_ += saved_s * elapsed;
  if (wanted_frames_ < options_.frames && !far_better(other, now)) return Reason::patience;
  // After changes in a row, time and not a share of it: what is better by half must not wait as long as what
  // is better by a twentieth.
  if (missed_s_ < options_.penalty_frames * penalty_ * now.frame_s) return Reason::patience;
  const double horizon = options_.horizon_frames / (1.0 + penalty_);
  if (saved_s * horizon < other.change_s && missed_s_ < other.change_s) return Reason::no_pay;
  return std::nullopt;
}

bool Choice::far_better(const Offer& other, const Offer& now) const {
  return cut_ && other.ready && now.frame_s - other.frame_s >= options_.at_once * now.frame_s &&
         now.frame_s - other.frame_s >= options_.at_once_of_usual * usual_s_;
}

std::optional<std::size_t> Choice::lost_to(std::span<const Offer> offers, std::size_t present,
                                           double elapsed) {
  if (trial_left_ <= 0.0) return std::nullopt;
  // While the best is not ready yet, the best of those that are.
  const Offer& now = offers[present];
  const std::size_t best = best_of(offers, present, true);
  if (best == offers.size()) return std::nullopt;
  const double more_s = now.frame_s - offers[best].frame_s;
  if (more_s <= options_.margin * now.frame_s || first_cut_) kept_lost_s_ = kept_lost_frames_ = 0;
  if (more_s <= options_.margin * now.frame_s) return std::nullopt;
  // Frames before this was first seen may have been of something else.
  const double frames = kept_lost_s_ > 0.0 ? elapsed : std::min(elapsed, 1.0);
  kept_lost_frames_ += frames;
  kept_lost_s_ += more_s * frames;
  if (in_trial() && since_change_ >= options_.trial_judged_frames &&
      more_s > options_.trial_loss * offers[best].frame_s)
    return best;
  const double most_frames = options_.kept_loss_frames * (1.0 + penalty_ / kMostPenalty);
  if (kept_lost_frames_ < options_.frames ||
      kept_lost_s_ < std::max(most_frames * offers[best].frame_s, offers[best].change_s))
    return std::nullopt;
  return best;
}

Choice::Decision Choice::decide(std::span<const Offer> offers, std::size_t present, std::uint32_t elapsed,
                                const Correction* correction, bool cut) {
  const Offer& now = offers[present];
  first_cut_ = cut && !cut_;
  cut_ = cut;
  // Changes in a row were about another picture: one that is twice as dear must not wait for seven frames
  // more. A quarter is left.
  if (cut) penalty_ *= 0.25;
  pass(elapsed, present, now.frame_s);
  Decision d;
  d.take = present;
  d.verdict = {now.method, now.method, now.frame_s, now.frame_s, Reason::alone};
  const std::size_t best = best_of(offers, present, false);
  if (best == offers.size()) return d;
  d.verdict.rival = offers[best].method;
  d.verdict.rival_s = offers[best].frame_s;
  if (!now.possible) {
    d.take = best;
  } else if (const std::optional<std::size_t> winner = lost_to(offers, present, elapsed)) {
    d.verdict.reason = Reason::cheaper;
    d.take = *winner;
  } else if (const std::size_t ready = best_of(offers, present, true);
             ready < offers.size() && ready != best && far_better(offers[ready], now)) {
    // What is best has to be prepared first: until then, not as what was right before the cut.
    d.take = ready;
  } else if (trial_left_ > 0.0 && !far_better(offers[best], now)) {
    d.verdict.reason = Reason::trial;
    return d;
  } else if (regretted(offers, now)) {
    d.verdict.reason = Reason::cheaper;
    d.take = *before_trial_;
  } else {
    const std::optional<Reason> against = objection(now, offers[best], best, elapsed);
    d.verdict.reason = against.value_or(Reason::cheaper);
    if (!against) d.take = best;
    const bool preparing = !against && !offers[best].ready;
    if (correction != nullptr && (preparing || (against && *against != Reason::patience))) {
      const std::size_t tried = to_try(offers, present, preparing, *correction);
      d.trial = tried < offers.size();
      if (d.trial) {
        d.take = tried;
        d.trial_cost_s = trial_cost_s(now, offers[tried], correction->knows(offers[tried].method));
      }
    }
  }
  if (d.take == present) return d;
  const Offer& other = offers[d.take];
  d.verdict.rival = other.method;
  d.verdict.rival_s = other.frame_s;
  if (!other.ready) {
    d.verdict.reason = Reason::preparing;
  } else {
    std::swap(d.verdict.used, d.verdict.rival);
    std::swap(d.verdict.used_s, d.verdict.rival_s);
    d.verdict.reason = d.trial ? Reason::trial : Reason::cheaper;
  }
  return d;
}

void Choice::changed(const Decision& decision) {
  before_trial_.reset();
  if (decision.trial) {
    before_trial_ = present_;
    // What is left may pay for trying another one that was never measured.
    trial_purse_s_ = std::max(0.0, trial_purse_s_ - decision.trial_cost_s);
    after_trial_ = true;
  } else {
    // Going back after a trial is what a trial is for, and a cut shows something else. (An animation of 20
    // frames that begins anew with nothing was drawn `inline` at its beginning, and in the sixth round for
    // four frames more than in the first.)
    if (since_change_ < kSoon && !after_trial_ && !cut_)
      penalty_ = std::min(2.0 * penalty_ + 1.0, kMostPenalty);
    after_trial_ = false;
  }
  begin();
}

void Choice::left() {
  after_trial_ = false;
  before_trial_.reset();
  begin();
}

/// With another way.
void Choice::begin() {
  trial_left_ = options_.trial_frames;
  since_change_ = 0;
  kept_lost_s_ = kept_lost_frames_ = 0;
  wanted_frames_ = 0;
  missed_s_ = 0;
}

}  // namespace scenegen::render::model
