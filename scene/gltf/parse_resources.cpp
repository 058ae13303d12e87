// Buffers, accessors, images, textures, cameras, scenes.
#include "scene/gltf/parse.h"

namespace scenegen::gltf::reading {

void parse_buffers(Value value, const Place& at, Document& out) {
  each_element(value, at, [&](Value& element, const Place& place) {
    Buffer& buffer = out.buffers.emplace_back();
    each_field(element, place, [&](std::string_view key, Value& v, const Place& p) {
      if (key == "uri") {
        buffer.uri = get_string(v, p);
        buffer.has_uri = true;
      } else if (key == "byteLength") {
        buffer.byte_length = get_count(v, p);
      }
    });
  });
}

void parse_buffer_views(Value value, const Place& at, Document& out) {
  each_element(value, at, [&](Value& element, const Place& place) {
    BufferView& view = out.views.emplace_back();
    each_field(element, place, [&](std::string_view key, Value& v, const Place& p) {
      if (key == "buffer") {
        view.buffer = get_index(v, p);
      } else if (key == "byteOffset") {
        view.byte_offset = get_count(v, p);
      } else if (key == "byteLength") {
        view.byte_length = get_count(v, p);
      } else if (key == "byteStride") {
        view.byte_stride = static_cast<std::uint32_t>(get_count(v, p, 252));
        if (view.byte_stride < 4) reject(p, std::to_string(view.byte_stride) + " is not in 4 ... 252");
      } else if (key == "extensions") {
        each_field(v, p,
                   [&](std::string_view name, Value&, const Place& q) { ignore_extension(name, q, out); });
      }
    });
  });
}

namespace {

std::uint32_t components_of(std::string_view type, const Place& at) {
  constexpr std::pair<std::string_view, std::uint32_t> kTypes[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
  for (const auto& [name, components] : kTypes) {
    if (name == type) return components;
  }
  reject(at, "'" + printable(type) + "' is none of SCALAR VEC2 VEC3 VEC4 MAT2 MAT3 MAT4");
}

void parse_sparse(Value value, const Place& at, Sparse& out) {
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    const bool indices = key == "indices";
    if (key == "count") {
      out.count = get_count(v, p);
    } else if (indices || key == "values") {
      each_field(v, p, [&](std::string_view inner, Value& w, const Place& q) {
        if (inner == "bufferView") {
          (indices ? out.index_view : out.value_view) = get_index(w, q);
        } else if (inner == "byteOffset") {
          (indices ? out.index_offset : out.value_offset) = get_count(w, q);
        } else if (inner == "componentType" && indices) {
          out.index_type = get_index(w, q);
        }
      });
    }
  });
}

}  // namespace

void parse_accessors(Value value, const Place& at, Document& out) {
  each_element(value, at, [&](Value& element, const Place& place) {
    Accessor& accessor = out.accessors.emplace_back();
    each_field(element, place, [&](std::string_view key, Value& v, const Place& p) {
      if (key == "bufferView") {
        accessor.view = get_index(v, p);
      } else if (key == "byteOffset") {
        accessor.byte_offset = get_count(v, p);
      } else if (key == "componentType") {
        accessor.component_type = get_index(v, p);
      } else if (key == "count") {
        accessor.count = get_count(v, p);
      } else if (key == "type") {
        accessor.components = components_of(get_string(v, p), p);
      } else if (key == "normalized") {
        accessor.normalized = get_bool(v, p);
      } else if (key == "sparse") {
        accessor.sparse = static_cast<std::uint32_t>(out.sparse.size());
        parse_sparse(v, p, out.sparse.emplace_back());
      }
    });
    if (accessor.components == 0) reject(place.key("type"), "missing");
    if (accessor.component_type == 0) reject(place.key("componentType"), "missing");
    if (accessor.count == 0) reject(place.key("count"), "missing or 0; wanted at least 1");
  });
}

