// Small glTF documents made by hand, for tests of the reader: data go into one buffer, as a data URI.
#pragma once

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace scenegen::testing {

inline std::string base64(const std::vector<std::uint8_t>& bytes) {
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = (word << 8) | (i + k < bytes.size() ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k > bytes.size() ? '=' : kAlphabet[(word >> (18 - 6 * k)) & 63U];
  }
  return out;
}

/// accessor(…) calls return indices; str() is the document with `members` ("\"nodes\":[…],…") added.
class GltfText {
 public:
  /// Accessor of its own tightly packed view; `extra` is more of the accessor's JSON
  /// (",\"normalized\":true").
  template <class T>
  std::size_t accessor(std::string_view type, std::uint64_t count, const std::vector<T>& values,
                       std::string_view extra = {}) {
    const std::size_t view = this->view(values);
    return accessor_on(std::to_string(view), component<T>(), type, count, extra);
  }
  std::size_t floats(std::string_view type, std::uint64_t count, const std::vector<float>& values) {
    return accessor(type, count, values);
  }
  std::size_t accessor_on(const std::string& view, int component_type, std::string_view type,
                          std::uint64_t count, std::string_view extra = {}) {
    accessors_ += accessors_.empty() ? "{" : ",{";
    if (!view.empty()) accessors_ += "\"bufferView\":" + view + ",";
    accessors_ += "\"componentType\":" + std::to_string(component_type) +
                  ",\"count\":" + std::to_string(count) + ",\"type\":\"" + std::string(type) + "\"" +
                  std::string(extra) + "}";
    return accessor_count_++;
  }
  template <class T>
  std::size_t view(const std::vector<T>& values, std::string_view extra = {}) {
    while (buffer_.size() % 4 != 0) buffer_.push_back(0);
    const std::size_t offset = buffer_.size();
    const std::size_t size = values.size() * sizeof(T);
    buffer_.resize(offset + size);
    if (size != 0) std::memcpy(buffer_.data() + offset, values.data(), size);
    views_ += (views_.empty() ? "{" : ",{") + std::string("\"buffer\":0,\"byteOffset\":") +
              std::to_string(offset) + ",\"byteLength\":" + std::to_string(size) + std::string(extra) + "}";
    return view_count_++;
  }
  /// A triangle: accessor of POSITION, and `members` of a mesh with it.
  std::string triangle_mesh() {
    const std::size_t positions = floats("VEC3", 3, {0, 0, 0, 1, 0, 0, 0, 1, 0});
    return R"("meshes":[{"primitives":[{"attributes":{"POSITION":)" + std::to_string(positions) + "}}]}]";
  }
  [[nodiscard]] std::string str(std::string_view members) const {
    std::string out = R"({"asset":{"version":"2.0"})";
    if (!buffer_.empty()) {
      out += R"(,"buffers":[{"byteLength":)" + std::to_string(buffer_.size()) +
             R"(,"uri":"data:application/octet-stream;base64,)" + base64(buffer_) + "\"}]";
    }
    if (!views_.empty()) out += ",\"bufferViews\":[" + views_ + "]";
    if (!accessors_.empty()) out += ",\"accessors\":[" + accessors_ + "]";
    if (!members.empty()) out += "," + std::string(members);
    return out + "}";
  }

 private:
  template <class T>
  static constexpr int component() {
    if (std::is_same_v<T, std::int8_t>) return 5120;
    if (std::is_same_v<T, std::uint8_t>) return 5121;
    if (std::is_same_v<T, std::int16_t>) return 5122;
    if (std::is_same_v<T, std::uint16_t>) return 5123;
    if (std::is_same_v<T, std::uint32_t>) return 5125;
    static_assert(sizeof(T) <= 4);
    return 5126;
  }
  std::vector<std::uint8_t> buffer_;
  std::string views_, accessors_;
  std::size_t view_count_ = 0, accessor_count_ = 0;
};

}  // namespace scenegen::testing
