// Channels of the one animation: which there are and their text.
#include "scene/gltf/write_document.h"
#include "scene/gltf/write_info.h"

namespace scenegen::gltf {

namespace {
constexpr std::uint32_t kNone = ChannelPlan::kNone;

bool is_wrapped(const NodePlan& nodes, std::uint32_t object) {
  return !nodes.wrapped.empty() && std::binary_search(nodes.wrapped.begin(), nodes.wrapped.end(), object);
}

void plan_group_channels(const NodePlan& nodes, AnimationPlanner& planner, ChannelPlan& plan) {
  for (const GroupNode& node : nodes.group_nodes) {
    const bool by_scale = node.by_scale.track.valid(), by_pointer = node.by_pointer.track.valid();
    plan.scale_of_group_node.push_back(by_scale ? planner.scale_sampler(node.by_scale, glm::vec3(1.0F))
                                                : kNone);
    plan.pointer_of_group_node.push_back(by_pointer ? planner.pointer_sampler(node.by_pointer) : kNone);
    plan.channel_count += (by_scale ? 1 : 0) + (by_pointer ? 1 : 0);
  }
}

void plan_object_channels(const Scene& scene, const NodePlan& nodes, AnimationPlanner& planner,
                          ChannelPlan& plan) {
  const auto want = [&](TrackId track) {
    if (nodes.pointer()) {
      std::uint32_t& sampler = plan.pointer_of_track[track.value];
      if (sampler == kNone) sampler = planner.pointer_sampler({track, {}});
      ++plan.channel_count;
    }
    if (nodes.scale()) ++plan.channel_count;
  };
  const auto want_unit_scale = [&](TrackId track) {
    if (!nodes.scale()) return;
    std::uint32_t& sampler = plan.unit_scale_of_track[track.value];
    if (sampler == kNone) sampler = planner.scale_sampler({track, {}}, glm::vec3(1.0F));
  };
  const bool all = nodes.layout == Layout::nodes;
  const std::size_t count = all ? scene.objects.size() : nodes.single.size();
  if (nodes.scale()) plan.scale_of_object.assign(count, kNone);
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t i = all ? k : nodes.single[k];
    const TrackId track = scene.objects.visibility[i];
    if (!track.valid()) continue;
    want(track);
    if (!nodes.scale()) continue;
    if (is_wrapped(nodes, i)) {
      want_unit_scale(track);
    } else {
      plan.scale_of_object[k] = planner.scale_sampler({track, {}}, scene.objects.frame_from_object[i].scale);
    }
  }
}

}  // namespace

ChannelPlan plan_channels(const Scene& scene, const NodePlan& nodes, const std::vector<float>& strengths) {
  ChannelPlan plan;
  AnimationPlanner planner(nodes.tracks);
  plan.pointer_of_track.assign(nodes.pointer() ? scene.tracks.size() : 0, kNone);
  plan.unit_scale_of_track.assign(nodes.scale() ? scene.tracks.size() : 0, kNone);
  plan_group_channels(nodes, planner, plan);
  plan_object_channels(scene, nodes, planner, plan);
  for (const LookNode& look : nodes.looks)
    plan.of_look.push_back(planner.scale_sampler({look.track, look.look}, glm::vec3(1.0F)));
  for (const FrameTrack& t : scene.frame_tracks)
    plan.of_frame_track.push_back(planner.value_sampler(t.track, 1.0F));
  for (const MaterialTrack& t : scene.material_tracks) {
    const bool emissive = scene.tracks[t.track.value].property == Property::emissive;
    plan.of_material_track.push_back(
        planner.value_sampler(t.track, emissive ? strengths[t.material.value] : 1.0F));
  }
  plan.channel_count += plan.of_look.size() + plan.of_frame_track.size() + plan.of_material_track.size();
  plan.animation = std::move(planner).take();
  return plan;
}

void Document::emit_channels(TextOut& out) const {
  ChannelText text(out);
  const auto whole = [&](TrackId track, std::uint32_t node) {  // inserted parents
    if (nodes_.scale()) text.node(channels_.unit_scale_of_track[track.value], node, "scale");
    if (nodes_.pointer()) text.visible(channels_.pointer_of_track[track.value], node);
  };
  for (std::uint32_t g = 0; g < nodes_.group_nodes.size(); ++g) {
    const std::uint32_t scale = channels_.scale_of_group_node[g];
    const std::uint32_t pointer = channels_.pointer_of_group_node[g];
    if (scale != kNone) text.node(scale, nodes_.first_group + g, "scale");
    if (pointer != kNone) text.visible(pointer, nodes_.first_group + g);
  }
  const bool all = nodes_.layout == Layout::nodes;
  const std::size_t count = all ? scene_.objects.size() : nodes_.single.size();
  for (std::uint32_t k = 0; k < count && !out.sink().failed(); ++k) {
    const std::uint32_t i = all ? k : nodes_.single[k];
    const TrackId track = scene_.objects.visibility[i];
    if (!track.valid()) continue;
    const std::uint32_t node = nodes_.layout == Layout::instances ? nodes_.first_object + k : i;
    if (is_wrapped(nodes_, i)) {
      whole(track, top_node_of(i));
      continue;
    }
    if (nodes_.scale()) text.node(channels_.scale_of_object[k], node, "scale");
    if (nodes_.pointer()) text.visible(channels_.pointer_of_track[track.value], node);
  }
  for (std::uint32_t l = 0; l < nodes_.looks.size(); ++l)
    text.node(channels_.of_look[l], nodes_.first_look + l, "scale");
  for (std::size_t i = 0; i < scene_.frame_tracks.size(); ++i) {
    const FrameTrack& t = scene_.frame_tracks[i];
    text.node(channels_.of_frame_track[i], nodes_.first_frame + t.frame.value,
              path_of(scene_.tracks[t.track.value].property));
  }
  for (std::size_t i = 0; i < scene_.material_tracks.size(); ++i) {
    const MaterialTrack& t = scene_.material_tracks[i];
    const bool emissive = scene_.tracks[t.track.value].property == Property::emissive;
    text.pointer(channels_.of_material_track[i], "/materials/", t.material.value,
                 emissive ? "/emissiveFactor" : "/pbrMetallicRoughness/baseColorFactor");
  }
}

void Document::emit_animation(TextOut& out) const {
  if (channels_.channel_count == 0) return;
  out.raw(R"(,"animations":[{"name":"timeline","samplers":[)");
  Commas commas(out);
  for (const AnimationSampler& sampler : channels_.animation.samplers) {
    commas.next();
    emit_sampler(buffer_.first_input + sampler.input, buffer_.accessor_of(sampler), sampler.interpolation,
                 out);
  }
  out.raw(R"(],"channels":[)");
  emit_channels(out);
  out.raw("]}]");
}

}  // namespace scenegen::gltf
