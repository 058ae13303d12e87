// Predictions of whole frames against sums made by hand.
#include <catch2/catch.hpp>
#include <cmath>

#include "render/model/prediction.h"

using namespace scenegen::render::model;

namespace {

/// Round numbers, each of its own size, so that a term that is left out or doubled shows.
UnitCosts units() {
  UnitCosts c;
  c.update_object_s = 2;
  c.intersect_s = 3;
  c.refresh_chunk_s = 9;
  c.refresh_slot_s = 0.75;
  c.visit_node_s = 5;
  c.cull_slot_s = 0.5;
  c.list_draw_s = 0.375;
  c.cull_node_s = 7;
  c.list_slot_s = 0.25;
  c.record_s = 11;
  c.record_kept_s = 13;
  c.secondary_s = {{10, 20}, {100, 110}};
  c.node_command_s = 17;
  c.write_indirect_s = 19;
  c.ask_s = 23;
  c.receive_s = 29;
  c.second_part_cpu_s = 1000;
  c.hi_z_cpu_s = 47;
  c.hi_z_device_s = 300;
  c.hi_z_block_s = 5;
  c.hi_z_slot_s = 0.25;
  c.shadow_slot_s = 0.125;
  c.empty_cpu_s = 10'000;
  c.draw_s = {Curve{{3, 36}, {40, 73}}, Curve{{3, 36}, {50, 116}}};  // 37 + v; 44 + 2 v from 3 on
  c.fragment_s.fill({{0.5, 1}, {2, 2}});
  c.instance_saves_s = 30;
  c.hidden_fragment_s = 0.5;
  c.background_s = 0.25;
  c.secondary_device_s = 31;
  c.node_command_device_s = 37;
  c.indirect_draw_s = 41;
  c.skipped_draw_s = 4;
  c.query_s = 43;
  c.seen_query_s = 3;
  c.asked_fragment_s = 1.5;
  c.second_part_device_s = 2000;
  c.shadow_vertex_s = 0.0625;
  c.empty_device_s = 20'000;
  c.latency_s = 500;
  c.node_overlap = 0.75;
  c.send_overlap = 0.5;
  return c;
}

/// Every pixel is covered once, so all fragments are shaded.
FrameFacts facts() {
  FrameFacts f;
  f.visible_slots = 1000;
  f.changed = 8;
  f.screen_pixels = 4000;
  f.visible = {900, 900 * 36, 1000, 0, 0.25};
  f.in_frustum = {100, 100 * 36, 1000, 0, 0.25};
  f.height = 2;
  f.chunks_refreshed = 4;
  f.slots_refreshed = 64;
  f.nodes_visited = 30;
  f.boxes_tested = 50;
  f.chunks = 12;
  f.in_chunks = {180, 180 * 36, 1000, 0, 0.25};  // 15 in each
  f.chunks_rerecorded = 2;
  f.draws_rerecorded = 30;
  f.asked = 5;
  f.asked_fragments = 20;
  f.chunks_hidden = 3;
  f.hidden = {45, 45 * 36, 0, 0, 0};
  f.all_asked_fragments = 1100;
  f.all_chunks_hidden = 8;
  f.all_hidden = {120, 120 * 36, 0, 0, 0};
  f.slots_hidden = {60, 60 * 36, 0, 0, 0};
  return f;
}

constexpr PredictionOptions kOneByOne{1, true, false};
constexpr double kSky = 1000 * 0.25;        // 1000 pixels of it are covered
constexpr double kDraw = 73;                // 36 vertices, plain
constexpr double kDevice = 20'000 - kSky;   // T_0 without that sky
constexpr double kUpdate = 8 * 2;           // changed
constexpr double kTree = 8 * 2 * 3 + 84;    // changed, height, t_intersect; chunks and slots made anew
constexpr double kCull = 30 * 5 + 50 * 7;   // nodes, boxes
constexpr double kSecondaries = 12 * 105.;  // 15 draws each

}  // namespace

