// asset.extras.scenegen.calendar. Private to scene/gltf.
#pragma once

#include "scene/gltf/write_text.h"
#include "scene/scene.h"

namespace scenegen::gltf {

/// ,"calendar":{…} (docs/FORMAT.md 1)
void emit_calendar(const Calendar& calendar, TextOut& out);

}  // namespace scenegen::gltf
