#include "tools/sweep.h"

#include <nettle/sha2.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "tools/text.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* kGenerator = "scenegen " SCENEGEN_VERSION;

std::string pointer(const std::string& where, const std::string& key) {
  std::string out = where + ": /";
  for (const char c : key) out += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return out;
}

tl::unexpected<Error> located(Error error, const std::string& where) {
  error.where = where;
  return tl::unexpected<Error>(std::move(error));
}

std::string hex(const std::array<std::uint8_t, SHA256_DIGEST_SIZE>& digest) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out;
  for (const std::uint8_t byte : digest) out.append(1, kDigits[byte >> 4U]).append(1, kDigits[byte & 15U]);
  return out;
}

std::string sha256(std::string_view text) {
  sha256_ctx context{};
  sha256_init(&context);
  sha256_update(&context, text.size(), reinterpret_cast<const std::uint8_t*>(text.data()));
  std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest{};
  sha256_digest(&context, digest.size(), digest.data());
  return hex(digest);
}

/// A value as part of a file's name.
std::string name_part(const ordered_json& value) {
  const std::string spelled = value.is_string() ? value.get<std::string>() : value.dump();
  std::string out;
  for (const char c : spelled) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                       std::string_view(".+-,").find(c) != std::string_view::npos;
    out += plain ? c : '_';
  }
  return out;
}

std::string file_name(const ordered_json& parameters) {
  std::string stem;
  for (const auto& [key, value] : parameters.items())
    stem += (stem.empty() ? "" : "_") + key + "-" + name_part(value);
  constexpr std::size_t kLongest = 200;  // file systems take 255 bytes
  if (stem.size() > kLongest)
    stem = stem.substr(0, kLongest - 17) + "_" + sha256(parameters.dump()).substr(0, 16);
  return (stem.empty() ? "scene" : stem) + ".glb";
}

/// Sets all options of one combination.
Result<void> set_all(const ordered_json& config, const std::vector<std::size_t>& choice,
                     const std::string& where, Options& options) {
  std::size_t varied = 0;
  for (const auto& [key, value] : config.items()) {
    std::string at = pointer(where, key);
    const bool list = value.is_array();
    const std::size_t index = list ? choice[varied++] : 0;
    if (list) at += "/" + std::to_string(index);
    if (auto set = options.set_content(key, list ? value[index] : value); !set)
      return located(std::move(set.error()), at);
  }
  return {};
}

/// What can be said of each member alone: its name, and that it has values. Returns the number of
/// combinations.
Result<std::uint64_t> count_scenes(const ordered_json& config, const std::string& where) {
  std::uint64_t count = 1;
  for (const auto& [key, value] : config.items()) {
    if (!value.is_array()) continue;
    if (value.empty()) return fail(ErrorKind::usage, pointer(where, key), "is empty: no scene would be made");
    // Above the limit the exact number does not matter any more, as long as it does not overflow.
    if (count < UINT64_MAX / 1'000'000) count *= std::min<std::uint64_t>(value.size(), 1'000'000);
  }
  if (count > kMaxSweepScenes)
    return fail(ErrorKind::usage, where,
                "asks for " + human_count(count) + " scenes; at most " + human_count(kMaxSweepScenes));
  return count;
}

/// The next combination; the last parameter changes fastest.
void advance(const ordered_json& config, const std::vector<std::string>& varied,
             std::vector<std::size_t>& choice) {
  for (std::size_t i = varied.size(); i-- > 0;) {
    if (++choice[i] < config[varied[i]].size()) return;
    choice[i] = 0;
  }
}

/// Names that mean the same scene twice: 0.5 and 0.50.
Result<void> check_distinct(const SweepPlan& plan, const std::string& where) {
  for (std::size_t i = 0; i < plan.varied.size(); ++i) {
    std::map<std::string, std::size_t> seen;
    for (const SweepScene& scene : plan.scenes) {
      const auto [it, added] = seen.emplace(name_part(scene.parameters[plan.varied[i]]), scene.choice[i]);
      if (!added && it->second != scene.choice[i])
        return fail(ErrorKind::usage, pointer(where, plan.varied[i]) + "/" + std::to_string(scene.choice[i]),
                    "gives the same files as /" + plan.varied[i] + "/" + std::to_string(it->second));
    }
  }
  return {};
}

bool takes_models(const GenerateRequest& r) {
  return !r.town.building_model.empty() ||
         (r.town.extra_model != "box" && !r.town.extra_model.starts_with("sphere:"));
}

}  // namespace

