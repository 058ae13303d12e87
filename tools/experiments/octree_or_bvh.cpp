// D 5.2: an octree against hierarchies of boxes for hiding what is behind something, and while objects
// appear.
#include "tools/experiments/octree_or_bvh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>
#include <tuple>

#include "scene/random.h"
#include "timeline/appearance.h"
#include "timeline/player.h"
#include "tools/experiments/all.h"
#include "tools/experiments/bvh.h"
#include "tools/experiments/cell_octree.h"
#include "tools/experiments/late_queries.h"
#include "tools/experiments/measures.h"
#include "tools/experiments/scenes.h"

namespace scenegen::tools {

BoxedObjects boxed(const Scene& scene, std::uint32_t per_node) {
  BoxedObjects out;
  out.boxes = object_bounds(scene);
  out.slots.resize(out.boxes.size());
  for (std::size_t i = 0; i < out.boxes.size(); ++i) {
    out.slots.set(i, out.boxes[i]);
    out.options.root_m.add(out.slots.get(i));
  }
  out.options.slots = out.boxes.size();
  out.options.slots_per_node = per_node;
  return out;
}

std::vector<render::View> camera_round(const Box& bounds, Height height, std::uint32_t frames) {
  std::vector<render::View> out;
  const glm::vec3 size = bounds.size();
  const float radius = 0.5F * std::hypot(size.x, size.z);
  render::Lens lens;
  lens.yfov_rad = 0.8F;
  for (std::uint32_t i = 0; i < frames; ++i) {
    constexpr float kStep = 0.5F * std::numbers::pi_v<float> / 180.0F;
    const float angle = 0.5F + kStep * static_cast<float>(i);
    const float up = height == Height::street ? std::min(1.7F, 0.5F * size.y) : 0.6F * radius + size.y;
    const glm::vec3 eye(bounds.centre().x + (1.05F * radius + 1.0F) * std::sin(angle), bounds.lo.y + up,
                        bounds.centre().z + (1.05F * radius + 1.0F) * std::cos(angle));
    const glm::vec3 target(bounds.centre().x, bounds.lo.y + 0.4F * size.y, bounds.centre().z);
    out.push_back(render::make_view(render::look_at(eye, target), lens, 16.0F / 9.0F));
  }
  return out;
}

namespace {

constexpr std::uint32_t kPerLeaf = 20;

render::Octree::Work no_work(std::uint32_t /*slot*/) {
  return {};
}

std::vector<std::uint32_t> all_of(const Scene& scene) {
  std::vector<std::uint32_t> out(scene.objects.size());
  std::iota(out.begin(), out.end(), 0U);
  return out;
}

/// An index: build() is what takes time, flat() is for walking it.
struct Structure {
  std::string name;
  std::function<void()> build;
  std::function<FlatTree()> flat;
};

Structure octree_of(const BoxedObjects& objects, const std::vector<std::uint32_t>& all, const char* name,
                    OctreeUnits units) {
  const auto tree = std::make_shared<std::optional<render::Octree>>();
  return {name,
          [&objects, &all, tree] {
            tree->emplace(objects.slots, no_work, objects.options);
            for (const std::uint32_t o : all) (*tree)->insert(o);
            (*tree)->refresh();
          },
          [tree, units] { return flatten(**tree, units); }};
}

Structure hierarchy_of(const BoxedObjects& objects, const std::vector<std::uint32_t>& all, const char* name,
                       FlatTree (*build)(std::span<const Box>, std::span<const std::uint32_t>,
                                         std::uint32_t)) {
  const auto tree = std::make_shared<FlatTree>();
  return {name, [&objects, &all, tree, build] { *tree = build(objects.boxes, all, kPerLeaf); },
          [tree] { return *tree; }};
}

std::vector<Structure> structures_of(const BoxedObjects& objects, const std::vector<std::uint32_t>& all) {
  return {octree_of(objects, all, "octree", OctreeUnits::nodes),
          octree_of(objects, all, "octree, chunks", OctreeUnits::chunks),
          hierarchy_of(objects, all, "BVH, SAH", build_bvh_sah),
          hierarchy_of(objects, all, "LBVH, Morton", build_lbvh)};
}

struct NamedScene {
  std::string name;
  Scene scene;
};

Result<std::vector<NamedScene>> static_scenes(const ExperimentContext& context) {
  std::vector<NamedScene> out;
  auto town = buildings_with_boxes(context.quick, context.seed);
  if (!town) return forward_error(town);
  out.push_back({context.quick ? "buildings with boxes, small" : "set 32", std::move(town->scene)});
  if (context.quick) {
    out.push_back({"6 000 random boxes", random_boxes(6000, context.seed)});
  } else {
    auto boxes = gen::generate_test_set(13, context.seed);
    if (!boxes) return forward_error(boxes);
    out.push_back({"set 13", std::move(boxes->scene)});
  }
  for (int set = 1; set <= (context.quick ? 1 : 4); ++set) {
    auto made = stand_in(set, context.quick ? 0.05 : 1.0, context.seed);
    if (!made) return forward_error(made);
    out.push_back({stand_in_name(set) + (context.quick ? ", small" : ""), std::move(made->scene)});
  }
  return out;
}

struct Sums {
  double octree_shown = 0, best_bvh_shown = 0, octree_ms = 0, sah_ms = 0, lbvh_ms = 0;
};

/// Means over both ways of the camera, frames that count.
struct ManyWalks {
  double in_frustum = 0, visible = 0;
  std::vector<LateWalk> of_tree;
};

ManyWalks walk_all(const ExperimentContext& context, const Scene& scene, const BoxedObjects& objects,
                   const std::vector<std::uint32_t>& all, const std::vector<FlatTree>& trees) {
  ManyWalks out;
  out.of_tree.resize(trees.size());
  const LateWalkOptions how;
  const std::uint32_t frames = how.warm_up + (context.quick ? 4 : 12);
  const glm::uvec2 size = context.quick ? glm::uvec2(160, 90) : glm::uvec2(320, 180);
  for (const Height height : {Height::street, Height::roofs}) {
    const std::vector<render::View> views = camera_round(objects.options.root_m, height, frames);
    std::vector<SoftwareDepth> depths;
    const double share = 0.5 / (frames - how.warm_up);
    for (std::uint32_t f = 0; f < frames; ++f) {
      depths.push_back(draw_depths(scene, all, views[f], size));
      if (f < how.warm_up) continue;
      const render::Frustum frustum = render::frustum_of(views[f].clip_from_world);
      out.visible += share * static_cast<double>(depths.back().visible_objects().size());
      out.in_frustum += share * static_cast<double>(std::count_if(
                                    objects.boxes.begin(), objects.boxes.end(),
                                    [&](const Box& b) { return render::intersects(frustum, b); }));
    }
    for (std::size_t i = 0; i < trees.size(); ++i) {
      const LateWalk walked = walk_with_late_queries(trees[i], views, depths, all.size(), how);
      out.of_tree[i].shown += 0.5 * walked.shown;
      out.of_tree[i].missed += 0.5 * walked.missed;
      out.of_tree[i].queries += 0.5 * walked.queries;
    }
  }
  return out;
}

/// What each index shows and how long it takes to build.
void add_visible(const ExperimentContext& context, const NamedScene& named, DocumentTable& table,
                 Sums& sums) {
  begin_step(context, "octree-or-bvh: " + named.name);
  const BoxedObjects objects = boxed(named.scene, kPerLeaf);
  const std::vector<std::uint32_t> all = all_of(named.scene);
  const std::vector<Structure> structures = structures_of(objects, all);
  std::vector<std::vector<double>> build_ms(structures.size());
  std::vector<FlatTree> trees(structures.size());
  for (std::uint32_t r = 0; r < repetitions(context, 5, 3); ++r) {
    for (std::size_t i = 0; i < structures.size(); ++i) {
      const std::size_t at = (i + r) % structures.size();
      build_ms[at].push_back(cpu_milliseconds(structures[at].build));
    }
  }
  for (std::size_t i = 0; i < structures.size(); ++i) trees[i] = structures[i].flat();
  const ManyWalks walks = walk_all(context, named.scene, objects, all, trees);
  for (std::size_t i = 0; i < structures.size(); ++i) {
    const LateWalk& walked = walks.of_tree[i];
    const Spread ms = spread_of(build_ms[i]);
    table.rows.push_back({named.name, static_cast<double>(all.size()), structures[i].name,
                          static_cast<double>(trees[i].nodes.size()), walks.in_frustum, walks.visible,
                          walked.shown, walked.missed, walked.queries, ms.median, spread_cell({ms})});
  }
  sums.octree_shown += walks.of_tree[0].shown;
  sums.best_bvh_shown += std::min(walks.of_tree[2].shown, walks.of_tree[3].shown);
  sums.octree_ms += spread_of(build_ms[0]).median;
  sums.sah_ms += spread_of(build_ms[2]).median;
  sums.lbvh_ms += spread_of(build_ms[3]).median;
}

// ---- Updates ------------------------------------------------------------------------------------------

/// Which nodes an answer still fits some frames later.
using Keys = std::set<std::uint64_t>;

std::uint64_t hash_of(std::uint64_t a, std::uint64_t b) {
  return mix64(a ^ mix64(b));
}

/// Of nodes that are objects: an answer fits a node with the same objects. What they are in order does not
/// matter.
Keys keys_of_sets(const FlatTree& tree) {
  std::vector<std::uint64_t> sums(tree.nodes.size(), 0);
  Keys out;
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    for (std::uint32_t k = tree.nodes[i].first; k < tree.nodes[i].own_end; ++k)
      sums[i] += mix64(tree.objects[k]);
    for (std::uint32_t c = static_cast<std::uint32_t>(i) + 1; c < tree.nodes[i].end; c = tree.nodes[c].end)
      sums[i] += sums[c];
    out.insert(sums[i]);
  }
  return out;
}

/// Of nodes that are cells: an answer fits the cell, whatever is in it.
Keys keys_of_cells(const render::Octree& tree) {
  Keys out;
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const render::Octree::Node& node = tree.node(open.back());
    open.pop_back();
    if (node.content.slots == 0) continue;
    std::uint64_t key = node.level;
    for (int k = 0; k < 3; ++k) key = hash_of(key, std::bit_cast<std::uint32_t>(node.centre_m[k]));
    out.insert(key);
    if (node.leaf()) continue;
    for (std::uint32_t k = 0; k < 8; ++k) open.push_back(node.first_child + k);
  }
  return out;
}

