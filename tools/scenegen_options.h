// Everything that `scenegen` can be asked for, and how it is said on the command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gen/generate.h"
#include "scene/gltf/write.h"
#include "timeline/appearance.h"
#include "tools/cli.h"
#include "tools/output.h"
#include "tools/profile_options.h"

namespace scenegen::tools {

struct GenerateRequest {
  gen::TownOptions town;
  std::uint32_t test_set = 0;                                               ///< 0: none, a town
  std::optional<timeline::CurveKind> curve = timeline::CurveKind::hilbert;  ///< none: a static scene
  timeline::AppearanceOptions appearance;
  ProfileRequest profile;
  gltf::WriteOptions file;
  std::uint64_t seed = 1;
  std::uint32_t threads = 0;  ///< 0: one per processor

  std::string output = "scene.glb";
  std::string report;
  Format format = Format::table;
  bool dry_run = false;
  bool dump_config = false;
  bool quiet = false;
};

/// The options write into `request`, which must outlive them.
[[nodiscard]] Options generate_options(GenerateRequest& request);

/// Options that do not go together with the others of the request. Given, they are errors; they are not in a
/// config.
[[nodiscard]] std::vector<Conflict> conflicts(const GenerateRequest& request);

/// Copies the seed and the threads to where the rooms look for them.
void settle(GenerateRequest& request);

/// The order of a curve's axes.
[[nodiscard]] Value order_value(timeline::AxisOrder& target);
/// --order, --cells, --interval, --hold and --coherence, in the present group.
void add_curve_options(Options& options, timeline::AppearanceOptions& appearance);
void add_visibility_option(Options& options, gltf::VisibilityEncoding& visibility);
/// --layout and --visibility.
void add_file_options(Options& options, gltf::WriteOptions& file);

/// Whether a scene can be written to `path` (option --output), before the long work.
[[nodiscard]] Result<void> check_scene_output(const std::string& path);

/// The group "Compression"; conflicts_of_draco() tells which of its options need --draco.
void add_draco_options(Options& options, gltf::DracoOptions& draco);
[[nodiscard]] std::vector<Conflict> conflicts_of_draco(const gltf::DracoOptions& draco);

[[nodiscard]] std::string layout_name(gltf::Layout layout);
[[nodiscard]] std::string visibility_name(gltf::VisibilityEncoding encoding);

}  // namespace scenegen::tools
