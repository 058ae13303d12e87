#include "timeline/schedule/plan_build.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <iostream>

#include "scene/limits.h"
#include "timeline/schedule/plan_values.h"

namespace scenegen::timeline {

namespace {

struct ColumnNames {
  Column column;
  std::string_view words;  ///< between blanks, plain
};
constexpr std::array<ColumnNames, kColumnCount> kColumns{{
    {Column::id, " id taskid uid uniqueid activityid "},
    {Column::name, " name taskname task activity activityname title "},
    {Column::start, " start startdate begin plannedstart "},
    {Column::finish, " finish finishdate end enddate plannedfinish plannedend "},
    {Column::duration, " duration "},
    {Column::type, " type tasktype "},
    {Column::parent, " parent parentid parenttask "},
    {Column::predecessors, " predecessors predecessor dependson "},
    {Column::objects, " objects object elements guids "},
    {Column::selector, " selector selectors selection "},
    {Column::offset, " offset move "},
}};

/// Non-empty pieces between any of `separators`.
template <class F>
void each_piece(std::string_view text, std::string_view separators, F&& f) {
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
    const std::string_view piece = trimmed(text.substr(begin, end - begin));
    if (!piece.empty()) f(piece);
    begin = end + 1;
  }
}

Result<glm::vec3> parse_offset(std::string_view text) {
  glm::vec3 out{0.0F};
  int count = 0;
  bool ok = true;
  each_piece(text, " ;\t\n\r", [&](std::string_view piece) {
    double value = 0;
    if (piece.starts_with('+')) piece.remove_prefix(1);
    const auto [end, code] = std::from_chars(piece.data(), piece.data() + piece.size(), value);
    ok = ok && code == std::errc() && end == piece.data() + piece.size() && std::abs(value) <= 1e6;
    if (count < 3) out[count] = static_cast<float>(value);
    ++count;
  });
  if (ok && count == 3) return out;
  return fail(
      ErrorKind::bad_input, "",
      in_quotes(text) + ": wanted three numbers of metres, x y z with z up, each within 1000000 (12 0 -3.5)");
}

Result<std::string> read_bytes(const std::string& path) {
  std::ifstream file;
  if (path != "-") {
    file.open(path, std::ios::binary);
    if (!file) return fail(ErrorKind::io, path, "cannot be read");
  }
  std::istream& in = path == "-" ? std::cin : file;
  const std::string name = path == "-" ? "stdin" : path;
  std::string out;
  std::array<char, 65536> piece;
  while (in && out.size() <= limits::kMaxPlanBytes) {
    in.read(piece.data(), piece.size());
    out.append(piece.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (out.size() > limits::kMaxPlanBytes) {
    return fail(ErrorKind::bad_input, name,
                "is larger than " + std::to_string(limits::kMaxPlanBytes >> 20) + " MiB");
  }
  if (!in.eof()) return fail(ErrorKind::io, name, "cannot be read");
  return out;
}

}  // namespace

Column column_of(std::string_view title) {
  const std::string plain = plain_word(title.substr(0, 64));
  if (plain.empty()) return Column::none;
  for (const ColumnNames& column : kColumns) {
    if (column.words.find(" " + plain + " ") != std::string_view::npos) return column.column;
  }
  return Column::none;
}

Result<void> take_cell(Task& task, Column column, std::string_view text, const PlanOptions& options) {
  const std::string_view cell = trimmed(text);
  if (cell.empty()) return {};
  if (column == Column::name) {
    task.name = cell;
  } else if (column == Column::start || column == Column::finish) {
    auto moment = parse_moment(cell, options.date_order);
    if (!moment) return forward_error(moment);
    // A day as a finish is worked on to its end: a task from 1 March to 1 March takes a day.
    const bool to_the_end = column == Column::finish && !moment->has_time;
    (column == Column::start ? task.start_s : task.finish_s) = moment->at_s + (to_the_end ? kDay : 0);
  } else if (column == Column::duration) {
    auto duration = parse_duration(cell);
    if (!duration) return forward_error(duration);
    task.duration_s = *duration;
  } else if (column == Column::type) {
    auto type = parse_task_type(cell);
    if (!type) return forward_error(type);
    task.profile = *type;
  } else if (column == Column::objects) {
    each_piece(cell, ";\n", [&](std::string_view piece) { task.objects.emplace_back(piece); });
  } else if (column == Column::selector) {
    each_piece(cell, "\n", [&](std::string_view piece) { task.selectors.emplace_back(piece); });
  } else if (column == Column::offset) {
    auto offset = parse_offset(cell);
    if (!offset) return forward_error(offset);
    task.offset_z_up_m = *offset;
  }
  return {};
}

/// "+2d" of "A + 2d"
std::string lag_of(std::string_view piece, std::string_view id) {
  std::string out(trimmed(trimmed(piece).substr(id.size())));
  if (const auto last = out.back(); last >= '0' && last <= '9') out += 'd';
  return out;
}

Result<void> take_predecessors(Task& task, std::uint32_t self, std::string_view text,
                               const std::unordered_map<std::string, std::uint32_t>& ids) {
  Result<void> done;
  each_piece(text, ";,\n", [&](std::string_view piece) {
    if (!done) return;
    Link link;
    auto found = ids.find(std::string(piece));
    if (found == ids.end()) {
      auto parsed = parse_link(piece);
      if (!parsed) {
        done = forward_error(parsed);
        return;
      }
      if (parsed->lag_without_kind &&
          ids.count(std::string(parsed->id)) != 0) {  // 'A-2' may be a typing error
        done = fail(ErrorKind::bad_input, "",
                    "no task is called " + in_quotes(piece) + "; a lag stands behind FS, SS, FF or SF: " +
                        std::string(parsed->id) + "FS" + lag_of(piece, parsed->id));
        return;
      }
      link.kind = parsed->kind;
      link.lag_s = parsed->lag_s;
      found = ids.find(std::string(parsed->id));
    }
    if (found == ids.end()) {
      done = fail(ErrorKind::bad_input, "",
                  "no task is called " + in_quotes(piece) +
                      " (a predecessor is an id, alone or with FS, SS, FF or SF and a lag: 3FS+2d)");
    } else if (found->second == self) {
      done = fail(ErrorKind::bad_input, "", in_quotes(piece) + ": a task cannot be its own predecessor");
    } else {
      link.task = found->second;
      task.predecessors.push_back(link);
    }
  });
  return done;
}

Result<Plan> parse_plan(std::string_view bytes, const std::string& name, const PlanOptions& options) {
  const auto utf16 = bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF");
  const std::size_t first = bytes.find_first_not_of("\xEF\xBB\xBF \t\r\n");
  const bool xml = (first != std::string_view::npos && bytes[first] == '<') ||
                   (utf16 && bytes.substr(2, 64).find('<') != std::string_view::npos);
  auto plan = xml ? parse_plan_msproject(bytes, name, options) : parse_plan_csv(bytes, name, options);
  if (!plan) return plan;
  plan->path = name;
  if (auto dated = compute_dates(*plan); !dated) return forward_error(dated);
  return plan;
}

Result<Plan> read_plan(const std::string& path, const PlanOptions& options) {
  auto bytes = read_bytes(path);
  if (!bytes) return forward_error(bytes);
  return parse_plan(*bytes, path == "-" ? "stdin" : path, options);
}

}  // namespace scenegen::timeline
