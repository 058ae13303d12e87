// What is known of ways of drawing that were not taken in a frame: from when they were, else by formulas.
#pragma once

#include <cstdint>

#include "render/model/prediction.h"

namespace scenegen::render::model {

/// A mean that forgets, and that one value cannot throw: it counts as at most `leap` times the mean (and
/// `floor`), so a seek in a scene in which little changes is no sign of much changing. Three in a row that
/// are as far off, to the same side, are one, and the nearest of them is the mean.
class SlowMean {
 public:
  explicit SlowMean(double floor, double weight = 0.1, double leap = 4)
      : floor_(floor), weight_(weight), leap_(leap) {}
  void add(double value);
  [[nodiscard]] double value() const { return mean_; }

 private:
  double floor_, weight_, leap_;
  double mean_ = 0;
  bool any_ = false;
  int far_ = 0;             // values in a row that were far off; below 0: below the mean
  double nearest_far_ = 0;  // of them
};

/// How many different ones there are among `count` things, if a sample of `sampled` of them had `different`:
/// things are taken to fall evenly into an unknown number of places.
[[nodiscard]] double different_among(double count, double sampled, double different);

/// Chunks of the whole octree that changes of a frame touch.
struct TouchedChunks {
  double recorded = 0;  ///< something in them appeared, vanished or changed its look
  double changed = 0;   ///< or moved
  double left = 0;      ///< something in them vanished or moved: boxes and sums are made anew
};

/// Ratios that were seen, and fill_unknown() makes counts of.
class Experience {
 public:
  /// Takes the exact parts of facts in.
  void learn(const FrameFacts& facts);
  /// Fills the parts that are not exact: the octree's by (3.1), (3.2), (3.14), (3.15) for nodes of `per_node`
  /// objects.
  void fill_unknown(FrameFacts& facts, std::uint32_t per_node, const TouchedChunks& touched) const;

 private:
  void fill_octree(FrameFacts& facts, std::uint32_t per_node, const TouchedChunks& touched) const;
  void fill_queries(FrameFacts& facts) const;
  void fill_seen(FrameFacts& facts) const;
  [[nodiscard]] static double seen_share(const FrameFacts& facts);
  [[nodiscard]] double still_seen(double mean, const FrameFacts& facts) const;

  // Until something was seen: half-full to full chunks; some of a chunk in the frustum lies outside it.
  double fill_ = 0.7;                                  // draws in a chunk / objects a node
  double excess_ = 1.15;                               // draws in chunks in the frustum / draws in it
  double visits_ = 1.3, tests_ = 2.0;                  // a chunk
  double commands_per_draw_ = 1, runs_per_chunk_ = 1;  // indirect draws
  bool queried_ = false;
  double asked_ = 0, asked_fragments_ = 0;       // of chunks; of their fragments
  double chunks_hidden_ = 0, draws_hidden_ = 0;  // of them
  double vertices_hidden_ = 0, fragments_hidden_ = 0;
  bool culled_ = false;
  double draws_seen_ = 1, vertices_seen_ = 1;  // by culling on the device / seen_share()
  double seen_of_draws_ = 0;                   // in the frustum then
};

}  // namespace scenegen::render::model
