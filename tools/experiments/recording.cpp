// D 5.4: recording commands for every object, or keeping them in secondary command buffers of one or a
// thousand draws; and draws that the device culls by itself.
#include <malloc.h>

#include <algorithm>
#include <array>
#include <limits>

#include "render/strategy/draw_list.h"
#include "tools/experiments/all.h"
#include "tools/experiments/device_culling.h"
#include "tools/experiments/draw_stage.h"
#include "tools/experiments/measures.h"
#include "tools/experiments/paper.h"
#include "tools/experiments/scenes.h"

namespace scenegen::tools {
namespace {

using render::PassContext;

render::View first_camera(const ExperimentContext& context, const Scene& scene) {
  const float aspect = static_cast<float>(context.width) / static_cast<float>(context.height);
  return render::view_of_camera(scene.cameras.front(), scene.cameras.front().frame_from_camera.matrix(),
                                aspect);
}

/// Draws kept in secondary command buffers of `each`, recorded once.
class KeptBuffers {
 public:
  KeptBuffers(DrawStage& stage, std::uint32_t each)
      : pool_(stage.device().device, {{}, stage.device().queue_family}) {
    const auto slots = static_cast<std::uint32_t>(stage.scene().slot_count());
    const std::uint32_t count = (slots + each - 1) / each;
    buffers_ =
        vk::raii::CommandBuffers(stage.device().device, {*pool_, vk::CommandBufferLevel::eSecondary, count});
    handles_.reserve(count);
    for (std::uint32_t b = 0; b < count; ++b) {
      render::begin_secondary(buffers_[b], stage.pipelines(), stage.target(),
                              vk::CommandBufferUsageFlagBits::eSimultaneousUse);
      render::DrawRecorder recorder(buffers_[b], stage.pipelines(), stage.gpu(), stage.scene(),
                                    stage.target().pass);
      for (std::uint32_t s = b * each; s < std::min(slots, (b + 1) * each); ++s) recorder.draw(s);
      buffers_[b].end();
      handles_.push_back(*buffers_[b]);
    }
  }
  [[nodiscard]] std::span<const vk::CommandBuffer> handles() const { return handles_; }