double kept_percent(const Keys& before, const Keys& now) {
  const auto kept =
      std::count_if(before.begin(), before.end(), [&](std::uint64_t k) { return now.contains(k); });
  return before.empty() ? 100.0 : 100.0 * static_cast<double>(kept) / static_cast<double>(before.size());
}

/// The same steps for all four ways of keeping an index right.
class Updates {
 public:
  Updates(const Scene& scene, const render::View& view)
      : objects_(boxed(scene, kPerLeaf)),
        player_(timeline::compile(scene)),
        octree_(objects_.slots, no_work, objects_.options),
        refit_(objects_.boxes, kPerLeaf),
        planes_(render::cull_planes(render::frustum_of(view.clip_from_world), objects_.options.root_m)) {}

  struct Way {
    std::string name, how;
    std::vector<double> ms, kept, shown;
    std::vector<Keys> keys;
  };

  void run(const std::vector<double>& moments) {
    changes_ = 0;
    for (std::size_t i = 0; i < moments.size(); ++i) step(player_.seek(moments[i]), i > 0);
  }
  [[nodiscard]] const std::vector<Way>& ways() const { return ways_; }
  [[nodiscard]] double changes() const { return changes_; }

 private:
  void step(const timeline::ChangeSet& changes, bool counts) {
    for (const ObjectId o : changes.shown) there_.insert(o.value);
    for (const ObjectId o : changes.hidden) there_.erase(o.value);
    if (!started_) {
      // The first change set tells what changed against the state before the first key.
      for (std::uint32_t o = 0; o < objects_.boxes.size(); ++o) {
        if (player_.visible(ObjectId(o))) there_.insert(o);
      }
    }
    const std::vector<std::uint32_t> list(there_.begin(), there_.end());
    const double octree_ms = cpu_milliseconds([&] { update_octree(changes, list); });
    FlatTree sah;
    FlatTree lbvh;
    const double sah_ms = cpu_milliseconds([&] { sah = build_bvh_sah(objects_.boxes, list, kPerLeaf); });
    const double lbvh_ms = cpu_milliseconds([&] { lbvh = build_lbvh(objects_.boxes, list, kPerLeaf); });
    const double refit_ms = cpu_milliseconds([&] { update_refit(changes, list); });
    started_ = true;
    if (counts) changes_ += static_cast<double>(changes.shown.size() + changes.hidden.size());
    note(0, counts, octree_ms, flatten(octree_, OctreeUnits::nodes), keys_of_cells(octree_));
    note(1, counts, sah_ms, sah, keys_of_sets(sah));
    note(2, counts, lbvh_ms, lbvh, keys_of_sets(lbvh));
    note(3, counts, refit_ms, refit_.tree(), {});
  }

