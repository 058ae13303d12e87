// Which parts of an octree are asked about, against a world in which a wall hides what lies behind it.
#include "render/strategy/query_chooser.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <deque>
#include <set>

#include "scene/random.h"

using namespace scenegen;
using namespace scenegen::render;

namespace {

constexpr glm::uvec2 kSize{800, 600};
constexpr std::uint32_t kSlots = 20'000;

/// How boxes lie in the cube.
enum class Places : std::uint8_t {
  even,
  checkered  ///< hardly any in every other cell of the octree's third level
};

/// Boxes in a cube of 100 m; what lies wholly behind `wall_z_m` is hidden.
class World {
 public:
  explicit World(const QueryChooser::Settings& settings, const model::UnitCosts& costs,
                 Places places = Places::even, std::uint32_t slots = kSlots)
      : costs_(costs), chooser(settings) {
    const Random random(4, "query chooser");
    boxes_.resize(kSlots);
    Octree::Options options;
    options.root_m = {{-50, -50, -100}, {50, 50, 0}};
    options.slots = kSlots;
    options.slots_per_node = 50;
    for (std::uint32_t i = 0; i < kSlots; ++i) {
      const auto unit = [&](std::uint64_t k) { return random.unit(8 * i + k); };
      const glm::vec3 at(100 * unit(0) - 50, 100 * unit(1) - 50, -100 * unit(2));
      const glm::ivec3 cell(glm::floor(at / 12.5F));
      if (places == Places::checkered && ((cell.x + cell.y + cell.z) & 1) != 0 && i % 32 != 0)
        continue;  // an empty box is in no tree
      boxes_.set(i, {at - 0.4F, at + 0.4F});
    }
    tree.emplace(
        boxes_,
        [](std::uint32_t) {
          return render::Octree::Work{36, 12};
        },
        options);
    grow(slots);
  }

  /// To so many boxes.
  void grow(std::uint32_t slots) {
    for (; slots_ < slots; ++slots_) tree->insert(slots_);
    tree->refresh();
  }

  /// From the same place, through another lens.
  void zoom(float yfov_rad) {
    view_ = make_view(look_at({0, 0, 60}, {0, 0, 0}), {false, yfov_rad, 1, 1, 0.1F, 0}, 4.0F / 3.0F);
  }

  /// One frame; answers come two frames later.
  void frame() {
    chunks.clear();
    visits_.clear();
    OctreeCounters found;
    tree->cull(cull_planes(frustum_of(view_.clip_from_world), tree->root().content.box_m), view_.eye_m(),
               chunks, found, &visits_);
    answered = hidden_answers = 0;
    if (asked_.size() == 2) {
      chooser.learn(asked_.front().first, asked_.front().second);
      answered = asked_.front().second.size();
      for (std::size_t i = 0; i < answered; ++i) {
        if (asked_.front().first[i].with_previous) continue;
        hidden_answers += asked_.front().second[i] == 0 ? 1 : 0;
      }
      answered = query_count(asked_.front().first);
      asked_.pop_front();
    }
    plan.clear(chunks.size());
    const QueryBoxes boxes(view_, kSize);
    const ScreenArea screen(view_, kSize);
    chooser.choose({*tree, visits_, chunks, boxes, screen, costs_, 0.0}, plan);
    check_plan(boxes);
    auto& [asked, samples] = asked_.emplace_back();
    asked = plan.asked;
    for (std::size_t i = 0, end = 0; i < asked.size(); i = end) {
      bool hidden = true;
      for (end = i; end == i || (end < asked.size() && asked[end].with_previous); ++end)
        hidden = hidden && asked[end].box_m.hi.z < wall_z_m;
      samples.resize(end, hidden ? 0 : 7);
    }
  }

  [[nodiscard]] std::size_t truly_hidden() const { return behind(chunks, wall_z_m); }
  /// How many of `some` lie wholly behind.
  [[nodiscard]] std::size_t behind(const std::vector<std::uint32_t>& some, float z_m) const {
    return static_cast<std::size_t>(std::count_if(some.begin(), some.end(), [&](std::uint32_t c) {
      return tree->chunk(c).content.box_m.hi.z < z_m - 0.5F;
    }));
  }
  /// Parts believed hidden, and the queries that they take.
  [[nodiscard]] std::size_t hidden_parts() const {
    return static_cast<std::size_t>(std::count_if(plan.asked.begin(), plan.asked.end(),
                                                  [](const Asked& a) { return a.believed_hidden; }));
  }
  [[nodiscard]] std::size_t hidden_queries() const {
    return static_cast<std::size_t>(std::count_if(plan.asked.begin(), plan.asked.end(), [](const Asked& a) {
      return a.believed_hidden && !a.with_previous;
    }));
  }

