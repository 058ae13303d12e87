#include "render/strategy/estimate_load.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

namespace scenegen::render {
namespace {

/// The picture in cells: how much of each is covered, by things that do not know of each other.
class Coverage {
 public:
  explicit Coverage(const ScreenArea& screen) : screen_(screen) {}

  /// `times` like it lie about there. The fragments that are in the picture, of one.
  double add(const ScreenArea::Spot& spot, double filled, double times) {
    const glm::dvec2 cell = screen_.size() / glm::dvec2(kColumns, kRows);
    const glm::dvec2 lo = (spot.middle - 0.5 * spot.sides) / cell;
    const glm::dvec2 hi = (spot.middle + 0.5 * spot.sides) / cell;
    double inside = 0.0;
    const auto part = [](double from, double to, int i) {
      return std::max(0.0, std::min(to, i + 1.0) - std::max(from, static_cast<double>(i)));
    };
    for (int y = first(lo.y); y < std::min<double>(kRows, hi.y); ++y) {
      for (int x = first(lo.x); x < std::min<double>(kColumns, hi.x); ++x) {
        const double share = part(lo.x, hi.x, x) * part(lo.y, hi.y, y) * filled;
        inside += share;
        open_[static_cast<std::size_t>(y) * kColumns + static_cast<std::size_t>(x)] += times * ln_open(share);
      }
    }
    return inside * cell.x * cell.y;
  }
  [[nodiscard]] double share() const {
    double sum = 0.0;
    for (const double open : open_) sum -= std::expm1(open);
    return sum / static_cast<double>(open_.size());
  }

 private:
  static constexpr int kColumns = 16, kRows = 9;
  static constexpr double kAll = 0.9999;
  static int first(double at) { return static_cast<int>(std::clamp(at, 0.0, 1e6)); }
  /// ln(1 - share); by the series where the share is small, as nearly all are.
  static double ln_open(double share) {
    if (share < 0.01) return -share * (1.0 + share * (0.5 + share / 3.0));  // off by less than 3e-9
    return std::log1p(-std::min(share, kAll));
  }

  const ScreenArea& screen_;
  std::array<double, kColumns * kRows> open_{};  // logarithms of the open share
};

/// Things of which one was sampled lie at most so many layers deep over the picture.
constexpr double kDeepest = 4.0;

/// Sums up some slots of many, then scales.
class Sample {
 public:
  /// `all`: nothing is left out.
  Sample(const DrawScene& scene, const ScreenArea& screen, bool all)
      : scene_(scene), screen_(screen), all_(all) {}

  /// Large slots do not stand for others: of a sample they are left out, and counted one by one.
  void add(std::uint32_t slot) {
    const DrawPrimitive& primitive = scene_.primitive(slot);
    if (!all_ && scene_.large(slot)) return;
    spots_[taken_++] = {screen_.spot(scene_.boxes().get(slot)), primitive.work.covered_share};
    vertices_ += primitive.work.vertices;
    triangles_ += primitive.work.triangles;
    textured_ += scene_.batches()[primitive.batch].state.texture_set != 0 ? 1.0 : 0.0;
  }

  [[nodiscard]] double vertices() const { return vertices_; }
  [[nodiscard]] double triangles() const { return triangles_; }
  [[nodiscard]] model::Load scaled(std::size_t draws) const {
    model::Load load;
    if (taken_ == 0) return load;
    load.draws = static_cast<double>(draws);
    const double scale = load.draws / static_cast<double>(taken_);
    load.vertices = scale * vertices_;
    load.triangles = scale * triangles_;
    load.textured_share = textured_ / static_cast<double>(taken_);
    Coverage coverage(screen_);
    for (std::size_t i = 0; i < taken_; ++i) {
      const auto& [spot, filled] = spots_[i];
      // What fills the picture because it is near stands for itself, not for hundreds of its kind.
      const double like = std::min(
          scale, std::max(1.0, kDeepest * screen_.pixels() / std::max(1.0, filled * spot.fragments())));
      load.fragments += like * coverage.add(spot, filled, like);
    }
    if (!all_) {
      for (const std::uint32_t slot : scene_.large_slots()) {
        if (scene_.visible().test(slot))
          load.fragments += coverage.add(screen_.spot(scene_.boxes().get(slot)),
                                         scene_.primitive(slot).work.covered_share, 1.0);
      }
    }
    load.screen_share = coverage.share();
    return load;
  }