TEST_CASE("prediction: what is not read back is not copied") {
  UnitCosts c = units();
  c.readback_cpu_s = 3000;
  c.readback_device_s = 7000;
  PredictionOptions shown = kOneByOne;
  shown.readback = false;
  const Prediction read = predict(Method::inline_frustum, facts(), c, kOneByOne);
  const Prediction only_shown = predict(Method::inline_frustum, facts(), c, shown);
  CHECK(read.cpu_s - only_shown.cpu_s == Approx(3000));
  CHECK(read.gpu_s - only_shown.gpu_s == Approx(7000));
  CHECK(predict(Method::inline_frustum, facts(), units(), kOneByOne).cpu_s == Approx(read.cpu_s));
}

TEST_CASE("prediction: outlines of textured things cost their own, by their share of the fragments") {
  UnitCosts c = units();
  c.edge_s = 1;
  c.textured_edge_s = 5;
  Load load{10, 360, 200, 0, 0.25, 120};
  const double plain = device_stages(load, 1000, c).fragments_s;
  load.textured_fragment_share = 0;  // as of draws, of which none is
  CHECK(device_stages(load, 1000, c).fragments_s == Approx(plain));
  load.textured_fragment_share = 1;
  const double textured = device_stages(load, 1000, c).fragments_s;
  c.edge_s = c.textured_edge_s = 0;
  const double inside = device_stages(load, 1000, c).fragments_s;
  CHECK(textured - inside == Approx(5 * (plain - inside)));
}

TEST_CASE(
    "prediction: culling on the device costs by blocks and by what is visible, and draws what is seen") {
  FrameFacts f = facts();
  f.hi_z_blocks = 4;
  f.seen = {20, 20 * 36, 10, 0, 0.25};
  const Prediction p = predict(Method::hi_z, f, units(), kOneByOne);
  CHECK(p.cull_s == 0);
  CHECK(p.record_s == Approx(47));
  CHECK(p.query_device_s == Approx(300 + 4 * 5 + 1000 * 0.25));
  // As `inline` draws the same, but for what commands cost: four in place of twenty.
  FrameFacts same = f;
  same.in_frustum = f.seen;
  const Prediction flat = predict(Method::inline_frustum, same, units(), kOneByOne);
  CHECK(flat.draw_device_s - p.draw_device_s == Approx(16 * 30));
  same.in_frustum.commands = 4;
  CHECK(p.draw_device_s == Approx(predict(Method::inline_frustum, same, units(), kOneByOne).draw_device_s));
  // The sets of visible slots are written whatever changes; nothing else is.
  f.changed = 500;
  CHECK(predict(Method::hi_z, f, units(), kOneByOne).update_octree_s == 0);
  CHECK(name_of(Method::hi_z) == "hi-z");
}

TEST_CASE("predictions: names are those of the strategies") {
  CHECK(name_of(Method::brute) == "brute");
  CHECK(name_of(Method::inline_frustum) == "inline");
  CHECK(name_of(Method::inline_queries) == "inline-queries");
  CHECK(name_of(Method::octree_record) == "octree-record");
  CHECK(name_of(Method::octree) == "octree");
  CHECK(name_of(Method::queries_all) == "queries-all");
  CHECK(name_of(Method::queries) == "queries");
}

