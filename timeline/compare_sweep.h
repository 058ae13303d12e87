// Comparing the state of two scenes over time.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "timeline/compare.h"
#include "timeline/compare_content.h"
#include "timeline/compare_report.h"
#include "timeline/player.h"

namespace scenegen::timeline {

/// Which object (or camera) of B goes with which of A; none: it has no partner. Empty: equal indices.
struct Matching {
  std::vector<std::uint32_t> b_of_a, a_of_b;

  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  [[nodiscard]] std::uint32_t to_b(std::uint32_t a) const { return b_of_a.empty() ? a : b_of_a[a]; }
  [[nodiscard]] std::uint32_t to_a(std::uint32_t b) const { return a_of_b.empty() ? b : a_of_b[b]; }
};

/// Plays both scenes side by side. At time 0 everything is looked at, then only what the players report to
/// have changed; a difference is reported when it begins, not again while it lasts.
class Sweep {
 public:
  Sweep(const Scene& a, const Scene& b, const Matching& objects, const Matching& cameras,
        const CompareOptions& options, Comparison& out);

  void run();

 private:
  enum Fault : std::uint8_t { visibility = 1, transform = 2, look = 4 };

  struct MaterialPair {
    MaterialId a, b;
    std::uint32_t object;  ///< of A: the first that showed it
    bool differs = false;
  };
  struct CameraPair {
    CameraId a, b;
    bool differs = false;
  };

  void start();
  void compare_looks_at_start();
  void step(double time_s);
  void look_at_changes(const ChangeSet& of_a, const ChangeSet& of_b);
  template <class Check>
  void for_each_changed(std::span<const ObjectId> of_a, std::span<const ObjectId> of_b, const Check& check);
  void check_visibility(std::uint32_t a, std::uint32_t b);
  void check_transform(std::uint32_t a, std::uint32_t b);
  void check_look(std::uint32_t a, std::uint32_t b);
  void check_colors(MaterialPair& pair);
  void check_camera(CameraPair& pair);
  /// True if a difference begins.
  bool begins(std::uint32_t a, Fault fault, bool differs);
  void add_material_pairs(MeshId a, MeshId b, std::uint32_t object);
  [[nodiscard]] bool same_place(const glm::mat4& a, const glm::mat4& b, float tolerance) const;
  [[nodiscard]] std::string place_difference(const glm::mat4& a, const glm::mat4& b, float tolerance) const;
  [[nodiscard]] std::string object_now(std::uint32_t a) const;
  [[nodiscard]] std::string now() const;

  const Scene& a_;
  const Scene& b_;
  const Matching& objects_;
  const Matching& cameras_;
  CompareOptions options_;
  Comparison& out_;
  DifferenceList differences_;
  ContentComparer content_;
  Player player_a_, player_b_;
  float size_m_ = 1.0F;
  double time_s_ = 0;
  bool just_before_ = false;          ///< time_s_ is the last before an event
  std::vector<std::uint8_t> faults_;  ///< by object of A
  std::map<std::pair<ContentFault::Kind, std::uint64_t>, std::size_t> seen_at_start_;  ///< reported then
  std::unordered_map<std::uint64_t, std::uint32_t> pair_index_;
  std::vector<MaterialPair> pairs_;
  std::vector<std::vector<std::uint32_t>> pairs_of_a_, pairs_of_b_;  ///< by material
  std::vector<CameraPair> moving_cameras_;
};

}  // namespace scenegen::timeline