 private:
  View view_ = make_view(look_at({0, 0, 60}, {0, 0, 0}), {false, 1.2F, 1, 1, 0.1F, 0}, 4.0F / 3.0F);
  model::UnitCosts costs_;
  SlotBoxes boxes_;
  std::uint32_t slots_ = 0;
  std::vector<OctreeVisit> visits_;
  std::deque<std::pair<std::vector<Asked>, std::vector<std::uint32_t>>> asked_;

  /// Every chunk is drawn once, first or governed by a box round it that can be asked about.
  void check_plan(const QueryBoxes& boxes) const {
    std::set<std::uint32_t> all(plan.first.begin(), plan.first.end());
    std::vector<std::vector<Asked>> queries;
    for (const Asked& asked : plan.asked) {
      if (asked.with_previous) {
        REQUIRE(asked.believed_hidden);
        REQUIRE(queries.back().front().believed_hidden);
      } else {
        queries.emplace_back();
      }
      queries.back().push_back(asked);
    }
    REQUIRE(plan.queries == queries.size());
    REQUIRE(plan.governed.size() == plan.second.size());
    for (std::size_t i = 0; i < plan.second.size(); ++i) {
      REQUIRE(all.insert(plan.second[i]).second);
      REQUIRE(plan.governed[i].chunk == plan.second[i]);
      const Box box = boxes.grown(tree->chunk(plan.second[i]).content.box_m);
      const auto& asked = queries.at(plan.governed[i].query);
      REQUIRE(asked.front().believed_hidden);
      REQUIRE(std::any_of(asked.begin(), asked.end(), [&](const Asked& a) {
        return glm::all(glm::lessThanEqual(a.box_m.lo, box.lo)) &&
               glm::all(glm::greaterThanEqual(a.box_m.hi, box.hi));
      }));
    }
    REQUIRE(all == std::set<std::uint32_t>(chunks.begin(), chunks.end()));
    for (const Asked& asked : plan.asked) REQUIRE_FALSE(boxes.touches_eye(asked.box_m));
  }

 public:
  QueryChooser chooser;
  std::optional<Octree> tree;
  std::vector<std::uint32_t> chunks;
  QueryPlan plan;
  float wall_z_m = -20;
  std::size_t answered = 0, hidden_answers = 0;
};

struct Totals {
  std::size_t queries = 0, answered = 0, hidden_answers = 0;
};
Totals run(World& world, int frames) {
  Totals totals;
  for (int i = 0; i < frames; ++i) {
    world.frame();
    totals.queries += world.plan.queries;
    totals.answered += world.answered;
    totals.hidden_answers += world.hidden_answers;
  }
  return totals;
}

}  // namespace

TEST_CASE("gathering finds what is hidden, and few queries then keep it from being drawn") {
  for (const bool exact : {true, false}) {
    for (const bool indirect : {true, false}) {
      INFO("exact " << exact << ", indirect " << indirect);
      model::UnitCosts costs = model::rough_costs(false);
      costs.secondary_device_s = 0.5e-6;
      costs.node_overlap = 0;  // skipping some thirty boxes pays
      World world({exact, indirect, true}, costs);
      world.frame();
      CHECK(world.chooser.phase() == QueryChooser::Phase::gathering);
      CHECK(world.plan.second.empty());
      CHECK(world.plan.asked.size() <= 64);
      run(world, 200);
      REQUIRE(world.chooser.phase() == QueryChooser::Phase::asking);
      CHECK(world.chooser.best() > 0);
      // Nearly all of what could be skipped is, by queries about a tenth of the nodes, few of them for
      // nothing. (A skipped draw in a secondary is not free: some chunks do not pay.)
      CHECK(world.plan.second.size() >= world.truly_hidden() * (indirect || !exact ? 9 : 6) / 10);
      const Totals totals = run(world, 100);
      CHECK(static_cast<double>(totals.queries) <= 100 * 0.1 * static_cast<double>(world.tree->node_count()));
      CHECK(static_cast<double>(totals.answered - totals.hidden_answers) <=
            0.3 * static_cast<double>(totals.answered));
    }
  }
}

