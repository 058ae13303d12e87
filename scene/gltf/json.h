// The few things the reader asks of simdjson (on demand: one pass over the text, nothing built). Private to
// scene/gltf.
#pragma once

#include <simdjson.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

#include "scene/gltf/fault.h"

namespace scenegen::gltf::reading {

using Value = simdjson::ondemand::value;

[[noreturn]] void reject_json(const Place& at, simdjson::error_code code, std::string_view wanted);

/// A string of the document. A view into the text where it holds no escape, else into the parser's own
/// buffer, which dies with the parser.
[[nodiscard]] std::string_view get_string(Value& value, const Place& at);
[[nodiscard]] bool get_bool(Value& value, const Place& at);
/// Integer in [0, 2^63); `most` is named in the error.
[[nodiscard]] std::uint64_t get_count(Value& value, const Place& at, std::uint64_t most = (1ULL << 53) - 1);
/// Index into an array: [0, 2^32 - 2].
[[nodiscard]] std::uint32_t get_index(Value& value, const Place& at);
/// Finite number.
[[nodiscard]] double get_double(Value& value, const Place& at);
/// Number that is finite as a float32.
[[nodiscard]] float get_float(Value& value, const Place& at);
[[nodiscard]] bool is_object(Value& value);

/// Calls f(key, value, place) for every member of an object.
template <class F>
void each_field(simdjson::ondemand::object object, const Place& at, F&& f) {
  for (auto entry : object) {
    simdjson::ondemand::field field;
    if (const auto code = std::move(entry).get(field); code != simdjson::SUCCESS)
      reject_json(at, code, "an object");
    const char* const raw = field.key().raw();
    const char* end = raw;
    while (*end != '"' && *end != '\\') ++end;  // stage 1 has seen the closing quote
    std::string_view key(raw, static_cast<std::size_t>(end - raw));
    if (*end == '\\') {
      if (const auto code = field.unescaped_key().get(key); code != simdjson::SUCCESS)
        reject_json(at, code, "a key");
    }
    f(key, field.value(), at.key(key));
  }
}

template <class F>
void each_field(Value value, const Place& at, F&& f) {
  simdjson::ondemand::object object;
  if (const auto code = value.get_object().get(object); code != simdjson::SUCCESS)
    reject_json(at, code, "an object");
  each_field(object, at, std::forward<F>(f));
}

/// Calls f(value, place) for every element of an array; returns their number.
template <class F>
std::uint64_t each_element(Value value, const Place& at, F&& f) {
  simdjson::ondemand::array array;
  if (const auto code = value.get_array().get(array); code != simdjson::SUCCESS)
    reject_json(at, code, "an array");
  std::uint64_t index = 0;
  for (auto entry : array) {
    Value element;
    if (const auto code = entry.get(element); code != simdjson::SUCCESS) reject_json(at, code, "an array");
    f(element, at.at(index));
    ++index;
  }
  return index;
}

/// Array of exactly N finite numbers.
template <std::size_t N>
std::array<float, N> get_floats(Value value, const Place& at) {
  std::array<float, N> out{};
  const std::uint64_t count = each_element(value, at, [&](Value& element, const Place& place) {
    if (place.index < N) out[place.index] = get_float(element, place);
  });
  if (count != N) reject(at, std::to_string(count) + " numbers; wanted " + std::to_string(N));
  return out;
}

}  // namespace scenegen::gltf::reading