void parse_images(Value value, const Place& at, Document& out) {
  each_element(value, at, [&](Value& element, const Place& place) {
    ImageRecord& image = out.images.emplace_back();
    each_field(element, place, [&](std::string_view key, Value& v, const Place& p) {
      if (key == "name") {
        image.name = get_string(v, p);
      } else if (key == "uri") {
        image.uri = get_string(v, p);
        image.has_uri = true;
      } else if (key == "mimeType") {
        image.mime_type = get_string(v, p);
      } else if (key == "bufferView") {
        image.view = get_index(v, p);
      }
    });
    if (image.has_uri == (image.view != kNone)) reject(place, "wanted one of uri and bufferView");
  });
}

void parse_samplers(Value value, const Place& at, Document& out) {
  const auto one_of = [](Value& v, const Place& p, std::initializer_list<int> allowed) {
    const auto given = static_cast<int>(get_count(v, p, 0x7FFFFFFF));
    std::string list;
    for (const int a : allowed) {
      if (given == a) return given;
      list += " " + std::to_string(a);
    }
    reject(p, std::to_string(given) + " is none of" + list);
  };
  each_element(value, at, [&](Value& element, const Place& place) {
    Sampler& sampler = out.samplers.emplace_back();
    each_field(element, place, [&](std::string_view key, Value& v, const Place& p) {
      if (key == "magFilter") {
        sampler.mag_filter = one_of(v, p, {9728, 9729});
      } else if (key == "minFilter") {
        sampler.min_filter = one_of(v, p, {9728, 9729, 9984, 9985, 9986, 9987});
      } else if (key == "wrapS") {
        sampler.wrap_s = one_of(v, p, {33071, 33648, 10497});
      } else if (key == "wrapT") {
        sampler.wrap_t = one_of(v, p, {33071, 33648, 10497});
      }
    });
  });
}

void parse_textures(Value value, const Place& at, Document& out) {
  each_element(value, at, [&](Value& element, const Place& place) {
    TextureRecord& texture = out.textures.emplace_back();
    each_field(element, place, [&](std::string_view key, Value& v, const Place& p) {
      if (key == "source") {
        texture.source = get_index(v, p);
      } else if (key == "sampler") {
        texture.sampler = get_index(v, p);
      } else if (key == "extensions") {
        each_field(v, p,
                   [&](std::string_view name, Value&, const Place& q) { ignore_extension(name, q, out); });
      }
    });
  });
}

namespace {

void parse_lens(Value value, const Place& at, bool orthographic, Camera& camera) {
  bool has_size = false;
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    const bool xmag = key == "xmag";
    if (key == "znear") {
      camera.znear_m = get_float(v, p);
    } else if (key == "zfar") {
      camera.zfar_m = get_float(v, p);
    } else if (key == "yfov" && !orthographic) {
      camera.yfov_rad = get_float(v, p);
      has_size = true;
    } else if (orthographic && (xmag || key == "ymag")) {
      (xmag ? camera.xmag_m : camera.ymag_m) = get_float(v, p);
      has_size = true;
    }
  });
  camera.orthographic = orthographic;
  if (!has_size) reject(at, orthographic ? "xmag and ymag are missing" : "yfov is missing");
  if (camera.zfar_m != 0 && !(camera.zfar_m > camera.znear_m))
    reject(at.key("zfar"), "must be greater than znear");
  if (orthographic) {
    if (!(camera.znear_m >= 0)) reject(at.key("znear"), "must not be negative");
    if (camera.xmag_m == 0 || camera.ymag_m == 0) reject(at, "xmag and ymag must not be 0");
    if (camera.zfar_m == 0) reject(at.key("zfar"), "missing or 0");
  } else {
    if (!(camera.znear_m > 0)) reject(at.key("znear"), "must be positive");
    constexpr float kPi = 3.14159265F;
    if (!(camera.yfov_rad > 0 && camera.yfov_rad < kPi))
      reject(at.key("yfov"), "must lie between 0 and pi radians");
  }
}

}  // namespace

