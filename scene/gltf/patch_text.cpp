#include "scene/gltf/patch_text.h"

#include <algorithm>
#include <new>

#include "scene/gltf/parse.h"
#include "scene/gltf/write_info.h"

namespace scenegen::gltf::patching {

using reading::Path;
using reading::Place;
using reading::reject;
using reading::Value;

SourceText::SourceText(const std::string& json) {
  if (json.capacity() >= json.size() + simdjson::SIMDJSON_PADDING) {
    text_ = json;
  } else {
    padded_.reserve(json.size() + simdjson::SIMDJSON_PADDING);
    padded_ = json;
    text_ = padded_;
  }
  const simdjson::padded_string_view padded(text_.data(), text_.size(),
                                            text_.size() + simdjson::SIMDJSON_PADDING);
  if (const auto code = parser_.iterate(padded).get(document_); code != simdjson::SUCCESS) {
    if (code == simdjson::MEMALLOC) throw std::bad_alloc();  // the document may be a good one
    reject(Place(), std::string("not a JSON document: ") + simdjson::error_message(code));
  }
}

simdjson::ondemand::object SourceText::root() {
  document_.rewind();
  simdjson::ondemand::object object;
  if (const auto code = document_.get_object().get(object); code != simdjson::SUCCESS)
    reading::reject_json(Place(), code, "an object");
  return object;
}

std::uint64_t SourceText::begin_of(Value& value) const {
  std::string_view token;
  token = value.raw_json_token();
  return static_cast<std::uint64_t>(token.data() - text_.data());
}

std::uint64_t SourceText::trimmed(std::uint64_t end) const {
  while (end > 0 && std::string_view(" \t\r\n").find(text_[end - 1]) != std::string_view::npos) --end;
  return end;
}

std::uint64_t SourceText::end_before_next() {
  const char* next = nullptr;
  if (document_.current_location().get(next) != simdjson::SUCCESS) return trimmed(text_.size());
  return trimmed(static_cast<std::uint64_t>(next - text_.data()));
}

void SourceText::close(ItemList& list) {
  list.brackets.end = end_before_next();
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const bool last = i + 1 == list.items.size();
    const std::uint64_t next = last ? list.brackets.end : trimmed(list.items[i + 1].whole.begin);
    list.items[i].whole.end = trimmed(next - 1);  // before the bracket or the comma
  }
}

// ---- What the reader does not keep
// -------------------------------------------------------------------------------

namespace {

void mark(NodeUses& uses, std::uint64_t node, std::uint8_t what) {
  if (node < uses.of_node.size()) uses.of_node[node] |= what;
}

void survey_target(Value target, const Place& at, bool first, NodeUses& uses) {
  std::uint64_t node = kNone;
  std::string path;
  std::string pointer;
  reading::each_field(target, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "node") {
      node = reading::get_count(v, p);
    } else if (key == "path") {
      path = reading::get_string(v, p);
    } else if (key == "extensions") {
      reading::each_field(v, p, [&](std::string_view name, Value& w, const Place& q) {
        if (name != "KHR_animation_pointer") return;
        reading::each_field(w, q, [&](std::string_view inner, Value& x, const Place& r) {
          if (inner == "pointer") pointer = reading::get_string(x, r);
        });
      });
    }
  });
  if (path == "weights") mark(uses, node, NodeUses::kWeights);
  if (path == "scale" && !first) mark(uses, node, NodeUses::kScaleElsewhere);
  if (path != "pointer") return;
  const reading::PointerTarget to = reading::parse_pointer(pointer);
  if (to.path == Path::scale && !first) mark(uses, to.index, NodeUses::kScaleElsewhere);
  constexpr std::string_view kNodes = "/nodes/";
  constexpr std::string_view kWeights = "/weights";
  if (pointer.size() > kNodes.size() + kWeights.size() && pointer.starts_with(kNodes) &&
      pointer.find(kWeights) != std::string::npos)
    mark(uses, std::strtoull(pointer.c_str() + kNodes.size(), nullptr, 10), NodeUses::kWeightsPointer);
}

void survey_animation(Value animation, const Place& at, bool first, NodeUses& uses) {
  reading::each_field(animation, at, [&](std::string_view key, Value& channels, const Place& p) {
    if (key != "channels") return;
    reading::each_element(channels, p, [&](Value& channel, const Place& q) {
      reading::each_field(channel, q, [&](std::string_view name, Value& target, const Place& r) {
        if (name == "target") survey_target(target, r, first, uses);
      });
    });
  });
}

void survey_skin(Value skin, const Place& at, NodeUses& uses) {
  reading::each_field(skin, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "skeleton") mark(uses, reading::get_count(v, p), NodeUses::kJoint);
    if (key != "joints") return;
    reading::each_element(
        v, p, [&](Value& w, const Place& q) { mark(uses, reading::get_count(w, q), NodeUses::kJoint); });
  });
}

}  // namespace

NodeUses SourceText::survey(const reading::Document& document) {
  NodeUses uses;
  uses.of_node.assign(document.nodes.size(), 0);
  const Place place;
  reading::each_field(root(), place, [&](std::string_view key, Value& v, const Place& at) {
    if (key == "skins") {
      reading::each_element(v, at, [&](Value& skin, const Place& p) { survey_skin(skin, p, uses); });
    } else if (key == "animations") {
      reading::each_element(v, at, [&](Value& animation, const Place& p) {
        survey_animation(animation, p, p.index == 0, uses);
      });
    }
  });
  return uses;
}

}  // namespace scenegen::gltf::patching
