#include "gen/layout.h"

namespace scenegen::gen {

const char* name_of(PartKind kind) {
  static constexpr std::array<const char*, kPartKinds> kNames{"brick", "block", "lintel", "sill",    "frame",
                                                              "pane",  "door",  "step",   "slab",    "coping",
                                                              "tile",  "ridge", "gravel", "pavement"};
  return kNames[static_cast<std::size_t>(kind)];
}

}  // namespace scenegen::gen
