#include "timeline/profile_plan.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <queue>

namespace scenegen::timeline {
namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();
constexpr int kDropKeys = 6,
              kMoveKeys = 8;  // pieces of a way: straight between keys, bent enough to look eased

std::string seconds(float time_s) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), time_s);
  return std::string(buffer.data(), end.ptr) + " s";
}

bool needs_presence(Profile profile) {
  return profile == Profile::demolish || profile == Profile::move || profile == Profile::operate;
}

bool moves(const ActivitySpan& span) {
  return span.profile == Profile::drop || (span.profile == Profile::move && span.offset_m != glm::vec3(0.0F));
}

tl::unexpected<Error> contradiction(const ActivitySpan& span, const std::string& why) {
  return fail(ErrorKind::usage, "",
              std::string(name(span.profile)) + " at " + seconds(span.start_s) + ": " + why);
}

/// When the object is there.
class Presence {
 public:
  explicit Presence(bool there) : there_at_start_(there), there_(there) {}

  Result<void> take(const ActivitySpan& span) {
    if (there_ && gone_s_ <= span.start_s) leave();
    if (needs_presence(span.profile) && !there_) return contradiction(span, "it is not there then");
    switch (span.profile) {
      case Profile::drop:
        if (there_) return contradiction(span, "it is there already and cannot come down into its place");
        break;
      case Profile::temporary:
        if (there_ && !temporary_)
          return contradiction(span, "it is there already and cannot be there for that time only");
        gone_s_ = there_ ? std::max(gone_s_, span.finish_s) : span.finish_s;
        temporary_ = true;
        break;
      case Profile::demolish:
        gone_s_ = gone_s_ == kNever || temporary_ ? span.finish_s : std::max(gone_s_, span.finish_s);
        temporary_ = false;
        break;
      case Profile::appear:
      case Profile::construct:
      case Profile::neutral:
        if (there_ && gone_s_ != kNever)
          return contradiction(span, "it is going away until " + seconds(gone_s_));
        break;
      default:
        break;
    }
    if (!there_) come(span.start_s);
    return {};
  }

  void finish() {
    if (there_ && gone_s_ != kNever) leave();
  }
  [[nodiscard]] bool there_at_start() const { return there_at_start_; }
  [[nodiscard]] const std::vector<float>& flips_s() const { return flips_s_; }

 private:
  void come(float time_s) {
    there_ = true;
    flip(time_s);
  }
  void leave() {
    there_ = false;
    temporary_ = false;
    flip(gone_s_);
    gone_s_ = kNever;
  }
  /// Two flips at one time cancel each other, so do those at the very beginning.
  void flip(float time_s) {
    if (time_s <= 0) {
      there_at_start_ = !there_at_start_;
    } else if (!flips_s_.empty() && flips_s_.back() == time_s) {
      flips_s_.pop_back();
    } else {
      flips_s_.push_back(time_s);
    }
  }

  bool there_at_start_;
  bool there_;
  bool temporary_ = false;  ///< it is there only until gone_s_, by an activity `temporary`
  float gone_s_ = kNever;   ///< when it will go, as far as is known
  std::vector<float> flips_s_;
};

/// Highlights while the object is there: what it looks like while it is hidden costs no keys.
class Looks {
 public:
  Looks(std::span<const ActivitySpan> spans, const ProfileOptions& options) : spans_(spans) {
    for (const ActivitySpan& span : spans) {
      const bool shown = options.highlight[static_cast<std::size_t>(span.profile)].w > 0.0F;
      lit_.push_back(shown && span.finish_s > span.start_s);
    }
  }

  [[nodiscard]] std::vector<LookKey> keys(bool there_at_start, std::span<const float> flips_s) {
    if (std::none_of(lit_.begin(), lit_.end(), [](bool lit) { return lit; })) return {};
    std::vector<float> times_s{0.0F};
    times_s.insert(times_s.end(), flips_s.begin(), flips_s.end());
    for (std::size_t i = 0; i < spans_.size(); ++i) {
      if (lit_[i]) times_s.insert(times_s.end(), {spans_[i].start_s, spans_[i].finish_s});
    }
    std::sort(times_s.begin(), times_s.end());
    times_s.erase(std::unique(times_s.begin(), times_s.end()), times_s.end());

    std::vector<LookKey> out;
    std::size_t flips = 0;
    for (const float time_s : times_s) {
      while (flips < flips_s.size() && flips_s[flips] <= time_s) ++flips;
      const std::uint8_t look = look_at(time_s);
      if (there_at_start != (flips % 2 == 0)) continue;
      if (!out.empty() && out.back().look == look) continue;
      out.push_back({out.empty() ? 0.0F : time_s, look});
    }
    if (out.size() == 1 && out[0].look == kOwnLook) out.clear();
    return out;
  }

