// What the renderer's own memory is for, without Vulkan's headers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace scenegen::render {

enum class MemoryKind : std::uint8_t {
  geometry,  ///< vertices, indices (2.2)
  textures,  ///< (2.3)
  records,   ///< what shaders read of objects and materials (2.8), and the camera block
  timeline,  ///< what is played, and the player
  slots,     ///< draws, their boxes, the visible set
  octree,    ///< nodes and chunks (2.9)
  commands,  ///< what we keep about kept command buffers; not what the driver puts into them
  indirect,  ///< kept indirect draws
  queries,   ///< occlusion queries, predicates, what is known from them
  lists,     ///< of a frame: what is drawn, in which order
  staging,   ///< what is copied to the device at the start of a frame
  targets,   ///< pictures that are drawn into, the shadow map
  readback,  ///< pictures for the processor
  unused,    ///< of blocks taken from the driver, what nothing lies in
};
constexpr std::size_t kMemoryKinds = 14;
constexpr std::array<std::string_view, kMemoryKinds> kMemoryKindNames{
    "geometry", "textures", "records", "timeline", "slots",   "octree",   "commands",
    "indirect", "queries",  "lists",   "staging",  "targets", "readback", "unused"};

/// Not what depends on the scene's looks or the pictures' size. What drivers take for commands is in no kind.
[[nodiscard]] constexpr bool is_own(MemoryKind kind) {
  return kind != MemoryKind::geometry && kind != MemoryKind::textures && kind != MemoryKind::targets &&
         kind != MemoryKind::readback;
}

/// Bytes of one kind.
struct MemoryShare {
  std::uint64_t host = 0;     ///< heap of the process, and Vulkan's memory that is not the device's own
  std::uint64_t device = 0;   ///< in heaps of the device (of a software device, too)
  std::uint64_t spilled = 0;  ///< of `host`, what was meant for the device and did not fit (D 2.4)
  [[nodiscard]] std::uint64_t total() const { return host + device; }
};

/// Command buffers that are kept: what the driver holds for them, beside what the model says.
struct CommandMemoryReport {
  std::uint64_t buffers = 0;  ///< allocated
  std::uint64_t draws = 0;    ///< recorded in them, also in those that wait to be used again
  std::uint64_t driver = 0;   ///< bytes that the driver holds through allocation callbacks
  std::int64_t process =
      0;                 ///< bytes by which the process grew while they were recorded; if that is measured
  double predicted = 0;  ///< (2.6), bytes
  /// On a software device what the driver holds, which is all there is; else how the process grew. 0: not
  /// known.
  std::uint64_t measured = 0;
};

struct MemoryAccount {
  std::array<MemoryShare, kMemoryKinds> kinds;
  CommandMemoryReport commands;
  std::uint64_t objects = 0;

  [[nodiscard]] MemoryShare& operator[](MemoryKind kind) { return kinds[static_cast<std::size_t>(kind)]; }
  [[nodiscard]] const MemoryShare& operator[](MemoryKind kind) const {
    return kinds[static_cast<std::size_t>(kind)];
  }
  void add_host(MemoryKind kind, std::uint64_t bytes) { (*this)[kind].host += bytes; }

  /// Host and device, of all kinds that are our own.
  [[nodiscard]] std::uint64_t own_bytes() const {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < kMemoryKinds; ++i)
      sum += is_own(static_cast<MemoryKind>(i)) ? kinds[i].total() : 0;
    return sum;
  }
  [[nodiscard]] double bytes_per_object() const {
    return objects == 0 ? 0.0 : static_cast<double>(own_bytes()) / static_cast<double>(objects);
  }
  [[nodiscard]] std::uint64_t spilled_bytes() const {
    std::uint64_t sum = 0;
    for (const MemoryShare& share : kinds) sum += share.spilled;
    return sum;
  }
};

}  // namespace scenegen::render
