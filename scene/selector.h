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
/// Built once from the source document; memory grows with the document only.
class ObjectFacts {
 public:
  ObjectFacts(const Scene& scene, const gltf::SourceDocument& source);
  ~ObjectFacts();
  ObjectFacts(ObjectFacts&&) noexcept;
  ObjectFacts& operator=(ObjectFacts&&) noexcept;

 private:
  friend class Selector;
  struct State;
  std::unique_ptr<State> state_;
};

/// "name=Wall*"      glob over object names (* ? [abc]); a bare word without '=' is the same
/// "name~^Wall_\d+"  regular expression (RE2) over object names
/// "extras.guid=2O2Fr$" value of a member of the node's extras, or of the nearest node above that has it
/// "material=Brick*" glob over names of the materials of the object's mesh
/// "subtree=Storey*" objects at or below a node whose name matches the glob
class Selector {
 public:
  [[nodiscard]] static Result<Selector> parse(std::string_view text);
  /// Ascending.
  [[nodiscard]] std::vector<ObjectId> select(const ObjectFacts& facts) const;
  ~Selector();
  Selector(Selector&&) noexcept;
  Selector& operator=(Selector&&) noexcept;

 private:
  struct State;
  explicit Selector(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace scenegen
