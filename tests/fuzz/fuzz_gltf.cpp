// libFuzzer target: any bytes give an error, or a scene that passes validate().
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "scene/gltf/read.h"
#include "scene/validate.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto read = scenegen::gltf::read_memory({data, data + size}, "fuzz", "", {size % 2 == 0, 1});
  if (!read) {
    if (!read.error().what.empty() && read.error().str().find('\n') == std::string::npos) return 0;
    std::fprintf(stderr, "error that is not one line: %s\n", read.error().str().c_str());
    std::abort();
  }
  for (const scenegen::Finding& f : scenegen::validate(read->scene, 1)) {
    std::fprintf(stderr, "rule %d: %s: %s\n", f.rule, f.where.c_str(), f.what.c_str());
    std::abort();
  }
  return 0;
}
