// glTF 2.0 (.glb, .gltf) -> Scene: our own files, and anybody else's.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "scene/result.h"
#include "scene/scene.h"

namespace scenegen::gltf {

/// The file as it was, so that authoring can patch it (append nodes and animations) and lose nothing.
struct SourceDocument {
  std::string path;
  std::string json;  ///< the JSON text, byte for byte
  std::vector<std::vector<std::uint8_t>>
      buffers;                                ///< resolved bytes of /buffers/i (GLB chunk, data URI, file)
  std::vector<std::uint32_t> node_of_object;  ///< /nodes/i of each object of the scene
  std::vector<std::uint32_t>
      instance_of_object;  ///< index within an instancing node; empty when there are none
  /// Layout merged: objects are parts of meshes that they share, and have no nodes of their own.
  bool merged = false;
  std::vector<std::uint32_t> node_of_frame;  ///< /nodes/i of each frame of the scene
  /// What the scene held when it was read; what patch() finds beside it is new.
  std::uint32_t track_count = 0;
  std::vector<TrackId> visibility_of_object;  ///< empty: no object had a track
  /// Nodes whose scale the first animation sets to (0,0,0) and one other value, by node.
  struct ScaleVisibility {
    std::uint32_t node = 0;
    glm::vec3 shown{1.0F};
  };
  std::vector<ScaleVisibility> scale_visibility;
};

/// Something in the file that the scene does not hold (it stays in the source document).
struct Ignored {
  std::string where;  ///< JSON pointer of the first occurrence
  std::string what;   ///< "skins are drawn at rest", "KHR_lights_punctual"
  std::uint64_t count = 1;
};

struct ReadOptions {
  bool keep_source = false;  ///< fill ReadResult::source (holds the file's bytes in memory)
  unsigned threads = 1;      ///< a hint; one thread reads 1 M objects in 1 s, so it is not used yet
};

struct ReadResult {
  Scene scene;
  std::vector<Ignored> ignored;
  std::shared_ptr<const SourceDocument> source;
  std::uint64_t file_bytes = 0, json_bytes = 0;
};

/// Reads a file. Any content whatever gives a scene that passes validate(), or an error with a JSON pointer;
/// memory is bounded by the size of the file and its buffers, never by a number in it. An unsupported
/// extension in extensionsRequired is an error that names it.
[[nodiscard]] Result<ReadResult> read(const std::string& path, const ReadOptions& options = {});

/// The same from memory; external buffers and images are looked for in `folder`, and refused when it is
/// empty.
[[nodiscard]] Result<ReadResult> read_memory(std::vector<std::uint8_t> bytes, const std::string& name,
                                             const std::string& folder, const ReadOptions& options = {});

}  // namespace scenegen::gltf
