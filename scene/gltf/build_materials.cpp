#include <cstring>
#include <set>

#include "scene/gltf/build.h"
#include "scene/limits.h"

namespace scenegen::gltf::reading {

namespace {

/// "image/png" or "image/jpeg" by the first bytes, else "".
std::string_view kind_of(const std::vector<std::uint8_t>& bytes) {
  if (bytes.size() >= 8 && std::memcmp(bytes.data(), "\x89PNG\r\n\x1a\n", 8) == 0) return "image/png";
  if (bytes.size() >= 3 && std::memcmp(bytes.data(), "\xFF\xD8\xFF", 3) == 0) return "image/jpeg";
  return {};
}

class ImageReader {
 public:
  ImageReader(Document& document, Data& data, const std::string& folder)
      : document_(document), data_(data), folder_(folder) {}
  /// Bytes of an image; empty (and ignored) when its file is missing.
  Image read(const ImageRecord& record, const Place& at);

 private:
  std::vector<std::uint8_t> read_image_file(std::string_view uri, const Place& at);

  Document& document_;
  Data& data_;
  const std::string& folder_;
  std::set<std::string> opened_;
};

std::vector<std::uint8_t> ImageReader::read_image_file(std::string_view uri, const Place& at) {
  const std::string path = resolve_uri(uri, folder_, at);
  try {
    const Block block = read_file(path, at, false, limits::kMaxGlbBytes);
    if (!opened_.insert(path).second)
      data_.budget().take(block.size, at);  // again: a copy that no file's size pays for
    return {block.data.get(), block.data.get() + block.size};
  } catch (const Fault& fault) {
    if (fault.error.kind != ErrorKind::io) throw;
    document_.ignored.add(at, "image files that cannot be read");
    return {};
  }
}

Image ImageReader::read(const ImageRecord& record, const Place& at) {
  Image image;
  image.name = record.name;
  image.mime_type = record.mime_type;
  const Place uri = at.key("uri");
  if (!record.has_uri) {
    const Bytes bytes = data_.view(record.view, at.key("bufferView"));
    data_.budget().take(bytes.size(), at);
    image.bytes.assign(bytes.begin(), bytes.end());
  } else if (std::string type; decode_data_uri(record.uri, uri, image.bytes, &type)) {
    if (image.mime_type.empty()) image.mime_type = type;
  } else {
    image.bytes = read_image_file(record.uri, uri);
  }
  const std::string_view kind = kind_of(image.bytes);
  if (!kind.empty()) {
    image.mime_type = kind;
  } else if (!image.bytes.empty()) {
    document_.ignored.add(at, "images that are neither PNG nor JPEG");
  }
  return image;
}

void resolve(TextureUse& use, std::size_t textures, const Place& at) {
  if (use.texture.valid()) check_index(use.texture.value, textures, "textures", at.key("index"));
}

}  // namespace

void build_materials(Document& document, Data& data, const std::string& folder, Scene& scene) {
  const Place root;
  const Place images = root.key("images");
  std::vector<bool> readable;
  ImageReader reader(document, data, folder);
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    scene.images.push_back(reader.read(document.images[i], images.at(i)));
    readable.push_back(!kind_of(scene.images.back().bytes).empty());
  }
  const Place textures = root.key("textures");
  for (std::size_t i = 0; i < document.textures.size(); ++i) {
    const TextureRecord& record = document.textures[i];
    const Place at = textures.at(i);
    Texture& texture = scene.textures.emplace_back();
    if (record.source != kNone) {
      check_index(record.source, scene.images.size(), "images", at.key("source"));
      if (readable[record.source]) texture.image = ImageId(record.source);
    }
    if (record.sampler != kNone) {
      check_index(record.sampler, document.samplers.size(), "samplers", at.key("sampler"));
      texture.sampler = document.samplers[record.sampler];
    }
  }
  const Place materials = root.key("materials");
  for (std::size_t i = 0; i < document.materials.size(); ++i) {
    const Place at = materials.at(i);
    const Place pbr = at.key("pbrMetallicRoughness");
    Material& m = document.materials[i];
    const std::size_t count = scene.textures.size();
    resolve(m.base_color_texture, count, pbr.key("baseColorTexture"));
    resolve(m.metallic_roughness_texture, count, pbr.key("metallicRoughnessTexture"));
    resolve(m.normal_texture, count, at.key("normalTexture"));
    resolve(m.occlusion_texture, count, at.key("occlusionTexture"));
    resolve(m.emissive_texture, count, at.key("emissiveTexture"));
  }
  scene.materials = std::move(document.materials);
}

}  // namespace scenegen::gltf::reading
