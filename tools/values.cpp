// How the kinds of option values read and spell themselves.
#include <algorithm>
#include <limits>

#include "tools/cli.h"

namespace scenegen::tools {

namespace {

std::string spell_size(std::span<const std::uint32_t> parts) {
  std::string out;
  for (const std::uint32_t part : parts) out += (out.empty() ? "" : "x") + std::to_string(part);
  return out;
}

std::string spell_metres(std::span<const double> parts) {
  std::string out;
  for (const double part : parts) out += (out.empty() ? "" : "x") + shortest(part);
  return out;
}

tl::unexpected<Error> size_out_of_range(std::string_view text, const std::string& least,
                                        const std::string& most, const std::string& nearest) {
  return fail(
      ErrorKind::usage, "",
      std::string(text) + " is out of range (" + least + " to " + most + "; nearest: " + nearest + ")");
}

/// One part of a size, clamped; `ok` says whether it had to be.
Result<std::uint32_t> clamped_whole(std::string_view text, std::uint32_t least, std::uint32_t most,
                                    bool& ok) {
  if (auto value = parse_whole(text, least, most); value) return static_cast<std::uint32_t>(*value);
  auto any = parse_whole(text, 0, UINT64_MAX);
  const bool digits =
      text.find_first_not_of("0123456789", text.starts_with('-') ? 1 : 0) == std::string_view::npos;
  if (!digits || text == "-") return forward_error(any);
  ok = false;
  return text.starts_with('-') || (any && *any < least) ? least : most;
}

template <int N>
Value size_value(glm::vec<N, std::uint32_t>& target, glm::vec<N, std::uint32_t> least,
                 glm::vec<N, std::uint32_t> most, std::string form) {
  const auto spell = [](const glm::vec<N, std::uint32_t>& v) { return spell_size(std::span(&v.x, N)); };
  auto parse = [&target, least, most, form, spell](std::string_view text) -> Result<void> {
    auto parts = split_size(text, N, form);
    if (!parts) return forward_error(parts);
    glm::vec<N, std::uint32_t> nearest{};
    bool ok = true;
    for (int i = 0; i < N; ++i) {
      auto part = clamped_whole((*parts)[static_cast<std::size_t>(i)], least[i], most[i], ok);
      if (!part) return forward_error(part);
      nearest[i] = *part;
    }
    if (!ok) return size_out_of_range(text, spell(least), spell(most), spell(nearest));
    target = nearest;
    return {};
  };
  return {Value::Kind::text, std::move(form), spell(least) + " to " + spell(most), std::move(parse),
          [&target, spell] { return spell(target); }};
}

template <int N>
Value metres_value(glm::vec<N, double>& target, double least, double most, std::string form) {
  const auto spell = [](const glm::vec<N, double>& v) { return spell_metres(std::span(&v.x, N)); };
  auto parse = [&target, least, most, form, spell](std::string_view text) -> Result<void> {
    auto parts = split_size(text, N, form);
    if (!parts) return forward_error(parts);
    glm::vec<N, double> nearest{};
    bool ok = true;
    for (int i = 0; i < N; ++i) {
      constexpr double kAny = std::numeric_limits<double>::max();
      auto part = parse_real((*parts)[static_cast<std::size_t>(i)], -kAny, kAny);
      if (!part) return forward_error(part);
      nearest[i] = std::clamp(*part, least, most);
      ok = ok && nearest[i] == *part;
    }
    if (!ok) {
      return size_out_of_range(text, spell(glm::vec<N, double>(least)), spell(glm::vec<N, double>(most)),
                               spell(nearest));
    }
    target = nearest;
    return {};
  };
  return {Value::Kind::text, std::move(form), "each " + shortest(least) + " to " + shortest(most) + " m",
          std::move(parse), [&target, spell] { return spell(target); }};
}

}  // namespace

Value real_value(double& target, double least, double most, std::string form) {
  return {Value::Kind::number, std::move(form), shortest(least) + " to " + shortest(most),
          [&target, least, most](std::string_view text) -> Result<void> {
            auto value = parse_real(text, least, most);
            if (!value) return forward_error(value);
            target = *value;
            return {};
          },
          [&target] { return shortest(target); }};
}

Value size2_value(glm::uvec2& target, glm::uvec2 least, glm::uvec2 most, std::string form) {
  return size_value<2>(target, least, most, std::move(form));
}

Value size3_value(glm::uvec3& target, glm::uvec3 least, glm::uvec3 most, std::string form) {
  return size_value<3>(target, least, most, std::move(form));
}

Value metres2_value(glm::dvec2& target, double least, double most, std::string form) {
  return metres_value<2>(target, least, most, std::move(form));
}

Value metres3_value(glm::dvec3& target, double least, double most, std::string form) {
  return metres_value<3>(target, least, most, std::move(form));
}

Value on_off_value(bool& target) {
  Value value = choice_value<bool>(target, {{"on", true}, {"off", false}}, "on|off");
  value.kind = Value::Kind::boolean;
  value.range.clear();  // the form says it
  return value;
}

Result<void> not_empty(const std::string& text) {
  if (text.empty()) return fail(ErrorKind::usage, "", "is empty");
  return {};
}

Value texts_value(std::vector<std::string>& target, std::string form, std::string range,
                  std::function<Result<void>(const std::string&)> check) {
  Value value{Value::Kind::text, std::move(form), std::move(range),
              [&target, check = std::move(check)](std::string_view text) -> Result<void> {
                if (auto good = check(std::string(text)); !good) return good;
                target.emplace_back(text);
                return {};
              },
              [] { return std::string(); }};
  value.spell_all = [&target] { return target; };
  value.clear = [&target] { target.clear(); };
  return value;
}

Value text_value(std::string& target, std::string form, std::string range) {
  return {Value::Kind::text, std::move(form), std::move(range),
          [&target](std::string_view text) -> Result<void> {
            if (text.empty()) return fail(ErrorKind::usage, "", "is empty");
            target = text;
            return {};
          },
          [&target] { return target; }};
}

}  // namespace scenegen::tools
