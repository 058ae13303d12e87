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
      CounterField{"chunks", &FrameReport::chunks},
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
      CounterField{"stateChanges", &FrameReport::state_changes},
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
      StageField{"choose", &FrameReport::choose_ms, false},
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

void add_choice(const FrameReport& report, nlohmann::ordered_json& to) {
  using nlohmann::ordered_json;
  namespace model = render::model;
  to["strategyUsed"] = report.strategy_used;
  if (report.verdict.used_s > 0.0) {
    const model::Verdict& v = report.verdict;
    to["reason"] = model::in_words(v);
    to["sidesMs"] = {{model::name_of(v.used), v.used_s * 1e3}};
    if (v.rival != v.used) to["sidesMs"][std::string(model::name_of(v.rival))] = v.rival_s * 1e3;
  }
  if (report.predicted.front().frame_s <= 0.0) return;
  ordered_json& all = to["predicted"] = ordered_json::array();
  for (std::size_t m = 0; m < report.predicted.size(); ++m) {
    const model::Prediction& p = report.predicted[m];
    all.push_back({{"name", model::name_of(static_cast<model::Method>(m))},
                   {"cpuMs", p.cpu_s * 1e3},
                   {"gpuMs", p.gpu_s * 1e3},
                   {"totalMs", p.frame_s * 1e3}});
  }
}

}  // namespace scenegen::tools
