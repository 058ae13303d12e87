// A glTF file as JSON and bytes, read with nothing of the program: for tests of what the writer wrote.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace scenegen::testing {

/// The bytes of a file; empty when there is none.
[[nodiscard]] std::string file_bytes(const std::filesystem::path& path);

/// A folder of its own under the system's temporary folder, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::vector<std::string> files() const;  ///< names, sorted

 private:
  std::filesystem::path folder_;
};

/// Throws std::runtime_error on anything that is not a well-formed container.
struct GltfFile {
  nlohmann::json json;
  std::string binary;

  [[nodiscard]] static GltfFile from_glb(const std::string& bytes);
  [[nodiscard]] static GltfFile from_gltf(const std::filesystem::path& path);

  /// All numbers of an accessor, element after element (any component type, no sparse ones).
  [[nodiscard]] std::vector<double> numbers(std::size_t accessor) const;
  /// Parent of every node, -1 for roots; throws when a node has two.
  [[nodiscard]] std::vector<int> parents() const;
  /// parent_from_node at rest.
  [[nodiscard]] glm::dmat4 local_matrix(std::size_t node) const;
};

[[nodiscard]] glm::dmat4 trs_matrix(const std::vector<double>& t, const std::vector<double>& r,
                                    const std::vector<double>& s);

}  // namespace scenegen::testing
