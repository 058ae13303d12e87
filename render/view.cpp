#include "render/view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace scenegen::render {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

glm::mat4 perspective(const Lens& lens, float aspect) {
  const float f = 1.0F / std::tan(0.5F * lens.yfov_rad);
  glm::mat4 m(0.0F);
  m[0][0] = f / aspect;
  m[1][1] = -f;
  if (lens.far_m > lens.near_m) {
    m[2][2] = lens.near_m / (lens.far_m - lens.near_m);
    m[3][2] = lens.near_m * lens.far_m / (lens.far_m - lens.near_m);
  } else {
    m[3][2] = lens.near_m;
  }
  m[2][3] = -1.0F;
  return m;
}

glm::mat4 orthographic(const Lens& lens) {
  glm::mat4 m(1.0F);
  m[0][0] = 1.0F / lens.xmag_m;
  m[1][1] = -1.0F / lens.ymag_m;
  m[2][2] = 1.0F / (lens.far_m - lens.near_m);
  m[3][2] = lens.far_m / (lens.far_m - lens.near_m);
  return m;
}

std::array<glm::vec3, 8> corners(const Box& b) {
  std::array<glm::vec3, 8> out;
  for (unsigned i = 0; i < 8; ++i) {
    out[i] = {(i & 1U) != 0 ? b.hi.x : b.lo.x, (i & 2U) != 0 ? b.hi.y : b.lo.y,
              (i & 4U) != 0 ? b.hi.z : b.lo.z};
  }
  return out;
}

/// Flat, under everything and as wide as everything: the ground, which would push the camera away.
bool is_ground(const Box& b, const Box& all) {
  const glm::vec3 size = b.size();
  const glm::vec3 whole = all.size();
  return size.x >= 0.8F * whole.x && size.z >= 0.8F * whole.z && size.y <= 0.25F * whole.y &&
         size.y <= 0.05F * std::max(size.x, size.z) && b.hi.y <= all.lo.y + 0.3F * whole.y;
}

/// The two supports that decide how near a camera may come along one picture axis.
struct Support {
  float upper = -kInfinity;  ///< max of x + t z
  float lower = kInfinity;   ///< min of x - t z
  void add(float x, float z, float t) {
    upper = std::max(upper, x + t * z);
    lower = std::min(lower, x - t * z);
  }
  [[nodiscard]] float distance(float t) const { return (upper - lower) / (2.0F * t); }
  [[nodiscard]] float centre() const { return 0.5F * (upper + lower); }
};

}  // namespace

float View::distance_m(float depth) const {
  if (lens.orthographic) return lens.far_m + depth * (lens.near_m - lens.far_m);
  if (lens.far_m > lens.near_m)
    return lens.near_m * lens.far_m / (lens.near_m + depth * (lens.far_m - lens.near_m));
  return depth > 0.0F ? lens.near_m / depth : kInfinity;
}

View make_view(const glm::mat4& world_from_camera, const Lens& lens, float aspect) {
  View view;
  view.lens = lens;
  view.aspect = aspect;
  view.world_from_camera = world_from_camera;
  view.camera_from_world = glm::inverse(world_from_camera);
  view.clip_from_camera = lens.orthographic ? orthographic(lens) : perspective(lens, aspect);
  view.clip_from_world = view.clip_from_camera * view.camera_from_world;
  return view;
}

glm::mat4 look_at(const glm::vec3& eye_m, const glm::vec3& target_m) {
  glm::vec3 back = eye_m - target_m;
  const float length = glm::length(back);
  back = length > 0.0F ? back / length : glm::vec3(0.0F, 0.0F, 1.0F);
  glm::vec3 right = glm::cross(glm::vec3(0.0F, 1.0F, 0.0F), back);
  if (glm::dot(right, right) < 1e-10F) right = glm::vec3(1.0F, 0.0F, 0.0F);
  right = glm::normalize(right);
  return {glm::vec4(right, 0.0F), glm::vec4(glm::cross(back, right), 0.0F), glm::vec4(back, 0.0F),
          glm::vec4(eye_m, 1.0F)};
}

