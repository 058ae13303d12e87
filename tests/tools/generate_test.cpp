// scenegen from end to end: what it writes, says and repeats.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/tools/process.h"

using namespace scenegen::test;
using nlohmann::json;

namespace {

/// scenegen in `folder`, which must succeed.
ProcessResult made_by(const TemporaryFolder& folder, const std::string& arguments) {
  ProcessResult result = run(SCENEGEN_PROGRAM, words(arguments), {.folder = folder.path()});
  INFO("scenegen " << arguments << "\n" << result.err);
  REQUIRE(result.code == 0);
  return result;
}

json json_of(const TemporaryFolder& folder, const std::string& arguments) {
  return json::parse(made_by(folder, arguments + " --format json").out);
}

const char* const kTown = "--grid 2x1 --extras 2 --coherence 0.9 --cells 8x8x8 --seed 7 ";

}  // namespace

TEST_CASE("every layout and visibility holds the same scene") {
  const TemporaryFolder folder;
  made_by(folder, kTown + std::string("--layout nodes -o base.glb"));
  for (const std::string layout : {"nodes", "groups", "instances", "merged"}) {
    for (const std::string visibility : {"scale", "pointer", "both"}) {
      for (const std::string file : {"a.glb", "a.gltf"}) {
        made_by(folder, kTown + ("--layout " + layout + " --visibility " + visibility + " -o " + file));
        INFO(layout << " " << visibility << " " << file);
        CHECK_THAT(made_by(folder, "diff base.glb " + file).out, Catch::Matchers::StartsWith("equal  "));
      }
    }
  }
}

TEST_CASE("diff tells what differs") {
  const TemporaryFolder folder;
  made_by(folder, "--cells 8x8x8 -o a.glb");
  for (const char* other : {"--cells 8x8x8 --curve morton", "--cells 8x8x8 --coherence 0.999",
                            "--cells 8x8x8 --seed 2", "--cells 8x8x8 --floors 2", "--curve none"}) {
    INFO(other);
    made_by(folder, std::string(other) + " -o b.glb");
    const ProcessResult text =
        run(SCENEGEN_PROGRAM, words("diff a.glb b.glb --most 3"), {.folder = folder.path()});
    CHECK(text.code == 1);
    CHECK_THAT(text.out, Catch::Matchers::Contains("different: "));
    const ProcessResult data =
        run(SCENEGEN_PROGRAM, words("diff a.glb b.glb --most 3 --format json"), {.folder = folder.path()});
    CHECK(data.code == 1);
    const json report = json::parse(data.out);
    CHECK(report["schema"] == "scenegen/diff");
    CHECK(report["equal"] == false);
    CHECK(report["differenceCount"] >= report["differences"].size());
    CHECK(report["differences"].size() >= 1);
    CHECK(report["differences"].size() <= 3);
  }
}

TEST_CASE("the same arguments give the same bytes whatever the number of threads") {
  const TemporaryFolder folder;
  for (const char* arguments : {"--grid 2x2 --coherence 0.5", "--grid 2x2 --layout nodes --visibility both",
                                "--test-set 20 --coherence 0.5", "--test-set 41"}) {
    INFO(arguments);
    made_by(folder, std::string(arguments) + " --threads 1 -o 1.glb");
    const std::string bytes = read_file(folder.file("1.glb"));
    REQUIRE(bytes.size() > 1000);
    for (const char* threads : {"2", "8", "0"}) {
      made_by(folder, std::string(arguments) + " --threads " + threads + " -o n.glb");
      CHECK((read_file(folder.file("n.glb")) == bytes));
    }
    const ProcessResult piped = made_by(folder, std::string(arguments) + " -o -");
    CHECK((piped.out == bytes));
    CHECK_THAT(piped.err, Catch::Matchers::Contains("stdout  "));
  }
}

