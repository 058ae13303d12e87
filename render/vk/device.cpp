#include "render/vk/device.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <optional>

namespace scenegen::render {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

std::string lower(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return s;
}

std::string_view type_name(vk::PhysicalDeviceType type) {
  switch (type) {
    case vk::PhysicalDeviceType::eDiscreteGpu:
      return "discrete GPU";
    case vk::PhysicalDeviceType::eIntegratedGpu:
      return "integrated GPU";
    case vk::PhysicalDeviceType::eVirtualGpu:
      return "virtual GPU";
    case vk::PhysicalDeviceType::eCpu:
      return "CPU";
    default:
      return "other";
  }
}

std::optional<std::uint32_t> graphics_family(const vk::raii::PhysicalDevice& physical) {
  const auto families = physical.getQueueFamilyProperties();
  for (std::uint32_t i = 0; i < families.size(); ++i) {
    if (families[i].queueFlags & vk::QueueFlagBits::eGraphics) return i;
  }
  return std::nullopt;
}

DeviceInfo describe(const vk::raii::PhysicalDevice& physical, std::uint32_t index) {
  const auto chain =
      physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties,
                              vk::PhysicalDeviceIDProperties>();
  const auto& properties = chain.get<vk::PhysicalDeviceProperties2>().properties;
  const auto& driver = chain.get<vk::PhysicalDeviceDriverProperties>();
  DeviceInfo info;
  info.index = index;
  info.name = properties.deviceName.data();
  info.type = type_name(properties.deviceType);
  info.driver = std::string(driver.driverName.data()) + " " + driver.driverInfo.data();
  for (const std::uint8_t byte : chain.get<vk::PhysicalDeviceIDProperties>().deviceUUID) {
    constexpr const char* kDigits = "0123456789abcdef";
    info.uuid += {kDigits[byte >> 4], kDigits[byte & 15]};
  }
  if (properties.apiVersion < VK_API_VERSION_1_3) {
    info.lacks = "Vulkan 1.3";
    return info;
  }
  const auto features =
      physical.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan13Features>();
  if (features.get<vk::PhysicalDeviceVulkan13Features>().synchronization2 == VK_FALSE)
    info.lacks = "synchronization2";
  if (!graphics_family(physical)) info.lacks = "a graphics queue";
  return info;
}

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT /*severity*/,
                                          VkDebugUtilsMessageTypeFlagsEXT /*types*/,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  // Messages of loader and drivers, not about how we use Vulkan; by id.
  static constexpr std::array kAllowed{"Loader Message"};
  // Mesa 22.3 puts its source line in place of an id. It does not know `invariant` on members of
  // gl_PerVertex, where glslang must put it; its code for one shader source is the same in every pipeline all
  // the same (the tests compare bits).
  if (std::strstr(data->pMessage, "Decoration not allowed on struct members: SpvDecorationInvariant") !=
      nullptr)
    return VK_FALSE;
  const char* id = data->pMessageIdName != nullptr ? data->pMessageIdName : "";
  for (const char* allowed : kAllowed) {
    if (std::strcmp(id, allowed) == 0) return VK_FALSE;
  }
  auto* log = static_cast<vkr::MessageLog*>(user);
  const std::lock_guard lock(log->mutex);
  constexpr std::size_t kMost = 100;
  if (log->messages.size() < kMost) log->messages.push_back(std::string(id) + ": " + data->pMessage);
  return VK_FALSE;
}

Error no_device(std::string what) {
  return {ErrorKind::no_device, "Vulkan", std::move(what)};
}

vk::raii::Instance make_instance(const vk::raii::Context& context, bool validation) {
  const vk::ApplicationInfo app("sceneplay", 1, "scenegen", 1, VK_API_VERSION_1_3);
  const std::array enabled{vk::ValidationFeatureEnableEXT::eSynchronizationValidation};
  const vk::ValidationFeaturesEXT features(enabled);
  vk::InstanceCreateInfo create({}, &app);
  std::vector<const char*> extensions;
  if (validation) {
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    create.setPEnabledLayerNames(kValidationLayer).setPNext(&features);
  }
  create.setPEnabledExtensionNames(extensions);
  return {context, create};
}

