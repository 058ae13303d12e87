#include "scene/gltf/write_buffer.h"

#include <bit>
#include <cassert>

namespace scenegen::gltf {

namespace {

constexpr std::uint64_t align4(std::uint64_t n) {
  return (n + 3) & ~std::uint64_t{3};
}

/// Index 65535 means "restart" in 16 bits.
bool fits_16_bits(std::uint64_t vertices) {
  return vertices <= 65535;
}

void plan_geometries(const Scene& scene, BufferPlan& plan) {
  const std::vector<std::uint8_t> used = used_geometries(scene);
  plan.geometries.resize(scene.geometries.size());
  int next = 0;
  bool compressed = false;
  const auto stream = [&](const auto& data, ViewKind kind, int& accessor) {
    if (data.empty()) return;
    accessor = next++;
    if (!compressed) plan[kind].bytes += data.size() * sizeof(data[0]);
  };
  for (std::size_t g = 0; g < scene.geometries.size(); ++g) {
    if (used[g] == 0) continue;
    const Geometry& geometry = scene.geometries[g];
    GeometryAccessors& accessors = plan.geometries[g];
    compressed = plan.streams->find(g) != nullptr;
    stream(geometry.positions_m, ViewKind::positions, accessors.position);
    stream(geometry.normals, ViewKind::normals, accessors.normal);
    stream(geometry.tangents, ViewKind::tangents, accessors.tangent);
    stream(geometry.texcoords[0], ViewKind::texcoords_0, accessors.texcoord[0]);
    stream(geometry.texcoords[1], ViewKind::texcoords_1, accessors.texcoord[1]);
    stream(geometry.colors, ViewKind::colors, accessors.color);
    if (geometry.indices.empty() && !compressed) continue;
    accessors.indices = next++;
    if (compressed) continue;
    const bool narrow = fits_16_bits(geometry.vertex_count());
    plan[narrow ? ViewKind::indices_16 : ViewKind::indices_32].bytes +=
        geometry.indices.size() * (narrow ? 2U : 4U);
  }
  plan.accessor_count = static_cast<std::uint32_t>(next);
}

std::uint64_t value_floats(const FileTracks& tracks, const ValueOutput& output) {
  const std::uint64_t parts = file_interpolation(tracks, output.track) == Interpolation::cubic_spline ? 3 : 1;
  return FileKeys(tracks, output.track).count * parts * width(tracks[output.track].property);
}

void plan_animation(const FileTracks& tracks, const AnimationPlan& animation, BufferPlan& plan) {
  const auto keys_of = [&](TrackId track) { return std::uint64_t{FileKeys(tracks, track).count}; };
  plan.first_input = plan.accessor_count;
  for (const TrackId track : animation.inputs) plan[ViewKind::times].bytes += keys_of(track) * 4;
  plan.first_byte_output = plan.first_input + static_cast<std::uint32_t>(animation.inputs.size());
  for (const std::uint32_t p : animation.byte_outputs)
    plan[ViewKind::bytes].bytes += keys_of(animation.patterns[p].track);
  plan.first_scale_output =
      plan.first_byte_output + static_cast<std::uint32_t>(animation.byte_outputs.size());
  for (const ScaleOutput& o : animation.scale_outputs)
    plan[ViewKind::values].bytes += keys_of(animation.patterns[o.pattern].track) * 12;
  plan.first_value_output =
      plan.first_scale_output + static_cast<std::uint32_t>(animation.scale_outputs.size());
  for (const ValueOutput& o : animation.value_outputs)
    plan[ViewKind::values].bytes += value_floats(tracks, o) * 4;
  plan.accessor_count = plan.first_value_output + static_cast<std::uint32_t>(animation.value_outputs.size());
}

void plan_instances(const Scene& scene, const NodePlan& nodes, BufferPlan& plan) {
  if (!nodes.compact()) return;
  plan.instances = number_instance_accessors(scene, nodes, plan.accessor_count);
  for (std::size_t s = 0; s < nodes.sets.size(); ++s) {
    const std::uint64_t count = nodes.sets[s].count;
    plan[ViewKind::translations].bytes += count * 12;
    if (plan.instances[s].own_rotation) plan[ViewKind::rotations].bytes += count * 16;
    if (plan.instances[s].own_scale) plan[ViewKind::scales].bytes += count * 12;
    if (!nodes.id_table) plan[ViewKind::object_ids].bytes += count * 4;
  }
  if (nodes.id_table) {
    ByteSink ids;
    write_id_table(nodes, ids);
    plan[ViewKind::object_ids].bytes = ids.total();
  }
  ByteSink counter;
  write_front_coded(scene.objects.names, counter);
  plan[ViewKind::names].bytes = counter.total();
}

struct MergedStream {
  VertexStream stream;
  ViewKind view;
  std::uint32_t bytes;  ///< of an element
  int component_type;
  std::string_view type;
};
constexpr int kUnsignedByte = 5121, kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;
constexpr MergedStream kMergedStreams[] = {
    {VertexStream::position, ViewKind::positions, 12, kFloat, "VEC3"},
    {VertexStream::normal, ViewKind::normals, 12, kFloat, "VEC3"},
    {VertexStream::tangent, ViewKind::tangents, 16, kFloat, "VEC4"},
    {VertexStream::texcoord_0, ViewKind::texcoords_0, 8, kFloat, "VEC2"},
    {VertexStream::texcoord_1, ViewKind::texcoords_1, 8, kFloat, "VEC2"},
    {VertexStream::color, ViewKind::colors, 16, kFloat, "VEC4"},
    {VertexStream::object_id, ViewKind::vertex_ids, 4, kUnsignedShort, "VEC2"},
};

void plan_merged(const MergePlan& merge, BufferPlan& plan) {
  plan.first_merged = plan.accessor_count;
  plan.merge = &merge;
  for (const MergedPrimitive& primitive : merge.primitives) {
    plan.accessor_count += merged_accessors(primitive);
    for (const MergedStream& s : kMergedStreams) {
      if (primitive.has(s.stream)) plan[s.view].bytes += primitive.vertices * s.bytes;
    }
    const bool narrow = fits_16_bits(primitive.vertices);
    plan[narrow ? ViewKind::indices_16 : ViewKind::indices_32].bytes += primitive.indices * (narrow ? 2 : 4);
  }
}

}  // namespace

std::uint32_t merged_accessors(const MergedPrimitive& primitive) {
  return static_cast<std::uint32_t>(std::popcount(primitive.streams)) + (primitive.indexed ? 1U : 0U);
}

std::uint32_t BufferPlan::accessor_of(const AnimationSampler& sampler) const {
  switch (sampler.kind) {
    case OutputKind::bytes:
      return first_byte_output + sampler.output;
    case OutputKind::scale:
      return first_scale_output + sampler.output;
    case OutputKind::values:
      return first_value_output + sampler.output;
  }
  return 0;
}

std::vector<std::uint8_t> used_geometries(const Scene& scene) {
  std::vector<std::uint8_t> used(scene.geometries.size(), 0);
  for (const Mesh& mesh : scene.meshes) {
    for (const Primitive& p : mesh.primitives) used[p.geometry.value] = 1;
  }
  return used;
}

std::uint64_t plain_bytes(const Geometry& geometry) {
  const auto of = [](const auto& data) { return std::uint64_t{data.size()} * sizeof(data[0]); };
  return of(geometry.positions_m) + of(geometry.normals) + of(geometry.tangents) + of(geometry.texcoords[0]) +
         of(geometry.texcoords[1]) + of(geometry.colors) +
         geometry.indices.size() * (fits_16_bits(geometry.vertex_count()) ? 2U : 4U);
}

BufferPlan plan_buffer(const Scene& scene, const NodePlan& nodes, const AnimationPlan& animation,
                       const DracoStreams& draco, const MergePlan& merge) {
  BufferPlan plan;
  plan.streams = &draco;
  plan_geometries(scene, plan);
  plan_animation(nodes.tracks, animation, plan);
  plan_instances(scene, nodes, plan);
  plan_merged(merge, plan);
  for (const DracoStream& stream : draco.of_geometry) plan.draco.push_back({0, stream.bytes.size(), 0});
  for (const Image& image : scene.images) plan.images.push_back({0, image.bytes.size(), 0});

  const auto place = [&](BufferPlan::View& view) {
    if (view.bytes == 0) return;
    view.offset = plan.bytes;
    view.index = plan.view_count++;
    plan.bytes = align4(plan.bytes + view.bytes);
  };
  for (BufferPlan::View& view : plan.views) place(view);
  for (BufferPlan::View& view : plan.draco) place(view);
  for (BufferPlan::View& view : plan.images) place(view);
  return plan;
}

namespace {

/// Writes the elements of /accessors one after the other and keeps track of the offset in each view.
class AccessorText {
 public:
  AccessorText(const BufferPlan& plan, TextOut& out) : plan_(plan), out_(out), commas_(out) {}