TEST_CASE("a file says how to make it again") {
  const TemporaryFolder folder;
  // Spelt unlike the canonical way, in another order, with options that do not decide the content.
  made_by(folder,
          "--threads 2 --coherence 0.90 --grid 02x1 --interval 1e-2 --curve=morton -q --order +y+x-z "
          "--windows off --seed 0 --visibility both -o a.glb --report r.json");
  const json inspected = json_of(folder, "inspect a.glb");
  const std::vector<std::string> arguments = inspected["arguments"];
  CHECK(arguments == words("--grid 2x1 --seed 0 --windows off --curve morton --order +y+x-z --interval 0.01 "
                           "--coherence 0.9 --visibility both"));
  CHECK(inspected["seed"] == 0);
  std::vector<std::string> again = arguments;
  again.insert(again.end(), {"-o", "b.glb"});
  REQUIRE(run(SCENEGEN_PROGRAM, again, {.folder = folder.path()}).code == 0);
  CHECK((read_file(folder.file("a.glb")) == read_file(folder.file("b.glb"))));
  CHECK(json::parse(read_file(folder.file("r.json")))["arguments"] == inspected["arguments"]);
}

TEST_CASE("model files stand in for buildings and extra objects") {
  const TemporaryFolder folder;
  made_by(folder, "--floors 1 --curve none --layout nodes -o model.glb");
  for (const char* arguments : {"--building-model model.glb --grid 3x2",
                                "--extras 1 --extra-model model.glb --building-size 20x20"}) {
    INFO(arguments);
    const json predicted = json_of(folder, std::string(arguments) + " --dry-run");
    const json made = json_of(folder, std::string(arguments) + " -o a.glb");
    for (const char* key : {"objects", "vertices", "triangles", "moments", "bytes"}) {
      INFO(key);
      CHECK(predicted[key] == made[key]);
    }
    const std::uint64_t of_model = json_of(folder, "inspect model.glb")["objects"];
    CHECK(made["objects"].get<std::uint64_t>() >= 3 * of_model);
    const std::vector<std::string> stored = json_of(folder, "inspect a.glb")["arguments"];
    std::vector<std::string> again = stored;
    again.insert(again.end(), {"-o", "b.glb"});
    REQUIRE(run(SCENEGEN_PROGRAM, again, {.folder = folder.path()}).code == 0);
    CHECK((read_file(folder.file("a.glb")) == read_file(folder.file("b.glb"))));
  }
}

TEST_CASE("a dry run says what generating gives and writes nothing") {
  const TemporaryFolder folder;
  for (const char* arguments : {"--grid 2x1", "--grid 1x3 --windows off --partitions off --ground off",
                                "--extras 3 --extra-model sphere:8", "--brick 0.3x0.1x0.1 --floors 1",
                                "--layout nodes --visibility pointer -o scene.gltf", "--curve none",
                                "--layout groups --coherence 0.3", "--test-set 5", "--test-set 20",
                                "--test-set 26", "--test-set 45"}) {
    INFO(arguments);
    const json predicted = json_of(folder, std::string(arguments) + " --dry-run");
    CHECK(folder.entries().empty());
    const json made = json_of(folder, arguments);
    for (const char* key : {"objects", "vertices", "triangles", "moments", "bytes"}) {
      INFO(key);
      CHECK(predicted[key] == made[key]);
      CHECK(made[key].is_number_unsigned());
    }
    std::uint64_t bytes = 0;
    for (const std::string& name : folder.entries()) {
      bytes += read_file(folder.file(name)).size();
      std::remove(folder.file(name).c_str());
    }
    CHECK(made["bytes"] == bytes);
    CHECK(made["objects"] > 0);
    CHECK(predicted["schema"] == "scenegen/report");
    CHECK(predicted["version"] == 1);
  }
}

TEST_CASE("a finished command says what it made") {
  const TemporaryFolder folder;
  const ProcessResult result = made_by(folder, "--grid 4x4 --coherence 0.95 --layout instances");
  CHECK(result.err.empty());
  CHECK_THAT(result.out,
             Catch::Matchers::Matches("scene\\.glb  [0-9.]+ MB  [0-9 ]+ objects  [0-9 ]+ moments  "
                                      "coherence 0\\.95  locality 13\\.3  seed 1  [0-9.]+ s\n"
                                      "instances: [0-9 ]+ groups, [0-9.]+ objects per group, .*\n"));
  CHECK(folder.entries() == std::vector<std::string>{"scene.glb"});
  CHECK(read_file(folder.file("scene.glb")).size() < 10'000'000);
  CHECK(made_by(folder, "-q").out.empty());
  CHECK(made_by(folder, "--version").out == "scenegen " SCENEGEN_VERSION "\n");
}

