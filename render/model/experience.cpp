#include "render/model/experience.h"

#include <algorithm>
#include <cmath>

#include "render/model/octree_size.h"

namespace scenegen::render::model {
namespace {

Load scaled(Load load, double by) {
  load.draws *= by;
  load.vertices *= by;
  load.triangles *= by;
  load.fragments *= by;
  return load;
}

/// What is seen, by seen_share(), may be wrong by so much; between bricks a town lets twice as much be seen.
constexpr double kMostOff = 4.0;
constexpr double kNewest = 0.25;

double share(double part, double all) {
  return all > 0.0 ? std::clamp(part / all, 0.0, 1.0) : 0.0;
}

}  // namespace

void SlowMean::add(double value) {
  constexpr int kBelieved = 3;
  const double most = std::max(floor_, leap_ * mean_);
  const int side = value > most ? 1 : leap_ * std::max(value, floor_) < mean_ ? -1 : 0;
  if (side == 0 || side * far_ < 0) far_ = 0;
  nearest_far_ = far_ == 0 ? value : side > 0 ? std::min(nearest_far_, value) : std::max(nearest_far_, value);
  far_ += side;
  if (any_ && std::abs(far_) >= kBelieved) {
    mean_ = nearest_far_;
    far_ = 0;
    return;
  }
  const double counted = std::min(value, most);
  mean_ = any_ ? mean_ + weight_ * (counted - mean_) : counted;
  any_ = true;
}

double different_among(double count, double sampled, double different) {
  if (sampled <= 0.0 || different <= 0.0) return 0.0;
  if (sampled >= count) return different;
  // Of p places, m things fall into p (1 - exp(-m / p)): p by bisection.
  const auto seen = [](double places, double things) { return places * -std::expm1(-things / places); };
  double low = different;
  double high = 1e9;
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(low * high);
    (seen(middle, sampled) < different ? low : high) = middle;
  }
  return std::min(seen(low, count), different * count / sampled);
}

void Experience::learn(const FrameFacts& f) {
  if (f.exact_octree && f.chunks > 0.0) {
    visits_ = f.nodes_visited / f.chunks;
    tests_ = f.boxes_tested / f.chunks;
    if (f.commands_per_draw > 0.0) commands_per_draw_ = f.commands_per_draw;
    if (f.runs_per_chunk > 0.0) runs_per_chunk_ = f.runs_per_chunk;
    if (f.in_frustum.draws > 0.0) excess_ = std::clamp(f.in_chunks.draws / f.in_frustum.draws, 1.0, 3.0);
  }
  if (f.exact_seen && f.in_frustum.draws > 0.0) {
    // Slowly, and within bounds: the counts are some frames old, and say nothing after a seek or a cut.
    const auto towards = [&](double& mean, double part) {
      mean = still_seen(mean, f);
      mean += (culled_ ? kNewest : 1.0) * (std::clamp(part / seen_share(f), 1.0 / kMostOff, kMostOff) - mean);
    };
    towards(draws_seen_, share(f.seen.draws, f.in_frustum.draws));
    towards(vertices_seen_, share(f.seen.vertices, f.in_frustum.vertices));
    seen_of_draws_ = f.in_frustum.draws;
    culled_ = true;
  }
  if (f.exact_queries && f.chunks > 0.0) {
    queried_ = true;
    asked_ = share(f.asked, f.chunks);
    asked_fragments_ = f.in_chunks.fragments > 0.0 ? f.asked_fragments / f.in_chunks.fragments : 0.0;
    chunks_hidden_ = share(f.chunks_hidden, f.chunks);
    draws_hidden_ = share(f.hidden.draws, f.in_chunks.draws);
    vertices_hidden_ = share(f.hidden.vertices, f.in_chunks.vertices);
    fragments_hidden_ = share(f.hidden.fragments, f.in_chunks.fragments);
  }
}

/// Of what is in the frustum: of k layers over the picture, one and a half are seen.
double Experience::seen_share(const FrameFacts& f) {
  const double covered = shaded_fragments(f.in_frustum, f.screen_pixels).covered_share * f.screen_pixels;
  const double layers = covered > 0.0 ? f.in_frustum.fragments / covered : 1.0;
  return std::clamp(1.5 / std::max(1.0, layers), 0.02, 1.0);
}

/// What was learned when there was far less or more to see says little: the first few objects of a town are
/// all seen, which would keep `hi-z` from being taken until there are 15 000.
double Experience::still_seen(double mean, const FrameFacts& f) const {
  if (seen_of_draws_ <= 0.0) return mean;
  constexpr double kAlike = 0.3, kFade = 0.7;  // ln
  const double apart = std::abs(std::log(std::max(1.0, f.in_frustum.draws) / seen_of_draws_));
  return std::exp(std::log(mean) * std::exp(-std::max(0.0, apart - kAlike) / kFade));
}

