#include "render/draw_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace scenegen::render {

DrawScene::DrawScene(const Scene& scene, const timeline::Player& player,
                     std::span<const std::uint32_t> texture_set_of_material) {
  default_material_ = static_cast<std::uint32_t>(scene.materials.size());
  build_primitives(scene, texture_set_of_material);
  build_slots(scene);
  const std::size_t slots = slot_count();
  boxes_.resize(slots);
  visible_ = BitSet(slots);
  mirrored_ = BitSet(slots);
  visible_object_.assign(scene.objects.size(), 0);
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    const ObjectId id(i);
    place(id, player.world_from_object(id));
    refresh_visibility(id, player);
  }
  const std::span<const ObjectId> moving = player.timeline().moving_objects();
  moving_objects_.assign(moving.begin(), moving.end());
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    if (next < moving_objects_.size() && moving_objects_[next].value == i) {
      ++next;
    } else {
      add_boxes_of(ObjectId(i), resting_bounds_m_);
    }
  }
  refresh_bounds();
  find_large_slots();
  find_strata();
}

void DrawScene::find_large_slots() {
  constexpr std::size_t kMost = 64;
  constexpr float kTimes = 8.0F;  // the median's diagonal; walls and roofs of bricks stay below
  std::vector<float> diagonals(solid_end_);
  for (std::uint32_t slot = 0; slot < solid_end_; ++slot) {
    const Box box = boxes_.get(slot);
    diagonals[slot] = box.empty() ? 0.0F : glm::length(box.size());
  }
  if (diagonals.size() <= kMost) return;
  std::vector<float> ranked = diagonals;
  const auto ranked_at = [&](std::size_t rank) {
    const auto at = ranked.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(ranked.begin(), at, ranked.end());
    return *at;
  };
  const float above = std::max(kTimes * ranked_at(ranked.size() / 2), ranked_at(ranked.size() - kMost - 1));
  for (std::uint32_t slot = 0; slot < solid_end_; ++slot) {
    if (diagonals[slot] > above) large_slots_.push_back(slot);
  }
}

bool DrawScene::large(std::uint32_t slot) const {
  return std::binary_search(large_slots_.begin(), large_slots_.end(), slot);
}

void DrawScene::build_primitives(const Scene& scene, std::span<const std::uint32_t> texture_set_of_material) {
  std::vector<Box> bounds;
  bounds.reserve(scene.geometries.size());
  for (const Geometry& geometry : scene.geometries) bounds.push_back(geometry.bounds());

  std::vector<DrawState> states;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    for (const Primitive& p : scene.meshes[m].primitives) {
      const Material fallback;
      const Material& material = p.material.valid() ? scene.materials[p.material.value] : fallback;
      const std::uint32_t material_index = p.material.valid() ? p.material.value : default_material_;
      const Geometry& geometry = scene.geometries[p.geometry.value];
      DrawState state;
      state.alpha = material.alpha_mode;
      switch (geometry.topology) {
        case Topology::points:
          state.kind = PrimitiveKind::points;
          break;
        case Topology::lines:
        case Topology::line_loop:
        case Topology::line_strip:
          state.kind = PrimitiveKind::lines;
          break;
        default:
          break;
      }
      state.double_sided = material.double_sided;
      state.texture_set = texture_set_of_material[material_index];
      // glTF: tangents without normals are to be ignored.
      state.tangents =
          material.normal_texture.texture.valid() && !geometry.normals.empty() && !geometry.tangents.empty();
      states.push_back(state);
      const auto vertices = static_cast<std::uint32_t>(geometry.drawn_vertex_count());
      primitives_.push_back({p.geometry, MaterialId(material_index), MeshId(m), 0,
                             DrawWork{vertices, vertices / 3, 1.0F}, bounds[p.geometry.value]});
    }
  }

  std::vector<std::uint32_t> order(primitives_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (const auto c = states[a] <=> states[b]; c != 0) return c < 0;
    return primitives_[a].geometry < primitives_[b].geometry;
  });
  std::vector<DrawPrimitive> sorted;
  sorted.reserve(primitives_.size());
  primitives_of_mesh_.resize(scene.meshes.size());
  for (const std::uint32_t i : order) {
    if (batches_.empty() || batches_.back().state != states[i]) batches_.push_back({states[i], 0, 0});
    sorted.push_back(primitives_[i]);
    sorted.back().batch = static_cast<std::uint32_t>(batches_.size() - 1);
    primitives_of_mesh_[sorted.back().mesh.value].push_back(static_cast<std::uint32_t>(sorted.size() - 1));
  }
  primitives_ = std::move(sorted);
}

