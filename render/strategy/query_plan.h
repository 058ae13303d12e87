// What to draw and to ask in a pass.
#pragma once

#include <cstdint>
#include <vector>

#include "render/passes/occlusion.h"

namespace scenegen::render {

/// Room for `count`, and half as much again if it has to grow: what is asked differs from frame to frame, and
/// a list that grew as it filled up would still grow long after.
template <class T>
void make_room(std::vector<T>& list, std::size_t count) {
  if (list.capacity() < count) list.reserve(count + count / 2);
}

struct QueryPlan {
  std::vector<std::uint32_t> first;   ///< chunks to draw whatever the answers are
  std::vector<std::uint32_t> second;  ///< chunks believed hidden, each governed by one of `asked`
  std::vector<Asked> asked;
  std::vector<Governed> governed;  ///< as `second`, with the query
  std::uint32_t queries = 0;       ///< that `asked` takes
  /// Index of its query.
  std::uint32_t ask(const Asked& what) {
    asked.push_back(what);
    if (!what.with_previous) ++queries;
    return queries - 1;
  }
  /// Empties it, with room for a frame with so many chunks.
  void clear(std::size_t chunks) {
    for (std::vector<std::uint32_t>* list : {&first, &second}) make_room(*list, chunks);
    make_room(asked, chunks);
    make_room(governed, chunks);
    first.clear();
    second.clear();
    asked.clear();
    governed.clear();
    queries = 0;
  }
};

}  // namespace scenegen::render
