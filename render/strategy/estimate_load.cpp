#include "render/strategy/estimate_load.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "render/strategy/draw_list.h"

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

  /// Large slots do not stand for others: of a sample they are left out, and counted one by one. `weight`:
  /// against others of the sample.
  void add(std::uint32_t slot, double weight = 1.0) {
    const DrawPrimitive& primitive = scene_.primitive(slot);
    if (!all_ && scene_.large(slot)) return;
    const bool with_textures = textured(slot);
    spots_[taken_++] = {screen_.spot(scene_.boxes().get(slot)), primitive.work.covered_share, weight,
                        with_textures};
    weights_ += weight;
    vertices_ += weight * primitive.work.vertices;
    triangles_ += weight * primitive.work.triangles;
    textured_ += with_textures ? weight : 0.0;
  }

  [[nodiscard]] double vertices() const { return vertices_; }
  [[nodiscard]] double triangles() const { return triangles_; }
  [[nodiscard]] model::Load scaled(double draws) const {
    model::Load load;
    if (draws <= 0.0) return load;
    load.draws = draws;
    const double scale = weights_ > 0.0 ? draws / weights_ : 0.0;  // 0: all that was met is large
    load.vertices = scale * vertices_;
    load.triangles = scale * triangles_;
    if (weights_ > 0.0) load.textured_share = textured_ / weights_;
    Coverage coverage(screen_);
    double textured_fragments = 0.0;
    for (std::size_t i = 0; i < taken_; ++i) {
      const auto& [spot, filled, weight, textured] = spots_[i];
      // What fills the picture because it is near stands for itself, not for hundreds of its kind.
      const double like =
          std::min(scale * weight,
                   std::max(1.0, kDeepest * screen_.pixels() / std::max(1.0, filled * spot.fragments())));
      const double fragments = like * coverage.add(spot, filled, like);
      load.fragments += fragments;
      if (textured) textured_fragments += fragments;
    }
    if (!all_) {
      for (const std::uint32_t slot : scene_.large_slots()) {
        if (!scene_.visible().test(slot)) continue;
        const double fragments = coverage.add(screen_.spot(scene_.boxes().get(slot)),
                                              scene_.primitive(slot).work.covered_share, 1.0);
        load.fragments += fragments;
        if (textured(slot)) textured_fragments += fragments;
      }
    }
    load.screen_share = coverage.share();
    if (load.fragments > 0.0) load.textured_fragment_share = textured_fragments / load.fragments;
    return load;
  }

 private:
  struct Seen {
    ScreenArea::Spot spot;
    double filled = 0;
    double weight = 1;
    bool textured = false;
  };
  [[nodiscard]] bool textured(std::uint32_t slot) const {
    return scene_.batches()[scene_.primitive(slot).batch].state.texture_set != 0;
  }

  const DrawScene& scene_;
  const ScreenArea& screen_;
  bool all_;
  std::size_t taken_ = 0;
  double weights_ = 0, vertices_ = 0, triangles_ = 0, textured_ = 0;
  std::array<Seen, kSampledSlots> spots_;  // no memory is asked for in a frame
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

/// What slots of strata take.
class Exact {
 public:
  void add(const Stratum& stratum, double draws) {
    draws_ += draws;
    vertices_ += draws * stratum.work.vertices;
    triangles_ += draws * stratum.work.triangles;
    if (stratum.textured) textured_ += draws;
  }
  [[nodiscard]] model::Load into(model::Load load) const {
    load.vertices = vertices_;
    load.triangles = triangles_;
    if (draws_ > 0.0) load.textured_share = textured_ / draws_;
    return load;
  }

 private:
  double draws_ = 0, vertices_ = 0, triangles_ = 0, textured_ = 0;
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

/// Bits of a word that are slots of a stratum.
std::uint64_t bits_of(const Stratum& stratum, std::span<const std::uint64_t> words, std::size_t word) {
  std::uint64_t bits = words[word];
  if (stratum.first > 64 * word) bits &= ~std::uint64_t{0} << (stratum.first - 64 * word);
  if (stratum.end < 64 * word + 64) bits &= ~(~std::uint64_t{0} << (stratum.end - 64 * word));
  return bits;
}

/// Words of slots that stand for others of their stratum.
class SampledFrustum {
 public:
  SampledFrustum(const DrawScene& scene, DrawList& list)
      : scene_(scene),
        list_(list),
        words_(scene.visible().words()),
        whole_{0, scene.solid_end(), {}, false},
        strata_(scene.strata().empty() ? std::span(&whole_, 1) : scene.strata()) {
    for (std::size_t i = 0; i < strata_.size(); ++i) {
      if (strata_[i].first < strata_[i].end) count(strata_[i], parts_[i]);
      visible_ += parts_[i].visible;
      vertices_ += parts_[i].visible * strata_[i].work.vertices;
    }
    list.clear();
    // As many as it can ever be, so that no later frame asks for memory.
    list.solid.reserve(
        std::min<std::size_t>(scene.solid_end(), 64 * (kSampledWords + 5 * DrawScene::kMostStrata)));
    list.inside.assign(words_.size(), 0);
  }

  /// Their visible slots into list.inside.
  void choose_words() {
    for (std::size_t i = 0; i < strata_.size(); ++i) {
      Part& part = parts_[i];
      if (part.visible <= 0.0) continue;
      // Half by number, half by what they take; a few of each.
      const double number = part.visible / visible_;
      const double heavy = vertices_ > 0.0 ? part.visible * strata_[i].work.vertices / vertices_ : number;
      part.looked_at = std::clamp(static_cast<std::size_t>(std::ceil(0.5 * (number + heavy) * kSampledWords)),
                                  std::min<std::size_t>(4, part.shown), part.shown);
      each_word(i, [&](std::size_t w) { list_.inside[w] |= bits_of(strata_[i], words_, w); });
    }
  }

