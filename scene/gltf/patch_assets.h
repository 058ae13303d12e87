// New meshes and materials of a patched document: copies of the file's with a few members changed, or plain
// ones. Private to scene/gltf.
#pragma once

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "scene/gltf/patch_plan.h"
#include "scene/gltf/patch_splice.h"

namespace scenegen::gltf::patching {

constexpr std::size_t kAbsent = static_cast<std::size_t>(-1);

struct NewMaterial {
  std::uint32_t copy_of = kNone;
  nlohmann::json tree;  ///< a plain one
};
struct NewMesh {
  static constexpr MaterialId kAsBefore{MaterialId::kNone - 1ULL};
  std::uint32_t copy_of = kNone;
  std::vector<MaterialId> materials;  ///< by primitive of the file's mesh
};

/// Where things are in the text of a material or mesh that is copied; filled by the pass over the text.
struct CopiedMaterial {
  std::uint32_t index = 0;
  ItemList list, pbr_list;
  std::size_t name = kAbsent, pbr = kAbsent, color = kAbsent;
};
struct CopiedMesh {
  struct Primitive {
    ItemList list;
    std::size_t material = kAbsent;
  };
  std::uint32_t index = 0;
  ItemList list;
  std::size_t name = kAbsent;
  std::vector<Primitive> primitives;
};

struct AssetPatch {
  std::vector<NewMaterial> materials;
  std::vector<NewMesh> meshes;
  std::set<std::string> extensions_used;
  std::vector<CopiedMaterial> copied_materials;  ///< by index
  std::vector<CopiedMesh> copied_meshes;         ///< by index
};

[[nodiscard]] AssetPatch plan_assets(const PatchInput& input);
/// The elements to add to /materials and /meshes, without brackets.
[[nodiscard]] std::string material_texts(const PatchInput& input, const AssetPatch& assets,
                                         std::string_view text);
[[nodiscard]] std::string mesh_texts(const PatchInput& input, const AssetPatch& assets,
                                     std::string_view text);

}  // namespace scenegen::gltf::patching
