// Machines at rest: their parts, objects and frames.
#include "gen/machines.h"

#include <array>
#include <string>

#include "gen/generate.h"
#include "gen/machine_shapes.h"

namespace scenegen::gen {
namespace {

enum Shape : std::uint8_t {
  base,
  mast,
  head,
  cab,
  cab_window,
  jib,
  counter_jib,
  counterweight,
  trolley,
  cable,
  hook,
  chassis,
  lorry_cabin,
  lorry_window,
  bed,
  load,
  tyre,
  hub,
  shape_count
};
using Shapes = std::array<Geometry, shape_count>;

Shapes build_shapes(const MachinePlan& plan) {
  const float s = plan.scale, r = plan.reach_m;
  return {crane_base(s),
          crane_mast(s, plan.mast_section_m),
          crane_head(s, r),
          crane_cab(s),
          crane_cab_glass(s),
          crane_jib(s, r),
          crane_counter_jib(s, r),
          crane_counterweight(s, r),
          crane_trolley(s),
          crane_cable(s),
          crane_hook(s),
          lorry_chassis(s),
          lorry_cab(s),
          lorry_glass(s),
          lorry_bed(s),
          lorry_load(s),
          lorry_tyre(s),
          lorry_hub(s)};
}

std::string numbered(const char* kind, std::size_t number) {
  std::string digits = std::to_string(number);
  if (digits.size() < 2) digits.insert(0, 1, '0');
  return std::string(kind) + "_" + digits;
}

class MachinePlacer {
 public:
  MachinePlacer(Scene& scene, Palette& palette, const MachinePlan& plan)
      : scene_(scene), palette_(palette), plan_(plan), first_geometry_(scene.geometries.size()) {
    const bool has_cranes = !plan.cranes.empty();
    const bool has_lorries = !plan.loops.empty();
    Shapes shapes = build_shapes(plan);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      if (i < chassis ? has_cranes : has_lorries) {
        ids_[i] = GeometryId(scene_.geometries.size());
        scene_.geometries.push_back(std::move(shapes[i]));
      }
    }
    if (has_cranes) add_crane_meshes();
    if (has_lorries) add_lorry_meshes();
  }

  Crane place_crane(std::size_t number) {
    const CraneSite& site = plan_.cranes[number];
    const std::string name = numbered("crane", number);
    const glm::vec3 foot(glm::dvec3(site.at_m.x, 0, -site.at_m.y));
    const float s = plan_.scale;
    Crane crane;
    crane.top_m = foot + glm::vec3(0, static_cast<float>(site.top_m), 0);
    crane.slew = add_frame(name + "/slew", {}, crane.top_m);
    crane.trolley = add_frame(name + "/trolley", crane.slew, {0.5F * plan_.reach_m, kCraneTrolleyY * s, 0});
    crane.cable = add_frame(name + "/cable", crane.trolley, {0, -0.1F * s, 0});
    crane.hook = add_frame(name + "/hook", crane.trolley, {0, -1.1F * s, 0});

    add(name + "/base", meshes_[base], {}, foot);
    const std::uint32_t sections = plan_.mast_sections(site);
    const float height_m = (static_cast<float>(site.top_m) - 0.75F * s) / static_cast<float>(sections);
    for (std::uint32_t i = 0; i < sections; ++i) {
      Transform t;
      t.translation_m = foot + glm::vec3(0, 0.75F * s + height_m * static_cast<float>(i), 0);
      t.scale.y = height_m / plan_.mast_section_m;
      scene_.objects.add(name + "/" + numbered("mast", i), meshes_[mast], t);
    }
    add(name + "/head", meshes_[head], crane.slew);
    add(name + "/cab", meshes_[cab], crane.slew);
    add(name + "/jib", meshes_[jib], crane.slew);
    add(name + "/counter_jib", meshes_[counter_jib], crane.slew);
    add(name + "/counterweight", meshes_[counterweight], crane.slew);
    add(name + "/trolley", meshes_[trolley], crane.trolley);
    add(name + "/cable", meshes_[cable], crane.cable);
    add(name + "/hook", meshes_[hook], crane.hook);
    return crane;
  }

  Lorry place_lorry(std::size_t number, std::uint32_t loop, double start) {
    const std::string name = numbered("lorry", number);
    const float s = plan_.scale;
    Lorry lorry;
    lorry.loop = loop;
    lorry.start = start;
    lorry.body = add_frame(name, {}, glm::vec3(0));
    add(name + "/chassis", meshes_[chassis], lorry.body);
    add(name + "/cab", number % 2 == 0 ? meshes_[lorry_cabin] : blue_cab_, lorry.body);
    add(name + "/bed", meshes_[bed], lorry.body);
    add(name + "/load", meshes_[load], lorry.body);
    for (std::size_t i = 0; i < lorry.axles.size(); ++i) {
      lorry.axles[i] =
          add_frame(name + "/axle_" + std::to_string(i), lorry.body, {kAxleX[i] * s, kWheelRadius * s, 0});
      const std::string wheel = name + "/wheel_" + std::to_string(i);
      add(wheel + "_right", meshes_[tyre], lorry.axles[i], {0, 0, kWheelZ * s});
      add(wheel + "_left", meshes_[tyre], lorry.axles[i], {0, 0, -kWheelZ * s});
    }
    return lorry;
  }