TEST_CASE("a config says the same as the command line, which wins") {
  const TemporaryFolder folder;
  const std::string arguments =
      "--grid 2x1 --windows off --coherence 0.9 --order +x+y-z --seed 3 --layout groups ";
  write_file(folder.file("c.json"), made_by(folder, arguments + "--dump-config").out);
  CHECK(made_by(folder, "--config c.json --dump-config").out == read_file(folder.file("c.json")));
  made_by(folder, arguments + "-o a.glb");
  made_by(folder, "--config c.json -o b.glb");
  CHECK_THAT(made_by(folder, "diff a.glb b.glb").out, Catch::Matchers::StartsWith("equal  "));
  CHECK(json_of(folder, "--config c.json --dry-run --seed 4")["seed"] == 4);
  CHECK(json_of(folder, "--seed 4 --config c.json --dry-run")["seed"] == 4);
  for (const char* other : {"--test-set 20", "--curve none", "--extras 2 --extra-model sphere:8", ""}) {
    INFO(other);
    const std::string dumped = made_by(folder, std::string(other) + " --dump-config").out;
    write_file(folder.file("d.json"), dumped);
    CHECK(made_by(folder, "--config d.json --dump-config").out == dumped);
  }
}

TEST_CASE("inspect agrees with what was generated, in three forms") {
  const TemporaryFolder folder;
  const json made = json_of(folder, "--grid 2x2 --coherence 0.8 -o a.glb");
  const json inspected = json_of(folder, "inspect a.glb");
  for (const char* key : {"objects", "vertices", "triangles", "moments", "bytes", "seed", "coherence",
                          "locality", "arguments"}) {
    INFO(key);
    CHECK(inspected[key] == made[key]);
  }
  CHECK(inspected["schema"] == "scenegen/inspect");
  CHECK(inspected["parts"]["json"] == made["jsonBytes"]);
  CHECK(inspected["parts"]["json"].get<int>() + inspected["parts"]["binary"].get<int>() ==
        inspected["bytes"]);
  CHECK(inspected["ignored"].empty());
  CHECK(inspected["findings"].empty());
  CHECK(inspected["coherenceGiven"] == 0.8);
  CHECK(inspected["jumps"] == 0);  // Hilbert's curve on 16^3 cells
  CHECK(inspected["coherence"].get<double>() == Approx(0.8).margin(1e-4));
  CHECK(made["timed"].get<int>() > 1000);
  CHECK(inspected["classes"]["pseudoDynamic"] == made["timed"]);  // the others are the ground
  CHECK(inspected["classes"]["static"].get<int>() + made["timed"].get<int>() == made["objects"]);
  const std::string csv = made_by(folder, "inspect a.glb --format csv").out;
  CHECK_THAT(csv, Catch::Matchers::StartsWith("key,value\n"));
  CHECK_THAT(csv, Catch::Matchers::Contains("\nobjects," + inspected["objects"].dump() + "\n"));
  const std::string table = made_by(folder, "inspect a.glb").out;
  for (const char* part :
       {"static", "pseudo-dynamic", "meshes", "materials", "events per moment", "length", "coherence given",
        "coherence measured", "jumps", "locality", "JSON", "binary", "seed", "arguments"}) {
    CHECK_THAT(table, Catch::Matchers::Contains(part));
  }
}

TEST_CASE("no arguments give a short help and an example") {
  const TemporaryFolder folder;
  const ProcessResult result = made_by(folder, "");
  CHECK_THAT(result.out, Catch::Matchers::Contains("scenegen --grid 4x4 --curve hilbert"));
  CHECK(std::count(result.out.begin(), result.out.end(), '\n') < 14);
  CHECK(folder.entries().empty());
}
