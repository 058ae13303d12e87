#include "tools/report/pictures.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <span>
#include <string_view>
#include <vector>

#include "render/image_decode.h"
#include "render/image_file.h"

namespace scenegen::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = std::size_t{64} << 20;
constexpr std::uint64_t kMostPixels = 64'000'000;  // 256 MB while it is made smaller
constexpr std::size_t kSmallBytes = 400'000;
constexpr std::uint32_t kMostSide = 1600;

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return i + k < bytes.size() ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i + k])) : 0U;
    };
    const std::uint32_t group = byte(0) << 16U | byte(1) << 8U | byte(2);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
  }
  return out;
}

/// "image/png", "image/jpeg" or "".
std::string_view type_of(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return "image/png";
  return bytes.starts_with("\xFF\xD8\xFF") ? "image/jpeg" : "";
}

bool lies_below(const fs::path& folder, const fs::path& file) {
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  const fs::path real = error ? fs::path() : fs::canonical(file, error);
  return !error && std::mismatch(root.begin(), root.end(), real.begin(), real.end()).first == root.end();
}

Result<std::string> read_picture(const std::string& folder, const std::string& file) {
  const fs::path path = fs::path(folder) / file;
  std::error_code error;
  if (!fs::exists(path, error)) return fail(ErrorKind::io, path.string(), "there is no such picture");
  if (!fs::is_regular_file(path, error)) return fail(ErrorKind::io, path.string(), "is no file");
  if (!lies_below(folder.empty() ? "." : folder, path))
    return fail(ErrorKind::bad_input, path.string(), "leads out of the folder of the results");
  if (fs::file_size(path, error) > kMostBytes || error)
    return fail(ErrorKind::bad_input, path.string(), "is larger than 64 MiB");
  std::ifstream in(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (in.bad() || !in.is_open()) return fail(ErrorKind::io, path.string(), "cannot be read");
  if (type_of(bytes).empty()) return fail(ErrorKind::bad_input, path.string(), "is neither PNG nor JPEG");
  return bytes;
}

}  // namespace

Result<EmbeddedPicture> embed_picture(const std::string& folder, const std::string& file) {
  Result<std::string> bytes = read_picture(folder, file);
  if (!bytes) return forward_error(bytes);
  const std::string where = (fs::path(folder) / file).string();
  // Decoded in any case: what is damaged is said now, not shown as a broken frame.
  Result<render::DecodedImage> image = render::decode_image(
      std::span(reinterpret_cast<const std::uint8_t*>(bytes->data()), bytes->size()), where, kMostPixels);
  if (!image) return forward_error(image);
  EmbeddedPicture out;
  std::string_view type = type_of(*bytes);
  if (bytes->size() > kSmallBytes || std::max(image->width, image->height) > kMostSide) {
    while (std::max(image->width, image->height) > kMostSide) image = render::halved(*image);
    *bytes = render::encode_picture(render::PictureFormat::jpg, {image->width, image->height}, image->rgba);
    type = "image/jpeg";
  }
  out.width = image->width;
  out.height = image->height;
  out.data_uri = "data:" + std::string(type) + ";base64," + base64(*bytes);
  return out;
}

}  // namespace scenegen::tools
