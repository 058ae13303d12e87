// Documents as JSON: written whole, read as data of a stranger.
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "tools/report/document.h"
#include "tools/text.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;

// What a report can show; a file above it is damaged or no report of ours. Rows and points are what is large,
// and those of all tables are bounded by the size of the file.
constexpr std::size_t kMostText = 20'000;  // characters of a paragraph or a note
constexpr std::size_t kMostName = 1'000;   // of a title, a cell, a fact
constexpr std::size_t kMostId = 100;
constexpr std::size_t kMostFacts = 1'000;
constexpr std::size_t kMostSections = 1'000;
constexpr std::size_t kMostParagraphs = 1'000;
constexpr std::size_t kMostBlocks = 1'000;
constexpr std::size_t kMostFailures = 100'000;
constexpr std::size_t kMostVerdicts = 1'000;
constexpr std::size_t kMostPictures = 100;  // each up to some 0.5 MB of the page
constexpr std::size_t kMostColumns = 256;
constexpr std::size_t kMostRows = 100'000;
constexpr std::size_t kMostSeries = 64;
constexpr std::size_t kMostPoints = 100'000;
constexpr int kMostDigits = 17;

constexpr std::array<std::string_view, 2> kOrigins{"ours", "paper"};
constexpr std::array<std::string_view, 3> kBetter{"none", "lower", "higher"};
constexpr std::array<std::string_view, 5> kFindings{"better", "level", "worse", "agrees", "differs"};
constexpr std::array<std::string_view, 3> kKinds{"table", "chart", "picture"};

// ---- Writing ---------------------------------------------------------------------------------------------

/// JSON has no NaN and no infinity: such a figure was not measured.
ordered_json number_json(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json();
}

ordered_json cell_json(const Cell& cell) {
  if (const auto* number = std::get_if<double>(&cell)) return number_json(*number);
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  return nullptr;
}

ordered_json column_json(const Column& column) {
  ordered_json out{{"name", column.name},
                   {"title", column.title},
                   {"unit", column.unit},
                   {"origin", kOrigins[static_cast<std::size_t>(column.origin)]},
                   {"better", kBetter[static_cast<std::size_t>(column.better)]}};
  if (!column.against.empty()) out["against"] = column.against;
  out["digits"] = column.digits;
  return out;
}

ordered_json block_json(const DocumentTable& table) {
  ordered_json columns = ordered_json::array();
  for (const Column& column : table.columns) columns.push_back(column_json(column));
  ordered_json rows = ordered_json::array();
  for (const std::vector<Cell>& row : table.rows) {
    ordered_json cells = ordered_json::array();
    for (const Cell& cell : row) cells.push_back(cell_json(cell));
    rows.push_back(std::move(cells));
  }
  return {{"kind", "table"},         {"id", table.id},
          {"title", table.title},    {"columns", std::move(columns)},
          {"rows", std::move(rows)}, {"note", table.note}};
}

ordered_json block_json(const Chart& chart) {
  ordered_json all = ordered_json::array();
  for (const Series& series : chart.series) {
    ordered_json points = ordered_json::array();
    for (const ChartPoint& point : series.points) {
      if (!std::isfinite(point.x) || !std::isfinite(point.y)) continue;
      ordered_json entry{{"x", point.x}, {"y", point.y}};
      if (point.low) entry["low"] = number_json(*point.low);
      if (point.high) entry["high"] = number_json(*point.high);
      points.push_back(std::move(entry));
    }
    all.push_back({{"name", series.name},
                   {"origin", kOrigins[static_cast<std::size_t>(series.origin)]},
                   {"points", std::move(points)}});
  }
  return {{"kind", "chart"},         {"id", chart.id},           {"title", chart.title},
          {"xTitle", chart.x_title}, {"yTitle", chart.y_title},  {"logX", chart.log_x},
          {"logY", chart.log_y},     {"series", std::move(all)}, {"note", chart.note}};
}

ordered_json block_json(const Picture& picture) {
  return {{"kind", "picture"},
          {"id", picture.id},
          {"title", picture.title},
          {"file", picture.file},
          {"note", picture.note}};
}

ordered_json failures_json(const std::vector<Failure>& failures) {
  ordered_json out = ordered_json::array();
  for (const Failure& f : failures) out.push_back({{"what", f.what}, {"why", f.why}});
  return out;
}

