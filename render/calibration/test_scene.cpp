#include "render/calibration/test_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <numeric>
#include <optional>

#include "render/image_file.h"
#include "scene/random.h"

namespace scenegen::render::calibration {
namespace {

constexpr float kFovRad = 0.8F;
constexpr float kDistanceM = 100.0F;           // where small objects stand
constexpr float kWallM = 50.0F;                // where quads stand, and nearer
constexpr float kSpeckPx = 0.05F;              // sides of what has no fragments
constexpr std::uint32_t kBoxesPerGroup = 125;  // of neighbours, below

/// 36 vertices without indices, as the papers count a box. With tangents, as what has a normal map mostly is:
/// they cost vertices (H200: textured boxes of test set 23 take 32 ns, not 25).
Geometry box_geometry() {
  Geometry g;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0F, 1.0F}) {
      glm::vec3 n(0.0F);
      n[axis] = side;
      glm::vec3 u(0.0F);
      u[(axis + 1) % 3] = side;
      const glm::vec3 v = glm::cross(n, u);
      constexpr std::array<glm::vec2, 6> kCorners{{{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}}};
      for (const glm::vec2 c : kCorners) {
        g.positions_m.push_back(0.5F * (n + c.x * u + c.y * v));
        g.normals.push_back(n);
        g.tangents.emplace_back(u, 1.0F);
        g.texcoords[0].push_back(0.5F + 0.5F * glm::vec2(c.x, -c.y));
      }
    }
  }
  return g;
}

/// Unit sphere of `slices` x `stacks`, 6 slices (stacks - 1) vertices drawn through indices: what is shared
/// is shaded once, as in most files.
Geometry sphere_geometry(std::uint32_t slices, std::uint32_t stacks) {
  Geometry g;
  for (std::uint32_t j = 0; j <= stacks; ++j) {
    for (std::uint32_t i = 0; i <= slices; ++i) {
      const float a = glm::two_pi<float>() * static_cast<float>(i) / static_cast<float>(slices);
      const float b = glm::pi<float>() * static_cast<float>(j) / static_cast<float>(stacks);
      const glm::vec3 n(std::sin(b) * std::cos(a), std::cos(b), std::sin(b) * std::sin(a));
      g.positions_m.push_back(0.5F * n);
      g.normals.push_back(n);
      g.tangents.emplace_back(-std::sin(a), 0.0F, std::cos(a), 1.0F);
      g.texcoords[0].emplace_back(a, b);
    }
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return j * (slices + 1) + i; };
  for (std::uint32_t j = 0; j < stacks; ++j) {
    for (std::uint32_t i = 0; i < slices; ++i) {
      if (j + 1 < stacks) g.indices.insert(g.indices.end(), {at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      if (j > 0) g.indices.insert(g.indices.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1)});
    }
  }
  return g;
}

/// Every triangle has vertices of its own, which differ a little (else loading would share them).
Geometry without_indices(const Geometry& from) {
  Geometry g;
  for (const std::uint32_t i : from.indices) {
    g.positions_m.push_back(from.positions_m[i]);
    g.normals.push_back(from.normals[i]);
    g.tangents.push_back(from.tangents[i]);
    g.texcoords[0].emplace_back(static_cast<float>(g.texcoords[0].size()) * 1e-6F, 0.0F);
  }
  return g;
}

Geometry quad_geometry(bool lone_triangle) {
  Geometry g;
  constexpr std::array<glm::vec2, 6> kCorners{{{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}}};
  for (std::size_t i = 0; i < (lone_triangle ? 3U : 6U); ++i) {
    g.positions_m.emplace_back(0.5F * kCorners[i], 0.0F);
    g.normals.emplace_back(0, 0, 1);
    g.tangents.emplace_back(1, 0, 0, 1);
    // Magnified, as what is near and fills pictures mostly is.
    g.texcoords[0].push_back(0.25F * kCorners[i]);
  }
  return g;
}

/// Some hills and valleys, as a normal map.
Image bumps() {
  constexpr std::uint32_t kSide = 256;
  std::vector<std::uint8_t> rgba;
  rgba.reserve(std::size_t{4} * kSide * kSide);
  for (std::uint32_t y = 0; y < kSide; ++y) {
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const auto tilt = [](std::uint32_t k) { return static_cast<std::uint8_t>(112 + (k % 16) * 2); };
      rgba.insert(rgba.end(), {tilt(x), tilt(y), 245, 255});
    }
  }
  const std::string png = encode_picture(PictureFormat::png, {kSide, kSide}, rgba);
  return {"bumps", "image/png", {png.begin(), png.end()}};
}

