#include "tests/support/facts_json.h"

namespace scenegen::test {
namespace {

using nlohmann::ordered_json;

// Both directions go through the same lists. `see` gets a name and a number, or a name and a load.
void each_of(auto& load, const auto& see) {
  see("draws", load.draws);
  see("vertices", load.vertices);
  see("fragments", load.fragments);
  see("triangles", load.triangles);
  see("texturedShare", load.textured_share);
  see("texturedFragmentShare", load.textured_fragment_share);
  see("screenShare", load.screen_share);
  see("commands", load.commands);
}

void each_number(auto& facts, const auto& see) {
  see("visibleSlots", facts.visible_slots);
  see("changed", facts.changed);
  see("screenPixels", facts.screen_pixels);
  see("shadowSlots", facts.shadow_slots);
  see("shadowVertices", facts.shadow_vertices);
  see("height", facts.height);
  see("chunksRefreshed", facts.chunks_refreshed);
  see("slotsRefreshed", facts.slots_refreshed);
  see("nodesVisited", facts.nodes_visited);
  see("boxesTested", facts.boxes_tested);
  see("chunks", facts.chunks);
  see("chunksRerecorded", facts.chunks_rerecorded);
  see("drawsRerecorded", facts.draws_rerecorded);
  see("commandsPerDraw", facts.commands_per_draw);
  see("runsPerChunk", facts.runs_per_chunk);
  see("asked", facts.asked);
  see("askedFragments", facts.asked_fragments);
  see("chunksHidden", facts.chunks_hidden);
  see("allAskedFragments", facts.all_asked_fragments);
  see("allChunksHidden", facts.all_chunks_hidden);
  see("hiZBlocks", facts.hi_z_blocks);
}

void each_load(auto& facts, const auto& see) {
  see("blended", facts.blended);
  see("visible", facts.visible);
  see("inFrustum", facts.in_frustum);
  see("inChunks", facts.in_chunks);
  see("hidden", facts.hidden);
  see("allHidden", facts.all_hidden);
  see("slotsHidden", facts.slots_hidden);
  see("seen", facts.seen);
}

}  // namespace

ordered_json facts_json(const render::model::FrameFacts& facts) {
  ordered_json out;
  each_number(facts, [&](const char* name, double value) { out[name] = value; });
  each_load(facts, [&](const char* name, const render::model::Load& load) {
    ordered_json& of = out[name];
    each_of(load, [&](const char* part, double value) { of[part] = value; });
  });
  return out;
}

render::model::FrameFacts facts_from_json(const ordered_json& json) {
  render::model::FrameFacts out;
  each_number(out, [&](const char* name, double& value) { json.at(name).get_to(value); });
  each_load(out, [&](const char* name, render::model::Load& load) {
    const ordered_json& of = json.at(name);
    each_of(load, [&](const char* part, double& value) { of.at(part).get_to(value); });
  });
  return out;
}

}  // namespace scenegen::test
