// Instance, physical device and logical device; validation messages are collected here.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

#include "render/device_options.h"

namespace scenegen::render {

namespace vkr {

/// Messages of the validation layer; any thread of the driver may report.
struct MessageLog {
  std::mutex mutex;
  std::vector<std::string> messages;
};

struct Device {
  vk::raii::Context context;
  std::unique_ptr<MessageLog> log;  // outlives the instance
  vk::raii::Instance instance{nullptr};
  vk::raii::DebugUtilsMessengerEXT messenger{nullptr};
  vk::raii::PhysicalDevice physical{nullptr};
  vk::raii::Device device{nullptr};
  vk::raii::Queue queue{nullptr};
  std::uint32_t queue_family = 0;
  vk::PhysicalDeviceProperties properties;
  vk::PhysicalDeviceMemoryProperties memory_properties;
  DeviceInfo info;
  bool timestamps = false;
  bool conditional_rendering = false;
  bool indirect_nodes = false;  ///< many indirect draws a command, with a count and a first instance
  float max_anisotropy = 1.0F;

  /// Errors and warnings reported so far, and forgets them.
  [[nodiscard]] std::vector<std::string> take_messages();
};

/// Can a depth picture of so many samples be read in shaders?
[[nodiscard]] inline bool can_sample_depth(const Device& device, vk::SampleCountFlagBits samples) {
  return static_cast<bool>(device.properties.limits.sampledImageDepthSampleCounts & samples);
}

/// Errors are of kind no_device (or usage, for a --device that names none).
[[nodiscard]] Result<std::unique_ptr<Device>> open_device(const DeviceOptions& options);

}  // namespace vkr
}  // namespace scenegen::render
