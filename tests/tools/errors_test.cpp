// Every kind of wrong call: one line, the right exit code, nothing left behind.
#include <algorithm>
#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>

#include "tests/tools/process.h"

using namespace scenegen::test;

namespace {

struct Case {
  const char* arguments;
  int code;
  const char* line;  ///< stderr without "error: " and the newline; begins with "~": a part of it
};

bool one_error_line(const std::string& text) {
  return text.starts_with("error: ") && text.ends_with("\n") &&
         std::count(text.begin(), text.end(), '\n') == 1;
}

void check_case(const Case& wrong, const ProcessResult& result) {
  INFO("scenegen " << wrong.arguments << "\n" << result.err);
  CHECK(result.signal == 0);
  CHECK(result.code == wrong.code);
  CHECK(result.out.empty());
  REQUIRE(one_error_line(result.err));
  const std::string line = result.err.substr(7, result.err.size() - 8);
  if (wrong.line[0] == '~') {
    CHECK_THAT(line, Catch::Matchers::Contains(wrong.line + 1));
  } else {
    CHECK(line == wrong.line);
  }
}

constexpr int kBad = 1;
constexpr int kUsage = 2;
constexpr int kIo = 3;

const Case kWrongCalls[] = {
    // Unknown words.
    {"--curve hilber", kUsage,
     "--curve: unknown value 'hilber' (did you mean 'hilbert'? one of: hilbert, morton, row-prime, none)"},
    {"--curve peano", kUsage, "--curve: unknown value 'peano' (one of: hilbert, morton, row-prime, none)"},
    {"--gird 4x4", kUsage, "--gird: unknown option (did you mean '--grid'?)"},
    {"--gird=4x4", kUsage, "--gird: unknown option (did you mean '--grid'?)"},
    {"--zzzzzz", kUsage, "--zzzzzz: unknown option (--help lists them)"},
    {"-z", kUsage, "-z: unknown option (--help lists them)"},
    {"inspct a.glb", kUsage,
     "unknown command 'inspct' (did you mean 'inspect'? one of: animate, schedule, inspect, diff, optimize, "
     "truth, sweep)"},
    {"--grid 2x2 stray", kUsage, "unexpected argument 'stray'"},
    {"--windows yes", kUsage, "--windows: unknown value 'yes' (one of: on, off)"},
    {"--layout node", kUsage,
     "--layout: unknown value 'node' (did you mean 'nodes'? one of: auto, nodes, groups, instances, merged)"},
    {"--visibility none", kUsage, "~--visibility: unknown value 'none' ("},
    {"--format xml", kUsage, "--format: unknown value 'xml' (one of: table, json, csv)"},
    {"--order +x+y", kUsage, "~--order: unknown value '+x+y' ("},
    {"--order +x+x+y", kUsage, "~--order: unknown value '+x+x+y' ("},
    // Missing values.
    {"--coherence", kUsage, "--coherence: needs a value"},
    {"--grid --seed 3", kUsage, "~--grid: needs a value"},
    {"--seed=", kUsage, "--seed: needs a value"},
    {"--quiet=3", kUsage, "--quiet: takes no value"},
    {"inspect", kUsage, "missing FILE (usage: scenegen inspect FILE [options])"},
    {"diff a.glb", kUsage, "missing B (usage: scenegen diff A B [options])"},
    // Numbers.
    {"--grid 0x4", kUsage, "--grid: 0x4 is out of range (1x1 to 1000x1000; nearest: 1x4)"},
    {"--grid -1x4", kUsage, "--grid: -1x4 is out of range (1x1 to 1000x1000; nearest: 1x4)"},
    {"--grid 1000000x1000000", kUsage,
     "--grid: 1000000x1000000 is out of range (1x1 to 1000x1000; nearest: 1000x1000)"},
    {"--grid 99999999999999999999x4", kUsage,
     "--grid: 99999999999999999999x4 is out of range (1x1 to 1000x1000; nearest: 1000x4)"},
    {"--grid 4", kUsage, "--grid: '4' is not of the form XxY"},
    {"--grid 4x4x4", kUsage, "--grid: '4x4x4' is not of the form XxY"},
    {"--grid 4x4.5", kUsage, "--grid: '4.5' is not a whole number"},
    {"--coherence 1.2", kUsage, "--coherence: 1.2 is out of range (0 to 1; nearest: 1)"},
    {"--coherence -0.1", kUsage, "--coherence: -0.1 is out of range (0 to 1; nearest: 0)"},
    {"--coherence nan", kUsage, "--coherence: 'nan' is not a finite number"},
    {"--interval inf", kUsage, "--interval: 'inf' is not a finite number"},
    {"--interval 0", kUsage, "--interval: 0 is out of range (0.000001 to 1000000; nearest: 0.000001)"},
    {"--hold 1e999", kUsage, "~--hold: '1e999' does not fit a number"},
    {"--spacing 3m", kUsage, "--spacing: '3m' is not a number"},
    {"--brick 0.5x0.25", kUsage, "--brick: '0.5x0.25' is not of the form LxWxH"},
    {"--brick 0.5x0.25x-1", kUsage, "~--brick: 0.5x0.25x-1 is out of range"},
    {"--seed -1", kUsage, "--seed: -1 is out of range (0 to 9007199254740991; nearest: 0)"},
    {"--seed 1e3", kUsage, "--seed: '1e3' is not a whole number"},
    {"--threads 257", kUsage, "--threads: 257 is out of range (0 to 256; nearest: 256)"},
    {"--cells 1x1x1025", kUsage,
     "--cells: 1x1x1025 is out of range (1x1x1 to 1024x1024x1024; nearest: 1x1x1024)"},
    {"--cells 1024x1024x1024", kUsage, "~--cells: "},
    {"--test-set 4", kUsage, "--test-set: 4 is out of range (5 to 48; nearest: 5)"},
    {"--test-set 49", kUsage, "--test-set: 49 is out of range (5 to 48; nearest: 48)"},
    // Contradictions.
    {"--test-set 5 --grid 4x4", kUsage, "--grid: cannot be used with --test-set, which fixes the scene"},
    {"--windows off --window 1x1", kUsage, "--window: cannot be used with --windows off"},
    {"--draco-level 9", kUsage, "--draco-level: needs --draco"},
    {"--draco --draco-position-bits 1", kUsage,
     "--draco-position-bits: 1 is out of range (0, or 2 to 30; nearest: 2)"},
    {"--draco --draco-normal-bits 31", kUsage, "~--draco-normal-bits: 31 is out of range (0 to 30"},
    {"--draco-levle 9", kUsage, "--draco-levle: unknown option (did you mean '--draco-level'?)"},
    {"--extra-model sphere:8", kUsage, "--extra-model: needs --extras of 1 or more"},
    {"--curve none --coherence 0.5", kUsage,
     "--coherence: cannot be used with --curve none, which makes a static scene"},
    {"--cells 1x1x1 --coherence 0.5", kUsage, "~--coherence: "},
    {"-o - --format json", kUsage, "~--format: cannot be used with --output -"},
    {"-o - --report -", kUsage, "~--report: cannot be used with --output -"},
    // Too much.
    {"--grid 1000x1000 --spacing 0 --floors 1000", kUsage, "~more than 100000000 objects"},
    // Files.
    {"-o town.obj", kUsage, "--output: 'town.obj' ends neither in .glb nor in .gltf (nearest: 'town.glb')"},
    {"-o missing/town.glb", kIo, "missing/town.glb: cannot be written: No such file or directory"},
    {"-o /dev/null/town.glb", kIo, "/dev/null/town.glb: cannot be written: Not a directory"},
    {"-o .", kIo, ".: cannot be written: Is a directory"},
    {"-o town/", kIo, "~town/: cannot be written: "},
    {"--report missing/r.json", kIo, "missing/r.json: cannot be written: No such file or directory"},
    {"--config missing.json", kIo, "missing.json: cannot be read"},
    {"--extras 1 --extra-model missing.glb", kIo, "~missing.glb"},
    {"--building-model missing.glb", kIo, "~missing.glb"},
    {"--building-model missing.glb --extras 1", kUsage, "~--extras: cannot be used with --building-model"},
    {"--extras 1 --extra-model sphere:0", kUsage, "~sphere:0"},
    {"inspect missing.glb", kIo, "~missing.glb: "},
    {"inspect .", kIo, "~.: "},
    {"diff missing.glb missing.glb", kIo, "~missing.glb: "},
};

}  // namespace

