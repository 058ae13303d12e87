// Units and axes: what a file says, what its format means, what Assimp 5.2 has done about it already.
#include <minizip/unzip.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>

#include "scene/import/convert.h"

namespace scenegen::import {

namespace {

/// Rows are the Y-up axes in terms of the file's.
const glm::mat4 kFromZUp(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1);  // (x, z, -y)
const glm::mat4 kFromXUp(0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);  // (-y, x, z)

glm::mat4 from_up(UpAxis up) {
  return up == UpAxis::z ? kFromZUp : up == UpAxis::x ? kFromXUp : glm::mat4(1.0F);
}

constexpr std::size_t kHead = 1 << 16;  // units stand at the beginning

std::string head_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string out(kHead, '\0');
  file.read(out.data(), static_cast<std::streamsize>(out.size()));
  out.resize(static_cast<std::size_t>(file.gcount()));
  return out;
}

std::string head_of_zipped(const std::string& path, const char* inner) {
  const std::unique_ptr<void, int (*)(void*)> archive(::unzOpen64(path.c_str()), ::unzClose);
  constexpr int kIgnoreCase = 2;
  if (!archive || ::unzLocateFile(archive.get(), inner, kIgnoreCase) != UNZ_OK ||
      ::unzOpenCurrentFile(archive.get()) != UNZ_OK) {
    return {};
  }
  std::string out(kHead, '\0');
  const int read = ::unzReadCurrentFile(archive.get(), out.data(), static_cast<unsigned>(out.size()));
  out.resize(static_cast<std::size_t>(std::max(read, 0)));
  (void)::unzCloseCurrentFile(archive.get());
  return out;
}

/// Value of the attribute in the first tag of that name; empty when there is none.
std::string attribute(const std::string& xml, const std::string& tag, const std::string& name) {
  for (std::size_t at = xml.find('<' + tag); at != std::string::npos; at = xml.find('<' + tag, at + 1)) {
    const std::size_t end = xml.find('>', at);
    if (xml.find_first_of(" \t\r\n>/", at + tag.size() + 1) != at + tag.size() + 1) continue;
    const std::string inside = xml.substr(at, end == std::string::npos ? end : end - at);
    for (std::size_t k = inside.find(name); k != std::string::npos; k = inside.find(name, k + 1)) {
      std::size_t to = inside.find_first_not_of(" \t\r\n", k + name.size());
      if (to == std::string::npos || inside[to] != '=' ||
          std::isspace(static_cast<unsigned char>(inside[k - 1])) == 0)
        continue;
      to = inside.find_first_of("\"'", to);
      if (to == std::string::npos) return {};
      return inside.substr(to + 1, inside.find(inside[to], to + 1) - to - 1);
    }
    return {};
  }
  return {};
}

/// Of 3MF (core specification 3.4) and AMF (ISO/ASTM 52915): both mean millimetres when they say nothing.
double printing_unit_m(const std::string& word) {
  constexpr std::pair<const char*, double> kUnits[] = {
      {"micron", 1e-6}, {"micrometer", 1e-6}, {"millimeter", 1e-3}, {"centimeter", 1e-2},
      {"inch", 0.0254}, {"foot", 0.3048},     {"feet", 0.3048},     {"meter", 1}};
  for (const auto& [name, metres] : kUnits) {
    if (word == name) return metres;
  }
  return 1e-3;
}

double positive(const std::string& word, double otherwise) {
  double value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  return code == std::errc() && value > 0 && std::isfinite(value) ? value : otherwise;
}

/// What stands behind `(key = "distance")` up to the closing braces.
std::string open_gex_metric(const std::string& file, const std::string& key) {
  for (std::size_t at = file.find("Metric"); at != std::string::npos; at = file.find("Metric", at + 1)) {
    const std::size_t open = file.find('{', at);
    const std::size_t named = file.find('"' + key + '"', at);
    if (open == std::string::npos || named == std::string::npos || named > open) continue;
    const std::size_t inner = file.find('{', open + 1);
    if (inner == std::string::npos) return {};
    const std::size_t from = file.find_first_not_of(" \t\r\n\"", inner + 1);
    const std::size_t to = from == std::string::npos ? from : file.find_first_of(" \t\r\n\"}", from);
    return to == std::string::npos ? std::string() : file.substr(from, to - from);
  }
  return {};
}

struct Convention {
  glm::mat4 y_up_from_file{1.0F};
  glm::mat4 file_from_read{1.0F};  ///< undoes what Assimp did about the axes
  double metres = 1;               ///< per unit of the file
  double applied_metres = 1;       ///< what Assimp has multiplied with already
};

int integer(const aiScene& scene, const char* key, int otherwise) {
  std::int32_t out = otherwise;
  return scene.mMetaData != nullptr && scene.mMetaData->Get(key, out) ? out : otherwise;
}

/// FBX names the file axis that is up, front and right, each with a sign; Assimp only reports them.
Convention fbx(const aiScene& scene) {
  Convention out;
  const int axis[3] = {integer(scene, "CoordAxis", 0), integer(scene, "UpAxis", 1),
                       integer(scene, "FrontAxis", 2)};
  const int sign[3] = {integer(scene, "CoordAxisSign", 1), integer(scene, "UpAxisSign", 1),
                       integer(scene, "FrontAxisSign", 1)};
  glm::mat4 m(0.0F);
  m[3][3] = 1;
  bool seen[3] = {};
  bool proper = true;
  for (int row = 0; row < 3; ++row) {
    proper = proper && axis[row] >= 0 && axis[row] < 3 && !seen[axis[row]];
    if (!proper) break;
    seen[axis[row]] = true;
    m[axis[row]][row] = sign[row] < 0 ? -1.0F : 1.0F;
  }
  if (proper) out.y_up_from_file = m;
  float centimetres = 1;
  if (scene.mMetaData != nullptr) {
    double wide = 1;
    if (!scene.mMetaData->Get("UnitScaleFactor", centimetres) &&
        scene.mMetaData->Get("UnitScaleFactor", wide))
      centimetres = static_cast<float>(wide);
  }
  out.metres = centimetres > 0 && std::isfinite(centimetres) ? double{centimetres} / 100 : 0.01;
  return out;
}

Convention z_up_applied() {
  Convention out;
  out.y_up_from_file = kFromZUp;
  out.file_from_read = glm::transpose(kFromZUp);
  return out;
}

Convention convention(const aiScene& scene, const std::string& path, const std::string& extension) {
  Convention out;
  if (extension == "fbx") return fbx(scene);
  if (extension == "3ds" || extension == "ase" || extension == "ask" || extension == "dxf" ||
      extension == "prj")
    return z_up_applied();
  if (extension == "ifc" || extension == "ifczip") {
    out = z_up_applied();
    const aiMatrix4x4& root = scene.mRootNode->mTransformation;
    const double scale =
        std::sqrt(double{root.a1} * root.a1 + double{root.b1} * root.b1 + double{root.c1} * root.c1);
    if (scale > 0 && std::isfinite(scale)) out.metres = out.applied_metres = scale;
  } else if (extension == "dae") {
    out.metres = out.applied_metres = positive(attribute(head_of_file(path), "unit", "meter"), 1);
  } else if (extension == "3mf") {
    out.y_up_from_file = kFromZUp;
    out.metres = printing_unit_m(attribute(head_of_zipped(path, "3D/3dmodel.model"), "model", "unit"));
  } else if (extension == "amf") {
    out.y_up_from_file = kFromZUp;
    out.metres = printing_unit_m(attribute(head_of_file(path), "amf", "unit"));
  } else if (extension == "ogex") {
    const std::string head = head_of_file(path);
    out.metres = positive(open_gex_metric(head, "distance"), 1);
    out.y_up_from_file = open_gex_metric(head, "up") == "y" ? glm::mat4(1.0F) : kFromZUp;  // z when unsaid
  } else if (extension == "stl" || extension == "blend") {
    out.y_up_from_file = kFromZUp;
  }
  return out;
}

}  // namespace

glm::mat4 metres_y_up(const aiScene& scene, const std::string& path, const ImportOptions& options) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  Convention c = convention(scene, path, extension.empty() ? extension : extension.substr(1));
  if (options.up != UpAxis::automatic) c.y_up_from_file = from_up(options.up);
  if (options.metres_per_unit > 0) c.metres = options.metres_per_unit;
  const auto scale = static_cast<float>(c.metres / c.applied_metres);
  glm::mat4 out = c.y_up_from_file * c.file_from_read;
  for (int column = 0; column < 3; ++column) out[column] *= scale;
  return out;
}

}  // namespace scenegen::import
