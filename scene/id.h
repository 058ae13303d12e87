// Typed indices into the flat arrays of a scene: an ObjectId cannot be passed where a MeshId is wanted.
#pragma once

#include <compare>
#include <cstdint>
#include <limits>

namespace scenegen {

/// Index into one of the arrays of `Scene`; default-constructed it is "none". 4 bytes, so a million cost 4
/// MB.
template <class Tag>
struct Id {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t value = kNone;

  constexpr Id() = default;
  constexpr explicit Id(std::uint64_t v) : value(static_cast<std::uint32_t>(v)) {}
  [[nodiscard]] constexpr bool valid() const { return value != kNone; }
  friend constexpr auto operator<=>(Id, Id) = default;
};

using ObjectId = Id<struct ObjectTag>;
using MeshId = Id<struct MeshTag>;
using GeometryId = Id<struct GeometryTag>;
using MaterialId = Id<struct MaterialTag>;
using TextureId = Id<struct TextureTag>;
using ImageId = Id<struct ImageTag>;
using FrameId = Id<struct FrameTag>;
using TrackId = Id<struct TrackTag>;
using CameraId = Id<struct CameraTag>;

}  // namespace scenegen
