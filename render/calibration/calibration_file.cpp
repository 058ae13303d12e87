#include "render/calibration/calibration_file.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "render/calibration/unit_names.h"

namespace scenegen::render {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr std::string_view kSchema = "sceneplay/calibration";
constexpr int kVersion = 8;
constexpr std::size_t kMostPoints = 64;      // of a curve
constexpr std::size_t kMostBytes = 1 << 20;  // a file has 5 kB
constexpr double kMostUnitBytes = 1e9;
constexpr double kMostSeconds = 100.0;  // no unit takes longer

ordered_json curve_json(const model::Curve& curve) {
  return {{"x", curve.x}, {"y", curve.y}};
}

Error wrong(const std::string& where, const std::string& what) {
  return {ErrorKind::bad_input, where, what};
}

/// Reads members of an object; the first thing that is wrong stays.
class Reader {
 public:
  Reader(const json& object, std::string where) : object_(object), where_(std::move(where)) {
    if (!object.is_object()) error_ = wrong(where_, "must be an object");
  }

  double number(std::string_view name, double least, double most) {
    const json* v = member(name);
    if (v == nullptr) return 0.0;
    if (!v->is_number()) return bad(name, "must be a number"), 0.0;
    const auto value = v->get<double>();
    if (!std::isfinite(value) || value < least || value > most)
      return bad(name,
                 v->dump() + "; must be " + ordered_json(least).dump() + " to " + ordered_json(most).dump()),
             0.0;
    return value;
  }
  bool boolean(std::string_view name) {
    const json* v = member(name);
    if (v != nullptr && !v->is_boolean()) bad(name, "must be true or false");
    return v != nullptr && v->is_boolean() && v->get<bool>();
  }
  std::string text(std::string_view name) {
    const json* v = member(name);
    if (v != nullptr && !v->is_string()) bad(name, "must be a string");
    return v != nullptr && v->is_string() ? v->get<std::string>() : std::string();
  }
  std::vector<std::string> texts(std::string_view name) {
    std::vector<std::string> out;
    const json* v = member(name);
    if (v == nullptr) return out;
    const bool good = v->is_array() && v->size() <= kMostPoints &&
                      std::all_of(v->begin(), v->end(), [](const json& e) { return e.is_string(); });
    if (!good) return bad(name, "must be an array of at most 64 strings"), out;
    for (const json& e : *v) out.push_back(e.get<std::string>());
    return out;
  }
  model::Curve curve(std::string_view name, double most = kMostSeconds) {
    const json* v = member(name);
    if (v == nullptr) return {};
    Reader inner(*v, where_ + "/" + std::string(name));
    model::Curve out{inner.numbers("x", 1e12), inner.numbers("y", most)};
    if (!inner.error_ && out.x.size() != out.y.size())
      inner.error_ = wrong(inner.where_, "x has " + std::to_string(out.x.size()) + " values, y " +
                                             std::to_string(out.y.size()));
    if (!inner.error_ && (out.x.front() <= 0.0 || std::adjacent_find(out.x.begin(), out.x.end(),
                                                                     std::greater_equal<>()) != out.x.end()))
      inner.error_ = wrong(inner.where_ + "/x", "must be positive and ascending");
    if (inner.error_ && !error_) error_ = inner.error_;
    return out;
  }
  /// The member itself, for a Reader of its own.
  const json* member(std::string_view name) {
    if (error_) return nullptr;
    const auto it = object_.find(std::string(name));
    if (it == object_.end()) return bad(name, "is missing"), nullptr;
    return &*it;
  }
  void bad(std::string_view name, const std::string& what) {
    if (!error_) error_ = wrong(where_ + "/" + std::string(name), what);
  }
  void take(const Reader& inner) {
    if (!error_) error_ = inner.error_;
  }
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }
  [[nodiscard]] const std::string& where() const { return where_; }

 private:
  std::vector<double> numbers(std::string_view name, double most) {
    const json* v = member(name);
    if (v == nullptr) return {};
    if (!v->is_array() || v->empty() || v->size() > kMostPoints)
      return bad(name, "must be an array of 1 to 64 numbers"), std::vector<double>{};
    std::vector<double> out;
    for (const json& e : *v) {
      const double value = e.is_number() ? e.get<double>() : -1.0;
      if (!std::isfinite(value) || value < 0.0 || value > most)
        return bad(std::string(name) + "/" + std::to_string(out.size()), "must be a number, 0 or above"), out;
      out.push_back(value);
    }
    return out;
  }

  const json& object_;
  std::string where_;
  std::optional<Error> error_;
};

void read_units(Reader& in, model::UnitCosts& costs) {
  for (const UnitName& unit : unit_names()) {
    if (unit.value != nullptr) {
      costs.*unit.value = in.number(unit.name, 0.0,
                                    unit.share   ? 1.0
                                    : unit.bytes ? kMostUnitBytes
                                                 : kMostSeconds);
    } else if (unit.curve != nullptr) {
      costs.*unit.curve = in.curve(unit.name, unit.share ? 1.0 : kMostSeconds);
    } else if (const json* both = in.member(unit.name)) {
      Reader inner(*both, in.where() + "/" + std::string(unit.name));
      for (std::size_t i = 0; i < model::kShadings; ++i)
        (costs.*unit.curves)[i] = inner.curve(kShadingNames[i]);
      in.take(inner);
    }
  }
}

std::string size_text(glm::uvec2 size) {
  return std::to_string(size.x) + "x" + std::to_string(size.y);
}

}  // namespace

