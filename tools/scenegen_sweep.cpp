// scenegen sweep CONFIG -o DIR: all combinations of parameters as scenes, and an index of them.
#include <chrono>
#include <cstdio>
#include <filesystem>

#include "scene/limits.h"
#include "tools/output.h"
#include "tools/scenegen.h"
#include "tools/sweep.h"
#include "tools/verb.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;
namespace fs = std::filesystem;

struct SweepRequest {
  std::string config, folder;
  bool resume = false, dry_run = false, quiet = false;
  std::uint32_t threads = 0;
  Format format = Format::table;
};

/// Writes index.json now and then: a run that is killed loses little, and writing it costs little of the
/// time.
class IndexFile {
 public:
  IndexFile(const SweepPlan& plan, std::string path) : plan_(plan), path_(std::move(path)) {}

  Result<void> update(const std::vector<ordered_json>& entries, bool last) {
    constexpr int kShare = 20;
    if (!last && between_.seconds() < kShare * cost_s_) return {};
    const Stopwatch cost;
    auto written = write_file(path_, pretty(sweep_index(plan_, entries)));
    cost_s_ = cost.seconds();
    between_ = Stopwatch();
    return written;
  }

 private:
  const SweepPlan& plan_;
  std::string path_;
  double cost_s_ = 0;
  Stopwatch between_;
};

Result<ordered_json> make_one(const SweepRequest& r, const SweepPlan& plan, const SweepScene& scene) {
  GenerateRequest request = request_of(plan, scene);
  const std::string path = (fs::path(r.folder.empty() ? "." : r.folder) / scene.file).string();
  request.output = path;
  request.threads = r.threads;
  request.dry_run = r.dry_run;
  request.quiet = true;           // progress is by scenes
  request.format = Format::json;  // exact counts
  settle(request);
  auto made = make_scene(request, scene.arguments);
  if (!made) {
    if (made.error().where.empty()) made.error().where = scene.file;
    return forward_error(made);
  }
  if (r.dry_run) return scene_entry(scene, *made, {made->file.bytes, {}});
  for (gltf::OutputFile& file : made->files) {
    if (auto placed = file.commit(); !placed) return forward_error(placed);
  }
  Result<FileDigest> digest = digest_file(path);
  return digest ? Result<ordered_json>(scene_entry(scene, *made, *digest)) : forward_error(digest);
}

struct Done {
  std::vector<ordered_json> entries;
  std::size_t kept = 0, failed = 0;
};

/// A scene that cannot be is said, and the others are made; when nothing can be written any more, it ends.
Result<Done> make_all(const SweepRequest& r, const SweepPlan& plan) {
  Done out;
  out.entries.resize(plan.scenes.size());
  if (r.resume) out.entries = entries_kept(plan, r.folder);
  Progress progress("making scenes", plan.scenes.size(), r.quiet);
  IndexFile index(plan, (fs::path(r.folder) / "index.json").string());
  for (std::size_t i = 0; i < plan.scenes.size(); ++i) {
    if (!out.entries[i].is_null()) {
      ++out.kept;
    } else if (Result<ordered_json> entry = make_one(r, plan, plan.scenes[i])) {
      out.entries[i] = std::move(*entry);
      if (!r.dry_run) {
        if (auto written = index.update(out.entries, false); !written) return forward_error(written);
      }
    } else if (entry.error().kind == ErrorKind::io) {
      (void)index.update(out.entries, true);  // the first error is the one to tell
      entry.error().what += "; " + counted(i, "scene") + " of " + human_count(plan.scenes.size()) +
                            " done, --resume goes on from there";
      return forward_error(entry);
    } else {
      progress.clear();
      ++out.failed;
      (void)report_error(entry.error());
    }
    progress.advance();
  }
  if (!r.dry_run) {
    if (auto written = index.update(out.entries, true); !written) return forward_error(written);
  }
  return out;
}