void parse_cameras(Value value, const Place& at, Document& out) {
  each_element(value, at, [&](Value& element, const Place& place) {
    Camera& camera = out.cameras.emplace_back();
    bool has_lens = false;
    each_field(element, place, [&](std::string_view key, Value& v, const Place& p) {
      if (key == "name") {
        camera.name = get_string(v, p);
      } else if (key == "perspective" || key == "orthographic") {
        if (has_lens) reject(p, "a camera is either perspective or orthographic");
        has_lens = true;
        parse_lens(v, p, key == "orthographic", camera);
      }
    });
    if (!has_lens) reject(place, "neither perspective nor orthographic");
  });
}

namespace {

void parse_table(Value value, const Place& at, std::string_view encoding, NameList& names) {
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "bufferView") {
      names.view = get_index(v, p);
    } else if (key == "count") {
      names.count = get_count(v, p);
    } else if (key == "encoding" && get_string(v, p) != encoding) {
      reject(p, "wanted \"" + std::string(encoding) + "\"");
    }
  });
}

void parse_timeline(Value value, const Place& at, Document& out) {
  Timeline timeline;
  timeline.first = out.timeline_times_s.size();
  std::uint64_t values = 0;
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "times") {
      each_element(v, p, [&](Value& w, const Place& q) {
        const float time_s = get_float(w, q);
        const bool first = out.timeline_times_s.size() == timeline.first;
        if (first ? !(time_s >= 0.0F) : !(time_s > out.timeline_times_s.back()))
          reject(q, first ? "negative" : "times do not increase");
        out.timeline_times_s.push_back(time_s);
      });
    } else if (key == "shown" || key == "looks") {
      if (values != 0) reject(p, "a timeline has either \"shown\" or \"looks\"");
      timeline.is_looks = key == "looks";
      each_element(v, p, [&](Value& w, const Place& q) {
        out.timeline_values.push_back(
            static_cast<std::uint32_t>(get_count(w, q, timeline.is_looks ? kNone - 1 : 1)));
        ++values;
      });
    }
  });
  timeline.count = out.timeline_times_s.size() - timeline.first;
  if (timeline.count == 0 || values != timeline.count) {
    reject(at, std::to_string(timeline.count) + " times and " + std::to_string(values) +
                   " values; wanted as many of both, at least one");
  }
  out.timelines.push_back(timeline);
}

void parse_scene_extras(Value value, const Place& at, SceneExtras& extras, Document& out) {
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "names") {
      parse_table(v, p, "front-coded-utf8", extras.names);
    } else if (key == "ids") {
      parse_table(v, p, "delta-leb128", extras.ids);
    } else if (key == "merged") {
      each_field(v, p, [&](std::string_view inner, Value& w, const Place& q) {
        if (inner == "meshes") extras.merged_after = get_index(w, q);
      });
    } else if (key == "timelines") {
      extras.first_timeline = static_cast<std::uint32_t>(out.timelines.size());
      each_element(v, p, [&](Value& w, const Place& q) { parse_timeline(w, q, out); });
      extras.timeline_count = static_cast<std::uint32_t>(out.timelines.size()) - extras.first_timeline;
    }
  });
}

}  // namespace

void parse_scenes(Value value, const Place& at, Document& out) {
  each_element(value, at, [&](Value& element, const Place& place) {
    SceneRecord scene;
    SceneExtras extras;
    each_field(element, place, [&](std::string_view key, Value& v, const Place& p) {
      if (key == "nodes") {
        scene.first_root = static_cast<std::uint32_t>(out.scene_roots.size());
        each_element(v, p, [&](Value& w, const Place& q) { out.scene_roots.push_back(get_index(w, q)); });
        scene.root_count = static_cast<std::uint32_t>(out.scene_roots.size() - scene.first_root);
      } else if (key == "extensions") {
        each_field(v, p,
                   [&](std::string_view name, Value&, const Place& q) { ignore_extension(name, q, out); });
      } else if (key == "extras" && is_object(v)) {
        each_field(v, p, [&](std::string_view owner, Value& w, const Place& q) {
          if (owner == "scenegen" && is_object(w)) parse_scene_extras(w, q, extras, out);
        });
      }
    });
    out.scenes.push_back(scene);
    out.scene_extras.push_back(extras);
  });
}

}  // namespace scenegen::gltf::reading