void DrawScene::set_work(std::span<const DrawWork> of_geometry) {
  for (DrawPrimitive& primitive : primitives_) primitive.work = of_geometry[primitive.geometry.value];
  find_strata();
}

void DrawScene::find_strata() {
  strata_.clear();
  for (std::uint32_t slot = 0; slot < solid_end_; ++slot) {
    const DrawWork& work = primitive(slot).work;
    const bool textured = batches_[primitive(slot).batch].state.texture_set != 0;
    if (strata_.empty() || strata_.back().work.vertices != work.vertices ||
        strata_.back().work.triangles != work.triangles || strata_.back().textured != textured) {
      if (strata_.size() == kMostStrata) return strata_.clear();
      strata_.push_back({slot, slot, work, textured});
    }
    strata_.back().end = slot + 1;
  }
}

void DrawScene::build_slots(const Scene& scene) {
  // Meshes that an object may show besides its own.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> swaps;  // object, mesh
  for (const ObjectMeshTrack& t : scene.object_mesh_tracks) {
    for (const float value : scene.values(t.track))
      swaps.emplace_back(t.object.value, static_cast<std::uint32_t>(value));
    swaps.emplace_back(t.object.value, scene.objects.mesh[t.object.value].value);
  }
  std::sort(swaps.begin(), swaps.end());
  swaps.erase(std::unique(swaps.begin(), swaps.end()), swaps.end());

  const auto objects = static_cast<std::uint32_t>(scene.objects.size());
  const auto for_each_primitive = [&](const auto& body) {
    std::size_t next_swap = 0;
    for (std::uint32_t i = 0; i < objects; ++i) {
      if (next_swap < swaps.size() && swaps[next_swap].first == i) {
        for (; next_swap < swaps.size() && swaps[next_swap].first == i; ++next_swap)
          for (const std::uint32_t p : primitives_of_mesh_[swaps[next_swap].second]) body(i, p);
      } else if (scene.objects.mesh[i].valid()) {
        for (const std::uint32_t p : primitives_of_mesh_[scene.objects.mesh[i].value]) body(i, p);
      }
    }
  };

  // Counting sort by primitive; objects ascend within one. A batch is a run of primitives.
  std::vector<std::uint32_t> next(primitives_.size() + 1, 0);
  for_each_primitive([&](std::uint32_t, std::uint32_t p) { ++next[p + 1]; });
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (std::uint32_t p = 0; p < primitives_.size(); ++p) {
    Batch& batch = batches_[primitives_[p].batch];
    if (p == 0 || primitives_[p - 1].batch != primitives_[p].batch) batch.first = next[p];
    batch.end = next[p + 1];
  }
  for (const Batch& batch : batches_) {
    if (batch.state.alpha != AlphaMode::blend) solid_end_ = batch.end;
  }
  const std::uint32_t slots = next.back();
  primitive_of_slot_.resize(slots);
  object_of_slot_.resize(slots);
  slots_by_object_.reserve(slots);
  first_slot_of_object_.assign(objects + 1, 0);
  for_each_primitive([&](std::uint32_t object, std::uint32_t p) {
    const std::uint32_t slot = next[p]++;
    primitive_of_slot_[slot] = p;
    object_of_slot_[slot] = object;
    slots_by_object_.push_back(slot);
    first_slot_of_object_[object + 1] = static_cast<std::uint32_t>(slots_by_object_.size());
  });
  for (std::uint32_t i = 0; i < objects; ++i)  // objects without a slot
    first_slot_of_object_[i + 1] = std::max(first_slot_of_object_[i + 1], first_slot_of_object_[i]);
}

