// Every limit of the program in one place, each with what it costs. A number in a file or an argument above
// its limit is an error that names the limit; nothing is allocated from an unchecked number.
#pragma once

#include <cstdint>

namespace scenegen::limits {

// Objects: about 90 B each in Scene (40 transform, 16 ids, 4 name offset, ~30 name), so 9 GB at the limit.
constexpr std::uint64_t kMaxObjects = 100'000'000;
// Cells of the appearance grid: 4 B each for ranks while times are assigned (512 MB at the limit, 512^3).
constexpr std::uint64_t kMaxCells = 1ULL << 27;
constexpr std::uint32_t kMaxCellsPerAxis = 1024;
// Seeds are written to JSON as numbers; above 2^53 JavaScript readers would round them.
constexpr std::uint64_t kMaxSeed = (1ULL << 53) - 1;
// Files: a .glb's length field is 32 bits.
constexpr std::uint64_t kMaxGlbBytes = 0xFFFFFFFFULL;
// Vertices of one mesh of layout merged: indices have 32 bits, of which glTF keeps the last.
constexpr std::uint64_t kMaxMergedVertices = 0xFFFFFFFFULL;
constexpr std::uint64_t kMaxJsonBytes = 0xFFFFFFFFULL;  // simdjson's own limit
// Node hierarchies deeper than this are refused: readers of other people recurse.
constexpr std::uint32_t kMaxNodeDepth = 512;
// Images are decoded only to be drawn; 16384^2 RGBA8 is 1 GiB.
constexpr std::uint32_t kMaxImageSide = 16384;
// Output pictures: 16384^2 is the largest attachment of lavapipe.
constexpr std::uint32_t kMaxFrameSide = 16384;
constexpr std::uint32_t kMaxThreads = 256;
// Plans: as XML, elements cost up to 16 times their text in memory (1 GiB at the limit). A task of MS Project
// takes 2 to 5 kB.
constexpr std::uint64_t kMaxPlanBytes = 64ULL << 20;
constexpr std::uint64_t kMaxTasks = 1'000'000;
// Pairs of a task and an object that it is about: 12 B each while tasks are mapped (600 MB at the limit, and
// as much again for activities).
constexpr std::uint64_t kMaxClaims = 50'000'000;

}  // namespace scenegen::limits