std::string calibration_json(const Calibration& c) {
  ordered_json units;
  for (const UnitName& unit : unit_names()) {
    const std::string name(unit.name);
    if (unit.value != nullptr) {
      units[name] = c.costs.*unit.value;
    } else if (unit.curve != nullptr) {
      units[name] = curve_json(c.costs.*unit.curve);
    } else {
      for (std::size_t i = 0; i < model::kShadings; ++i)
        units[name][std::string(kShadingNames[i])] = curve_json((c.costs.*unit.curves)[i]);
    }
  }
  const ordered_json out{{"schema", kSchema},
                         {"version", kVersion},
                         {"deviceUuid", c.key.device_uuid},
                         {"device", c.key.device},
                         {"driver", c.key.driver},
                         {"size", {c.key.size.x, c.key.size.y}},
                         {"samples", c.key.samples},
                         {"shadows", c.key.shadows},
                         {"quick", c.quick},
                         {"notMeasured", c.not_measured},
                         {"clamped", c.clamped},
                         {"units", units}};
  return out.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

Result<Calibration> parse_calibration(std::string_view text, const std::string& where) {
  if (text.size() > kMostBytes) return fail(ErrorKind::bad_input, where, "is no calibration: above 1 MiB");
  const json document = json::parse(text, nullptr, false);
  if (document.is_discarded()) return fail(ErrorKind::bad_input, where, "is damaged: no JSON");
  if (!document.is_object())
    return fail(ErrorKind::bad_input, where, "must be a JSON object: this is no calibration");
  Reader in(document, where + ": ");
  if (const std::string schema = in.text("schema"); !in.error() && schema != kSchema)
    in.bad("schema", "must be '" + std::string(kSchema) + "': this is no calibration");
  if (const double version = in.number("version", 0, 1e9); !in.error() && version != kVersion)
    in.bad("version", "this program reads version " + std::to_string(kVersion) + ", not " +
                          std::to_string(static_cast<long long>(version)) +
                          "; run sceneplay calibrate again");
  Calibration out;
  out.key.device_uuid = in.text("deviceUuid");
  out.key.device = in.text("device");
  out.key.driver = in.text("driver");
  if (const json* size = in.member("size")) {
    const auto side = [&](std::size_t i) {
      return size->is_array() && size->size() == 2 && (*size)[i].is_number_unsigned() &&
                     (*size)[i].get<std::uint64_t>() <= 65'536
                 ? (*size)[i].get<std::uint32_t>()
                 : 0U;
    };
    out.key.size = {side(0), side(1)};
    if (out.key.size.x == 0 || out.key.size.y == 0) in.bad("size", "must be two whole numbers, 1 to 65536");
  }
  out.key.samples = static_cast<std::uint32_t>(in.number("samples", 1, 64));
  out.key.shadows = in.boolean("shadows");
  out.quick = in.boolean("quick");
  out.not_measured = in.texts("notMeasured");
  out.clamped = in.texts("clamped");
  if (const json* units = in.member("units")) {
    Reader inner(*units, where + ": /units");
    read_units(inner, out.costs);
    in.take(inner);
  }
  if (in.error()) return tl::unexpected<Error>(*in.error());
  return out;
}

Result<void> check_calibration(const Calibration& c, const CalibrationKey& wanted, const std::string& where) {
  const auto differs = [&](const std::string& measured, const std::string& now) {
    return fail(ErrorKind::bad_input, where,
                "was measured for " + measured + ", this is " + now +
                    "; measure with sceneplay calibrate --size " + std::to_string(wanted.size.x) + "x" +
                    std::to_string(wanted.size.y) + " --samples " + std::to_string(wanted.samples) +
                    " --shadows " + (wanted.shadows ? "on" : "off"));
  };
  const CalibrationKey& k = c.key;
  if (k.device_uuid != wanted.device_uuid)
    return differs("device '" + k.device + "'",
                   "'" + wanted.device + "'" + (k.device == wanted.device ? " with another UUID" : ""));
  if (k.driver != wanted.driver) return differs("driver '" + k.driver + "'", "'" + wanted.driver + "'");
  if (k.size != wanted.size) return differs("pictures of " + size_text(k.size), size_text(wanted.size));
  if (k.samples != wanted.samples)
    return differs("--samples " + std::to_string(k.samples), "--samples " + std::to_string(wanted.samples));
  if (k.shadows != wanted.shadows)
    return differs(k.shadows ? "--shadows on" : "--shadows off",
                   wanted.shadows ? "--shadows on" : "--shadows off");
  return {};
}

Result<std::string> calibration_path(const CalibrationKey& key) {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nobody sets variables
  const auto variable = [](const char* name) {
    return std::string(std::getenv(name) ? std::getenv(name) : "");
  };
  std::filesystem::path cache = variable("XDG_CACHE_HOME");
  if (!cache.is_absolute()) {  // as the XDG specification wants it
    const std::string home = variable("HOME");
    if (home.empty())
      return fail(ErrorKind::io, "calibration",
                  "neither XDG_CACHE_HOME nor HOME says where; use --output FILE");
    cache = std::filesystem::path(home) / ".cache";
  }
  const std::string name = "calibration-" + key.device_uuid + "-" + size_text(key.size) + "-" +
                           std::to_string(key.samples) + (key.shadows ? "-shadows" : "") + ".json";
  return (cache / "scenegen" / name).string();
}

}  // namespace scenegen::render