  /// Opens an accessor; the caller adds min and max, then calls close().
  TextOut& open(ViewKind kind, int component_type, std::uint64_t count, std::string_view type,
                std::uint64_t bytes) {
    commas_.next().raw(R"({"bufferView":)");
    out_.number(plan_[kind].index);
    std::uint64_t& offset = offsets_[static_cast<std::size_t>(kind)];
    if (offset != 0) {
      out_.raw(R"(,"byteOffset":)");
      out_.number(offset);
    }
    out_.raw(R"(,"componentType":)");
    out_.number(component_type);
    out_.raw(R"(,"count":)");
    out_.number(count);
    out_.raw(R"(,"type":")");
    out_.raw(type);
    out_.raw("\"");
    offset += bytes;
    ++count_;
    return out_;
  }
  /// An accessor whose data are in a Draco stream: no buffer view.
  TextOut& open_compressed(int component_type, std::uint64_t count, std::string_view type) {
    commas_.next().raw(R"({"componentType":)");
    out_.number(component_type);
    out_.raw(R"(,"count":)");
    out_.number(count);
    out_.raw(R"(,"type":")");
    out_.raw(type);
    out_.raw("\"");
    ++count_;
    return out_;
  }
  void close() { out_.raw("}"); }
  void add(ViewKind kind, int component_type, std::uint64_t count, std::string_view type,
           std::uint64_t bytes) {
    open(kind, component_type, count, type, bytes);
    close();
  }
  [[nodiscard]] std::uint32_t count() const { return count_; }