  /// Once list.inside is what is in the frustum.
  void list() {
    for (std::size_t i = 0; i < strata_.size(); ++i) {
      Part& part = parts_[i];
      double tested = 0;
      double inside = 0;
      each_word(i, [&](std::size_t w) {
        tested += std::popcount(bits_of(strata_[i], words_, w));
        for (std::uint64_t bits = bits_of(strata_[i], list_.inside, w); bits != 0; bits &= bits - 1, ++inside)
          list_.solid.push_back(
              static_cast<std::uint32_t>(64 * w + static_cast<unsigned>(std::countr_zero(bits))));
      });
      part.end = list_.solid.size();
      list_.tested += static_cast<std::uint64_t>(tested);
      all_ = all_ && tested == part.visible;
      part.weight = tested > 0.0 ? part.visible / tested : 0.0;
      draws_ += part.weight * inside;
      exact_.add(strata_[i], part.weight * inside);
    }
  }

  [[nodiscard]] model::Load load(const ScreenArea& screen) const {
    const std::size_t count = list_.solid.size();
    Sample sample(scene_, screen, all_ && count <= kSampledSlots);
    std::size_t part = 0;
    for (Steps steps(count); steps.below(count); steps.next()) {
      while (steps.at() >= parts_[part].end) ++part;
      sample.add(list_.solid[steps.at()], parts_[part].weight);
    }
    const model::Load load = sample.scaled(draws_);
    return scene_.strata().empty() ? load : exact_.into(load);
  }

 private:
  struct Part {
    std::size_t first_word = 0;
    std::size_t shown = 0, looked_at = 0;  // words in which something is visible, and those looked at
    double visible = 0, weight = 0;
    std::size_t end = 0;  // of its slots in the list
  };

  void count(const Stratum& stratum, Part& part) const {
    part.first_word = stratum.first / 64;
    for (std::size_t w = part.first_word; w <= (stratum.end - 1) / 64; ++w) {
      const std::uint64_t bits = bits_of(stratum, words_, w);
      part.visible += std::popcount(bits);
      part.shown += bits != 0 ? 1 : 0;
    }
  }
  /// Equal steps over the words that have something to show.
  template <class Body>
  void each_word(std::size_t i, const Body& body) const {
    const Part& part = parts_[i];
    std::size_t rank = 0;
    std::size_t k = 0;
    for (std::size_t w = part.first_word; k < part.looked_at; ++w) {
      if (bits_of(strata_[i], words_, w) == 0) continue;
      if (rank++ != (2 * k + 1) * part.shown / (2 * part.looked_at)) continue;
      body(w);
      ++k;
    }
  }

  const DrawScene& scene_;
  DrawList& list_;
  std::span<const std::uint64_t> words_;
  Stratum whole_;
  std::span<const Stratum> strata_;
  std::array<Part, DrawScene::kMostStrata> parts_;
  double visible_ = 0, vertices_ = 0, draws_ = 0;
  Exact exact_;
  bool all_ = true;
};

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
                          const ScreenArea& screen) {
  const bool solid = !slots.empty() && slots.front() < scene.solid_end();
  Sample sample(scene, screen, !solid || slots.size() <= kSampledSlots);
  for (Steps steps(slots.size()); steps.below(slots.size()); steps.next()) sample.add(slots[steps.at()]);
  model::Load load = sample.scaled(static_cast<double>(slots.size()));
  if (!solid || scene.strata().empty()) return load;
  const bool ascending = slots.front() <= slots.back();
  const auto before = [&](std::uint32_t end) {
    return ascending
               ? std::lower_bound(slots.begin(), slots.end(), end) - slots.begin()
               : slots.end() - std::lower_bound(slots.begin(), slots.end(), end,
                                                [](std::uint32_t a, std::uint32_t b) { return a >= b; });
  };
  Exact exact;
  std::ptrdiff_t passed = 0;
  for (const Stratum& stratum : scene.strata()) {
    const std::ptrdiff_t end = before(stratum.end);
    exact.add(stratum, static_cast<double>(end - passed));
    passed = end;
  }
  return exact.into(load);
}

model::Load estimated_in_frustum(const DrawScene& scene, const CullPlanes& planes, const ScreenArea& screen,
                                 DrawList& scratch) {
  SampledFrustum sampled(scene, scratch);
  sampled.choose_words();
  cull_boxes(scene.boxes(), planes, scratch.inside, scratch.inside);
  sampled.list();
  return sampled.load(screen);
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
  return sample.scaled(static_cast<double>(count));
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
  model::Load load = sample.scaled(static_cast<double>(all.slots));
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
  model::Load load = sample.scaled(taken == 0 ? 0.0
                                              : static_cast<double>(inside) * static_cast<double>(all.slots) /
                                                    static_cast<double>(taken));
  // How many there are in the chunks is known, and only a share is to be estimated: where few slots have most
  // of the vertices, the sample alone says 40 % too much or too little from frame to frame.
  if (sampled_vertices > 0.0) load.vertices = all.vertices * sample.vertices() / sampled_vertices;
  if (sampled_triangles > 0.0) load.triangles = all.triangles * sample.triangles() / sampled_triangles;
  return load;
}

}  // namespace scenegen::render