TEST_CASE("predictions: ways that record each frame") {
  const Prediction brute = predict(Method::brute, facts(), units(), kOneByOne);
  CHECK(brute.cull_s == 0);
  CHECK(brute.record_s == Approx(900 * 11));
  CHECK(brute.cpu_s == Approx(10'000 + kUpdate + 9900));
  CHECK(brute.draw_device_s == Approx(900 * kDraw));  // the vertices take longer than 1000 * 2
  CHECK(brute.gpu_s == Approx(kDevice + 900 * kDraw));
  CHECK(brute.frame_s == Approx(brute.cpu_s + brute.gpu_s + 500));

  const Prediction in = predict(Method::inline_frustum, facts(), units(), kOneByOne);
  CHECK(in.cull_s == Approx(500 + 100 * 0.375));
  CHECK(in.cpu_s == Approx(10'000 + kUpdate + 500 + 100 * 0.375 + 1100));
  CHECK(in.gpu_s == Approx(kDevice + 100 * kDraw));
  CHECK(in.queries_cpu_s + in.query_device_s + in.secondaries_s + in.update_octree_s == 0);

  const Prediction record = predict(Method::octree_record, facts(), units(), kOneByOne);
  CHECK(record.update_octree_s == Approx(kTree));
  CHECK(record.cull_s == Approx(kCull + 180 * 0.25));
  CHECK(record.record_s == Approx(180 * 11));
  CHECK(record.secondaries_s == 0);

  const Prediction asking = predict(Method::inline_queries, facts(), units(), kOneByOne);
  CHECK(asking.record_s == Approx(40 * 11));
  CHECK(asking.queries_cpu_s == Approx(100 * (23 + 29)));
  CHECK(asking.draw_device_s == Approx(40 * kDraw));
  // Some are seen, so 1000 fragments of boxes are; the other faces fail.
  CHECK(asking.query_device_s == Approx(100 * 43 + 40 * 3 + 1000 * 1.5 + 1000 * 0.5));
}

TEST_CASE("predictions: ways that keep commands") {
  const Prediction octree = predict(Method::octree, facts(), units(), kOneByOne);
  CHECK(octree.record_s == Approx(30 * 13));
  CHECK(octree.secondaries_s == Approx(kSecondaries));
  CHECK(octree.cpu_s == Approx(10'000 + kUpdate + kTree + kCull + 390 + kSecondaries));
  CHECK(octree.gpu_s == Approx(kDevice + 180 * kDraw + 0.25 * 12 * 31));  // the rest beside the vertices
  CHECK(octree.frame_s == Approx(octree.cpu_s + octree.gpu_s + 500 - 0.5 * kSecondaries));

  const Prediction all = predict(Method::queries_all, facts(), units(), kOneByOne);
  CHECK(all.queries_cpu_s == Approx(12 * (23 + 29) + 1000));
  CHECK(all.secondaries_s == Approx(kSecondaries));  // hidden ones are executed all the same
  // Those of the second part have nothing to be beside.
  CHECK(all.draw_device_s == Approx(60 * kDraw + 0.25 * 4 * 31 + 8 * 31 + 120 * 4));
  CHECK(all.query_device_s == Approx(12 * 43 + 4 * 3 + 1000 * 1.5 + 1200 * 0.5 + 2000));

  const Prediction some = predict(Method::queries, facts(), units(), kOneByOne);
  CHECK(some.queries_cpu_s == Approx(5 * (23 + 29) + 1000));
  CHECK(some.draw_device_s == Approx(135 * kDraw + 0.25 * 9 * 31 + 3 * 31 + 45 * 4));
  CHECK(some.query_device_s == Approx(5 * 43 + 2 * 3 + 20 * 1.5 + 20 * 0.5 + 2000));

  const Prediction late = predict(Method::queries, facts(), units(), {1, false, false});
  CHECK(late.queries_cpu_s == Approx(5 * (23 + 29)));
  CHECK(late.secondaries_s == Approx(9 * 105));
  CHECK(late.draw_device_s == Approx(135 * kDraw + 0.25 * 9 * 31));
  CHECK(late.query_device_s == Approx(5 * 43 + 2 * 3 + 20 * 1.5 + 20 * 0.5));

  const Prediction indirect = predict(Method::queries, facts(), units(), {1, true, true});
  CHECK(indirect.record_s == Approx(30 * 19));
  CHECK(indirect.secondaries_s == Approx(12 * 17));
  CHECK(indirect.draw_device_s == Approx(135 * (kDraw - 40 + 41) + 12 * 37));

  // An indirect draw is as much dearer than a recorded one with textures as without.
  FrameFacts textured = facts();
  textured.in_chunks.textured_share = 1;
  CHECK(predict(Method::octree, textured, units(), {1, true, true}).draw_device_s ==
        Approx(180 * (116 - 40 + 41) + 12 * 37));

  FrameFacts nothing = facts();
  nothing.asked = nothing.chunks_hidden = 0;
  nothing.hidden = {};
  CHECK(predict(Method::queries, nothing, units(), kOneByOne).frame_s == Approx(octree.frame_s));
}

TEST_CASE("predictions: several frames in flight, overlaps, shadows, blended objects, textures") {
  UnitCosts c = units();
  FrameFacts f = facts();
  const Prediction one = predict(Method::octree, f, c, kOneByOne);
  CHECK(predict(Method::octree, f, c, {2, true, false}).frame_s == Approx(std::max(one.cpu_s, one.gpu_s)));
  c.frame_overlap = 0.25;
  CHECK(predict(Method::octree, f, c, {3, true, false}).frame_s ==
        Approx(std::max(one.cpu_s, one.gpu_s) + 0.75 * std::min(one.cpu_s, one.gpu_s)));
  c.stage_overlap = 0;
  CHECK(predict(Method::octree, f, c, kOneByOne).gpu_s == Approx(one.gpu_s + 1000 * 2));

  f.shadow_slots = 800;
  f.shadow_vertices = 28'800;
  const Prediction shaded = predict(Method::octree, f, units(), kOneByOne);
  CHECK(shaded.cpu_s - one.cpu_s == Approx(100));
  CHECK(shaded.gpu_s - one.gpu_s == Approx(1800));

  f = facts();
  f.blended = {10, 10 * 36, 0, 1, 0};
  const Prediction glass = predict(Method::octree, f, units(), kOneByOne);
  CHECK(glass.record_s - one.record_s == Approx(10 * 11));
  CHECK(glass.draw_device_s - one.draw_device_s == Approx(10 * 116));
}

TEST_CASE("predictions: triangles are done beside vertices, or after them") {
  UnitCosts c = units();
  c.triangle_s = c.speck_triangle_s = 5;
  const Load load{10, 360, 0, 0, 0, 200};  // 73 a draw, 100 for its triangles
  CHECK(device_stages(load, 1000, c).vertices_s == Approx(1000));
  c.triangle_overlap = 0;
  CHECK(device_stages(load, 1000, c).vertices_s == Approx(1730));
}

TEST_CASE("predictions: triangles between all samples cost less, and large frames less each") {
  UnitCosts c = units();
  c.triangle_s = 5;
  c.speck_triangle_s = 1;
  const auto each = [&](double fragments) { return triangles_s({10, 360, fragments, 0, 0, 200}, c) / 200; };
  CHECK(each(0) == Approx(1));
  CHECK(each(25) == Approx(5));  // a quarter of one for each of the 100 that face the eye
  CHECK(each(1000) == Approx(5));
  CHECK(each(1) == Approx(1 + 4 * 0.0392 / 0.632).epsilon(0.01));
  c.triangle_overlap = 0;
  const Load load{10, 360, 0, 0, 0, 200};
  const double alone_s = device_stages(load, 1000, c).vertices_s;
  c.bulk = {{100, 400}, {1, 0.5}};
  CHECK(device_stages(load, 1000, c).vertices_s == Approx(0.75 * alone_s));  // half way, by factors
}

TEST_CASE("predictions: outlines grow with the triangles that are seen") {
  const auto outline = [](double fragments, double triangles) {
    return outlines({1, 0, fragments, 0, 0, triangles});
  };
  CHECK(outline(10'000, 2) == Approx(100));  // one faces the eye
  CHECK(outline(10'000, 8) == Approx(200).epsilon(0.01));
  CHECK(outline(100, 1e6) == Approx(100).epsilon(0.01));  // no more are seen than there are fragments
}

TEST_CASE("predictions: how many fragments are shaded") {
  const auto shaded = [](double fragments, double share) {
    return shaded_fragments({1, 3, fragments, 0, share}, 1000);
  };
  CHECK(shaded(0, 0).covered_share == 0);
  CHECK(shaded(500, 0.5).shaded == Approx(500));  // one layer
  CHECK(shaded(500, 0.5).hidden == Approx(0).margin(1e-9));
  CHECK(shaded(1000, 0.5).shaded == Approx(500 * 1.5).epsilon(0.02));  // 1 + 1/2
  CHECK(shaded(2000, 0.5).shaded == Approx(500 * (1 + 1 / 2. + 1 / 3. + 1 / 4.)).epsilon(0.02));
  CHECK(shaded(2000, 0.5).shaded + shaded(2000, 0.5).hidden == Approx(2000));
  // Anywhere on the screen: 1 - 1/e of it for as many fragments as pixels.
  CHECK(shaded(1000, 0).covered_share == Approx(1 - std::exp(-1)));
  CHECK(shaded(1e6, 0).covered_share == Approx(1));
  // Hidden ones cost less: 4 layers over the whole screen.
  const GpuStages s = device_stages({1, 36, 4000, 0, 1}, 1000, units());
  CHECK(s.state_s == Approx(40));
  CHECK(s.vertices_s == Approx(73));
  const double layers = shaded(4000, 1).shaded;
  CHECK(s.fragments_s == Approx(2 * layers + 0.5 * (4000 - layers)));
}
