// Which way of drawing to take for the next frame (D 3.3): by predictions, corrected by what frames really
// took, and not changed more often than it pays.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "render/model/prediction.h"

namespace scenegen::render::model {

/// Seconds of a frame on both sides.
struct Sides {
  double cpu_s = 0, gpu_s = 0;
};

/// A slow, bounded correction: measured time / predicted time, on each side the product of a factor of the
/// machine (others may use it too) and one of the way of drawing. What drifts while a way is taken is the
/// machine's, and holds for all ways; what jumps when a way is taken is its own. So a way that is not taken
/// keeps its relation to the others, and one that never was has the factor of its nearest relative. The
/// product stays in [1/2, 2]. A device that is no processor is hardly shared, and has a clock of its own:
/// what drifts there is mostly that a scene grows beyond what the unit costs were measured on, and more than
/// half of it is the way's own. There a way that was measured when it had far less or more to do has the
/// benefit of the doubt: what is shared with the way that is taken, or all of that one's if that is less.
class Correction {
 public:
  explicit Correction(bool device_shared = true) : device_shared_(device_shared) {}
  /// A frame drawn by `method`; `since_change`: frames since another way was taken. `taken` < 0: not
  /// measured.
  void measured(Method method, std::uint32_t since_change, const Sides& predicted, const Sides& taken);
  [[nodiscard]] Sides corrected(Method method, const Sides& predicted) const;
  /// Was this way, or a near relative, ever measured?
  [[nodiscard]] bool knows(Method method) const;

 private:
  struct Side {
    double machine = 0;                          // ln
    std::array<double, kMethods> own{};          // ln
    std::array<double, kMethods> predicted_s{};  // when last measured; 0: never
  };
  /// `machines`: what drifts is the machine's alone.
  void learn(Side& side, Method method, bool fresh, bool machines, double predicted_s, double taken_s) const;
  [[nodiscard]] double factor(const Side& side, Method method, double predicted_s) const;
  /// Of what was measured, in 0..1.
  [[nodiscard]] double trust(const Side& side, Method method, double predicted_s) const;
  /// Itself, if it was measured.
  [[nodiscard]] Method known_relative(Method method) const;

  bool device_shared_;
  Side cpu_, gpu_;
  Method last_ = Method::inline_frustum;          // measured
  std::array<std::uint32_t, kMethods> frames_{};  // measured
};

/// A way that could be taken.
struct Offer {
  Method method = Method::inline_frustum;
  double frame_s = 0;    ///< what a frame takes (2.12), in steady state
  double change_s = 0;   ///< what changing to it costs once: building, bringing up to date, recording
  bool possible = true;  ///< can it be taken at all?
  bool ready = true;     ///< at once; otherwise it has to be prepared first
};

/// Why a way was taken or kept.
enum class Reason : std::uint8_t {
  cheaper,    ///< no other way is predicted to take less
  too_near,   ///< another takes less, but by less than the margin
  patience,   ///< another takes less, but not for long enough yet
  no_pay,     ///< another takes less, but changing to it would not pay back
  preparing,  ///< another takes less, and is being prepared, a slice a frame
  trial,      ///< just taken: kept for some frames to measure it
  forced,     ///< by an option for tests
  alone       ///< no other is possible
};

/// What was chosen, and both sides of the inequality; `rival` is the best of the others.
struct Verdict {
  Method used = Method::inline_frustum;
  Method rival = Method::inline_frustum;
  double used_s = 0, rival_s = 0;
  Reason reason = Reason::alone;
};
/// "octree: 2.10 ms against inline 5.71 ms".
[[nodiscard]] std::string in_words(const Verdict& verdict);

struct ChoiceOptions {
  double margin = 0.03;  ///< another way must take less by this share
  double frames = 3;     ///< for so many frames in a row
  double at_once = 0.4;  ///< or at once after a cut, trial or not, when it takes less by this share
  /// and by this share of what frames took before. An animation of frames of 0.2 s that begins anew with one
  /// of next to nothing would save 0.01 s, and lose more where going back to `hi-z` draws two frames
  /// unculled.
  double at_once_of_usual = 0.25;
  double penalty_frames = 0.25;  ///< or so many frames' time missed, for each change soon after another
  double horizon_frames = 60;    ///< and pay back its change within so many, or have missed as much already
  double trial_share = 0.01;     ///< of the time goes into trials at most; 0: none
  /// And so many frames' time in advance. Without it, building an octree of 200 000 objects for a first trial
  /// (60 ms) is put off for 800 frames of 8 ms.
  double advance_frames = 12;
  /// But no more seconds: of frames that take 0.2 s each, twelve would be noticed, and of a run of twenty be
  /// the most. A trial takes two frames' time at least: above 50 ms the first is saved up for as others are.
  double advance_s = 0.1;
  double trial_frames = 20;        ///< how long one takes, and how long any way is kept
  double trial_judged_frames = 8;  ///< but a trial is over after so many
  double trial_loss = 0.05;        ///< when its frames take so much more than one's that is ready
  /// And any way that was just taken is left when, in at least `frames`, it has cost so many frames of
  /// another that is ready more than that would have (a way that takes twice as long: after three), after
  /// changes in a row up to twice as many, and as much as changing costs. Of the other's frames: in a scene
  /// that grows by a twentieth a frame, the present way's outgrow what was lost.
  double kept_loss_frames = 1.5;
  double trial_reach = 1.3;         ///< only of ways predicted to take at most this much more
  double trial_again_frames = 600;  ///< a way is tried again when it was not taken for so many
  /// And once in what a cut shows when it is predicted to take at most this share more: models are no better
  /// than that. (25 000 draws of which none hides another on an H200: `hi-z` was taken to cost 1 % less than
  /// `inline` and the octree, and costs 4 % more.)
  double near_share = 0.05;
  double near_frames = 20;      ///< after the cut, when what was measured is of what is shown
  double regret_share = 0.005;  ///< after a trial, what was before is better when it takes less by this share
};

/// Hysteresis, and trials. A change soon after a change doubles what has to be missed before the next (up to
/// 15 times penalty_frames), which wears off.
class Choice {
 public:
  explicit Choice(const ChoiceOptions& options = {}) : options_(options) { since_taken_.fill(1e6); }