View view_of_camera(const Camera& camera, const glm::mat4& world_from_camera, float aspect) {
  glm::vec3 back(world_from_camera[2]);
  glm::vec3 up(world_from_camera[1]);
  back = glm::dot(back, back) > 0.0F ? glm::normalize(back) : glm::vec3(0.0F, 0.0F, 1.0F);
  glm::vec3 right = glm::cross(up, back);
  right = glm::dot(right, right) > 0.0F ? glm::normalize(right) : glm::vec3(1.0F, 0.0F, 0.0F);
  up = glm::cross(back, right);
  const glm::mat4 rigid(glm::vec4(right, 0.0F), glm::vec4(up, 0.0F), glm::vec4(back, 0.0F),
                        glm::vec4(glm::vec3(world_from_camera[3]), 1.0F));
  Lens lens;
  lens.orthographic = camera.orthographic;
  lens.yfov_rad = std::clamp(camera.yfov_rad, 1e-3F, 3.1F);
  lens.near_m = camera.znear_m;
  lens.far_m = camera.zfar_m;
  if (camera.orthographic) {
    // The picture keeps the camera's height; its width follows the picture's shape.
    lens.ymag_m = std::abs(camera.ymag_m) > 0.0F ? std::abs(camera.ymag_m) : 1.0F;
    lens.xmag_m = lens.ymag_m * aspect;
    if (!(lens.far_m > lens.near_m)) lens.far_m = lens.near_m + 1000.0F;
  } else if (!(lens.near_m > 0.0F)) {
    lens.near_m = 0.01F;
  }
  return make_view(rigid, lens, aspect);
}

Box framed_bounds(std::span<const Box> object_bounds_m) {
  Box all;
  for (const Box& b : object_bounds_m) {
    if (!b.empty()) all.add(b);
  }
  Box framed;
  for (const Box& b : object_bounds_m) {
    if (!b.empty() && !is_ground(b, all)) framed.add(b);
  }
  return framed.empty() ? all : framed;
}

View frame_boxes(std::span<const Box> object_bounds_m, float aspect) {
  Box all;
  for (const Box& b : object_bounds_m) {
    if (!b.empty()) all.add(b);
  }
  const Box framed = framed_bounds(object_bounds_m);
  const glm::vec3 centre = framed.empty() ? glm::vec3(0.0F) : framed.centre();
  const glm::vec3 to_eye = glm::normalize(glm::vec3(0.62F, 0.46F, 1.0F));
  const glm::mat4 axes = look_at(centre + to_eye, centre);
  const glm::vec3 right(axes[0]);
  const glm::vec3 up(axes[1]);

  Lens lens;
  lens.yfov_rad = 0.55F;
  constexpr float kMargin = 0.93F;  // share of the picture's width and height that the scene may take
  const float ty = kMargin * std::tan(0.5F * lens.yfov_rad);
  const float tx = ty * aspect;
  Support horizontal;
  Support vertical;
  float nearest = -kInfinity;
  for (const Box& b : object_bounds_m) {
    if (b.empty() || is_ground(b, all)) continue;
    for (const glm::vec3& p : corners(b)) {
      const glm::vec3 q = p - centre;
      const float z = glm::dot(q, to_eye);
      horizontal.add(glm::dot(q, right), z, tx);
      vertical.add(glm::dot(q, up), z, ty);
      nearest = std::max(nearest, z);
    }
  }
  if (!std::isfinite(nearest)) {  // nothing but ground, or nothing at all
    for (const glm::vec3& p : corners(framed.empty() ? Box{glm::vec3(-1.0F), glm::vec3(1.0F)} : framed)) {
      const glm::vec3 q = p - centre;
      const float z = glm::dot(q, to_eye);
      horizontal.add(glm::dot(q, right), z, tx);
      vertical.add(glm::dot(q, up), z, ty);
      nearest = std::max(nearest, z);
    }
  }
  float distance = std::max(horizontal.distance(tx), vertical.distance(ty));
  distance = std::max(distance, nearest + 1e-3F);
  const glm::vec3 eye = centre + horizontal.centre() * right + vertical.centre() * up + distance * to_eye;
  // Reversed float depth does not care how near the near plane is; a thousandth of the distance clips
  // nothing.
  lens.near_m = std::max(1e-4F, std::min(0.001F * distance, 0.5F * (distance - nearest)));
  glm::mat4 world_from_camera = axes;
  world_from_camera[3] = glm::vec4(eye, 1.0F);
  return make_view(world_from_camera, lens, aspect);
}

Frustum frustum_of(const glm::mat4& m) {
  const glm::mat4 t = glm::transpose(m);  // t[i] is row i
  return {{t[3] + t[0], t[3] - t[0], t[3] + t[1], t[3] - t[1], t[3] - t[2], t[2]}};
}

bool intersects(const Frustum& frustum, const Box& box) {
  if (box.empty()) return false;
  const glm::vec3 c = box.centre();
  const glm::vec3 h = 0.5F * box.size();
  for (const glm::vec4& plane : frustum.planes) {
    const glm::vec3 n(plane);
    const float reach = glm::dot(glm::abs(n), h);
    const float slack = 1e-5F * (glm::dot(glm::abs(n), glm::abs(c)) + std::abs(plane.w) + reach);
    if (glm::dot(n, c) + plane.w + reach < -slack) return false;
  }
  return true;
}

