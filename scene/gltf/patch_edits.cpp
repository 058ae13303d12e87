// The splices that a plan asks for.
#include <algorithm>
#include <iterator>

#include "scene/gltf/patch_text.h"
#include "scene/gltf/write_info.h"

namespace scenegen::gltf::patching {

using reading::Path;
using reading::Place;
using reading::Value;

namespace {

void add_item(std::string& to, std::string_view item) {
  if (!to.empty()) to += ',';
  to += item;
}

/// An object of the text with the one member in it that matters.
struct Inner {
  ItemList list;
  std::size_t item = kAbsent;
  bool is_object = false;
};

class TextPatcher {
 public:
  TextPatcher(SourceText& text, const PatchInput& in, const NodePatch& nodes, const BufferPatch& buffers,
              AssetPatch& assets)
      : text_(text), in_(in), nodes_(nodes), buffers_(buffers), assets_(assets) {}
  TextPatch run();

 private:
  /// Where the members of a node are.
  struct NodeText {
    ItemList list;
    std::size_t name = kAbsent, mesh = kAbsent, skin = kAbsent, weights = kAbsent, matrix = kAbsent,
                children = kAbsent, extras = kAbsent, extensions = kAbsent;
    ItemList kids;
    std::vector<std::uint32_t> kid_nodes;
    Inner outer, ours;  ///< extras, extras.scenegen
    std::size_t our_mesh = kAbsent, our_name = kAbsent;
    Inner extension, visibility;  ///< extensions, extensions.KHR_node_visibility
  };

  void patch_member(std::string_view key, Value& value, const Place& at);
  void patch_asset(Value value, const Place& at);
  void patch_nodes(Value value, const Place& at);
  void read_node(Value value, const Place& at, NodeText& node);
  void patch_node(const NodeEdit& edit, Value value, const Place& at);
  void drop_mesh(NodeText& node, std::uint32_t index);
  void patch_extras(const NodeEdit& edit, NodeText& node, std::string& added);
  void patch_visibility(const NodeEdit& edit, NodeText& node, std::string& added);
  void patch_children(std::uint32_t index, NodeText& node, std::string& added);
  void swap_children(ItemList& list, const std::vector<std::uint32_t>& nodes, std::string_view added);
  void patch_scenes(Value value, const Place& at);
  void patch_buffers(Value value, const Place& at);
  void patch_images(Value value, const Place& at);
  void patch_animations(Value value, const Place& at);
  void read_animation(Value value, const Place& at);
  void read_channel(bool is_first, Value value, const Place& at);
  void move_weights(const ItemList& channel, Span node, std::uint32_t from, const CarriedChannel* carried);
  void patch_extensions_used(Value value, const Place& at);
  void patch_materials(Value value, const Place& at);
  void patch_meshes(Value value, const Place& at);
  void append_to(Value value, const Place& at, std::string_view text, Part part);
  void add_missing();
  [[nodiscard]] std::vector<std::string> extensions() const;
  [[nodiscard]] std::string new_buffer() const;
  [[nodiscard]] bool animates() const { return !nodes_.channels.empty(); }
  [[nodiscard]] bool carries(const reading::Channel& channel) const;
  [[nodiscard]] bool seen(std::string_view member) const {
    return std::find(seen_.begin(), seen_.end(), member) != seen_.end();
  }

