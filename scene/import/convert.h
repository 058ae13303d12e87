// What Assimp read -> a glTF document. Private to scene/import; runs in the child process.
#pragma once

#include <assimp/scene.h>

#include <glm/glm.hpp>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "scene/import/glb_builder.h"
#include "scene/import/import.h"

namespace scenegen::import {

/// Thrown for a model that cannot become a document; the one line that says why.
struct Refusal {
  std::string what;
};

/// Things of the model that the document does not hold, counted by kind in order of first occurrence.
class Notes {
 public:
  void add(const std::string& what, std::uint64_t count = 1);
  [[nodiscard]] const std::vector<gltf::Ignored>& list() const { return list_; }

 private:
  std::vector<gltf::Ignored> list_;
};

/// One conversion: what all its steps share.
struct Conversion {
  const aiScene& scene;
  std::string path;
  std::string folder;  ///< of the model: textures are looked for at and below it
  bool ifc = false;
  glm::mat4 metres_y_up{1.0F};  ///< on top of the model's root
  GlbBuilder document;
  Notes notes;
};

[[nodiscard]] nlohmann::json metadata_json(const aiMetadata* metadata, unsigned depth = 0);
/// UTF-8 whatever the file held (else it is taken for Latin-1); no control characters.
[[nodiscard]] std::string text(const aiString& string);

/// glTF primitive of each Assimp mesh; null where there is nothing to draw.
[[nodiscard]] std::vector<nlohmann::json> convert_meshes(Conversion& c);
/// Index of a glTF material that equals material `index` of the model.
[[nodiscard]] std::size_t convert_material(Conversion& c, unsigned index);
/// Nodes, cameras, lights, the scene.
void convert_nodes(Conversion& c, const std::vector<nlohmann::json>& primitives);

/// metres_y_up for what stands in the file `path` or is the custom of its format, unless `options` say other.
[[nodiscard]] glm::mat4 metres_y_up(const aiScene& scene, const std::string& path,
                                    const ImportOptions& options);

}  // namespace scenegen::import