 private:
  vk::raii::CommandPool pool_;
  vk::raii::CommandBuffers buffers_{nullptr};
  std::vector<vk::CommandBuffer> handles_;
};

struct Recorded {
  std::vector<double> record_ms, submit_ms, device_ms;
  std::uint64_t process_bytes = 0;
  std::uint64_t commands_bytes = 0;  ///< of it, what the commands took
};

/// `each`: 0 records every object each frame.
Recorded measure(DrawStage& stage, std::uint32_t each, std::uint32_t repeat) {
  Recorded out;
  (void)malloc_trim(0);
  const std::uint64_t before = resident_bytes();
  std::optional<KeptBuffers> kept;
  if (each > 0) kept.emplace(stage, each);
  const auto slots = static_cast<std::uint32_t>(stage.scene().slot_count());
  const auto record = [&](const PassContext& context) {
    render::PassRecording pass(context, stage.target());
    if (kept) {
      pass.execute(kept->handles(), {});
    } else {
      render::DrawRecorder& draws = pass.draws();
      for (std::uint32_t s = 0; s < slots; ++s) draws.draw(s);
    }
    pass.end();
  };
  stage.frame(record);
  out.process_bytes = resident_bytes();
  out.commands_bytes = out.process_bytes - std::min(out.process_bytes, before);
  for (std::uint32_t r = 0; r < repeat; ++r) {
    const StageFrame f = stage.frame(record);
    out.record_ms.push_back(f.record_ms);
    out.submit_ms.push_back(f.submit_ms);
    out.device_ms.push_back(f.gpu_ms >= 0 ? f.gpu_ms : f.wait_ms);
  }
  return out;
}

struct Technique {
  const char* name;
  const char* title;
  std::uint32_t each;
};
// The one that takes the least memory first: what a driver keeps hides what the next one takes.
constexpr std::array kTechniques{Technique{"secondary_of_1000", "kept, 1000 a buffer", 1000},
                                 Technique{"record_every_object", "every object recorded", 0},
                                 Technique{"secondary_of_1", "kept, 1 a buffer", 1}};

Result<DocumentTable> recording_table(const ExperimentContext& context, std::string& found) {
  const PaperTable paper("command_recording");
  DocumentTable table{"recording-times",
                      "Recording and submitting commands",
                      {{"technique", "technique", ""},
                       {"objects", "objects", "", Origin::ours, Better::none, {}, 6},
                       {"recordMs", "record", "ms", Origin::ours, Better::lower, "recordPaper"},
                       {"recordPaper", "record", "ms", Origin::paper, Better::lower},
                       {"submitMs", "submit", "ms", Origin::ours, Better::lower, "submitPaper"},
                       {"submitPaper", "submit", "ms", Origin::paper, Better::lower},
                       {"spread", "spread, most", "%"},
                       {"deviceMs", "then on the device", "ms", Origin::ours, Better::lower},
                       {"memoryMb", "process", "MB", Origin::ours, Better::lower, "memoryPaper"},
                       {"memoryPaper", "memory", "MB", Origin::paper, Better::lower},
                       {"commandsMb", "of it commands", "MB", Origin::ours, Better::lower}},
                      {},
                      {}};
  const std::vector<std::uint32_t> sizes = context.quick
                                               ? std::vector<std::uint32_t>{2000, 10000}
                                               : std::vector<std::uint32_t>{10000, 50000, 100000, 300000};
  const std::uint32_t repeat = repetitions(context, 9, 3);
  std::array<double, kTechniques.size()> largest{};
  for (std::size_t t = 0; t < kTechniques.size(); ++t) {
    for (const std::uint32_t size : sizes) {
      begin_step(context, std::string("recording: ") + kTechniques[t].title + ", " + human_count(size));
      const Scene scene = random_boxes(size, context.seed);
      auto stage =
          DrawStage::make(context, scene, first_camera(context, scene), render::vkr::PassKind::color);
      if (!stage) return forward_error(stage);
      Recorded r;
      auto done = (*stage)->guarded([&] { r = measure(**stage, kTechniques[t].each, repeat); });
      if (!done) return forward_error(done);
      const Spread record = spread_of(r.record_ms);
      const Spread submit = spread_of(r.submit_ms);
      largest[t] = record.median + submit.median;
      const PaperTable::Where row{{"technique", kTechniques[t].name}, {"objects", std::to_string(size)}};
      table.rows.push_back({kTechniques[t].title, static_cast<double>(size), record.median,
                            paper.cell(row, "record_ms"), submit.median, paper.cell(row, "submit_ms"),
                            spread_cell({record, submit}), spread_of(r.device_ms).median,
                            static_cast<double>(r.process_bytes) * 1e-6, paper.cell(row, "memory_mb"),
                            static_cast<double>(r.commands_bytes) * 1e-6});
    }
  }
  table.note =
      "D tables 3 to 5. Random boxes, all drawn, one frame in flight. Memory is what the process holds in "
      "the host's "
      "memory, which has the program, the scene and the driver in it; what the driver keeps of earlier cases "
      "may make "
      "'of it commands' too little. 'then on the device' is not in D.";
  found = "For " + human_count(sizes.back()) + " objects, recording and submitting take " +
          in_words(largest[1]) + " ms when every object is recorded, " + in_words(largest[2]) +
          " ms with one kept command buffer an object and " + in_words(largest[0]) + " ms with one for 1000";
  return table;
}

// ---- Draws that the device culls
// ------------------------------------------------------------------------------

Result<std::vector<double>> device_culled(const ExperimentContext& context, const Scene& scene,
                                          std::uint32_t repeat) {
  auto stage = DrawStage::make(context, scene, first_camera(context, scene), render::vkr::PassKind::color);
  if (!stage) return forward_error(stage);
  std::vector<double> out;
  if (!(*stage)->device().indirect_nodes) return out;
  auto done = (*stage)->guarded([&] {
    DeviceCulling culling(**stage);
    for (std::uint32_t r = 0; r < repeat + 3; ++r) {
      const StageFrame f = (*stage)->frame([&](const PassContext& c) { culling.record(c); });
      if (r >= 3) out.push_back(f.whole_ms());
    }
  });
  if (!done) return forward_error(done);
  return out;
}

Result<void> indirect_table(const ExperimentContext& context, DocumentTable& table, Chart& chart) {
  const PaperTable paper("indirect_vs_cpu");
  const std::vector<std::uint32_t> sides =
      context.quick ? std::vector<std::uint32_t>{12, 20} : std::vector<std::uint32_t>{20, 30, 40, 50, 60};
  const std::uint32_t repeat = repetitions(context, 3, 1);
  for (const std::uint32_t side : sides) {
    const std::uint32_t count = side * side * side;
    begin_step(context, "recording: " + human_count(count) + " objects, indirect or recorded");
    const Scene scene = box_grid(side);
    auto indirect = device_culled(context, scene, context.quick ? 5 : 40);
    if (!indirect) return forward_error(indirect);
    const Turns turns{std::vector<double>(context.quick ? 5 : 40, 0.0), 8, repeat, 1};
    auto runs =
        compare_ways(context, scene, {{"recorded", "inline", false}, {"cached", "octree", false}}, turns);
    if (!runs) return forward_error(runs);
    const Spread recorded = (*runs)[0].frame_ms();
    const Spread cached = (*runs)[1].frame_ms();
    const double indirect_ms = indirect->empty() ? -1.0 : spread_of(*indirect).median;
    const PaperTable::Where row{{"objects", std::to_string(count)}};
    table.rows.push_back({static_cast<double>(count), known(indirect_ms),
                          paper.cell(row, "draw_indirect_gpu_ms"), recorded.median,
                          paper.cell(row, "recorded_on_cpu_ms"), cached.median,
                          paper.cell(row, "cached_on_cpu_ms"), spread_cell({recorded, cached})});
    const auto add = [&](std::size_t at, std::optional<double> ours, const char* column) {
      if (ours) chart.series[at].points.push_back({static_cast<double>(count), *ours, {}, {}});
      if (const auto theirs = paper.number(row, column))
        chart.series[at + 3].points.push_back({static_cast<double>(count), *theirs, {}, {}});
    };
    add(0, indirect_ms < 0 ? std::optional<double>() : indirect_ms, "draw_indirect_gpu_ms");
    add(1, recorded.median, "recorded_on_cpu_ms");
    add(2, cached.median, "cached_on_cpu_ms");
  }
  return {};
}

}  // namespace

Result<DocumentSection> recording(const ExperimentContext& context) {
  std::string found;
  auto table = recording_table(context, found);
  if (!table) return forward_error(table);
  DocumentTable indirect{
      "indirect-or-recorded",
      "Time of a frame: draws culled by the device, recorded, and kept",
      {{"objects", "objects", "", Origin::ours, Better::none, {}, 6},
       {"indirectMs", "indirect, culled by the device", "ms", Origin::ours, Better::lower, "indirectPaper"},
       {"indirectPaper", "indirect", "ms", Origin::paper, Better::lower},
       {"recordedMs", "recorded", "ms", Origin::ours, Better::lower, "recordedPaper"},
       {"recordedPaper", "recorded", "ms", Origin::paper, Better::lower},
       {"cachedMs", "kept", "ms", Origin::ours, Better::lower, "cachedPaper"},
       {"cachedPaper", "kept", "ms", Origin::paper, Better::lower},
       {"spread", "spread, most", "%"}},
      {},
      "D table 6, on a GeForce GTX 1070 with a picture of a size that it does not give, so times are not "
      "like for like; how they grow is. Boxes in a grid, one frame in flight. Indirect: a compute "
      "shader tests every box against the frustum and sets its draw's number of instances. Recorded: "
      "culled and recorded by the processor (inline). Kept: command buffers of an octree's chunks, or "
      "indirect draws where those cost less (octree)."};
  Chart chart{"indirect",
              "Frame time by number of objects",
              "objects",
              "frame time, ms",
              {{"indirect", {}, Origin::ours},
               {"recorded", {}, Origin::ours},
               {"kept", {}, Origin::ours},
               {"indirect, paper", {}, Origin::paper},
               {"recorded, paper", {}, Origin::paper},
               {"kept, paper", {}, Origin::paper}},
              false,
              false,
              {}};
  if (auto done = indirect_table(context, indirect, chart); !done) return forward_error(done);
  auto picture = take_picture(context, random_boxes(context.quick ? 2000 : 10000, context.seed), 0,
                              "recording", "Random boxes");
  if (!picture) return forward_error(picture);
  DocumentSection out{"recording", "Recording and submitting commands", {}, {}};
  out.paragraphs.push_back(found + ".");
  out.paragraphs.emplace_back(
      "The dissertation: for 300 000 objects 55.6 ms, 48.8 ms and 0.2 ms, and one command buffer an object "
      "takes 5.3 GB.");
  out.blocks.emplace_back(std::move(*table));
  out.blocks.emplace_back(std::move(indirect));
  out.blocks.emplace_back(std::move(chart));
  out.blocks.emplace_back(std::move(*picture));
  return out;
}

}  // namespace scenegen::tools
