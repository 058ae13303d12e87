#include "render/gpu_scene.h"
#include "render/draw_optimize.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>

#include "render/config.h"
#include "scene/held_bytes.h"

namespace scenegen::render {
namespace {

using vkr::Use;
using BufferUsage = vk::BufferUsageFlagBits;

constexpr bool is_srgb(std::uint32_t which) {
  return which == kTextureBaseColor || which == kTextureEmissive;
}

std::array<const TextureUse*, kTextureCount> uses_of(const Material& m) {
  return {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture, &m.occlusion_texture,
          &m.emissive_texture};
}

vk::SamplerAddressMode address_mode(int wrap) {
  if (wrap == 33071) return vk::SamplerAddressMode::eClampToEdge;
  return wrap == 33648 ? vk::SamplerAddressMode::eMirroredRepeat : vk::SamplerAddressMode::eRepeat;
}

}  // namespace

TextureSets texture_sets(const Scene& scene) {
  TextureSets out;
  std::map<std::array<TextureId, kTextureCount>, std::uint32_t> known;
  const auto number = [&](const std::array<TextureId, kTextureCount>& set) {
    const auto [it, added] = known.emplace(set, static_cast<std::uint32_t>(out.sets.size()));
    if (added) out.sets.push_back(set);
    return it->second;
  };
  (void)number({});
  for (const Material& material : scene.materials) {
    std::array<TextureId, kTextureCount> set;
    const auto uses = uses_of(material);
    for (std::uint32_t i = 0; i < kTextureCount; ++i) {
      const TextureId texture = uses[i]->texture;
      if (texture.valid() && scene.textures[texture.value].image.valid()) set[i] = texture;
    }
    out.of_material.push_back(number(set));
  }
  out.of_material.push_back(0);
  return out;
}

MaterialRecord material_record(const Material& m) {
  MaterialRecord r{};
  r.base_color = m.base_color;
  r.emissive = glm::vec4(m.emissive, m.alpha_cutoff);
  r.factors = glm::vec4(m.metallic, m.roughness, m.normal_texture.strength, m.occlusion_texture.strength);
  if (m.unlit) r.flags.x |= kMaterialUnlit;
  const auto uses = uses_of(m);
  for (std::uint32_t i = 0; i < kTextureCount; ++i) {
    const TextureUse& use = *uses[i];
    if (use.texcoord == 1) r.flags.x |= kMaterialSecondTexcoord << i;
    // KHR_texture_transform: offset * rotation * scale, rotation counter-clockwise in (u, -v), that is
    // [cos sin; -sin cos].
    const float c = std::cos(use.uv_rotation_rad);
    const float s = std::sin(use.uv_rotation_rad);
    r.textures[i].row0 = {c * use.uv_scale.x, s * use.uv_scale.y, use.uv_offset.x, 0.0F};
    r.textures[i].row1 = {-s * use.uv_scale.x, c * use.uv_scale.y, use.uv_offset.y, 0.0F};
  }
  return r;
}

GpuScene::GpuScene(const vkr::Device& device, vkr::Memory& memory, const vkr::Pipelines& pipelines,
                   const Scene& scene, const TextureSets& sets)
    : device_(device), memory_(memory) {
  upload_ =
      memory_.buffer(kUploadBytes, BufferUsage::eTransferSrc, vkr::MemoryUse::upload, MemoryKind::staging);
  upload_geometry(scene);
  for (const Material& material : scene.materials) material_records_.push_back(material_record(material));
  material_records_.push_back(material_record(Material{}));
  check_range("materials", material_records_.size(), sizeof(MaterialRecord));
  materials_ = memory_.buffer(material_records_.size() * sizeof(MaterialRecord),
                              BufferUsage::eStorageBuffer | BufferUsage::eTransferDst, vkr::MemoryUse::scene,
                              MemoryKind::records);
  upload_bytes(materials_, std::as_bytes(std::span(material_records_)));
  camera_ = memory_.buffer(sizeof(CameraBlock), BufferUsage::eUniformBuffer | BufferUsage::eTransferDst,
                           vkr::MemoryUse::device, MemoryKind::records);
  upload_textures(scene, sets);
  const auto set_count = static_cast<std::uint32_t>(sets.sets.size());
  const std::array sizes{
      vk::DescriptorPoolSize(vk::DescriptorType::eUniformBuffer, 1),
      vk::DescriptorPoolSize(vk::DescriptorType::eStorageBuffer, 2),
      vk::DescriptorPoolSize(vk::DescriptorType::eCombinedImageSampler, 1 + kTextureCount * set_count)};
  pool_ = vk::raii::DescriptorPool(device_.device, vk::DescriptorPoolCreateInfo({}, 1 + set_count, sizes));
  make_frame_set(pipelines);
  make_texture_sets(pipelines, scene, sets);
}

void GpuScene::check_range(const std::string& what, std::uint64_t count, std::uint64_t bytes_each) const {
  const std::uint64_t most = device_.properties.limits.maxStorageBufferRange / bytes_each;
  if (count <= most) return;
  throw LimitError("the scene has " + std::to_string(count) + " " + what + ", this device takes " +
                   std::to_string(most) +
                   " (maxStorageBufferRange); a smaller scene or another --device helps");
}

void GpuScene::upload_bytes(const vkr::Buffer& target, std::span<const std::byte> bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const std::size_t piece = std::min<std::size_t>(bytes.size() - done, kUploadBytes);
    std::memcpy(upload_.mapped(), bytes.data() + done, piece);
    vkr::run_once(device_, [&](const vk::raii::CommandBuffer& commands) {
      commands.copyBuffer(*upload_.buffer, *target.buffer, vk::BufferCopy(0, done, piece));
      vkr::Barriers().buffer(*target.buffer, Use::transfer_write, Use::shader_data).flush(commands);
    });
    done += piece;
  }
}

