// Small texts that the writer of scenes and the patcher of documents share.
#pragma once

#include <string_view>

#include "scene/gltf/write.h"
#include "scene/gltf/write_text.h"
#include "scene/gltf/write_tracks.h"
#include "scene/scene.h"

namespace scenegen::gltf {

struct FileInfo {
  std::string_view layout;
  VisibilityEncoding visibility = VisibilityEncoding::scale;
  /// asset.generator of the document that was patched; its data() is null when the document is all ours.
  std::string_view source_generator;
};

/// The value of asset.extras.scenegen (docs/FORMAT.md 1).
void emit_scenegen(const Scene& scene, const FileInfo& file, TextOut& out);

/// ,"translation":[…],"rotation":[…],"scale":[…] without what is neutral.
void emit_transform(const Transform& transform, TextOut& out);

/// {"input":…,"output":…,"interpolation":…}
void emit_sampler(std::uint32_t input, std::uint32_t output, Interpolation interpolation, TextOut& out);

/// Text of channels, one after the other.
class ChannelText {
 public:
  explicit ChannelText(TextOut& out) : out_(out), commas_(out) {}

  void node(std::uint32_t sampler, std::uint32_t node, std::string_view path);
  void pointer(std::uint32_t sampler, std::string_view list, std::uint32_t index, std::string_view rest);
  void visible(std::uint32_t sampler, std::uint32_t node) {
    pointer(sampler, "/nodes/", node, "/extensions/KHR_node_visibility/visible");
  }
  /// For a channel whose text comes from elsewhere.
  TextOut& next() { return commas_.next(); }

 private:
  void open(std::uint32_t sampler);
  TextOut& out_;
  Commas commas_;
};

/// "translation", "rotation", "scale"
[[nodiscard]] std::string_view path_of(Property property);

}  // namespace scenegen::gltf
