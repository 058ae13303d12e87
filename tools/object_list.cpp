#include "tools/object_list.h"

#include <algorithm>
#include <map>
#include <set>

#include "scene/selector.h"

namespace scenegen::tools {

namespace {

using nlohmann::ordered_json;
using Extras = std::vector<ObjectFacts::Extra>;

std::vector<std::string> materials_of(const Scene& scene, ObjectId object) {
  std::vector<std::string> out;
  for (const Primitive& primitive : scene.meshes[scene.objects.mesh[object.value].value].primitives) {
    if (!primitive.material.valid()) continue;
    const std::string& name = scene.materials[primitive.material.value].name;
    if (!name.empty() && std::find(out.begin(), out.end(), name) == out.end()) out.push_back(name);
  }
  return out;
}

/// Those that selectors find for an object: of the nearest node that has the member.
Extras extras_of(const ObjectFacts& facts, const std::vector<std::uint32_t>& path) {
  Extras out;
  std::set<std::string> known;
  for (auto node = path.rbegin(); node != path.rend(); ++node) {
    for (ObjectFacts::Extra& extra : facts.node_extras(*node)) {
      if (known.insert(extra.key).second) out.push_back(std::move(extra));
    }
  }
  return out;
}

std::string spelt(const Extras& extras, const char* separator) {
  std::string out;
  for (const ObjectFacts::Extra& extra : extras)
    out += (out.empty() ? "" : separator) + extra.key + "=" + std::string(extra.value);
  return out;
}

/// The tree of the nodes that have objects, depth first.
class Tree {
 public:
  Tree(const Scene& scene, const ObjectFacts& facts) : scene_(scene), facts_(facts) {
    for (const ObjectId object : facts.in_order()) {
      const std::vector<std::uint32_t> path = facts.path(object);
      for (const std::uint32_t node : path) ++below_[node];
      ++own_[path.back()];
    }
  }

  std::string str() {
    for (const ObjectId object : facts_.in_order()) {
      std::vector<std::uint32_t> path = facts_.path(object);
      const bool alone = own_[path.back()] == 1;  // else instances, of which the node is above
      const std::size_t above = alone ? path.size() - 1 : path.size();
      const auto common = std::mismatch(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(above),
                                        shown_.begin(), shown_.end());
      for (auto depth = static_cast<std::size_t>(common.first - path.begin()); depth < above; ++depth)
        group(depth, path[depth]);
      leaf(above, object, alone ? path.back() : kNone);
      shown_ = std::move(path);
    }
    return std::move(out_);
  }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  void line(std::size_t depth, std::string_view name, const std::string& what, const Extras& extras) {
    out_.append(2 * depth, ' ');
    out_ += name.empty() ? std::string("(no name)") : printable(std::string(name));
    for (const std::string& part : {what, printable(spelt(extras, "  "))}) {
      if (!part.empty()) out_ += "  " + part;
    }
    out_ += "\n";
  }
  void group(std::size_t depth, std::uint32_t node) {
    line(depth, facts_.node_name(node), "(" + counted(below_[node], "object") + ")",
         facts_.node_extras(node));
  }
  void leaf(std::size_t depth, ObjectId object, std::uint32_t node) {
    std::string what = printable(join(materials_of(scene_, object), "; "));
    if (!what.empty()) what = "[" + what + "]";
    if (node != kNone && below_[node] > 1)
      what += (what.empty() ? "(" : "  (") + counted(below_[node] - 1, "object") + " below)";
    line(depth, scene_.objects.names[object.value], what,
         node == kNone ? Extras() : facts_.node_extras(node));
  }

  const Scene& scene_;
  const ObjectFacts& facts_;
  std::map<std::uint32_t, std::uint64_t> below_, own_;  ///< by node: objects at or below it, objects of it
  std::vector<std::uint32_t> shown_;                    ///< path of the line before
  std::string out_;
};

ordered_json names_of(const ObjectFacts& facts, const std::vector<std::uint32_t>& path) {
  ordered_json out = ordered_json::array();
  for (const std::uint32_t node : path) {
    if (!facts.node_name(node).empty()) out.push_back(facts.node_name(node));
  }
  return out;
}

ordered_json json_row(const Scene& scene, const ObjectFacts& facts, ObjectId object) {
  const std::vector<std::uint32_t> path = facts.path(object);
  ordered_json extras = ordered_json::object();
  for (const ObjectFacts::Extra& extra : extras_of(facts, path)) extras[extra.key] = extra.value;
  return {{"object", scene.objects.names[object.value]},
          {"path", names_of(facts, path)},
          {"materials", materials_of(scene, object)},
          {"extras", std::move(extras)}};
}

std::vector<ordered_json> csv_row(const Scene& scene, const ObjectFacts& facts, ObjectId object) {
  const std::vector<std::uint32_t> path = facts.path(object);
  std::vector<std::string> names;
  for (const auto& name : names_of(facts, path)) names.push_back(name);
  return {scene.objects.names[object.value], join(names, " > "), join(materials_of(scene, object), ";"),
          spelt(extras_of(facts, path), ";")};
}

}  // namespace

Result<std::string> object_list(const std::string& file, const gltf::ReadResult& read, Format format) {
  const auto facts = ObjectFacts::make(read.scene, *read.source);
  if (!facts) return tl::unexpected<Error>(facts.error());
  if (format == Format::table) return Tree(read.scene, *facts).str();
  if (format == Format::csv) {
    Table table({{"object", ""}, {"path", ""}, {"materials", ""}, {"extras", ""}});
    for (const ObjectId object : facts->in_order()) table.row(csv_row(read.scene, *facts, object));
    return table.str(format);
  }
  Report out("scenegen/objects", 1);
  ordered_json list = ordered_json::array();
  for (const ObjectId object : facts->in_order()) list.push_back(json_row(read.scene, *facts, object));
  out.add({"file", "", file, ""});
  out.add({"objects", "", std::move(list), ""});
  return out.str(format);
}

}  // namespace scenegen::tools
