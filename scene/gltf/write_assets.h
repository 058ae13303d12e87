// Meshes, materials, textures, samplers and images as JSON, by tinygltf.
#pragma once

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "scene/gltf/write_buffer.h"
#include "scene/scene.h"

namespace scenegen::gltf {

/// Members of the document; empty arrays where there is nothing.
struct AssetTrees {
  nlohmann::json meshes, materials, textures, samplers, images;
  std::set<std::string> extensions_used, extensions_required;
};

/// KHR_materials_emissive_strength of every material: the least power of two (>= 1) that keeps all components
/// of its emissive light, at rest and in its tracks, at or below 1. Dividing by it is exact.
[[nodiscard]] std::vector<float> emissive_strengths(const Scene& scene);

/// Properties that a material track points at are written even when they have their default value.
[[nodiscard]] AssetTrees make_assets(const Scene& scene, const BufferPlan& buffer,
                                     const std::vector<float>& strengths);

}  // namespace scenegen::gltf