  void update_octree(const timeline::ChangeSet& changes, const std::vector<std::uint32_t>& list) {
    if (started_) {
      for (const ObjectId o : changes.hidden) octree_.remove(o.value);
      for (const ObjectId o : changes.shown) octree_.insert(o.value);
    } else {
      for (const std::uint32_t o : list) octree_.insert(o);
    }
    octree_.refresh();
  }

  void update_refit(const timeline::ChangeSet& changes, const std::vector<std::uint32_t>& list) {
    if (started_) {
      for (const ObjectId o : changes.hidden) refit_.hide(o.value);
      for (const ObjectId o : changes.shown) refit_.show(o.value);
    } else {
      for (const std::uint32_t o : list) refit_.show(o);
    }
    refit_.refit();
  }

  void note(std::size_t at, bool counts, double ms, const FlatTree& tree, Keys keys) {
    Way& way = ways_[at];
    way.keys.push_back(std::move(keys));
    if (!counts) return;
    way.ms.push_back(ms);
    double shown = 0;
    walk(
        tree, [&](std::uint32_t i) { return in_frustum(planes_, tree.nodes[i].box_m); },
        [&](std::uint32_t i) {
          for (std::uint32_t k = tree.nodes[i].first; k < tree.nodes[i].own_end; ++k)
            shown += at != 3 || refit_.there(tree.objects[k]) ? 1 : 0;
        });
    way.shown.push_back(shown);
    constexpr std::size_t kLatency = 2;
    if (way.keys.size() > kLatency)
      way.kept.push_back(at == 3 ? 100.0
                                 : kept_percent(way.keys[way.keys.size() - 1 - kLatency], way.keys.back()));
  }

