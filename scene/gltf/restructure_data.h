// Vertices of parts: elements of accessors copied as they are, whatever their type. Private to scene/gltf.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scene/gltf/read.h"
#include "scene/scene.h"

namespace scenegen::gltf {

/// Thrown inside restructure(); `where` is a JSON pointer.
struct RestructureFault {
  std::string where, what;
};

/// Adds accessors to a document; their data go behind those of buffer 0.
class PartData {
 public:
  PartData(nlohmann::ordered_json& document, const SourceDocument& source)
      : document_(document), source_(source) {}

  /// A new accessor with the elements `vertices` of accessor `index`; min and max when it had them.
  [[nodiscard]] std::size_t gather(std::size_t index, const std::vector<std::uint32_t>& vertices);
  /// A new float accessor of vectors that the document does not have as such (Draco).
  [[nodiscard]] std::size_t gather_floats(const float* values, std::uint32_t components, bool bounds,
                                          const std::vector<std::uint32_t>& vertices);
  [[nodiscard]] std::size_t indices(const std::vector<std::uint32_t>& values, std::size_t vertex_count);

  /// Buffer 0 with what was added, when anything was; adds the views to the document. Once.
  [[nodiscard]] std::vector<std::uint8_t> finish();

 private:
  struct Elements {
    std::vector<std::uint8_t> bytes;  ///< tightly packed, sparse values in their places
    std::uint32_t size = 0;
    std::uint64_t count = 0;
  };
  struct NewView {
    std::size_t index = 0;
    std::uint32_t stride = 0, target = 0;
    std::vector<std::uint8_t> bytes;
  };
  [[nodiscard]] const Elements& elements(std::size_t index);
  [[nodiscard]] Elements load(std::size_t index) const;
  void apply_sparse(const nlohmann::ordered_json& sparse, const std::string& at, Elements& out) const;
  [[nodiscard]] std::pair<const std::uint8_t*, std::uint64_t> view(std::uint64_t index,
                                                                   const std::string& at) const;
  [[nodiscard]] std::uint32_t stride(std::uint64_t view) const;
  NewView& view_for(std::uint32_t element_stride, std::uint32_t target);
  std::size_t add(nlohmann::ordered_json accessor, NewView& view);

  nlohmann::ordered_json& document_;
  const SourceDocument& source_;
  std::map<std::size_t, Elements> cache_;
  std::vector<NewView> views_;
};

}  // namespace scenegen::gltf
