// Counter-based randomness: value = f(seed, purpose, index). Independent of call order and of threads, and
// the same on every platform (no std:: distribution, whose results the standard leaves open).
#pragma once

#include <cstdint>
#include <string_view>

namespace scenegen {

/// Finaliser of SplitMix64 (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators").
constexpr std::uint64_t mix64(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// FNV-1a-64 of a byte string; also names the purposes of random numbers.
constexpr std::uint64_t fnv1a64(std::string_view bytes, std::uint64_t hash = 0xcbf29ce484222325ULL) {
  for (const char c : bytes) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3ULL;
  }
  return hash;
}

/// A stream of random numbers for one purpose ("brick tint", "displacement"), addressed by index.
class Random {
 public:
  constexpr Random(std::uint64_t seed, std::string_view purpose) : key_(mix64(seed ^ fnv1a64(purpose))) {}

  /// 64 uniform bits.
  [[nodiscard]] constexpr std::uint64_t bits(std::uint64_t index) const { return mix64(key_ ^ mix64(index)); }
  /// Uniform integer in [0, n), n > 0, by multiply-shift (Lemire 2019); bias < n / 2^64.
  [[nodiscard]] constexpr std::uint64_t below(std::uint64_t index, std::uint64_t n) const {
    __extension__ using Wide = unsigned __int128;
    return static_cast<std::uint64_t>((static_cast<Wide>(bits(index)) * n) >> 64);
  }
  /// Uniform in [0, 1), 24 bits: exact in float on every machine.
  [[nodiscard]] constexpr float unit(std::uint64_t index) const {
    return static_cast<float>(bits(index) >> 40) * 0x1.0p-24F;
  }

 private:
  std::uint64_t key_;
};

}  // namespace scenegen
