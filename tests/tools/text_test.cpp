#include "tools/text.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace scenegen;
using namespace scenegen::tools;

TEST_CASE("whole numbers are read whole or not at all") {
  CHECK(parse_whole("0", 0, 9).value() == 0);
  CHECK(parse_whole("18446744073709551615", 0, UINT64_MAX).value() == UINT64_MAX);
  CHECK(parse_whole("-0", 0, 9).value() == 0);
  for (const char* bad : {"", "-", "+1", "1.5", "1e3", " 1", "1 ", "0x10", "nan", "--1"}) {
    INFO(bad);
    REQUIRE_FALSE(parse_whole(bad, 0, 9));
    CHECK(parse_whole(bad, 0, 9).error().str() == "'" + std::string(bad) + "' is not a whole number");
  }
  CHECK(parse_whole("10", 1, 9).error().str() == "10 is out of range (1 to 9; nearest: 9)");
  CHECK(parse_whole("0", 1, 9).error().str() == "0 is out of range (1 to 9; nearest: 1)");
  CHECK(parse_whole("-5", 0, 9).error().str() == "-5 is out of range (0 to 9; nearest: 0)");
  CHECK(parse_whole("18446744073709551616", 1, 9).error().str().ends_with("nearest: 9)"));
  CHECK(parse_whole("-18446744073709551616", 1, 9).error().str().ends_with("nearest: 1)"));
}

TEST_CASE("real numbers are finite and in range") {
  CHECK(parse_real("0.95", 0, 1).value() == 0.95);
  CHECK(parse_real("1e-3", 0, 1).value() == 1e-3);
  CHECK_FALSE(std::signbit(parse_real("-0.0", 0, 1).value()));
  for (const char* bad : {"", "0.5x", "1,5", " 1", "0x1p3", "1e", "+1"}) {
    INFO(bad);
    CHECK(parse_real(bad, 0, 1).error().str() == "'" + std::string(bad) + "' is not a number");
  }
  for (const char* bad : {"nan", "inf", "-inf"}) {
    INFO(bad);
    CHECK(parse_real(bad, 0, 1).error().str() == "'" + std::string(bad) + "' is not a finite number");
  }
  CHECK(parse_real("1.2", 0, 1).error().str() == "1.2 is out of range (0 to 1; nearest: 1)");
  CHECK(parse_real("-0.1", 0, 1).error().str() == "-0.1 is out of range (0 to 1; nearest: 0)");
  CHECK_FALSE(parse_real("1e999", 0, 1));
  CHECK(parse_real("bad\nline", 0, 1).error().str() == "'bad?line' is not a number");
  CHECK(parse_real(std::string(100'000, '9') + "z", 0, 1).error().str().size() < 120);
}

TEST_CASE("sizes have exactly the parts they should") {
  CHECK(split_size("4x5", 2, "WxL").value().size() == 2);
  for (const char* bad : {"4", "4x", "x4", "4x5x6", "", "x", "4xx5"}) {
    INFO(bad);
    CHECK(split_size(bad, 2, "WxL").error().str() == "'" + std::string(bad) + "' is not of the form WxL");
  }
}

TEST_CASE("the nearest word is the one that was meant, or none") {
  const std::array<std::string, 4> curves{"hilbert", "morton", "row-prime", "none"};
  CHECK(nearest_word("hilber", curves) == "hilbert");
  CHECK(nearest_word("ihlbert", curves) == "hilbert");
  CHECK(nearest_word("row_prime", curves) == "row-prime");
  CHECK(nearest_word("mo", curves) == "morton");
  CHECK(nearest_word("peano", curves).empty());
  CHECK(nearest_word("", curves).empty());
  CHECK(nearest_word(std::string(1'000'000, 'h'), curves).empty());
  CHECK(unknown_word("value", "hilber", curves) ==
        "unknown value 'hilber' (did you mean 'hilbert'? one of: hilbert, morton, row-prime, none)");
}

TEST_CASE("people's units") {
  CHECK(human_bytes(999) == "999 B");
  CHECK(human_bytes(1000) == "1.0 kB");
  CHECK(human_bytes(5'123'456) == "5.1 MB");
  CHECK(human_bytes(999'600) == "1.0 MB");
  CHECK(human_bytes(UINT64_MAX) == "18.4 EB");
  CHECK(human_count(0) == "0");
  CHECK(human_count(999) == "999");
  CHECK(human_count(38016) == "38 016");
  CHECK(human_count(1'000'000) == "1 000 000");
  CHECK(counted(0, "object") == "0 objects");
  CHECK(counted(1, "object") == "1 object");
  CHECK(counted(38016, "object") == "38 016 objects");
  CHECK(counted(1, "vertex", "vertices") == "1 vertex");
  CHECK(counted(3, "vertex", "vertices") == "3 vertices");
  CHECK(human_seconds(0.214) == "0.21 s");
  CHECK(human_seconds(12.34) == "12.3 s");
  CHECK(human_seconds(184.6) == "3 min 05 s");
  CHECK(human_real(0.95, 3) == "0.95");
  CHECK(human_real(13.333, 1) == "13.3");
  CHECK(human_real(10, 0) == "10");
  CHECK(human_real(std::numeric_limits<double>::max(), 3).size() == 309);
  CHECK(shortest(0.1) == "0.1");
  CHECK(shortest(1e6) == "1000000");
  CHECK(shortest(1e300) == "1e+300");
}

TEST_CASE("lines break at blanks") {
  CHECK(wrap("one two three", 7) == std::vector<std::string>{"one two", "three"});
  CHECK(wrap("", 7) == std::vector<std::string>{""});
  CHECK(wrap("unbreakable", 3) == std::vector<std::string>{"unbreakable"});
  CHECK(display_width("naïve") == 5);
}

TEST_CASE("JSON that is nested too deeply or too wide is told from JSON with brackets in its words") {
  constexpr std::string_view kDeep = "is nested deeper than 64 levels";
  constexpr std::string_view kWide = "has an object of more than 1000 members";
  CHECK(json_excess("").empty());
  CHECK(json_excess(std::string(64, '[') + std::string(64, ']')).empty());
  CHECK(json_excess(std::string(65, '[') + std::string(65, ']')) == kDeep);
  CHECK(json_excess(std::string(200'000, '{')) == kDeep);
  CHECK(json_excess("[\"" + std::string(100, '[') + "\\\"" + std::string(100, '{') + "\"]").empty());
  CHECK(json_excess("]]]]{}").empty());  // no JSON, which the parser says
  std::string flat = "[";
  for (int i = 0; i < 1000; ++i) flat += "[1],";
  CHECK(json_excess(flat + "1]").empty());
  std::string wide = "{\"a\":{";  // 1000 members, and a thousand colons in names
  for (int i = 0; i < 1000; ++i) wide += (i == 0 ? "\"" : ",\"") + std::to_string(i) + ":\":{\"b\":0}";
  CHECK(json_excess(wide + "}}").empty());
  CHECK(json_excess(wide + ",\"one more\":0}}") == kWide);
}
