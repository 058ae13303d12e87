// A Vulkan layer for tests, loaded like any other: the renderer and the programs know nothing of it. Calls
// that may fail are counted and made to fail; devices, extensions and features are hidden.
#pragma once

#include <vulkan/vulkan.h>
#include <cstdint>
#include <string>
#include <vector>

namespace scenegen::test {

/// For programs, by environment: "vkQueueSubmit:3:-4": the third call gives VK_ERROR_DEVICE_LOST. In place of
/// a name "any": of all calls that can fail.
constexpr const char* kFaultVariable = "SCENEGEN_TEST_FAULT";
/// Names separated by commas: of device extensions; "devices", "vulkan13", "synchronization2", "graphics",
/// "timestamps", "drawIndirectCount", "multiDrawIndirect".
constexpr const char* kLacksVariable = "SCENEGEN_TEST_LACKS";

/// A call that can fail, and from where it was made.
struct FaultSite {
  const char* call = "";
  std::uint64_t stack = 0;  ///< the same for the same place in the program, while it runs
};

/// What the layer of this process does. For one thread at a time.
struct FaultControl {
  std::uint64_t calls = 0;  ///< counted from the last reset()
  std::uint64_t fail_at = 0;
  VkResult result = VK_ERROR_OUT_OF_DEVICE_MEMORY;
  std::string only;         ///< name of the only call that is counted; empty: all
  const char* failed = "";  ///< the call that was made to fail
  bool record = false;      ///< fills `sites`, one a call
  std::vector<FaultSite> sites;
  std::string lacks;
  bool lost = false;  ///< a call gave VK_ERROR_DEVICE_LOST: all that wait or submit do from then on

  /// Counts from 0; the `n`th call fails (0: none).
  void reset(std::uint64_t n = 0, VkResult with = VK_ERROR_OUT_OF_DEVICE_MEMORY, std::string call = {}) {
    calls = 0;
    fail_at = n;
    result = with;
    only = std::move(call);
    failed = "";
    sites.clear();
    lost = false;
  }
};

/// True while the layer calls what lies below it, on this thread.
using FaultInside = bool (*)();

}  // namespace scenegen::test

extern "C" {
/// Exported by the layer, for who has loaded it with dlopen().
scenegen::test::FaultControl* scenegen_fault_control();
bool scenegen_fault_inside();
}