TEST_CASE("what appears is asked about where most around is hidden, so that few queries are for nothing") {
  // Three quarters appear in front of the wall.
  World world({true, true, true}, model::rough_costs(false), Places::even, 2000);
  world.wall_z_m = -75;
  run(world, 30);
  Totals totals;
  double nodes = 0;
  for (std::uint32_t slots = 2000; slots <= kSlots; slots += 90) {
    world.grow(slots);
    const bool asking = world.chooser.phase() == QueryChooser::Phase::asking;
    const Totals frame = run(world, 1);
    if (!asking) continue;
    totals.queries += frame.queries;
    totals.answered += frame.answered;
    totals.hidden_answers += frame.hidden_answers;
    nodes += static_cast<double>(world.tree->node_count());
  }
  REQUIRE(totals.queries > 1000);
  CHECK(static_cast<double>(totals.queries) <= 0.1 * nodes);
  CHECK(static_cast<double>(totals.answered - totals.hidden_answers) <=
        0.2 * static_cast<double>(totals.answered));  // 0.185; without a limit to guesses 0.225
  CHECK(world.plan.second.size() >= world.truly_hidden() * 6 / 10);
}

TEST_CASE("a wall that vanishes is noticed at once; one that comes back after a while") {
  World world({true, true, true}, model::rough_costs(false));
  run(world, 200);
  REQUIRE(world.plan.second.size() > 100);
  world.wall_z_m = -1000;
  run(world, 60);
  CHECK(world.plan.second.empty());
  CHECK(world.chooser.phase() != QueryChooser::Phase::asking);
  CHECK(world.plan.asked.size() < 10);
  world.wall_z_m = -20;
  run(world, 600);
  CHECK(world.chooser.phase() == QueryChooser::Phase::asking);
  CHECK(world.plan.second.size() > 100);
}

TEST_CASE("nothing is asked where asking costs more than drawing") {
  model::UnitCosts costs = model::rough_costs(false);
  costs.query_s = costs.ask_s = 1e-3;
  World world({true, true, true}, costs);
  const Totals totals = run(world, 100);
  CHECK(totals.queries <= 20);  // the largest parts are heavy even so
  CHECK(world.plan.second.empty());
}

TEST_CASE("where nothing is hidden, gathering ends in rest, and is tried again more and more rarely") {
  World world({true, true, true}, model::rough_costs(false));
  world.wall_z_m = -1000;
  std::vector<int> begun;
  bool resting = false;
  for (int i = 0; i < 1200; ++i) {
    world.frame();
    const bool rests = world.chooser.phase() == QueryChooser::Phase::resting;
    if (resting && !rests) begun.push_back(i);
    if (rests) CHECK(world.plan.asked.empty());
    resting = rests;
  }
  REQUIRE(begun.size() >= 2);
  CHECK(begun.size() <= 4);
  CHECK(begun[1] - begun[0] > begun[0]);
}

TEST_CASE("told to rest, nothing is asked for 128 frames, or until told otherwise") {
  const auto queries_in = [](int told_after, int frames, bool otherwise) {
    World world({true, true, true}, model::rough_costs(false));
    for (int i = 0; i < told_after; ++i) world.frame();
    if (told_after > 0) CHECK(world.plan.queries > 0);
    world.chooser.rest(true);
    std::size_t queries = 0;
    for (int i = 0; i < frames; ++i) {
      if (i == 20 && otherwise) world.chooser.rest(false);
      world.frame();
      queries += world.plan.queries;
      if (queries == 0) CHECK(world.plan.second.empty());
    }
    return queries;
  };
  for (const int told_after : {0, 60}) {
    CHECK(queries_in(told_after, 128, false) == 0);
    CHECK(queries_in(told_after, 140, false) > 0);
    CHECK(queries_in(told_after, 20, true) == 0);
    CHECK(queries_in(told_after, 24, true) > 0);
  }
  // A rest of its own does not end by that.
  World world({true, true, true}, model::rough_costs(false));
  world.wall_z_m = -1000;
  while (world.chooser.phase() != QueryChooser::Phase::resting) world.frame();
  world.chooser.rest(false);
  world.frame();
  CHECK(world.plan.queries == 0);
}

