#include "gen/town.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "gen/camera.h"
#include "gen/extras.h"
#include "gen/model.h"
#include "gen/palette.h"
#include "gen/primitives.h"
#include "scene/append.h"
#include "scene/limits.h"
#include "scene/random.h"

namespace scenegen::gen {
namespace {

constexpr float kHalfRoot = 0.70710678F;
constexpr std::uint64_t kGroundObjects = 2;

/// Text put together without allocation once it has grown.
class NameWriter {
 public:
  void cut(std::size_t length) { text_.resize(length); }
  void add(std::string_view s) { text_.append(s); }
  void add(std::uint64_t number, int digits) {
    char buffer[24];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, number).ptr;
    for (auto n = end - buffer; n < digits; ++n) text_.push_back('0');
    text_.append(buffer, end);
  }
  [[nodiscard]] std::size_t size() const { return text_.size(); }
  [[nodiscard]] std::string_view text() const { return text_; }

 private:
  std::string text_;
};

int digits_of(std::uint64_t most) {
  int digits = 1;
  for (; most >= 10; most /= 10) ++digits;
  return digits;
}

void add_storey(NameWriter& name, std::uint32_t storey) {
  if (storey == kRoofStorey) {
    name.add("/roof/");
  } else if (storey == kSiteStorey) {
    name.add("/site/");
  } else {
    name.add("/floor_");
    name.add(storey, 1);
    name.add("/");
  }
}

/// A part ready to be copied: transform in the building (Y up), name behind the building's, looks.
struct Stamp {
  glm::dvec3 centre_m;
  glm::vec3 scale;
  glm::quat rotation{1, 0, 0, 0};
  PartKind kind = PartKind::brick;
};
struct Stamps {
  std::vector<Stamp> parts;
  NameTable suffixes;
};

Stamp stamp_of(const Part& part, const Layout& layout) {
  const glm::dvec3 lo(part.box.lo_mm), hi(part.box.hi_mm);
  const glm::dvec3 size = (hi - lo) * 0.001, centre = (lo + hi) * 0.0005;
  Stamp s;
  s.kind = part.kind;
  s.scale = {static_cast<float>(size.x), static_cast<float>(size.z), static_cast<float>(size.y)};
  s.centre_m = {centre.x, centre.z, -centre.y};
  if (part.frame != PartFrame::building) {
    const bool left = part.frame == PartFrame::left_slope;
    const Slope& slope = layout.slopes[left ? 0 : 1];
    const double sine = left ? slope.sine : -slope.sine;
    const glm::dvec3 origin = glm::dvec3(slope.origin_mm) * 0.001;
    s.centre_m = {origin.x + slope.cosine * centre.x - sine * centre.z,
                  origin.z + sine * centre.x + slope.cosine * centre.z, -centre.y};
    const double half_cosine = std::sqrt((1.0 + slope.cosine) * 0.5);
    s.rotation =
        glm::quat(static_cast<float>(half_cosine), 0, 0, static_cast<float>(sine / (2.0 * half_cosine)));
  } else if (size.y > size.x && part.kind == PartKind::brick) {
    // The texture's long side lies along the box's own x: bricks of walls along y are turned, not stretched.
    s.rotation = glm::quat(kHalfRoot, 0, kHalfRoot, 0);
    std::swap(s.scale.x, s.scale.z);
  }
  return s;
}

Stamps stamps_of(const Layout& layout) {
  Stamps out;
  out.parts.reserve(layout.parts.size());
  out.suffixes.reserve(layout.parts.size(), layout.parts.size() * 20);
  NameWriter name;
  std::array<std::uint32_t, kPartKinds> next{};
  std::uint32_t storey = kSiteStorey;
  for (const Part& part : layout.parts) {
    if (part.storey != storey) next.fill(0);
    storey = part.storey;
    name.cut(0);
    add_storey(name, storey);
    name.add(name_of(part.kind));
    name.add("_");
    const bool many =
        part.kind == PartKind::brick || part.kind == PartKind::block || part.kind == PartKind::tile;
    name.add(next[static_cast<std::size_t>(part.kind)]++, many ? 4 : 2);
    out.parts.push_back(stamp_of(part, layout));
    out.suffixes.push_back(name.text());
  }
  return out;
}

/// Copies everything to its place on the grid.
class TownBuilder {
 public:
  TownBuilder(const TownRecipe& recipe, Generated& out)
      : recipe_(recipe),
        out_(out),
        scene_(out.scene),
        palette_(out.scene, recipe.unindexed_boxes ? unit_box_unindexed(false) : unit_box(),
                 recipe.plan.brick_mm),
        tint_(recipe.seed, "brick tint"),
        firing_(recipe.seed, "building tint") {
    pitch_m_ = recipe.building_m + recipe.spacing_m;
    first_m_ = -0.5 * (glm::dvec2(recipe.grid) * pitch_m_ - recipe.spacing_m);
    digits_ = {std::max(2, digits_of(recipe.grid.x - 1)), std::max(2, digits_of(recipe.grid.y - 1))};
    for (const Layout& layout : recipe.layouts) stamps_.push_back(stamps_of(layout));
    if (recipe.building_model) {
      building_resources_ = append_resources(scene_, *recipe.building_model);
      model_box_ = model_bounds(*recipe.building_model);
    }
    prepare_extras();
  }

