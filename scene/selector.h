// Which objects somebody means: by name, extras, material or subtree.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scene/gltf/read.h"
#include "scene/result.h"
#include "scene/scene.h"

namespace scenegen {

/// What a file says of objects beyond the scene: the nodes above them, their extras, their materials' names.
/// Built once from the source document; memory grows with the document only. Keeps a reference to the scene,
/// of whose objects and materials it knows those that read() gave.
class ObjectFacts {
 public:
  /// Errors (bad_input): JSON inside extras that read() had no reason to look at.
  [[nodiscard]] static Result<ObjectFacts> make(const Scene& scene, const gltf::SourceDocument& source);
  /// Sorts what there is to look up, so that thousands of selectors are quick. One or a few are without it.
  void index();
  /// The identifier (Selector::with_guid) of the object's node or of the nearest above that has one, or "".
  [[nodiscard]] std::string_view guid(ObjectId object) const;

  // To list what selectors can find.
  /// Objects depth first: those below one node follow each other.
  [[nodiscard]] std::vector<ObjectId> in_order() const;
  /// /nodes/i from the root down to the object's own, which instances share.
  [[nodiscard]] std::vector<std::uint32_t> path(ObjectId object) const;
  [[nodiscard]] std::string_view node_name(std::uint32_t node) const;  ///< "": it has none
  struct Extra {
    std::string key;  ///< as behind "extras."
    std::string_view value;
  };
  [[nodiscard]] std::vector<Extra> node_extras(std::uint32_t node) const;
  ~ObjectFacts();
  ObjectFacts(ObjectFacts&&) noexcept;
  ObjectFacts& operator=(ObjectFacts&&) noexcept;

 private:
  friend class Selector;
  struct State;
  explicit ObjectFacts(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// "name=Wall*"      glob over object names (* ? [abc]); a bare word without '=' is the same
/// "name~^Wall_\d+"  regular expression (RE2) over object names
/// "extras.guid=2O2Fr$" value of a member of the node's extras, or of the nearest node above that has it;
///                    "extras.ifc.guid" is a member of a member
/// "material=Brick*" glob over names of the materials of the object's mesh
/// "subtree=Storey*" objects at or below a node whose name matches the glob
/// Every value is a glob (scene/glob.h) behind '=' and a regular expression behind '~'.
class Selector {
 public:
  enum class Kind : std::uint8_t { name, extras, guid, material, subtree };
  /// Errors (usage, `where` empty): an unknown kind, a pattern that does not parse, above 4096 bytes.
  [[nodiscard]] static Result<Selector> parse(std::string_view text);
  /// The object of that name, whatever its characters.
  [[nodiscard]] static Selector with_name(std::string_view name);
  /// Objects whose nearest node with an identifier has this one; when there are none, those below a node that
  /// has it. An identifier is a member of extras named guid, GlobalId, ifcGuid or ifcGlobalId, in any case
  /// and with or without underscores, at any depth.
  [[nodiscard]] static Selector with_guid(std::string_view guid);
  /// extras.KEY and subtree with a value whose characters mean themselves.
  [[nodiscard]] static Selector with_extra(std::string_view key, std::string_view value);
  [[nodiscard]] static Selector with_subtree(std::string_view node_name);

  [[nodiscard]] Kind kind() const;
  /// Neither wildcards nor a regular expression.
  [[nodiscard]] bool is_literal() const;
  /// Ascending.
  [[nodiscard]] std::vector<ObjectId> select(const ObjectFacts& facts) const;
  ~Selector();
  Selector(Selector&&) noexcept;
  Selector& operator=(Selector&&) noexcept;

 private:
  struct State;
  explicit Selector(std::unique_ptr<State> state);
  [[nodiscard]] static Selector with_literal(Kind kind, std::string_view value);
  std::unique_ptr<State> state_;
};

}  // namespace scenegen
