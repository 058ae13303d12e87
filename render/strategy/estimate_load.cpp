#include "render/strategy/estimate_load.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace scenegen::render {
namespace {

/// Sums up some slots of many, then scales.
class Sample {
 public:
  Sample(const DrawScene& scene, const ScreenArea& screen) : scene_(scene), screen_(screen) {}

  void add(std::uint32_t slot) {
    const DrawPrimitive& primitive = scene_.primitive(slot);
    ++taken_;
    vertices_ += primitive.work.vertices;
    fragments_ += screen_.fragments(scene_.boxes().get(slot));
    textured_ += scene_.batches()[primitive.batch].state.texture_set != 0 ? 1.0 : 0.0;
  }

  [[nodiscard]] model::Load scaled(std::size_t draws) const {
    model::Load load;
    if (taken_ == 0) return load;
    load.draws = static_cast<double>(draws);
    const double scale = load.draws / static_cast<double>(taken_);
    load.vertices = scale * vertices_;
    load.fragments = scale * fragments_;
    load.textured_share = textured_ / static_cast<double>(taken_);
    load.screen_share = screen_.covered_share(load.fragments);
    return load;
  }

 private:
  const DrawScene& scene_;
  const ScreenArea& screen_;
  std::size_t taken_ = 0;
  double vertices_ = 0, fragments_ = 0, textured_ = 0;
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
  screen_.eye_m = view.eye_m();
  screen_.forward = view.forward();
  screen_.near_m = view.lens.near_m;
  if (view.lens.orthographic) {
    per_m2_ = pixels() * 0.25 * std::abs(static_cast<double>(view.clip_from_camera[0][0])) *
              std::abs(static_cast<double>(view.clip_from_camera[1][1]));
  } else {
    screen_.yfov_rad = 2.0 * std::atan(1.0 / std::abs(static_cast<double>(view.clip_from_camera[1][1])));
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

double ScreenArea::covered_share(double fragments) const {
  return 1.0 - std::exp(-fragments / pixels());
}

model::Load load_of_slots(const DrawScene& scene, std::span<const std::uint32_t> slots,
                          const ScreenArea& screen) {
  Sample sample(scene, screen);
  for (Steps steps(slots.size()); steps.below(slots.size()); steps.next()) sample.add(slots[steps.at()]);
  return sample.scaled(slots.size());
}

model::Load load_of_visible(const DrawScene& scene, const ScreenArea& screen) {
  const std::size_t words = (scene.solid_end() + std::size_t{63}) / 64;
  std::size_t count = 0;
  for (std::size_t w = 0; w < words; ++w)
    count += static_cast<std::size_t>(std::popcount(solid_bits(scene, w)));
  Sample sample(scene, screen);
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
  model::Load load;
  std::size_t count = 0;
  for (const std::uint32_t number : chunks) {
    const Octree::Content& content = tree.chunk(number).content;
    count += content.slots;
    load.vertices += static_cast<double>(content.vertices);
    load.fragments += screen.fragments(content);
  }
  load.draws = static_cast<double>(count);
  load.screen_share = screen.covered_share(load.fragments);
  Sample sample(scene, screen);
  Steps steps(count);
  std::size_t passed = 0;
  for (const std::uint32_t number : chunks) {
    const std::vector<std::uint32_t>& slots = tree.chunk(number).slots;
    for (; steps.below(passed + slots.size()); steps.next()) sample.add(slots[steps.at() - passed]);
    passed += slots.size();
  }
  load.textured_share = sample.scaled(count).textured_share;
  return load;
}

void add_scene_facts(const DrawScene& scene, const ScreenArea& screen, model::FrameFacts& facts) {
  std::size_t visible = 0;
  for (const std::uint64_t bits : scene.visible().words())
    visible += static_cast<std::size_t>(std::popcount(bits));
  facts.visible_slots = static_cast<double>(visible);
  facts.screen_pixels = screen.pixels();
  facts.visible = load_of_visible(scene, screen);
}

model::Load load_in_frustum(const DrawScene& scene, const Octree& tree, std::span<const std::uint32_t> chunks,
                            const CullPlanes& planes, const ScreenArea& screen) {
  std::size_t count = 0;
  for (const std::uint32_t number : chunks) count += tree.chunk(number).slots.size();
  Sample sample(scene, screen);
  Steps steps(count);
  std::size_t passed = 0;
  std::size_t inside = 0;
  std::size_t taken = 0;
  for (const std::uint32_t number : chunks) {
    const std::vector<std::uint32_t>& slots = tree.chunk(number).slots;
    for (; steps.below(passed + slots.size()); steps.next(), ++taken) {
      const std::uint32_t slot = slots[steps.at() - passed];
      const auto all = planes.all();
      const Box box = scene.boxes().get(slot);
      if (std::any_of(all.begin(), all.end(),
                      [&](const CullPlane& plane) { return side_of(plane, box) == Side::outside; }))
        continue;
      sample.add(slot);
      ++inside;
    }
    passed += slots.size();
  }
  return sample.scaled(taken == 0 ? 0 : inside * count / taken);
}

}  // namespace scenegen::render
