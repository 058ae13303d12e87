#include "tools/camera_paths.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <vector>

#include "render/scripted_path.h"
#include "tools/text.h"

namespace scenegen::tools {
namespace {

std::vector<std::string> names() {
  const auto all = render::scripted_path_names();
  return {all.begin(), all.end()};
}

bool built_in(const std::string& wanted) {
  const auto all = render::scripted_path_names();
  return std::find(all.begin(), all.end(), wanted) != all.end();
}

Result<std::string> read_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  // What looks like a word and is no file was meant as a name.
  if (!in && path.find_first_of("./\\") == std::string::npos)
    return fail(ErrorKind::usage, "--camera-path", unknown_word("camera path", path, names()));
  constexpr std::size_t kMost = std::size_t{64} << 20;
  std::string out;
  std::array<char, 65536> piece;
  while (in && out.size() <= kMost) {
    in.read(piece.data(), piece.size());
    out.append(piece.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (!in.eof() || out.size() > kMost)
    return fail(ErrorKind::io, path, "cannot be read (or is above 64 MiB)");
  return out;
}

Result<render::CameraPath> read_path(const std::string& file) {
  auto text = read_text(file);
  if (!text) return forward_error(text);
  return render::parse_camera_path(*text, file);
}

}  // namespace

std::string camera_path_range() {
  return "a file, or " + join(names(), ", ");
}

Result<void> check_camera_path(const std::string& wanted) {
  if (built_in(wanted)) return {};
  auto path = read_path(wanted);
  return path ? Result<void>() : forward_error(path);
}

Result<render::CameraPath> camera_path_of(const std::string& wanted, const Scene& scene) {
  if (!built_in(wanted)) return read_path(wanted);
  return *render::scripted_path(wanted, object_bounds(scene), static_cast<double>(scene.duration_s));
}

}  // namespace scenegen::tools