ordered_json verdicts_json(const std::vector<Verdict>& verdicts) {
  ordered_json out = ordered_json::array();
  for (const Verdict& v : verdicts) {
    out.push_back({{"source", v.source},
                   {"what", v.what},
                   {"paper", v.paper},
                   {"ours", v.ours},
                   {"finding", word_of(v.finding)},
                   {"why", v.why}});
  }
  return out;
}

// ---- Reading ---------------------------------------------------------------------------------------------

/// The first error is kept; after it, everything reads as empty.
using Found = std::optional<Error>;

bool plain_id(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  });
}

/// One value and its place.
class Reader {
 public:
  Reader(const ordered_json& value, std::string where, Found& found)
      : value_(value), where_(std::move(where)), found_(found) {}

  void bad(const std::string& what) const {
    if (!found_) found_ = Error{ErrorKind::bad_input, where_, what};
  }
  [[nodiscard]] const ordered_json& value() const { return value_; }
  [[nodiscard]] bool failed() const { return found_.has_value(); }

  /// Calls use(reader) for a member; one that is missing is an error unless `optional`.
  template <class F>
  void member(const char* name, F&& use, bool optional = false) const {
    if (found_) return;
    if (!value_.is_object()) return bad("is not an object");
    const auto it = value_.find(name);
    if (it != value_.end()) return use(Reader(*it, where_ + "/" + name, found_));
    if (!optional) Reader(value_, where_ + "/" + name, found_).bad("is missing");
  }
  /// Calls use(reader) for every element.
  template <class F>
  void elements(std::size_t most, F&& use) const {
    if (found_) return;
    if (!value_.is_array()) return bad("is not an array");
    if (value_.size() > most)
      return bad("has " + std::to_string(value_.size()) + " entries; at most " + std::to_string(most));
    for (std::size_t i = 0; i < value_.size() && !found_; ++i)
      use(Reader(value_[i], where_ + "/" + std::to_string(i), found_));
  }
  void text(std::string& out, std::size_t most) const {
    if (found_) return;
    if (!value_.is_string()) return bad("is not text");
    const auto& text = value_.get_ref<const std::string&>();
    if (text.size() > most)
      return bad("has " + std::to_string(text.size()) + " bytes; at most " + std::to_string(most));
    if (text.find('\0') != std::string::npos) return bad("holds a zero character");
    out = text;
  }
  [[nodiscard]] double number() const {
    if (found_) return 0;
    const double out = value_.is_number() ? value_.get<double>() : NAN;
    if (std::isfinite(out)) return out;
    bad("is not a finite number");
    return 0;
  }

  // Members of an object.
  void text(const char* name, std::string& out, std::size_t most, bool optional = false) const {
    member(
        name, [&](const Reader& in) { in.text(out, most); }, optional);
  }
  void boolean(const char* name, bool& out) const {
    member(
        name,
        [&](const Reader& in) {
          if (!in.value().is_boolean()) return in.bad("is neither true nor false");
          out = in.value().get<bool>();
        },
        true);
  }
  template <class Enum, std::size_t N>
  void word(const char* name, Enum& out, const std::array<std::string_view, N>& words) const {
    member(
        name, [&](const Reader& in) { out = static_cast<Enum>(in.word(words)); }, true);
  }
  /// Index of the word.
  template <std::size_t N>
  [[nodiscard]] std::size_t word(const std::array<std::string_view, N>& words) const {
    std::string text;
    this->text(text, kMostText);
    if (found_) return 0;
    const auto* it = std::find(words.begin(), words.end(), text);
    if (it != words.end()) return static_cast<std::size_t>(it - words.begin());
    bad(unknown_word("value", text, std::vector<std::string>(words.begin(), words.end())));
    return 0;
  }
  void figure(const char* name, std::optional<double>& out) const {
    member(
        name,
        [&](const Reader& in) {
          if (!in.value().is_null()) out = in.number();
        },
        true);
  }
  /// A word that names files and anchors, not in `taken` yet.
  void id(std::string& out, std::set<std::string>& taken) const {
    member("id", [&](const Reader& in) {
      in.text(out, kMostId);
      if (in.failed()) return;
      if (!plain_id(out)) return in.bad("is not a word of letters, digits, - and _");
      if (!taken.insert(out).second) in.bad("'" + out + "' is there twice");
    });
  }

 private:
  const ordered_json& value_;
  std::string where_;
  Found& found_;
};

Cell read_cell(const Reader& in) {
  if (in.value().is_null()) return {};
  if (in.value().is_number()) return in.number();
  std::string text;
  if (!in.value().is_string()) return in.bad("is neither a number, nor text, nor null"), Cell();
  in.text(text, kMostName);
  return text;
}

