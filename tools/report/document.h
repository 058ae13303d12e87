// What a measurement found, as tables, charts and pictures: experiments and benchmarks make it, write.h turns
// it into files.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "scene/result.h"

namespace scenegen::tools {

/// Whose figures stand in a column or on a curve. The paper's are drawn dashed and never stand alone.
enum class Origin : std::uint8_t { ours, paper };
/// What a reader wants of a figure; `none`: it is a fact, neither good nor bad.
enum class Better : std::uint8_t { none, lower, higher };

/// A figure, a word, or nothing ("-": not measured, does not apply).
using Cell = std::variant<std::monostate, double, std::string>;

struct Column {
  std::string name;   ///< in JSON and CSV: "frameMs"
  std::string title;  ///< for people: "frame"
  std::string unit;   ///< "ms", "B", "%"; "" when it has none
  Origin origin = Origin::ours;
  Better better = Better::none;
  /// Name of the column of the paper's that this one of ours is compared with; the report marks each cell as
  /// better or worse. "" when there is none.
  std::string against = {};
  int digits = 3;  ///< significant digits for people; files hold all of them
};

struct DocumentTable {
  std::string id;  ///< a word, unique in its document: file names and anchors
  std::string title;
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;  ///< a cell a column
  std::string note = {};  ///< what a reader must know to read it right; where the paper's are from
};

struct ChartPoint {
  double x = 0, y = 0;
  std::optional<double> low = {}, high = {};  ///< spread of y
};
struct Series {
  std::string name;
  std::vector<ChartPoint> points;  ///< in the order in which they are joined
  Origin origin = Origin::ours;
};
struct Chart {
  std::string id;
  std::string title;
  std::string x_title, y_title;  ///< with units: "frame time, ms"
  std::vector<Series> series;
  bool log_x = false, log_y = false;
  std::string note = {};
};

struct Picture {
  std::string id;
  std::string title;
  std::string file;  ///< PNG or JPEG, relative to the folder of the results file
  std::string note = {};
};

using Block = std::variant<DocumentTable, Chart, Picture>;

/// What was to be measured and could not be.
struct Failure {
  std::string what;  ///< the case: "town.glb, orbit: octree"
  std::string why;
};

/// What came out beside the paper: of figures how ours stand, of what it says in words whether it is so here.
enum class Finding : std::uint8_t { better, level, worse, agrees, differs };

/// A table or a claim of the paper's beside what was found, in one line: what a reader sees first.
struct Verdict {
  std::string source;       ///< "D table 32"
  std::string what;         ///< what is compared: "gain of adaptive at C = 1"
  std::string paper, ours;  ///< figures with their units, or words
  Finding finding = Finding::level;
  std::string why;  ///< the reason, from what was measured where that can be
};

struct DocumentSection {
  std::string id;
  std::string title;
  std::vector<std::string> paragraphs;  ///< plain text; the first says in one sentence what came out
  std::vector<Block> blocks;
  std::vector<Failure> failures = {};  ///< of its cases
  std::vector<Verdict> verdicts = {};
};

struct Document {
  std::string title;
  std::vector<std::pair<std::string, std::string>>
      facts;  ///< machine, device, driver, versions, seed, arguments
  std::vector<DocumentSection> sections;
  std::vector<Failure> failures = {};  ///< of what would have been sections
};

/// "better", "level", "worse", "agrees", "differs".
[[nodiscard]] std::string_view word_of(Finding finding);

/// {"title", "facts", "sections": [{"id", "title", "paragraphs", "blocks": [{"kind":
/// "table"|"chart"|"picture", …}], "failures", "verdicts": [{"source", "what", "paper", "ours", "finding",
/// "why"}]}], "failures": [{"what", "why"}]}; failures and verdicts only where there are some.
[[nodiscard]] nlohmann::ordered_json document_json(const Document& document);
/// The error's `where` is a JSON pointer below `pointer`.
[[nodiscard]] Result<Document> document_from_json(const nlohmann::ordered_json& json,
                                                  const std::string& pointer);

}  // namespace scenegen::tools