Image checker() {
  constexpr std::uint32_t kSide = 256;
  std::vector<std::uint8_t> rgba;
  rgba.reserve(std::size_t{4} * kSide * kSide);
  for (std::uint32_t y = 0; y < kSide; ++y) {
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const auto level =
          static_cast<std::uint8_t>(((x / 16 + y / 16) % 2 != 0 ? 200 : 90) + (x * 7 + y * 3) % 32);
      rgba.insert(rgba.end(), {level, static_cast<std::uint8_t>(level / 2), 60, 255});
    }
  }
  const std::string png = encode_picture(PictureFormat::png, {kSide, kSide}, rgba);
  return {"checker", "image/png", {png.begin(), png.end()}};
}

class Builder {
 public:
  Builder(const TestSizes& sizes, glm::uvec2 size, TestContents contents)
      : sizes_(sizes), size_(size), all_(contents == TestContents::all) {
    Lens lens;
    lens.yfov_rad = kFovRad;
    out_.view = make_view(glm::mat4(1.0F), lens, static_cast<float>(size.x) / static_cast<float>(size.y));
    Scene& s = out_.scene;
    s.images.push_back(checker());
    s.images.push_back(bumps());
    for (const std::uint32_t image : {0U, 1U}) {
      Texture texture;
      texture.image = ImageId(image);
      texture.sampler = {9729, 9987};  // linear, through all levels, as most files have it
      s.textures.push_back(texture);
    }
    Material plain;
    plain.base_color = {0.6F, 0.4F, 0.3F, 1.0F};
    plain.metallic = 0.0F;
    plain.roughness = 0.8F;
    s.materials.push_back(plain);
    plain.base_color_texture.texture = TextureId(0);
    plain.normal_texture.texture = TextureId(1);
    s.materials.push_back(plain);
    // Geometries in order of drawing: walls and layers before what they hide.
    quads_ = add_geometry(quad_geometry(false));
    boxes_ = add_geometry(box_geometry());
  }

  TestScene build() {
    begin({Trial::empty});
    add_boxes();
    add_meshes();
    add_layers();
    add_piles();
    finish();
    return std::move(out_);
  }

 private:
  struct Pair {
    MeshId plain, textured;
  };
  struct Group {  // objects with one visibility
    std::uint32_t first = 0, end = 0;
    std::vector<std::uint32_t> steps;
  };

  Pair add_geometry(Geometry geometry) {
    Scene& s = out_.scene;
    s.geometries.push_back(std::move(geometry));
    for (const std::uint32_t material : {0U, 1U}) {
      Mesh mesh;
      mesh.name = "mesh " + std::to_string(s.meshes.size());
      mesh.primitives.push_back({GeometryId(s.geometries.size() - 1), MaterialId(material)});
      s.meshes.push_back(std::move(mesh));
    }
    return {MeshId(s.meshes.size() - 2), MeshId(s.meshes.size() - 1)};
  }

  /// Height of the picture in metres at a distance.
  [[nodiscard]] static float height_m(float distance_m) {
    return 2.0F * distance_m * std::tan(0.5F * kFovRad);
  }

  std::uint32_t begin(Step step) {
    step.time_s = static_cast<double>(out_.steps.size());
    out_.steps.push_back(step);
    return static_cast<std::uint32_t>(out_.steps.size() - 1);
  }
  void object(MeshId mesh, const glm::vec3& at_m, const glm::vec3& scale) {
    Transform t;
    t.translation_m = at_m;
    t.scale = scale;
    out_.scene.objects.add("o" + std::to_string(out_.scene.objects.size()), mesh, t);
  }
  template <class Body>
  std::size_t group(const Body& add_objects, bool wanted = true) {
    Group g;
    g.first = static_cast<std::uint32_t>(out_.scene.objects.size());
    if (wanted) add_objects();
    g.end = static_cast<std::uint32_t>(out_.scene.objects.size());
    groups_.push_back(std::move(g));
    return groups_.size() - 1;
  }
  void show(std::size_t group, std::uint32_t step) { groups_[group].steps.push_back(step); }
  /// A step of other things than boxes.
  template <class Body>
  void other(const Step& step, const Body& add_objects) {
    show(group(add_objects, all_), begin(step));
  }