Column read_column(const Reader& in) {
  Column out;
  in.text("name", out.name, kMostName);
  in.text("title", out.title, kMostName);
  in.text("unit", out.unit, kMostName, true);
  in.word("origin", out.origin, kOrigins);
  in.word("better", out.better, kBetter);
  in.text("against", out.against, kMostName, true);
  in.member(
      "digits",
      [&](const Reader& digits) {
        const double value = digits.number();
        if (value < 1 || value > kMostDigits || value != std::floor(value))
          return digits.bad("is not a whole number from 1 to " + std::to_string(kMostDigits));
        out.digits = static_cast<int>(value);
      },
      true);
  return out;
}

void read_columns(const Reader& in, std::vector<Column>& columns) {
  in.elements(kMostColumns, [&](const Reader& column) {
    columns.push_back(read_column(column));
    const std::string& name = columns.back().name;
    const auto same = [&](const Column& other) { return &other != &columns.back() && other.name == name; };
    if (std::any_of(columns.begin(), columns.end(), same))
      column.member("name", [&](const Reader& at) { at.bad("'" + name + "' is there twice"); });
  });
  if (columns.empty()) in.bad("is empty");
  // What is compared with, once all are known.
  in.elements(kMostColumns, [&](const Reader& column) {
    column.member(
        "against",
        [&](const Reader& at) {
          const auto& name = at.value().get_ref<const std::string&>();
          std::vector<std::string> papers;
          for (const Column& other : columns) {
            if (other.origin == Origin::paper) papers.push_back(other.name);
          }
          if (!name.empty() && std::find(papers.begin(), papers.end(), name) == papers.end())
            at.bad(unknown_word("column of the paper's", name, papers));
        },
        true);
  });
}

DocumentTable read_table(const Reader& in) {
  DocumentTable out;
  in.text("title", out.title, kMostName);
  in.text("note", out.note, kMostText, true);
  in.member("columns", [&](const Reader& columns) { read_columns(columns, out.columns); });
  in.member("rows", [&](const Reader& rows) {
    rows.elements(kMostRows, [&](const Reader& row) {
      std::vector<Cell>& cells = out.rows.emplace_back();
      row.elements(kMostColumns, [&](const Reader& cell) { cells.push_back(read_cell(cell)); });
      if (cells.size() != out.columns.size())
        row.bad("has " + counted(cells.size(), "cell") + "; the table has " +
                counted(out.columns.size(), "column"));
    });
  });
  return out;
}

ChartPoint read_point(const Reader& in) {
  ChartPoint out;
  in.member("x", [&](const Reader& x) { out.x = x.number(); });
  in.member("y", [&](const Reader& y) { out.y = y.number(); });
  in.figure("low", out.low);
  in.figure("high", out.high);
  if (out.low && out.high && *out.low > *out.high) in.bad("low is above high");
  return out;
}

Chart read_chart(const Reader& in) {
  Chart out;
  in.text("title", out.title, kMostName);
  in.text("xTitle", out.x_title, kMostName);
  in.text("yTitle", out.y_title, kMostName);
  in.boolean("logX", out.log_x);
  in.boolean("logY", out.log_y);
  in.text("note", out.note, kMostText, true);
  in.member("series", [&](const Reader& all) {
    all.elements(kMostSeries, [&](const Reader& one) {
      Series& series = out.series.emplace_back();
      one.text("name", series.name, kMostName);
      one.word("origin", series.origin, kOrigins);
      one.member("points", [&](const Reader& points) {
        points.elements(kMostPoints,
                        [&](const Reader& point) { series.points.push_back(read_point(point)); });
      });
    });
  });
  return out;
}

/// A results file must not make a report hold a file of the reader's that is none of its pictures.
bool stays_below(const std::string& path) {
  if (path.empty() || path.front() == '/' || path.find('\\') != std::string::npos) return false;
  std::string_view rest = path;
  while (!rest.empty()) {
    const std::string_view part = rest.substr(0, rest.find('/'));
    if (part == "..") return false;
    rest.remove_prefix(std::min(rest.size(), part.size() + 1));
  }
  return true;
}

Picture read_picture(const Reader& in) {
  Picture out;
  in.text("title", out.title, kMostName);
  in.member("file", [&](const Reader& file) {
    file.text(out.file, kMostName);
    if (!file.failed() && !stays_below(out.file)) file.bad("is not a path below the folder of the results");
  });
  in.text("note", out.note, kMostText, true);
  return out;
}

