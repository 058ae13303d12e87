#include "scene/gltf/accessor.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace scenegen::gltf::reading {

namespace {

constexpr std::uint32_t kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123,
                        kUnsignedInt = 5125, kFloat = 5126;

std::uint32_t component_bytes(std::uint32_t type) {
  switch (type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      return 0;
  }
}

template <class T>
T load(const std::uint8_t* from) {
  T out;
  std::memcpy(&out, from, sizeof(T));
  return out;
}

/// glTF 2.0, 3.6.2.2 and KHR_mesh_quantization.
template <class T>
void convert(const std::uint8_t* from, std::uint32_t components, bool normalized, float* to) {
  for (std::uint32_t i = 0; i < components; ++i) {
    const auto value = static_cast<float>(load<T>(from + i * sizeof(T)));
    to[i] = normalized ? std::max(value / static_cast<float>(std::numeric_limits<T>::max()), -1.0F) : value;
  }
}

void convert_element(const Accessor& a, const std::uint8_t* from, float* to) {
  switch (a.component_type) {
    case kFloat:
      std::memcpy(to, from, 4 * a.components);
      break;
    case kByte:
      convert<std::int8_t>(from, a.components, a.normalized, to);
      break;
    case kUnsignedByte:
      convert<std::uint8_t>(from, a.components, a.normalized, to);
      break;
    case kShort:
      convert<std::int16_t>(from, a.components, a.normalized, to);
      break;
    case kUnsignedShort:
      convert<std::uint16_t>(from, a.components, a.normalized, to);
      break;
    default:
      break;
  }
}

std::uint32_t load_integer(std::uint32_t type, const std::uint8_t* from) {
  if (type == kUnsignedByte) return *from;
  if (type == kUnsignedShort) return load<std::uint16_t>(from);
  return load<std::uint32_t>(from);
}

bool unsigned_integer(std::uint32_t type) {
  return type == kUnsignedByte || type == kUnsignedShort || type == kUnsignedInt;
}

/// No overflow below: offsets and counts are < 2^53, strides < 2^8.
void check_range(std::uint64_t offset, std::uint64_t count, std::uint64_t stride, std::uint64_t element,
                 const Bytes& view, const Place& at) {
  const std::uint64_t end = offset + (count - 1) * stride + element;
  if (end <= view.size()) return;
  reject(at, std::to_string(count) + " elements end at byte " + std::to_string(end) +
                 " of a buffer view of " + std::to_string(view.size()));
}

}  // namespace

const Accessor& Data::accessor(std::uint32_t index, const Place& at) const {
  check_index(index, document_.accessors.size(), "accessors", at);
  return document_.accessors[index];
}

Bytes Data::view(std::uint32_t index, const Place& at) const {
  check_index(index, document_.views.size(), "bufferViews", at);
  const BufferView& view = document_.views[index];
  const Place root;
  const Place views = root.key("bufferViews");
  const Place here = views.at(index);
  check_index(view.buffer, document_.buffers.size(), "buffers", here.key("buffer"));
  const Bytes buffer = buffers_[view.buffer];
  if (view.byte_offset > buffer.size() || view.byte_length > buffer.size() - view.byte_offset) {
    reject(here, std::to_string(view.byte_length) + " bytes from " + std::to_string(view.byte_offset) +
                     " on, in a buffer of " + std::to_string(buffer.size()));
  }
  if (view.byte_length == 0) reject(here.key("byteLength"), "missing or 0");
  return buffer.subspan(view.byte_offset, view.byte_length);
}

Data::Elements Data::elements(const Accessor& accessor, const Place& at) const {
  if (accessor.view == kNone) return {nullptr, accessor.count, 0};
  const Bytes bytes = view(accessor.view, at.key("bufferView"));
  const std::uint64_t element = std::uint64_t{component_bytes(accessor.component_type)} * accessor.components;
  const std::uint32_t given = document_.views[accessor.view].byte_stride;
  if (given != 0 && given < element) {
    reject(at,
           "elements of " + std::to_string(element) + " bytes at a byteStride of " + std::to_string(given));
  }
  const std::uint64_t stride = given == 0 ? element : given;
  check_range(accessor.byte_offset, accessor.count, stride, element, bytes, at);
  return {bytes.data() + accessor.byte_offset, accessor.count, stride};
}

