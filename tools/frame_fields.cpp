#include "tools/frame_fields.h"

#include <array>

namespace scenegen::tools {

using render::FrameReport;

std::span<const CounterField> counter_fields() {
  static constexpr std::array kFields{
      CounterField{"objects", &FrameReport::objects},
      CounterField{"changed", &FrameReport::changed},
      CounterField{"visible", &FrameReport::visible},
      CounterField{"tested", &FrameReport::tested},
      CounterField{"nodes", &FrameReport::nodes},
      CounterField{"treeNodes", &FrameReport::tree_nodes},
      CounterField{"secondaries", &FrameReport::secondaries},
      CounterField{"recorded", &FrameReport::recorded},
      CounterField{"recordedDraws", &FrameReport::recorded_draws},
      CounterField{"indirectCommands", &FrameReport::indirect_commands},
      CounterField{"queries", &FrameReport::queries},
      CounterField{"believedHidden", &FrameReport::believed_hidden},
      CounterField{"answers", &FrameReport::answers},
      CounterField{"foundHidden", &FrameReport::found_hidden},
      CounterField{"reveals", &FrameReport::reveals},
      CounterField{"drawn", &FrameReport::drawn},
      CounterField{"draws", &FrameReport::draws},
      CounterField{"triangles", &FrameReport::triangles},
      CounterField{"shadowDraws", &FrameReport::shadow_draws},
      CounterField{"shadowTriangles", &FrameReport::shadow_triangles},
      CounterField{"idsDraws", &FrameReport::ids_draws},
      CounterField{"idsTriangles", &FrameReport::ids_triangles},
      CounterField{"uploadedBytes", &FrameReport::uploaded_bytes},
  };
  return kFields;
}

std::span<const StageField> stage_fields() {
  static constexpr std::array kFields{
      StageField{"update", &FrameReport::update_ms, true},
      StageField{"updateOctree", &FrameReport::update_octree_ms, false},
      StageField{"cull", &FrameReport::plan_ms, true},
      StageField{"record", &FrameReport::record_ms, true},
      StageField{"upload", &FrameReport::upload_ms, false},
      StageField{"keep", &FrameReport::keep_ms, false},
      StageField{"secondaries", &FrameReport::secondaries_ms, false},
      StageField{"ask", &FrameReport::ask_ms, false},
      StageField{"receive", &FrameReport::receive_ms, false},
      StageField{"submit", &FrameReport::submit_ms, true},
      StageField{"wait", &FrameReport::wait_ms, false},
      StageField{"gpu", &FrameReport::gpu_ms, false},
      StageField{"readback", &FrameReport::readback_ms, false},
  };
  return kFields;
}

}  // namespace scenegen::tools