void GpuScene::upload_geometry(const Scene& scene) {
  std::vector<glm::vec3> positions;
  std::vector<VertexAttributes> attributes;
  std::vector<std::uint32_t> indices;
  std::vector<TriangleOrder> orders(scene.geometries.size(), TriangleOrder::free);
  for (const Mesh& mesh : scene.meshes) {
    for (const Primitive& p : mesh.primitives) {
      if (p.material.valid() && scene.materials[p.material.value].alpha_mode == AlphaMode::blend)
        orders[p.geometry.value] = TriangleOrder::kept;
    }
  }
  for (const Geometry& geometry : scene.geometries) {
    DrawGeometry drawn = make_draw_geometry(geometry);
    share_vertices(drawn, orders[ranges_.size()]);
    work_.push_back(work_of(drawn));
    GeometryRange range;
    range.first_index = static_cast<std::uint32_t>(indices.size());
    range.index_count = static_cast<std::uint32_t>(drawn.indices.size());
    range.vertex_offset = static_cast<std::int32_t>(positions.size());
    range.kind = drawn.kind;
    positions.insert(positions.end(), drawn.positions_m.begin(), drawn.positions_m.end());
    attributes.insert(attributes.end(), drawn.attributes.begin(), drawn.attributes.end());
    indices.insert(indices.end(), drawn.indices.begin(), drawn.indices.end());
    ranges_.push_back(range);
    if (positions.size() > 0x7FFFFFFFU || indices.size() > 0xFFFFFFFFU)
      throw LimitError("the scene has more than 2^31 vertices or 2^32 indices; a smaller scene helps");
  }
  const auto make = [&](auto& data, vk::BufferUsageFlags usage) {
    vkr::Buffer buffer = memory_.buffer(data.size() * sizeof(data[0]), usage | BufferUsage::eTransferDst,
                                        vkr::MemoryUse::scene, MemoryKind::geometry);
    upload_bytes(buffer, std::as_bytes(std::span(data)));
    return buffer;
  };
  positions_ = make(positions, BufferUsage::eVertexBuffer);
  attributes_ = make(attributes, BufferUsage::eVertexBuffer);
  indices_ = make(indices, BufferUsage::eIndexBuffer);
}

