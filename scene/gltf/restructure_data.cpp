#include "scene/gltf/restructure_data.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

namespace scenegen::gltf {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kArrayBuffer = 34962, kElementArrayBuffer = 34963;

[[noreturn]] void reject(const std::string& where, const std::string& what) {
  throw RestructureFault{where, what};
}

/// A member that is a whole number of at most 2^53.
std::uint64_t whole(const Json& object, const char* key, std::uint64_t otherwise, const std::string& at) {
  const auto found = object.find(key);
  if (found == object.end()) return otherwise;
  if (!found->is_number_unsigned() || found->get<std::uint64_t>() > (1ULL << 53))
    reject(at + "/" + key, "is no whole number");
  return found->get<std::uint64_t>();
}

std::uint32_t component_bytes(std::uint64_t type, const std::string& at) {
  switch (type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      reject(at + "/componentType", "is none of 5120 5121 5122 5123 5125 5126");
  }
}

std::uint32_t components(const Json& accessor, const std::string& at) {
  const std::string type = accessor.value("type", "");
  constexpr std::pair<const char*, std::uint32_t> kTypes[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
  for (const auto& [name, count] : kTypes) {
    if (type == name) return count;
  }
  reject(at + "/type", "a vertex attribute is SCALAR, VEC2, VEC3 or VEC4");
}

std::uint64_t read_index(const std::uint8_t* from, std::uint32_t bytes) {
  std::uint64_t out = 0;
  std::memcpy(&out, from, bytes);  // little-endian, as the machines we build for
  return out;
}

template <class T>
double as_double(const std::uint8_t* from) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return static_cast<double>(value);
}

double component(const std::uint8_t* from, std::uint64_t type) {
  switch (type) {
    case 5120:
      return as_double<std::int8_t>(from);
    case 5121:
      return as_double<std::uint8_t>(from);
    case 5122:
      return as_double<std::int16_t>(from);
    case 5123:
      return as_double<std::uint16_t>(from);
    case 5125:
      return as_double<std::uint32_t>(from);
    default:
      return as_double<float>(from);
  }
}

/// min and max over the elements `vertices`, as numbers of the accessor's own type.
void put_bounds(const std::vector<std::uint8_t>& bytes, std::uint32_t element_bytes, std::uint32_t count,
                const std::vector<std::uint32_t>& vertices, Json& accessor) {
  const auto type = accessor["componentType"].get<std::uint64_t>();
  const std::uint32_t step = element_bytes / count;
  Json least = Json::array();
  Json most = Json::array();
  for (std::uint32_t k = 0; k < count; ++k) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const std::uint32_t v : vertices) {
      const double value = component(&bytes[std::size_t{v} * element_bytes + std::size_t{k} * step], type);
      low = std::min(low, value);
      high = std::max(high, value);
    }
    if (type == 5126) {
      least.push_back(low);
      most.push_back(high);
    } else {
      least.push_back(static_cast<std::int64_t>(low));
      most.push_back(static_cast<std::int64_t>(high));
    }
  }
  accessor["min"] = std::move(least);
  accessor["max"] = std::move(most);
}

}  // namespace

std::pair<const std::uint8_t*, std::uint64_t> PartData::view(std::uint64_t index,
                                                             const std::string& at) const {
  const Json& views = document_["bufferViews"];
  if (!views.is_array() || index >= views.size()) reject(at, "names a buffer view that is not there");
  const std::string here = "/bufferViews/" + std::to_string(index);
  const std::uint64_t buffer = whole(views[index], "buffer", 0, here);
  const std::uint64_t offset = whole(views[index], "byteOffset", 0, here);
  const std::uint64_t length = whole(views[index], "byteLength", 0, here);
  if (buffer >= source_.buffers.size()) reject(here + "/buffer", "names a buffer that is not there");
  const auto& bytes = source_.buffers[buffer];
  if (offset > bytes.size() || length > bytes.size() - offset) reject(here, "reaches beyond its buffer");
  return {bytes.data() + offset, length};
}

std::uint32_t PartData::stride(std::uint64_t index) const {
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>(whole(document_["bufferViews"][index], "byteStride", 0, "/bufferViews"), 252));
}

void PartData::apply_sparse(const Json& sparse, const std::string& at, Elements& out) const {
  const std::uint64_t count = whole(sparse, "count", 0, at);
  const Json& from = sparse.at("indices");
  const Json& values = sparse.at("values");
  const std::uint32_t index_bytes = component_bytes(whole(from, "componentType", 0, at), at);
  const auto [index_view, index_length] = view(whole(from, "bufferView", 0, at), at);
  const auto [value_view, value_length] = view(whole(values, "bufferView", 0, at), at);
  const std::uint64_t index_offset = whole(from, "byteOffset", 0, at);
  const std::uint64_t value_offset = whole(values, "byteOffset", 0, at);
  if (count > out.count || index_offset + count * index_bytes > index_length ||
      value_offset + count * out.size > value_length) {
    reject(at, "reaches beyond its data");
  }
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t to = read_index(index_view + index_offset + i * index_bytes, index_bytes);
    if (to >= out.count) reject(at + "/indices", "names an element that is not there");
    std::memcpy(&out.bytes[to * out.size], value_view + value_offset + i * out.size, out.size);
  }
}

