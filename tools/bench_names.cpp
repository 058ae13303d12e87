#include "tools/bench_names.h"

#include <algorithm>
#include <map>
#include <set>

#include "tools/bench_case.h"
#include "tools/text.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;

std::vector<std::string> paths_in(const ordered_json& result, const std::string& member) {
  std::vector<std::string> out;
  const auto cases = result.find("cases");
  if (cases == result.end() || !cases->is_array()) return out;
  for (const ordered_json& c : *cases) {
    const ordered_json path = bench_member(c, member);
    std::string text = path.is_string() ? path.get<std::string>() : "";
    if (std::find(out.begin(), out.end(), text) == out.end()) out.push_back(std::move(text));
  }
  return out;
}

bool differ(double a, double b) {
  return a >= 0 && b >= 0 && a != b;
}

}  // namespace

ordered_json bench_member(const ordered_json& object, const std::string& path) {
  const ordered_json* here = &object;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    const std::string name = path.substr(begin, end - begin);
    if (!here->is_object() || !here->contains(name)) return {};
    here = &here->at(name);
    begin = end + 1;
  }
  return *here;
}

BenchNames::BenchNames(std::span<const ordered_json> results, const std::string& member) {
  std::set<std::string> clashes;
  for (const ordered_json& result : results) {
    std::set<std::string> bases;
    for (const std::string& path : paths_in(result, member)) {
      if (!bases.insert(base_name(path)).second) clashes.insert(base_name(path));
    }
  }
  for (const ordered_json& result : results) {
    for (const std::string& path : paths_in(result, member)) {
      const std::string base = base_name(path);
      Name name = name_of(result, path);
      const std::size_t place = match(name, clashes.contains(base));
      if (place == things_.size()) things_.push_back({base, {}, {}});
      things_[place].names.push_back(std::move(name));
    }
  }
  make_titles();
}

/// Cameras are in no list, so of them nothing more is known.
BenchNames::Name BenchNames::name_of(const ordered_json& result, const std::string& path) {
  Name out{&result, path};
  const ordered_json scenes = bench_member(result, "scenes");
  for (const ordered_json& scene : scenes) {
    if (bench_member(scene, "file") != ordered_json(path)) continue;
    const ordered_json bytes = bench_member(scene, "bytes");
    const ordered_json objects = bench_member(scene, "objects");
    if (bytes.is_number()) out.bytes = bytes.get<double>();
    if (objects.is_number()) out.objects = objects.get<double>();
  }
  return out;
}

/// `clash`: some result has two of this name, so that the name alone says nothing.
std::size_t BenchNames::match(const Name& name, bool clash) const {
  const std::string base = base_name(name.path);
  const auto place = std::find_if(things_.begin(), things_.end(), [&](const Thing& thing) {
    return thing.base == base && std::all_of(thing.names.begin(), thing.names.end(), [&](const Name& other) {
             if (other.result == name.result) return false;
             if (differ(other.bytes, name.bytes) || differ(other.objects, name.objects)) return false;
             const bool same_file = other.bytes > 0 && other.bytes == name.bytes;
             return !clash || same_file || other.path == name.path;
           });
  });
  return static_cast<std::size_t>(place - things_.begin());
}

std::size_t BenchNames::find(const ordered_json& result, const std::string& path) const {
  const auto place = std::find_if(things_.begin(), things_.end(), [&](const Thing& thing) {
    return std::any_of(thing.names.begin(), thing.names.end(),
                       [&](const Name& name) { return name.result == &result && name.path == path; });
  });
  return static_cast<std::size_t>(place - things_.begin());
}

void BenchNames::make_titles() {
  std::map<std::string, int> bases;
  std::map<std::string, int> paths;
  for (const Thing& thing : things_) {
    ++bases[thing.base];
    ++paths[thing.names.front().path];
  }
  for (Thing& thing : things_) {
    const Name& first = thing.names.front();
    thing.title = bases[thing.base] > 1 ? first.path : thing.base;
    if (paths[first.path] < 2) continue;
    // The file has changed between two results.
    thing.title +=
        first.objects >= 0 ? ", " + counted(static_cast<std::uint64_t>(first.objects), "object") : "";
    thing.title += first.bytes >= 0 ? ", " + human_bytes(static_cast<std::uint64_t>(first.bytes)) : "";
  }
}

}  // namespace scenegen::tools
