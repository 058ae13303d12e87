#include "tools/experiments/run.h"

#include <algorithm>

namespace scenegen::tools {

using nlohmann::ordered_json;

std::string experiment_list() {
  std::string out;
  for (const Experiment& e : experiments()) {
    std::string name(e.name);
    name.resize(std::max<std::size_t>(name.size(), 20), ' ');
    std::string source(e.source);
    source.resize(std::max<std::size_t>(source.size(), 7), ' ');
    bool first = true;
    for (const std::string& line : wrap(e.summary, 70)) {
      out.append(first ? name : std::string(name.size(), ' ')).append("  ");
      out.append(first ? source : std::string(source.size(), ' ')).append(line).append("\n");
      first = false;
    }
  }
  out += "all" + std::string(26, ' ') + "all of them, in this order\n";
  return out;
}

Result<std::vector<const Experiment*>> find_experiments(const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const Experiment& e : experiments()) known.emplace_back(e.name);
  known.emplace_back("all");
  std::vector<const Experiment*> out;
  const auto add = [&](const Experiment& e) {
    if (std::find(out.begin(), out.end(), &e) == out.end()) out.push_back(&e);
  };
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      return fail(ErrorKind::usage, "NAME", unknown_word("experiment", name, known));
    for (const Experiment& e : experiments()) {
      if (name == "all" || name == e.name) add(e);
    }
  }
  return out;
}

ordered_json experiment_json(const ordered_json& run, const ExperimentResults& results) {
  ordered_json out{{"schema", "sceneplay/experiment"}, {"version", 1}};
  out.update(run);
  ordered_json& failures = out["failures"] = ordered_json::array();
  for (const auto& [name, error] : results.failures)
    failures.push_back({{"experiment", name}, {"error", error.str()}});
  out["document"] = document_json(results.document);
  return out;
}

std::vector<std::pair<std::string, std::string>> table_files(const Document& document) {
  std::vector<std::pair<std::string, std::string>> out;
  for (const DocumentSection& section : document.sections) {
    for (const Block& block : section.blocks) {
      const auto* table = std::get_if<DocumentTable>(&block);
      if (table == nullptr) continue;
      std::vector<Table::Column> columns;
      for (const Column& c : table->columns) columns.push_back({c.name, c.title});
      Table csv(std::move(columns));
      for (const std::vector<Cell>& row : table->rows) {
        std::vector<ordered_json> values;
        for (const Cell& cell : row) {
          if (const auto* number = std::get_if<double>(&cell)) {
            values.emplace_back(*number);
          } else if (const auto* word = std::get_if<std::string>(&cell)) {
            values.emplace_back(*word);
          } else {
            values.emplace_back("");
          }
        }
        csv.row(std::move(values));
      }
      out.emplace_back(table->id + ".csv", csv.str(Format::csv));
    }
  }
  return out;
}

}  // namespace scenegen::tools