std::span<const std::uint32_t> DrawScene::slots_of(ObjectId id) const {
  const std::uint32_t first = first_slot_of_object_[id.value];
  return std::span(slots_by_object_).subspan(first, first_slot_of_object_[id.value + 1] - first);
}

void DrawScene::place(ObjectId id, const glm::mat4& world_from_object) {
  const bool inside_out = glm::determinant(glm::mat3(world_from_object)) < 0.0F;
  for (const std::uint32_t slot : slots_of(id)) {
    const Box box = transformed(primitives_[primitive_of_slot_[slot]].bounds_m, world_from_object);
    boxes_.set(slot, box);
    inside_out ? mirrored_.set(slot) : mirrored_.reset(slot);
  }
}

void DrawScene::add_boxes_of(ObjectId id, Box& bounds_m) const {
  for (const std::uint32_t slot : slots_of(id)) {
    const Box box = boxes_.get(slot);
    if (!box.empty()) bounds_m.add(box);
  }
}

void DrawScene::refresh_bounds() {
  bounds_m_ = resting_bounds_m_;
  for (const ObjectId id : moving_objects_) add_boxes_of(id, bounds_m_);
}

void DrawScene::refresh_visibility(ObjectId id, const timeline::Player& player) {
  const bool now = player.visible(id);
  std::uint8_t& before = visible_object_[id.value];
  if (now && before == 0) ++visible_objects_;
  if (!now && before != 0) --visible_objects_;
  before = now ? 1 : 0;
  const MeshId mesh = player.mesh(id);
  for (const std::uint32_t slot : slots_of(id)) {
    now&& primitives_[primitive_of_slot_[slot]].mesh == mesh ? visible_.set(slot) : visible_.reset(slot);
  }
}

void DrawScene::apply(const timeline::ChangeSet& changes, const timeline::Player& player) {
  for (const ObjectId id : changes.shown) refresh_visibility(id, player);
  for (const ObjectId id : changes.hidden) refresh_visibility(id, player);
  for (const ObjectId id : changes.remeshed) refresh_visibility(id, player);
  for (const ObjectId id : changes.moved) {
    const glm::mat4 world_from_object = player.world_from_object(id);
    place(id, world_from_object);
    for (const std::uint32_t slot : slots_of(id)) {
      dirty_slots_.push_back(slot);
      dirty_records_.push_back(record(slot, world_from_object));
    }
  }
  if (!changes.moved.empty()) refresh_bounds();
}

ObjectRecord DrawScene::record(std::uint32_t slot, const glm::mat4& m) const {
  ObjectRecord r;
  for (int row = 0; row < 3; ++row)
    r.world_from_object[row] = glm::vec4(m[0][row], m[1][row], m[2][row], m[3][row]);
  r.material = primitive(slot).material.value;
  r.object = object_of_slot_[slot];
  return r;
}

std::vector<ObjectRecord> DrawScene::all_records(const timeline::Player& player) const {
  std::vector<ObjectRecord> out(slot_count());
  for (std::uint32_t i = 0; i < object_count(); ++i) {
    const glm::mat4 world_from_object = player.world_from_object(ObjectId(i));
    for (const std::uint32_t slot : slots_of(ObjectId(i))) out[slot] = record(slot, world_from_object);
  }
  return out;
}

void DrawScene::clear_dirty() {
  dirty_slots_.clear();
  dirty_records_.clear();
}

std::uint64_t DrawScene::memory_bytes() const {
  return held_bytes(primitives_, primitives_of_mesh_, batches_, primitive_of_slot_, object_of_slot_,
                    first_slot_of_object_, slots_by_object_, large_slots_, strata_) +
         held_bytes(visible_object_, moving_objects_, dirty_slots_, dirty_records_) + boxes_.memory_bytes() +
         visible_.memory_bytes() + mirrored_.memory_bytes();
}

}  // namespace scenegen::render
