#include "scene/gltf/parse.h"

namespace scenegen::gltf::reading {

namespace {

NodeDetail& detail_of(Node& node, Document& out) {
  if (node.detail == kNone) {
    node.detail = static_cast<std::uint32_t>(out.node_details.size());
    out.node_details.emplace_back();
  }
  return out.node_details[node.detail];
}

void parse_attributes(Value value, const Place& at, Instances& instances, Document& out) {
  each_field(value, at, [&](std::string_view name, Value& v, const Place& p) {
    if (name == "TRANSLATION") {
      instances.translation = get_index(v, p);
    } else if (name == "ROTATION") {
      instances.rotation = get_index(v, p);
    } else if (name == "SCALE") {
      instances.scale = get_index(v, p);
    } else if (name == "_OBJECT_ID") {
      instances.object_id = get_index(v, p);
    } else if (name == "mesh") {
      instances.mesh = get_index(v, p);
    } else {
      out.ignored.add(p, "instance attribute " + printable(name));
    }
  });
}

void parse_instancing(Value value, const Place& at, NodeDetail& detail, Document& out) {
  detail.instanced = true;
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "attributes") parse_attributes(v, p, detail.instances, out);
  });
  detail.instances.mesh = kNone;
}

void parse_sets(Value value, const Place& at, NodeDetail& detail, Document& out) {
  detail.first_set = static_cast<std::uint32_t>(out.instance_sets.size());
  each_element(value, at, [&](Value& element, const Place& place) {
    parse_attributes(element, place, out.instance_sets.emplace_back(), out);
  });
  detail.set_count = static_cast<std::uint32_t>(out.instance_sets.size()) - detail.first_set;
}

void parse_node_extensions(Value value, const Place& at, Node& node, Document& out) {
  each_field(value, at, [&](std::string_view name, Value& v, const Place& p) {
    if (name == "KHR_node_visibility") {
      node.has_visibility = true;
      each_field(v, p, [&](std::string_view key, Value& w, const Place& q) {
        if (key == "visible") node.visible = get_bool(w, q);
      });
    } else if (name == "EXT_mesh_gpu_instancing") {
      parse_instancing(v, p, detail_of(node, out), out);
    } else {
      node.has_other = true;
      ignore_extension(name, p, out);
    }
  });
}

void parse_node_extras(Value value, const Place& at, Node& node, Document& out) {
  node.odd_extras = !is_object(value);
  if (node.odd_extras) return;
  each_field(value, at, [&](std::string_view owner, Value& v, const Place& p) {
    if (owner != "scenegen" || !is_object(v)) return;
    NodeDetail& detail = detail_of(node, out);
    each_field(v, p, [&](std::string_view key, Value& w, const Place& q) {
      if (key == "object") {
        detail.object = get_index(w, q);
      } else if (key == "look") {
        detail.look = get_index(w, q);
      } else if (key == "mesh") {
        detail.mesh = get_index(w, q);
      } else if (key == "frame") {
        detail.frame = get_index(w, q);
      } else if (key == "visibility") {
        detail.visibility = get_index(w, q);
      } else if (key == "looks") {
        detail.looks = get_index(w, q);
      } else if (key == "ids") {
        detail.instances.first_id = get_index(w, q);
      } else if (key == "standsFor") {
        detail.stands_for = get_index(w, q);
      } else if (key == "name") {
        detail.name = out.unescaped.emplace_back(get_string(w, q));
      } else if (key == "shows") {
        detail.shows = get_index(w, q);
      } else if (key == "objects") {
        parse_sets(w, q, detail, out);
      }
    });
  });
}

void parse_matrix(Value value, const Place& at, Node& node, Document& out) {
  const auto f = get_floats<16>(value, at);
  NodeDetail& detail = detail_of(node, out);
  detail.has_matrix = true;
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r)
      detail.matrix[c][r] = f[static_cast<std::size_t>(c) * 4 + static_cast<std::size_t>(r)];
  }
  if (f[3] != 0 || f[7] != 0 || f[11] != 0 || f[15] != 1) reject(at, "its last row is not 0 0 0 1");
}

void parse_node(Value value, const Place& at, Document& out) {
  Node node;
  bool has_trs = false;
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "name") {
      node.name = get_string(v, p);
    } else if (key == "mesh") {
      node.mesh = get_index(v, p);
    } else if (key == "translation") {
      const auto f = get_floats<3>(v, p);
      node.local.translation_m = {f[0], f[1], f[2]};
      has_trs = true;
    } else if (key == "rotation") {
      node.local.rotation = unit_rotation(get_floats<4>(v, p), p);
      has_trs = true;
    } else if (key == "scale") {
      const auto f = get_floats<3>(v, p);
      node.local.scale = {f[0], f[1], f[2]};
      has_trs = true;
    } else if (key == "matrix") {
      parse_matrix(v, p, node, out);
    } else if (key == "children") {
      node.first_child = static_cast<std::uint32_t>(out.children.size());
      each_element(v, p, [&](Value& w, const Place& q) { out.children.push_back(get_index(w, q)); });
      node.child_count = static_cast<std::uint32_t>(out.children.size() - node.first_child);
    } else if (key == "extensions") {
      parse_node_extensions(v, p, node, out);
    } else if (key == "extras") {
      parse_node_extras(v, p, node, out);
    } else if (key == "camera") {
      node.camera = get_index(v, p);
    } else if (key == "skin") {
      node.skinned = true;
      out.ignored.add(p, "skins are drawn at rest");
    }
  });
  if (node.detail != kNone && out.node_details[node.detail].has_matrix && has_trs) {
    reject(at.key("matrix"), "together with translation, rotation or scale");
  }
  out.nodes.push_back(node);
}

}  // namespace

glm::quat unit_rotation(const std::array<float, 4>& f, const Place& at) {
  const double length2 =
      double{f[0]} * f[0] + double{f[1]} * f[1] + double{f[2]} * f[2] + double{f[3]} * f[3];
  const glm::quat q(f[3], f[0], f[1], f[2]);
  if (std::abs(length2 - 1.0) <= 1e-4) return q;
  if (!(length2 > 1e-6 && length2 < 1e6)) reject(at, "not a rotation: its length is 0 or beyond reason");
  const double s = 1.0 / std::sqrt(length2);
  return {static_cast<float>(f[3] * s), static_cast<float>(f[0] * s), static_cast<float>(f[1] * s),
          static_cast<float>(f[2] * s)};
}

void parse_nodes(Value value, const Place& at, Document& out) {
  each_element(value, at, [&](Value& element, const Place& place) { parse_node(element, place, out); });
}

}  // namespace scenegen::gltf::reading