 private:
  FrameId add_frame(std::string name, FrameId parent, const glm::vec3& at_m) {
    Frame frame;
    frame.name = std::move(name);
    frame.parent = parent;
    frame.local.translation_m = at_m;
    scene_.frames.push_back(std::move(frame));
    return FrameId(scene_.frames.size() - 1);
  }

  void add(const std::string& name, MeshId mesh, FrameId frame, const glm::vec3& at_m = glm::vec3(0)) {
    Transform t;
    t.translation_m = at_m;
    scene_.objects.add(name, mesh, t, frame);
  }

  MeshId paint(const char* name, std::initializer_list<std::pair<Shape, Look>> parts) {
    std::vector<std::pair<GeometryId, Look>> painted;
    for (const auto& [shape, look] : parts) painted.emplace_back(ids_[shape], look);
    return palette_.mesh(painted, name);
  }

  void add_crane_meshes() {
    meshes_[base] = paint("crane_base", {{base, Look::stone}});
    meshes_[mast] = paint("crane_mast", {{mast, Look::crane_yellow}});
    meshes_[head] = paint("crane_head", {{head, Look::crane_yellow}});
    meshes_[cab] = paint("crane_cab", {{cab, Look::paint}, {cab_window, Look::cab_glass}});
    meshes_[jib] = paint("crane_jib", {{jib, Look::crane_yellow}});
    meshes_[counter_jib] = paint("crane_counter_jib", {{counter_jib, Look::crane_yellow}});
    meshes_[counterweight] = paint("crane_counterweight", {{counterweight, Look::stone}});
    meshes_[trolley] = paint("crane_trolley", {{trolley, Look::steel}});
    meshes_[cable] = paint("crane_cable", {{cable, Look::steel}});
    meshes_[hook] = paint("crane_hook", {{hook, Look::crane_yellow}});
  }

  void add_lorry_meshes() {
    meshes_[chassis] = paint("lorry_chassis", {{chassis, Look::steel}});
    meshes_[lorry_cabin] =
        paint("lorry_cab_red", {{lorry_cabin, Look::lorry_red}, {lorry_window, Look::cab_glass}});
    blue_cab_ = paint("lorry_cab_blue", {{lorry_cabin, Look::lorry_blue}, {lorry_window, Look::cab_glass}});
    meshes_[bed] = paint("lorry_bed", {{bed, Look::steel}});
    meshes_[load] = paint("lorry_load", {{load, Look::tile_red}});
    meshes_[tyre] = paint("lorry_wheel", {{tyre, Look::rubber}, {hub, Look::paint}});
  }

  Scene& scene_;
  Palette& palette_;
  const MachinePlan& plan_;
  std::size_t first_geometry_;
  std::array<GeometryId, shape_count> ids_;
  std::array<MeshId, shape_count> meshes_;  // by their first shape
  MeshId blue_cab_;
};

}  // namespace

Machines place_machines(Scene& scene, Palette& palette, const MachinePlan& plan) {
  Machines out{plan, {}, {}};
  if (plan.empty()) return out;
  MachinePlacer placer(scene, palette, plan);
  for (std::size_t i = 0; i < plan.cranes.size(); ++i) out.cranes.push_back(placer.place_crane(i));
  std::uint32_t loop = 0;
  for (const LorryLoop& road : plan.loops) {
    for (std::uint32_t i = 0; i < road.lorries; ++i) {
      out.lorries.push_back(
          placer.place_lorry(out.lorries.size(), loop, static_cast<double>(i) / road.lorries));
    }
    ++loop;
  }
  return out;
}

Prediction predict(const MachinePlan& plan) {
  Prediction sum;
  const Shapes shapes = build_shapes(plan);
  const auto add = [&](std::initializer_list<Shape> parts, std::uint64_t times) {
    sum.objects += times;
    for (const Shape part : parts) {
      sum.vertices += times * shapes[part].drawn_vertex_count();
      sum.triangles += times * shapes[part].triangle_count();
    }
  };
  for (const CraneSite& crane : plan.cranes) {
    for (const Shape part : {base, head, jib, counter_jib, counterweight, trolley, cable, hook})
      add({part}, 1);
    add({cab, cab_window}, 1);
    add({mast}, plan.mast_sections(crane));
  }
  for (const LorryLoop& loop : plan.loops) {
    for (const Shape part : {chassis, bed, load}) add({part}, loop.lorries);
    add({lorry_cabin, lorry_window}, loop.lorries);
    add({tyre, hub}, std::uint64_t{6} * loop.lorries);
  }
  return sum;
}

}  // namespace scenegen::gen
