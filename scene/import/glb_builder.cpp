#include "scene/import/glb_builder.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include "scene/gltf/write_text.h"

namespace scenegen::import {

namespace {

using nlohmann::json;

template <class T>
std::span<const std::uint8_t> bytes_of(std::span<const T> values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()};
}

void put_u32(std::vector<std::uint8_t>& out, std::uint64_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::uint8_t>(value >> shift));
}

}  // namespace

std::size_t GlbBuilder::unique(json& array, const char* kind, const json& value) {
  const auto [entry, fresh] =
      known_.emplace(kind + value.dump(-1, ' ', false, json::error_handler_t::replace), array.size());
  if (fresh) array.push_back(value);
  return entry->second;
}

std::size_t GlbBuilder::shared(const char* key, const json& value) {
  json& array = root[key];
  if (array.is_null()) array = json::array();
  return unique(array, key, value);
}

std::size_t GlbBuilder::view(std::span<const std::uint8_t> bytes, Target target) {
  const std::uint64_t hash = std::hash<std::string_view>()(
      std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  const auto same_hash = view_of_hash_.equal_range(hash);
  for (auto at = same_hash.first; at != same_hash.second; ++at) {
    const json& known = views_[at->second];
    const auto offset = known["byteOffset"].get<std::size_t>();
    const bool same_use = known.value("target", 0U) == static_cast<std::uint32_t>(target);
    if (same_use && known["byteLength"].get<std::size_t>() == bytes.size() &&
        std::memcmp(binary_.data() + offset, bytes.data(), bytes.size()) == 0) {
      return at->second;
    }
  }
  binary_.resize((binary_.size() + 3) / 4 * 4);
  json made = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes.size()}};
  if (target != Target::none) made["target"] = static_cast<std::uint32_t>(target);
  binary_.insert(binary_.end(), bytes.begin(), bytes.end());
  views_.push_back(std::move(made));
  view_of_hash_.emplace(hash, views_.size() - 1);
  return views_.size() - 1;
}

std::size_t GlbBuilder::floats(std::span<const float> values, std::uint32_t components, Target target,
                               bool bounds) {
  constexpr std::array<const char*, 5> kTypes{"", "SCALAR", "VEC2", "VEC3", "VEC4"};
  json accessor = {{"bufferView", view(bytes_of(values), target)},
                   {"componentType", 5126},
                   {"count", values.size() / components},
                   {"type", kTypes[components]}};
  if (bounds) {
    std::vector<float> least(values.begin(), values.begin() + components), most = least;
    for (std::size_t i = components; i < values.size(); ++i) {
      float& low = least[i % components];
      float& high = most[i % components];
      low = std::min(low, values[i]);
      high = std::max(high, values[i]);
    }
    accessor["min"] = least;
    accessor["max"] = most;
  }
  return unique(accessors_, "accessor", accessor);
}

std::size_t GlbBuilder::indices(std::span<const std::uint32_t> values, std::size_t vertex_count) {
  const bool narrow = vertex_count <= 0xFFFF;  // 65535 itself means primitive restart
  std::size_t at = 0;
  if (narrow) {
    const std::vector<std::uint16_t> words(values.begin(), values.end());
    at = view(bytes_of(std::span<const std::uint16_t>(words)), Target::indices);
  } else {
    at = view(bytes_of(values), Target::indices);
  }
  return unique(accessors_, "accessor",
                {{"bufferView", at},
                 {"componentType", narrow ? 5123 : 5125},
                 {"count", values.size()},
                 {"type", "SCALAR"}});
}

std::size_t GlbBuilder::image(std::span<const std::uint8_t> bytes, std::string_view mime_type,
                              std::string_view name) {
  return unique(images_, "image",
                {{"bufferView", view(bytes, Target::none)}, {"mimeType", mime_type}, {"name", name}});
}

void GlbBuilder::write(gltf::ByteSink& sink) {
  binary_.resize((binary_.size() + 3) / 4 * 4);
  if (!binary_.empty()) root["buffers"] = json::array({{{"byteLength", binary_.size()}}});
  if (!views_.empty()) root["bufferViews"] = std::move(views_);
  if (!accessors_.empty()) root["accessors"] = std::move(accessors_);
  if (!images_.empty()) root["images"] = std::move(images_);

  gltf::ByteSink counter;
  gltf::TextOut(counter).tree(root);
  const std::uint64_t padding = (4 - counter.total() % 4) % 4;
  const std::uint64_t text_bytes = counter.total() + padding;
  std::vector<std::uint8_t> header;
  put_u32(header, 0x46546C67);  // "glTF"
  put_u32(header, 2);
  put_u32(header, 20 + text_bytes + (binary_.empty() ? 0 : 8 + binary_.size()));
  put_u32(header, text_bytes);
  put_u32(header, 0x4E4F534A);  // "JSON"
  sink.write(header.data(), header.size());
  gltf::TextOut(sink).tree(root);
  sink.fill(' ', padding);
  if (binary_.empty()) return;
  header.clear();
  put_u32(header, binary_.size());
  put_u32(header, 0x004E4942);  // "BIN"
  sink.write(header.data(), header.size());
  sink.write(binary_.data(), binary_.size());
}

}  // namespace scenegen::import