  SourceText& text_;
  const PatchInput& in_;
  const NodePatch& nodes_;
  const BufferPatch& buffers_;
  AssetPatch& assets_;
  TextPatch out_;
  std::vector<std::string> seen_;     ///< members of the root
  std::vector<std::string> names_;    ///< of the file's animations
  std::vector<std::uint8_t> driven_;  ///< by node of the file: 1 its scale, 2 its visibility, by our channels
};

void TextPatcher::patch_asset(Value value, const Place& at) {
  std::size_t generator = kAbsent;
  std::size_t extras = kAbsent;
  Inner inner;
  const ItemList list =
      text_.members(value, at, [&](std::size_t i, std::string_view key, Value& v, const Place& p) {
        if (key == "generator") generator = i;
        if (key != "extras") return;
        extras = i;
        inner.is_object = reading::is_object(v);
        if (!inner.is_object) return;
        inner.list = text_.members(v, p, [&](std::size_t k, std::string_view name, Value&, const Place&) {
          if (name == "scenegen") inner.item = k;
        });
      });
  const std::string name = json_string("scenegen " SCENEGEN_VERSION);
  FileInfo info{"patched", in_.options.visibility, {}};
  if (in_.document.foreign) {
    info.source_generator = in_.document.source_generator;
  } else if (!in_.document.ours) {
    info.source_generator = in_.document.info.generator;
  }
  const std::string ours = text_of([&](TextOut& out) { emit_scenegen(in_.scene, info, out); });
  std::string added;
  if (generator != kAbsent) {
    out_.splices.replace(list.items[generator].value_span(), name);
  } else {
    add_item(added, "\"generator\":" + name);
  }
  if (extras == kAbsent) {
    add_item(added, R"("extras":{"scenegen":)" + ours + "}");
  } else if (!inner.is_object) {  // whatever it is, it stays, one level down
    out_.splices.insert(list.items[extras].value, R"({"scenegen":)" + ours + R"(,"extras":)");
    out_.splices.insert(list.items[extras].whole.end, "}");
  } else if (inner.item != kAbsent) {
    out_.splices.replace(inner.list.items[inner.item].value_span(), ours);
  } else {
    inner.list.splice("\"scenegen\":" + ours, out_.splices);
  }
  list.splice(added, out_.splices);
}

// ---- Nodes

void TextPatcher::read_node(Value value, const Place& at, NodeText& node) {
  const auto read_object = [&](Value& v, const Place& p, Inner& inner, std::string_view wanted,
                               const auto& into) {
    inner.is_object = reading::is_object(v);
    if (!inner.is_object) return;
    inner.list = text_.members(v, p, [&](std::size_t i, std::string_view key, Value& w, const Place& q) {
      if (key != wanted) return;
      inner.item = i;
      into(w, q);
    });
  };
  node.list = text_.members(value, at, [&](std::size_t i, std::string_view key, Value& v, const Place& p) {
    if (key == "name") node.name = i;
    if (key == "mesh") node.mesh = i;
    if (key == "skin") node.skin = i;
    if (key == "weights") node.weights = i;
    if (key == "matrix") node.matrix = i;
    if (key == "children") {
      node.children = i;
      node.kids = text_.elements(v, p, [&](std::size_t, Value& w, const Place& q) {
        node.kid_nodes.push_back(reading::get_index(w, q));
      });
    } else if (key == "extras") {
      node.extras = i;
      read_object(v, p, node.outer, "scenegen", [&](Value& w, const Place& q) {
        node.ours.is_object = reading::is_object(w);
        if (!node.ours.is_object) return;
        node.ours.list = text_.members(w, q, [&](std::size_t k, std::string_view name, Value&, const Place&) {
          if (name == "mesh") node.our_mesh = k;
          if (name == "name") node.our_name = k;
        });
      });
    } else if (key == "extensions") {
      node.extensions = i;
      read_object(v, p, node.extension, "KHR_node_visibility", [&](Value& w, const Place& q) {
        read_object(w, q, node.visibility, "visible", [](Value&, const Place&) {});
      });
    }
  });
}

/// Takes the mesh and what belongs to it out of a node.
void TextPatcher::drop_mesh(NodeText& node, std::uint32_t index) {
  MeshCompanions companions{index, {}, {}};
  if (node.skin != kAbsent) companions.skin = node.list.items[node.skin].value_span();
  if (node.weights != kAbsent) companions.weights = node.list.items[node.weights].value_span();
  for (const std::size_t i : {node.mesh, node.skin, node.weights}) {
    if (i != kAbsent) node.list.items[i].removed = true;
  }
  if (!companions.skin.empty() || !companions.weights.empty()) out_.companions.push_back(companions);
}

void TextPatcher::patch_extras(const NodeEdit& edit, NodeText& node, std::string& added) {
  std::string ours;
  const auto member = [&](std::size_t have, std::string_view key, const std::string& value) {
    if (have != kAbsent) {
      out_.splices.replace(node.ours.list.items[have].value_span(), value);
    } else {
      add_item(ours, key);
      ours += value;
    }
  };
  if (edit.looks_mesh != kNone) {
    member(node.our_mesh, "\"mesh\":", std::to_string(edit.looks_mesh));
  } else if (edit.drop_mesh && node.our_mesh != kAbsent) {
    node.ours.list.items[node.our_mesh].removed = true;
  }
  if (edit.keep_name.valid())
    member(node.our_name, "\"name\":", json_string(in_.scene.objects.names[edit.keep_name.value]));
  if (node.ours.is_object) return node.ours.list.splice(ours, out_.splices);
  if (ours.empty()) return;
  ours = "{" + ours + "}";
  if (node.outer.item != kAbsent) {
    out_.splices.replace(node.outer.list.items[node.outer.item].value_span(), ours);
  } else if (node.outer.is_object) {
    node.outer.list.splice("\"scenegen\":" + ours, out_.splices);
  } else {
    add_item(added, R"("extras":{"scenegen":)" + ours + "}");
  }
}

void TextPatcher::patch_visibility(const NodeEdit& edit, NodeText& node, std::string& added) {
  if (edit.show && node.visibility.item != kAbsent)
    out_.splices.replace(node.visibility.list.items[node.visibility.item].value_span(), "true");
  if (!edit.add_visibility || node.extension.item != kAbsent) return;
  if (node.extension.is_object) {
    node.extension.list.splice(R"("KHR_node_visibility":{})", out_.splices);
  } else {
    add_item(added, R"("extensions":{"KHR_node_visibility":{}})");
  }
}

void TextPatcher::swap_children(ItemList& list, const std::vector<std::uint32_t>& nodes,
                                std::string_view added) {
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const auto swapped = nodes_.swapped.find(nodes[k]);
    if (swapped == nodes_.swapped.end()) continue;
    if (swapped->second == kNone) {
      list.items[k].removed = true;
    } else {
      out_.splices.replace(list.items[k].whole, std::to_string(swapped->second));
    }
  }
  list.splice(added, out_.splices);
}

void TextPatcher::patch_children(std::uint32_t index, NodeText& node, std::string& added) {
  std::string children;
  for (const auto& [parent, child] : nodes_.added_to(index)) add_item(children, std::to_string(child));
  if (node.children != kAbsent) return swap_children(node.kids, node.kid_nodes, children);
  if (!children.empty()) add_item(added, "\"children\":[" + children + "]");
}

void TextPatcher::patch_node(const NodeEdit& edit, Value value, const Place& at) {
  NodeText node;
  read_node(value, at, node);
  std::string added;
  const auto set = [&](std::size_t have, std::string_view key, const std::string& text) {
    if (have != kAbsent) return out_.splices.replace(node.list.items[have].value_span(), text);
    add_item(added, key);
    added += text;
  };
  if (edit.name != kNone) set(node.name, "\"name\":", json_string(nodes_.new_names[edit.name]));
  if (edit.mesh != kNone) set(node.mesh, "\"mesh\":", std::to_string(edit.mesh));
  if (edit.drop_mesh) drop_mesh(node, edit.node);
  if (edit.as_trs && node.matrix != kAbsent) {
    Transform transform;
    (void)decompose(in_.document.node_details[in_.document.nodes[edit.node].detail].matrix, transform);
    const std::string text = text_of([&](TextOut& out) { emit_transform(transform, out); });
    if (text.empty()) {
      node.list.items[node.matrix].removed = true;
    } else {
      out_.splices.replace(node.list.items[node.matrix].whole, std::string_view(text).substr(1));
    }
  }
  patch_children(edit.node, node, added);
  patch_extras(edit, node, added);
  patch_visibility(edit, node, added);
  node.list.splice(added, out_.splices);
}

void TextPatcher::patch_nodes(Value value, const Place& at) {
  auto edit = nodes_.edits.begin();
  const ItemList list = text_.each(value, at, [&](Value& element, const Place& p) {
    if (edit != nodes_.edits.end() && edit->node == p.index) patch_node(*edit++, element, p);
  });
  if (!nodes_.new_nodes.empty()) list.append({}, Part::new_nodes, out_.splices);
}

void TextPatcher::patch_scenes(Value value, const Place& at) {
  if (!nodes_.roots_swapped) return;
  reading::each_element(value, at, [&](Value& scene, const Place& p) {
    reading::each_field(scene, p, [&](std::string_view key, Value& v, const Place& q) {
      if (key != "nodes") return;
      std::vector<std::uint32_t> roots;
      ItemList list = text_.elements(
          v, q, [&](std::size_t, Value& w, const Place& r) { roots.push_back(reading::get_index(w, r)); });
      swap_children(list, roots, {});
    });
  });
}

// ---- Buffers and images

std::string TextPatcher::new_buffer() const {
  std::string text = "{\"byteLength\":" + std::to_string(buffers_.bytes);
  if (!buffers_.new_uri.empty()) text += ",\"uri\":" + json_string(buffers_.new_uri);
  return text + "}";
}

void TextPatcher::patch_buffers(Value value, const Place& at) {
  const ItemList list = text_.each(value, at, [&](Value& buffer, const Place& p) {
    const auto i = static_cast<std::size_t>(p.index);
    std::size_t uri = kAbsent;
    std::size_t length = kAbsent;
    ItemList members =
        text_.members(buffer, p, [&](std::size_t k, std::string_view key, Value&, const Place&) {
          if (key == "uri") uri = k;
          if (key == "byteLength") length = k;
        });
    std::string added;
    const std::string& new_uri = buffers_.uri_of_buffer[i];
    if (new_uri == "-") {
      if (uri != kAbsent) members.items[uri].removed = true;
    } else if (!new_uri.empty()) {
      if (uri != kAbsent) {
        out_.splices.replace(members.items[uri].value_span(), json_string(new_uri));
      } else {
        add_item(added, "\"uri\":" + json_string(new_uri));
      }
    }
    if (i == 0 && buffers_.keeps_first && buffers_.grows && length != kAbsent)
      out_.splices.replace(members.items[length].value_span(), std::to_string(buffers_.bytes));
    members.splice(added, out_.splices);
  });
  if (buffers_.new_buffer) list.append(new_buffer(), Part::none, out_.splices);
}

void TextPatcher::patch_images(Value value, const Place& at) {
  auto embedded = buffers_.images.begin();
  reading::each_element(value, at, [&](Value& image, const Place& p) {
    std::size_t uri = kAbsent;
    bool has_type = false;
    const ItemList members =
        text_.members(image, p, [&](std::size_t k, std::string_view key, Value&, const Place&) {
          if (key == "uri") uri = k;
          has_type = has_type || key == "mimeType";
        });
    if (uri == kAbsent) return;
    if (embedded != buffers_.images.end() && embedded->image == p.index) {
      std::string text = "\"bufferView\":" + std::to_string(embedded->view);
      if (!has_type) text += ",\"mimeType\":" + json_string(embedded->mime_type);
      out_.splices.replace(members.items[uri].whole, text);
      ++embedded;
    } else if (const std::string& moved = buffers_.uri_of_image[p.index]; !moved.empty()) {
      out_.splices.replace(members.items[uri].value_span(), json_string(moved));
    }
  });
}

// ---- Animations

/// Whether our animation repeats a channel of the file's first one, which viewers no longer play.
bool TextPatcher::carries(const reading::Channel& channel) const {
  if (channel.path == Path::none || channel.path == Path::base_color || channel.path == Path::emissive)
    return true;
  const std::uint32_t node = channel.target;
  const bool dropped = std::binary_search(nodes_.dropped.begin(), nodes_.dropped.end(), node);
  if (channel.path == Path::visibility) return !dropped && (driven_[node] & 2U) == 0;
  if (channel.path != Path::scale) return true;
  if ((driven_[node] & 1U) != 0) return false;
  const auto& visible = in_.source.scale_visibility;
  return !dropped ||
         std::none_of(visible.begin(), visible.end(), [&](const auto& v) { return v.node == node; });
}

/// Morph weights are of the node that has the mesh: the channel goes to where the mesh went, once for each
/// look.
void TextPatcher::move_weights(const ItemList& channel, Span node, std::uint32_t from,
                               const CarriedChannel* carried) {
  bool first = true;
  for (std::size_t i = 0; i < nodes_.new_nodes.size(); ++i) {
    const NewNode& made = nodes_.new_nodes[i];
    if (made.source != from || made.mesh == kNone) continue;
    const auto to = static_cast<std::uint32_t>(nodes_.first_new + i);
    if (first) {
      out_.splices.replace(node, std::to_string(to));
    } else {
      const std::string_view text = text_.text();
      out_.splices.insert(
          channel.brackets.end,
          "," + std::string(text.substr(channel.brackets.begin, node.begin - channel.brackets.begin)) +
              std::to_string(to) + std::string(text.substr(node.end, channel.brackets.end - node.end)));
    }
    first = false;
    if (carried == nullptr) continue;
    out_.carried.channels.push_back(*carried);
    out_.carried.channels.back().node = node;
    out_.carried.channels.back().node_index = to;
  }
}

void TextPatcher::read_channel(bool is_first, Value value, const Place& at) {
  std::size_t sampler = kAbsent;
  Inner target;
  std::uint32_t node = kNone;
  bool weights = false;
  const ItemList list =
      text_.members(value, at, [&](std::size_t k, std::string_view key, Value& v, const Place& p) {
        if (key == "sampler") sampler = k;
        if (key != "target" || !nodes_.moves_weights) return;
        target.list =
            text_.members(v, p, [&](std::size_t i, std::string_view name, Value& w, const Place& q) {
              if (name == "path") weights = reading::get_string(w, q) == "weights";
              if (name != "node") return;
              target.item = i;
              node = reading::get_index(w, q);
            });
      });
  CarriedChannel carried;
  bool carry = false;
  if (is_first && sampler != kAbsent && at.index < in_.document.channels.size()) {
    const reading::Channel& channel = in_.document.channels[at.index];
    carry = carries(channel);
    carried = {list.brackets, list.items[sampler].value_span(), channel.sampler, {}, 0};
  }
  const auto edited = std::lower_bound(nodes_.edits.begin(), nodes_.edits.end(), node,
                                       [](const NodeEdit& e, std::uint32_t n) { return e.node < n; });
  if (weights && edited != nodes_.edits.end() && edited->node == node && edited->drop_mesh)
    return move_weights(list, target.list.items[target.item].value_span(), node, carry ? &carried : nullptr);
  if (carry) out_.carried.channels.push_back(carried);
}

void TextPatcher::read_animation(Value value, const Place& at) {
  const bool is_first = at.index == 0;
  reading::each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "name") names_.emplace_back(reading::get_string(v, p));
    if (key == "samplers" && is_first) {
      const ItemList list = text_.elements(v, p, [](std::size_t, Value&, const Place&) {});
      for (const ItemList::Item& item : list.items) out_.carried.samplers.push_back(item.whole);
    } else if (key == "channels" && (is_first || nodes_.moves_weights)) {
      reading::each_element(v, p, [&](Value& w, const Place& q) { read_channel(is_first, w, q); });
    }
  });
}

