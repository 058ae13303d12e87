#include "scene/gltf/write_text.h"

#include <cassert>
#include <cmath>
#include <nlohmann/json.hpp>

namespace scenegen::gltf {

void TextOut::number(float value) {
  assert(std::isfinite(value));
  char* to = sink_.reserve(32);
  sink_.commit(std::to_chars(to, to + 32, value).ptr);
}

void TextOut::number(double value) {
  assert(std::isfinite(value));
  char* to = sink_.reserve(40);
  sink_.commit(std::to_chars(to, to + 40, value).ptr);
}

void TextOut::floats(const float* values, int count) {
  raw("[");
  for (int i = 0; i < count; ++i) {
    if (i > 0) raw(",");
    number(values[i]);
  }
  raw("]");
}

void TextOut::string(std::string_view text) {
  raw("\"");
  std::size_t plain = 0;  // start of the run that needs no escape
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c >= 0x20 && c != '"' && c != '\\') continue;
    raw(text.substr(plain, i - plain));
    plain = i + 1;
    if (c == '"' || c == '\\') {
      const char escaped[2] = {'\\', text[i]};
      raw({escaped, 2});
    } else {
      constexpr std::string_view kHex = "0123456789abcdef";
      const char escaped[6] = {'\\', 'u', '0', '0', kHex[c >> 4], kHex[c & 15]};
      raw({escaped, 6});
    }
  }
  raw(text.substr(plain));
  raw("\"");
}

void TextOut::tree(const nlohmann::json& value) {
  Commas commas(*this);
  switch (value.type()) {
    case nlohmann::json::value_t::object:
      raw("{");
      for (const auto& [key, member] : value.items()) {
        commas.next().string(key);
        raw(":");
        tree(member);
      }
      raw("}");
      return;
    case nlohmann::json::value_t::array:
      raw("[");
      for (const nlohmann::json& element : value) {
        commas.next();
        tree(element);
      }
      raw("]");
      return;
    case nlohmann::json::value_t::string:
      return string(value.get_ref<const std::string&>());
    case nlohmann::json::value_t::boolean:
      return raw(value.get<bool>() ? "true" : "false");
    case nlohmann::json::value_t::number_integer:
      return number(value.get<std::int64_t>());
    case nlohmann::json::value_t::number_unsigned:
      return number(value.get<std::uint64_t>());
    case nlohmann::json::value_t::number_float:
      return number(value.get<float>());
    default:
      return raw("null");
  }
}

}  // namespace scenegen::gltf
