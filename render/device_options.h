// Which Vulkan device to use, without Vulkan's headers.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "scene/result.h"

namespace scenegen::render {

struct DeviceOptions {
  std::string
      wanted;  ///< index, or part of the name (case does not matter); empty: a discrete GPU if there is one
  bool validation = false;  ///< Khronos validation layer with synchronization validation; an error without it
};

/// For tests: memory that is not there.
struct MemoryFaults {
  /// What the device seems to have, counting all that was ever taken; 0: no limit.
  std::uint64_t device_bytes = 0;
};

struct DeviceInfo {
  std::uint32_t index = 0;
  std::string name;
  std::string type;    ///< "discrete GPU", "integrated GPU", "virtual GPU", "CPU", "other"
  std::string driver;  ///< "NVIDIA 580.65.06"
  std::string uuid;    ///< 32 hexadecimal digits, the same for this device and driver in every process
  std::string lacks;   ///< why it cannot be used; empty when it can
};

/// Every Vulkan device there is, also those that cannot be used. Error (no_device): no Vulkan loader or
/// instance.
[[nodiscard]] Result<std::vector<DeviceInfo>> list_devices();

namespace vkr {
struct Device;
}
/// An open device that several renderers use in turn or side by side, all on one thread: drivers give out a
/// limited number of instances a process (NVIDIA's some twenty). Errors as of Renderer::create().
[[nodiscard]] Result<std::shared_ptr<vkr::Device>> share_device(const DeviceOptions& options);
[[nodiscard]] const DeviceInfo& info_of(const vkr::Device& device);

}  // namespace scenegen::render
