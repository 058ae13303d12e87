// Numbers and strings as JSON, and names.
#include "scene/gltf/write_text.h"

#include <fcntl.h>
#include <unistd.h>

#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "scene/gltf/write_names.h"
#include "scene/random.h"
#include "tests/support/gltf_file.h"

using namespace scenegen;

namespace {

/// What `put` writes.
template <class Put>
std::string text_of(const Put& put) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.path("text");
  const int descriptor = ::open(path.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
  gltf::ByteSink sink(descriptor);
  gltf::TextOut out(sink);
  put(out);
  sink.flush();
  ::close(descriptor);
  const std::string text = testing::file_bytes(path);
  CHECK(text.size() == sink.total());
  return text;
}

}  // namespace

TEST_CASE("floats are the shortest text that reads back the same") {
  const auto number = [](auto value) { return text_of([&](gltf::TextOut& out) { out.number(value); }); };
  CHECK(number(0.1F) == "0.1");
  CHECK(number(0.1) == "0.1");
  CHECK(number(static_cast<double>(0.1F)) == "0.10000000149011612");
  CHECK(number(1.0F) == "1");
  CHECK(number(-0.70710677F) == "-0.70710677");
  CHECK(number(16777216.0F) == "16777216");
  CHECK(number(std::uint64_t{18446744073709551615ULL}) == "18446744073709551615");

  // All kinds of bit patterns, denormals among them: through JSON and back.
  const Random random(5, "floats");
  std::vector<float> values;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const auto value = std::bit_cast<float>(static_cast<std::uint32_t>(random.bits(i)));
    if (std::isfinite(value)) values.push_back(value);
  }
  const auto parsed = nlohmann::json::parse(
      text_of([&](gltf::TextOut& out) { out.floats(values.data(), static_cast<int>(values.size())); }));
  REQUIRE(parsed.size() == values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    CHECK(std::bit_cast<std::uint32_t>(static_cast<float>(parsed[i].get<double>())) ==
          std::bit_cast<std::uint32_t>(values[i]));
  }
}

TEST_CASE("strings are escaped and come back") {
  std::string all;
  for (char c = 0; c < 127; ++c) all += c;
  all += "Süd 日本 \xF0\x9F\x8F\xA0";
  const std::string text = text_of([&](gltf::TextOut& out) { out.string(all); });
  CHECK(nlohmann::json::parse(text).get<std::string>() == all);
  CHECK(text_of([](gltf::TextOut& out) { out.string(""); }) == "\"\"");
  const std::string long_text(10000, 'x');  // longer than the room of the sink
  CHECK(text_of([&](gltf::TextOut& out) { out.string(long_text); }) == "\"" + long_text + "\"");
}

TEST_CASE("trees are written as they are") {
  const nlohmann::json tree = {
      {"a", {1, -2, true, nullptr}}, {"b", {{"c", 0.5}}}, {"d", nlohmann::json::object()}};
  CHECK(text_of([&](gltf::TextOut& out) { out.tree(tree); }) ==
        R"({"a":[1,-2,true,null],"b":{"c":0.5},"d":{}})");
}

TEST_CASE("node names are made unique against objects and each other") {
  NameTable objects;
  for (const char* name : {"door", "door~2", "wall"}) objects.push_back(name);
  gltf::UniqueNames names;
  for (const char* name : {"door", "gate", "gate", "door", "wall~2", "wall"}) names.wish(name);
  names.settle(objects);
  std::set<std::string_view> seen;
  for (std::size_t i = 0; i < objects.size(); ++i) seen.insert(objects[i]);
  for (std::size_t i = 0; i < names.size(); ++i) {
    CAPTURE(names[i]);
    CHECK(seen.insert(names[i]).second);
  }
  CHECK(names[1] == "gate");
  CHECK(names[2] == "gate~2");
  CHECK(names[4] == "wall~2");
}