TEST_CASE("a wrong call is one line, the right exit code, and nothing else") {
  const TemporaryFolder folder;
  for (const Case& wrong : kWrongCalls) {
    check_case(wrong, run(SCENEGEN_PROGRAM, words(wrong.arguments), {.folder = folder.path()}));
    CHECK(folder.entries().empty());
  }
}

TEST_CASE("an option that could have no effect is refused") {
  const std::vector<std::string> of_bricks = words(
      "--brick=1x1x1 --building-size=9x9 --floor-courses=9 --floors=2 --partitions=off --windows=off "
      "--window=1x1 --roof=flat --extras=1 --extra-model=box");
  for (const std::string& option : of_bricks) {
    check_case({option.c_str(), kUsage, "~ cannot be used with --building-model"},
               run(SCENEGEN_PROGRAM, {"--building-model", "missing.glb", option}));
    check_case({option.c_str(), kUsage, "~ cannot be used with --test-set"},
               run(SCENEGEN_PROGRAM, {"--test-set", "5", option}));
  }
  for (const std::string& option :
       words("--grid=2x2 --spacing=1 --ground=off --building-model=missing.glb")) {
    check_case({option.c_str(), kUsage, "~ cannot be used with --test-set"},
               run(SCENEGEN_PROGRAM, {"--test-set", "5", option}));
  }
  for (const std::string& option :
       words("--order=+x+y+z --cells=2x2x2 --interval=1 --hold=1 --coherence=1 --visibility=scale")) {
    check_case({option.c_str(), kUsage, "~ cannot be used with --curve none"},
               run(SCENEGEN_PROGRAM, {"--curve", "none", option}));
  }
}