  /// The i-th of `count` places of a grid over most of the picture; objects of `side_m`.
  [[nodiscard]] glm::vec3 place(std::uint32_t i, std::uint32_t count, float distance_m) const {
    const float aspect = static_cast<float>(size_.x) / static_cast<float>(size_.y);
    const auto columns =
        static_cast<std::uint32_t>(std::max(1.0F, std::ceil(std::sqrt(static_cast<float>(count) * aspect))));
    const std::uint32_t rows = (count + columns - 1) / columns;
    const std::uint32_t row = i / columns;
    const float x = (static_cast<float>(i % columns) + 0.5F) / static_cast<float>(columns) - 0.5F;
    const float y = (static_cast<float>(row) + 0.5F) / static_cast<float>(rows) - 0.5F;
    const float h = 0.9F * height_m(distance_m);
    return {x * h * aspect, y * h, -distance_m};
  }
  [[nodiscard]] float pixel_m() const { return height_m(kDistanceM) / static_cast<float>(size_.y); }

  void small(MeshId mesh, std::uint32_t from, std::uint32_t to, std::uint32_t of, float shift = 0.0F,
             float side_px = 0.7F) {
    for (std::uint32_t i = from; i < to; ++i)
      object(mesh, place(i, of, kDistanceM) + glm::vec3(i % 2 != 0 ? shift : 0.0F, 0, 0),
             glm::vec3(side_px * pixel_m()));
  }
  /// A quad in front of the picture's middle, over `share` of it (all of it with some to spare).
  void quad(MeshId mesh, double share, float distance_m) {
    const float h = height_m(distance_m) * (share >= 1.0 ? 1.1F : std::sqrt(static_cast<float>(share)));
    const float aspect = static_cast<float>(size_.x) / static_cast<float>(size_.y);
    object(mesh, {0, 0, -distance_m}, {h * aspect, h, 1.0F});
  }

  void add_boxes() {
    const std::uint32_t most = sizes_.boxes.back();
    const std::size_t wall = group([&] { quad(quads_.plain, 1.0, kWallM); });
    std::vector<std::size_t> nested;
    std::uint32_t before = 0;
    for (const std::uint32_t n : sizes_.boxes) {
      std::uint32_t taken = 0;  // away later
      const auto add = [&](bool thinned) {
        for (std::uint32_t i = before; i < n; ++i) {
          if ((n == most && i % kThinned == 0) != thinned) continue;
          small(boxes_.plain, i, i + 1, most);
          taken += thinned ? 1 : 0;
        }
      };
      nested.push_back(group([&] { add(false); }));
      const std::vector<std::size_t> kept = nested;
      if (n == most) nested.push_back(group([&] { add(true); }));
      before = n;
      const std::uint32_t seen = begin({Trial::boxes, n, 36});
      if (n == most) {  // next in time: nothing else changes
        const std::uint32_t thinned = begin({Trial::thinned_boxes, n - taken, 36});
        out_.steps[thinned].from = seen;
        for (const std::size_t g : kept) show(g, thinned);
        const std::uint32_t refilled = begin({Trial::refilled_boxes, n, 36});
        out_.steps[refilled].from = thinned;
        for (const std::size_t g : nested) show(g, refilled);
      }
      const std::uint32_t behind = begin({Trial::hidden_boxes, n, 36, 1, 1.0});
      show(wall, behind);
      for (const std::size_t g : nested) show(g, seen), show(g, behind);
    }
    const std::uint32_t n = sizes_.boxes[sizes_.boxes.size() / 2];
    // What vertices cost alone: at 0.7 pixels fragments are a quarter of it (H200: 25 ns a box, where test
    // sets drawn so small that there are hardly any take 18).
    for (const std::uint32_t specks : sizes_.specks)
      other({Trial::speck_boxes, specks, 36},
            [&] { small(boxes_.plain, 0, specks, specks, 0.0F, kSpeckPx); });
    other({Trial::textured_boxes, n, 36}, [&] { small(boxes_.textured, 0, n, n, 0.0F, kSpeckPx); });
    // Every other one is moved out of the picture, beyond its side.
    const float aside =
        2.0F * height_m(kDistanceM) * static_cast<float>(size_.x) / static_cast<float>(size_.y);
    show(group([&] { small(boxes_.plain, 0, most, most, aside); }), begin({Trial::halved_boxes, most, 36}));
  }

