#include "scene/gltf/json.h"

#include <charconv>
#include <cstring>

namespace scenegen::gltf::reading {

void reject_json(const Place& at, simdjson::error_code code, std::string_view wanted) {
  switch (code) {
    case simdjson::INCORRECT_TYPE:
    case simdjson::NUMBER_ERROR:
    case simdjson::NUMBER_OUT_OF_RANGE:
    case simdjson::T_ATOM_ERROR:
    case simdjson::F_ATOM_ERROR:
    case simdjson::N_ATOM_ERROR:
      reject(at, "wanted " + std::string(wanted));
    default:
      reject(at, "not JSON where " + std::string(wanted) + " was wanted: " + simdjson::error_message(code));
  }
}

std::string_view get_string(Value& value, const Place& at) {
  std::string_view token;
  token = value.raw_json_token();
  if (token.empty() || token.front() != '"') reject(at, "wanted a string");
  const std::size_t close = token.rfind('"');
  if (close == 0) reject(at, "wanted a string");
  const std::string_view body = token.substr(1, close - 1);
  if (body.find('\\') == std::string_view::npos && body.find('"') == std::string_view::npos) return body;
  std::string_view out;
  if (const auto code = value.get_string().get(out); code != simdjson::SUCCESS)
    reject_json(at, code, "a string");
  return out;
}

bool get_bool(Value& value, const Place& at) {
  bool out = false;
  if (const auto code = value.get_bool().get(out); code != simdjson::SUCCESS)
    reject_json(at, code, "true or false");
  return out;
}

std::uint64_t get_count(Value& value, const Place& at, std::uint64_t most) {
  std::uint64_t out = 0;
  if (const auto code = value.get_uint64().get(out); code != simdjson::SUCCESS) {
    reject_json(at, code, "an integer from 0 to " + std::to_string(most));
  }
  if (out > most) reject(at, std::to_string(out) + " is more than " + std::to_string(most));
  return out;
}

std::uint32_t get_index(Value& value, const Place& at) {
  return static_cast<std::uint32_t>(get_count(value, at, 0xFFFFFFFEULL));
}

double get_double(Value& value, const Place& at) {
  double out = 0;
  const std::string_view token = value.raw_json_token();
  if (const auto code = value.get_double().get(out); code != simdjson::SUCCESS)
    reject_json(at, code, "a number");
  // On demand, simdjson 3.0.1 reads numbers of 20 and more digits wrong: -0.07904822439840125109869401756656
  // as -6.3e-14. What it has found to be a number, from_chars reads right.
  constexpr std::size_t kManyDigits = 18;
  if (token.size() > kManyDigits) {
    double exact = 0;
    if (std::from_chars(token.data(), token.data() + token.size(), exact).ec == std::errc()) out = exact;
  }
  if (!std::isfinite(out)) reject(at, "wanted a finite number");
  return out;
}

float get_float(Value& value, const Place& at) {
  const auto out = static_cast<float>(get_double(value, at));
  if (!std::isfinite(out)) reject(at, "number beyond the range of float32");
  return out;
}

bool is_object(Value& value) {
  simdjson::ondemand::json_type type{};
  return value.type().get(type) == simdjson::SUCCESS && type == simdjson::ondemand::json_type::object;
}

}  // namespace scenegen::gltf::reading