TEST_CASE("what stays hidden shares queries, and is asked one by one when something of it comes into view") {
  for (const bool exact : {true, false}) {
    INFO("exact " << exact);
    World world({exact, true, true}, model::rough_costs(false));
    run(world, 30);
    REQUIRE(world.chooser.phase() == QueryChooser::Phase::asking);
    run(world, 170);
    REQUIRE(world.hidden_parts() > 20);
    CHECK(2 * world.hidden_queries() <= world.hidden_parts());
    CHECK(world.plan.second.size() >= world.truly_hidden() * 9 / 10);
    // What comes into view is drawn as soon as that is known, and what does not is not, or not for long.
    const std::size_t before = world.hidden_queries();
    world.wall_z_m = -45;
    run(world, 3);
    if (exact) {
      CHECK(world.hidden_queries() > before);
      run(world, 4);
      CHECK(world.plan.second.size() >= world.truly_hidden() * 9 / 10);
    }
    CHECK(world.behind(world.plan.second, world.wall_z_m + 1) == world.plan.second.size());
    run(world, 200);
    CHECK(world.plan.second.size() >= world.truly_hidden() * 9 / 10);
    CHECK(2 * world.hidden_queries() <= world.hidden_parts());
  }
}

TEST_CASE("parts that come into view often are asked one by one") {
  World world({true, true, true}, model::rough_costs(false));
  run(world, 100);
  const std::size_t still = world.hidden_queries();
  REQUIRE(2 * still <= world.hidden_parts());
  // Each twelfth frame shows what lies at another depth.
  std::size_t queries = 0;
  std::size_t parts = 0;
  for (int i = 0; i < 240; ++i) {
    world.wall_z_m = i % 12 == 0 ? -25.0F - static_cast<float>(i % 60) : -20.0F;
    run(world, 1);
    queries += world.hidden_queries();
    parts += world.hidden_parts();
  }
  CHECK(queries * 4 > parts * 3);
}

TEST_CASE("parts too light to be asked about do not keep those around them from becoming one") {
  World world({true, true, true}, model::rough_costs(false), Places::checkered);
  world.wall_z_m = -60;
  run(world, 200);
  REQUIRE(world.chooser.phase() == QueryChooser::Phase::asking);
  // What the wall hides now was seen, chunk by chunk, and is found hidden so.
  world.wall_z_m = -20;
  run(world, 800);
  REQUIRE(world.chooser.phase() == QueryChooser::Phase::asking);
  CHECK(world.plan.second.size() >= world.truly_hidden() * 9 / 10);
  CHECK(world.hidden_parts() * 8 <= world.plan.second.size());
}

TEST_CASE("what was seen and gets hidden is soon found, by what guesses were saved up before") {
  World world({true, true, true}, model::rough_costs(false));
  world.wall_z_m = -70;
  run(world, 300);
  const std::size_t hidden_before = world.plan.second.size();
  world.wall_z_m = -20;
  REQUIRE(world.truly_hidden() > 2 * hidden_before);
  Totals totals = run(world, 20);
  // 423 of 472; without saving 221.
  CHECK(world.plan.second.size() >= world.truly_hidden() * 8 / 10);
  const Totals later = run(world, 140);
  totals.answered += later.answered;
  totals.hidden_answers += later.hidden_answers;
  CHECK(static_cast<double>(totals.answered - totals.hidden_answers) <=
        0.3 * static_cast<double>(totals.answered));
}

TEST_CASE("after a cut what was seen is asked again at once") {
  World world({true, true, true}, model::rough_costs(false));
  world.wall_z_m = -80;
  run(world, 400);
  REQUIRE(world.chooser.phase() == QueryChooser::Phase::asking);
  const auto guesses = [&] { return world.plan.asked.size() - world.hidden_parts(); };
  world.zoom(0.35F);
  run(world, 20);
  REQUIRE(world.chooser.phase() == QueryChooser::Phase::asking);
  CHECK(guesses() < 8);
  world.zoom(1.2F);
  run(world, 1);
  CHECK(guesses() > 24);
  run(world, 40);
  CHECK(guesses() < 8);
}

TEST_CASE("however little queries cost, few nodes are asked") {
  model::UnitCosts costs = model::rough_costs(false);
  for (double* unit : {&costs.ask_s, &costs.receive_s, &costs.query_s}) *unit *= 1e-3;
  World world({true, true, true}, costs);
  run(world, 60);
  REQUIRE(world.hidden_parts() > 40);  // so many queries it would be
  for (int i = 0; i < 60; ++i) {
    run(world, 1);
    CHECK(static_cast<double>(world.hidden_queries()) <=
          0.07 * static_cast<double>(world.tree->node_count()));
  }
  CHECK(world.plan.second.size() == world.truly_hidden());
}