  BoxedObjects objects_;
  timeline::Player player_;
  render::Octree octree_;
  RefitBvh refit_;
  render::CullPlanes planes_;
  std::set<std::uint32_t> there_;
  bool started_ = false;
  double changes_ = 0;
  std::vector<Way> ways_{{"octree", "objects inserted, taken out", {}, {}, {}, {}},
                         {"BVH, SAH", "built anew", {}, {}, {}, {}},
                         {"LBVH, Morton", "built anew", {}, {}, {}, {}},
                         {"BVH, SAH, of all objects", "boxes refitted", {}, {}, {}, {}}};
};

struct UpdateSums {
  double octree_ms = 0, sah_ms = 0, lbvh_ms = 0, refit_ms = 0;
};

Result<DocumentTable> updates_table(const ExperimentContext& context, UpdateSums& sums) {
  DocumentTable table{"index-updates",
                      "Keeping the index right while objects appear",
                      {{"coherence", "C", ""},
                       {"index", "index", ""},
                       {"how", "how", ""},
                       {"changes", "changes a step", ""},
                       {"updateMs", "update", "ms", Origin::ours, Better::lower},
                       {"updateSpread", "spread", "%"},
                       {"kept", "answers that still fit", "%", Origin::ours, Better::higher},
                       {"shown", "objects shown", "", Origin::ours, Better::lower, {}, 4}},
                      {},
                      {}};
  for (const double coherence : {0.95, 0.0}) {
    auto town = buildings_with_boxes(context.quick, context.seed);
    if (!town) return forward_error(town);
    timeline::AppearanceOptions how;
    how.cells = glm::uvec3(context.quick ? 16 : 32);
    how.coherence = coherence;
    how.seed = context.seed;
    const auto info = timeline::assign_appearance(town->scene, how, town->exempt);
    if (!info) return tl::unexpected<Error>(info.error());
    const double end_s = town->scene.duration_s;
    const std::uint32_t steps = context.quick ? 13 : 33;
    const double from_s = 0.5 * end_s;
    const double step_s = end_s * (context.quick ? 0.004 : 0.001);
    const Box bounds = [&] {
      Box b;
      for (const Box& box : object_bounds(town->scene)) b.add(box);
      return b;
    }();
    Updates updates(town->scene, camera_round(bounds, Height::street, 1).front());
    updates.run(moments_between(from_s, from_s + step_s * (steps - 1), steps));
    for (std::size_t i = 0; i < updates.ways().size(); ++i) {
      const Updates::Way& way = updates.ways()[i];
      const Spread ms = spread_of(way.ms);
      (i == 0 ? sums.octree_ms : i == 1 ? sums.sah_ms : i == 2 ? sums.lbvh_ms : sums.refit_ms) += ms.median;
      table.rows.push_back({coherence, way.name, way.how, updates.changes() / (steps - 1), ms.median,
                            spread_cell({ms}), mean_of(way.kept), mean_of(way.shown)});
    }
  }
  table.note = std::string(context.quick ? "A small town" : "Test set 32") +
               " in the middle of its time, objects shown by frustum culling alone. Answers that still fit: "
               "of the nodes there "
               "were two steps before, those that an answer read now is still about: the same cell (octree), "
               "the same objects "
               "(hierarchies). The last way needs to know at the start all objects that will ever be there: "
               "a plan does, an "
               "editor does not.";
  return table;
}

