#include "scene/gltf/patch_buffers.h"

#include <algorithm>
#include <filesystem>

#include "scene/gltf/container.h"
#include "scene/gltf/write_check.h"

namespace scenegen::gltf::patching {

using reading::Place;
using reading::reject;

namespace {

namespace fs = std::filesystem;

const DracoStreams kNoStreams;  // the plan refers to it
const MergePlan kNoMerge;

constexpr std::uint64_t align4(std::uint64_t n) {
  return (n + 3) & ~std::uint64_t{3};
}

bool is_data_uri(std::string_view uri) {
  return uri.substr(0, 5) == "data:";
}

fs::path folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

fs::path real_path(const fs::path& path) {
  std::error_code ignored;
  fs::path out = fs::weakly_canonical(fs::absolute(path, ignored), ignored);
  return out.empty() ? path : out;
}

/// The URI by which `to_folder` reaches what `uri` is in `from_folder`; empty: the same one.
std::string moved_uri(std::string_view uri, const fs::path& from_folder, const fs::path& to_folder,
                      const Place& at) {
  const fs::path from = real_path(from_folder);
  const fs::path to = real_path(to_folder);
  if (from == to) return {};
  const fs::path file = real_path(reading::resolve_uri(uri, from.string(), at));
  const fs::path relative = file.lexically_relative(to);
  if (relative.empty()) reject(at, "cannot be reached from the folder of the result");
  return percent_encoded(relative.generic_string());
}

std::string data_uri(const std::vector<std::uint8_t>& bytes) {
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out = "data:application/octet-stream;base64,";
  out.reserve(out.size() + (bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = (word << 8) | (i + k < bytes.size() ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k > bytes.size() ? '=' : kAlphabet[(word >> (18 - 6 * k)) & 63U];
  }
  return out;
}

class BufferPlanner {
 public:
  BufferPlanner(const PatchInput& in, FileForm form, const std::string& path, const std::string& binary)
      : in_(in),
        document_(in.document),
        form_(form),
        binary_(binary),
        from_(folder_of(in.source.path)),
        to_(folder_of(path)) {}

  BufferPatch plan(const NodePatch& nodes, const Scene& tracks) {
    out_.uri_of_buffer.resize(document_.buffers.size());
    out_.uri_of_image.resize(document_.images.size());
    out_.animation = plan_buffer(tracks, NodePlan(tracks), nodes.animation, kNoStreams, kNoMerge);
    first_buffer();
    other_buffers();
    place_animation();
    place_images();
    out_.grows = out_.animation.bytes > 0 || !out_.images.empty();
    out_.new_buffer = out_.new_buffer && out_.grows;
    if (out_.new_buffer && form_ == FileForm::gltf)
      out_.new_uri = percent_encoded(fs::path(binary_).filename().string());
    return std::move(out_);
  }

 private:
  /// A buffer without URI that has bytes is the chunk of a .glb.
  [[nodiscard]] bool first_is_chunk() const {
    return !document_.buffers.empty() && !document_.buffers[0].has_uri && !in_.source.buffers[0].empty();
  }

  void first_buffer() {
    if (document_.buffers.empty()) {
      out_.new_buffer = true;
      return;
    }
    const bool chunk = first_is_chunk();
    if (form_ == FileForm::glb) {
      if (!chunk && !document_.buffers[0].has_uri)
        reject(buffers_.at(0),
               "has neither bytes nor a URI: a .glb has no place for new ones, write a .gltf");
      out_.keeps_first = true;
      if (!chunk) out_.uri_of_buffer[0] = "-";
    } else if (chunk) {
      out_.keeps_first = true;
      out_.uri_of_buffer[0] = percent_encoded(fs::path(binary_).filename().string());
    } else {
      out_.new_buffer = true;
      out_.animation.buffer = static_cast<std::uint32_t>(document_.buffers.size());
    }
    if (out_.keeps_first) out_.bytes = align4(in_.source.buffers[0].size());
  }

  void other_buffers() {
    for (std::uint32_t i = out_.keeps_first ? 1 : 0; i < document_.buffers.size(); ++i) {
      const reading::Buffer& buffer = document_.buffers[i];
      if (!buffer.has_uri || is_data_uri(buffer.uri)) continue;
      const Place at = buffers_.at(i);
      out_.uri_of_buffer[i] = form_ == FileForm::glb ? data_uri(in_.source.buffers[i])
                                                     : moved_uri(buffer.uri, from_, to_, at.key("uri"));
    }
  }

  void place_animation() {
    BufferPlan& plan = out_.animation;
    plan.first_byte = out_.bytes;
    out_.bytes += plan.bytes;
    const auto views = static_cast<std::uint32_t>(document_.views.size());
    for (BufferPlan::View& view : plan.views) view.index += views;
    next_view_ = views + plan.view_count;
    const auto accessors = static_cast<std::uint32_t>(document_.accessors.size());
    plan.first_input += accessors;
    plan.first_byte_output += accessors;
    plan.first_scale_output += accessors;
    plan.first_value_output += accessors;
  }

  void place_images() {
    const Place images = root_.key("images");
    for (std::uint32_t i = 0; i < document_.images.size(); ++i) {
      const reading::ImageRecord& image = document_.images[i];
      if (!image.has_uri || is_data_uri(image.uri)) continue;
      const Place at = images.at(i);
      if (form_ == FileForm::gltf) {
        out_.uri_of_image[i] = moved_uri(image.uri, from_, to_, at.key("uri"));
        continue;
      }
      const Image& read = in_.scene.images[i];
      if (read.bytes.empty()) {
        out_.uri_of_image[i] = moved_uri(image.uri, from_, to_, at.key("uri"));
        out_.notes.push_back(at.str() + ": its file cannot be read; the result names it as before");
        continue;
      }
      const std::string type = image_mime_type(read);
      if (type.empty()) {
        reject(at, "the file '" + reading::printable(image.uri) +
                       "' is of no kind that a .glb holds (PNG, JPEG, WebP, KTX2): write a .gltf");
      }
      out_.images.push_back({i, next_view_++, out_.bytes, type});
      out_.bytes += align4(read.bytes.size());
    }
  }

  const PatchInput& in_;
  const reading::Document& document_;
  FileForm form_;
  const std::string& binary_;
  fs::path from_, to_;
  BufferPatch out_;
  std::uint32_t next_view_ = 0;
  Place root_;
  Place buffers_ = root_.key("buffers");
};

}  // namespace

BufferPatch plan_buffers(const PatchInput& input, const NodePatch& nodes, const Scene& tracks, FileForm form,
                         const std::string& path, const std::string& binary) {
  return BufferPlanner(input, form, path, binary).plan(nodes, tracks);
}

void write_patched_buffer(const PatchInput& input, const NodePatch& nodes, const Scene& tracks,
                          const BufferPatch& plan, ByteSink& sink) {
  const auto put = [&](const std::vector<std::uint8_t>& bytes) {
    sink.write(bytes.data(), bytes.size());
    sink.fill(0, align4(bytes.size()) - bytes.size());
  };
  if (plan.keeps_first) put(input.source.buffers[0]);
  write_buffer(tracks, NodePlan(tracks), nodes.animation, plan.animation, sink);
  for (const EmbeddedImage& image : plan.images) put(input.scene.images[image.image].bytes);
}

std::string free_binary_path(const PatchInput& input, const std::string& path) {
  const fs::path folder = folder_of(input.source.path);
  std::vector<fs::path> named;
  const Place root;
  const auto add = [&](std::string_view uri, const Place& at) {
    if (!is_data_uri(uri)) named.push_back(real_path(reading::resolve_uri(uri, folder.string(), at)));
  };
  for (const auto& buffer : input.document.buffers) {
    if (buffer.has_uri) add(buffer.uri, root.key("buffers"));
  }
  for (const auto& image : input.document.images) {
    if (image.has_uri) add(image.uri, root.key("images"));
  }
  const auto is_named = [&](const std::string& candidate) {
    return std::find(named.begin(), named.end(), real_path(candidate)) != named.end();
  };
  std::string out = binary_path(path);
  for (int i = 1; is_named(out); ++i) {
    const fs::path stem = fs::path(path).replace_extension();
    out = stem.string() + "_timeline" + (i == 1 ? "" : "_" + std::to_string(i)) + ".bin";
  }
  return out;
}

}  // namespace scenegen::gltf::patching
