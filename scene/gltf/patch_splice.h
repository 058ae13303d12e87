// Changes of a JSON text at byte offsets; everything between them stays as it is. Private to scene/gltf.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/gltf/write_text.h"

namespace scenegen::gltf::patching {

/// What `emit` writes.
template <class Emit>
std::string text_of(const Emit& emit) {
  std::string text;
  ByteSink sink(text);
  TextOut out(sink);
  emit(out);
  sink.flush();
  return text;
}
[[nodiscard]] std::string json_string(std::string_view text);

/// [begin, end) in the source text.
struct Span {
  std::uint64_t begin = 0, end = 0;
  [[nodiscard]] bool empty() const { return begin == end; }
};

/// Longer texts that are made while they are written.
enum class Part : std::uint8_t { none, new_nodes, accessors, views, animation };

class Splices {
 public:
  void replace(Span what, std::string_view with) { add(what, with, Part::none); }
  void insert(std::uint64_t at, std::string_view text) { add({at, at}, text, Part::none); }
  /// `part` behind `text`.
  void insert(std::uint64_t at, std::string_view text, Part part) { add({at, at}, text, part); }
  /// Before emit(). Insertions at one place keep their order.
  void sort();
  /// text[span] with the changes inside it.
  void emit(std::string_view text, Span span, TextOut& out,
            const std::function<void(Part)>& emit_part = {}) const;
  [[nodiscard]] bool empty() const { return list_.empty(); }

 private:
  struct Splice {
    Span removed;
    std::uint64_t text = 0;  ///< into texts_
    std::uint32_t length = 0;
    Part part = Part::none;
  };
  void add(Span removed, std::string_view with, Part part);

  std::vector<Splice> list_;
  std::string texts_;
};

/// The members of an object or the elements of an array as the text has them, and what is to become of them.
class ItemList {
 public:
  struct Item {
    Span whole;               ///< key and value, without comma
    std::uint64_t value = 0;  ///< where the value begins
    bool removed = false;
    [[nodiscard]] Span value_span() const { return {value, whole.end}; }
  };
  std::vector<Item> items;
  Span brackets;  ///< the whole object or array

  /// Splices that take out what is `removed` and put `added` (`"a":1,"b":2`) behind the last item.
  void splice(std::string_view added, Splices& splices) const;
  /// The same for a part that is made while it is written.
  void append(std::string_view added, Part part, Splices& splices) const;

 private:
  void remove_runs(Splices& splices) const;
};

}  // namespace scenegen::gltf::patching
