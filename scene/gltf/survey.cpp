#include "scene/gltf/survey.h"

#include <cassert>

#include "scene/gltf/document.h"
#include "scene/gltf/json.h"

namespace scenegen::gltf {

namespace {

using namespace reading;

class Surveyor {
 public:
  Survey run(const ReadResult& read) {
    for (const Ignored& entry : read.ignored) {
      if (!unseen(entry.what)) losses_.add(entry.where, thing(entry.what), entry.count);
    }
    const simdjson::padded_string text(read.source->json);
    simdjson::ondemand::parser parser;
    simdjson::ondemand::document document;
    simdjson::ondemand::object top;
    const Place root;
    if (const auto code = parser.iterate(text).get(document); code != simdjson::SUCCESS)
      reject_json(root, code, "an object");
    if (const auto code = document.get_object().get(top); code != simdjson::SUCCESS)
      reject_json(root, code, "an object");
    each_field(top, root, [&](std::string_view key, Value& v, const Place& p) { member(key, v, p); });
    for (const std::uint32_t mesh : mesh_of_node_) {
      if (mesh < primitives_.size()) out_.draws += primitives_[mesh];
    }
    out_.losses = losses_.take();
    return std::move(out_);
  }

 private:
  /// Pruning takes away what is not shown; that is no loss.
  static bool unseen(std::string_view what) { return what == "nodes outside the scene"; }

  /// "skins are drawn at rest" -> "skins"
  static std::string_view thing(std::string_view what) {
    constexpr std::string_view kAtRest = " are drawn at rest";
    if (what.ends_with(kAtRest)) what.remove_suffix(kAtRest.size());
    return what;
  }

  void member(std::string_view key, Value& value, const Place& at) {
    if (key == "nodes") {
      out_.nodes = each_element(value, at, [&](Value& v, const Place& p) { node(v, p); });
    } else if (key == "meshes") {
      out_.meshes = each_element(value, at, [&](Value& v, const Place& p) { mesh(v, p); });
    } else if (key == "animations") {
      each_element(value, at, [&](Value& v, const Place& p) { animation(v, p); });
    } else if (key == "extras") {
      extras(value, at, "the document");
    } else {
      const std::uint64_t count = walk(value, at, key);
      if (key == "accessors") out_.accessors = count;
      if (key == "materials") out_.materials = count;
      if (key == "textures") out_.textures = count;
      if (key == "images") out_.images = count;
    }
  }

  void node(Value& value, const Place& at) {
    each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
      if (key == "mesh") {
        mesh_of_node_.push_back(get_index(v, p));
      } else {
        inner(key, v, p, "nodes");
      }
    });
  }

  void mesh(Value& value, const Place& at) {
    std::uint64_t primitives = 0;
    each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
      if (key == "primitives") {
        primitives = walk(v, p, "meshes");
      } else {
        inner(key, v, p, "meshes");
      }
    });
    primitives_.push_back(primitives);
  }

  void animation(Value& value, const Place& at) {
    each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
      if (key == "channels") {
        out_.channels += walk(v, p, "animations");
      } else {
        inner(key, v, p, "animations");
      }
    });
  }

  void inner(std::string_view key, Value& value, const Place& at, std::string_view kind) {
    if (key == "extras") {
      extras(value, at, kind);
    } else {
      walk(value, at, kind);
    }
  }

  /// Looks for extras in whatever is below; the number of elements if it is an array.
  std::uint64_t walk(Value& value, const Place& at, std::string_view kind) {
    simdjson::ondemand::json_type type{};
    if (value.type().get(type) != simdjson::SUCCESS) return 0;
    if (type == simdjson::ondemand::json_type::object) {
      each_field(value, at, [&](std::string_view key, Value& v, const Place& p) { inner(key, v, p, kind); });
    } else if (type == simdjson::ondemand::json_type::array) {
      return each_element(value, at, [&](Value& v, const Place& p) { walk(v, p, kind); });
    }
    return 0;
  }

  /// Our own member of extras is part of the scene or made anew.
  void extras(Value& value, const Place& at, std::string_view kind) {
    bool foreign = !is_object(value);
    if (!foreign) {
      each_field(value, at,
                 [&](std::string_view key, Value&, const Place&) { foreign |= key != "scenegen"; });
    }
    if (foreign) losses_.add(at, "extras of " + printable(kind));
  }

  Survey out_;
  IgnoredList losses_;
  std::vector<std::uint32_t> mesh_of_node_;
  std::vector<std::uint64_t> primitives_;
};

}  // namespace

Result<Survey> survey(const ReadResult& read) {
  assert(read.source != nullptr);
  try {
    return Surveyor().run(read);
  } catch (Fault& fault) {
    Error& error = fault.error;
    error.where = read.source->path + (error.where.empty() ? "" : ": " + error.where);
    return tl::unexpected<Error>(std::move(error));
  }
}

}  // namespace scenegen::gltf
