#include "gen/building.h"

#include <algorithm>
#include <cmath>

#include "gen/roof.h"
#include "gen/storey.h"

namespace scenegen::gen {

bool build_building(const BuildingPlan& plan, std::uint64_t most_parts, Layout& layout) {
  // One storey tells how many there will be, before anything is kept.
  LayoutSink counter(layout, most_parts / static_cast<std::uint64_t>(plan.floors), LayoutSink::Mode::count);
  build_storey(plan, 0, 0, counter);
  if (counter.overflowed()) return false;
  layout.parts.reserve(counter.count() * static_cast<std::uint64_t>(plan.floors));

  LayoutSink sink(layout, most_parts);
  int bottom_mm = 0;
  if (plan.fitted && plan.margin_mm > 0) {
    sink.set_storey(kSiteStorey);
    const int out = plan.margin_mm;
    sink.add(PartKind::pavement,
             {{-out, -out, 0}, {plan.size_mm.x + out, plan.size_mm.y + out, plan.pavement_mm}});
  }
  if (plan.fitted) bottom_mm = plan.pavement_mm;
  for (int floor = 0; floor < plan.floors && !sink.overflowed(); ++floor) {
    sink.set_storey(static_cast<std::uint32_t>(floor));
    build_storey(plan, floor, bottom_mm, sink);
    bottom_mm += plan.storey_mm();
  }
  if (!sink.overflowed()) build_roof(plan, bottom_mm, sink);
  layout.size_mm = {plan.size_mm, bottom_mm};
  for (const Part& part : layout.parts) {
    if (part.frame == PartFrame::building) layout.size_mm.z = std::max(layout.size_mm.z, part.box.hi_mm.z);
  }
  return !sink.overflowed();
}

}  // namespace scenegen::gen