void GpuScene::record_mipmaps(const vk::raii::CommandBuffer& commands, const vkr::Image& image) const {
  vkr::Barriers barriers;
  using Aspect = vk::ImageAspectFlagBits;
  auto width = static_cast<std::int32_t>(image.extent.width);
  auto height = static_cast<std::int32_t>(image.extent.height);
  for (std::uint32_t level = 1; level < image.mip_levels; ++level) {
    barriers.image_levels(*image.image, level - 1, 1, Use::transfer_write, Use::transfer_read)
        .image_levels(*image.image, level, 1, Use::none, Use::transfer_write)
        .flush(commands);
    vk::ImageBlit blit;
    blit.srcSubresource = vk::ImageSubresourceLayers(Aspect::eColor, level - 1, 0, 1);
    blit.srcOffsets[1] = vk::Offset3D(width, height, 1);
    width = std::max(1, width / 2);
    height = std::max(1, height / 2);
    blit.dstSubresource = vk::ImageSubresourceLayers(Aspect::eColor, level, 0, 1);
    blit.dstOffsets[1] = vk::Offset3D(width, height, 1);
    commands.blitImage(*image.image, vk::ImageLayout::eTransferSrcOptimal, *image.image,
                       vk::ImageLayout::eTransferDstOptimal, blit, vk::Filter::eLinear);
  }
  if (image.mip_levels > 1)
    barriers.image_levels(*image.image, 0, image.mip_levels - 1, Use::transfer_read, Use::sampled);
  barriers.image_levels(*image.image, image.mip_levels - 1, 1, Use::transfer_write, Use::sampled)
      .flush(commands);
}

vkr::Image GpuScene::upload_image(const DecodedImage& decoded, vk::Format format) {
  using Usage = vk::ImageUsageFlagBits;
  const vk::Extent2D extent(decoded.width, decoded.height);
  const auto levels = static_cast<std::uint32_t>(std::bit_width(std::max(extent.width, extent.height)));
  vkr::Image image =
      memory_.image({format, extent, levels, vk::SampleCountFlagBits::e1,
                     Usage::eSampled | Usage::eTransferSrc | Usage::eTransferDst, MemoryKind::textures});
  vkr::Buffer own;  // of a texture that does not fit the upload buffer
  const vkr::Buffer* source = &upload_;
  if (decoded.rgba.size() > kUploadBytes) {
    own = memory_.buffer(decoded.rgba.size(), BufferUsage::eTransferSrc, vkr::MemoryUse::upload,
                         MemoryKind::staging);
    source = &own;
  }
  std::memcpy(source->mapped(), decoded.rgba.data(), decoded.rgba.size());
  vkr::run_once(device_, [&](const vk::raii::CommandBuffer& commands) {
    vkr::Barriers().image_levels(*image.image, 0, 1, Use::none, Use::transfer_write).flush(commands);
    const vk::BufferImageCopy region(0, 0, 0, {vk::ImageAspectFlagBits::eColor, 0, 0, 1}, {0, 0, 0},
                                     vk::Extent3D(extent, 1));
    commands.copyBufferToImage(*source->buffer, *image.image, vk::ImageLayout::eTransferDstOptimal, region);
    record_mipmaps(commands, image);
  });
  image.last_use = Use::sampled;
  return image;
}

