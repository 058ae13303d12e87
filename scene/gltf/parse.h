// JSON text -> Document. Private to scene/gltf.
#pragma once

#include <span>

#include "scene/gltf/document.h"
#include "scene/gltf/json.h"

namespace scenegen::gltf::reading {

/// `text` has simdjson::SIMDJSON_PADDING readable bytes behind it and outlives `out`.
void parse_document(std::string_view text, Document& out);

// One function a member of the root, each given the member's value.
void parse_asset(Value value, const Place& at, Document& out);
void parse_buffers(Value value, const Place& at, Document& out);
void parse_buffer_views(Value value, const Place& at, Document& out);
void parse_accessors(Value value, const Place& at, Document& out);
void parse_images(Value value, const Place& at, Document& out);
void parse_samplers(Value value, const Place& at, Document& out);
void parse_textures(Value value, const Place& at, Document& out);
void parse_materials(Value value, const Place& at, Document& out);
void parse_meshes(Value value, const Place& at, Document& out);
void parse_cameras(Value value, const Place& at, Document& out);
void parse_nodes(Value value, const Place& at, Document& out);
void parse_scenes(Value value, const Place& at, Document& out);
void parse_animations(Value value, const Place& at, Document& out);

/// Extensions without a meaning for a Scene, at the object that holds them.
void ignore_extension(std::string_view name, const Place& at, Document& out);

/// Where "/nodes/17/extensions/KHR_node_visibility/visible" and the like lead.
struct PointerTarget {
  Path path = Path::none;
  std::uint32_t index = kNone;
};
[[nodiscard]] PointerTarget parse_pointer(std::string_view pointer);

}  // namespace scenegen::gltf::reading
