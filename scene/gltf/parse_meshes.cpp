#include "scene/gltf/parse.h"

namespace scenegen::gltf::reading {

namespace {

constexpr std::string_view kAttributeNames[kAttributes] = {"POSITION",   "NORMAL",     "TANGENT",
                                                           "TEXCOORD_0", "TEXCOORD_1", "COLOR_0"};

/// f(slot, value, place) for the attributes that a Geometry has.
template <class F>
void each_attribute(Value value, const Place& at, Document* report, F&& f) {
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    for (std::size_t i = 0; i < kAttributes; ++i) {
      if (kAttributeNames[i] == key) return f(i, get_index(v, p));
    }
    const bool ours = key == "_OBJECT_ID";  // of layout merged
    if (report != nullptr && !ours) report->ignored.add(p, "vertex attribute " + printable(key));
  });
}

void parse_draco(Value value, const Place& at, PrimitiveRecord& primitive) {
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "bufferView") {
      primitive.draco_view = get_index(v, p);
    } else if (key == "attributes") {
      each_attribute(v, p, nullptr,
                     [&](std::size_t slot, std::uint32_t id) { primitive.draco_id[slot] = id; });
    }
  });
  if (primitive.draco_view == kNone) reject(at.key("bufferView"), "missing");
}

void parse_primitive(Value value, const Place& at, Document& out) {
  PrimitiveRecord primitive;
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "attributes") {
      each_attribute(v, p, &out,
                     [&](std::size_t slot, std::uint32_t index) { primitive.attribute[slot] = index; });
    } else if (key == "indices") {
      primitive.indices = get_index(v, p);
    } else if (key == "material") {
      primitive.material = get_index(v, p);
    } else if (key == "mode") {
      primitive.mode = static_cast<std::uint32_t>(get_count(v, p, 6));
    } else if (key == "targets") {
      out.ignored.add(p, "morph targets are drawn at rest");
    } else if (key == "extensions") {
      each_field(v, p, [&](std::string_view name, Value& w, const Place& q) {
        if (name == "KHR_draco_mesh_compression") {
          parse_draco(w, q, primitive);
        } else {
          ignore_extension(name, q, out);
        }
      });
    }
  });
  out.primitives.push_back(primitive);
}

}  // namespace

void parse_meshes(Value value, const Place& at, Document& out) {
  each_element(value, at, [&](Value& element, const Place& place) {
    MeshRecord mesh;
    mesh.first_primitive = static_cast<std::uint32_t>(out.primitives.size());
    each_field(element, place, [&](std::string_view key, Value& v, const Place& p) {
      if (key == "name") {
        mesh.name = get_string(v, p);
      } else if (key == "primitives") {
        each_element(v, p, [&](Value& w, const Place& q) { parse_primitive(w, q, out); });
        mesh.primitive_count = static_cast<std::uint32_t>(out.primitives.size() - mesh.first_primitive);
      } else if (key == "extensions") {
        each_field(v, p,
                   [&](std::string_view name, Value&, const Place& q) { ignore_extension(name, q, out); });
      }
    });
    if (mesh.primitive_count == 0) reject(place.key("primitives"), "missing or empty");
    out.meshes.push_back(mesh);
  });
}

}  // namespace scenegen::gltf::reading