namespace {

/// Room for `kMost` points, so that a frame allocates nothing.
template <std::size_t kMost>
struct Points {
  std::array<glm::vec3, kMost> points;
  std::size_t count = 0;

  void add(const glm::vec3& p) { points[count++] = p; }
  [[nodiscard]] const glm::vec3* begin() const { return points.data(); }
  [[nodiscard]] const glm::vec3* end() const { return points.data() + count; }
};
/// A face of a box cut by six planes, each of which adds at most one corner to what is convex.
using Polygon = Points<16>;

/// Sutherland-Hodgman against one plane n.p + d >= 0.
Polygon clipped(const Polygon& in, const glm::vec4& plane) {
  Polygon out;
  for (std::size_t i = 0; i < in.count; ++i) {
    const glm::vec3& a = in.points[i];
    const glm::vec3& b = in.points[(i + 1) % in.count];
    const float da = glm::dot(glm::vec3(plane), a) + plane.w;
    const float db = glm::dot(glm::vec3(plane), b) + plane.w;
    // Rounding may bend what was convex: then it has more corners, of which the last ones are left out.
    if (da >= 0.0F && out.count < 15) out.add(a);
    if ((da >= 0.0F) != (db >= 0.0F) && out.count < 16) out.add(a + (b - a) * (da / (da - db)));
  }
  return out;
}

/// Corner points of box and frustum cut with each other (the frustum's far end is bounded by the box).
Points<100> seen_points(const View& view, const Box& box) {
  const Frustum frustum = frustum_of(view.clip_from_world);
  const std::array<glm::vec3, 8> c = corners(box);
  constexpr unsigned kFaces[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                     {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};
  Points<100> out;
  for (const auto& face : kFaces) {
    Polygon polygon;
    for (const unsigned corner : face) polygon.add(c[corner]);
    for (const glm::vec4& plane : frustum.planes) {
      if (glm::dot(glm::vec3(plane), glm::vec3(plane)) > 0.0F) polygon = clipped(polygon, plane);
    }
    for (const glm::vec3& p : polygon) out.add(p);
  }
  const glm::vec3 eye = view.eye_m();
  if (glm::all(glm::greaterThanEqual(eye, box.lo)) && glm::all(glm::lessThanEqual(eye, box.hi))) out.add(eye);
  return out;
}

}  // namespace

glm::mat4 shadow_clip_from_world(const View& view, const Box& scene_m, const glm::vec3& to_sun,
                                 std::uint32_t side) {
  const Box scene = scene_m.empty() ? Box{glm::vec3(-1.0F), glm::vec3(1.0F)} : scene_m;
  const glm::mat4 axes = look_at(to_sun, glm::vec3(0.0F));
  const glm::mat3 light_from_world = glm::transpose(glm::mat3(axes));
  Box seen;
  for (const glm::vec3& p : seen_points(view, scene)) seen.add(light_from_world * p);
  Box casters;
  for (const glm::vec3& p : corners(scene)) casters.add(light_from_world * p);
  if (seen.empty()) seen = casters;
  // A square, its size rounded up and its corner to whole texels, so that edges stand still when the camera
  // pans.
  const float wanted = std::max({seen.size().x, seen.size().y, 1e-3F}) * 1.02F;
  const float extent = std::exp2(std::ceil(std::log2(wanted) * 8.0F) / 8.0F);
  const float texel = extent / static_cast<float>(side);
  const glm::vec3 middle = seen.centre();
  const float x0 = std::floor((middle.x - 0.5F * extent) / texel) * texel;
  const float y0 = std::floor((middle.y - 0.5F * extent) / texel) * texel;
  const float margin = 0.01F * std::max(casters.size().z, 1e-3F);
  const float near_z = casters.hi.z + margin;  // light looks along -z: larger z is nearer to the sun
  const float far_z = casters.lo.z - margin;
  glm::mat4 clip_from_light(1.0F);
  clip_from_light[0][0] = 2.0F / extent;
  clip_from_light[1][1] = -2.0F / extent;
  clip_from_light[2][2] = 1.0F / (near_z - far_z);
  clip_from_light[3] =
      glm::vec4(-1.0F - 2.0F * x0 / extent, 1.0F + 2.0F * y0 / extent, -far_z / (near_z - far_z), 1.0F);
  return clip_from_light * glm::mat4(light_from_world);
}

}  // namespace scenegen::render