/// read(element index, bytes) for every overridden element.
template <class Read>
void Data::apply_sparse(const Accessor& accessor, const Place& at, const Read& read) {
  if (accessor.sparse == kNone) return;
  const Sparse& sparse = document_.sparse[accessor.sparse];
  const Place here = at.key("sparse");
  if (sparse.count == 0 || sparse.count > accessor.count) {
    reject(here.key("count"),
           std::to_string(sparse.count) + " of " + std::to_string(accessor.count) + " elements");
  }
  if (!unsigned_integer(sparse.index_type)) {
    reject(here, "indices.componentType " + std::to_string(sparse.index_type) + " is none of 5121 5123 5125");
  }
  const std::uint64_t index_bytes = component_bytes(sparse.index_type);
  const std::uint64_t value_bytes =
      std::uint64_t{component_bytes(accessor.component_type)} * accessor.components;
  const Bytes indices = view(sparse.index_view, here.key("indices"));
  const Bytes values = view(sparse.value_view, here.key("values"));
  check_range(sparse.index_offset, sparse.count, index_bytes, index_bytes, indices, here.key("indices"));
  check_range(sparse.value_offset, sparse.count, value_bytes, value_bytes, values, here.key("values"));
  std::uint64_t least = 0;
  for (std::uint64_t i = 0; i < sparse.count; ++i) {
    const std::uint64_t index =
        load_integer(sparse.index_type, indices.data() + sparse.index_offset + i * index_bytes);
    if (index < least) reject(here.key("indices"), "not strictly increasing at element " + std::to_string(i));
    check_index(index, accessor.count, "elements", here.key("indices"));
    read(index, values.data() + sparse.value_offset + i * value_bytes);
    least = index + 1;
  }
}

std::vector<float> Data::floats(std::uint32_t index, std::uint32_t components, const Place& at) {
  const Accessor& a = accessor(index, at);
  const Place root;
  const Place list = root.key("accessors");
  const Place here = list.at(index);
  if (a.components != components) {
    reject(here.key("type"), std::to_string(a.components) + " components; " + at.str() + " wants " +
                                 std::to_string(components));
  }
  if (component_bytes(a.component_type) == 0 || a.component_type == kUnsignedInt) {
    reject(here.key("componentType"),
           std::to_string(a.component_type) + " is none of 5120 5121 5122 5123 5126");
  }
  const Elements from = elements(a, here);
  budget_.take(a.count * components * sizeof(float), here);
  std::vector<float> out(a.count * components);
  if (from.bytes != nullptr) {
    if (a.component_type == kFloat && from.stride == 4ULL * components) {
      std::memcpy(out.data(), from.bytes, out.size() * sizeof(float));
    } else {
      for (std::uint64_t i = 0; i < a.count; ++i)
        convert_element(a, from.bytes + i * from.stride, &out[i * components]);
    }
  }
  apply_sparse(a, here, [&](std::uint64_t i, const std::uint8_t* bytes) {
    convert_element(a, bytes, &out[i * components]);
  });
  for (std::uint64_t i = 0; i < out.size(); ++i) {
    if (!std::isfinite(out[i])) reject(here, "element " + std::to_string(i / components) + " is not finite");
  }
  return out;
}

std::vector<std::uint32_t> Data::integers(std::uint32_t index, const Place& at) {
  const Accessor& a = accessor(index, at);
  const Place root;
  const Place list = root.key("accessors");
  const Place here = list.at(index);
  if (a.components != 1) reject(here.key("type"), at.str() + " wants SCALAR");
  if (!unsigned_integer(a.component_type)) {
    reject(here.key("componentType"), std::to_string(a.component_type) + " is none of 5121 5123 5125");
  }
  const Elements from = elements(a, here);
  budget_.take(a.count * sizeof(std::uint32_t), here);
  std::vector<std::uint32_t> out(a.count);
  if (from.bytes != nullptr) {
    for (std::uint64_t i = 0; i < a.count; ++i)
      out[i] = load_integer(a.component_type, from.bytes + i * from.stride);
  }
  apply_sparse(a, here, [&](std::uint64_t i, const std::uint8_t* bytes) {
    out[i] = load_integer(a.component_type, bytes);
  });
  return out;
}

}  // namespace scenegen::gltf::reading