// ---- References ---------------------------------------------------------------------------------------

struct ReferenceFigures {
  DocumentTable table{
      "references-by-height",
      "Draw commands by height of the octree, one reference to an object or many",
      {{"scene", "scene", ""},
       {"height", "height", "", Origin::ours, Better::none, {}, 2},
       {"inFrustum", "objects in the frustum", "", Origin::ours, Better::none, {}, 4},
       {"single", "commands, single reference", "", Origin::ours, Better::lower, {}, 4},
       {"multiple", "commands, multiple references", "", Origin::ours, Better::lower, {}, 4}},
      {},
      "D 5.2, figures 5.12 to 5.15, which are charts without numbers. Means over the camera's ways."};
  std::vector<Chart> charts;
  double worst = 0;  ///< multiple over single
};

void add_references(const ExperimentContext& context, const NamedScene& named, ReferenceFigures& out) {
  const std::vector<Box> boxes = object_bounds(named.scene);
  Box bounds;
  for (const Box& b : boxes) bounds.add(b);
  std::vector<render::View> views = camera_round(bounds, Height::street, context.quick ? 2 : 6);
  const std::vector<render::View> above = camera_round(bounds, Height::roofs, context.quick ? 2 : 6);
  views.insert(views.end(), above.begin(), above.end());
  Chart chart{"references-" + std::to_string(out.charts.size() + 1),
              named.name,
              "height of the octree",
              "draw commands",
              {{"single reference", {}, Origin::ours}, {"multiple references", {}, Origin::ours}},
              false,
              false,
              {}};
  for (std::uint32_t height = 1; height <= (context.quick ? 6U : 8U); ++height) {
    begin_step(context, "octree-or-bvh: " + named.name + ", height " + std::to_string(height));
    std::array<std::optional<double>, 2> commands;
    double in_view = 0;
    for (const References references : {References::single, References::multiple}) {
      const auto tree = build_cell_octree(boxes, height, references);
      if (!tree) continue;
      double sum = 0;
      for (const render::View& view : views) {
        const render::Frustum frustum = render::frustum_of(view.clip_from_world);
        sum += static_cast<double>(count_in_frustum(*tree, render::cull_planes(frustum, bounds)).objects);
        if (references == References::single)
          in_view += static_cast<double>(std::count_if(
              boxes.begin(), boxes.end(), [&](const Box& b) { return render::intersects(frustum, b); }));
      }
      const std::size_t at = references == References::single ? 0 : 1;
      commands[at] = sum / static_cast<double>(views.size());
      chart.series[at].points.push_back({static_cast<double>(height), *commands[at], {}, {}});
    }
    if (commands[0] && commands[1]) out.worst = std::max(out.worst, *commands[1] / *commands[0]);
    const auto cell = [](const std::optional<double>& v) { return v ? Cell(*v) : Cell("too many"); };
    out.table.rows.push_back({named.name, static_cast<double>(height),
                              in_view / static_cast<double>(views.size()), cell(commands[0]),
                              cell(commands[1])});
  }
  out.charts.push_back(std::move(chart));
}

