#include "scene/gltf/parse.h"

#include <algorithm>
#include <iterator>
#include <new>

#include "scene/limits.h"

namespace scenegen::gltf::reading {

void IgnoredList::add(std::string where, std::string_view what, std::uint64_t count) {
  const auto found = index_.find(what);
  if (found != index_.end()) {
    list_[found->second].count += count;
    return;
  }
  index_.emplace(std::string(what), list_.size());
  list_.push_back({std::move(where), std::string(what), count});
}

void IgnoredList::add(const Place& at, std::string_view what, std::uint64_t count) {
  const auto found = index_.find(what);
  if (found != index_.end()) {
    list_[found->second].count += count;
  } else {
    add(at.str(), what, count);
  }
}

namespace {

constexpr std::string_view kSupported[] = {"EXT_mesh_gpu_instancing",    "KHR_animation_pointer",
                                           "KHR_draco_mesh_compression", "KHR_materials_emissive_strength",
                                           "KHR_materials_unlit",        "KHR_mesh_quantization",
                                           "KHR_node_visibility",        "KHR_texture_transform"};

bool supported(std::string_view extension) {
  return std::find(std::begin(kSupported), std::end(kSupported), extension) != std::end(kSupported);
}

void parse_strings(Value value, const Place& at, std::vector<std::string_view>& out) {
  each_element(value, at,
               [&](Value& element, const Place& place) { out.push_back(get_string(element, place)); });
}

struct Member {
  std::string_view name;
  void (*parse)(Value, const Place&, Document&);
};
constexpr Member kMembers[] = {
    {"nodes", parse_nodes},
    {"animations", parse_animations},
    {"accessors", parse_accessors},
    {"bufferViews", parse_buffer_views},
    {"buffers", parse_buffers},
    {"meshes", parse_meshes},
    {"materials", parse_materials},
    {"images", parse_images},
    {"samplers", parse_samplers},
    {"textures", parse_textures},
    {"cameras", parse_cameras},
    {"scenes", parse_scenes},
    {"asset", parse_asset},
    {"scene", [](Value value, const Place& at, Document& out) { out.scene = get_index(value, at); }},
    {"extensionsUsed",
     [](Value value, const Place& at, Document& out) { parse_strings(value, at, out.extensions_used); }},
    {"extensionsRequired",
     [](Value value, const Place& at, Document& out) { parse_strings(value, at, out.extensions_required); }},
};

void check_extensions(const Place& root, Document& out) {
  const Place required = root.key("extensionsRequired");
  for (std::size_t i = 0; i < out.extensions_required.size(); ++i) {
    if (supported(out.extensions_required[i])) continue;
    reject(required.at(i), "the file requires the extension " + printable(out.extensions_required[i]) +
                               ", which scenegen does not read");
  }
  const Place used = root.key("extensionsUsed");
  for (std::size_t i = 0; i < out.extensions_used.size(); ++i) {
    const std::string name = printable(out.extensions_used[i]);
    if (!supported(name) && !out.ignored.has(name)) out.ignored.add(used.at(i), name);
  }
}

/// Strings with escapes lie in the parser's buffer: moves them to the document.
void keep_unescaped(std::string_view text, Document& out) {
  const auto keep = [&](std::string_view& view) {
    const bool inside = view.data() >= text.data() && view.data() <= text.data() + text.size();
    if (!inside && !view.empty()) view = out.unescaped.emplace_back(view);
  };
  for (Node& node : out.nodes) keep(node.name);
  for (MeshRecord& mesh : out.meshes) keep(mesh.name);
  for (Buffer& buffer : out.buffers) keep(buffer.uri);
  for (ImageRecord& image : out.images) {
    keep(image.name);
    keep(image.uri);
    keep(image.mime_type);
  }
  out.extensions_used.clear();  // done with
  out.extensions_required.clear();
}

}  // namespace

void ignore_extension(std::string_view name, const Place& at, Document& out) {
  out.ignored.add(at, printable(name));
}

void parse_document(std::string_view text, Document& out) {
  const Place root;
  if (text.size() > limits::kMaxJsonBytes - simdjson::SIMDJSON_PADDING) {
    reject(root, "JSON of " + std::to_string(text.size()) + " bytes is more than 4 GiB");
  }
  simdjson::ondemand::parser parser;  // dies here: for 330 MB of nodes its index has 250 MB
  simdjson::ondemand::document document;
  const simdjson::padded_string_view padded(text.data(), text.size(),
                                            text.size() + simdjson::SIMDJSON_PADDING);
  if (const auto code = parser.iterate(padded).get(document); code != simdjson::SUCCESS) {
    if (code == simdjson::MEMALLOC) throw std::bad_alloc();  // the document may be a good one
    reject(root, std::string("not a JSON document: ") + simdjson::error_message(code));
  }
  simdjson::ondemand::object members;
  if (const auto code = document.get_object().get(members); code != simdjson::SUCCESS)
    reject_json(root, code, "an object");
  std::uint64_t seen = 0;
  bool has_asset = false;
  each_field(members, root, [&](std::string_view key, Value& member, const Place& at) {
    const auto* const found = std::find_if(std::begin(kMembers), std::end(kMembers),
                                           [&](const Member& m) { return m.name == key; });
    if (found == std::end(kMembers)) return;
    const std::uint64_t bit = 1ULL << (found - std::begin(kMembers));
    if ((seen & bit) != 0) reject(at, "given twice");
    seen |= bit;
    has_asset |= key == "asset";
    found->parse(member, at, out);
  });
  const char* rest = nullptr;
  if (document.current_location().get(rest) != simdjson::OUT_OF_BOUNDS)
    reject(root, "text behind the end of the JSON document");
  if (!has_asset)
    reject(root.key("asset"), "missing; a glTF 2.0 file says \"asset\": {\"version\": \"2.0\"}");
  check_extensions(root, out);
  keep_unescaped(text, out);
}

}  // namespace scenegen::gltf::reading
