// Where the bytes go that a patched document adds, and what becomes of the buffers and images it has. Private
// to scene/gltf.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf/patch_plan.h"
#include "scene/gltf/write_buffer.h"
#include "scene/gltf/write_content.h"

namespace scenegen::gltf::patching {

/// An image that was a file of its own and moves into the buffer.
struct EmbeddedImage {
  std::uint32_t image = 0, view = 0;
  std::uint64_t offset = 0;  ///< in the buffer
  std::string mime_type;
};

/// The .glb's chunk or the .bin: bytes of the file's buffer 0 (if `keeps_first`), our animation, images.
struct BufferPatch {
  BufferPlan animation;
  std::vector<EmbeddedImage> images;
  bool keeps_first = false;
  bool grows = false;                      ///< more than buffer 0
  bool new_buffer = false;                 ///< an element is added to /buffers
  std::string new_uri;                     ///< its URI; empty: the chunk of a .glb
  std::uint64_t bytes = 0;                 ///< of the whole; 0: none is written
  std::vector<std::string> uri_of_buffer;  ///< new text of /buffers/i/uri; empty: as it was; "-": none
  std::vector<std::string> uri_of_image;   ///< new text of /images/i/uri; empty: as it was
  std::vector<std::string> notes;
};

/// `binary`: path of the .bin of a .gltf.
[[nodiscard]] BufferPatch plan_buffers(const PatchInput& input, const NodePatch& nodes, const Scene& tracks,
                                       FileForm form, const std::string& path, const std::string& binary);
void write_patched_buffer(const PatchInput& input, const NodePatch& nodes, const Scene& tracks,
                          const BufferPatch& plan, ByteSink& sink);

/// A .bin beside `path` that is none of the files the document names.
[[nodiscard]] std::string free_binary_path(const PatchInput& input, const std::string& path);

}  // namespace scenegen::gltf::patching
