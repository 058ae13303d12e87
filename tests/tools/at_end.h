// A scene as it stands when its timeline is over, without a timeline: what a model must still be after it was
// animated.
#pragma once

#include "scene/scene.h"

namespace scenegen::test {

/// Every track at its last key; objects that are hidden then are left out.
[[nodiscard]] Scene at_end(const Scene& scene);

}  // namespace scenegen::test
