#include "timeline/appearance.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <mutex>

#include "scene/limits.h"
#include "scene/parallel.h"
#include "scene/random.h"
#include "timeline/cell_grid.h"
#include "timeline/track_table.h"

namespace scenegen::timeline {
namespace {

constexpr std::uint32_t kNotTimed = 0xFFFFFFFFU;
// Time of cell n is n * interval: float32 tells at most 2^24 of such times apart.
constexpr std::uint64_t kMostTimedCells = 1U << 24;

std::string text_of(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end.ptr};
}

std::string text_of(glm::uvec3 cells) {
  return std::to_string(cells.x) + "x" + std::to_string(cells.y) + "x" + std::to_string(cells.z);
}

/// When the cell of rank 0, 1, … appears: cells are numbered from 1, so that the scene is empty at t = 0.
float cell_time_s(std::uint64_t rank, double interval_s) {
  return static_cast<float>(static_cast<double>(rank + 1) * interval_s);
}

bool times_increase(std::uint64_t cells, double interval_s) {
  float before = 0.0F;
  for (std::uint64_t rank = 0; rank < cells; ++rank) {
    const float time_s = cell_time_s(rank, interval_s);
    if (!(time_s > before)) return false;
    before = time_s;
  }
  return true;
}

Result<std::uint64_t> checked_cell_count(glm::uvec3 cells) {
  for (int i = 0; i < 3; ++i) {
    if (cells[i] < 1 || cells[i] > limits::kMaxCellsPerAxis) {
      return fail(
          ErrorKind::usage, "--cells",
          text_of(cells) + ": from 1 to " + std::to_string(limits::kMaxCellsPerAxis) + " along an axis");
    }
  }
  const std::uint64_t count = std::uint64_t{cells.x} * cells.y * cells.z;
  constexpr std::uint64_t kMost = std::min(kMostTimedCells, limits::kMaxCells);
  if (count > kMost) {
    return fail(ErrorKind::usage, "--cells",
                text_of(cells) + " = " + std::to_string(count) + " cells: at most " + std::to_string(kMost) +
                    " (256x256x256) have times that differ as float32");
  }
  return count;
}

Result<void> check_interval(const AppearanceOptions& options, std::uint64_t cells) {
  // Below the smallest normal float32, readers may flush times to zero.
  constexpr double kLeast = std::numeric_limits<float>::min();
  const double interval_s = options.interval_s;
  if (!(interval_s >= kLeast)) {
    return fail(
        ErrorKind::usage, "--interval",
        text_of(interval_s) + " s: the smallest that float32 times can keep is " + text_of(kLeast) + " s");
  }
  if (!(options.hold_s >= 0.0 && options.hold_s <= 1e30)) {
    return fail(ErrorKind::usage, "--hold", text_of(options.hold_s) + " s: from 0 to 1e+30 s");
  }
  if (!(interval_s * static_cast<double>(cells) <= kLongest)) {
    return fail(ErrorKind::usage, "--interval",
                text_of(interval_s) + " s: at most " + text_of(kLongest / static_cast<double>(cells)) +
                    " s with " + std::to_string(cells) + " cells, or the last time is no float32");
  }
  if (times_increase(cells, interval_s)) return {};
  // Two neighbouring times fall together where the interval is below the spacing of float32, 2^(e - 23) for
  // times in [2^e, 2^(e+1)). That depends on the interval's mantissa alone: what fails keeps failing up to
  // the next power of two (or a rounding error below it), whose first 2^24 multiples are all exact.
  const double workable_s = std::exp2(std::ceil(std::log2(interval_s)));
  return fail(ErrorKind::usage, "--interval",
              text_of(interval_s) + " s: with " + std::to_string(cells) +
                  " cells some neighbouring times are the same as float32; the next that works is " +
                  text_of(workable_s) + " s");
}

Result<std::uint64_t> check(const Scene& scene, const AppearanceOptions& options,
                            std::span<const std::uint8_t> exempt) {
  if (!exempt.empty() && exempt.size() != scene.objects.size()) {
    return fail(
        ErrorKind::bad_input, "exempt",
        std::to_string(exempt.size()) + " entries for " + std::to_string(scene.objects.size()) + " objects");
  }
  if (!(options.coherence >= 0.0 && options.coherence <= 1.0)) {
    return fail(ErrorKind::usage, "--coherence", text_of(options.coherence) + ": from 0 to 1");
  }
  if (options.seed > limits::kMaxSeed) {
    return fail(ErrorKind::usage, "--seed",
                std::to_string(options.seed) + ": from 0 to " + std::to_string(limits::kMaxSeed));
  }
  Result<std::uint64_t> cells = checked_cell_count(options.cells);
  if (!cells) return cells;
  if (*cells == 1 && options.coherence < 1.0) {
    return fail(
        ErrorKind::usage, "--coherence",
        text_of(options.coherence) + ": must be 1 with one cell, there is no other time to appear at");
  }
  if (Result<void> interval = check_interval(options, *cells); !interval) return forward_error(interval);
  return cells;
}

Box united(std::span<const Box> boxes, std::span<const std::uint8_t> exempt, unsigned threads) {
  Box all;
  std::mutex mutex;
  parallel_for(boxes.size(), threads, [&](std::size_t begin, std::size_t end) {
    Box piece;
    for (std::size_t i = begin; i < end; ++i) {
      if (exempt.empty() || exempt[i] == 0) piece.add(boxes[i]);
    }
    const std::scoped_lock lock(mutex);  // the least and the greatest do not depend on the order
    all.add(piece);
  });
  return all.empty() ? Box{glm::vec3(0.0F), glm::vec3(0.0F)} : z_up_from_y_up(all);
}

/// Displaces V = round(N (1 - C)) of the N timed objects, evenly over their indices. The new time is drawn
/// from the times of all other cells of the grid, whether they hold objects or not: times stay on the lattice
/// n * interval, a displaced object is never at its own cell's time, and its draw depends on nothing but
/// seed, its index and its own cell, so that adding an object elsewhere does not reshuffle the others.
std::uint64_t displace(const AppearanceOptions& options, std::uint64_t cells,
                       std::span<const std::uint32_t> timed, std::vector<std::uint32_t>& rank) {
  const std::uint64_t n = timed.size();
  const auto displaced =
      static_cast<std::uint64_t>(std::llround(static_cast<double>(n) * (1.0 - options.coherence)));
  const Random random(options.seed, "displacement");
  for (std::uint64_t i = 0; i < displaced; ++i) {
    const std::uint32_t object = timed[i * n / displaced];
    const auto other = static_cast<std::uint32_t>(random.below(object, cells - 1));
    rank[object] = other < rank[object] ? other : other + 1;
  }
  return displaced;
}

/// One visibility track a moment, in ascending time; returns how many. Sets the duration.
std::uint64_t add_tracks(Scene& scene, const AppearanceOptions& options, std::uint64_t cells,
                         std::span<const std::uint32_t> rank) {
  std::vector<TrackId> track_of(cells);
  constexpr TrackId kWanted(0);
  for (const std::uint32_t r : rank) {
    if (r != kNotTimed) track_of[r] = kWanted;
  }
  double last_s = 0;
  std::uint64_t moments = 0;
  for (std::uint64_t r = 0; r < cells; ++r) {
    if (!track_of[r].valid()) continue;
    const std::array times{0.0F, cell_time_s(r, options.interval_s)};
    constexpr std::array kValues{0.0F, 1.0F};
    track_of[r] = scene.add_track(Property::visibility, Interpolation::step, times, kValues);
    last_s = times[1];
    ++moments;
  }
  parallel_for(rank.size(), options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (rank[i] != kNotTimed) scene.objects.visibility[i] = track_of[rank[i]];
    }
  });
  scene.duration_s = static_cast<float>(last_s + options.hold_s);
  for (std::size_t i = 0; i < scene.tracks.size(); ++i) {  // movements that were there may last longer
    const std::span<const float> times = scene.times_s(TrackId(i));
    if (!times.empty()) scene.duration_s = std::max(scene.duration_s, times.back());
  }
  return moments;
}

