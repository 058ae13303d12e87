#include "timeline/compare_sweep.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>

#include "timeline/timeline_data.h"

namespace scenegen::timeline {

namespace {

// Between two events neither at the middle, where an S-shaped spline meets the straight line, nor at a key.
constexpr double kBetween = 0.381966;

double between(double from_s, double to_s) {
  return static_cast<float>(from_s + kBetween * (to_s - from_s));  // float32: short to write
}

float scene_size_m(const Scene& scene) {
  Box box;
  for (const Box& b : object_bounds(scene)) box.add(b);
  const float size_m = box.empty() ? 0.0F : glm::length(box.size());
  return size_m > 0.0F ? size_m : 1.0F;
}

bool close(const glm::vec4& a, const glm::vec4& b, float tolerance) {
  const glm::vec4 d = glm::abs(a - b);
  return std::max({d.x, d.y, d.z, d.w}) <= tolerance;
}

}  // namespace

Sweep::Sweep(const Scene& a, const Scene& b, const Matching& objects, const Matching& cameras,
             const CompareOptions& options, Comparison& out)
    : a_(a),
      b_(b),
      objects_(objects),
      cameras_(cameras),
      options_(options),
      out_(out),
      differences_(out, options.most),
      content_(a, b, options),
      player_a_(compile(a)),
      player_b_(compile(b)),
      size_m_(scene_size_m(a)),
      faults_(a.objects.size(), 0),
      pairs_of_a_(a.materials.size()),
      pairs_of_b_(b.materials.size()) {}

void Sweep::run() {
  const auto times_a = player_a_.timeline().event_times_s();
  const auto times_b = player_b_.timeline().event_times_s();
  std::vector<float> times;
  times.reserve(times_a.size() + times_b.size());
  std::set_union(times_a.begin(), times_a.end(), times_b.begin(), times_b.end(), std::back_inserter(times));
  const double end_s = std::max(player_a_.timeline().duration_s(), player_b_.timeline().duration_s());

  start();
  for (const float event_s : times) {
    const auto event = static_cast<double>(event_s);
    if (event > 0.0) {
      step(between(time_s_, event));
      just_before_ = true;
      step(std::nextafter(event, -1.0));
      just_before_ = false;
    }
    step(event);
  }
  if (end_s > time_s_) {
    step(between(time_s_, end_s));
    step(end_s);
  }
}

void Sweep::start() {
  player_a_.seek(0.0);
  player_b_.seek(0.0);
  ++out_.times_compared;
  for (std::uint32_t a = 0; a < a_.objects.size(); ++a) {
    const std::uint32_t b = objects_.to_b(a);
    if (b == Matching::kNone) continue;
    check_visibility(a, b);
    check_transform(a, b);
  }
  compare_looks_at_start();
  const auto moves = [](const Player& p, FrameId frame) {
    return frame.valid() && p.timeline().data().frame_slot[frame.value] != MovingFrame::kNone;
  };
  for (std::uint32_t a = 0; a < a_.cameras.size(); ++a) {
    const std::uint32_t b = cameras_.to_b(a);
    if (b == Matching::kNone) continue;
    CameraPair pair{CameraId(a), CameraId(b)};
    check_camera(pair);
    if (moves(player_a_, a_.cameras[a].frame) || moves(player_b_, b_.cameras[b].frame)) {
      moving_cameras_.push_back(pair);
    }
  }
}

/// Content that differs is reported once, with the number of objects that show it.
void Sweep::compare_looks_at_start() {
  struct Seen {
    ContentFault fault;
    std::uint32_t first_object;
    std::uint64_t objects;
  };
  std::vector<Seen> seen;
  for (std::uint32_t a = 0; a < a_.objects.size(); ++a) {
    const std::uint32_t b = objects_.to_b(a);
    if (b == Matching::kNone) continue;
    const MeshId mesh_a = player_a_.mesh(ObjectId(a));
    const MeshId mesh_b = player_b_.mesh(ObjectId(b));
    add_material_pairs(mesh_a, mesh_b, a);
    for (const ContentFault& fault : content_.mesh_faults(mesh_a, mesh_b)) {
      faults_[a] |= Fault::look;
      const auto [found, is_new] =
          seen_at_start_.try_emplace({fault.kind, pair_key(fault.a, fault.b)}, seen.size());
      if (is_new) seen.push_back({fault, a, 0});
      ++seen[found->second].objects;
    }
  }
  for (const Seen& s : seen) {
    differences_.add(
        [&] {
          std::string where =
              content_.where(s.fault) + " of " + std::string(a_.objects.names[s.first_object]);
          if (s.objects > 1) where += " and " + text(s.objects - 1) + " more";
          return where;
        },
        [&] { return content_.what(s.fault); });
  }
}

void Sweep::step(double time_s) {
  if (!(time_s > time_s_)) return;
  time_s_ = time_s;
  ++out_.times_compared;
  const ChangeSet& of_a = player_a_.seek(time_s);
  const ChangeSet& of_b = player_b_.seek(time_s);
  look_at_changes(of_a, of_b);
  for (CameraPair& pair : moving_cameras_) check_camera(pair);
}

void Sweep::look_at_changes(const ChangeSet& of_a, const ChangeSet& of_b) {
  const auto visibility_of = [this](std::uint32_t a, std::uint32_t b) { check_visibility(a, b); };
  for_each_changed(of_a.shown, of_b.shown, visibility_of);
  for_each_changed(of_a.hidden, of_b.hidden, visibility_of);
  for_each_changed(of_a.moved, of_b.moved,
                   [this](std::uint32_t a, std::uint32_t b) { check_transform(a, b); });
  for_each_changed(of_a.remeshed, of_b.remeshed, [this](std::uint32_t a, std::uint32_t b) {
    check_look(a, b);
    check_transform(a, b);  // other meshes may be stretched differently
  });
  for (const MaterialId m : of_a.recolored) {
    for (const std::uint32_t pair : pairs_of_a_[m.value]) check_colors(pairs_[pair]);
  }
  for (const MaterialId m : of_b.recolored) {
    for (const std::uint32_t pair : pairs_of_b_[m.value]) check_colors(pairs_[pair]);
  }
}

template <class Check>
void Sweep::for_each_changed(std::span<const ObjectId> of_a, std::span<const ObjectId> of_b,
                             const Check& check) {
  for (const ObjectId a : of_a) {
    if (const std::uint32_t b = objects_.to_b(a.value); b != Matching::kNone) check(a.value, b);
  }
  for (const ObjectId b : of_b) {
    if (const std::uint32_t a = objects_.to_a(b.value); a != Matching::kNone) check(a, b.value);
  }
}

bool Sweep::begins(std::uint32_t a, Fault fault, bool differs) {
  const bool differed = (faults_[a] & fault) != 0;
  if (differs != differed) faults_[a] ^= static_cast<std::uint8_t>(fault);
  return differs && !differed;
}

void Sweep::check_visibility(std::uint32_t a, std::uint32_t b) {
  const bool in_a = player_a_.visible(ObjectId(a));
  if (!begins(a, Fault::visibility, in_a != player_b_.visible(ObjectId(b)))) return;
  differences_.add([&] { return object_now(a); },
                   [&] { return in_a ? "visible in A, hidden in B" : "hidden in A, visible in B"; });
}

void Sweep::check_transform(std::uint32_t a, std::uint32_t b) {
  const glm::mat4 in_a = player_a_.world_from_object(ObjectId(a));
  glm::mat4 in_b = player_b_.world_from_object(ObjectId(b));
  const auto* const stretch = content_.stretch(player_a_.mesh(ObjectId(a)), player_b_.mesh(ObjectId(b)));
  float tolerance = options_.transform_tolerance;
  if (stretch != nullptr) {
    in_b = in_b * stretch->b_from_a;  // where it puts the vertices of A's mesh
    if (stretch->rounded) tolerance = std::max(tolerance, options_.geometry_tolerance);
  }
  if (!begins(a, Fault::transform, !same_place(in_a, in_b, tolerance))) return;
  differences_.add([&] { return object_now(a); }, [&] { return place_difference(in_a, in_b, tolerance); });
}

void Sweep::check_look(std::uint32_t a, std::uint32_t b) {
  const MeshId mesh_a = player_a_.mesh(ObjectId(a));
  const MeshId mesh_b = player_b_.mesh(ObjectId(b));
  add_material_pairs(mesh_a, mesh_b, a);
  const std::vector<ContentFault>& faults = content_.mesh_faults(mesh_a, mesh_b);
  const auto is_new = [this](const ContentFault& f) {
    return !seen_at_start_.contains({f.kind, pair_key(f.a, f.b)});
  };
  const auto fault = std::find_if(faults.begin(), faults.end(), is_new);
  if (!begins(a, Fault::look, !faults.empty()) || fault == faults.end()) return;
  differences_.add([&] { return object_now(a); },
                   [&] {
                     return a_and_b("shows mesh", "'" + a_.meshes[mesh_a.value].name + "'",
                                    "'" + b_.meshes[mesh_b.value].name + "'") +
                            ": " + content_.where(*fault) + ": " + content_.what(*fault);
                   });
}

void Sweep::add_material_pairs(MeshId a, MeshId b, std::uint32_t object) {
  const auto& of_a = a_.meshes[a.value].primitives;
  const auto& of_b = b_.meshes[b.value].primitives;
  if (of_a.size() != of_b.size()) return;
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    const MaterialId in_a = of_a[i].material;
    const MaterialId in_b = of_b[i].material;
    const auto index = static_cast<std::uint32_t>(pairs_.size());
    if (!pair_index_.try_emplace(pair_key(in_a.value, in_b.value), index).second) continue;
    pairs_.push_back({in_a, in_b, object});
    if (in_a.valid()) pairs_of_a_[in_a.value].push_back(index);
    if (in_b.valid()) pairs_of_b_[in_b.value].push_back(index);
    check_colors(pairs_.back());
  }
}

