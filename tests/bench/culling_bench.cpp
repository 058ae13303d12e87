// Frustum culling on one thread: a million boxes with each instruction set, beside the same test written per
// box with a slack of its own (what compilers make of it), and the octree beside the flat walk on a grid of
// buildings. Prints CPU times; run the release build.
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "gen/generate.h"
#include "render/spatial/frustum_cull.h"
#include "render/spatial/octree.h"
#include "scene/random.h"
#include "scene/scene.h"

namespace scenegen::render {
namespace {

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Best of several, ns a box.
template <class Body>
double best_ns(std::size_t boxes, int times, const Body& body) {
  double best = 1e9;
  for (int i = 0; i < times; ++i) {
    const double start = cpu_s();
    body();
    best = std::min(best, (cpu_s() - start) * 1e9 / static_cast<double>(boxes));
  }
  return best;
}

/// The peer: centre and half size, every plane with the box's own slack, 64 boxes a call.
struct CentreBoxes {
  std::vector<float> centre[3], half[3];
};

std::uint64_t inside_by_box(const CentreBoxes& b, std::size_t first, const Frustum& frustum) {
  bool inside[64];
  std::fill(std::begin(inside), std::end(inside), true);
  for (const glm::vec4& p : frustum.planes) {
    const glm::vec3 a = glm::abs(glm::vec3(p));
    for (std::size_t i = 0; i < 64; ++i) {
      const std::size_t at = first + i;
      const float t = p.x * b.centre[0][at] + p.y * b.centre[1][at] + p.z * b.centre[2][at] + p.w;
      const float reach = a.x * b.half[0][at] + a.y * b.half[1][at] + a.z * b.half[2][at];
      const float size = a.x * std::fabs(b.centre[0][at]) + a.y * std::fabs(b.centre[1][at]) +
                         a.z * std::fabs(b.centre[2][at]) + std::fabs(p.w) + reach;
      inside[i] = inside[i] & !(t + reach < -1e-5F * size);
    }
  }
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < 64; ++i) bits |= static_cast<std::uint64_t>(inside[i]) << i;
  return bits;
}

void flat(std::size_t count) {
  SlotBoxes boxes;
  boxes.resize(count);
  CentreBoxes centres;
  for (int a = 0; a < 3; ++a) {
    centres.centre[a].resize(boxes.lo[a].size());
    centres.half[a].resize(boxes.lo[a].size(), -1e30F);
  }
  const Random random(5, "culling bench");
  Box all;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 at =
        500.0F * glm::vec3(random.unit(4 * i), random.unit(4 * i + 1), random.unit(4 * i + 2));
    const Box box{at, at + 0.5F};
    boxes.set(i, box);
    all.add(boxes.get(i));
    for (int a = 0; a < 3; ++a) {
      centres.centre[a][i] = box.centre()[a];
      centres.half[a][i] = 0.5F * box.size()[a];
    }
  }
  const std::vector<std::uint64_t> wanted(boxes.lo[0].size() / 64, ~std::uint64_t{0});
  std::vector<std::uint64_t> out(wanted.size());
  Lens lens;
  lens.yfov_rad = 0.9F;
  const View inside = make_view(look_at({250, 250, 250}, {400, 250, 300}), lens, 16.0F / 9);
  const View outside = make_view(look_at({1400, 900, 1400}, {250, 250, 250}), lens, 16.0F / 9);
  std::printf("%zu boxes, ns a box        peer   scalar     SSE2     AVX2   (best here: %s; aim 1.5)\n",
              count, std::string(simd_name(best_simd())).c_str());
  const int times = count > 500'000 ? 15 : 60;
  for (const auto& [name, view] :
       {std::pair<const char*, View>{"camera inside", inside}, {"everything seen", outside}}) {
    const Frustum frustum = frustum_of(view.clip_from_world);
    const CullPlanes planes = cull_planes(frustum, all);
    std::printf("  %-22s %8.2f", name, best_ns(count, times, [&] {
                  for (std::size_t w = 0; w < out.size(); ++w)
                    out[w] = inside_by_box(centres, w * 64, frustum);
                }));
    for (const Simd simd : {Simd::scalar, Simd::sse2, Simd::avx2})
      std::printf(" %8.2f", best_ns(count, times, [&] { cull_boxes(boxes, planes, wanted, out, simd); }));
    std::uint64_t kept = 0;
    for (const std::uint64_t word : out) kept += static_cast<std::uint64_t>(__builtin_popcountll(word));
    std::printf("   %.0f %% inside\n", 100.0 * static_cast<double>(kept) / static_cast<double>(count));
  }
}

void hierarchical() {
  const auto generated = gen::generate_test_set(32, 1);
  if (!generated) return;
  const std::vector<Box> bounds = object_bounds(generated->scene);
  SlotBoxes boxes;
  boxes.resize(bounds.size());
  Octree::Options options;
  options.slots = bounds.size();
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    boxes.set(i, bounds[i]);
    options.root_m.add(boxes.get(i));
  }
  const Box all = options.root_m;
  const auto slots = static_cast<std::uint32_t>(bounds.size());
  const glm::vec3 street(all.centre().x, 1.7F, all.centre().z);
  Lens lens;
  lens.yfov_rad = 0.7F;
  const View close = make_view(look_at(street, street + glm::vec3(0, 0.5F, -10)), lens, 1.6F);
  const View above = make_view(look_at(all.hi + glm::vec3(60, 80, 60), all.centre()), lens, 1.6F);
  std::printf(
      "\ntest set 32, %u objects       build   remove   street: tests  us    above: tests  us    flat us  "
      "B/slot\n",
      slots);
  const std::vector<std::uint64_t> wanted((slots + 63) / 64, ~std::uint64_t{0});
  std::vector<std::uint64_t> out(wanted.size());
  for (const std::uint32_t n : {5U, 20U, 100U, 500U}) {
    options.slots_per_node = n;
    Octree tree(
        boxes,
        [](std::uint32_t) {
          return Octree::Work{36, 12};
        },
        options);
    const double build = best_ns(slots, 1, [&] {
      for (std::uint32_t i = 0; i < slots; ++i) tree.insert(i);
      tree.refresh();
    });
    const std::uint64_t bytes = tree.bytes() / slots;
    std::printf("  %3u objects a node    %5.0f ns", n, build);
    std::string rest;
    for (const View& view : {close, above}) {
      const CullPlanes planes = cull_planes(frustum_of(view.clip_from_world), all);
      OctreeCounters counters;
      std::vector<std::uint32_t> chunks;
      const double us = best_ns(1, 20,
                                [&] {
                                  chunks.clear();
                                  counters = {};
                                  tree.cull(planes, view.eye_m(), chunks, counters);
                                }) *
                        1e-3;
      char text[64];
      (void)std::snprintf(text, sizeof(text), "     %8llu %6.1f",
                          static_cast<unsigned long long>(counters.tests), us);
      rest += text;
    }
    const CullPlanes planes = cull_planes(frustum_of(close.clip_from_world), all);
    const double flat_us = best_ns(1, 20, [&] { cull_boxes(boxes, planes, wanted, out); }) * 1e-3;
    const double gone = best_ns(slots, 1, [&] {
      for (std::uint32_t i = 0; i < slots; ++i) tree.remove(i);
      tree.refresh();
    });
    std::printf(" %5.0f ns%s   %8.1f %6llu\n", gone, rest.c_str(), flat_us,
                static_cast<unsigned long long>(bytes));
  }
}

}  // namespace
}  // namespace scenegen::render

int main() {
  scenegen::render::flat(100'000);
  scenegen::render::flat(1'000'000);
  scenegen::render::hierarchical();
}