  void add_meshes() {
    for (const std::uint32_t vertices : sizes_.vertices) {
      Geometry geometry = quad_geometry(true);
      std::uint32_t each = 3;
      if (vertices > 3) {
        const auto stacks = static_cast<std::uint32_t>(std::max(2.0, std::sqrt(vertices / 12.0)));
        const std::uint32_t slices = std::max(3U, vertices / (6 * (stacks - 1)));
        geometry = sphere_geometry(slices, stacks);
        each = 6 * slices * (stacks - 1);
      }
      // Each of the triangles that face the viewer covers about a quarter of a fragment.
      const float quarter_px = 0.5F * std::sqrt(static_cast<float>(each) / 6.0F);
      const auto share = [&](float side_px) {  // of one
        return vertices <= 3
                   ? 0.0
                   : glm::quarter_pi<double>() * side_px * side_px / (static_cast<double>(size_.x) * size_.y);
      };
      constexpr double kMostShare = 0.5;
      if (4.0 * share(quarter_px) > kMostShare) continue;  // too small a picture for these
      std::uint32_t n = std::clamp(sizes_.mesh_vertices / each, 4U, sizes_.boxes[sizes_.boxes.size() / 2]);
      if (n * share(quarter_px) > kMostShare) n = static_cast<std::uint32_t>(kMostShare / share(quarter_px));
      const auto sized = [&](Trial trial, MeshId mesh, std::uint32_t count, float side_px) {
        other({trial, count, each, 1, count * share(side_px)},
              [&] { small(mesh, 0, count, count, 0.0F, side_px); });
      };
      const auto many = [&](Trial trial, MeshId mesh) {
        sized(trial, mesh, n, vertices <= 3 ? kSpeckPx : quarter_px);
      };
      const Pair unshared =
          all_ ? add_geometry(vertices <= 3 ? geometry : without_indices(geometry)) : boxes_;
      many(Trial::unshared_meshes, unshared.plain);
      if (vertices <= 3 || vertices != sizes_.vertices.back()) continue;
      const MeshId shared = all_ ? add_geometry(std::move(geometry)).plain : boxes_.plain;
      many(Trial::meshes, shared);
      sized(Trial::speck_meshes, shared, 4 * n, kSpeckPx / 0.5F * quarter_px);
      many(Trial::textured_meshes, unshared.textured);
    }
  }

  void add_layers() {
    for (const double share : sizes_.shares) {
      layers(Trial::layers, quads_.plain, share);
      layers(Trial::textured_layers, quads_.textured, share);
    }
  }

  /// One layer, and several, each in front of the one before.
  void layers(Trial trial, MeshId mesh, double share) {
    const std::size_t first = group([&] { quad(mesh, share, kWallM - 20.0F); }, all_);
    show(first, begin({trial, 1, 6, 1, share}));
    const std::uint32_t more = begin({trial, sizes_.layers, 6, static_cast<double>(sizes_.layers), share});
    show(first, more);
    const auto in_front = [&] {
      for (std::uint32_t i = 1; i < sizes_.layers; ++i)
        quad(mesh, share, kWallM - 20.0F - static_cast<float>(i));
    };
    show(group(in_front, all_), more);
  }

  /// Boxes of one size: anywhere, what is in front before or after what is behind; and in groups of
  /// neighbours in the picture (at any depth), as towns and chunks have them, one group after the other in
  /// any order. A GPU deals the picture out to its units, so draws in a row that fall on one place keep few
  /// of them busy (H200, 1920x1080, 64000 boxes two layers deep, groups of 128: 75 ns each instead of 48).
  void add_piles() {
    for (std::size_t i = sizes_.boxes.size() - 2; i < sizes_.boxes.size(); ++i) {
      for (const double layers : sizes_.piles) pile(Trial::piles, boxes_.plain, sizes_.boxes[i], layers, 1);
    }
    for (const double layers : sizes_.textured_piles)
      pile(Trial::textured_piles, boxes_.textured, sizes_.boxes.back(), layers, 1);
    for (std::size_t i = sizes_.boxes.size() - 2; i < sizes_.boxes.size(); ++i) {
      for (const double layers : sizes_.grouped_piles)
        pile(Trial::piles, boxes_.plain, sizes_.boxes[i], layers, kBoxesPerGroup);
    }
    for (const double layers : sizes_.grouped_piles)
      pile(Trial::textured_piles, boxes_.textured, sizes_.boxes.back(), layers, kBoxesPerGroup);
  }