/// Share of the objects to which something happens at a time of their own (starts_s) for which it is their
/// own cell's time.
std::optional<double> share_in_order(const Scene& scene, std::span<const std::uint32_t> own_rank,
                                     double interval_s) {
  std::uint64_t timed = 0;
  std::uint64_t in_order = 0;
  const ObjectStarts starts(scene);
  for (std::size_t i = 0; i < own_rank.size(); ++i) {
    const std::optional<float> start_s = starts.of(ObjectId(i));
    if (!start_s) continue;
    ++timed;
    if (*start_s == cell_time_s(own_rank[i], interval_s)) ++in_order;
  }
  if (timed == 0) return std::nullopt;
  return static_cast<double>(in_order) / static_cast<double>(timed);
}

/// Rank along the curve of every object's own cell.
std::vector<std::uint32_t> own_ranks(std::span<const Box> bounds, const CellGrid& grid,
                                     std::span<const std::uint32_t> rank_of_cell, unsigned threads) {
  std::vector<std::uint32_t> rank(bounds.size());
  parallel_for(bounds.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) rank[i] = rank_of_cell[grid.cell(bounds[i])];
  });
  return rank;
}

/// The curve that a scene's times say they follow.
struct GivenCurve {
  CurveKind kind = CurveKind::hilbert;
  AxisOrder order;
};

