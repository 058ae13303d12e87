#include "tests/support/gltf_file.h"

#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <glm/gtc/quaternion.hpp>
#include <iterator>
#include <stdexcept>

namespace scenegen::testing {

std::string file_bytes(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "scenegen_test_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp failed");
  folder_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::vector<std::string> TemporaryFolder::files() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

namespace {
void require(bool condition, const char* what) {
  if (!condition) throw std::runtime_error(what);
}

std::uint32_t u32_at(const std::string& bytes, std::size_t at) {
  require(at + 4 <= bytes.size(), "truncated");
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

template <class T>
double number_at(const std::string& bytes, std::size_t at) {
  require(at + sizeof(T) <= bytes.size(), "accessor leaves the buffer");
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return static_cast<double>(value);
}
}  // namespace

GltfFile GltfFile::from_glb(const std::string& bytes) {
  require(bytes.starts_with("glTF") && u32_at(bytes, 4) == 2, "not a .glb");
  require(u32_at(bytes, 8) == bytes.size() && bytes.size() % 4 == 0, "wrong length");
  const std::uint32_t json_length = u32_at(bytes, 12);
  require(json_length % 4 == 0 && bytes.substr(16, 4) == "JSON", "wrong JSON chunk");
  GltfFile file;
  file.json = nlohmann::json::parse(bytes.substr(20, json_length));
  const std::size_t next = 20 + std::size_t{json_length};
  if (next == bytes.size()) return file;
  require(u32_at(bytes, next) % 4 == 0 && bytes.substr(next + 4, 4) == std::string("BIN\0", 4),
          "wrong BIN chunk");
  file.binary = bytes.substr(next + 8);
  require(file.binary.size() == u32_at(bytes, next), "wrong BIN length");
  return file;
}

GltfFile GltfFile::from_gltf(const std::filesystem::path& path) {
  GltfFile file;
  file.json = nlohmann::json::parse(file_bytes(path));
  file.binary = file_bytes(std::filesystem::path(path).replace_extension(".bin"));
  return file;
}

std::vector<double> GltfFile::numbers(std::size_t index) const {
  const nlohmann::json& accessor = json.at("accessors").at(index);
  const nlohmann::json& view = json.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
  const std::string type = accessor.at("type");
  const std::size_t components = type == "SCALAR" ? 1 : static_cast<std::size_t>(type.back() - '0');
  const int component = accessor.at("componentType");
  const std::size_t size = component == 5121 ? 1 : component == 5123 ? 2 : 4;
  const std::size_t count = accessor.at("count");
  const std::size_t stride = view.value("byteStride", components * size);
  const std::size_t in_view = accessor.value("byteOffset", std::size_t{0});
  require(count > 0 &&
              in_view + (count - 1) * stride + components * size <= view.at("byteLength").get<std::size_t>(),
          "accessor leaves its view");
  const std::size_t start = view.value("byteOffset", std::size_t{0}) + in_view;
  require(start % size == 0, "accessor is not aligned");
  std::vector<double> out;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < components; ++c) {
      const std::size_t at = start + i * stride + c * size;
      out.push_back(component == 5121   ? number_at<std::uint8_t>(binary, at)
                    : component == 5123 ? number_at<std::uint16_t>(binary, at)
                    : component == 5125 ? number_at<std::uint32_t>(binary, at)
                                        : number_at<float>(binary, at));
    }
  }
  return out;
}

std::vector<int> GltfFile::parents() const {
  const nlohmann::json nodes = json.value("nodes", nlohmann::json::array());
  std::vector<int> parents(nodes.size(), -1);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const std::size_t child : nodes[i].value("children", std::vector<std::size_t>{})) {
      require(parents.at(child) == -1, "a node has two parents");
      parents[child] = static_cast<int>(i);
    }
  }
  return parents;
}

glm::dmat4 trs_matrix(const std::vector<double>& t, const std::vector<double>& r,
                      const std::vector<double>& s) {
  glm::dmat4 m = glm::mat4_cast(glm::dquat(r[3], r[0], r[1], r[2]));
  for (int c = 0; c < 3; ++c) m[c] *= s[static_cast<std::size_t>(c)];
  m[3] = glm::dvec4(t[0], t[1], t[2], 1.0);
  return m;
}

glm::dmat4 GltfFile::local_matrix(std::size_t index) const {
  const nlohmann::json& node = json.at("nodes").at(index);
  if (node.contains("matrix")) {
    glm::dmat4 m;
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node["matrix"].at(static_cast<std::size_t>(i));
    return m;
  }
  return trs_matrix(node.value("translation", std::vector<double>{0, 0, 0}),
                    node.value("rotation", std::vector<double>{0, 0, 0, 1}),
                    node.value("scale", std::vector<double>{1, 1, 1}));
}

}  // namespace scenegen::testing
