#include "tests/support/fault_layer.h"

#include <dlfcn.h>
#include <vulkan/vk_layer.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <optional>

#include "tests/support/stack_hash.h"

namespace {

using scenegen::test::FaultControl;

// Every function of a device that may fail and that the renderer uses, or is likely to.
// clang-format off
#define SCENEGEN_CALLS(X)                                                                              \
  X(vkAllocateMemory) X(vkMapMemory) X(vkBindBufferMemory) X(vkBindImageMemory) X(vkCreateBuffer)      \
  X(vkCreateBufferView) X(vkCreateImage) X(vkCreateImageView) X(vkCreateFence) X(vkCreateSemaphore)    \
  X(vkCreateEvent) X(vkCreateQueryPool) X(vkCreateSampler) X(vkCreateShaderModule)                     \
  X(vkCreatePipelineCache) X(vkCreateGraphicsPipelines) X(vkCreateComputePipelines)                    \
  X(vkCreatePipelineLayout) X(vkCreateDescriptorSetLayout) X(vkCreateDescriptorPool)                   \
  X(vkAllocateDescriptorSets) X(vkCreateFramebuffer) X(vkCreateRenderPass) X(vkCreateRenderPass2)      \
  X(vkCreateCommandPool) X(vkAllocateCommandBuffers) X(vkResetCommandPool) X(vkBeginCommandBuffer)     \
  X(vkEndCommandBuffer) X(vkResetCommandBuffer) X(vkQueueSubmit) X(vkQueueSubmit2) X(vkQueueWaitIdle)  \
  X(vkDeviceWaitIdle) X(vkWaitForFences) X(vkResetFences) X(vkGetFenceStatus) X(vkGetQueryPoolResults)

// Of an instance, what is called below.
#define SCENEGEN_INSTANCE_CALLS(X)                                       \
  X(vkDestroyInstance) X(vkCreateDevice) X(vkEnumeratePhysicalDevices)   \
  X(vkEnumerateDeviceExtensionProperties) X(vkGetPhysicalDeviceFeatures2) \
  X(vkGetPhysicalDeviceProperties2) X(vkGetPhysicalDeviceQueueFamilyProperties)
// clang-format on

enum CallIndex : std::size_t {
#define SCENEGEN_INDEX(name) k_##name,
  SCENEGEN_CALLS(SCENEGEN_INDEX)
#undef SCENEGEN_INDEX
      kCalls
};

struct InstanceTable {
  PFN_vkGetInstanceProcAddr next = nullptr;
  // Asked for while the instance is made: later the loader gives the top of the chain.
#define SCENEGEN_MEMBER(name) PFN_##name name = nullptr;
  SCENEGEN_INSTANCE_CALLS(SCENEGEN_MEMBER)
#undef SCENEGEN_MEMBER
};
struct DeviceTable {
  VkDevice device = VK_NULL_HANDLE;
  PFN_vkGetDeviceProcAddr next = nullptr;
  std::array<PFN_vkVoidFunction, kCalls> calls{};
};

std::mutex mutex;
std::map<void*, InstanceTable> instances;  // by the loader's key, which children of an instance share
std::map<void*, DeviceTable> devices;
thread_local bool inside = false;

struct Inside {
  Inside() { inside = true; }
  ~Inside() { inside = false; }
};

template <class Handle>
void* key(Handle handle) {
  return *reinterpret_cast<void**>(handle);
}
template <class Handle>
InstanceTable instance_of(Handle handle) {
  const std::lock_guard lock(mutex);
  return instances.at(key(handle));
}

FaultControl from_environment() {
  FaultControl c;
  if (const char* lacks = std::getenv(scenegen::test::kLacksVariable)) c.lacks = lacks;
  const char* fault = std::getenv(scenegen::test::kFaultVariable);
  if (fault == nullptr) return c;
  const std::string text = fault;
  const std::size_t first = text.find(':');
  const std::size_t last = text.rfind(':');
  if (first == last) std::abort();  // a test that is wrong
  if (text.substr(0, first) != "any") c.only = text.substr(0, first);
  c.fail_at = std::strtoull(text.c_str() + first + 1, nullptr, 10);
  c.result = static_cast<VkResult>(std::strtol(text.c_str() + last + 1, nullptr, 10));
  return c;
}

FaultControl& control() {
  static FaultControl one = from_environment();
  return one;
}

bool lacks(const std::string& name) {
  return ("," + control().lacks + ",").find("," + name + ",") != std::string::npos;
}

bool finds_a_lost_device(CallIndex call) {
  constexpr std::array kThose{k_vkQueueSubmit,        k_vkQueueSubmit2,  k_vkQueueWaitIdle,
                              k_vkDeviceWaitIdle,     k_vkWaitForFences, k_vkGetFenceStatus,
                              k_vkGetQueryPoolResults};
  return std::find(kThose.begin(), kThose.end(), call) != kThose.end();
}

/// What a call is to give instead of being made.
std::optional<VkResult> fault(CallIndex call, const char* name, const DeviceTable& table) {
  FaultControl& c = control();
  const std::lock_guard lock(mutex);
  if (c.lost && finds_a_lost_device(call)) return VK_ERROR_DEVICE_LOST;
  if (!c.only.empty() && c.only != name) return std::nullopt;
  ++c.calls;
  if (c.record) c.sites.push_back({name, scenegen::test::stack_hash()});
  if (c.calls != c.fail_at) return std::nullopt;
  c.failed = name;
  if (c.result == VK_ERROR_DEVICE_LOST) {
    // A lost device runs nothing any more: whoever destroys what it used is right.
    const Inside guard;
    reinterpret_cast<PFN_vkDeviceWaitIdle>(table.calls[k_vkDeviceWaitIdle])(table.device);
    c.lost = true;
  }
  return c.result;
}

template <class F>
struct Hook;
template <class First, class... Rest>
struct Hook<VkResult(VKAPI_PTR*)(First, Rest...)> {
  using F = VkResult(VKAPI_PTR*)(First, Rest...);
  template <CallIndex kCall>
  static VKAPI_ATTR VkResult VKAPI_CALL call(First first, Rest... rest) {
    constexpr std::array kNames{
#define SCENEGEN_NAME(name) #name,
        SCENEGEN_CALLS(SCENEGEN_NAME)
#undef SCENEGEN_NAME
    };
    DeviceTable table;
    {
      const std::lock_guard lock(mutex);
      table = devices.at(key(first));
    }
    if (const auto failed = fault(kCall, kNames[kCall], table)) return *failed;
    const Inside guard;
    return reinterpret_cast<F>(table.calls[kCall])(first, rest...);
  }
};

template <class Info>
Info* chain_info(const void* next, VkStructureType type) {
  for (auto* info = static_cast<const Info*>(next); info != nullptr;
       info = static_cast<const Info*>(info->pNext)) {
    if (info->sType == type && info->function == VK_LAYER_LINK_INFO) return const_cast<Info*>(info);
  }
  return nullptr;
}

VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* create,
                                               const VkAllocationCallbacks* allocator, VkInstance* out) {
  auto* link =
      chain_info<VkLayerInstanceCreateInfo>(create->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
  if (link == nullptr) return VK_ERROR_INITIALIZATION_FAILED;
  const PFN_vkGetInstanceProcAddr next = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const auto make = reinterpret_cast<PFN_vkCreateInstance>(next(VK_NULL_HANDLE, "vkCreateInstance"));
  const VkResult result = make(create, allocator, out);
  if (result != VK_SUCCESS) return result;
  InstanceTable table;
  table.next = next;
#define SCENEGEN_FILL(name) table.name = reinterpret_cast<PFN_##name>(next(*out, #name));
  SCENEGEN_INSTANCE_CALLS(SCENEGEN_FILL)
#undef SCENEGEN_FILL
  const std::lock_guard lock(mutex);
  instances[key(*out)] = table;
  return result;
}

VKAPI_ATTR void VKAPI_CALL destroy_instance(VkInstance instance, const VkAllocationCallbacks* allocator) {
  const InstanceTable table = instance_of(instance);
  void* const gone = key(instance);
  table.vkDestroyInstance(instance, allocator);
  const std::lock_guard lock(mutex);
  instances.erase(gone);
}

VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo* create,
                                             const VkAllocationCallbacks* allocator, VkDevice* out) {
  FaultControl& c = control();
  if (c.only == "vkCreateDevice") {
    if (++c.calls == c.fail_at) return c.result;
  }
  auto* link =
      chain_info<VkLayerDeviceCreateInfo>(create->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  if (link == nullptr) return VK_ERROR_INITIALIZATION_FAILED;
  const PFN_vkGetDeviceProcAddr next_device = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const VkResult result = instance_of(physical).vkCreateDevice(physical, create, allocator, out);
  if (result != VK_SUCCESS) return result;
  DeviceTable table{*out, next_device, {}};
#define SCENEGEN_FILL(name) table.calls[k_##name] = next_device(*out, #name);
  SCENEGEN_CALLS(SCENEGEN_FILL)
#undef SCENEGEN_FILL
  const std::lock_guard lock(mutex);
  devices[key(*out)] = table;
  return result;
}

VKAPI_ATTR void VKAPI_CALL destroy_device(VkDevice device, const VkAllocationCallbacks* allocator) {
  if (device == VK_NULL_HANDLE) return;
  DeviceTable table;
  {
    const std::lock_guard lock(mutex);
    table = devices.at(key(device));
    devices.erase(key(device));
  }
  reinterpret_cast<PFN_vkDestroyDevice>(table.next(device, "vkDestroyDevice"))(device, allocator);
}

VKAPI_ATTR VkResult VKAPI_CALL enumerate_devices(VkInstance instance, std::uint32_t* count,
                                                 VkPhysicalDevice* out) {
  if (lacks("devices")) {
    *count = 0;
    return VK_SUCCESS;
  }
  return instance_of(instance).vkEnumeratePhysicalDevices(instance, count, out);
}

VKAPI_ATTR VkResult VKAPI_CALL enumerate_extensions(VkPhysicalDevice physical, const char* layer,
                                                    std::uint32_t* count, VkExtensionProperties* out) {
  const auto next = instance_of(physical).vkEnumerateDeviceExtensionProperties;
  std::uint32_t all = 0;
  if (const VkResult result = next(physical, layer, &all, nullptr); result != VK_SUCCESS) return result;
  std::vector<VkExtensionProperties> known(all);
  if (const VkResult result = next(physical, layer, &all, known.data()); result != VK_SUCCESS) return result;
  known.erase(std::remove_if(known.begin(), known.end(),
                             [](const VkExtensionProperties& e) { return lacks(e.extensionName); }),
              known.end());
  const auto there = static_cast<std::uint32_t>(known.size());
  if (out == nullptr) {
    *count = there;
    return VK_SUCCESS;
  }
  const bool fits = *count >= there;
  *count = std::min(*count, there);
  std::copy_n(known.begin(), *count, out);
  return fits ? VK_SUCCESS : VK_INCOMPLETE;
}

VKAPI_ATTR void VKAPI_CALL get_features(VkPhysicalDevice physical, VkPhysicalDeviceFeatures2* out) {
  instance_of(physical).vkGetPhysicalDeviceFeatures2(physical, out);
  if (lacks("multiDrawIndirect")) out->features.multiDrawIndirect = VK_FALSE;
  for (auto* s = static_cast<VkBaseOutStructure*>(out->pNext); s != nullptr; s = s->pNext) {
    if (s->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES && lacks("drawIndirectCount"))
      reinterpret_cast<VkPhysicalDeviceVulkan12Features*>(s)->drawIndirectCount = VK_FALSE;
    if (s->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES && lacks("synchronization2"))
      reinterpret_cast<VkPhysicalDeviceVulkan13Features*>(s)->synchronization2 = VK_FALSE;
  }
}

VKAPI_ATTR void VKAPI_CALL get_properties(VkPhysicalDevice physical, VkPhysicalDeviceProperties2* out) {
  instance_of(physical).vkGetPhysicalDeviceProperties2(physical, out);
  if (lacks("vulkan13")) out->properties.apiVersion = VK_API_VERSION_1_2;
}

VKAPI_ATTR void VKAPI_CALL get_queue_families(VkPhysicalDevice physical, std::uint32_t* count,
                                              VkQueueFamilyProperties* out) {
  instance_of(physical).vkGetPhysicalDeviceQueueFamilyProperties(physical, count, out);
  for (std::uint32_t i = 0; out != nullptr && i < *count; ++i) {
    if (lacks("timestamps")) out[i].timestampValidBits = 0;
    if (lacks("graphics")) out[i].queueFlags &= ~VkQueueFlags{VK_QUEUE_GRAPHICS_BIT};
  }
}

PFN_vkVoidFunction device_hook(const char* name) {
#define SCENEGEN_HOOK(call_name)          \
  if (std::strcmp(name, #call_name) == 0) \
    return reinterpret_cast<PFN_vkVoidFunction>(&Hook<PFN_##call_name>::call<k_##call_name>);
  SCENEGEN_CALLS(SCENEGEN_HOOK)
#undef SCENEGEN_HOOK
  return nullptr;
}

PFN_vkVoidFunction VKAPI_CALL get_instance_proc(VkInstance instance, const char* name);

PFN_vkVoidFunction VKAPI_CALL get_device_proc(VkDevice device, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&get_device_proc);
  if (std::strcmp(name, "vkDestroyDevice") == 0) return reinterpret_cast<PFN_vkVoidFunction>(&destroy_device);
  PFN_vkGetDeviceProcAddr next = nullptr;
  {
    const std::lock_guard lock(mutex);
    next = devices.at(key(device)).next;
  }
  const PFN_vkVoidFunction below = next(device, name);
  const PFN_vkVoidFunction hook = device_hook(name);
  return below != nullptr && hook != nullptr ? hook : below;
}

PFN_vkVoidFunction VKAPI_CALL get_instance_proc(VkInstance instance, const char* name) {
  struct Named {
    const char* name;
    PFN_vkVoidFunction function;
  };
#define SCENEGEN_NAMED(name, function)                      \
  Named {                                                   \
    name, reinterpret_cast<PFN_vkVoidFunction>(&(function)) \
  }
  static const std::array kHooks{
      SCENEGEN_NAMED("vkGetInstanceProcAddr", get_instance_proc),
      SCENEGEN_NAMED("vkGetDeviceProcAddr", get_device_proc),
      SCENEGEN_NAMED("vkCreateInstance", create_instance),
      SCENEGEN_NAMED("vkDestroyInstance", destroy_instance),
      SCENEGEN_NAMED("vkCreateDevice", create_device),
      SCENEGEN_NAMED("vkDestroyDevice", destroy_device),
      SCENEGEN_NAMED("vkEnumeratePhysicalDevices", enumerate_devices),
      SCENEGEN_NAMED("vkEnumerateDeviceExtensionProperties", enumerate_extensions),
      SCENEGEN_NAMED("vkGetPhysicalDeviceFeatures2", get_features),
      SCENEGEN_NAMED("vkGetPhysicalDeviceProperties2", get_properties),
      SCENEGEN_NAMED("vkGetPhysicalDeviceQueueFamilyProperties", get_queue_families)};
#undef SCENEGEN_NAMED
  for (const Named& hook : kHooks) {
    if (std::strcmp(name, hook.name) == 0) return hook.function;
  }
  if (instance == VK_NULL_HANDLE) return nullptr;
  const PFN_vkVoidFunction below = instance_of(instance).next(instance, name);
  const PFN_vkVoidFunction hook = device_hook(name);
  return below != nullptr && hook != nullptr ? hook : below;
}

}  // namespace

extern "C" {

FaultControl* scenegen_fault_control() {
  return &control();
}

bool scenegen_fault_inside() {
  return inside;
}

VKAPI_ATTR VkResult VKAPI_CALL vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* negotiated) {
  if (negotiated->loaderLayerInterfaceVersion < 2) return VK_ERROR_INITIALIZATION_FAILED;
  negotiated->loaderLayerInterfaceVersion = 2;
  negotiated->pfnGetInstanceProcAddr = &get_instance_proc;
  negotiated->pfnGetDeviceProcAddr = &get_device_proc;
  negotiated->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}
}