Result<SweepPlan> plan_sweep(const ordered_json& config, const std::string& where) {
  const Result<std::uint64_t> count = count_scenes(config, where);
  if (!count) return tl::unexpected(count.error());
  SweepPlan out{config, {}, {}};
  for (const auto& [key, value] : config.items()) {
    if (value.is_array()) out.varied.push_back(key);
  }
  std::vector<std::size_t> choice(out.varied.size());
  for (std::uint64_t i = 0; i < *count; ++i, advance(config, out.varied, choice)) {
    GenerateRequest request;
    Options options = generate_options(request);
    if (auto set = set_all(config, choice, where, options); !set) return forward_error(set);
    SweepScene scene{{}, choice, ordered_json::object(), options.canonical_arguments()};
    for (const std::string& name : out.varied) scene.parameters[name] = options.config_value(name);
    scene.file = file_name(scene.parameters);
    if (auto allowed = options.refuse(conflicts(request)); !allowed)
      return fail(ErrorKind::usage, pointer(where, allowed.error().where.substr(2)),
                  allowed.error().what + (out.varied.empty() ? "" : " (in " + scene.file + ")"));
    out.scenes.push_back(std::move(scene));
  }
  if (auto distinct = check_distinct(out, where); !distinct) return forward_error(distinct);
  return out;
}

GenerateRequest request_of(const SweepPlan& plan, const SweepScene& scene) {
  GenerateRequest out;
  Options options = generate_options(out);
  const auto set = set_all(plan.config, scene.choice, "", options);
  assert(set);  // plan_sweep() has done the same
  (void)set;
  return out;
}

Result<FileDigest> digest_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return fail(ErrorKind::io, path, "cannot be read");
  FileDigest out;
  sha256_ctx context{};
  sha256_init(&context);
  for (std::array<char, 65536> part{}; in;) {
    in.read(part.data(), part.size());
    const auto count = static_cast<std::size_t>(in.gcount());
    sha256_update(&context, count, reinterpret_cast<const std::uint8_t*>(part.data()));
    out.bytes += count;
  }
  if (in.bad()) return fail(ErrorKind::io, path, "cannot be read");
  std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest{};
  sha256_digest(&context, digest.size(), digest.data());
  out.sha256 = hex(digest);
  return out;
}

ordered_json sweep_index(const SweepPlan& plan, const std::vector<ordered_json>& entries) {
  ordered_json scenes = ordered_json::array();
  bool complete = true;
  for (const ordered_json& entry : entries) {
    complete = complete && !entry.is_null();
    if (!entry.is_null()) scenes.push_back(entry);
  }
  return {{"schema", "scenegen/sweep"}, {"version", 1},          {"generator", kGenerator},
          {"config", plan.config},      {"varied", plan.varied}, {"complete", complete},
          {"scenes", std::move(scenes)}};
}

ordered_json scene_entry(const SweepScene& scene, const Made& made, const FileDigest& file) {
  ordered_json out{{"file", scene.file},
                   {"parameters", scene.parameters},
                   {"arguments", scene.arguments},
                   {"objects", made.counts.objects},
                   {"vertices", made.counts.vertices},
                   {"triangles", made.counts.triangles},
                   {"moments", made.moments()}};
  if (made.appearance) {
    out["coherence"] = made.appearance->coherence_measured;
    out["displaced"] = made.appearance->displaced_objects;
    out["locality"] = made.appearance->locality_cells;
  }
  out["layout"] = layout_name(made.file.layout);
  out["bytes"] = file.bytes;
  if (!file.sha256.empty()) out["sha256"] = file.sha256;
  return out;
}

std::vector<ordered_json> entries_kept(const SweepPlan& plan, const std::string& folder) {
  std::vector<ordered_json> out(plan.scenes.size());
  std::ifstream in(fs::path(folder) / "index.json", std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const ordered_json index =
      json_excess(text).empty() ? ordered_json::parse(text, nullptr, false) : ordered_json();
  const auto is = [](const ordered_json& json, const char* name, const ordered_json& value) {
    return json.is_object() && json.contains(name) && json[name] == value;
  };
  if (!is(index, "schema", "scenegen/sweep") || !is(index, "version", 1) ||
      !is(index, "generator", kGenerator) || !index.contains("scenes") || !index["scenes"].is_array())
    return out;
  std::map<std::string, const ordered_json*> by_file;
  for (const ordered_json& entry : index["scenes"]) {
    if (entry.is_object() && entry.contains("file") && entry["file"].is_string())
      by_file[entry["file"].get<std::string>()] = &entry;
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    const SweepScene& scene = plan.scenes[i];
    const auto it = by_file.find(scene.file);
    if (it == by_file.end() || !is(*it->second, "arguments", scene.arguments) ||
        takes_models(request_of(plan, scene)))
      continue;
    const Result<FileDigest> digest = digest_file((fs::path(folder) / scene.file).string());
    if (digest && is(*it->second, "sha256", digest->sha256) && is(*it->second, "bytes", digest->bytes))
      out[i] = *it->second;
  }
  return out;
}

}  // namespace scenegen::tools