void GpuScene::upload_textures(const Scene& scene, const TextureSets& sets) {
  images_.push_back(upload_image(DecodedImage{}, vk::Format::eR8G8B8A8Unorm));  // white, for what is missing
  image_index_.assign(scene.images.size(), {0, 0});
  std::vector<std::array<bool, 2>> wanted(scene.images.size(), {false, false});
  for (const auto& set : sets.sets) {
    for (std::uint32_t i = 0; i < kTextureCount; ++i) {
      if (set[i].valid()) wanted[scene.textures[set[i].value].image.value][is_srgb(i) ? 1 : 0] = true;
    }
  }
  const std::uint32_t most = std::min(kMaxTextureSide, device_.properties.limits.maxImageDimension2D);
  for (std::size_t i = 0; i < scene.images.size(); ++i) {
    if (!wanted[i][0] && !wanted[i][1]) continue;
    const std::string where = "image " + std::to_string(i) +
                              (scene.images[i].name.empty() ? "" : " '" + scene.images[i].name + "'");
    Result<DecodedImage> decoded = decode_image(scene.images[i].bytes, where);
    if (!decoded) {
      warnings_.push_back(decoded.error().str() + "; drawn white");
      continue;
    }
    while (std::max(decoded->width, decoded->height) > most) *decoded = halved(*decoded);
    for (std::uint32_t srgb = 0; srgb < 2; ++srgb) {
      if (!wanted[i][srgb]) continue;
      image_index_[i][srgb] = static_cast<std::uint32_t>(images_.size());
      images_.push_back(
          upload_image(*decoded, srgb == 1 ? vk::Format::eR8G8B8A8Srgb : vk::Format::eR8G8B8A8Unorm));
    }
  }
}

vk::Sampler GpuScene::sampler(const Sampler& wanted) {
  for (const auto& [known, made] : samplers_) {
    if (known == wanted) return *made;
  }
  const int min = wanted.min_filter;
  const bool nearest_min = min == 9728 || min == 9984 || min == 9986;
  const bool no_mip = min == 9728 || min == 9729;
  const bool nearest_mip = no_mip || min == 9984 || min == 9985;
  vk::SamplerCreateInfo create;
  create.magFilter = wanted.mag_filter == 9728 ? vk::Filter::eNearest : vk::Filter::eLinear;
  create.minFilter = nearest_min ? vk::Filter::eNearest : vk::Filter::eLinear;
  create.mipmapMode = nearest_mip ? vk::SamplerMipmapMode::eNearest : vk::SamplerMipmapMode::eLinear;
  create.maxLod = no_mip ? 0.25F : VK_LOD_CLAMP_NONE;  // 0.25: the level stays 0, min and mag still differ
  create.addressModeU = address_mode(wanted.wrap_s);
  create.addressModeV = address_mode(wanted.wrap_t);
  if (!nearest_min && !no_mip && device_.max_anisotropy > 1.0F) {
    create.anisotropyEnable = VK_TRUE;
    create.maxAnisotropy = device_.max_anisotropy;
  }
  samplers_.emplace_back(wanted, vk::raii::Sampler(device_.device, create));
  return *samplers_.back().second;
}

void GpuScene::make_frame_set(const vkr::Pipelines& pipelines) {
  const vk::DescriptorSetLayout layout = pipelines.frame_set_layout();
  frame_set_ =
      (*device_.device).allocateDescriptorSets({*pool_, layout}, *device_.device.getDispatcher()).front();
  vk::SamplerCreateInfo create;
  const vk::FormatProperties depth = device_.physical.getFormatProperties(vkr::kDepthFormat);
  const bool linear =
      static_cast<bool>(depth.optimalTilingFeatures & vk::FormatFeatureFlagBits::eSampledImageFilterLinear);
  create.magFilter = create.minFilter = linear ? vk::Filter::eLinear : vk::Filter::eNearest;
  create.addressModeU = create.addressModeV = vk::SamplerAddressMode::eClampToEdge;
  create.compareEnable = VK_TRUE;
  create.compareOp = vk::CompareOp::eGreaterOrEqual;  // reversed depth: lit when not farther than the caster
  shadow_sampler_ = vk::raii::Sampler(device_.device, create);
  const vk::DescriptorBufferInfo camera(*camera_.buffer, 0, VK_WHOLE_SIZE);
  const vk::DescriptorBufferInfo materials(*materials_.buffer, 0, VK_WHOLE_SIZE);
  device_.device.updateDescriptorSets(
      {vk::WriteDescriptorSet(frame_set_, 0, 0, vk::DescriptorType::eUniformBuffer, {}, camera),
       vk::WriteDescriptorSet(frame_set_, 2, 0, vk::DescriptorType::eStorageBuffer, {}, materials)},
      {});
}