TEST_CASE("a wrong config is located in its file") {
  const TemporaryFolder folder;
  const std::pair<const char*, Case> wrong_configs[] = {
      {"{\"gird\": \"4x4\"}", {"", kUsage, "c.json: /gird: unknown option (did you mean 'grid'?)"}},
      {"{\"grid\": \"0x4\"}",
       {"", kUsage, "c.json: /grid: 0x4 is out of range (1x1 to 1000x1000; nearest: 1x4)"}},
      {"{\"grid\": [4, 4]}", {"", kUsage, "c.json: /grid: is neither text, nor a number, nor true or false"}},
      {"{\"config\": \"c.json\"}", {"", kUsage, "~c.json: /config: unknown option"}},
      {"{\"coherence\": 1e400}", {"", kBad, "~c.json: "}},
      {"[]", {"", kBad, "c.json: is not a JSON object"}},
      {"{\"grid\": ", {"", kBad, "~c.json: parse error at line 1"}},
      {"", {"", kBad, "~c.json: parse error"}},
  };
  for (const auto& [text, wrong] : wrong_configs) {
    write_file(folder.file("c.json"), text);
    INFO(text);
    check_case(wrong, run(SCENEGEN_PROGRAM, {"--config", "c.json"}, {.folder = folder.path()}));
    CHECK(folder.entries() == std::vector<std::string>{"c.json"});
  }
  write_file(folder.file("c.json"), std::string((1 << 20) + 1, ' '));
  check_case({"", kBad, "c.json: is longer than 1 MiB: not a config file"},
             run(SCENEGEN_PROGRAM, {"--config", "c.json"}, {.folder = folder.path()}));
}

TEST_CASE("arguments that are no text are refused") {
  check_case({"", kUsage, "--extra-model: is not valid UTF-8"},
             run(SCENEGEN_PROGRAM, {"--extras", "1", "--extra-model", "\xff\xfe"}));
  check_case({"", kUsage, "~--curve: unknown value 'a?b'"}, run(SCENEGEN_PROGRAM, {"--curve", "a\nb"}));
  check_case({"", kUsage, "~--grid: "}, run(SCENEGEN_PROGRAM, {"--grid", ""}));
}

