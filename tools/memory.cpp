#include "tools/memory.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace scenegen::tools {

namespace {

std::optional<std::uint64_t> first_number(const std::string& path) {
  std::ifstream file(path);
  std::uint64_t value = 0;
  return file >> value ? std::optional(value) : std::nullopt;  // "max" is no number
}

std::optional<std::uint64_t> mem_available() {
  std::ifstream file("/proc/meminfo");
  std::string word;
  std::uint64_t kib = 0;
  while (file >> word) {
    if (word == "MemAvailable:" && file >> kib) return kib * 1024;
    file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return std::nullopt;
}

std::optional<std::uint64_t> left_in_group(const std::string& limit_path, const std::string& usage_path) {
  const auto limit = first_number(limit_path);
  const auto usage = first_number(usage_path);
  if (!limit || !usage) return std::nullopt;
  return *limit - std::min(*limit, *usage);
}

}  // namespace

std::optional<std::uint64_t> available_memory() {
  std::optional<std::uint64_t> least = mem_available();
  // In a container the paths of its own control group are these; version 2 and version 1.
  const auto v2 = left_in_group("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current");
  const auto v1 = left_in_group("/sys/fs/cgroup/memory/memory.limit_in_bytes",
                                "/sys/fs/cgroup/memory/memory.usage_in_bytes");
  for (const auto& bytes : {v2, v1}) {
    if (bytes) least = std::min(least.value_or(*bytes), *bytes);
  }
  return least;
}

}  // namespace scenegen::tools
