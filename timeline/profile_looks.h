// Material timelines: highlights while something happens to an object. For profile_apply.cpp.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "timeline/profile_plan.h"
#include "timeline/profiles.h"
#include "timeline/track_table.h"

namespace scenegen::timeline {

class ProfileLooks {
 public:
  ProfileLooks(Scene& scene, const ProfileOptions& options);

  /// Whether the object's look may be changed; the error's `where` is empty.
  [[nodiscard]] Result<void> check(ObjectId object) const;
  /// From here on the scene changes.
  void begin(TrackSharing& tracks);
  /// `timeline`: a number that is the same for the same keys.
  void give(ObjectId object, std::uint32_t timeline, std::span<const LookKey> keys);
  [[nodiscard]] ProfileResult result() &&;

 private:
  [[nodiscard]] const glm::vec4& color(std::uint8_t look) const { return options_.highlight[look]; }
  Material highlight_material(MaterialId own, std::uint8_t look) const;
  MaterialId shared_material(Material material, std::uint8_t look);
  MeshId swapped_mesh(MeshId own, std::uint8_t look);
  TrackId mesh_track(MeshId own, std::span<const LookKey> keys);
  MaterialId animated_material(MaterialId own, std::span<const LookKey> keys);
  MeshId animated_mesh(MeshId own, std::span<const LookKey> keys);

  Scene& scene_;
  const ProfileOptions& options_;
  TrackSharing* tracks_ = nullptr;
  ProfileResult result_;
  std::vector<bool> has_mesh_track_;                                        // by object, before
  std::vector<TrackId> emissive_track_;                                     // by material, before
  std::vector<bool> has_color_track_;                                       // by material, before
  std::vector<std::pair<std::uint8_t, MaterialId>> highlights_;             // swap: (look, material)
  std::map<std::pair<MeshId, std::uint8_t>, MeshId> swapped_;               // (own mesh, look)
  std::unordered_map<std::uint64_t, std::uint32_t> given_;                  // (timeline, mesh): track or mesh
  std::map<std::pair<MaterialId, TrackId>, MaterialId> animated_;           // pointer
  std::map<std::pair<MeshId, std::vector<MaterialId>>, MeshId> recolored_;  // pointer
};

}  // namespace scenegen::timeline