Result<GivenCurve> given_curve(const SceneInfo& scene_info) {
  const auto bad = [](const std::string& member, std::string what) {
    return fail(ErrorKind::bad_input, "appearance" + member, std::move(what));
  };
  if (!scene_info.appearance) return bad("", "the scene does not say how its times were given");
  const AppearanceInfo& info = *scene_info.appearance;
  const Result<CurveKind> curve = parse_curve(info.curve);
  if (!curve) return bad(".curve", curve.error().what);
  if (info.curve_variant != variant(*curve)) {
    return bad(".curveVariant", "'" + info.curve_variant.substr(0, 40) + "' is not known; '" +
                                    std::string(variant(*curve)) + "' is");
  }
  const Result<AxisOrder> order = parse_axis_order(info.order);
  if (!order) return bad(".order", order.error().what);
  const Result<std::uint64_t> cells = checked_cell_count(info.cells);
  if (!cells) return bad(".cells", cells.error().what);
  if (!(info.interval_s > 0.0 && info.interval_s * static_cast<double>(*cells) <= kLongest)) {
    return bad(".interval", text_of(info.interval_s) + " s: not above 0, or the last time is no float32");
  }
  return GivenCurve{*curve, *order};
}

}  // namespace

Result<AppearanceInfo> assign_appearance(Scene& scene, const AppearanceOptions& options,
                                         std::span<const std::uint8_t> exempt) {
  Result<std::uint64_t> cells = check(scene, options, exempt);
  if (!cells) return forward_error(cells);

  const std::vector<Box> bounds = placed_bounds(scene, options.threads);
  const Box box_z_up_m = united(bounds, exempt, options.threads);
  const std::vector<std::uint32_t> own =
      own_ranks(bounds, CellGrid(options.cells, box_z_up_m),
                cell_ranks(options.curve, options.cells, options.order), options.threads);

  std::vector<std::uint32_t> rank = own;
  std::vector<std::uint32_t> timed;
  timed.reserve(rank.size());
  for (std::uint32_t i = 0; i < rank.size(); ++i) {
    if (exempt.empty() || exempt[i] == 0) {
      timed.push_back(i);
    } else {
      rank[i] = kNotTimed;
    }
  }

  AppearanceInfo info;
  info.curve = name(options.curve);
  info.curve_variant = variant(options.curve);
  info.order = str(options.order);
  info.cells = options.cells;
  info.grid_z_up_m = box_z_up_m;
  info.interval_s = options.interval_s;
  info.hold_s = options.hold_s;
  info.coherence_given = options.coherence;
  info.timed_objects = timed.size();
  info.displaced_objects = displace(options, *cells, timed, rank);
  remove_visibility_tracks(scene);
  info.moments = add_tracks(scene, options, *cells, rank);
  info.coherence_measured = share_in_order(scene, own, options.interval_s).value_or(1.0);
  info.locality_cells = locality(options.curve, glm::uvec3(32U), options.order).mean_box_side_cells;
  scene.info.appearance = info;
  scene.info.seed = options.seed;
  return info;
}

Result<double> measure_coherence(const Scene& scene, unsigned threads) {
  const Result<GivenCurve> given = given_curve(scene.info);
  if (!given) return tl::unexpected<Error>(given.error());
  const AppearanceInfo& info = *scene.info.appearance;
  const std::vector<std::uint32_t> own =
      own_ranks(placed_bounds(scene, threads), CellGrid(info.cells, info.grid_z_up_m),
                cell_ranks(given->kind, info.cells, given->order), threads);
  const std::optional<double> share = share_in_order(scene, own, info.interval_s);
  if (share) return *share;
  if (info.timed_objects == 0) return 1.0;
  return fail(ErrorKind::bad_input, "appearance", "the scene's tracks do not show when its objects start");
}

Result<std::uint64_t> curve_jumps(const SceneInfo& info) {
  const Result<GivenCurve> given = given_curve(info);
  if (!given) return tl::unexpected<Error>(given.error());
  return locality(given->kind, info.appearance->cells, given->order, 1).jumps;
}

}  // namespace scenegen::timeline
