// Globs and selectors: who is meant, with and without the index; and every way of saying it wrongly.
#include "scene/selector.h"

#include <catch2/catch.hpp>
#include <map>

#include "scene/glob.h"
#include "tests/support/gltf_text.h"

using namespace scenegen;

namespace {

bool globs(const char* pattern, const char* text) {
  const auto glob = Glob::parse(pattern);
  if (!glob) FAIL(glob.error().str());
  return glob->matches(text);
}

/// site: (storey A: wall 1 (with a door), wall 2), (storey B: wall 1 twice by name), a loose stone, cameras.
constexpr const char* kHouse =
    R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]},
                 {"primitives":[{"attributes":{"POSITION":0},"material":1},{"attributes":{"POSITION":0}}]}],
    "materials":[{"name":"Brick red"},{"name":"Wood [oak]"}],
    "scenes":[{"nodes":[9,7]}],
    "nodes":[
      {"name":"wall 1","mesh":0,"children":[1],"extras":{"guid":"0aB$","Level":1}},
      {"name":"door","mesh":1,"extras":{"ifc":{"Global_Id":"2O2Fr$","load.bearing":true}}},
      {"name":"wall 2","mesh":0,"extras":{"guid":"1xx_","Level":1.5,"list":[1,2],"none":null}},
      {"name":"Storey A","children":[0,2],"extras":{"guid":"SA","phase":"one"}},
      {"name":"w\u00e4nd","mesh":0,"extras":{"phase":"two"}},
      {"name":"wall 1","mesh":0},
      {"name":"Storey B","children":[4,5],"extras":{"guid":"SB"}},
      {"name":"stone*","mesh":0},
      {"name":"unused"},
      {"name":"site","children":[3,6],"extras":{"phase":"zero","scenegen":{"object":3}}}])";

class House {
 public:
  House() {
    testing::GltfText g;
    (void)g.triangle_mesh();
    const std::string text = g.str(kHouse);
    auto read = gltf::read_memory({text.begin(), text.end()}, "house.gltf", "", {true, 1});
    if (!read) FAIL(read.error().str());
    read_ = std::move(*read);
  }
  /// Names of the objects, joined by '+', and the same with the index.
  std::string pick(const std::string& text) {
    const auto selector = Selector::parse(text);
    if (!selector) FAIL(selector.error().str());
    return pick(*selector);
  }
  std::string pick(const Selector& selector) {
    auto facts = ObjectFacts::make(read_.scene, *read_.source);
    if (!facts) FAIL(facts.error().str());
    const auto slow = selector.select(*facts);
    facts->index();
    CHECK(slow == selector.select(*facts));
    CHECK(std::is_sorted(slow.begin(), slow.end()));
    std::string out;
    for (const ObjectId id : slow)
      out += (out.empty() ? "" : "+") + std::string(read_.scene.objects.names[id.value]);
    return out;
  }

 private:
  gltf::ReadResult read_;
};

}  // namespace

TEST_CASE("globs match as in a shell, by characters and not by bytes") {
  CHECK(globs("wall", "wall"));
  CHECK_FALSE(globs("wall", "wall 1"));
  CHECK(globs("*", ""));
  CHECK(globs("*", "anything"));
  CHECK(globs("w*l*", "wall"));
  CHECK(globs("*1*2*", "a1b2c"));
  CHECK_FALSE(globs("*2*1*", "a1b2c"));
  CHECK(globs("w?nd", "w\xC3\xA4nd"));
  CHECK_FALSE(globs("w??nd", "w\xC3\xA4nd"));
  CHECK(globs("w[\xC3\xA4\xC3\xB6]nd", "w\xC3\xA4nd"));
  CHECK(globs("[a-c]x", "bx"));
  CHECK_FALSE(globs("[a-c]x", "dx"));
  CHECK(globs("[!a-c]x", "dx"));
  CHECK(globs("[]]", "]"));
  CHECK(globs("[a-]", "-"));
  CHECK(globs("\\*\\[", "*["));
  CHECK_FALSE(globs("\\*", "x"));
  CHECK(globs("wall\\*", "wall*"));
  CHECK(globs("[\\]]x", "]x"));
  const std::string many(2000, 'a');
  std::string stars;
  for (int i = 0; i < 500; ++i) stars += "a*";
  CHECK_FALSE(globs((stars + "b").c_str(), many.c_str()));  // exponential matchers never end
  CHECK(Glob::parse("[a").error().str() == "the set '[' of '[a' has no ']'");
  CHECK(Glob::parse("[]").error().str() == "the set '[' of '[]' has no ']'");
  CHECK(Glob::parse("a\\").error().str() == "'a\\' ends in a backslash");
  CHECK(Glob::parse("\xFF").error().str() == "a pattern is not valid UTF-8");
  CHECK(Glob::literal("a*").matches("a*"));
  CHECK_FALSE(Glob::literal("a*").matches("ab"));
}

