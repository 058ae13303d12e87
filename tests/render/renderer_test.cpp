// Whole frames on whatever device there is, with the validation layer watching.
#include <cmath>
#include <cstring>

#include "render/image_file.h"
#include "tests/render/render_support.h"

using namespace scenegen;
using namespace scenegen::render;
using namespace scenegen::render::test;

namespace {

bool same_bits(const FrameResult& a, const FrameResult& b) {
  return a.rgba == b.rgba && a.ids == b.ids && a.depth.size() == b.depth.size() &&
         std::memcmp(a.depth.data(), b.depth.data(), a.depth.size() * sizeof(float)) == 0;
}

const std::vector<double> kTimes{0.0, 1.55, 3.0, 5.0, 0.75, 5.0};

}  // namespace

TEST_CASE("brute and inline give the same bits, at several times, from inside and outside") {
  const Scene scene = wall_scene();
  RendererOptions options = test_options();
  options.shadows = true;
  for (const glm::vec3 eye : {glm::vec3(4, 3, 8), glm::vec3(0.3F, 1.2F, 2.0F), glm::vec3(-1, 0.4F, 0.9F)}) {
    const View view = look(eye, {0.5F, 1, 0}, options.size);
    options.strategy = "brute";
    const auto brute = render::test::render(scene, kTimes, view, options);
    options.strategy = "inline";
    const auto culled = render::test::render(scene, kTimes, view, options);
    bool something_culled = false;
    for (std::size_t i = 0; i < kTimes.size(); ++i) {
      INFO("time " << kTimes[i]);
      CHECK(same_bits(brute[i], culled[i]));
      something_culled = something_culled || culled[i].report.drawn < brute[i].report.drawn;
    }
    CHECK(something_culled == (eye.z < 5.0F));
    CHECK(same_bits(culled[3], culled[5]));  // the same time again, after going back
    CHECK_FALSE(same_bits(culled[1], culled[3]));
  }
}