 private:
  const BufferPlan& plan_;
  TextOut& out_;
  Commas commas_;
  std::array<std::uint64_t, kViewKinds> offsets_{};
  std::uint32_t count_ = 0;
};

void emit_box(const Box& box, TextOut& out) {
  out.raw(R"(,"min":)");
  out.numbers(box.lo);
  out.raw(R"(,"max":)");
  out.numbers(box.hi);
}

/// The same accessors in the same order as emit_geometry_accessors(), of what the stream decodes to.
void emit_compressed_accessors(const DracoStream& stream, AccessorText& accessors) {
  const auto attribute = [&](int id, std::string_view type) {
    if (id < 0) return;
    accessors.open_compressed(kFloat, stream.vertices, type);
    accessors.close();
  };
  emit_box(stream.box, accessors.open_compressed(kFloat, stream.vertices, "VEC3"));
  accessors.close();
  attribute(stream.normal, "VEC3");
  attribute(stream.tangent, "VEC4");
  attribute(stream.texcoord[0], "VEC2");
  attribute(stream.texcoord[1], "VEC2");
  attribute(stream.color, "VEC4");
  accessors.open_compressed(fits_16_bits(stream.vertices) ? kUnsignedShort : kUnsignedInt, stream.indices,
                            "SCALAR");
  accessors.close();
}

void emit_geometry_accessors(const Geometry& geometry, AccessorText& accessors) {
  const auto stream = [&](const auto& data, ViewKind kind, std::string_view type) {
    if (!data.empty()) accessors.add(kind, kFloat, data.size(), type, data.size() * sizeof(data[0]));
  };
  const std::size_t vertices = geometry.positions_m.size();
  emit_box(geometry.bounds(),
           accessors.open(ViewKind::positions, kFloat, vertices, "VEC3", vertices * sizeof(glm::vec3)));
  accessors.close();
  stream(geometry.normals, ViewKind::normals, "VEC3");
  stream(geometry.tangents, ViewKind::tangents, "VEC4");
  stream(geometry.texcoords[0], ViewKind::texcoords_0, "VEC2");
  stream(geometry.texcoords[1], ViewKind::texcoords_1, "VEC2");
  stream(geometry.colors, ViewKind::colors, "VEC4");
  const std::size_t indices = geometry.indices.size();
  if (indices == 0) return;
  if (fits_16_bits(vertices)) {
    accessors.add(ViewKind::indices_16, kUnsignedShort, indices, "SCALAR", indices * 2);
  } else {
    accessors.add(ViewKind::indices_32, kUnsignedInt, indices, "SCALAR", indices * 4);
  }
}

void emit_merged_accessors(const MergedPrimitive& primitive, AccessorText& accessors) {
  const std::uint64_t n = primitive.vertices;
  for (const MergedStream& s : kMergedStreams) {
    if (!primitive.has(s.stream)) continue;
    TextOut& out = accessors.open(s.view, s.component_type, n, s.type, n * s.bytes);
    if (s.stream == VertexStream::position) emit_box(primitive.box, out);
    accessors.close();
  }
  if (!primitive.indexed) return;
  const bool narrow = fits_16_bits(n);
  accessors.add(narrow ? ViewKind::indices_16 : ViewKind::indices_32, narrow ? kUnsignedShort : kUnsignedInt,
                primitive.indices, "SCALAR", primitive.indices * (narrow ? 2 : 4));
}

void emit_animation_accessors(const FileTracks& tracks, const AnimationPlan& animation,
                              AccessorText& accessors) {
  for (const TrackId track : animation.inputs) {
    const FileKeys keys(tracks, track);
    TextOut& out =
        accessors.open(ViewKind::times, kFloat, keys.count, "SCALAR", std::uint64_t{keys.count} * 4);
    out.raw(R"(,"min":[)");
    out.number(file_time_s(tracks, track, keys, 0));
    out.raw(R"(],"max":[)");
    out.number(file_time_s(tracks, track, keys, keys.count - 1));
    out.raw("]");
    accessors.close();
  }
  for (const std::uint32_t p : animation.byte_outputs) {
    const std::uint64_t count = FileKeys(tracks, animation.patterns[p].track).count;
    accessors.add(ViewKind::bytes, kUnsignedByte, count, "SCALAR", count);
  }
  for (const ScaleOutput& o : animation.scale_outputs) {
    const std::uint64_t count = FileKeys(tracks, animation.patterns[o.pattern].track).count;
    accessors.add(ViewKind::values, kFloat, count, "VEC3", count * 12);
  }
  for (const ValueOutput& o : animation.value_outputs) {
    const std::uint64_t floats = value_floats(tracks, o);
    const std::uint32_t w = width(tracks[o.track].property);
    accessors.add(ViewKind::values, kFloat, floats / w, w == 3 ? "VEC3" : "VEC4", floats * 4);
  }
}

void write_indices(const Geometry& geometry, bool narrow, ByteSink& sink) {
  if (geometry.indices.empty() || fits_16_bits(geometry.vertex_count()) != narrow) return;
  if (!narrow) return sink.write(geometry.indices.data(), geometry.indices.size() * 4);
  for (const std::uint32_t index : geometry.indices) {
    const auto value = static_cast<std::uint16_t>(index);
    sink.write(&value, 2);
  }
}

void write_times(const FileTracks& tracks, const AnimationPlan& animation, ByteSink& sink) {
  for (const TrackId track : animation.inputs) {
    const FileKeys keys(tracks, track);
    for (std::uint32_t k = 0; k < keys.count; ++k) {
      const float time_s = file_time_s(tracks, track, keys, k);
      sink.write(&time_s, 4);
    }
  }
}

void write_values(const FileTracks& tracks, const AnimationPlan& animation, ByteSink& sink) {
  for (const ScaleOutput& o : animation.scale_outputs) {
    const Pattern& pattern = animation.patterns[o.pattern];
    const FileKeys keys(tracks, pattern.track);
    for (std::uint32_t k = 0; k < keys.count; ++k) {
      const glm::vec3 scale = pattern.shown(tracks, keys.source(k)) ? o.shown : glm::vec3(0.0F);
      sink.write(&scale, 12);
    }
  }
  for (const ValueOutput& o : animation.value_outputs)
    for_each_file_value(tracks, o.track, o.divisor, [&](float v) { sink.write(&v, 4); });
}

void write_visibility_bytes(const FileTracks& tracks, const AnimationPlan& animation, ByteSink& sink) {
  for (const std::uint32_t p : animation.byte_outputs) {
    const Pattern& pattern = animation.patterns[p];
    const FileKeys keys(tracks, pattern.track);
    for (std::uint32_t k = 0; k < keys.count; ++k) {
      const std::uint8_t value = pattern.shown(tracks, keys.source(k)) ? 1 : 0;
      sink.write(&value, 1);
    }
  }
}

/// One attribute of all instances. The pass over the groups is repeated for each, so that nothing is
/// collected.
void write_instances(const Scene& scene, const NodePlan& nodes, const BufferPlan& plan, ViewKind kind,
                     ByteSink& sink) {
  if (kind == ViewKind::object_ids && nodes.id_table) return write_id_table(nodes, sink);
  for (std::size_t s = 0; s < nodes.sets.size(); ++s) {
    const InstanceSet& set = nodes.sets[s];
    if ((kind == ViewKind::rotations && !plan.instances[s].own_rotation) ||
        (kind == ViewKind::scales && !plan.instances[s].own_scale))
      continue;
    for (std::uint32_t k = set.first; k < set.first + set.count; ++k) {
      const std::uint32_t object = nodes.grouped[k];
      const Transform& transform = scene.objects.frame_from_object[object];
      const glm::quat& r = transform.rotation;
      const glm::vec4 rotation(r.x, r.y, r.z, r.w);
      if (kind == ViewKind::translations) sink.write(&transform.translation_m, 12);
      if (kind == ViewKind::rotations) sink.write(&rotation, 16);
      if (kind == ViewKind::scales) sink.write(&transform.scale, 12);
      if (kind == ViewKind::object_ids) sink.write(&object, 4);
    }
  }
}

void write_geometries(const Scene& scene, const BufferPlan& plan, ViewKind kind, ByteSink& sink) {
  const auto put = [&](const auto& data) { sink.write(data.data(), data.size() * sizeof(data[0])); };
  for (std::size_t g = 0; g < scene.geometries.size(); ++g) {
    if (plan.geometries[g].position < 0 || plan.streams->find(g) != nullptr) continue;
    const Geometry& geometry = scene.geometries[g];
    if (kind == ViewKind::positions) put(geometry.positions_m);
    if (kind == ViewKind::normals) put(geometry.normals);
    if (kind == ViewKind::tangents) put(geometry.tangents);
    if (kind == ViewKind::texcoords_0) put(geometry.texcoords[0]);
    if (kind == ViewKind::texcoords_1) put(geometry.texcoords[1]);
    if (kind == ViewKind::colors) put(geometry.colors);
    if (kind == ViewKind::indices_16 || kind == ViewKind::indices_32)
      write_indices(geometry, kind == ViewKind::indices_16, sink);
  }
}

void write_merged(const Scene& scene, const MergePlan& merge, ViewKind kind, ByteSink& sink) {
  for (const MergedPrimitive& primitive : merge.primitives) {
    if (sink.failed()) return;
    for (const MergedStream& s : kMergedStreams) {
      if (s.view == kind) write_merged_stream(scene, merge, primitive, s.stream, sink);
    }
    const bool narrow = fits_16_bits(primitive.vertices);
    if (kind == (narrow ? ViewKind::indices_16 : ViewKind::indices_32))
      write_merged_indices(scene, merge, primitive, narrow, sink);
  }
}

}  // namespace

void emit_accessors(const Scene& scene, const NodePlan& nodes, const AnimationPlan& animation,
                    const BufferPlan& plan, TextOut& out) {
  AccessorText accessors(plan, out);
  for (std::size_t g = 0; g < scene.geometries.size(); ++g) {
    if (plan.geometries[g].position < 0) continue;
    const DracoStream* const stream = plan.streams->find(g);
    if (stream != nullptr) {
      emit_compressed_accessors(*stream, accessors);
    } else {
      emit_geometry_accessors(scene.geometries[g], accessors);
    }
  }
  emit_animation_accessors(nodes.tracks, animation, accessors);
  for (std::size_t s = 0; s < nodes.sets.size(); ++s) {
    const std::uint64_t n = nodes.sets[s].count;
    accessors.add(ViewKind::translations, kFloat, n, "VEC3", n * 12);
    if (plan.instances[s].own_rotation) accessors.add(ViewKind::rotations, kFloat, n, "VEC4", n * 16);
    if (plan.instances[s].own_scale) accessors.add(ViewKind::scales, kFloat, n, "VEC3", n * 12);
    if (!nodes.id_table) accessors.add(ViewKind::object_ids, kUnsignedInt, n, "SCALAR", n * 4);
  }
  for (const MergedPrimitive& primitive : plan.merge->primitives) emit_merged_accessors(primitive, accessors);
  assert(accessors.count() == plan.accessor_count);
}

void emit_buffer_views(const Scene& scene, const BufferPlan& plan, TextOut& out) {
  Commas commas(out);
  const auto view = [&](const BufferPlan::View& v, int stride, int target) {
    if (v.bytes == 0) return;
    commas.next().raw(R"({"buffer":)");
    out.number(plan.buffer);
    out.raw(R"(,"byteOffset":)");
    out.number(plan.first_byte + v.offset);
    out.raw(R"(,"byteLength":)");
    out.number(v.bytes);
    if (stride != 0) {
      out.raw(R"(,"byteStride":)");
      out.number(stride);
    }
    if (target != 0) {
      out.raw(R"(,"target":)");
      out.number(target);
    }
    out.raw("}");
  };
  constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
  view(plan[ViewKind::positions], sizeof(glm::vec3), kArrayBuffer);
  view(plan[ViewKind::normals], sizeof(glm::vec3), kArrayBuffer);
  view(plan[ViewKind::tangents], sizeof(glm::vec4), kArrayBuffer);
  view(plan[ViewKind::texcoords_0], sizeof(glm::vec2), kArrayBuffer);
  view(plan[ViewKind::texcoords_1], sizeof(glm::vec2), kArrayBuffer);
  view(plan[ViewKind::colors], sizeof(glm::vec4), kArrayBuffer);
  view(plan[ViewKind::vertex_ids], sizeof(std::uint32_t), kArrayBuffer);
  view(plan[ViewKind::indices_16], 0, kElementArrayBuffer);
  view(plan[ViewKind::indices_32], 0, kElementArrayBuffer);
  for (std::size_t kind = static_cast<std::size_t>(ViewKind::times); kind < kViewKinds; ++kind)
    view(plan.views[kind], 0, 0);
  for (const BufferPlan::View& stream : plan.draco) view(stream, 0, 0);
  for (std::size_t i = 0; i < scene.images.size(); ++i) view(plan.images[i], 0, 0);
}

void write_buffer(const Scene& scene, const NodePlan& nodes, const AnimationPlan& animation,
                  const BufferPlan& plan, ByteSink& sink) {
  const std::uint64_t start = sink.total();
  const auto pad = [&] {
    const std::uint64_t at = sink.total() - start;
    sink.fill(0, align4(at) - at);
  };
  for (std::size_t k = 0; k < kViewKinds && !sink.failed(); ++k) {
    const auto kind = static_cast<ViewKind>(k);
    assert(plan[kind].bytes == 0 || sink.total() - start == plan[kind].offset);
    if (kind < ViewKind::times) {
      write_geometries(scene, plan, kind, sink);
      write_merged(scene, *plan.merge, kind, sink);
    }
    if (kind == ViewKind::times) write_times(nodes.tracks, animation, sink);
    if (kind == ViewKind::values) write_values(nodes.tracks, animation, sink);
    if (kind == ViewKind::bytes) write_visibility_bytes(nodes.tracks, animation, sink);
    if (kind >= ViewKind::translations && kind <= ViewKind::object_ids)
      write_instances(scene, nodes, plan, kind, sink);
    if (kind == ViewKind::names && plan[kind].bytes != 0) write_front_coded(scene.objects.names, sink);
    pad();
  }
  for (const DracoStream& stream : plan.streams->of_geometry) {
    sink.write(stream.bytes.data(), stream.bytes.size());
    pad();
  }
  for (const Image& image : scene.images) {
    sink.write(image.bytes.data(), image.bytes.size());
    pad();
  }
  assert(sink.failed() || sink.total() - start == plan.bytes);
}

}  // namespace scenegen::gltf