  struct Decision {
    Verdict verdict;
    std::size_t take =
        0;  ///< index of the offer to take: the present one, or another one now (or to prepare)
    bool trial = false;
    double trial_cost_s = 0;  ///< what one was saved up for
  };
  /// `elapsed`: frames since the last decision. `correction`: what was measured, null when nothing is
  /// learned. `cut`: this frame shows something else than the one before.
  /// Offers keep their numbers from one decision to the next; at most kMethods.
  [[nodiscard]] Decision decide(std::span<const Offer> offers, std::size_t present, std::uint32_t elapsed,
                                const Correction* correction, bool cut = false);
  /// A decision was carried out. (One that asks for a way that has to be prepared is repeated until then.)
  void changed(const Decision& decision);
  /// A way was left without a decision, for something in this frame alone.
  void left();

  /// Is a way kept to measure it?
  [[nodiscard]] bool in_trial() const { return after_trial_ && trial_left_ > 0.0; }
  [[nodiscard]] std::uint32_t since_change() const { return static_cast<std::uint32_t>(since_change_); }

 private:
  [[nodiscard]] double trial_cost_s(const Offer& now, const Offer& other, bool known) const;
  /// Is it time to try it, and is it predicted to take little enough?
  [[nodiscard]] bool in_reach(const Offer& now, const Offer& other, std::size_t number, bool known) const;
  /// The offer to try, if it can be paid: of those in reach that were never measured the one predicted to
  /// take least, without any of the others; offers.size(): none. While the best is being prepared, only one
  /// that was never measured and is ready.
  [[nodiscard]] std::size_t to_try(std::span<const Offer> offers, std::size_t present, bool preparing,
                                   const Correction& correction) const;
  /// What speaks against a change; nothing: it is to be made.
  [[nodiscard]] std::optional<Reason> objection(const Offer& now, const Offer& other, std::size_t number,
                                                double elapsed);
  void pass(double elapsed, std::size_t present, double frame_s);
  /// A trial that is over: is what was before better after all?
  [[nodiscard]] bool regretted(std::span<const Offer> offers, const Offer& now);
  void begin();
  [[nodiscard]] bool far_better(const Offer& other, const Offer& now) const;
  /// Another that is to be taken instead of a way that was just taken, and loses: a trial that lasted long
  /// enough to be judged, or any when it lost enough.
  [[nodiscard]] std::optional<std::size_t> lost_to(std::span<const Offer> offers, std::size_t present,
                                                   double elapsed);

  ChoiceOptions options_;
  std::size_t wanted_ = 0;
  double wanted_frames_ = 0;
  double missed_s_ = 0;  // by not changing to what is wanted
  double since_change_ = 1e6;
  double since_cut_ = 1e6;
  std::array<double, kMethods> since_taken_{};  // of offers, frames
  std::size_t present_ = 0;                     // at the last decision
  std::optional<std::size_t> before_trial_;     // until it is judged
  double penalty_ = 0;
  double trial_left_ = 0;   // frames
  double kept_lost_s_ = 0;  // meanwhile, to what would have been better
  double kept_lost_frames_ = 0;
  double trial_purse_s_ = -1;  // below 0: the advance was not paid yet
  bool after_trial_ = false;
  bool cut_ = false;
  bool first_cut_ = false;  // cuts in a row are a camera or a scene that moves fast
  double usual_s_ = -1;     // mean of the present ways' frames; below 0: of none yet
};

}  // namespace scenegen::render::model