void TextPatcher::patch_animations(Value value, const Place& at) {
  if (!animates()) return;
  const ItemList list =
      text_.each(value, at, [&](Value& animation, const Place& p) { read_animation(animation, p); });
  out_.splices.insert(list.brackets.begin + 1, {}, Part::animation);
  if (!list.items.empty()) out_.splices.insert(list.brackets.begin + 1, ",");
  for (int i = 2; std::find(names_.begin(), names_.end(), out_.animation_name) != names_.end(); ++i)
    out_.animation_name = "timeline~" + std::to_string(i);
}

// ---- The rest

std::vector<std::string> TextPatcher::extensions() const {
  std::vector<std::string> out(assets_.extensions_used.begin(), assets_.extensions_used.end());
  bool visibility = false;
  bool pointer = false;
  for (const PatchChannel& c : nodes_.channels) {
    visibility = visibility || c.path == Path::visibility;
    pointer = pointer || c.path == Path::visibility || c.path == Path::base_color;
  }
  if (visibility) out.emplace_back("KHR_node_visibility");
  if (pointer) out.emplace_back("KHR_animation_pointer");
  return out;
}

void TextPatcher::patch_extensions_used(Value value, const Place& at) {
  std::vector<std::string> wanted = extensions();
  const ItemList list = text_.each(value, at, [&](Value& v, const Place& p) {
    const std::string_view name = reading::get_string(v, p);
    std::erase(wanted, std::string(name));
    if (name == "KHR_interactivity" && animates() && in_.document.animated)
      out_.notes.emplace_back(
          "the file uses KHR_interactivity, which refers to animations by number: they have moved up by one");
  });
  std::string added;
  for (const std::string& name : wanted) add_item(added, json_string(name));
  if (!added.empty()) list.append(added, Part::none, out_.splices);
}

