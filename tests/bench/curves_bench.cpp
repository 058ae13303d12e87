// Curves beside their peers in one run: bench_curves [ROUNDS]. One thread; every figure is the best of
// ROUNDS. Exit code 1 when a figure of the project's plan is missed (Hilbert keys 30 M/s, ordering 3 times
// faster than CGAL's hilbert_sort, times for a million objects in 0.25 s).
#include <CGAL/Simple_cartesian.h>
#include <CGAL/hilbert_sort.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "scene/random.h"
#include "timeline/appearance.h"
#include "timeline/curves.h"

using namespace scenegen;
using namespace scenegen::timeline;

namespace {

constexpr std::size_t kCount = 1'000'000;
using Point = CGAL::Simple_cartesian<double>::Point_3;

double best_of_s(int rounds, const std::function<void()>& prepare, const std::function<void()>& work) {
  double best = 1e30;
  for (int i = 0; i < rounds; ++i) {
    prepare();
    const auto begin = std::chrono::steady_clock::now();
    work();
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return best;
}

void row(const std::string& what, double seconds, double peer_s) {
  std::printf("%-44s %9.2f ms %8.1f M/s %8.1fx\n", what.c_str(), seconds * 1e3, kCount / seconds * 1e-6,
              peer_s / seconds);
}

struct Verdict {
  bool met = true;
  void need(bool condition, const char* what) {
    if (!condition) std::printf("MISSED: %s\n", what);
    met = met && condition;
  }
};

std::uint64_t sum(const std::vector<std::uint64_t>& keys) {
  std::uint64_t s = 0;
  for (const std::uint64_t key : keys) s = mix64(s ^ key);
  return s;
}

void bench_keys(int rounds, unsigned bits, Verdict& verdict) {
  const Random random(1, "cells");
  std::vector<glm::uvec3> cells(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    const std::uint64_t b = random.bits(i);
    cells[i] = glm::uvec3(b, b >> 21, b >> 42) & ((1U << bits) - 1U);
  }
  std::vector<std::uint64_t> keys(kCount);
  const auto nothing = [] {};
  const std::string order = ", order " + std::to_string(bits);
  const double textbook_s = best_of_s(rounds, nothing, [&] {
    for (std::size_t i = 0; i < kCount; ++i) keys[i] = hilbert_key(cells[i].x, cells[i].y, cells[i].z, bits);
  });
  const std::uint64_t expected = sum(keys);
  const double table_s =
      best_of_s(rounds, nothing, [&] { hilbert_keys(cells.data(), kCount, bits, keys.data()); });
  verdict.need(sum(keys) == expected, "table and textbook give the same keys");
  const double magic_s = best_of_s(rounds, nothing, [&] {
    for (std::size_t i = 0; i < kCount; ++i) keys[i] = morton_key(cells[i].x, cells[i].y, cells[i].z);
  });
  const double morton_s = best_of_s(rounds, nothing, [&] { morton_keys(cells.data(), kCount, keys.data()); });
  row("Hilbert keys, textbook (peer)" + order, textbook_s, textbook_s);
  row("Hilbert keys, table" + order, table_s, textbook_s);
  row("Morton keys, magic bits (peer)" + order, magic_s, magic_s);
  row("Morton keys, best of this processor" + order, morton_s, magic_s);
  verdict.need(kCount / table_s >= 30e6, "30 M Hilbert keys/s");
}

void bench_order(int rounds, Verdict& verdict) {
  const Random random(2, "points");
  std::vector<glm::vec3> points(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    points[i] = {random.unit(3 * i), random.unit(3 * i + 1), random.unit(3 * i + 2)};
  }
  std::vector<Point> shuffled;
  const auto prepare = [&] {
    shuffled.clear();
    for (const glm::vec3& p : points) shuffled.emplace_back(p.x, p.y, p.z);
  };
  const auto nothing = [] {};
  const double median_s = best_of_s(rounds, prepare, [&] {
    CGAL::hilbert_sort(shuffled.begin(), shuffled.end(), CGAL::Hilbert_sort_median_policy());
  });
  const double middle_s = best_of_s(rounds, prepare, [&] {
    CGAL::hilbert_sort(shuffled.begin(), shuffled.end(), CGAL::Hilbert_sort_middle_policy());
  });
  std::vector<std::uint32_t> order;
  const double ours_s = best_of_s(rounds, nothing, [&] { order = hilbert_order(points); });
  std::vector<glm::vec3> sorted(kCount);
  const double moved_s = best_of_s(rounds, nothing, [&] {
    const std::vector<std::uint32_t> again = hilbert_order(points);
    for (std::size_t i = 0; i < kCount; ++i) sorted[i] = points[again[i]];
  });
  // The same kind of order: neighbours along it are about as near.
  double ours_m = 0;
  double peer_m = 0;
  for (std::size_t i = 1; i < kCount; ++i) {
    ours_m += double(glm::distance(sorted[i - 1], sorted[i]));
    peer_m += std::sqrt(CGAL::squared_distance(shuffled[i - 1], shuffled[i]));
  }
  row("CGAL hilbert_sort, median policy (peer)", median_s, middle_s);
  row("CGAL hilbert_sort, middle policy (peer)", middle_s, middle_s);
  row("hilbert_order: keys + radix sort, indices", ours_s, middle_s);
  row("hilbert_order and moving the points", moved_s, middle_s);
  std::printf("length of the path through the points: %.3f of CGAL's\n", ours_m / peer_m);
  verdict.need(std::min(median_s, middle_s) / ours_s >= 3.0, "3 times faster than CGAL's hilbert_sort");
  verdict.need(ours_m < 1.1 * peer_m, "a path as short as CGAL's");
}

void bench_appearance(int rounds, Verdict& verdict) {
  Scene scene;
  Geometry box;
  box.positions_m = {glm::vec3(-0.5F), glm::vec3(0.5F)};
  scene.geometries.push_back(box);
  scene.meshes.push_back({"box", {{GeometryId(0), MaterialId()}}});
  const Random random(3, "places");
  scene.objects.reserve(kCount, kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    Transform t;
    t.translation_m = {random.unit(3 * i), random.unit(3 * i + 1), random.unit(3 * i + 2)};
    scene.objects.add("b", MeshId(0), t);
  }
  AppearanceOptions options;
  options.cells = glm::uvec3(64U);
  options.coherence = 0.95;
  const double assign_s = best_of_s(
      rounds, [] {}, [&] { verdict.need(assign_appearance(scene, options).has_value(), "times are given"); });
  double coherence = 0;
  const double measure_s = best_of_s(
      rounds, [] {}, [&] { coherence = measure_coherence(scene).value_or(-1.0); });
  const double bounds_s = best_of_s(
      rounds, [] {}, [&] { verdict.need(object_bounds(scene).size() == kCount, "boxes"); });
  row("object_bounds alone (part of the next two)", bounds_s, bounds_s);
  row("assign_appearance, 64^3 cells, C 0.95", assign_s, bounds_s);
  row("measure_coherence", measure_s, bounds_s);
  verdict.need(coherence == 0.95, "measured coherence is the given one");
  verdict.need(assign_s <= 0.25, "times for a million objects in 0.25 s");
  const double ranks_s = best_of_s(
      rounds, [] {},
      [&] {
        verdict.need(cell_ranks(CurveKind::hilbert, glm::uvec3(100U), {}).size() == kCount, "100^3 ranks");
      });
  row("cell_ranks, Hilbert, 100^3 cells", ranks_s, ranks_s);
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  Verdict verdict;
  std::printf("%-44s %12s %12s %9s\n", "1 000 000 of each", "best", "rate", "peer/this");
  for (const unsigned bits : {10U, 21U}) bench_keys(rounds, bits, verdict);
  bench_order(rounds, verdict);
  bench_appearance(rounds, verdict);
  return verdict.met ? 0 : 1;
}
