// Collecting differences, and how numbers stand in their texts.
#pragma once

#include <charconv>
#include <string>
#include <string_view>
#include <utility>

#include "timeline/compare.h"

namespace scenegen::timeline {

/// Shortest text that reads back as the same number.
template <class Number>
std::string text(Number value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return {buffer, end};
}

/// "(1, 0.5, 0)"
template <class Vector>
std::string vector_text(const Vector& v) {
  std::string out = "(";
  for (int i = 0; i < v.length(); ++i) out += (i == 0 ? "" : ", ") + text(v[i]);
  return out + ")";
}

inline std::string a_and_b(const std::string& what, const std::string& in_a, const std::string& in_b) {
  return what + (what.empty() ? "" : " ") + in_a + " in A, " + in_b + " in B";
}

/// Counts all differences, keeps the first `most`. `where` and `what` are made only for those that are kept.
class DifferenceList {
 public:
  DifferenceList(Comparison& out, std::size_t most) : out_(out), most_(most) {}

  template <class Where, class What>
  void add(const Where& where, const What& what) {
    if (out_.difference_count++ < most_) out_.differences.push_back({where(), what()});
  }
  void add_text(std::string where, std::string what) {
    if (out_.difference_count++ < most_) out_.differences.push_back({std::move(where), std::move(what)});
  }

 private:
  Comparison& out_;
  std::size_t most_;
};

}  // namespace scenegen::timeline