  void build() {
    reserve();
    if (recipe_.ground) add_ground();
    NameWriter name;
    for (std::uint32_t y = 0; y < recipe_.grid.y; ++y) {
      for (std::uint32_t x = 0; x < recipe_.grid.x; ++x) add_building(x, y, name);
    }
    add_camera();
    out_.exempt.resize(scene_.objects.size(), 0);
    out_.machines = place_machines(scene_, palette_, recipe_.machines);
    out_.exempt.resize(scene_.objects.size(), 1);
  }

  [[nodiscard]] double extra_scale() const {
    double least = 1;
    for (const ExtraPlacer& placer : placers_) least = std::min(least, placer.scale());
    return least;
  }

 private:
  void reserve() {
    const std::uint64_t objects = predict(recipe_).objects;
    std::size_t name_bytes = 0;
    const std::size_t prefix = 10 + static_cast<std::size_t>(digits_.x + digits_.y);
    const std::uint64_t buildings = std::uint64_t{recipe_.grid.x} * recipe_.grid.y;
    for (const Stamps& s : stamps_)
      name_bytes = std::max(name_bytes, s.suffixes.byte_count() + s.parts.size() * prefix);
    if (!stamps_.empty()) name_bytes += recipe_.extras_per_floor * recipe_.plan.floors * (prefix + 20);
    scene_.objects.reserve(objects, name_bytes * buildings + 64);
  }

  void prepare_extras() {
    if (recipe_.extras_per_floor == 0) return;
    for (const Layout& layout : recipe_.layouts) {
      placers_.emplace_back(layout, static_cast<std::uint32_t>(recipe_.plan.floors), recipe_.extras_per_floor,
                            recipe_.extra_size_m, recipe_.seed);
    }
    if (recipe_.extra == ExtraKind::box) {
      extra_mesh_ = palette_.box(Look::cargo);
    } else if (recipe_.extra == ExtraKind::sphere) {
      scene_.geometries.push_back(uv_sphere(recipe_.sphere_slices, recipe_.sphere_stacks));
      extra_mesh_ = palette_.mesh(GeometryId(scene_.geometries.size() - 1), Look::cargo, "sphere");
    } else {
      extra_resources_ = append_resources(scene_, *recipe_.extra_model);
      extra_box_ = model_bounds(*recipe_.extra_model);
    }
  }

  void add_ground_box(const char* name, Look look, const glm::dvec2& half_m, double top_m,
                      double thickness_m) {
    const glm::dvec3 size_m(half_m.x * 2, thickness_m, half_m.y * 2);
    const MeshId mesh = palette_.ground(look, size_m, 6.0);
    Transform t;
    t.translation_m = {0, static_cast<float>(top_m - thickness_m * 0.5), 0};
    t.scale = glm::vec3(size_m);
    scene_.objects.add(name, mesh, t);
    out_.exempt.push_back(1);
  }

  /// Streets between and round the buildings, grass beyond.
  void add_ground() {
    const glm::dvec2 half = glm::dvec2(recipe_.grid) * pitch_m_ * 0.5 + 0.5 * recipe_.spacing_m;
    const double thin = 0.04 * recipe_.plan.scale;
    const double beyond = std::max(4.0 * recipe_.plan.scale, 0.12 * std::max(half.x, half.y));
    add_ground_box("ground/grass", Look::grass, half + beyond, -thin, 0.5 * recipe_.plan.scale);
    add_ground_box("ground/streets", Look::street, half, 0, thin);
  }