void Sweep::check_colors(MaterialPair& pair) {
  const Material gltf_default;
  const auto base = [&](const Player& p, MaterialId m) {
    return m.valid() ? p.base_color(m) : gltf_default.base_color;
  };
  const auto emissive = [&](const Player& p, MaterialId m) {
    return m.valid() ? p.emissive(m) : gltf_default.emissive;
  };
  const glm::vec4 base_a = base(player_a_, pair.a);
  const glm::vec4 base_b = base(player_b_, pair.b);
  const glm::vec3 emissive_a = emissive(player_a_, pair.a);
  const glm::vec3 emissive_b = emissive(player_b_, pair.b);
  const bool same_base = close(base_a, base_b, options_.color_tolerance);
  const bool differs = !same_base || !close(glm::vec4(emissive_a, 0.0F), glm::vec4(emissive_b, 0.0F),
                                            options_.color_tolerance);
  if (std::exchange(pair.differs, differs) || !differs) return;
  differences_.add(
      [&] {
        return "material '" + material_of(a_, pair.a).name + "' of " +
               std::string(a_.objects.names[pair.object]) + now();
      },
      [&] {
        return same_base ? a_and_b("emissive", vector_text(emissive_a), vector_text(emissive_b))
                         : a_and_b("base colour", vector_text(base_a), vector_text(base_b));
      });
}

