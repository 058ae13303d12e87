// Which scenes and cameras of several results of benchmarks are the same.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace scenegen::tools {

/// The member at "frameMs/median", or null.
[[nodiscard]] nlohmann::ordered_json bench_member(const nlohmann::ordered_json& object,
                                                  const std::string& path);

/// Results are from other folders and machines, so a scene is known by its name without the folder, as in
/// `bench compare`. Those of one name are kept apart when one result has them at two paths, or when their
/// files or numbers of objects differ.
class BenchNames {
 public:
  /// `member` of a case: "file" or "camera". `results` must outlive it.
  BenchNames(std::span<const nlohmann::ordered_json> results, const std::string& member);

  /// Number of what `result` calls `path`, which is the member of one of its cases.
  [[nodiscard]] std::size_t find(const nlohmann::ordered_json& result, const std::string& path) const;
  /// The name, with what tells it from others of that name.
  [[nodiscard]] const std::string& title(std::size_t number) const { return things_[number].title; }

 private:
  /// As one result has it.
  struct Name {
    const nlohmann::ordered_json* result;
    std::string path;
    double bytes = -1, objects = -1;  ///< of the file; negative: not known
  };
  struct Thing {
    std::string base, title;
    std::vector<Name> names;
  };
  static Name name_of(const nlohmann::ordered_json& result, const std::string& path);
  [[nodiscard]] std::size_t match(const Name& name, bool clash) const;
  void make_titles();

  std::vector<Thing> things_;
};

}  // namespace scenegen::tools