void Experience::fill_seen(FrameFacts& f) const {
  const double covered = shaded_fragments(f.in_frustum, f.screen_pixels).covered_share * f.screen_pixels;
  if (!f.exact_seen) {
    // By how far that was wrong when it was last known: what was seen looking away says little of a street.
    double draws = std::min(1.0, still_seen(draws_seen_, f) * seen_share(f));
    double vertices = std::min(1.0, still_seen(vertices_seen_, f) * seen_share(f));
    // Never known: no more than queries left, which ask about larger things.
    if (!culled_ && queried_) draws = vertices = std::min(draws, 1.0 - draws_hidden_);
    f.seen = scaled(f.in_frustum, vertices);
    f.seen.draws = draws * f.in_frustum.draws;
  }
  // What is seen is nearer than what is not: it has more than its share of the fragments.
  f.seen.textured_share = f.in_frustum.textured_share;
  f.seen.textured_fragment_share = f.in_frustum.textured_fragment_share;
  f.seen.screen_share = f.in_frustum.screen_share;
  const double share_seen = share(f.seen.draws, f.in_frustum.draws);
  f.seen.fragments =
      std::min(f.in_frustum.fragments, std::max(share_seen * f.in_frustum.fragments, 1.5 * covered));
}

void Experience::fill_octree(FrameFacts& f, std::uint32_t per_node, const TouchedChunks& touched) const {
  const auto objects = static_cast<std::uint64_t>(std::max(0.0, f.visible_slots));
  f.height = octree_height(objects, per_node);
  const double nodes = octree_nodes(objects, per_node);  // (3.2), of the whole scene
  const double seen = share(excess_ * f.in_frustum.draws, f.visible_slots);
  f.in_chunks = scaled(f.in_frustum, share(f.in_frustum.draws, f.visible_slots) > 0.0
                                         ? seen / share(f.in_frustum.draws, f.visible_slots)
                                         : 1.0);
  // c_n of (3.15): chunks are rarely full.
  const double c_n = std::min(fill_ * per_node, std::max(1.0, f.visible_slots));
  f.chunks = std::min(std::ceil(f.in_chunks.draws / c_n), std::max(nodes / fill_, 1.0));
  if (f.in_chunks.draws <= 0.0) f.chunks = 0.0;
  f.nodes_visited = visits_ * f.chunks + f.height;
  f.boxes_tested = tests_ * f.chunks + f.height;
  f.chunks_rerecorded = std::min(f.chunks, touched.recorded * seen);
  f.draws_rerecorded = std::min(f.in_chunks.draws, f.chunks_rerecorded * c_n);
  f.chunks_refreshed = touched.changed;
  f.slots_refreshed = std::min(f.visible_slots, touched.left * c_n);
}

void Experience::fill_queries(FrameFacts& f) const {
  if (queried_) {
    f.asked = asked_ * f.chunks;
    f.asked_fragments = asked_fragments_ * f.in_chunks.fragments;
    f.chunks_hidden = chunks_hidden_ * f.chunks;
    f.hidden = {draws_hidden_ * f.in_chunks.draws,
                vertices_hidden_ * f.in_chunks.vertices,
                fragments_hidden_ * f.in_chunks.fragments,
                f.in_chunks.textured_share,
                0,
                vertices_hidden_ * f.in_chunks.triangles};
    return;
  }
  // Never asked: of k layers over the picture, all but the first two or so could be hidden. Chunks are hidden
  // as a whole or not at all; half of that is a guess, until they are asked.
  const Shaded shaded = shaded_fragments(f.in_chunks, f.screen_pixels);
  const double covered = shaded.covered_share * f.screen_pixels;
  const double layers = covered > 0.0 ? f.in_chunks.fragments / covered : 1.0;
  const double hidden = 0.5 * std::clamp(1.0 - 2.0 / layers, 0.0, 0.8);
  f.chunks_hidden = hidden * f.chunks;
  f.hidden = scaled(f.in_chunks, hidden);
  f.asked = std::min(f.chunks, 1.2 * f.chunks_hidden);
  f.asked_fragments = 1.2 * f.hidden.fragments;
}

void Experience::fill_unknown(FrameFacts& f, std::uint32_t per_node, const TouchedChunks& touched) const {
  if (!f.exact_inline && f.exact_octree && f.in_frustum.draws <= 0.0)
    f.in_frustum = scaled(f.in_chunks, 1.0 / excess_);
  if (!f.exact_octree) fill_octree(f, per_node, touched);
  if (f.commands_per_draw <= 0.0) f.commands_per_draw = commands_per_draw_;
  if (f.runs_per_chunk <= 0.0) f.runs_per_chunk = runs_per_chunk_;
  if (!f.exact_queries) fill_queries(f);
  // If everything was asked about, at least as much would be hidden.
  if (f.all_chunks_hidden <= 0.0) {
    f.all_chunks_hidden = f.chunks_hidden;
    f.all_hidden = f.hidden;
    f.all_asked_fragments = f.in_chunks.fragments;
  }
  if (f.slots_hidden.draws <= 0.0)
    f.slots_hidden = scaled(f.in_frustum, share(f.all_hidden.draws, f.in_chunks.draws));
  if (f.hi_z_blocks <= 0.0) f.hi_z_blocks = std::ceil(f.visible_slots / 256.0);
  fill_seen(f);
}

}  // namespace scenegen::render::model