void GpuScene::upload_records(std::span<const ObjectRecord> records) {
  const std::uint64_t record_bytes = std::max<std::size_t>(records.size(), 1) * sizeof(ObjectRecord);
  check_range("slots (object x primitive)", records.size(), sizeof(ObjectRecord));
  records_ = memory_.buffer(record_bytes, BufferUsage::eStorageBuffer | BufferUsage::eTransferDst,
                            vkr::MemoryUse::scene, MemoryKind::records);
  upload_bytes(records_, std::as_bytes(records));
  upload_ = {};  // the last upload
  memory_.release_unused();
  std::string spilled;
  for (const auto& [kind, what] : {std::pair{MemoryKind::geometry, "geometry"},
                                   std::pair{MemoryKind::records, "object and material records"}}) {
    if (const std::uint64_t bytes = memory_.spilled_bytes(kind); bytes > 0)
      spilled +=
          (spilled.empty() ? "" : " and ") + std::to_string((bytes + 999'999) / 1'000'000) + " MB of " + what;
  }
  if (!spilled.empty())
    warnings_.push_back("device memory is full: " + spilled +
                        " lie in memory of the host, where drawing is slower");
  const vk::DescriptorBufferInfo info(*records_.buffer, 0, VK_WHOLE_SIZE);
  device_.device.updateDescriptorSets(
      vk::WriteDescriptorSet(frame_set_, 1, 0, vk::DescriptorType::eStorageBuffer, {}, info), {});
}

void GpuScene::add_memory(MemoryAccount& to) const {
  to.add_host(MemoryKind::geometry, held_bytes(ranges_, work_));
  to.add_host(MemoryKind::records,
              held_bytes(material_records_, dirty_materials_, record_copies_, material_copies_));
  to.add_host(MemoryKind::textures,
              held_bytes(images_, samplers_, texture_sets_, texture_masks_, image_index_));
}

void GpuScene::bind_shadow_map(const vkr::Image& map) {
  const vk::DescriptorImageInfo info(*shadow_sampler_, *map.view, vk::ImageLayout::eShaderReadOnlyOptimal);
  device_.device.updateDescriptorSets(
      vk::WriteDescriptorSet(frame_set_, 3, 0, vk::DescriptorType::eCombinedImageSampler, info), {});
}

void GpuScene::make_texture_sets(const vkr::Pipelines& pipelines, const Scene& scene,
                                 const TextureSets& sets) {
  const std::vector<vk::DescriptorSetLayout> layouts(sets.sets.size(), pipelines.texture_set_layout());
  texture_sets_ =
      (*device_.device).allocateDescriptorSets({*pool_, layouts}, *device_.device.getDispatcher());
  for (std::size_t s = 0; s < sets.sets.size(); ++s) {
    std::array<vk::DescriptorImageInfo, kTextureCount> infos;
    std::uint32_t mask = 0;
    for (std::uint32_t i = 0; i < kTextureCount; ++i) {
      const TextureId id = sets.sets[s][i];
      std::uint32_t index = 0;
      Sampler how;
      if (id.valid()) {
        mask |= 1U << i;
        const Texture& texture = scene.textures[id.value];
        index = image_index_[texture.image.value][is_srgb(i) ? 1 : 0];
        how = texture.sampler;
      }
      infos[i] = vk::DescriptorImageInfo(sampler(how), *images_[index].view,
                                         vk::ImageLayout::eShaderReadOnlyOptimal);
    }
    device_.device.updateDescriptorSets(
        vk::WriteDescriptorSet(texture_sets_[s], 0, 0, vk::DescriptorType::eCombinedImageSampler, infos), {});
    texture_masks_.push_back(mask);
  }
}

void GpuScene::set_material_colors(MaterialId id, const glm::vec4& base_color, const glm::vec3& emissive) {
  MaterialRecord& r = material_records_[id.value];
  r.base_color = base_color;
  r.emissive = glm::vec4(emissive, r.emissive.w);
  dirty_materials_.push_back(id.value);
}

std::uint64_t GpuScene::record_updates(vkr::Frame& frame, vkr::Barriers& barriers, const CameraBlock& camera,
                                       const DrawScene& scene) {
  const auto slots = scene.dirty_slots();
  const auto records = scene.dirty_records();
  const std::uint64_t records_at = sizeof(CameraBlock);
  const std::uint64_t materials_at = records_at + records.size_bytes();
  const std::uint64_t bytes = materials_at + dirty_materials_.size() * sizeof(MaterialRecord);
  std::byte* staging = frame.staging.reserve(memory_, bytes);
  std::memcpy(staging, &camera, sizeof(camera));
  if (!records.empty()) std::memcpy(staging + records_at, records.data(), records.size_bytes());
  material_copies_.clear();
  for (std::size_t i = 0; i < dirty_materials_.size(); ++i) {
    const std::uint64_t from = materials_at + i * sizeof(MaterialRecord);
    std::memcpy(staging + from, &material_records_[dirty_materials_[i]], sizeof(MaterialRecord));
    material_copies_.emplace_back(from, dirty_materials_[i] * sizeof(MaterialRecord), sizeof(MaterialRecord));
  }
  record_copies_.clear();  // neighbouring slots in one region
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const std::uint64_t from = records_at + i * sizeof(ObjectRecord);
    const std::uint64_t to = slots[i] * sizeof(ObjectRecord);
    if (!record_copies_.empty() && record_copies_.back().dstOffset + record_copies_.back().size == to) {
      record_copies_.back().size += sizeof(ObjectRecord);
    } else {
      record_copies_.emplace_back(from, to, sizeof(ObjectRecord));
    }
  }
  dirty_materials_.clear();

  const auto both = [&](Use before, Use after) {
    barriers.buffer(*camera_.buffer, before, after);
    if (!record_copies_.empty()) barriers.buffer(*records_.buffer, before, after);
    if (!material_copies_.empty()) barriers.buffer(*materials_.buffer, before, after);
    barriers.flush(frame.commands);
  };
  both(Use::shader_data, Use::transfer_write);
  frame.commands.copyBuffer(frame.staging.buffer(), *camera_.buffer,
                            vk::BufferCopy(0, 0, sizeof(CameraBlock)));
  if (!record_copies_.empty())
    frame.commands.copyBuffer(frame.staging.buffer(), *records_.buffer, record_copies_);
  if (!material_copies_.empty())
    frame.commands.copyBuffer(frame.staging.buffer(), *materials_.buffer, material_copies_);
  both(Use::transfer_write, Use::shader_data);
  return bytes;
}

void GpuScene::bind_geometry(const vk::raii::CommandBuffer& commands) const {
  commands.bindVertexBuffers(0, {*positions_.buffer, *attributes_.buffer}, {0, 0});
  commands.bindIndexBuffer(*indices_.buffer, 0, vk::IndexType::eUint32);
}

void GpuScene::bind_frame_set(const vk::raii::CommandBuffer& commands, vk::PipelineLayout layout,
                              vk::PipelineBindPoint where) const {
  commands.bindDescriptorSets(where, layout, 0, frame_set_, {});
}

void GpuScene::bind_texture_set(const vk::raii::CommandBuffer& commands, vk::PipelineLayout layout,
                                std::uint32_t set) const {
  commands.bindDescriptorSets(vk::PipelineBindPoint::eGraphics, layout, 1, texture_sets_[set], {});
}

}  // namespace scenegen::render