bool has_validation_layer(const vk::raii::Context& context) {
  const auto layers = context.enumerateInstanceLayerProperties();
  return std::any_of(layers.begin(), layers.end(), [](const vk::LayerProperties& layer) {
    return std::strcmp(layer.layerName, kValidationLayer) == 0;
  });
}

int preference(const vk::raii::PhysicalDevice& physical) {
  switch (physical.getProperties().deviceType) {
    case vk::PhysicalDeviceType::eDiscreteGpu:
      return 4;
    case vk::PhysicalDeviceType::eIntegratedGpu:
      return 3;
    case vk::PhysicalDeviceType::eVirtualGpu:
      return 2;
    case vk::PhysicalDeviceType::eCpu:
      return 1;
    default:
      return 0;
  }
}

std::string names(const std::vector<DeviceInfo>& infos) {
  std::string out;
  for (const DeviceInfo& info : infos)
    out += (out.empty() ? "" : ", ") + std::to_string(info.index) + " '" + info.name + "'";
  return out;
}

/// Index of the device to take.
Result<std::size_t> choose(const std::vector<vk::raii::PhysicalDevice>& all,
                           const std::vector<DeviceInfo>& infos, const std::string& wanted) {
  std::optional<std::size_t> best;
  const bool by_index = !wanted.empty() && std::all_of(wanted.begin(), wanted.end(),
                                                       [](unsigned char c) { return std::isdigit(c) != 0; });
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool match =
        wanted.empty() || (by_index ? std::to_string(i) == wanted
                                    : lower(infos[i].name).find(lower(wanted)) != std::string::npos);
    if (!match) continue;
    const bool better = !best || (!infos[*best].lacks.empty() && infos[i].lacks.empty()) ||
                        (infos[i].lacks.empty() && preference(all[i]) > preference(all[*best]));
    if (better) best = i;
  }
  if (!best && all.empty())
    return tl::unexpected(no_device("no device found (Debian: mesa-vulkan-drivers has a software one)"));
  if (!best)
    return fail(ErrorKind::usage, "--device", "no device matches '" + wanted + "'; there is " + names(infos));
  if (!infos[*best].lacks.empty())
    return tl::unexpected(no_device("device '" + infos[*best].name + "' lacks " + infos[*best].lacks));
  return *best;
}

bool has_conditional_rendering(const vk::raii::PhysicalDevice& physical) {
  const auto extensions = physical.enumerateDeviceExtensionProperties();
  const bool known = std::any_of(extensions.begin(), extensions.end(), [](const vk::ExtensionProperties& e) {
    return std::strcmp(e.extensionName, VK_EXT_CONDITIONAL_RENDERING_EXTENSION_NAME) == 0;
  });
  if (!known) return false;
  const auto features =
      physical.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceConditionalRenderingFeaturesEXT>();
  return features.get<vk::PhysicalDeviceConditionalRenderingFeaturesEXT>().conditionalRendering != VK_FALSE;
}

bool has_indirect_nodes(const vk::raii::PhysicalDevice& physical) {
  const auto all = physical.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features>();
  const vk::PhysicalDeviceFeatures& core = all.get<vk::PhysicalDeviceFeatures2>().features;
  return core.multiDrawIndirect != VK_FALSE && core.drawIndirectFirstInstance != VK_FALSE &&
         all.get<vk::PhysicalDeviceVulkan12Features>().drawIndirectCount != VK_FALSE;
}