void TextPatcher::append_to(Value value, const Place& at, std::string_view text, Part part) {
  if (text.empty() && part == Part::none) return;
  text_.each(value, at, [](Value&, const Place&) {}).append(text, part, out_.splices);
}

void TextPatcher::patch_materials(Value value, const Place& at) {
  const ItemList list =
      text_.each(value, at, [&](Value& v, const Place& p) { locate_material(text_, v, p, assets_); });
  const std::string added = material_texts(in_, assets_, text_.text());
  if (!added.empty()) list.append(added, Part::none, out_.splices);
}

void TextPatcher::patch_meshes(Value value, const Place& at) {
  const ItemList list =
      text_.each(value, at, [&](Value& v, const Place& p) { locate_mesh(text_, v, p, assets_); });
  const std::string added = mesh_texts(in_, assets_, text_.text());
  if (!added.empty()) list.append(added, Part::none, out_.splices);
}

void TextPatcher::patch_member(std::string_view key, Value& value, const Place& at) {
  seen_.emplace_back(key);
  const bool views = buffers_.animation.view_count > 0 || !buffers_.images.empty();
  if (key == "asset") return patch_asset(value, at);
  if (key == "nodes") return patch_nodes(value, at);
  if (key == "scenes") return patch_scenes(value, at);
  if (key == "animations") return patch_animations(value, at);
  if (key == "buffers") return patch_buffers(value, at);
  if (key == "images") return patch_images(value, at);
  if (key == "materials") return patch_materials(value, at);
  if (key == "meshes") return patch_meshes(value, at);
  if (key == "extensionsUsed") return patch_extensions_used(value, at);
  if (key == "accessors" && animates()) return append_to(value, at, {}, Part::accessors);
  if (key == "bufferViews" && views) return append_to(value, at, {}, Part::views);
}

