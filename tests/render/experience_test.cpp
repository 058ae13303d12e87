// What is remembered and guessed of ways of drawing that are not taken.
#include "render/model/experience.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "scene/random.h"

using namespace scenegen;
using namespace scenegen::render::model;

TEST_CASE("a slow mean follows what lasts, and a seek does not throw it") {
  SlowMean mean(10);
  for (int i = 0; i < 100; ++i) mean.add(20);
  CHECK(mean.value() == Approx(20).margin(0.01));
  mean.add(100'000);  // a jump to another time
  CHECK(mean.value() < 30);
  mean.add(20);
  mean.add(100'000);
  mean.add(100'000);
  mean.add(20);  // two jumps
  CHECK(mean.value() < 100);
  for (const double value : {5200, 5000, 5100}) mean.add(value);  // much changes now
  CHECK(mean.value() == 5000);
  for (int i = 0; i < 100; ++i) mean.add(6000);
  CHECK(mean.value() == Approx(6000).epsilon(0.01));
  for (const double value : {0, 3, 0}) mean.add(value);  // and now little
  CHECK(mean.value() == 3);
}

TEST_CASE("how many different ones there are is guessed from a sample") {
  CHECK(different_among(100, 100, 37) == 37);
  CHECK(different_among(10'000, 100, 1) == Approx(1).margin(0.1));
  CHECK(different_among(10'000, 100, 100) > 3000);  // all differ: most of them do
  const Random random{3, "places"};
  std::vector<bool> seen(500), sampled(500);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const auto place = static_cast<std::size_t>(random.unit(i) * 500.0F);
    seen[place] = true;
    if (i % 10 == 0) sampled[place] = true;
  }
  const auto count = [](const std::vector<bool>& v) {
    return static_cast<double>(std::count(v.begin(), v.end(), true));
  };
  CHECK(different_among(2000, 200, count(sampled)) == Approx(count(seen)).epsilon(0.2));
}

TEST_CASE("what was seen of another picture does not make everything seen for ever") {
  FrameFacts facts;
  facts.visible_slots = 10'000;
  facts.screen_pixels = 1e6;
  facts.in_frustum = {10'000, 360'000, 40e6, 0, 0.9, 120'000};  // forty layers
  facts.exact_inline = true;
  FrameFacts guessed = facts;
  Experience{}.fill_unknown(guessed, 100, {});
  REQUIRE(guessed.seen.draws < 0.2 * facts.in_frustum.draws);
  FrameFacts stale = facts;
  stale.seen = facts.in_frustum;
  stale.exact_seen = true;
  Experience once;
  once.learn(stale);
  FrameFacts after = facts;
  once.fill_unknown(after, 100, {});
  CHECK(after.seen.draws > guessed.seen.draws);
  CHECK(after.seen.draws < 5 * guessed.seen.draws);
  // And it wears off, when what is seen is as was guessed.
  FrameFacts usual = facts;
  usual.seen = guessed.seen;
  usual.exact_seen = true;
  for (int i = 0; i < 20; ++i) once.learn(usual);
  after = facts;
  once.fill_unknown(after, 100, {});
  CHECK(after.seen.draws == Approx(guessed.seen.draws).epsilon(0.1));
}

TEST_CASE("that the first objects are all seen says little of a town") {
  FrameFacts few;
  few.visible_slots = 100;
  few.screen_pixels = 1e6;
  few.in_frustum = {100, 3600, 0.4e6, 0, 0.2, 1200};  // two layers
  few.exact_inline = few.exact_seen = true;
  few.seen = few.in_frustum;
  FrameFacts town = few;
  town.visible_slots = 20'000;
  town.in_frustum = {20'000, 720'000, 8e6, 0, 0.8, 240'000};  // ten
  town.seen = {};
  town.exact_seen = false;
  FrameFacts guessed = town;
  Experience{}.fill_unknown(guessed, 100, {});
  Experience experience;
  experience.learn(few);
  FrameFacts twice = few;
  twice.in_frustum = {120, 4320, 0.4e6, 0, 0.2, 1440};
  twice.exact_seen = false;
  experience.fill_unknown(twice, 100, {});
  CHECK(twice.seen.draws == Approx(120));
  experience.fill_unknown(town, 100, {});
  CHECK(town.seen.draws < 1.1 * guessed.seen.draws);
}

TEST_CASE("(3.14) what an octree that is not built would have is guessed; once seen, ratios are remembered") {
  FrameFacts facts;
  facts.screen_pixels = 1e6;
  facts.visible_slots = 100'000;
  facts.visible = {100'000, 3.6e6, 5e6, 0, 0};
  facts.in_frustum = {20'000, 720'000, 4e6, 0, 0};
  facts.exact_inline = true;
  Experience experience;
  FrameFacts guess = facts;
  experience.fill_unknown(guess, 200, {50, 60, 30});
  CHECK(guess.in_chunks.draws > 20'000);
  CHECK(guess.in_chunks.draws < 30'000);
  CHECK(guess.chunks == Approx(guess.in_chunks.draws / 140).epsilon(0.01));
  CHECK(guess.chunks_rerecorded == Approx(50 * guess.in_chunks.draws / 100'000));
  CHECK(guess.chunks_refreshed == 60);  // in view or not
  CHECK(guess.slots_refreshed == Approx(30 * 140));
  CHECK(guess.height == Approx(std::log2(500.0) / 3.0));
  CHECK(guess.chunks_hidden > 0);  // four layers and more
  CHECK(guess.chunks_hidden < guess.chunks);

  FrameFacts seen = facts;
  seen.chunks = 100;
  seen.in_chunks = {40'000, 1.44e6, 6e6, 0, 0};
  seen.nodes_visited = 300;
  seen.boxes_tested = 400;
  seen.asked = 10;
  seen.chunks_hidden = 50;
  seen.hidden = {30'000, 1e6, 4e6, 0, 0};
  seen.exact_octree = seen.exact_queries = true;
  experience.learn(seen);
  FrameFacts again = facts;
  experience.fill_unknown(again, 200, {50, 60, 30});
  CHECK(again.in_chunks.draws == Approx(40'000));
  CHECK(again.nodes_visited == Approx(3 * again.chunks + again.height));
  CHECK(again.hidden.draws == Approx(30'000));
  CHECK(again.asked == Approx(0.1 * again.chunks));
  // What is exact is left alone.
  FrameFacts exact = seen;
  experience.fill_unknown(exact, 200, {50, 60, 30});
  CHECK(exact.chunks == 100);
  CHECK(exact.slots_refreshed == 0);
  CHECK(exact.hidden.draws == 30'000);
}
