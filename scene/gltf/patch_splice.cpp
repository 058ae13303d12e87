#include "scene/gltf/patch_splice.h"

#include <algorithm>

namespace scenegen::gltf::patching {

std::string json_string(std::string_view text) {
  return text_of([&](TextOut& out) { out.string(text); });
}

void Splices::add(Span removed, std::string_view with, Part part) {
  list_.push_back({removed, texts_.size(), static_cast<std::uint32_t>(with.size()), part});
  texts_ += with;
}

void Splices::sort() {
  const auto before = [](const Splice& a, const Splice& b) { return a.removed.begin < b.removed.begin; };
  if (!std::is_sorted(list_.begin(), list_.end(), before))
    std::stable_sort(list_.begin(), list_.end(), before);
}

void Splices::emit(std::string_view text, Span span, TextOut& out,
                   const std::function<void(Part)>& emit_part) const {
  std::uint64_t at = span.begin;
  auto splice =
      std::lower_bound(list_.begin(), list_.end(), span.begin,
                       [](const Splice& s, std::uint64_t begin) { return s.removed.begin < begin; });
  for (; splice != list_.end() && splice->removed.begin < span.end && !out.sink().failed(); ++splice) {
    out.raw(text.substr(at, splice->removed.begin - at));
    out.raw(std::string_view(texts_).substr(splice->text, splice->length));
    if (splice->part != Part::none && emit_part) emit_part(splice->part);
    at = std::max(at, splice->removed.end);
  }
  out.raw(text.substr(at, span.end - at));
}

void ItemList::remove_runs(Splices& splices) const {
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!items[i].removed) continue;
    std::size_t last = i;
    while (last + 1 < items.size() && items[last + 1].removed) ++last;
    Span gone{items[i].whole.begin, items[last].whole.end};
    if (last + 1 < items.size()) {
      gone.end = items[last + 1].whole.begin;  // with the comma behind
    } else if (i > 0) {
      gone.begin = items[i - 1].whole.end;  // with the comma before
    }
    splices.replace(gone, {});
    i = last;
  }
}

void ItemList::append(std::string_view added, Part part, Splices& splices) const {
  const bool any_left = std::any_of(items.begin(), items.end(), [](const Item& i) { return !i.removed; });
  const std::uint64_t at = items.empty() ? brackets.begin + 1 : items.back().whole.end;
  if (any_left) splices.insert(at, ",");
  splices.insert(at, added, part);
}

void ItemList::splice(std::string_view added, Splices& splices) const {
  remove_runs(splices);
  if (!added.empty()) append(added, Part::none, splices);
}

}  // namespace scenegen::gltf::patching