TEST_CASE("a full disk is an error and leaves nothing behind") {
  const TemporaryFolder folder;
  for (const char* arguments :
       {"-o town.glb", "-o town.gltf", "-o town.glb --layout nodes --visibility pointer"}) {
    const ProcessResult result =
        run(SCENEGEN_PROGRAM, words(arguments), {.folder = folder.path(), .most_file_bytes = 20'000});
    check_case({arguments, kIo, "~town."}, result);
    CHECK(folder.entries().empty());
  }
}

TEST_CASE("files and their report are written all or none") {
  const TemporaryFolder folder;
  const ProcessOptions here{.folder = folder.path()};
  REQUIRE(run(SCENEGEN_PROGRAM, words("--floors 1 -q -o model.glb"), here).code == 0);
  write_file(folder.file("plan.csv"), "id,start,finish,objects\n1,2024-03-01,2024-03-03,*\n");
  const std::vector<std::string> before = folder.entries();
  for (const char* call : {"", "animate model.glb", "optimize model.glb",
                           "schedule model.glb plan.csv --save-mapping map.json"}) {
    for (const char* name : {"out.glb", "out.gltf"}) {
      const std::string line = std::string(call) + " -o " + name + " --report /dev/full";
      check_case({line.c_str(), kIo, "/dev/full: cannot be written: No space left on device"},
                 run(SCENEGEN_PROGRAM, words(line), here));
      CHECK(folder.entries() == before);
    }
    // A pipe without a reader takes no model: its report stays away.
    ProcessOptions closed = here;
    closed.stdout_closed_pipe = true;
    const std::string line = std::string(call) + " -o - --report r.json";
    check_case({line.c_str(), kIo, "~Broken pipe"}, run(SCENEGEN_PROGRAM, words(line), closed));
    CHECK(folder.entries() == before);
    const std::string good = std::string(call) + " -o out.gltf -q --report r.json";
    REQUIRE(run(SCENEGEN_PROGRAM, words(good), here).code == 0);
    for (const char* made : {"out.gltf", "out.bin", "r.json", "map.json"})
      std::filesystem::remove(folder.file(made));
    CHECK(folder.entries() == before);
  }
}

TEST_CASE("a full disk under stdout is an error") {
  ProcessOptions full;
  full.stdout_path = "/dev/full";
  for (const char* arguments :
       {"-o -", "--help", "--version", "--dump-config", "--dry-run -q --format json"}) {
    check_case({arguments, kIo, "~No space left on device"}, run(SCENEGEN_PROGRAM, words(arguments), full));
  }
}

TEST_CASE("a reader that went away is an error, not a signal") {
  ProcessOptions closed;
  closed.stdout_closed_pipe = true;
  for (const char* arguments : {"-o - -q", "--help", "--dry-run -q --format json"}) {
    check_case({arguments, kIo, "~Broken pipe"}, run(SCENEGEN_PROGRAM, words(arguments), closed));
  }
}

TEST_CASE("no output overwrites an input or another output") {
  const TemporaryFolder folder;
  const std::string plan = "id,start,finish,objects\n1,2024-03-01,2024-03-02,name=*\n";
  REQUIRE(run(SCENEGEN_PROGRAM, words("--curve none -o model.glb -q"), {.folder = folder.path()}).code == 0);
  write_file(folder.file("plan.csv"), plan);
  std::filesystem::create_symlink("plan.csv", folder.file("link.csv"));
  const std::string model = read_file(folder.file("model.glb"));
  const auto entries = folder.entries();
  const std::string schedule = "schedule model.glb plan.csv ";
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"-o a.glb --report ./a.glb", "--report: would overwrite 'a.glb', which --output writes"},
      {"-o a.gltf --report a.bin", "--report: would overwrite 'a.bin', which --output writes"},
      {"-o model.glb --building-model model.glb",
       "--output: would overwrite 'model.glb', which is read (--building-model)"},
      {"animate model.glb -o a.glb --report a.glb",
       "--report: would overwrite 'a.glb', which --output writes"},
      {"animate model.glb -o a.glb --report model.glb",
       "--report: would overwrite 'model.glb', which is read (MODEL)"},
      {"optimize model.glb -o a.glb --report ../" + std::filesystem::path(folder.path()).filename().string() +
           "/model.glb",
       "--report: would overwrite 'model.glb', which is read (FILE)"},
      {"optimize model.glb -o a.glb --report a.glb",
       "--report: would overwrite 'a.glb', which --output writes"},
      {schedule + "-o a.glb --report link.csv", "--report: would overwrite 'plan.csv', which is read (PLAN)"},
      {schedule + "-o a.glb --save-mapping plan.csv",
       "--save-mapping: would overwrite 'plan.csv', which is read (PLAN)"},
      {schedule + "-o a.glb --report m.json --save-mapping m.json",
       "--save-mapping: would overwrite 'm.json', which --report writes"},
      {schedule + "-o a.glb --mapping m.json --report m.json",
       "--report: would overwrite 'm.json', which is read (--mapping)"},
      {schedule + "-o a.glb --save-mapping model.glb",
       "--save-mapping: would overwrite 'model.glb', which is read (MODEL)"},
      {schedule + "-o a.glb --report - --save-mapping -",
       "--save-mapping: cannot be used with --report -: stdout takes one of them"},
      {schedule + "-o - --save-mapping -",
       "--save-mapping: cannot be used with --output -: stdout takes one of them"},
  };
  for (const auto& [arguments, line] : wrong)
    check_case({arguments.c_str(), kUsage, line.c_str()},
               run(SCENEGEN_PROGRAM, words(arguments), {.folder = folder.path()}));
  CHECK(folder.entries() == entries);
  CHECK(read_file(folder.file("model.glb")) == model);
  CHECK(read_file(folder.file("plan.csv")) == plan);
  // The model itself may be replaced, a mapping brought up to date, and /dev/null takes everything.
  for (const std::string& arguments : {schedule + "-o model.glb -q --save-mapping m.json",
                                       schedule + "-o model.glb -q --mapping m.json --save-mapping m.json",
                                       schedule + "-o a.glb -q --report /dev/null --save-mapping /dev/null",
                                       std::string("optimize model.glb -o model.glb -q"),
                                       std::string("animate model.glb -o model.glb -q")}) {
    write_file(folder.file("model.glb"), model);
    const ProcessResult result = run(SCENEGEN_PROGRAM, words(arguments), {.folder = folder.path()});
    INFO(arguments << "\n" << result.err);
    CHECK(result.code == 0);
  }
}

