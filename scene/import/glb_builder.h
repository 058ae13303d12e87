// A glTF document under construction: JSON and one binary chunk. Equal data become one accessor. Private to
// scene/import.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "scene/gltf/write_sink.h"

namespace scenegen::import {

class GlbBuilder {
 public:
  enum class Target : std::uint32_t { none = 0, vertices = 34962, indices = 34963 };

  nlohmann::json root = nlohmann::json::object();  ///< without buffers, bufferViews, accessors, images

  /// Floats of "SCALAR" … "VEC4"; `bounds` adds min and max.
  std::size_t floats(std::span<const float> values, std::uint32_t components, Target target, bool bounds);
  /// 16 bits where `vertex_count` allows.
  std::size_t indices(std::span<const std::uint32_t> values, std::size_t vertex_count);
  std::size_t image(std::span<const std::uint8_t> bytes, std::string_view mime_type, std::string_view name);
  /// Index of `value` in the array `key`; one that equals it is used again.
  std::size_t shared(const char* key, const nlohmann::json& value);

  /// The .glb. Once.
  void write(gltf::ByteSink& sink);

 private:
  std::size_t view(std::span<const std::uint8_t> bytes, Target target);
  std::size_t unique(nlohmann::json& array, const char* kind, const nlohmann::json& value);

  std::vector<std::uint8_t> binary_;
  nlohmann::json views_ = nlohmann::json::array(), accessors_ = nlohmann::json::array(),
                 images_ = nlohmann::json::array();
  std::unordered_multimap<std::uint64_t, std::size_t> view_of_hash_;
  std::unordered_map<std::string, std::size_t> known_;  ///< kind and text of a JSON value
};

}  // namespace scenegen::import
