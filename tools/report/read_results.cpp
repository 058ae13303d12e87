#include "tools/report/read_results.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include "tools/text.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr std::array<const char*, 2> kNames{"experiment.json", "bench.json"};
constexpr const char* kExperiment = "sceneplay/experiment";

Result<std::string> read_text(const std::string& file) {
  constexpr std::size_t kMost = std::size_t{32} << 20;  // parsed, up to 20 times as much
  std::error_code error;
  if (fs::is_directory(file, error)) return fail(ErrorKind::io, file, "is a folder");
  std::ifstream in(file, std::ios::binary);
  if (!in) return fail(ErrorKind::io, file, "cannot be read");
  std::string out;
  for (std::array<char, 65536> part{}; out.size() <= kMost && in;) {
    in.read(part.data(), part.size());
    out.append(part.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (in.bad()) return fail(ErrorKind::io, file, "cannot be read");
  if (out.size() > kMost) return fail(ErrorKind::bad_input, file, "is larger than 32 MiB: no results file");
  return out;
}

Result<ordered_json> parse(const std::string& file, const std::string& text) {
  if (const std::string_view excess = json_excess(text); !excess.empty())
    return fail(ErrorKind::bad_input, file, "is damaged: it " + std::string(excess));
  try {
    return ordered_json::parse(text);
  } catch (const nlohmann::json::exception& error) {
    std::string what = error.what();  // "[json.exception.parse_error.101] parse error at line 1, ..."
    what.erase(0, what.find("] ") == std::string::npos ? 0 : what.find("] ") + 2);
    constexpr std::size_t kMost = 160;
    if (what.size() > kMost) what = what.substr(0, kMost) + "...";
    std::replace(what.begin(), what.end(), '\n', ' ');
    return fail(ErrorKind::bad_input, file, "is damaged: " + what);
  }
}

std::string text_of(const ordered_json& json, const char* name) {
  const auto it = json.is_object() ? json.find(name) : json.end();
  return json.is_object() && it != json.end() && it->is_string() ? it->get<std::string>() : "";
}

/// {"experiment", "error"} of an experiments file, which has them beside its document.
Result<std::vector<Failure>> failures_of(const std::string& file, const ordered_json& json) {
  std::vector<Failure> out;
  const auto all = json.find("failures");
  if (all == json.end()) return out;
  if (!all->is_array()) return fail(ErrorKind::bad_input, file + ": /failures", "is not an array");
  for (const ordered_json& one : *all) {
    out.push_back({text_of(one, "experiment"), text_of(one, "error")});
    if (!out.back().what.empty() && !out.back().why.empty()) continue;
    return fail(ErrorKind::bad_input, file + ": /failures/" + std::to_string(out.size() - 1),
                "has no text experiment or no text error");
  }
  return out;
}

Result<void> check_version(const std::string& file, const ordered_json& json) {
  const auto it = json.find("version");
  if (it == json.end()) return fail(ErrorKind::bad_input, file + ": /version", "is missing");
  if (*it == 1) return {};
  std::string version = it->dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  version.resize(std::min<std::size_t>(version.size(), 20));
  return fail(ErrorKind::bad_input, file + ": /version", "is " + version + "; this program reads 1");
}

}  // namespace

Result<std::string> results_schema(const std::string& file) {
  const Result<std::string> text = read_text(file);
  if (!text) return tl::unexpected(text.error());
  const Result<ordered_json> json = parse(file, *text);
  if (!json) return tl::unexpected(json.error());
  std::string schema = text_of(*json, "schema");
  if (schema.empty()) return fail(ErrorKind::bad_input, file, "is no results file: it has no schema");
  return schema;
}

Result<ReportRun> read_results(const std::string& file) {
  const Result<std::string> text = read_text(file);
  if (!text) return tl::unexpected(text.error());
  const Result<ordered_json> json = parse(file, *text);
  if (!json) return tl::unexpected(json.error());
  const std::string schema = text_of(*json, "schema");
  if (schema.empty()) return fail(ErrorKind::bad_input, file, "is no results file: it has no schema");
  if (schema != kExperiment) {
    const std::array<std::string, 2> known{kExperiment, "sceneplay/bench"};  // the latter: bench_report.h
    return fail(ErrorKind::bad_input, file + ": /schema", unknown_word("schema", schema, known));
  }
  if (auto good = check_version(file, *json); !good) return forward_error(good);
  const auto document = json->find("document");
  if (document == json->end()) return fail(ErrorKind::bad_input, file + ": /document", "is missing");
  Result<Document> read = document_from_json(*document, file + ": /document");
  if (!read) return forward_error(read);
  auto failures = failures_of(file, *json);
  if (!failures) return forward_error(failures);
  read->failures.insert(read->failures.end(), failures->begin(), failures->end());
  return ReportRun{std::move(*read), fs::path(file).parent_path().string()};
}

Result<std::vector<std::string>> results_files(const std::string& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return std::vector<std::string>{path};
  std::vector<std::string> out;
  const auto add = [&out](const fs::path& folder) {
    for (const char* name : kNames) {
      std::error_code ignored;
      if (fs::is_regular_file(folder / name, ignored)) out.push_back((folder / name).string());
    }
  };
  add(path);
  if (!out.empty()) return out;
  std::vector<fs::path> folders;
  for (fs::directory_iterator it(path, error); !error && it != fs::directory_iterator();
       it.increment(error)) {
    std::error_code ignored;
    if (it->is_directory(ignored)) folders.push_back(it->path());
  }
  if (error) return fail(ErrorKind::io, path, "cannot be read: " + error.message());
  std::sort(folders.begin(), folders.end());
  for (const fs::path& folder : folders) add(folder);
  if (out.empty())
    return fail(ErrorKind::io, path,
                "neither this folder nor one in it holds an experiment.json or bench.json");
  return out;
}

}  // namespace scenegen::tools