TEST_CASE("what was there before stays when writing fails") {
  const TemporaryFolder folder;
  write_file(folder.file("town.glb"), "before");
  const ProcessResult result =
      run(SCENEGEN_PROGRAM, {"-o", "town.glb"}, {.folder = folder.path(), .most_file_bytes = 20'000});
  CHECK(result.code == kIo);
  CHECK(read_file(folder.file("town.glb")) == "before");
  CHECK(folder.entries() == std::vector<std::string>{"town.glb"});
}

TEST_CASE("a signal leaves no part of a file behind and ends the process as signals do") {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const TemporaryFolder folder;
    write_file(folder.file("town.glb"), "before");
    ProcessOptions options{.folder = folder.path()};
    options.interrupt = signal;
    options.interrupt_when = [&] { return folder.entries().size() > 1; };
    const ProcessResult result =
        run(SCENEGEN_PROGRAM, words("--grid 8x8 --layout nodes -o town.glb"), options);
    CHECK(result.signal == signal);
    CHECK(folder.entries() == std::vector<std::string>{"town.glb"});
    CHECK(read_file(folder.file("town.glb")) == "before");
  }
}

#if !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)  // their shadow memory is larger than any limit
TEST_CASE("too little memory is one line, not a signal") {
  const TemporaryFolder folder;
  const ProcessResult result = run(SCENEGEN_PROGRAM, words("--grid 30x30 -o town.glb"),
                                   {.folder = folder.path(), .most_memory_bytes = 200'000'000});
  check_case({"--grid 30x30", kBad, "~memory"}, result);
  CHECK(folder.entries().empty());
}
#endif

TEST_CASE("a damaged file is one line") {
  const TemporaryFolder folder;
  REQUIRE(run(SCENEGEN_PROGRAM, {"-o", "town.glb", "-q"}, {.folder = folder.path()}).code == 0);
  const std::string whole = read_file(folder.file("town.glb"));
  for (const std::size_t kept : {std::size_t{0}, std::size_t{3}, std::size_t{12}, std::size_t{20},
                                 whole.size() / 2, whole.size() - 1}) {
    write_file(folder.file("cut.glb"), whole.substr(0, kept));
    INFO("first " << kept << " bytes");
    check_case({"inspect cut.glb", kBad, "~cut.glb"},
               run(SCENEGEN_PROGRAM, {"inspect", "cut.glb"}, {.folder = folder.path()}));
    check_case({"diff", kBad, "~cut.glb"},
               run(SCENEGEN_PROGRAM, {"diff", "town.glb", "cut.glb"}, {.folder = folder.path()}));
  }
}
