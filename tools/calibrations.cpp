#include "tools/calibrations.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "render/calibration/calibration_file.h"
#include "render/strategy_names.h"
#include "tools/output.h"
#include "tools/text.h"

namespace scenegen::tools {
namespace {

Result<std::string> read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  constexpr std::size_t kMost = std::size_t{1} << 20;
  std::string out(kMost + 1, '\0');
  in.read(out.data(), static_cast<std::streamsize>(out.size()));
  if (!in.eof() && in.fail()) return fail(ErrorKind::io, path, "cannot be read");
  out.resize(static_cast<std::size_t>(in.gcount()));
  return out;
}

Result<render::Calibration> load(const std::string& path, const render::CalibrationKey& key) {
  const Result<std::string> text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  Result<render::Calibration> calibration = render::parse_calibration(*text, path);
  if (!calibration) return calibration;
  if (Result<void> fits = render::check_calibration(*calibration, key, path); !fits)
    return forward_error(fits);
  return calibration;
}

void say(bool quiet, const std::string& text) {
  if (!quiet) std::fprintf(stderr, "%s\n", text.c_str());
}

Result<render::Calibration> measure_quickly(render::CalibrationOptions options, bool quiet) {
  options.quick = true;
  Progress progress("calibrating", 100, quiet);
  int shown = 0;
  options.progress = [&](double share) {
    for (; shown < static_cast<int>(100.0 * share); ++shown) progress.advance();
  };
  return render::calibrate(options);
}

}  // namespace

Result<std::string> calibration_place(const render::CalibrationKey& key) {
  Result<std::string> path = render::calibration_path(key);
  if (!path) return path;
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::path(*path).parent_path();
  std::filesystem::create_directories(folder, error);
  if (error) return fail(ErrorKind::io, folder.string(), "cannot be made: " + error.message());
  if (Result<void> writable = check_output_file(*path); !writable) return forward_error(writable);
  return path;
}

Result<std::string> store_calibration(const render::Calibration& calibration) {
  Result<std::string> path = calibration_place(calibration.key);
  if (!path) return path;
  if (Result<void> written = write_file(*path, render::calibration_json(calibration)); !written)
    return forward_error(written);
  return path;
}

Value calibration_value(std::string& target) {
  Value value = text_value(target, "FILE|WORD", "a file, or auto, quick, none");
  value.parse = [take = value.parse](std::string_view text) -> Result<void> {
    const std::vector<std::string> words{"auto", "quick", "none"};
    std::error_code ignored;
    // A name without dot and slash that is no file is a word misspelt, in all likelihood.
    if (std::find(words.begin(), words.end(), text) == words.end() &&
        text.find_first_of("./") == std::string_view::npos && !std::filesystem::exists(text, ignored))
      return fail(ErrorKind::usage, "", "no such file; " + unknown_word("word", text, words));
    return take(text);
  };
  return value;
}

Result<void> set_costs(render::RendererOptions& options, const std::string& wanted, bool quiet) {
  if (wanted == "none" || (wanted == "auto" && !render::strategy_traits(options.strategy).uses_costs))
    return {};
  if (!options.shared_device) {
    auto device = render::share_device(options.device);
    if (!device) return forward_error(device);
    options.shared_device = std::move(*device);
  }
  const render::CalibrationKey key = render::calibration_key(render::info_of(*options.shared_device),
                                                             options.size, options.samples, options.shadows);
  std::error_code ignored;
  if (wanted != "auto" && wanted != "quick") {
    Result<render::Calibration> calibration = load(wanted, key);
    if (!calibration) return forward_error(calibration);
    options.costs = calibration->costs;
    return {};
  }
  const Result<std::string> path = render::calibration_path(key);
  const bool is_kept = wanted == "auto" && path && std::filesystem::exists(*path, ignored);
  if (is_kept) {
    const Result<render::Calibration> kept = load(*path, key);
    if (kept) {
      options.costs = kept->costs;
      return {};
    }
    say(quiet, "note: " + kept.error().str());
  }
  const char* why = wanted == "quick" ? "a quick calibration runs"
                    : is_kept         ? "a quick calibration runs and replaces that"
                                      : "no calibration of this device for such pictures; a quick one runs";
  say(quiet, std::string("note: ") + why + " (sceneplay calibrate measures better)");
  render::CalibrationOptions how;
  how.shared_device = options.shared_device;
  how.size = options.size;
  how.samples = options.samples;
  how.shadows = options.shadows;
  Result<render::Calibration> measured = measure_quickly(std::move(how), quiet);
  if (!measured) return forward_error(measured);
  options.costs = measured->costs;
  if (!measured->clamped.empty())
    say(quiet, "note: " + std::to_string(measured->clamped.size()) +
                   " units came out below 0 (the machine is busy?) and were set to 0");
  if (wanted == "auto") {
    // Without a cache it is measured again next time: no reason to stop.
    if (const Result<std::string> stored = store_calibration(*measured); !stored)
      say(quiet, "note: not kept: " + stored.error().str());
  }
  return {};
}

}  // namespace scenegen::tools
