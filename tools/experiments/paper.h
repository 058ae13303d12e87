// The papers' figures, built into the program (tools/experiments/reference/).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/report/document.h"

namespace scenegen::tools {

/// A file of reference/: words in rows under named columns.
class PaperTable {
 public:
  /// `name` without ".csv"; it must be one of them.
  explicit PaperTable(std::string_view name);

  using Where = std::vector<std::pair<std::string_view, std::string>>;  ///< column, value
  /// The number in `column` of the first row with these values; none when there is no such row, or no number.
  [[nodiscard]] std::optional<double> number(const Where& where, std::string_view column) const;
  /// The same as a cell, empty when there is none.
  [[nodiscard]] Cell cell(const Where& where, std::string_view column) const;
  [[nodiscard]] std::size_t rows() const { return rows_.size(); }
  [[nodiscard]] const std::string& word(std::size_t row, std::string_view column) const;
  [[nodiscard]] double value(std::size_t row, std::string_view column) const;

 private:
  [[nodiscard]] std::size_t column(std::string_view name) const;
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace scenegen::tools
