#include "timeline/schedule/csv_rows.h"

#include <csv.h>
#include <simdjson.h>

#include <algorithm>
#include <array>
#include <cstdio>

namespace scenegen::timeline {

namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// Whether a line ends at a byte: files end them with \n, \r\n or (old spreadsheets of Macs) \r alone.
bool ends_line(std::string_view bytes, std::size_t at) {
  return bytes[at] == '\n' || (bytes[at] == '\r' && (at + 1 == bytes.size() || bytes[at + 1] != '\n'));
}

/// 1 for a byte of the first line.
std::uint64_t line_of(std::string_view bytes, std::size_t offset) {
  std::uint64_t line = 1;
  for (std::size_t i = 0; i < offset; ++i) line += ends_line(bytes, i) ? 1 : 0;
  return line;
}

/// Offset of the first byte that is no UTF-8: of the first line that is none, then byte by byte.
std::size_t first_bad_byte(std::string_view bytes) {
  std::size_t begin = 0;
  for (;;) {
    const std::size_t end = std::min(bytes.find('\n', begin), bytes.size());
    if (!simdjson::validate_utf8(bytes.data() + begin, end - begin)) break;
    if (end == bytes.size()) return end;
    begin = end + 1;
  }
  std::size_t good = begin;
  while (good < bytes.size()) {
    std::size_t length = 1;
    while (length <= 4 && good + length <= bytes.size() &&
           !simdjson::validate_utf8(bytes.data() + good, length))
      ++length;
    if (length > 4 || good + length > bytes.size()) return good;
    good += length;
  }
  return good;
}

tl::unexpected<Error> not_utf8(std::string_view bytes, const std::string& name) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) {
    return fail(ErrorKind::bad_input, at_line(name, 1), "is UTF-16; save the plan as CSV in UTF-8");
  }
  const std::size_t bad = first_bad_byte(bytes);
  const std::size_t newline = bad == 0 ? std::string_view::npos : bytes.find_last_of("\r\n", bad - 1);
  const std::size_t begin = newline == std::string_view::npos ? 0 : newline + 1;
  const auto column = std::count_if(bytes.begin() + static_cast<std::ptrdiff_t>(begin),
                                    bytes.begin() + static_cast<std::ptrdiff_t>(bad),
                                    [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; });
  std::array<char, 8> hex{};
  (void)std::snprintf(hex.data(), hex.size(), "0x%02X", static_cast<unsigned char>(bytes[bad]));
  return fail(ErrorKind::bad_input,
              at_line(name, line_of(bytes, bad)) + ", character " + std::to_string(column + 1),
              std::string("byte ") + hex.data() +
                  " is no UTF-8; save the plan in UTF-8 (Latin-1 and Windows code pages are not read)");
}

/// What stands most often between quotes of the first line that is not empty; a comma when nothing does.
char find_delimiter(std::string_view bytes) {
  constexpr std::string_view kDelimiters = ",;\t";
  std::array<std::size_t, 3> counts{};
  bool quoted = false;
  bytes.remove_prefix(std::min(bytes.find_first_not_of("\r\n"), bytes.size()));  // lines that say nothing
  for (const char c : bytes) {
    if (c == '"') quoted = !quoted;
    if (!quoted && (c == '\n' || c == '\r')) break;
    const std::size_t which = quoted ? std::string_view::npos : kDelimiters.find(c);
    if (which != std::string_view::npos) ++counts[which];
  }
  return kDelimiters[static_cast<std::size_t>(std::max_element(counts.begin(), counts.end()) -
                                              counts.begin())];
}

class Parser {
 public:
  Parser(char delimiter, const std::string& name, const std::function<Result<void>(CsvRow&)>& take)
      : name_(name), take_(take) {
    (void)csv_init(&parser_, CSV_STRICT | CSV_STRICT_FINI);
    csv_set_delim(&parser_, static_cast<unsigned char>(delimiter));
    csv_set_blk_size(&parser_, std::size_t{1} << 16);  // a cell's buffer grows by this
  }
  ~Parser() { csv_free(&parser_); }
  Parser(const Parser&) = delete;
  Parser& operator=(const Parser&) = delete;

  /// A byte at a time: libcsv does not say where in its input a record begins.
  Result<void> run(std::string_view bytes, std::uint64_t first_line) {
    line_ = first_line;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const char& c = bytes[i];
      const bool line_end = c == '\n' || c == '\r';
      if (fresh_ && !line_end) {
        row_.line = line_;
        fresh_ = false;
      }
      if (csv_parse(&parser_, &c, 1, on_field, on_row, this) != 1) return broken();
      if (!done_) return std::move(done_);
      if (ends_line(bytes, i)) ++line_;
    }
    if (csv_fini(&parser_, on_field, on_row, this) != 0) {
      if (csv_error(&parser_) != CSV_EPARSE) return broken();
      return fail(ErrorKind::bad_input, at_line(name_, row_.line), "a quote of this record is not closed");
    }
    return std::move(done_);
  }

 private:
  Result<void> broken() {
    if (csv_error(&parser_) != CSV_EPARSE)
      return fail(ErrorKind::bad_input, at_line(name_, line_), csv_strerror(csv_error(&parser_)));
    return fail(ErrorKind::bad_input, at_line(name_, line_),
                "a quote in a field that does not begin with one, or text behind a closing quote; a field "
                "with quotes stands in quotes, and they are doubled");
  }
  static void on_field(void* text, std::size_t size, void* self) {
    static_cast<Parser*>(self)->row_.cells.emplace_back(static_cast<const char*>(text), size);
  }
  static void on_row(int, void* data) {
    auto& self = *static_cast<Parser*>(data);
    if (self.done_) self.done_ = self.take_(self.row_);
    self.row_.cells.clear();
    self.fresh_ = true;
  }

  csv_parser parser_{};
  const std::string& name_;
  const std::function<Result<void>(CsvRow&)>& take_;
  CsvRow row_;
  std::uint64_t line_ = 1;
  bool fresh_ = true;
  Result<void> done_;
};

}  // namespace

std::string at_line(const std::string& name, std::uint64_t line) {
  return name + ": line " + std::to_string(line);
}

Result<void> read_csv(std::string_view bytes, const std::string& name,
                      const std::function<Result<void>(CsvRow&)>& take) {
  if (!simdjson::validate_utf8(bytes.data(), bytes.size())) return not_utf8(bytes, name);
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  if (const std::size_t zero = bytes.find('\0'); zero != std::string_view::npos)
    return fail(ErrorKind::bad_input, at_line(name, line_of(bytes, zero)),
                "a zero byte; is this a text file?");
  std::uint64_t first_line = 1;
  char delimiter = find_delimiter(bytes);
  if (bytes.starts_with("sep=") && bytes.size() > 4) {  // a spreadsheet's way of saying it
    delimiter = bytes[4];
    if (delimiter != ',' && delimiter != ';' && delimiter != '\t')
      return fail(ErrorKind::bad_input, at_line(name, 1), "'sep=' takes a comma, a semicolon or a tab");
    std::size_t end = 4;
    while (end < bytes.size() && !ends_line(bytes, end)) ++end;
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
    first_line = 2;
  }
  return Parser(delimiter, name, take).run(bytes, first_line);
}

}  // namespace scenegen::timeline