void make_logical_device(vkr::Device& d) {
  const float priority = 1.0F;
  const vk::DeviceQueueCreateInfo queue({}, d.queue_family, 1, &priority);
  const auto available = d.physical.getFeatures();
  vk::PhysicalDeviceVulkan13Features v13;
  v13.synchronization2 = VK_TRUE;
  v13.maintenance4 = VK_TRUE;  // every 1.3 device has it; compute shaders of SPIR-V 1.6 need it
  vk::PhysicalDeviceFeatures2 features;
  features.features.samplerAnisotropy = available.samplerAnisotropy;
  vk::PhysicalDeviceVulkan12Features v12;
  if (has_indirect_nodes(d.physical)) {
    features.features.multiDrawIndirect = VK_TRUE;
    features.features.drawIndirectFirstInstance = VK_TRUE;
    v12.drawIndirectCount = VK_TRUE;
    d.indirect_nodes = true;
  }
  v12.pNext = &v13;
  features.pNext = &v12;
  vk::DeviceCreateInfo create({}, queue);
  create.pNext = &features;
  vk::PhysicalDeviceConditionalRenderingFeaturesEXT conditional;
  std::vector<const char*> extensions;
  if (has_conditional_rendering(d.physical)) {
    conditional.conditionalRendering = VK_TRUE;
    v13.pNext = &conditional;
    extensions.push_back(VK_EXT_CONDITIONAL_RENDERING_EXTENSION_NAME);
    d.conditional_rendering = true;
  }
  create.setPEnabledExtensionNames(extensions);
  d.device = vk::raii::Device(d.physical, create);
  d.queue = vk::raii::Queue(d.device, d.queue_family, 0);
  // Not on lavapipe (seen with Mesa 22.3): its filter walks all texels of an ellipse, and where derivatives
  // are huge, as at the edges of triangles with four samples, one picture takes minutes.
  const bool software = d.properties.deviceType == vk::PhysicalDeviceType::eCpu;
  d.max_anisotropy = available.samplerAnisotropy != VK_FALSE && !software
                         ? std::min(4.0F, d.properties.limits.maxSamplerAnisotropy)
                         : 1.0F;
}

}  // namespace

Result<std::vector<DeviceInfo>> list_devices() {
  try {
    const vk::raii::Context context;
    const vk::raii::Instance instance = make_instance(context, false);
    std::vector<DeviceInfo> infos;
    for (const auto& physical : instance.enumeratePhysicalDevices())
      infos.push_back(describe(physical, static_cast<std::uint32_t>(infos.size())));
    return infos;
  } catch (const std::exception& e) {
    return tl::unexpected(no_device(std::string("no usable Vulkan loader or driver (") + e.what() + ")"));
  }
}

Result<std::shared_ptr<vkr::Device>> share_device(const DeviceOptions& options) {
  auto opened = vkr::open_device(options);
  if (!opened) return forward_error(opened);
  return std::shared_ptr<vkr::Device>(std::move(*opened));
}

const DeviceInfo& info_of(const vkr::Device& device) {
  return device.info;
}

namespace vkr {

std::vector<std::string> Device::take_messages() {
  const std::lock_guard lock(log->mutex);
  return std::exchange(log->messages, {});
}

Result<std::unique_ptr<Device>> open_device(const DeviceOptions& options) {
  try {
    auto d = std::make_unique<Device>();
    d->log = std::make_unique<MessageLog>();
    if (options.validation && !has_validation_layer(d->context))
      return tl::unexpected(
          no_device("validation asked for, but VK_LAYER_KHRONOS_validation is not installed"));
    d->instance = make_instance(d->context, options.validation);
    if (options.validation) {
      using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
      using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
      const vk::DebugUtilsMessengerCreateInfoEXT create(
          {}, Severity::eWarning | Severity::eError, Type::eGeneral | Type::eValidation | Type::ePerformance,
          &on_message, d->log.get());
      d->messenger = vk::raii::DebugUtilsMessengerEXT(d->instance, create);
    }
    std::vector<vk::raii::PhysicalDevice> all = d->instance.enumeratePhysicalDevices();
    std::vector<DeviceInfo> infos;
    infos.reserve(all.size());
    for (const auto& physical : all)
      infos.push_back(describe(physical, static_cast<std::uint32_t>(infos.size())));
    Result<std::size_t> chosen = choose(all, infos, options.wanted);
    if (!chosen) return forward_error(chosen);
    d->physical = std::move(all[*chosen]);
    d->info = infos[*chosen];
    d->queue_family = *graphics_family(d->physical);
    d->properties = d->physical.getProperties();
    d->memory_properties = d->physical.getMemoryProperties();
    d->timestamps = d->physical.getQueueFamilyProperties()[d->queue_family].timestampValidBits >= 36;
    make_logical_device(*d);
    return d;
  } catch (const std::exception& e) {
    return tl::unexpected(no_device(e.what()));
  }
}

}  // namespace vkr
}  // namespace scenegen::render