/// D 5.2 has charts without figures: what it says of them.
std::vector<Verdict> verdicts_of(const Sums& sums, const UpdateSums& updates, double worst_references) {
  const auto times = [](double ratio) {
    return ratio >= 1 ? with_unit(ratio, "\u00D7") + " slower" : with_unit(1 / ratio, "\u00D7") + " faster";
  };
  const double shown = sums.octree_shown / sums.best_bvh_shown;
  const double by_sah = sums.octree_ms / sums.sah_ms;
  const double by_lbvh = sums.octree_ms / sums.lbvh_ms;
  const double updating = std::max(updates.octree_ms / updates.sah_ms, updates.octree_ms / updates.lbvh_ms);
  return {
      judged(
          {"D 5.2, objects shown", "octree against the better hierarchy of boxes", "hierarchies show fewest",
           "octree shows " + with_unit(shown, "\u00D7") + " as many", Finding::level,
           "boxes of a hierarchy lie tight round what they hold, cells of an octree do not"},
          shown >= 1),
      judged({"D 5.2, building", "octree against BVH-SAH", "octree several times faster",
              "octree " + times(by_sah), Finding::level,
              "SAH looks for the best split at every node, an octree splits in the middle"},
             by_sah < 0.5),
      judged(
          {"D 5.2, building", "octree against Morton LBVH", "octree several times faster",
           "octree " + times(by_lbvh), Finding::level,
           "an LBVH sorts all codes at once; the octree takes object by object, which is what lets it follow "
           "changes"},
          by_lbvh < 0.5),
      judged({"D 5.2, updates", "octree against building a hierarchy anew", "octree faster",
              "octree " + times(updating), Finding::level,
              "a change touches a few nodes of the octree; building anew costs all objects"},
             updating < 1),
      judged({"D 5.2, references", "commands with many references to an object", "draws objects many times",
              "up to " + with_unit(worst_references, "\u00D7") + " the commands", Finding::level,
              "an object is drawn for every cell that it touches"},
             worst_references > 1)};
}

}  // namespace