std::string listing(const std::vector<ordered_json>& entries, Format format) {
  std::vector<Table::Column> columns;
  for (const char* name : {"file", "objects", "vertices", "triangles", "moments", "coherence", "bytes"})
    columns.push_back({name, name});
  if (format == Format::csv) columns.push_back({"sha256", ""});
  Table table(columns);
  for (const ordered_json& entry : entries) {
    if (entry.is_null()) continue;
    std::vector<ordered_json> row;
    row.reserve(columns.size());
    for (const Table::Column& column : columns)
      row.push_back(entry.contains(column.name) ? entry[column.name] : ordered_json());
    table.row(std::move(row));
  }
  return table.str(format);
}

Result<void> say_made(const SweepRequest& r, const SweepPlan& plan, const Done& done, double seconds) {
  if (r.format == Format::json) return write_stdout(pretty(sweep_index(plan, done.entries)));
  if (r.format == Format::csv || r.dry_run) {
    if (auto written = write_stdout(listing(done.entries, r.format)); !written) return written;
  }
  if (r.quiet) return {};
  std::uint64_t bytes = 0;
  for (const ordered_json& entry : done.entries)
    bytes += entry.is_null() ? 0 : entry["bytes"].get<std::uint64_t>();
  const std::string where = r.dry_run ? "(not written)" : (fs::path(r.folder) / "index.json").string();
  std::string line =
      where + "  " + counted(plan.scenes.size() - done.failed, "scene") + "  " + human_bytes(bytes);
  if (r.resume) line += "  " + human_count(done.kept) + " kept";
  if (done.failed > 0) line += "  " + human_count(done.failed) + " failed";
  line += "  " + human_seconds(seconds) + "\n";
  (void)std::fputs(line.c_str(), stderr);
  return {};
}

Result<void> check(const SweepRequest& r) {
  if (r.folder.empty() && !r.dry_run)
    return fail(ErrorKind::usage, "--output", "is missing (the folder that the scenes go to)");
  if (r.resume && r.dry_run) return fail(ErrorKind::usage, "--resume", "cannot be used with --dry-run");
  return {};
}

Result<int> work(const SweepRequest& r) {
  const Stopwatch watch;
  const auto config = read_config_file(r.config);
  if (!config) return tl::unexpected(config.error());
  const Result<SweepPlan> plan = plan_sweep(*config, r.config);
  if (!plan) return tl::unexpected(plan.error());
  if (!r.dry_run) {
    if (auto made = make_folder(r.folder); !made) return forward_error(made);
  }
  const Result<Done> done = make_all(r, *plan);
  if (!done) return tl::unexpected(done.error());
  if (auto said = say_made(r, *plan, *done, watch.seconds()); !said) return forward_error(said);
  return done->failed > 0 ? 1 : 0;
}

}  // namespace

int sweep_verb(std::span<const std::string> arguments) {
  SweepRequest r;
  Options options("scenegen sweep", {"scenegen sweep CONFIG -o DIR [options]"},
                  "makes a scene of every combination of parameters, and an index of them.");
  options.positional(
      "CONFIG", r.config,
      "JSON object of options of scenegen without their dashes; an array is a list of values to "
      "go through, the last array fastest (docs/SWEEP.md); - is stdin");
  options.group("Output");
  options.add("-o,--output", text_value(r.folder, "DIR"),
              "folder for the scenes and index.json; made when it is not there");
  options.flag("--resume", r.resume,
               "keep scenes of an earlier run whose files are still what its index says");
  options.flag("--dry-run", r.dry_run,
               "print scenes, counts and bytes and write nothing; the scenes are built in memory");
  options.add("--format", format_value(r.format), "form of what is printed on stdout; json: the index");
  options.group("General");
  options.add("--threads", whole_value<std::uint32_t>(r.threads, 0, limits::kMaxThreads),
              "0: one per processor; never changes the files");
  options.add_general(r.quiet);
  return run_verb(options, arguments, {.check = [&] { return check(r); }, .work = [&] { return work(r); }});
}

}  // namespace scenegen::tools
