#include "scene/import/texture_files.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <span>

#include "scene/limits.h"

#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 16384
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image.h>
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace scenegen::import {

namespace {

using Bytes = std::vector<std::uint8_t>;
namespace fs = std::filesystem;

constexpr std::uintmax_t kMostImageBytes = 1ULL << 30;

Bytes read_image_file(const fs::path& path) {
  std::error_code code;
  if (!fs::is_regular_file(path, code) || fs::file_size(path, code) > kMostImageBytes) return {};
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::string lower(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char ch) { return std::tolower(ch); });
  return s;
}

/// The file of that name in a folder, whatever the case of its letters (models come from Windows); the first
/// by name.
fs::path find_in(const fs::path& folder, const std::string& name) {
  std::error_code code;
  if (fs::is_regular_file(folder / name, code)) return folder / name;
  fs::path found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, code)) {
    if (lower(entry.path().filename().string()) != lower(name)) continue;
    if (found.empty() || entry.path() < found) found = entry.path();
  }
  return found;
}

/// As written below the model's folder; else its bare name there, or in a folder of textures.
fs::path find_file(const std::string& folder, std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  const fs::path given = fs::path(name).lexically_normal();
  const bool below = !given.empty() && given.is_relative() && *given.begin() != "..";
  if (below) {
    if (fs::path found = find_in(folder / given.parent_path(), given.filename().string()); !found.empty())
      return found;
  }
  const std::string bare = given.filename().string();
  for (const char* inner : {".", "textures", "Textures", "images", "maps"}) {
    if (fs::path found = find_in(fs::path(folder) / inner, bare); !bare.empty() && !found.empty())
      return found;
  }
  return {};
}

const char* mime_type(std::span<const std::uint8_t> bytes) {
  constexpr std::uint8_t kPng[] = {0x89, 'P', 'N', 'G'};
  constexpr std::uint8_t kJpeg[] = {0xFF, 0xD8, 0xFF};
  const auto begins = [&](std::span<const std::uint8_t> magic) {
    return bytes.size() > magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
  };
  return begins(kPng) ? "image/png" : begins(kJpeg) ? "image/jpeg" : nullptr;
}

Bytes png(const std::uint8_t* texels, int width, int height, int channels) {
  Bytes out;
  const auto append = [](void* to, void* data, int size) {
    const auto* const from = static_cast<const std::uint8_t*>(data);
    static_cast<Bytes*>(to)->insert(static_cast<Bytes*>(to)->end(), from, from + size);
  };
  if (stbi_write_png_to_func(append, &out, width, height, channels, texels, width * channels) == 0) return {};
  return out;
}

/// TGA, BMP, GIF, PSD … -> PNG; empty when it cannot be decoded.
Bytes as_png(std::span<const std::uint8_t> bytes) {
  if (bytes.empty() || bytes.size() > 0x7FFFFFFFU) return {};
  int width = 0;
  int height = 0;
  int channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> texels(
      stbi_load_from_memory(bytes.data(), static_cast<int>(bytes.size()), &width, &height, &channels, 0),
      stbi_image_free);
  if (!texels) return {};
  return png(texels.get(), width, height, channels);
}

Bytes embedded(const aiTexture& texture) {
  if (texture.pcData == nullptr) return {};
  if (texture.mHeight == 0) {  // a file in memory, mWidth bytes of it
    const auto* const from = reinterpret_cast<const std::uint8_t*>(texture.pcData);
    return {from, from + texture.mWidth};
  }
  if (texture.mWidth > limits::kMaxImageSide || texture.mHeight > limits::kMaxImageSide) return {};
  Bytes rgba;
  const std::size_t count = std::size_t{texture.mWidth} * texture.mHeight;
  rgba.reserve(count * 4);
  for (std::size_t i = 0; i < count; ++i) {
    const aiTexel& t = texture.pcData[i];
    rgba.insert(rgba.end(), {t.r, t.g, t.b, t.a});
  }
  return png(rgba.data(), static_cast<int>(texture.mWidth), static_cast<int>(texture.mHeight), 4);
}

}  // namespace

std::optional<std::size_t> add_image(Conversion& c, const aiString& path) {
  const std::string name = text(path);
  Bytes bytes;
  if (const aiTexture* const inside = c.scene.GetEmbeddedTexture(path.C_Str()); inside != nullptr) {
    bytes = embedded(*inside);
  } else if (const fs::path file = find_file(c.folder, name); !file.empty()) {
    bytes = read_image_file(file);
  } else {
    c.notes.add("textures that are not beside the model ('" + name + "')");
    return std::nullopt;
  }
  const char* type = mime_type(bytes);
  if (type == nullptr) {
    bytes = as_png(bytes);
    type = "image/png";
  }
  if (bytes.empty()) {
    c.notes.add("textures that cannot be decoded ('" + name + "')");
    return std::nullopt;
  }
  std::string shown = name;
  std::replace(shown.begin(), shown.end(), '\\', '/');
  return c.document.image(bytes, type, fs::path(shown).filename().string());
}

}  // namespace scenegen::import