 private:
  const DrawScene& scene_;
  const ScreenArea& screen_;
  bool all_;
  std::size_t taken_ = 0;
  double vertices_ = 0, triangles_ = 0, textured_ = 0;
  std::array<std::pair<ScreenArea::Spot, double>, kSampledSlots> spots_;  // no memory is asked for in a frame
};

/// The middles of kSampledSlots equal parts of `count` things; all of them when there are no more.
class Steps {
 public:
  explicit Steps(std::size_t count) : count_(count), parts_(std::min(count, kSampledSlots)) {}
  /// Is there one left below `end`? Then at() is it.
  [[nodiscard]] bool below(std::size_t end) const { return part_ < parts_ && at() < end; }
  [[nodiscard]] std::size_t at() const { return (2 * part_ + 1) * count_ / (2 * parts_); }
  void next() { ++part_; }

 private:
  std::size_t count_, parts_, part_ = 0;
};

/// What octrees know of chunks.
struct Sums {
  std::size_t slots = 0;
  double vertices = 0, triangles = 0;
};
Sums sums_of(const Octree& tree, std::span<const std::uint32_t> chunks) {
  Sums all;
  for (const std::uint32_t number : chunks) {
    const Octree::Content& content = tree.chunk(number).content;
    all.slots += content.slots;
    all.vertices += static_cast<double>(content.vertices);
    all.triangles += static_cast<double>(content.triangles);
  }
  return all;
}

std::uint64_t solid_bits(const DrawScene& scene, std::size_t word) {
  const std::uint64_t bits = scene.visible().words()[word];
  const std::size_t end = scene.solid_end();
  if (64 * word + 64 <= end) return bits;
  return 64 * word >= end ? 0 : bits & ~(~std::uint64_t{0} << (end % 64));
}

}  // namespace

ScreenArea::ScreenArea(const View& view, glm::uvec2 size) {
  screen_.width = size.x;
  screen_.height = size.y;
  clip_from_world_ = view.clip_from_world;
  right_ = glm::dvec3(view.world_from_camera[0]);
  up_ = glm::dvec3(view.world_from_camera[1]);
  screen_.eye_m = view.eye_m();
  screen_.forward = view.forward();
  screen_.near_m = view.lens.near_m;
  if (view.lens.orthographic) {
    per_m2_ = pixels() * 0.25 * std::abs(static_cast<double>(view.clip_from_camera[0][0])) *
              std::abs(static_cast<double>(view.clip_from_camera[1][1]));
  } else {
    screen_.yfov_rad = 2.0 * std::atan(1.0 / std::abs(static_cast<double>(view.clip_from_camera[1][1])));
    per_m_ = 0.5 * screen_.height * std::abs(static_cast<double>(view.clip_from_camera[1][1]));
  }
}

double ScreenArea::fragments(const Box& box, double occupied) const {
  if (per_m2_ == 0.0) return model::box_fragments(box, occupied, screen_);
  if (box.empty()) return 0.0;
  const glm::dvec3 s(box.size());
  return std::min(pixels(), per_m2_ * (s.x * s.y + s.y * s.z + s.z * s.x) / 3.0 * occupied);
}

double ScreenArea::fragments(const Octree::Content& content) const {
  return fragments(content.box_m, model::occupied_share(content.area_m2, content.box_m));
}

ScreenArea::Spot ScreenArea::spot(const Box& box) const {
  if (box.empty()) return {};
  const glm::dvec3 middle(box.centre());
  const glm::dvec4 clip = clip_from_world_ * glm::dvec4(middle, 1.0);
  const glm::dvec3 s(box.size());
  const double distance = glm::dot(middle - screen_.eye_m, screen_.forward);
  Spot out;
  if (per_m2_ != 0.0 || distance > std::max(screen_.near_m, glm::length(s))) {
    const glm::dvec3 seen_from =
        per_m2_ != 0.0 ? glm::abs(screen_.forward) : glm::abs(glm::normalize(middle - screen_.eye_m));
    const double face_m2 = glm::dot(seen_from, glm::dvec3(s.y * s.z, s.z * s.x, s.x * s.y));
    // A plane is hit the more aslant the farther it is from the middle of the picture.
    const double slant = per_m2_ != 0.0 ? 1.0 : glm::length(middle - screen_.eye_m) / distance;
    const double per_m = per_m_ / distance;
    const double fragments = face_m2 * slant * (per_m2_ != 0.0 ? per_m2_ : per_m * per_m);
    const double wide = std::max(glm::dot(glm::abs(right_), s), 1e-9 * glm::length(s));
    const double high = std::max(glm::dot(glm::abs(up_), s), 1e-9 * glm::length(s));
    if (fragments > 0.0)
      out.sides = std::sqrt(fragments) * glm::dvec2(std::sqrt(wide / high), std::sqrt(high / wide));
    out.middle = 0.5 * (1.0 + glm::dvec2(clip) / clip.w) * size();
    return out;
  }
  out.sides = std::sqrt(model::box_fragments(box, 1.0, screen_) / pixels()) * size();
  out.middle = 0.5 * size();
  return out;
}

model::Load load_of_slots(const DrawScene& scene, std::span<const std::uint32_t> slots,
                          const ScreenArea& screen, std::size_t each_stands_for) {
  const bool solid = !slots.empty() && slots.front() < scene.solid_end();
  Sample sample(scene, screen, each_stands_for == 1 && (!solid || slots.size() <= kSampledSlots));
  for (Steps steps(slots.size()); steps.below(slots.size()); steps.next()) sample.add(slots[steps.at()]);
  return sample.scaled(slots.size() * each_stands_for);
}

model::Load load_of_visible(const DrawScene& scene, const ScreenArea& screen) {
  const std::size_t words = (scene.solid_end() + std::size_t{63}) / 64;
  std::size_t count = 0;
  for (std::size_t w = 0; w < words; ++w)
    count += static_cast<std::size_t>(std::popcount(solid_bits(scene, w)));
  Sample sample(scene, screen, count <= kSampledSlots);
  Steps steps(count);
  std::size_t passed = 0;
  for (std::size_t w = 0; w < words; ++w) {
    std::uint64_t bits = solid_bits(scene, w);
    const std::size_t end = passed + static_cast<std::size_t>(std::popcount(bits));
    for (; steps.below(end); steps.next()) {
      for (; passed < steps.at(); ++passed) bits &= bits - 1;
      sample.add(static_cast<std::uint32_t>(64 * w + static_cast<unsigned>(std::countr_zero(bits))));
    }
    passed = end;
  }
  return sample.scaled(count);
}

model::Load load_of_chunks(const DrawScene& scene, const Octree& tree, std::span<const std::uint32_t> chunks,
                           const ScreenArea& screen) {
  const Sums all = sums_of(tree, chunks);
  Sample sample(scene, screen, all.slots <= kSampledSlots);
  Steps steps(all.slots);
  std::size_t passed = 0;
  for (const std::uint32_t number : chunks) {
    const std::vector<std::uint32_t>& slots = tree.chunk(number).slots;
    for (; steps.below(passed + slots.size()); steps.next()) sample.add(slots[steps.at() - passed]);
    passed += slots.size();
  }
  model::Load load = sample.scaled(all.slots);
  load.vertices = all.vertices;
  load.triangles = all.triangles;
  return load;
}

void add_scene_facts(const DrawScene& scene, const ScreenArea& screen, model::FrameFacts& facts) {
  std::size_t visible = 0;
  for (const std::uint64_t bits : scene.visible().words())
    visible += static_cast<std::size_t>(std::popcount(bits));
  facts.visible_slots = static_cast<double>(visible);
  facts.screen_pixels = screen.pixels();
}

model::Load load_in_frustum(const DrawScene& scene, const Octree& tree, std::span<const std::uint32_t> chunks,
                            const CullPlanes& planes, const ScreenArea& screen) {
  const Sums all = sums_of(tree, chunks);
  Sample sample(scene, screen, all.slots <= kSampledSlots);
  Steps steps(all.slots);
  std::size_t passed = 0;
  std::size_t inside = 0;
  double sampled_vertices = 0;
  double sampled_triangles = 0;
  std::size_t taken = 0;
  for (const std::uint32_t number : chunks) {
    const std::vector<std::uint32_t>& slots = tree.chunk(number).slots;
    for (; steps.below(passed + slots.size()); steps.next(), ++taken) {
      const std::uint32_t slot = slots[steps.at() - passed];
      sampled_vertices += scene.primitive(slot).work.vertices;
      sampled_triangles += scene.primitive(slot).work.triangles;
      const auto sides = planes.all();
      const Box box = scene.boxes().get(slot);
      if (std::any_of(sides.begin(), sides.end(),
                      [&](const CullPlane& plane) { return side_of(plane, box) == Side::outside; }))
        continue;
      sample.add(slot);
      ++inside;
    }
    passed += slots.size();
  }
  model::Load load = sample.scaled(taken == 0 ? 0 : inside * all.slots / taken);
  // How many there are in the chunks is known, and only a share is to be estimated: where few slots have most
  // of the vertices, the sample alone says 40 % too much or too little from frame to frame.
  if (sampled_vertices > 0.0) load.vertices = all.vertices * sample.vertices() / sampled_vertices;
  if (sampled_triangles > 0.0) load.triangles = all.triangles * sample.triangles() / sampled_triangles;
  return load;
}

}  // namespace scenegen::render