TEST_CASE("selectors mean what they say") {
  House house;
  const std::map<std::string, std::string> cases{
      {"wall*", "wall 1+wall 2+wall 1_2"},
      {"name=wall 1", "wall 1"},
      {"name=w?nd", "w\xC3\xA4nd"},
      {"stone\\*", "stone*"},
      {"name~^wall \\d$", "wall 1+wall 2"},
      {"name~[12]", "wall 1+wall 2+wall 1_2"},
      {"name~^door|nd$", "door+w\xC3\xA4nd"},
      {"name~(?i)^WALL", "wall 1+wall 2+wall 1_2"},
      {"name~^*door", "door"},
      {"extras.guid=0aB$", "wall 1+door"},  // the door has no guid of that name: the nearest above counts
      {"extras.guid=S*", "w\xC3\xA4nd+wall 1_2"},
      {"extras.guid=1xx_", "wall 2"},
      {"extras.ifc.Global_Id=2O2Fr$", "door"},
      {"extras.ifc.load.bearing=true", "door"},
      {"extras.load.bearing=true", ""},
      {"extras.Level=1", "wall 1+door"},
      {"extras.Level~^1", "wall 1+door+wall 2"},
      {"extras.phase=one", "wall 1+door+wall 2"},
      {"extras.phase=two", "w\xC3\xA4nd"},
      {"extras.phase=zero", "wall 1_2"},
      {"extras.phase~^(one|two)$", "wall 1+door+wall 2+w\xC3\xA4nd"},
      {"extras.scenegen.object=3", ""},  // ours, not the author's
      {"extras.none=null", ""},
      {"material=Brick*", "wall 1+wall 2+w\xC3\xA4nd+wall 1_2+stone*"},
      {"material~oak", "door"},
      {"subtree=Storey A", "wall 1+door+wall 2"},
      {"subtree=Storey*", "wall 1+door+wall 2+w\xC3\xA4nd+wall 1_2"},
      {"subtree~site", "wall 1+door+wall 2+w\xC3\xA4nd+wall 1_2"},
      {"subtree=wall 1", "wall 1+door+wall 1_2"},
      {"subtree=*", "wall 1+door+wall 2+w\xC3\xA4nd+wall 1_2+stone*"},
      {"name=nobody", ""},
      {"subtree=unused", ""}};
  for (const auto& [selector, wanted] : cases) {
    INFO(selector);
    CHECK(house.pick(selector) == wanted);
  }
}

TEST_CASE("an identifier means its element, or all that is below when the elements have their own") {
  House house;
  CHECK(house.pick(Selector::with_guid("2O2Fr$")) == "door");
  CHECK(house.pick(Selector::with_guid("0aB$")) == "wall 1");
  CHECK(house.pick(Selector::with_guid("SA")) == "wall 1+door+wall 2");
  CHECK(house.pick(Selector::with_guid("SB")) == "w\xC3\xA4nd+wall 1_2");
  CHECK(house.pick(Selector::with_guid("S*")).empty());
  CHECK(house.pick(Selector::with_name("stone*")) == "stone*");
  CHECK(house.pick(Selector::with_name("wall*")).empty());
}

TEST_CASE("wrong selectors are told in one line") {
  const auto error = [](const std::string& text) { return Selector::parse(text).error().str(); };
  CHECK(error("") == "a selector is empty");
  CHECK(error("nane=x") ==
        "unknown selector 'nane' (did you mean 'name'? one of: name, extras.KEY, material, subtree)");
  CHECK(error("colour=x") == "unknown selector 'colour' (one of: name, extras.KEY, material, subtree)");
  CHECK(error("extras.=x") == "unknown selector 'extras.' (one of: name, extras.KEY, material, subtree)");
  CHECK(error("name=") == "'name=' has no value");
  CHECK(error("name~") == "'name~' has no value");
  CHECK(error("name=[a") == "the set '[' of '[a' has no ']'");
  CHECK(error("name~(") == "'(' is no regular expression: missing ): (");
  CHECK(error(std::string(5000, 'a')) == "a selector of 5000 bytes; allowed up to 4096");
  CHECK(Selector::parse("wall~2").has_value());  // '~' in a name is only a character
}

TEST_CASE("broken extras are an error and not left out") {
  testing::GltfText g;
  (void)g.triangle_mesh();
  const std::string text = g.str(
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0,"extras":{"a":{"b":"\uD800"}}}])");
  const auto read = gltf::read_memory({text.begin(), text.end()}, "broken.gltf", "", {true, 1});
  REQUIRE(read);
  const auto facts = ObjectFacts::make(read->scene, *read->source);
  REQUIRE_FALSE(facts);
  CHECK(facts.error().kind == ErrorKind::bad_input);
  CHECK_THAT(facts.error().str(), Catch::Matchers::StartsWith("broken.gltf: /nodes/0/extras/a/b: "));
}