 private:
  /// For ascending times.
  std::uint8_t look_at(float time_s) {
    for (; next_ < spans_.size() && spans_[next_].start_s <= time_s; ++next_) {
      if (lit_[next_]) started_.push(next_);
    }
    while (!started_.empty() && spans_[started_.top()].finish_s <= time_s) started_.pop();
    return started_.empty() ? kOwnLook : static_cast<std::uint8_t>(spans_[started_.top()].profile);
  }

  std::span<const ActivitySpan> spans_;
  std::vector<bool> lit_;
  std::size_t next_ = 0;
  std::priority_queue<std::size_t> started_;  ///< the last that started is on top
};

/// Where the object is.
class Way {
 public:
  explicit Way(float drop_height_m) : drop_height_m_(drop_height_m) {}

  Result<void> take(const ActivitySpan& span) {
    if (!moves(span)) return {};
    if (!keys_.empty() && span.start_s < keys_.back().time_s) {
      return contradiction(span, "it is still on its way until " + seconds(keys_.back().time_s));
    }
    const bool drops = span.profile == Profile::drop;
    if (drops && !(span.finish_s > span.start_s)) return {};
    const glm::vec3 from = drops ? place_m_ + glm::vec3(0, drop_height_m_, 0) : place_m_;
    const glm::vec3 to = drops ? place_m_ : place_m_ + span.offset_m;
    // Before a drop it hangs in the air unseen, before a jump it stays where it was.
    const bool jumps = !(span.finish_s > span.start_s);
    if ((drops && !keys_.empty()) || jumps) add(std::nextafter(span.start_s, 0.0F), place_m_);
    const int pieces = jumps ? 0 : drops ? kDropKeys : kMoveKeys;
    for (int k = 0; k < pieces; ++k) {
      const double u = static_cast<double>(k) / pieces;
      const double left = 1.0 - u;
      const double done = drops ? 1.0 - left * left * left : u * u * (3.0 - 2.0 * u);
      const auto time_s =
          static_cast<float>(span.start_s + (static_cast<double>(span.finish_s) - span.start_s) * u);
      if (k > 0 && !(time_s > keys_.back().time_s && time_s < span.finish_s)) continue;  // too short for it
      add(time_s, glm::vec3(glm::dvec3(from) + (glm::dvec3(to) - glm::dvec3(from)) * done));
    }
    add(span.finish_s, to);
    place_m_ = to;
    return {};
  }
  [[nodiscard]] std::vector<WayKey> keys() && { return std::move(keys_); }

 private:
  /// Replaces keys that float32 cannot tell from it.
  void add(float time_s, const glm::vec3& offset_m) {
    while (!keys_.empty() && !(time_s > keys_.back().time_s)) keys_.pop_back();
    keys_.push_back({time_s, offset_m});
  }

  float drop_height_m_;
  glm::vec3 place_m_{0.0F};
  std::vector<WayKey> keys_;
};

Result<void> check_starts(std::span<const ActivitySpan> spans) {
  for (std::size_t i = 1; i < spans.size(); ++i) {
    const ActivitySpan &a = spans[i - 1], &b = spans[i];
    // What takes no time is over when the other begins.
    if (a.start_s != b.start_s || a.profile == b.profile || !(a.finish_s > a.start_s)) continue;
    return contradiction(b, std::string(name(a.profile)) + " starts at the same time");
  }
  return {};
}

}  // namespace

Result<ObjectPlan> plan_object(std::span<const ActivitySpan> spans, const ProfileOptions& options,
                               float drop_height_m) {
  if (auto r = check_starts(spans); !r) return forward_error(r);
  Presence presence(needs_presence(spans.front().profile));
  Way way(drop_height_m);
  ObjectPlan plan;
  plan.keeps_visibility = true;
  for (const ActivitySpan& span : spans) {
    if (auto r = presence.take(span); !r) return forward_error(r);
    if (auto r = way.take(span); !r) return forward_error(r);
    if (span.profile != Profile::move && span.profile != Profile::operate) plan.keeps_visibility = false;
  }
  presence.finish();
  plan.there_at_start = presence.there_at_start();
  plan.visibility_flip_s = presence.flips_s();
  plan.looks = Looks(spans, options).keys(plan.there_at_start, plan.visibility_flip_s);
  plan.way = std::move(way).keys();
  return plan;
}

}  // namespace scenegen::timeline