PartData::Elements PartData::load(std::size_t index) const {
  const Json& accessors = document_["accessors"];
  const std::string at = "/accessors/" + std::to_string(index);
  if (!accessors.is_array() || index >= accessors.size()) reject(at, "is not there");
  const Json& accessor = accessors[index];
  Elements out;
  out.size = components(accessor, at) * component_bytes(whole(accessor, "componentType", 0, at), at);
  out.count = whole(accessor, "count", 0, at);
  if (const auto found = accessor.find("bufferView"); found != accessor.end()) {
    const std::uint64_t number = whole(accessor, "bufferView", 0, at);
    const auto [bytes, length] = view(number, at + "/bufferView");
    const std::uint64_t offset = whole(accessor, "byteOffset", 0, at);
    const std::uint64_t step = stride(number) == 0 ? out.size : stride(number);
    if (out.count == 0 || step < out.size || offset > length ||
        (out.count - 1) * step + out.size > length - offset)
      reject(at, "reaches beyond its buffer view");
    out.bytes.resize(out.count * out.size);
    for (std::uint64_t i = 0; i < out.count; ++i)
      std::memcpy(&out.bytes[i * out.size], bytes + offset + i * step, out.size);
  } else {
    constexpr std::uint64_t kMostZeros = 1ULL << 28;  // no data stand behind them
    if (out.count > kMostZeros) reject(at + "/count", "too many elements without a buffer view");
    out.bytes.resize(out.count * out.size);
  }
  if (accessor.contains("sparse")) apply_sparse(accessor["sparse"], at + "/sparse", out);
  return out;
}

const PartData::Elements& PartData::elements(std::size_t index) {
  const auto found = cache_.find(index);
  return found != cache_.end() ? found->second : cache_.emplace(index, load(index)).first->second;
}

PartData::NewView& PartData::view_for(std::uint32_t element_stride, std::uint32_t target) {
  for (NewView& known : views_) {
    if (known.stride == element_stride && known.target == target) return known;
  }
  Json& views = document_["bufferViews"];
  views.push_back(Json::object());
  return views_.emplace_back(NewView{views.size() - 1, element_stride, target, {}});
}

std::size_t PartData::add(Json accessor, NewView& view) {
  accessor["bufferView"] = view.index;
  Json& accessors = document_["accessors"];
  accessors.push_back(std::move(accessor));
  return accessors.size() - 1;
}

std::size_t PartData::gather(std::size_t index, const std::vector<std::uint32_t>& vertices) {
  const Elements& from = elements(index);
  for (const std::uint32_t v : vertices) {
    if (v >= from.count)
      reject("/accessors/" + std::to_string(index),
             "has " + std::to_string(from.count) + " elements, a vertex is " + std::to_string(v));
  }
  Json accessor = document_["accessors"][index];
  const bool bounds = accessor.contains("min") || accessor.contains("max");
  for (const char* key : {"sparse", "byteOffset", "min", "max"}) accessor.erase(key);
  accessor["count"] = vertices.size();
  const std::uint32_t padded = (from.size + 3) / 4 * 4;
  NewView& to = view_for(padded, kArrayBuffer);
  accessor["byteOffset"] = to.bytes.size();
  if (bounds)
    put_bounds(from.bytes, from.size, components(accessor, "/accessors/" + std::to_string(index)), vertices,
               accessor);
  for (const std::uint32_t v : vertices) {
    const std::uint8_t* const element = &from.bytes[std::size_t{v} * from.size];
    to.bytes.insert(to.bytes.end(), element, element + from.size);
    to.bytes.resize(to.bytes.size() + padded - from.size);
  }
  return add(std::move(accessor), to);
}

std::size_t PartData::gather_floats(const float* values, std::uint32_t count, bool bounds,
                                    const std::vector<std::uint32_t>& vertices) {
  constexpr std::array<const char*, 5> kTypes{"", "SCALAR", "VEC2", "VEC3", "VEC4"};
  const std::uint32_t size = 4 * count;
  NewView& to = view_for(size, kArrayBuffer);
  Json accessor = {{"byteOffset", to.bytes.size()},
                   {"componentType", 5126},
                   {"count", vertices.size()},
                   {"type", kTypes[count]}};
  std::vector<std::uint8_t> gathered(vertices.size() * size);
  std::vector<std::uint32_t> all(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    std::memcpy(&gathered[i * size], values + std::size_t{vertices[i]} * count, size);
    all[i] = static_cast<std::uint32_t>(i);
  }
  if (bounds) put_bounds(gathered, size, count, all, accessor);
  to.bytes.insert(to.bytes.end(), gathered.begin(), gathered.end());
  return add(std::move(accessor), to);
}

std::size_t PartData::indices(const std::vector<std::uint32_t>& values, std::size_t vertex_count) {
  const bool narrow = vertex_count <= 0xFFFF;  // 65535 itself means primitive restart
  NewView& to = view_for(narrow ? 2 : 4, kElementArrayBuffer);
  Json accessor = {{"byteOffset", to.bytes.size()},
                   {"componentType", narrow ? 5123 : 5125},
                   {"count", values.size()},
                   {"type", "SCALAR"}};
  for (const std::uint32_t v : values) {
    for (int shift = 0; shift < (narrow ? 16 : 32); shift += 8)
      to.bytes.push_back(static_cast<std::uint8_t>(v >> shift));
  }
  return add(std::move(accessor), to);
}

std::vector<std::uint8_t> PartData::finish() {
  std::vector<std::uint8_t> out;
  if (!source_.buffers.empty()) out = source_.buffers[0];
  Json& views = document_["bufferViews"];
  for (const NewView& view : views_) {
    out.resize((out.size() + 3) / 4 * 4);
    Json made = {{"buffer", 0}, {"byteOffset", out.size()}, {"byteLength", view.bytes.size()}};
    if (view.target == kArrayBuffer) made["byteStride"] = view.stride;
    made["target"] = view.target;
    views[view.index] = std::move(made);
    out.insert(out.end(), view.bytes.begin(), view.bytes.end());
  }
  return out;
}

}  // namespace scenegen::gltf
