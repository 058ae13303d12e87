#include <charconv>

#include "scene/gltf/parse.h"

namespace scenegen::gltf::reading {

namespace {

bool take(std::string_view& text, std::string_view head) {
  if (text.substr(0, head.size()) != head) return false;
  text.remove_prefix(head.size());
  return true;
}

/// "/nodes/17/weights" -> "/nodes/*/weights": what the ignored list counts by.
std::string pattern_of(std::string_view pointer) {
  std::string out;
  for (std::size_t i = 0; i < pointer.size(); ++i) {
    out += pointer[i];
    if (pointer[i] != '/') continue;
    std::size_t end = i + 1;
    while (end < pointer.size() && pointer[end] >= '0' && pointer[end] <= '9') ++end;
    if (end > i + 1 && (end == pointer.size() || pointer[end] == '/')) {
      out += '*';
      i = end - 1;
    }
  }
  return printable(out);
}

void parse_animation_pointer(Value value, const Place& at, Channel& channel, bool& has_pointer,
                             Document& out) {
  each_field(value, at, [&](std::string_view name, Value& v, const Place& p) {
    if (name != "KHR_animation_pointer") return ignore_extension(name, p, out);
    each_field(v, p, [&](std::string_view key, Value& w, const Place& q) {
      if (key != "pointer") return;
      has_pointer = true;
      const std::string_view pointer = get_string(w, q);
      const PointerTarget target = parse_pointer(pointer);
      channel.path = target.path;
      channel.target = target.index;
      if (target.path == Path::none)
        out.ignored.add(printable(pointer), "animation of " + pattern_of(pointer));
    });
  });
}

void parse_target(Value value, const Place& at, Channel& channel, Document& out) {
  std::string_view path;
  std::uint32_t node = kNone;
  Channel pointed;
  bool has_pointer = false;
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "path") {
      path = get_string(v, p);
    } else if (key == "node") {
      node = get_index(v, p);
    } else if (key == "extensions") {
      parse_animation_pointer(v, p, pointed, has_pointer, out);
    }
  });
  if (path == "pointer") {
    if (!has_pointer) {
      // gltf-transform 4.5 leaves such channels behind; viewers play what else is there.
      return out.ignored.add(at, "animation channels with path \"pointer\" and no pointer");
    }
    if (node != kNone) reject(at.key("node"), "must be absent when the path is \"pointer\"");
    channel.path = pointed.path;
    channel.target = pointed.target;
    return;
  }
  if (path == "translation") {
    channel.path = Path::translation;
  } else if (path == "rotation") {
    channel.path = Path::rotation;
  } else if (path == "scale") {
    channel.path = Path::scale;
  } else if (path == "weights") {
    out.ignored.add(at, "animation of morph weights");
  } else if (path.empty()) {
    reject(at.key("path"), "missing");
  } else {
    reject(at.key("path"), "'" + printable(path) + "' is none of translation rotation scale weights pointer");
  }
  channel.target = node;
  if (node == kNone && channel.path != Path::none) {
    out.ignored.add(at, "animation channels without a node");
    channel.path = Path::none;
  }
}

void parse_sampler(Value value, const Place& at, AnimationSampler& out) {
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "input") {
      out.input = get_index(v, p);
    } else if (key == "output") {
      out.output = get_index(v, p);
    } else if (key == "interpolation") {
      const std::string_view name = get_string(v, p);
      if (name == "STEP") {
        out.interpolation = Interpolation::step;
      } else if (name == "LINEAR") {
        out.interpolation = Interpolation::linear;
      } else if (name == "CUBICSPLINE") {
        out.interpolation = Interpolation::cubic_spline;
      } else {
        reject(p, "'" + printable(name) + "' is none of STEP LINEAR CUBICSPLINE");
      }
    }
  });
  if (out.input == kNone) reject(at.key("input"), "missing");
  if (out.output == kNone) reject(at.key("output"), "missing");
}

void parse_channel(Value value, const Place& at, Document& out) {
  Channel channel;
  bool has_target = false;
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "sampler") {
      channel.sampler = get_index(v, p);
    } else if (key == "target") {
      has_target = true;
      parse_target(v, p, channel, out);
    }
  });
  if (channel.sampler == kNone) reject(at.key("sampler"), "missing");
  if (!has_target) reject(at.key("target"), "missing");
  out.channels.push_back(channel);
}

void parse_animation(Value value, const Place& at, Document& out) {
  bool has_samplers = false;
  bool has_channels = false;
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    const bool samplers = key == "samplers";
    if (!samplers && key != "channels") return;
    if (samplers ? has_samplers : has_channels) reject(p, "given twice");
    (samplers ? has_samplers : has_channels) = true;
    if (samplers) {
      each_element(v, p, [&](Value& w, const Place& q) {
        parse_sampler(w, q, out.animation_samplers.emplace_back());
      });
    } else {
      each_element(v, p, [&](Value& w, const Place& q) { parse_channel(w, q, out); });
    }
  });
  if (!has_samplers) reject(at.key("samplers"), "missing");
  if (!has_channels) reject(at.key("channels"), "missing");
  out.animated = true;
}

}  // namespace

PointerTarget parse_pointer(std::string_view pointer) {
  const bool node = take(pointer, "/nodes/");
  if (!node && !take(pointer, "/materials/")) return {};
  std::uint32_t index = 0;
  const auto [end, code] = std::from_chars(pointer.data(), pointer.data() + pointer.size(), index);
  const auto digits = static_cast<std::size_t>(end - pointer.data());
  if (code != std::errc() || digits == 0 || (digits > 1 && pointer.front() == '0') || index == kNone)
    return {};
  pointer.remove_prefix(digits);
  Path path = Path::none;
  if (node) {
    if (pointer == "/extensions/KHR_node_visibility/visible") path = Path::visibility;
    if (pointer == "/translation") path = Path::translation;
    if (pointer == "/rotation") path = Path::rotation;
    if (pointer == "/scale") path = Path::scale;
  } else {
    if (pointer == "/pbrMetallicRoughness/baseColorFactor") path = Path::base_color;
    if (pointer == "/emissiveFactor") path = Path::emissive;
  }
  return {path, path == Path::none ? kNone : index};
}

void parse_animations(Value value, const Place& at, Document& out) {
  each_element(value, at, [&](Value& element, const Place& place) {
    if (place.index == 0) {
      parse_animation(element, place, out);
    } else {
      out.ignored.add(place, "animations behind the first");
    }
  });
}

}  // namespace scenegen::gltf::reading
