#include "tools/experiments/paper.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>

#include "tools/experiments/paper_files.h"

namespace scenegen::tools {
namespace {

std::vector<std::string> fields_of(std::string_view line) {
  std::vector<std::string> out(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;  // no field holds quotes itself
    } else if (c == ',' && !quoted) {
      out.emplace_back();
    } else if (c != '\r') {
      out.back() += c;
    }
  }
  return out;
}

}  // namespace

PaperTable::PaperTable(std::string_view name) {
  const auto* file = std::find_if(kPaperFiles.begin(), kPaperFiles.end(),
                                  [&](const PaperFile& f) { return f.name == name; });
  assert(file != kPaperFiles.end());
  for (std::size_t begin = 0; begin < file->text.size();) {
    const std::size_t end = std::min(file->text.find('\n', begin), file->text.size());
    const std::string_view line = file->text.substr(begin, end - begin);
    begin = end + 1;
    if (line.empty()) continue;
    if (columns_.empty()) {
      columns_ = fields_of(line);
    } else {
      rows_.push_back(fields_of(line));
      rows_.back().resize(columns_.size());
    }
  }
}

std::size_t PaperTable::column(std::string_view name) const {
  const auto found = std::find(columns_.begin(), columns_.end(), name);
  assert(found != columns_.end());
  return static_cast<std::size_t>(found - columns_.begin());
}

const std::string& PaperTable::word(std::size_t row, std::string_view name) const {
  return rows_[row][column(name)];
}

double PaperTable::value(std::size_t row, std::string_view name) const {
  return std::strtod(word(row, name).c_str(), nullptr);
}

std::optional<double> PaperTable::number(const Where& where, std::string_view name) const {
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    const bool all = std::all_of(where.begin(), where.end(),
                                 [&](const auto& w) { return word(row, w.first) == w.second; });
    if (!all) continue;
    const std::string& text = word(row, name);
    char* end = nullptr;
    const double v = std::strtod(text.c_str(), &end);
    return end == text.c_str() ? std::nullopt : std::optional<double>(v);
  }
  return std::nullopt;
}

Cell PaperTable::cell(const Where& where, std::string_view name) const {
  const std::optional<double> v = number(where, name);
  return v ? Cell(*v) : Cell();
}

}  // namespace scenegen::tools
