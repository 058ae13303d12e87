// JSON text, streamed: the only place that turns numbers into text.
#pragma once

#include <charconv>
#include <concepts>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "scene/gltf/write_sink.h"

namespace scenegen::gltf {

/// Writes JSON to a sink. Punctuation is the caller's, except for the commas of List.
class TextOut {
 public:
  explicit TextOut(ByteSink& sink) : sink_(sink) {}

  void raw(std::string_view text) { sink_.write(text.data(), text.size()); }
  /// Shortest text that reads back as the same float32 (std::to_chars). Must be finite: JSON has no other
  /// numbers.
  void number(float value);
  void number(double value);
  void number(std::integral auto value) {
    char* to = sink_.reserve(24);
    sink_.commit(std::to_chars(to, to + 24, value).ptr);
  }
  /// Quoted and escaped; UTF-8 passes through.
  void string(std::string_view text);
  void numbers(const glm::vec3& v) { floats(&v.x, 3); }
  void numbers(const glm::vec4& v) { floats(&v.x, 4); }
  void numbers(const glm::quat& q) { numbers(glm::vec4(q.x, q.y, q.z, q.w)); }
  /// [a,b,…]
  void floats(const float* values, int count);
  /// A whole tree. Its floating numbers must come from float32: they are written as such.
  void tree(const nlohmann::json& value);

  ByteSink& sink() { return sink_; }

 private:
  ByteSink& sink_;
};

/// Commas between the elements of an array or object.
class Commas {
 public:
  explicit Commas(TextOut& out) : out_(out) {}
  TextOut& next() {
    if (!first_) out_.raw(",");
    first_ = false;
    return out_;
  }
  [[nodiscard]] bool empty() const { return first_; }

 private:
  TextOut& out_;
  bool first_ = true;
};

}  // namespace scenegen::gltf