/// Members of the root that the file has not.
void TextPatcher::add_missing() {
  const std::uint64_t end = text_.trimmed(text_.trimmed(text_.text().size()) - 1);
  const auto add = [&](std::string_view member, std::string_view text, Part part) {
    if (seen(member) || (text.empty() && part == Part::none)) return;
    out_.splices.insert(end, ",\"" + std::string(member) + "\":[" + std::string(text), part);
    out_.splices.insert(end, "]");
  };
  std::string used;
  for (const std::string& name : extensions()) add_item(used, json_string(name));
  add("extensionsUsed", used, Part::none);
  add("materials", material_texts(in_, assets_, text_.text()), Part::none);
  if (animates()) add("accessors", {}, Part::accessors);
  if (buffers_.animation.view_count > 0 || !buffers_.images.empty()) add("bufferViews", {}, Part::views);
  if (buffers_.new_buffer) add("buffers", new_buffer(), Part::none);
  if (animates()) add("animations", {}, Part::animation);
}

TextPatch TextPatcher::run() {
  driven_.assign(in_.document.nodes.size(), 0);
  for (const PatchChannel& c : nodes_.channels) {
    if (c.path == Path::base_color || c.target >= driven_.size()) continue;
    driven_[c.target] = static_cast<std::uint8_t>(driven_[c.target] | (c.path == Path::scale ? 1U : 2U));
  }
  const Place place;
  reading::each_field(text_.root(), place,
                      [&](std::string_view key, Value& v, const Place& at) { patch_member(key, v, at); });
  add_missing();
  out_.splices.sort();
  return std::move(out_);
}

}  // namespace

TextPatch make_splices(SourceText& text, const PatchInput& input, const NodePatch& nodes,
                       const BufferPatch& buffers, AssetPatch& assets) {
  return TextPatcher(text, input, nodes, buffers, assets).run();
}

}  // namespace scenegen::gltf::patching
