// asset, and what our own files say in asset.extras.scenegen (docs/FORMAT.md 1).
#include <algorithm>
#include <chrono>

#include "scene/gltf/parse.h"
#include "scene/limits.h"

namespace scenegen::gltf::reading {

namespace {

glm::vec3 get_vec3(Value v, const Place& at) {
  const auto f = get_floats<3>(v, at);
  return {f[0], f[1], f[2]};
}

void parse_appearance(Value value, const Place& at, AppearanceInfo& out) {
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "curve") {
      out.curve = get_string(v, p);
    } else if (key == "curveVariant") {
      out.curve_variant = get_string(v, p);
    } else if (key == "order") {
      out.order = get_string(v, p);
    } else if (key == "cells") {
      const std::uint64_t count = each_element(v, p, [&](Value& w, const Place& q) {
        const std::uint64_t cells = get_count(w, q, limits::kMaxCellsPerAxis);
        if (cells == 0) reject(q, "must be at least 1");
        if (q.index < 3) out.cells[static_cast<int>(q.index)] = static_cast<std::uint32_t>(cells);
      });
      if (count != 3) reject(p, "wanted 3 numbers of cells");
      if (std::uint64_t{out.cells.x} * out.cells.y * out.cells.z > limits::kMaxCells) {
        reject(p, "more than " + std::to_string(limits::kMaxCells) + " cells");
      }
    } else if (key == "gridMinZUp") {
      out.grid_z_up_m.lo = get_vec3(v, p);
    } else if (key == "gridMaxZUp") {
      out.grid_z_up_m.hi = get_vec3(v, p);
    } else if (key == "interval") {
      out.interval_s = get_double(v, p);
    } else if (key == "hold") {
      out.hold_s = get_double(v, p);
    } else if (key == "coherence") {
      out.coherence_given = get_double(v, p);
    } else if (key == "coherenceMeasured") {
      out.coherence_measured = get_double(v, p);
    } else if (key == "displaced") {
      out.displaced_objects = get_count(v, p);
    } else if (key == "timed") {
      out.timed_objects = get_count(v, p);
    } else if (key == "moments") {
      out.moments = get_count(v, p);
    } else if (key == "locality") {
      out.locality_cells = get_double(v, p);
    }
  });
}

/// "2024-03-01" or "2024-03-01T08:00:00", and a day that there is.
bool is_civil_time(std::string_view text) {
  constexpr std::string_view kForm = "dddd-dd-ddTdd:dd:dd";
  if (text.size() != 10 && text.size() != kForm.size()) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    if (kForm[i] == 'd' ? !digit : text[i] != kForm[i]) return false;
  }
  const auto number = [&](std::size_t at, std::size_t count) {
    unsigned out = 0;
    for (const char c : text.substr(at, count)) out = out * 10 + static_cast<unsigned>(c - '0');
    return out;
  };
  const std::chrono::year_month_day day{std::chrono::year(static_cast<int>(number(0, 4))),
                                        std::chrono::month(number(5, 2)), std::chrono::day(number(8, 2))};
  const bool clock = text.size() == 10 || (number(11, 2) < 24 && number(14, 2) < 60 && number(17, 2) < 60);
  return number(0, 4) >= 1 && day.ok() && clock;
}

void parse_calendar_task(Value value, const Place& at, CalendarTask& out) {
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "id") {
      out.id = get_string(v, p);
    } else if (key == "name") {
      out.name = get_string(v, p);
    } else if (key == "type") {
      out.type = get_string(v, p);
    } else if (key == "start") {
      out.start_s = get_double(v, p);
    } else if (key == "finish") {
      out.finish_s = get_double(v, p);
    }
  });
  if (!(out.start_s >= 0 && out.finish_s >= out.start_s))
    reject(at, "must start at 0 or later, and not finish before");
}

void parse_calendar(Value value, const Place& at, Calendar& out) {
  out.seconds_per_day = 0;
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "start") {
      out.start = get_string(v, p);
      if (!is_civil_time(out.start)) reject(p, "wanted a date YYYY-MM-DD or YYYY-MM-DDTHH:MM:SS");
    } else if (key == "secondsPerDay") {
      out.seconds_per_day = get_double(v, p);
    } else if (key == "tasks") {
      each_element(v, p,
                   [&](Value& w, const Place& q) { parse_calendar_task(w, q, out.tasks.emplace_back()); });
    }
  });
  if (out.start.empty()) reject(at.key("start"), "missing");
  if (!(out.seconds_per_day > 0)) reject(at.key("secondsPerDay"), "must be above 0");
}

void parse_ours(Value value, const Place& at, Document& out) {
  out.ours = true;
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "format") {
      if (get_count(v, p) != 1) reject(p, "a newer file form than this program reads (1)");
    } else if (key == "source") {
      out.foreign = true;
      each_field(v, p, [&](std::string_view inner, Value& w, const Place& q) {
        if (inner == "generator") out.source_generator = get_string(w, q);
      });
    } else if (key == "seed") {
      out.info.seed = get_count(v, p, limits::kMaxSeed);
    } else if (key == "arguments") {
      each_element(v, p,
                   [&](Value& w, const Place& q) { out.info.arguments.emplace_back(get_string(w, q)); });
    } else if (key == "time") {
      each_field(v, p, [&](std::string_view inner, Value& w, const Place& q) {
        if (inner != "end") return;
        out.end_s = double{get_float(w, q)};
        if (!(out.end_s >= 0)) reject(q, "must not be negative");
      });
    } else if (key == "appearance") {
      parse_appearance(v, p, out.info.appearance.emplace());
    } else if (key == "calendar") {
      parse_calendar(v, p, out.info.calendar.emplace());
    }
  });
}

}  // namespace

void parse_asset(Value value, const Place& at, Document& out) {
  std::string_view version;
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "version") {
      version = get_string(v, p);
    } else if (key == "minVersion") {
      const std::string_view least = get_string(v, p);
      if (least != "2.0") reject(p, "'" + printable(least) + "'; this program reads 2.0");
    } else if (key == "generator") {
      out.info.generator = get_string(v, p);
    } else if (key == "copyright") {
      out.info.copyright = get_string(v, p);
    } else if (key == "extras" && is_object(v)) {
      each_field(v, p, [&](std::string_view owner, Value& w, const Place& q) {
        if (owner == "scenegen" && is_object(w)) parse_ours(w, q, out);
      });
    }
  });
  if (version.substr(0, 2) != "2.")
    reject(at.key("version"), "'" + printable(version) + "'; this program reads 2.x");
}

}  // namespace scenegen::gltf::reading
