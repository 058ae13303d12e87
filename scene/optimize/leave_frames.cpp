#include <cmath>
#include <optional>

#include "scene/optimize/steps.h"

namespace scenegen::optimizing {

namespace {

/// The nearest frame above (or at) a frame that moves, and where the frame lies in it.
struct Anchor {
  FrameId frame;  ///< none: the world
  glm::dmat4 anchor_from_frame{1.0};
};

std::vector<Anchor> find_anchors(const Scene& scene) {
  std::vector<std::uint8_t> moves(scene.frames.size(), 0);
  for (const FrameTrack& t : scene.frame_tracks) moves[t.frame.value] = 1;
  std::vector<Anchor> anchors(scene.frames.size());
  for (std::size_t f = 0; f < scene.frames.size(); ++f) {
    const Frame& frame = scene.frames[f];
    if (moves[f] != 0) {
      anchors[f].frame = FrameId(f);
      continue;
    }
    if (frame.parent.valid()) anchors[f] = anchors[frame.parent.value];  // parents stand before
    const glm::dmat4 local(frame.has_matrix ? frame.matrix : frame.local.matrix());
    anchors[f].anchor_from_frame = anchors[f].anchor_from_frame * local;
  }
  return anchors;
}

/// The placement whose matrix is `m` to some units in the last place; none for one with shear.
std::optional<Transform> as_transform(const glm::dmat4& m) {
  constexpr double kTolerance = 2e-6;
  Transform out;
  if (!decompose(glm::mat4(m), out)) return std::nullopt;
  const glm::dmat4 got(out.matrix());
  for (int axis = 0; axis < 3; ++axis) {
    const double length = glm::length(glm::dvec3(m[axis]));
    if (!(glm::length(glm::dvec3(got[axis] - m[axis])) <= kTolerance * length)) return std::nullopt;
  }
  out.translation_m = glm::vec3(m[3]);
  return out;
}

/// A frame stays when something on it, or on a frame above which it stands, needs it.
void drop_empty_frames(Scene& scene) {
  std::vector<std::uint8_t> keep(scene.frames.size(), 0);
  const auto need = [&](FrameId id) {
    if (id.valid()) keep[id.value] = 1;
  };
  for (const FrameId id : scene.objects.frame) need(id);
  for (const Camera& camera : scene.cameras) need(camera.frame);
  for (std::size_t f = scene.frames.size(); f-- > 0;) {
    if (keep[f] != 0) need(scene.frames[f].parent);
  }
  const std::vector<std::uint32_t> moved = keep_only(scene.frames, keep);
  for (Frame& frame : scene.frames) renumber(frame.parent, moved);
  for (FrameId& id : scene.objects.frame) renumber(id, moved);
  for (Camera& camera : scene.cameras) renumber(camera.frame, moved);
  std::erase_if(scene.frame_tracks, [&](const FrameTrack& t) { return moved[t.frame.value] == kNone; });
  for (FrameTrack& t : scene.frame_tracks) renumber(t.frame, moved);
}

}  // namespace

void leave_still_frames(Scene& scene, OptimizeReport& report) {
  const std::vector<Anchor> anchors = find_anchors(scene);
  Objects& objects = scene.objects;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (!objects.frame[i].valid()) continue;
    const Anchor& anchor = anchors[objects.frame[i].value];
    if (anchor.frame == objects.frame[i]) continue;
    const glm::dmat4 m = anchor.anchor_from_frame * glm::dmat4(objects.frame_from_object[i].matrix());
    const std::optional<Transform> transform = as_transform(m);
    if (!transform) continue;
    objects.frame[i] = anchor.frame;
    objects.frame_from_object[i] = *transform;
    ++report.unframed_objects;
  }
  drop_empty_frames(scene);
}

}  // namespace scenegen::optimizing
