// The cartesian product of parameters as a list of scenes, and its index (docs/SWEEP.md).
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/result.h"
#include "tools/make_scene.h"

namespace scenegen::tools {

/// More scenes than this in one sweep is taken for a mistake.
constexpr std::uint64_t kMaxSweepScenes = 10'000;

/// One combination.
struct SweepScene {
  std::string file;                    ///< "coherence-0.5_curve-hilbert.glb"
  std::vector<std::size_t> choice;     ///< per varied parameter: which of its values
  nlohmann::ordered_json parameters;   ///< the varied ones, canonically spelt
  std::vector<std::string> arguments;  ///< all that decide it, canonically spelt
};

struct SweepPlan {
  nlohmann::ordered_json config;    ///< as it was read
  std::vector<std::string> varied;  ///< names, in the order of the config: the last one changes fastest
  std::vector<SweepScene> scenes;
};

/// Checks every combination before anything is made. `where` is the config's name; errors (usage, bad_input)
/// add the JSON pointer.
[[nodiscard]] Result<SweepPlan> plan_sweep(const nlohmann::ordered_json& config, const std::string& where);
/// What `scenegen` would be asked for. Not for a scene of another plan.
[[nodiscard]] GenerateRequest request_of(const SweepPlan& plan, const SweepScene& scene);

/// What is in a file that is whole.
struct FileDigest {
  std::uint64_t bytes = 0;
  std::string sha256;
};
[[nodiscard]] Result<FileDigest> digest_file(const std::string& path);

/// "scenegen/sweep" 1. An entry of `entries` is a scene's, in the order of the plan; null: not made yet.
[[nodiscard]] nlohmann::ordered_json sweep_index(const SweepPlan& plan,
                                                 const std::vector<nlohmann::ordered_json>& entries);
[[nodiscard]] nlohmann::ordered_json scene_entry(const SweepScene& scene, const Made& made,
                                                 const FileDigest& file);
/// Entries of an earlier index whose files in `folder` are still what it says, per scene of the plan; null
/// for the others. Scenes that take models from files are always null: those may have changed. An index that
/// is missing, damaged or of another version of this program keeps nothing.
[[nodiscard]] std::vector<nlohmann::ordered_json> entries_kept(const SweepPlan& plan,
                                                               const std::string& folder);

}  // namespace scenegen::tools