  /// `together` of them are neighbours.
  void pile(Trial trial, MeshId mesh, std::uint32_t n, double layers, std::uint32_t together) {
    const float aspect = static_cast<float>(size_.x) / static_cast<float>(size_.y);
    const float h = 0.8F * height_m(kDistanceM);
    const float side = std::sqrt(static_cast<float>(layers) * h * h * aspect / static_cast<float>(n));
    other({trial, n, 36, layers, 0.64}, [&] {
      // Places of groups: a grid of about as many columns as rows.
      const std::uint32_t groups = together > 1 ? std::max(1U, n / together) : 1;
      std::uint32_t columns = 1;
      while (columns * columns < groups) ++columns;
      const std::uint32_t rows = (groups + columns - 1) / columns;
      const std::vector<std::uint32_t> order = shuffled(groups);
      for (std::uint32_t k = 0; k < n; ++k) {
        const std::uint32_t place = order[static_cast<std::uint64_t>(k) * groups / n];
        const auto within = [&](std::uint32_t at, std::uint32_t of) {
          return (static_cast<float>(at) + anywhere_.unit(number_++)) / static_cast<float>(of) - 0.5F;
        };
        const float x = within(place % columns, columns), y = within(place / columns, rows);
        const float z = within(0, 1);
        object(mesh, {x * h * aspect, y * h, -kDistanceM + 0.4F * kDistanceM * z}, glm::vec3(side));
      }
    });
  }

  [[nodiscard]] std::vector<std::uint32_t> shuffled(std::uint32_t n) {
    std::vector<std::uint32_t> order(n);
    std::iota(order.begin(), order.end(), 0U);
    for (std::uint32_t i = 0; i + 1 < n; ++i)
      std::swap(order[i], order[i + anywhere_.below(number_++, n - i)]);
    return order;
  }

  void finish() {
    Scene& s = out_.scene;
    const auto steps = static_cast<std::uint32_t>(out_.steps.size());
    for (const Group& g : groups_) {
      std::vector<float> times{0.0F};
      std::vector<float> values{0.0F};
      std::vector<bool> shown(steps + 1, false);
      for (const std::uint32_t step : g.steps) shown[step] = true;
      values[0] = shown[0] ? 1.0F : 0.0F;
      for (std::uint32_t i = 1; i <= steps; ++i) {
        if (shown[i] == shown[i - 1]) continue;
        times.push_back(static_cast<float>(i));
        values.push_back(shown[i] ? 1.0F : 0.0F);
      }
      const TrackId track = s.add_track(Property::visibility, Interpolation::step, times, values);
      for (std::uint32_t i = g.first; i < g.end; ++i) s.objects.visibility[i] = track;
    }
    s.duration_s = static_cast<float>(steps + 1);
  }

  const TestSizes& sizes_;
  glm::uvec2 size_;
  bool all_;
  TestScene out_;
  Pair quads_, boxes_;
  Random anywhere_{1, "piles"};
  std::uint64_t number_ = 0;  // of it that were taken
  std::vector<Group> groups_;
};

}  // namespace

TestSizes test_sizes(bool software_device, bool quick) {
  TestSizes s;
  if (software_device) {
    s.boxes =
        quick ? std::vector<std::uint32_t>{200, 1600} : std::vector<std::uint32_t>{100, 400, 1600, 6400};
    s.specks =
        quick ? std::vector<std::uint32_t>{1600, 12'800} : std::vector<std::uint32_t>{1600, 6400, 25'600};
    s.vertices =
        quick ? std::vector<std::uint32_t>{3, 3000} : std::vector<std::uint32_t>{3, 150, 600, 3000, 30'000};
    s.mesh_vertices = 600'000;
  } else {
    s.boxes = quick ? std::vector<std::uint32_t>{2000, 20'000}
                    : std::vector<std::uint32_t>{1000, 4000, 16'000, 64'000};
    s.specks = quick ? std::vector<std::uint32_t>{20'000} : std::vector<std::uint32_t>{16'000, 64'000};
    s.vertices = quick ? std::vector<std::uint32_t>{3, 3000}
                       : std::vector<std::uint32_t>{3, 150, 600, 3000, 12'000, 60'000, 120'000};
    s.mesh_vertices = 2'000'000;
  }
  s.piles = {0.5, 2, 8};
  if (software_device) {
    s.textured_piles = {2};
  } else {
    s.grouped_piles = {0.5, 2};
  }
  s.shares =
      quick ? std::vector<double>{1.0, 0.25} : std::vector<double>{1.0, 0.75, 0.5, 0.25, 0.125, 0.0625};
  return s;
}

TestScene make_test_scene(const TestSizes& sizes, glm::uvec2 size, TestContents contents) {
  return Builder(sizes, size, contents).build();
}

}  // namespace scenegen::render::calibration