  MeshId mesh_of(PartKind kind, std::uint64_t object, std::uint64_t building) {
    if (kind == PartKind::brick) {
      // Most buildings are red with some dark and pale bricks; every fourth is mainly pale, some are mainly
      // dark.
      const float kind_draw = firing_.unit(3 * building);
      const bool is_pale = kind_draw<0.25F, is_dark = kind_draw> 0.85F;
      const float dark = (is_dark ? 0.6F : is_pale ? 0.02F : 0.08F) + 0.2F * firing_.unit(3 * building + 1);
      const float pale = (is_pale ? 0.62F : 0.02F) + 0.12F * firing_.unit(3 * building + 2);
      const float draw = tint_.unit(object);
      return palette_.box(draw < dark          ? Look::brick_dark
                          : draw < dark + pale ? Look::brick_pale
                                               : Look::brick_red);
    }
    if (kind == PartKind::tile)
      return palette_.box(tint_.unit(object) < 0.4F ? Look::tile_brown : Look::tile_red);
    return palette_.box(look_of(kind));
  }

  void add_building(std::uint32_t x, std::uint32_t y, NameWriter& name) {
    const std::uint64_t building = std::uint64_t{y} * recipe_.grid.x + x;
    const glm::dvec2 corner = first_m_ + glm::dvec2(x, y) * pitch_m_;
    name.cut(0);
    name.add("building_");
    name.add(x, digits_.x);
    name.add("_");
    name.add(y, digits_.y);
    const std::size_t prefix = name.size();
    if (recipe_.building_model) {
      Transform place;
      const glm::dvec2 middle = corner + recipe_.building_m * 0.5;
      const glm::vec3 foot(model_box_.centre().x, model_box_.lo.y, model_box_.centre().z);
      place.translation_m = glm::vec3(glm::dvec3(middle.x, 0, -middle.y)) - foot;
      name.add("/");
      append_objects(scene_, *recipe_.building_model, building_resources_, place, name.text());
      return;
    }
    const std::size_t variant = recipe_.layout_of(building);
    const Stamps& stamps = stamps_[variant];
    const glm::dvec3 at(corner.x, 0, -corner.y);
    for (std::size_t i = 0; i < stamps.parts.size(); ++i) {
      const Stamp& s = stamps.parts[i];
      name.cut(prefix);
      name.add(stamps.suffixes[i]);
      scene_.objects.add(name.text(), mesh_of(s.kind, scene_.objects.size(), building),
                         {glm::vec3(at + s.centre_m), s.rotation, s.scale});
    }
    if (recipe_.extras_per_floor > 0) add_extras(building, variant, corner, prefix, name);
  }

  void add_extras(std::uint64_t building, std::size_t variant, const glm::dvec2& corner, std::size_t prefix,
                  NameWriter& name) {
    ExtraPlacer& placer = placers_[variant];
    const glm::vec3 size = glm::vec3(recipe_.extra_size_m * placer.scale());
    const int digits = std::max(3, digits_of(recipe_.extras_per_floor - 1));
    for (std::uint32_t floor = 0; floor < static_cast<std::uint32_t>(recipe_.plan.floors); ++floor) {
      placer.place(building, floor, places_);
      for (std::size_t k = 0; k < places_.size(); ++k) {
        const glm::dvec3 foot = places_[k].foot_m + glm::dvec3(corner, 0);
        name.cut(prefix);
        add_storey(name, floor);
        name.add("extra_");
        name.add(k, digits);
        Transform t;
        t.translation_m = glm::vec3(glm::dvec3(foot.x, foot.z, -foot.y));
        if (recipe_.extra == ExtraKind::model) {
          const auto scale = static_cast<float>(placer.scale());
          const glm::vec3 own_foot(extra_box_.centre().x, extra_box_.lo.y, extra_box_.centre().z);
          t.translation_m -= own_foot * scale;
          t.scale = glm::vec3(scale);
          name.add("/");
          append_objects(scene_, *recipe_.extra_model, extra_resources_, t, name.text());
        } else {
          t.translation_m.y += 0.5F * size.z;
          t.scale = {size.x, size.z, size.y};
          scene_.objects.add(name.text(), extra_mesh_, t);
        }
      }
    }
  }

  void add_camera() {
    const glm::dvec2 half = -first_m_ + recipe_.plan.margin_mm * 0.001;
    Box bounds;
    bounds.add(glm::vec3(glm::dvec3(-half.x, 0, -half.y)));
    bounds.add(glm::vec3(glm::dvec3(half.x, height_m(recipe_), half.y)));
    if (!recipe_.machines.empty()) bounds.add(gen::bounds(recipe_.machines));
    scene_.cameras.push_back(framing_camera(bounds, 0.65F, 0.5F));
  }

