#include "scene/gltf/write_dedup.h"

#include <algorithm>
#include <cstring>

#include "scene/random.h"

namespace scenegen::gltf {

std::uint64_t fast_hash(const void* bytes, std::size_t count, std::uint64_t seed) {
  const auto* at = static_cast<const unsigned char*>(bytes);
  std::uint64_t hash = mix64(seed ^ count);
  for (; count >= 8; count -= 8, at += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, at, 8);
    hash = mix64(hash ^ word);
  }
  if (count > 0) {
    std::uint64_t word = 0;
    std::memcpy(&word, at, count);
    hash = mix64(hash ^ word);
  }
  return hash;
}

std::uint32_t Dedup::insert(std::uint64_t hash) {
  const auto index = static_cast<std::uint32_t>(hashes_.size());
  hashes_.push_back(hash);
  if (hashes_.size() * 2 > slots_.size()) {
    slots_.assign(std::max<std::size_t>(16, slots_.size() * 2), kMissing);
    for (std::uint32_t i = 0; i <= index; ++i) place(i);
  } else {
    place(index);
  }
  return index;
}

void Dedup::place(std::uint32_t index) {
  std::size_t at = hashes_[index] & mask();
  while (slots_[at] != kMissing) at = (at + 1) & mask();
  slots_[at] = index;
}

}  // namespace scenegen::gltf