void Sweep::check_camera(CameraPair& pair) {
  const glm::mat4 in_a = player_a_.world_from_camera(pair.a);
  const glm::mat4 in_b = player_b_.world_from_camera(pair.b);
  const bool differs = !same_place(in_a, in_b, options_.transform_tolerance);
  if (std::exchange(pair.differs, differs) || !differs) return;
  differences_.add([&] { return "camera '" + a_.cameras[pair.a.value].name + "'" + now(); },
                   [&] { return place_difference(in_a, in_b, options_.transform_tolerance); });
}

bool Sweep::same_place(const glm::mat4& a, const glm::mat4& b, float tolerance) const {
  if (std::memcmp(&a, &b, sizeof a) == 0) return true;
  if (!close(a[3], b[3], tolerance * size_m_)) return false;
  for (int axis = 0; axis < 3; ++axis) {
    const float length = std::max(glm::length(a[axis]), glm::length(b[axis]));
    if (!close(a[axis], b[axis], tolerance * length)) return false;
  }
  return true;
}

std::string Sweep::place_difference(const glm::mat4& a, const glm::mat4& b, float tolerance) const {
  if (!close(a[3], b[3], tolerance * size_m_)) {
    return a_and_b("at", vector_text(glm::vec3(a[3])), vector_text(glm::vec3(b[3])));
  }
  const char* const names[] = {"x axis", "y axis", "z axis"};
  for (int axis = 0; axis < 3; ++axis) {
    const float length = std::max(glm::length(a[axis]), glm::length(b[axis]));
    if (close(a[axis], b[axis], tolerance * length)) continue;
    return a_and_b(names[axis], vector_text(glm::vec3(a[axis])), vector_text(glm::vec3(b[axis])));
  }
  return {};
}

std::string Sweep::object_now(std::uint32_t a) const {
  return std::string(a_.objects.names[a]) + now();
}

std::string Sweep::now() const {
  return (just_before_ ? " just before " : " at ") + text(static_cast<float>(time_s_)) + " s";
}

}  // namespace scenegen::timeline