  const TownRecipe& recipe_;
  Generated& out_;
  Scene& scene_;
  Palette palette_;
  Random tint_, firing_;
  glm::dvec2 pitch_m_{0}, first_m_{0};
  glm::ivec2 digits_{2, 2};
  std::vector<Stamps> stamps_;
  std::vector<ExtraPlacer> placers_;
  std::vector<ExtraPlace> places_;
  MeshId extra_mesh_;
  Appended building_resources_, extra_resources_;
  Box model_box_, extra_box_;
};

/// Objects, drawn vertices and triangles of a model's scene.
Prediction counts_of(const Scene& scene) {
  std::vector<Prediction> of_mesh(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    for (const Primitive& p : scene.meshes[m].primitives) {
      of_mesh[m].vertices += scene.geometries[p.geometry.value].drawn_vertex_count();
      of_mesh[m].triangles += scene.geometries[p.geometry.value].triangle_count();
    }
  }
  Prediction sum{scene.objects.size(), 0, 0};
  for (const MeshId mesh : scene.objects.mesh) {
    sum.vertices += of_mesh[mesh.value].vertices;
    sum.triangles += of_mesh[mesh.value].triangles;
  }
  return sum;
}

void add_times(Prediction& sum, const Prediction& one, std::uint64_t times) {
  sum.objects += one.objects * times;
  sum.vertices += one.vertices * times;
  sum.triangles += one.triangles * times;
}

constexpr Prediction boxes(std::uint64_t count) {
  return {count, 36 * count, 12 * count};
}

}  // namespace

double height_m(const TownRecipe& recipe) {
  if (recipe.building_model) return static_cast<double>(model_bounds(*recipe.building_model).size().y);
  double highest_m = 0;
  for (const Layout& layout : recipe.layouts) {
    for (const Part& part : layout.parts) highest_m = std::max(highest_m, part.box.hi_mm.z * 0.001);
    highest_m = std::max(highest_m, layout.size_mm.z * 0.001);
  }
  return highest_m;
}

std::size_t TownRecipe::layout_of(std::uint64_t index) const {
  if (layouts.size() < 2) return 0;
  return index > 0 && Random(seed, "roof").below(index, 4) == 0 ? 1 : 0;  // the first is always gabled
}

Prediction predict(const TownRecipe& recipe) {
  Prediction sum;
  const std::uint64_t buildings = std::uint64_t{recipe.grid.x} * recipe.grid.y;
  if (recipe.ground) sum = boxes(kGroundObjects);
  add_times(sum, predict(recipe.machines), 1);
  if (recipe.building_model) {
    add_times(sum, counts_of(*recipe.building_model), buildings);
    return sum;
  }
  std::vector<std::uint64_t> uses(recipe.layouts.size(), 0);
  if (uses.size() == 1) {
    uses[0] = buildings;
  } else {
    for (std::uint64_t b = 0; b < buildings; ++b) ++uses[recipe.layout_of(b)];
  }
  for (std::size_t i = 0; i < uses.size(); ++i)
    add_times(sum, boxes(recipe.layouts[i].parts.size()), uses[i]);

  const std::uint64_t extras =
      buildings * static_cast<std::uint64_t>(recipe.plan.floors) * recipe.extras_per_floor;
  switch (recipe.extra) {
    case ExtraKind::box:
      add_times(sum, boxes(1), extras);
      break;
    case ExtraKind::sphere: {
      const std::uint64_t triangles = 2ULL * recipe.sphere_slices * (recipe.sphere_stacks - 1);
      add_times(sum, {1, 3 * triangles, triangles}, extras);
      break;
    }
    case ExtraKind::model:
      add_times(sum, recipe.extras_per_floor > 0 ? counts_of(*recipe.extra_model) : Prediction{}, extras);
      break;
  }
  return sum;
}

Result<void> check_count(const Prediction& prediction, const char* option) {
  if (prediction.objects <= limits::kMaxObjects) return {};
  return fail(ErrorKind::usage, option,
              "the scene would hold " + std::to_string(prediction.objects) + " objects, at most " +
                  std::to_string(limits::kMaxObjects));
}

Generated build_town(const TownRecipe& recipe, std::vector<std::string> notes) {
  Generated out;
  out.notes = std::move(notes);
  TownBuilder builder(recipe, out);
  builder.build();
  if (builder.extra_scale() < 1) {
    char text[96];
    std::snprintf(text, sizeof text, "extra objects are scaled by %.3g so that they fit into the rooms",
                  builder.extra_scale());
    out.notes.emplace_back(text);
  }
  out.scene.info.generator = "scenegen " SCENEGEN_VERSION;
  out.scene.info.seed = recipe.seed;
  return out;
}

}  // namespace scenegen::gen
