// Runs on disk, and the machine that they were measured on.
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "tools/bench_results.h"
#include "tools/output.h"
#include "tools/text.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".run.json";

/// FNV-1a.
constexpr std::uint64_t kHashOfNothing = 0xcbf29ce484222325U;
std::uint64_t hash(std::string_view text, std::uint64_t h = kHashOfNothing) {
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return h;
}

/// Of what is in a file; of nothing when it cannot be read.
std::uint64_t hash_of_file(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::vector<char> part(std::size_t{1} << 20);
  std::uint64_t h = kHashOfNothing;
  while (in.read(part.data(), static_cast<std::streamsize>(part.size())) || in.gcount() > 0)
    h = hash({part.data(), static_cast<std::size_t>(in.gcount())}, h);
  return h;
}

std::string word_after(const std::string& path, std::string_view key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t value = line.find_first_not_of("\t :=\"", key.size());
    if (value == std::string::npos) return "";
    line.erase(0, value);
    line.erase(line.find_last_not_of('"') + 1);
    return line;
  }
  return "";
}

}  // namespace

std::string compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#else
  return "g++ " __VERSION__;
#endif
}

ordered_json machine_json() {
  const auto pages = static_cast<std::uint64_t>(std::max(0L, ::sysconf(_SC_PHYS_PAGES)));
  const auto page = static_cast<std::uint64_t>(std::max(0L, ::sysconf(_SC_PAGESIZE)));
  struct utsname names {};
  const bool named = ::uname(&names) == 0;
  std::array<double, 1> load{};
  const bool loaded = ::getloadavg(load.data(), 1) == 1;
  return {{"processor", word_after("/proc/cpuinfo", "model name")},
          {"cores", std::thread::hardware_concurrency()},
          {"memoryBytes", pages * page},
          {"system", word_after("/etc/os-release", "PRETTY_NAME")},
          {"kernel", named ? std::string(names.sysname) + " " + names.release : ""},
          {"load", loaded ? ordered_json(load[0]) : ordered_json()}};
}

Result<void> RunStore::open(bool keep) const {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error || !fs::is_directory(folder_, error))
    return fail(ErrorKind::io, folder_, error ? "cannot be made: " + error.message() : "is no folder");
  if (keep) return {};
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, error)) {
    if (entry.path().filename().string().ends_with(kSuffix)) fs::remove(entry.path(), error);
  }
  return {};
}

std::string RunStore::path(const BenchCase& what, std::uint32_t repetition) const {
  std::string name = fs::path(what.file).stem().string() + "_" + what.way.label;
  for (char& c : name) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
    if (!plain) c = '_';
  }
  name.resize(std::min<std::size_t>(name.size(), 80));
  std::array<char, 40> tail{};
  (void)std::snprintf(tail.data(), tail.size(), "_%016llx_%u",
                      static_cast<unsigned long long>(hash(what.key())), repetition);
  return (fs::path(folder_) / name.append(tail.data()).append(kSuffix)).string();
}

ordered_json RunStore::settings_of(const BenchCase& what) const {
  ordered_json out = settings_;
  for (const auto& [name, file] : {std::pair("fileHash", what.file), std::pair("cameraHash", what.camera)}) {
    auto known = hashes_.find(file);
    if (known == hashes_.end()) known = hashes_.emplace(file, hash_of_file(file)).first;
    out[name] = known->second;
  }
  return out;
}

Result<std::optional<BenchRun>> RunStore::find(const BenchCase& what, std::uint32_t repetition) const {
  const std::string from = path(what, repetition);
  std::ifstream file(from, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const ordered_json json =
      json_excess(text).empty() ? ordered_json::parse(text, nullptr, false) : ordered_json();
  if (!json.is_object() || !json.contains("settings") || !json.contains("run") ||
      json.value("case", "") != what.key())
    return std::optional<BenchRun>();
  const ordered_json settings = settings_of(what);
  for (const auto& [name, value] : settings.items()) {
    const ordered_json then =
        json["settings"].is_object() ? json["settings"].value(name, ordered_json()) : ordered_json();
    if (then == value) continue;
    std::string what_differs = from;
    what_differs.append(" was measured with ").append(name).append(" ").append(then.dump());
    what_differs.append(", now it is ").append(value.dump());
    return fail(ErrorKind::usage, "--resume",
                what_differs + "; without --resume everything is measured anew");
  }
  return BenchRun::from_json(json["run"]);
}

Result<void> RunStore::save(const BenchCase& what, std::uint32_t repetition, const BenchRun& run) const {
  const ordered_json json{{"schema", "sceneplay/bench-run"},
                          {"case", what.key()},
                          {"repetition", repetition},
                          {"settings", settings_of(what)},
                          {"run", run.json()}};
  return write_file(path(what, repetition),
                    json.dump(-1, ' ', false, ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace scenegen::tools