/// Ids that are taken. Things of different kinds may have the same.
struct Ids {
  std::set<std::string> sections;
  std::array<std::set<std::string>, kKinds.size()> blocks;
};

Block read_block(const Reader& in, Ids& ids) {
  std::size_t kind = 0;
  in.member("kind", [&](const Reader& at) { kind = at.word(kKinds); });
  std::string id;
  in.id(id, ids.blocks[kind]);
  if (in.failed()) return {};
  if (kKinds[kind] == "picture" && ids.blocks[kind].size() > kMostPictures) {
    in.bad("is one picture more than the " + std::to_string(kMostPictures) + " of a document");
    return {};
  }
  const auto named = [&id](auto block) {
    block.id = id;
    return Block(std::move(block));
  };
  if (kKinds[kind] == "table") return named(read_table(in));
  return kKinds[kind] == "chart" ? named(read_chart(in)) : named(read_picture(in));
}

void read_failures(const Reader& in, std::vector<Failure>& out) {
  in.member(
      "failures",
      [&](const Reader& failures) {
        failures.elements(kMostFailures, [&](const Reader& one) {
          Failure& failure = out.emplace_back();
          one.text("what", failure.what, kMostName);
          one.text("why", failure.why, kMostText);
        });
      },
      true);
}

void read_verdicts(const Reader& in, std::vector<Verdict>& out) {
  in.member(
      "verdicts",
      [&](const Reader& verdicts) {
        verdicts.elements(kMostVerdicts, [&](const Reader& one) {
          Verdict& verdict = out.emplace_back();
          one.text("source", verdict.source, kMostName);
          one.text("what", verdict.what, kMostName);
          one.text("paper", verdict.paper, kMostName);
          one.text("ours", verdict.ours, kMostName);
          one.word("finding", verdict.finding, kFindings);
          one.text("why", verdict.why, kMostText);
        });
      },
      true);
}

DocumentSection read_section(const Reader& in, Ids& ids) {
  DocumentSection out;
  in.id(out.id, ids.sections);
  in.text("title", out.title, kMostName);
  in.member("paragraphs", [&](const Reader& paragraphs) {
    paragraphs.elements(kMostParagraphs,
                        [&](const Reader& p) { p.text(out.paragraphs.emplace_back(), kMostText); });
  });
  in.member("blocks", [&](const Reader& blocks) {
    blocks.elements(kMostBlocks, [&](const Reader& b) { out.blocks.push_back(read_block(b, ids)); });
  });
  read_failures(in, out.failures);
  read_verdicts(in, out.verdicts);
  return out;
}

}  // namespace

std::string_view word_of(Finding finding) {
  return kFindings[static_cast<std::size_t>(finding)];
}

ordered_json document_json(const Document& document) {
  ordered_json facts = ordered_json::array();
  for (const auto& [name, value] : document.facts) facts.push_back({{"name", name}, {"value", value}});
  ordered_json sections = ordered_json::array();
  for (const DocumentSection& section : document.sections) {
    ordered_json blocks = ordered_json::array();
    for (const Block& block : section.blocks)
      blocks.push_back(std::visit([](const auto& b) { return block_json(b); }, block));
    sections.push_back({{"id", section.id},
                        {"title", section.title},
                        {"paragraphs", section.paragraphs},
                        {"blocks", std::move(blocks)}});
    if (!section.verdicts.empty()) sections.back()["verdicts"] = verdicts_json(section.verdicts);
    if (!section.failures.empty()) sections.back()["failures"] = failures_json(section.failures);
  }
  ordered_json out{{"title", document.title}, {"facts", std::move(facts)}, {"sections", std::move(sections)}};
  if (!document.failures.empty()) out["failures"] = failures_json(document.failures);
  return out;
}

Result<Document> document_from_json(const ordered_json& json, const std::string& pointer) {
  Found found;
  const Reader in(json, pointer, found);
  Document out;
  Ids ids;
  in.text("title", out.title, kMostName);
  in.member("facts", [&](const Reader& facts) {
    facts.elements(kMostFacts, [&](const Reader& fact) {
      auto& [name, value] = out.facts.emplace_back();
      fact.text("name", name, kMostName);
      fact.text("value", value, kMostText);
    });
  });
  in.member("sections", [&](const Reader& sections) {
    sections.elements(kMostSections, [&](const Reader& s) { out.sections.push_back(read_section(s, ids)); });
  });
  read_failures(in, out.failures);
  if (found) return tl::unexpected<Error>(std::move(*found));
  return out;
}

}  // namespace scenegen::tools
