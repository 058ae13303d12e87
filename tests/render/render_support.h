// Small scenes and one-call rendering for the tests of the render room.
#pragma once

#include <catch2/catch.hpp>
#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>
#include <memory>
#include <string>
#include <vector>

#include "render/renderer.h"
#include "render/view.h"
#include "scene/scene.h"
#include "timeline/player.h"

namespace Catch {
template <>
struct StringMaker<glm::ivec3> {
  static std::string convert(const glm::ivec3& v) {
    return std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z);
  }
};
}  // namespace Catch

namespace scenegen::render::test {

/// Unit box round the origin, 24 vertices with normals and texture coordinates.
Geometry box_geometry();
/// Unit quad in the xy plane, facing +z; texture coordinate (0, 0) is its top left corner.
Geometry quad_geometry();

MeshId add_mesh(Scene& scene, Geometry geometry, const Material& material);
ObjectId add_object(Scene& scene, const std::string& name, MeshId mesh, const glm::vec3& at_m,
                    const glm::vec3& scale = glm::vec3(1.0F));
/// A material with a base colour, everything else plain.
Material plain(const glm::vec4& color, bool unlit = false);
/// Shows the object from `time_s` on.
void appear_at(Scene& scene, ObjectId id, float time_s);

/// A ground and a wall of boxes in three colours with gaps, glass in front, each box with its own time.
Scene wall_scene();

/// Looks from `eye_m` to `target_m`.
View look(const glm::vec3& eye_m, const glm::vec3& target_m, glm::uvec2 size, float yfov_rad = 0.8F);

/// Options for tests: validation on, 160x90, all outputs, no shadows.
RendererOptions test_options();

/// Renders `scene` at each time with one renderer and one player, pipelined as a program would; fails on any
/// error or validation message.
std::vector<FrameResult> render(const Scene& scene, const std::vector<double>& times_s, const View& view,
                                const RendererOptions& options);
FrameResult render_one(const Scene& scene, const View& view, const RendererOptions& options,
                       double time_s = 0);

/// Red, green, blue of a pixel.
glm::ivec3 pixel(const FrameResult& frame, glm::uvec2 size, std::uint32_t x, std::uint32_t y);

}  // namespace scenegen::render::test
