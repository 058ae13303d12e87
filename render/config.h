// Every limit and fixed size of the renderer in one place, each with what it costs.
#pragma once

#include <cstdint>

namespace scenegen::render {

// The most frames that may be in flight at once: each has a staging ring, a command pool and a set of
// readback buffers of its own.
constexpr std::uint32_t kMostFramesInFlight = 3;
// Device memory comes in blocks, as large as all before them of the same kind of memory, from the least to
// the most; what is larger than half of the next block gets one of its own. What is not used of a block is
// lost: with 64 MiB each that was 60 B an object of a million.
constexpr std::uint64_t kLeastMemoryBlockBytes = 1ULL << 20;
constexpr std::uint64_t kMostMemoryBlockBytes = 16ULL << 20;
// Staging for dirty records, per frame in flight; grows to what one frame needed.
constexpr std::uint64_t kStagingBytes = 1ULL << 20;
// Indirect draws of chunks come in blocks of this many, 20 B each.
constexpr std::uint32_t kIndirectBlockCommands = 1U << 16;
// Uploading geometry and textures goes through one buffer of this size.
constexpr std::uint64_t kUploadBytes = 32ULL << 20;
// Side of the shadow map: 4 B a texel, 36 MiB.
constexpr std::uint32_t kShadowMapSide = 3072;
// Textures above this side are halved until they fit: 4096^2 RGBA8 with mipmaps is 85 MiB.
constexpr std::uint32_t kMaxTextureSide = 8192;

}  // namespace scenegen::render
