// One building of bricks.
#pragma once

#include "gen/plan.h"

namespace scenegen::gen {

/// Parts of the building; stops when there are more than `most_parts` (then false). Deterministic, no
/// randomness.
bool build_building(const BuildingPlan& plan, std::uint64_t most_parts, Layout& layout);

}  // namespace scenegen::gen
