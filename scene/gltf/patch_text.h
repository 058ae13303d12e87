// One pass over the JSON text of the document that is patched: where its parts begin and end, and the splices
// that the plan asks for. Private to scene/gltf.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/gltf/json.h"
#include "scene/gltf/patch_assets.h"
#include "scene/gltf/patch_buffers.h"
#include "scene/gltf/patch_plan.h"
#include "scene/gltf/patch_splice.h"

namespace scenegen::gltf::patching {

/// A channel of the file's first animation that ours repeats: `whole` with another number at `sampler`.
struct CarriedChannel {
  Span whole, sampler;
  std::uint32_t sampler_index = 0;  ///< in the file
  Span node;                        ///< empty: the node stays
  std::uint32_t node_index = 0;     ///< instead of it
};

struct Carried {
  std::vector<CarriedChannel> channels;
  std::vector<Span> samplers;  ///< all of the file's first animation
};

/// Texts of a node's skin and morph weights, for the nodes that take over its mesh.
struct MeshCompanions {
  std::uint32_t node = 0;
  Span skin, weights;
};

struct TextPatch {
  Splices splices;
  std::string animation_name = "timeline";
  Carried carried;
  std::vector<std::string> notes;
  std::vector<MeshCompanions> companions;  ///< by node
};

/// Text of a source document with a parser over it.
class SourceText {
 public:
  explicit SourceText(const std::string& json);
  [[nodiscard]] std::string_view text() const { return text_; }
  /// What the text says of nodes beyond reading::Document.
  [[nodiscard]] NodeUses survey(const reading::Document& document);

  using Value = reading::Value;
  using Place = reading::Place;

  /// The root, to be read again.
  [[nodiscard]] simdjson::ondemand::object root();
  [[nodiscard]] std::uint64_t begin_of(Value& value) const;
  /// Where the value that was read last ended: the end of the text before the token that comes next.
  std::uint64_t end_before_next();
  /// `end` without the white space before it.
  [[nodiscard]] std::uint64_t trimmed(std::uint64_t end) const;
  /// f(index, key, value, place)
  template <class F>
  ItemList members(Value value, const Place& at, const F& f);
  template <class F>
  ItemList elements(Value value, const Place& at, const F& f);
  /// The same without the list of a million elements: it has only the last one.
  template <class F>
  ItemList each(Value value, const Place& at, const F& f);

 private:
  void close(ItemList& list);

  std::string padded_;  ///< only when the source's text has no room behind it
  std::string_view text_;
  simdjson::ondemand::parser parser_;
  simdjson::ondemand::document document_;
};

template <class F>
ItemList SourceText::members(Value value, const Place& at, const F& f) {
  ItemList list;
  list.brackets.begin = begin_of(value);
  simdjson::ondemand::object object;
  if (const auto code = value.get_object().get(object); code != simdjson::SUCCESS)
    reading::reject_json(at, code, "an object");
  for (auto entry : object) {
    simdjson::ondemand::field field;
    if (const auto code = std::move(entry).get(field); code != simdjson::SUCCESS)
      reading::reject_json(at, code, "an object");
    const auto begin = static_cast<std::uint64_t>(field.key().raw() - text_.data()) - 1;
    std::string_view key;
    if (const auto code = field.unescaped_key().get(key); code != simdjson::SUCCESS)
      reading::reject_json(at, code, "a key");
    Value member = field.value();
    list.items.push_back({{begin, begin}, begin_of(member), false});
    f(list.items.size() - 1, key, member, at.key(key));
  }
  close(list);
  return list;
}

template <class F>
ItemList SourceText::elements(Value value, const Place& at, const F& f) {
  ItemList list;
  list.brackets.begin = begin_of(value);
  (void)reading::each_element(value, at, [&](Value& element, const Place& place) {
    const std::uint64_t begin = begin_of(element);
    list.items.push_back({{begin, begin}, begin, false});
    f(list.items.size() - 1, element, place);
  });
  close(list);
  return list;
}

template <class F>
ItemList SourceText::each(Value value, const Place& at, const F& f) {
  ItemList list;
  list.brackets.begin = begin_of(value);
  const std::uint64_t count = reading::each_element(value, at, f);
  list.brackets.end = end_before_next();
  const std::uint64_t end = trimmed(list.brackets.end - 1);
  if (count > 0) list.items.push_back({{end, end}, end, false});
  return list;
}

/// Notes where things are in an element of /materials or /meshes, if it is copied.
void locate_material(SourceText& text, reading::Value value, const reading::Place& at, AssetPatch& assets);
void locate_mesh(SourceText& text, reading::Value value, const reading::Place& at, AssetPatch& assets);

/// The splices of the plan. Fills in where the copied assets are.
[[nodiscard]] TextPatch make_splices(SourceText& text, const PatchInput& input, const NodePatch& nodes,
                                     const BufferPatch& buffers, AssetPatch& assets);

}  // namespace scenegen::gltf::patching
