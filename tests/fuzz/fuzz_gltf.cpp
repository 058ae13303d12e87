// libFuzzer target: any bytes give an error, or a scene that passes validate(), also when it was optimized.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "scene/gltf/read.h"
#include "scene/gltf/survey.h"
#include "scene/optimize/optimize.h"
#include "scene/validate.h"

namespace {

void must_be_valid(const scenegen::Scene& scene) {
  for (const scenegen::Finding& f : scenegen::validate(scene, 1)) {
    std::fprintf(stderr, "rule %d: %s: %s\n", f.rule, f.where.c_str(), f.what.c_str());
    std::abort();
  }
}

void must_be_one_line(const scenegen::Error& error) {
  if (!error.what.empty() && error.str().find('\n') == std::string::npos) return;
  std::fprintf(stderr, "error that is not one line: %s\n", error.str().c_str());
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  auto read = scenegen::gltf::read_memory({data, data + size}, "fuzz", "", {size % 2 == 0, 1});
  if (!read) {
    must_be_one_line(read.error());
    return 0;
  }
  must_be_valid(read->scene);
  // What the reader skips need not be JSON: then survey() gives an error.
  if (read->source != nullptr) {
    if (const auto survey = scenegen::gltf::survey(*read); !survey) must_be_one_line(survey.error());
  }
  scenegen::optimize(read->scene);
  must_be_valid(read->scene);
  return 0;
}
