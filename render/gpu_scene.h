// The scene in device memory: one vertex and index buffer, one object array, one material array, one camera
// block, textures.
#pragma once

#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

#include "render/draw_scene.h"
#include "render/image_decode.h"
#include "render/vk/barrier.h"
#include "render/vk/frame_ring.h"
#include "render/vk/memory.h"
#include "render/vk/pipelines.h"

namespace scenegen::render {

/// The scene is above a limit of the device; the message says which and what helps.
class LimitError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Which textures a material binds; materials with equal sets share one descriptor set.
struct TextureSets {
  std::vector<std::array<TextureId, kTextureCount>> sets;  ///< sets[0]: none
  std::vector<std::uint32_t> of_material;                  ///< one more than materials: glTF's default
};
[[nodiscard]] TextureSets texture_sets(const Scene& scene);

/// What the shaders read of a material.
[[nodiscard]] MaterialRecord material_record(const Material& material);

/// Geometry in device memory is never moved. Object array, material array and camera block stand at fixed
/// places for the life of the scene: what changes is copied into them at the start of a frame from that
/// frame's staging memory.
class GpuScene {
 public:
  /// Uploads everything. Throws vk::SystemError and LimitError.
  GpuScene(const vkr::Device& device, vkr::Memory& memory, const vkr::Pipelines& pipelines,
           const Scene& scene, const TextureSets& sets);

  /// The object array, once slots are known.
  void upload_records(std::span<const ObjectRecord> records);
  void set_material_colors(MaterialId id, const glm::vec4& base_color, const glm::vec3& emissive);
  /// Copies the camera block, dirty object records and dirty materials; begins and ends with barriers.
  /// Returns the bytes copied.
  std::uint64_t record_updates(vkr::Frame& frame, vkr::Barriers& barriers, const CameraBlock& camera,
                               const DrawScene& scene);
  void bind_shadow_map(const vkr::Image& map);

  void bind_geometry(const vk::raii::CommandBuffer& commands) const;
  void bind_frame_set(const vk::raii::CommandBuffer& commands, vk::PipelineLayout layout,
                      vk::PipelineBindPoint where = vk::PipelineBindPoint::eGraphics) const;
  void bind_texture_set(const vk::raii::CommandBuffer& commands, vk::PipelineLayout layout,
                        std::uint32_t set) const;
  /// Bit i: the set has texture i.
  [[nodiscard]] std::uint32_t texture_mask(std::uint32_t set) const { return texture_masks_[set]; }
  [[nodiscard]] const GeometryRange& range(GeometryId id) const { return ranges_[id.value]; }
  [[nodiscard]] std::span<const GeometryRange> ranges() const { return ranges_; }
  /// Of each geometry, as it is drawn.
  [[nodiscard]] std::span<const DrawWork> work() const { return work_; }
  /// Host memory; what is on the device is counted where it was allocated.
  void add_memory(MemoryAccount& to) const;
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  void upload_geometry(const Scene& scene);
  void upload_textures(const Scene& scene, const TextureSets& sets);
  /// Throws LimitError when an array is above the device's storage range.
  void check_range(const std::string& what, std::uint64_t count, std::uint64_t bytes_each) const;
  void upload_bytes(const vkr::Buffer& target, std::span<const std::byte> bytes);
  vkr::Image upload_image(const DecodedImage& image, vk::Format format);
  void record_mipmaps(const vk::raii::CommandBuffer& commands, const vkr::Image& image) const;
  vk::Sampler sampler(const Sampler& sampler);
  void make_frame_set(const vkr::Pipelines& pipelines);
  void make_texture_sets(const vkr::Pipelines& pipelines, const Scene& scene, const TextureSets& sets);
  void write_buffer_descriptors();

  const vkr::Device& device_;
  vkr::Memory& memory_;
  std::vector<std::string> warnings_;
  std::vector<GeometryRange> ranges_;
  std::vector<DrawWork> work_;
  vkr::Buffer positions_, attributes_, indices_, records_, materials_, camera_;
  vkr::Buffer upload_;
  std::vector<MaterialRecord> material_records_;
  std::vector<std::uint32_t> dirty_materials_;
  std::vector<vk::BufferCopy> record_copies_, material_copies_;  // scratch of record_updates()
  std::vector<vkr::Image> images_;
  std::vector<std::pair<Sampler, vk::raii::Sampler>> samplers_;
  vk::raii::Sampler shadow_sampler_{nullptr};
  vk::raii::DescriptorPool pool_{nullptr};
  vk::DescriptorSet frame_set_;
  std::vector<vk::DescriptorSet> texture_sets_;
  std::vector<std::uint32_t> texture_masks_;
  // Texture of each set entry: index into images_, by (image, is it sRGB).
  std::vector<std::array<std::uint32_t, 2>> image_index_;
};

}  // namespace scenegen::render
