// The one way this program runs loops on several threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <thread>
#include <vector>

namespace scenegen {

/// Calls body(begin, end) on `threads` contiguous pieces of [0, count). The body must write only to its own
/// piece, so that the result does not depend on the number of threads. `threads` 0 means one per processor.
template <class Body>
void parallel_for(std::size_t count, unsigned threads, const Body& body) {
  if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
  constexpr std::size_t kLeastPiece = 4096;  // a thread costs about 20 us to start; smaller pieces do not pay
  const std::size_t pieces = std::clamp<std::size_t>(count / kLeastPiece, 1, threads);
  std::vector<std::jthread> workers;
  workers.reserve(pieces - 1);
  for (std::size_t i = 1; i < pieces; ++i) {
    workers.emplace_back([&body, count, pieces, i] { body(count * i / pieces, count * (i + 1) / pieces); });
  }
  body(std::size_t{0}, count / pieces);
}

}  // namespace scenegen
