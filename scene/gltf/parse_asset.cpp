// asset, and what our own files say in asset.extras.scenegen (docs/FORMAT.md 1).
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
