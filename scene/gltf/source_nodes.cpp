#include "scene/gltf/source_nodes.h"

#include <algorithm>
#include <map>
#include <utility>

#include "scene/gltf/json.h"

namespace scenegen::gltf {

namespace {

using namespace reading;

class NodeReader {
 public:
  explicit NodeReader(SourceNodes& out) : out_(out) {}

  void read(Value value, const Place& at) {
    each_element(value, at, [&](Value& element, const Place& place) { read_node(element, place); });
    for (const auto& [child, parent] : links_) {
      if (child < out_.parent.size()) out_.parent[child] = parent;
    }
  }

 private:
  void read_node(Value& value, const Place& at) {
    const auto node = static_cast<std::uint32_t>(out_.parent.size());
    const std::size_t first = out_.extras.size();
    out_.parent.push_back(SourceNodes::kNone);
    std::string_view name;
    each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
      if (key == "name") {
        name = get_string(v, p);
      } else if (key == "children") {
        each_element(v, p, [&](Value& w, const Place& q) { links_.emplace_back(get_index(w, q), node); });
      } else if (key == "extras" && is_object(v)) {
        read_extras(v, p, SourceNodes::kNone, node);
      }
    });
    out_.names.push_back(name);
    std::stable_sort(out_.extras.begin() + static_cast<std::ptrdiff_t>(first), out_.extras.end(),
                     [](const auto& a, const auto& b) { return a.path < b.path; });
  }

  void read_extras(Value& value, const Place& at, std::uint32_t outer, std::uint32_t node, int depth = 0) {
    constexpr int kMostDepth = 8;
    each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
      if (outer == SourceNodes::kNone && key == "scenegen") return;
      simdjson::ondemand::json_type type{};
      if (const auto code = v.type().get(type); code != simdjson::SUCCESS) reject_json(p, code, "a value");
      using Type = simdjson::ondemand::json_type;
      if (type == Type::object) {
        if (depth + 1 < kMostDepth) read_extras(v, p, path_of(outer, key), node, depth + 1);
        return;
      }
      if (type == Type::array || type == Type::null) return;
      const std::uint32_t path = path_of(outer, key);
      out_.extras.push_back({node, path, static_cast<std::uint32_t>(out_.extra_texts.size())});
      if (type == Type::string) {
        out_.extra_texts.push_back(get_string(v, p));
        return;
      }
      const std::string_view token = v.raw_json_token();
      const std::size_t end = token.find_last_not_of(" \t\r\n");
      out_.extra_texts.push_back(token.substr(0, end + 1));
    });
  }

  std::uint32_t path_of(std::uint32_t outer, std::string_view key) {
    const auto found = path_index_.find(std::pair(outer, key));
    if (found != path_index_.end()) return found->second;
    const auto id = static_cast<std::uint32_t>(out_.paths.size());
    out_.paths.push_back({outer, std::string(key)});
    path_index_.emplace(std::pair(outer, std::string(key)), id);
    return id;
  }

  struct Less {
    using is_transparent = void;
    template <class A, class B>
    bool operator()(const A& a, const B& b) const {
      if (a.first != b.first) return a.first < b.first;
      return std::string_view(a.second) < std::string_view(b.second);
    }
  };

  SourceNodes& out_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links_;  // child, parent
  std::map<std::pair<std::uint32_t, std::string>, std::uint32_t, Less> path_index_;
};

}  // namespace

Result<SourceNodes> read_source_nodes(const SourceDocument& source) {
  SourceNodes out;
  try {
    const simdjson::padded_string text(source.json);
    simdjson::ondemand::parser parser;
    simdjson::ondemand::document document;
    const Place root;
    if (const auto code = parser.iterate(text).get(document); code != simdjson::SUCCESS)
      reject_json(root, code, "a glTF document");
    simdjson::ondemand::object members;
    if (const auto code = document.get_object().get(members); code != simdjson::SUCCESS)
      reject_json(root, code, "an object");
    each_field(members, root, [&](std::string_view key, Value& member, const Place& at) {
      if (key == "nodes") NodeReader(out).read(member, at);
    });
  } catch (Fault& fault) {
    Error& error = fault.error;
    error.where = error.where.empty() ? source.path : source.path + ": " + error.where;
    return tl::unexpected<Error>(std::move(error));
  }
  return out;
}

}  // namespace scenegen::gltf
