#include "scene/gltf/fault.h"

namespace scenegen::gltf::reading {

std::string Place::str() const {
  if (up == nullptr) return {};
  std::string out = up->str();
  out += '/';
  if (name.data() == nullptr) return out + std::to_string(index);
  for (const char c : printable(name)) {  // RFC 6901
    if (c == '~') {
      out += "~0";
    } else if (c == '/') {
      out += "~1";
    } else {
      out += c;
    }
  }
  return out;
}

void reject(const Place& at, std::string what, ErrorKind kind) {
  throw Fault{Error{kind, at.str(), std::move(what)}};
}

std::string printable(std::string_view text, std::size_t most) {
  std::string out;
  for (const char c : text) {
    if (out.size() >= most) return out + "...";
    const auto byte = static_cast<unsigned char>(c);
    out += byte < 0x20 || byte == 0x7F ? '?' : c;
  }
  return out;
}

void check_index(std::uint64_t index, std::uint64_t count, std::string_view kind, const Place& at) {
  if (index < count) return;
  reject(at, "index " + std::to_string(index) + " of " + std::to_string(count) + " " + std::string(kind));
}

}  // namespace scenegen::gltf::reading