Result<DocumentSection> octree_or_bvh(const ExperimentContext& context) {
  auto scenes = static_scenes(context);
  if (!scenes) return forward_error(scenes);
  DocumentTable visible{
      "index-visible",
      "Objects shown, and building the index",
      {{"scene", "scene", ""},
       {"objects", "objects", "", Origin::ours, Better::none, {}, 4},
       {"index", "index", ""},
       {"nodes", "nodes", "", Origin::ours, Better::none, {}, 4},
       {"inFrustum", "in the frustum", "", Origin::ours, Better::none, {}, 4},
       {"visible", "truly visible", "", Origin::ours, Better::none, {}, 4},
       {"shown", "shown", "", Origin::ours, Better::lower, {}, 4},
       {"missed", "missed, too late", "", Origin::ours, Better::lower},
       {"queries", "queries", "", Origin::ours, Better::lower, {}, 4},
       {"buildMs", "build", "ms", Origin::ours, Better::lower},
       {"buildSpread", "spread", "%"}},
      {},
      "D 5.2, figures 5.10 and 5.11, which are charts without numbers. Means over two ways of a camera round "
      "the scene, at eye height and above the roofs, half a degree a frame; all nodes in the frustum are "
      "asked about, answers come two "
      "frames later. Depths are drawn by the processor, so counts are the same on every machine. At "
      "most " +
          std::to_string(kPerLeaf) +
          " objects a leaf. 'octree' shows a node's own objects at "
          "once, as in the dissertation; 'octree, chunks' in chunks with boxes of their own, as our "
          "renderer does. Milliseconds are of the processor's time, one thread."};
  Sums sums;
  for (const NamedScene& named : *scenes) add_visible(context, named, visible, sums);
  UpdateSums updates;
  auto updated = updates_table(context, updates);
  if (!updated) return forward_error(updated);
  ReferenceFigures references;
  for (const NamedScene& named : *scenes) {
    if (named.name.starts_with("stand-in")) add_references(context, named, references);
  }
  DocumentSection out{"octree-or-bvh", "Octree or hierarchy of boxes", {}, {}};
  out.paragraphs.push_back(
      "The octree shows " + in_words(sums.octree_shown / sums.best_bvh_shown) +
      " times the objects that the better hierarchy of boxes shows, is built in " +
      in_words(sums.octree_ms / sums.sah_ms) + " of the time of BVH-SAH and " +
      in_words(sums.octree_ms / sums.lbvh_ms) + " of that of LBVH, and follows changes in " +
      in_words(updates.octree_ms / updates.sah_ms) + " and " + in_words(updates.octree_ms / updates.lbvh_ms) +
      " of the time that building those anew takes.");
  out.paragraphs.emplace_back(
      "The dissertation says that hierarchies show the fewest objects, that an octree is built several times "
      "faster, "
      "that answers of queries are lost when a hierarchy is built anew, and that many references to an "
      "object draw it "
      "many times. What it does not look at is a hierarchy over all objects of the plan whose boxes are "
      "refitted: that "
      "follows changes in " +
      in_words(updates.refit_ms / updates.octree_ms) +
      " of the octree's time, and no node goes away. Many references cost up to " +
      in_words(references.worst) + " times the commands of one.");
  out.blocks.emplace_back(std::move(visible));
  out.blocks.emplace_back(std::move(*updated));
  out.blocks.emplace_back(std::move(references.table));
  for (Chart& chart : references.charts) out.blocks.emplace_back(std::move(chart));
  out.verdicts = verdicts_of(sums, updates, references.worst);
  return out;
}

}  // namespace scenegen::tools
