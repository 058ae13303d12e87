// How many guesses that something is hidden may be made, by how often guesses of their kind were wrong.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "render/passes/occlusion.h"

namespace scenegen::render {

/// An account of answers that say visible. What a frame does not need is saved up, for cuts; a frame that
/// asks little has some in any case, or nothing would be found where nothing is known to be hidden. Debts are
/// mostly forgiven: a change of view makes many guesses wrong at once, and says nothing of those after it.
class Guesses {
 public:
  /// By why something is guessed and by what is known around it.
  static constexpr std::size_t kKinds = 15;
  /// Of all answers so many may say visible: D allows 30 %, and gathering, at the start, takes some of that.
  static constexpr double kWasted = 0.27;
  /// Those that say visible more often than so are rather wrong, or not worth it though there is room.
  static constexpr double kRatherWrong = 0.5, kHopeless = 0.95;
  /// What is left above this goes to those that are rather wrong (H200, test set 36: 10.4 ms instead
  /// of 11.5).
  static constexpr double kSpare = 8;

  /// How often guesses of a kind were wrong lately.
  [[nodiscard]] double wrong(std::size_t kind) const {
    const Kind& k = kinds_[kind];
    return (k.visible + 0.5 * kWeight) / (k.answers + kWeight);
  }
  void begin() { room_ = std::max(room_, kAtFirst); }
  /// In another view: what was saved stays.
  void begin_anew() {
    kinds_ = {};
    begin();
  }
  /// A frame asks so much about what is believed hidden.
  void begin_frame(double queries) {
    room_ = std::min(room_ + std::max(0.0, kLeast - kWasted * queries), kMost);
  }
  /// Makes one, if more than `spare` is left: a right one makes room, a wrong one takes it.
  [[nodiscard]] bool make(double wrong, double spare) {
    const double taken = wrong - kWasted;
    if (taken + spare > room_) return false;
    room_ -= taken;
    return true;
  }
  /// Of a query about what was believed hidden, or a guess, whose price is set right.
  void learn(const Asked& asked, bool hidden) {
    const double visible = hidden ? 0.0 : 1.0;
    if (asked.believed_hidden) {
      room_ += kWasted - visible;
      return;
    }
    kinds_[asked.guess].answers += 1.0;
    kinds_[asked.guess].visible += visible;
    if (asked.limited) room_ += asked.wrong - visible;
  }
  /// After the answers of a frame.
  void forget() {
    room_ = std::max(room_, -kOwed);
    for (Kind& kind : kinds_) kind = {kMemory * kind.answers, kMemory * kind.visible};
  }

 private:
  // The least that a frame has pays back what is owed in three frames that ask nothing else.
  static constexpr double kAtFirst = 16, kMost = 64, kLeast = 0.8, kOwed = 2;
  // Answers are forgotten by so much a frame, and guessed to be half and half, with so much weight, before.
  static constexpr double kMemory = 0.98, kWeight = 4;

  struct Kind {
    double answers = 0, visible = 0;
  };
  std::array<Kind, kKinds> kinds_;
  double room_ = 0;
};

}  // namespace scenegen::render
