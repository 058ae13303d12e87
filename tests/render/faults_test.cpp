// Every Vulkan call that can fail does so once, and so does memory of the host: what comes of it is a slower
// way with a warning or one clear line, never a crash, a leak or a wrong call.
#include <dlfcn.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <set>

#include "render/vk/device.h"
#include "tests/render/render_support.h"
#include "tests/support/failing_new.h"
#include "tests/support/fault_layer.h"

using namespace scenegen;
using namespace scenegen::render;
using namespace scenegen::render::test;
using scenegen::test::FaultControl;

namespace {

/// Loads the layer for all instances that this program makes.
FaultControl& faults() {
  static FaultControl* const control = [] {
    const std::filesystem::path layer = SCENEGEN_FAULT_LAYER;
    ::setenv("VK_ADD_LAYER_PATH", layer.parent_path().c_str(), 1);
    ::setenv("VK_INSTANCE_LAYERS", "VK_LAYER_SCENEGEN_faults", 1);
    void* const library = ::dlopen(layer.c_str(), RTLD_NOW);
    if (library == nullptr) FAIL(::dlerror());
    scenegen::test::failing_new().exempt =
        reinterpret_cast<decltype(&scenegen_fault_inside)>(::dlsym(library, "scenegen_fault_inside"));
    const auto get =
        reinterpret_cast<decltype(&scenegen_fault_control)>(::dlsym(library, "scenegen_fault_control"));
    REQUIRE(get != nullptr);
    return get();
  }();
  return *control;
}

constexpr glm::uvec2 kSize{64, 36};

/// What came of a renderer that drew some frames.
struct Outcome {
  std::optional<Error> error;
  bool created = false;
  std::vector<std::string> warnings;
  std::vector<FrameResult> frames;
};

/// Allocations of the renderer may fail, if failing_new() is told so; those of the test do not.
template <class Body>
auto armed(const Body& body) {
  scenegen::test::FailingNew& state = scenegen::test::failing_new();
  state.armed = state.record || state.fail_at != 0;
  auto out = body();
  state.armed = false;
  return out;
}

/// Frames in which things appear, and a resize; with what may still be in flight when it ends.
Outcome play(const Scene& scene, const RendererOptions& options) {
  Outcome out;
  timeline::Player player(timeline::compile(scene));
  auto renderer = armed([&] { return Renderer::create(scene, player, options); });
  if (!renderer) {
    out.error = renderer.error();
    return out;
  }
  out.created = true;
  const auto failed = [&](const Result<void>& done) {
    if (!done) out.error = done.error();
    return !done;
  };
  const auto finish = [&] {
    FrameResult& frame = out.frames.emplace_back();
    return failed(armed([&] { return renderer->finish(frame); }));
  };
  const auto draw = [&] {
    for (int i = 0; i < 5; ++i) {
      const glm::uvec2 size = i < 3 ? kSize : glm::uvec2(48, 48);
      if (size != renderer->size()) {
        while (renderer->in_flight() > 0) {
          if (finish()) return;
        }
        if (failed(armed([&] { return renderer->resize(size); }))) return;
      }
      if (renderer->in_flight() == renderer->most_in_flight() && finish()) return;
      const timeline::ChangeSet& changes = player.seek(0.9 * i);
      const View view = look({0, 2, 9}, {0, 1, 0}, size);
      if (failed(armed([&] { return renderer->submit(changes, player, view); }))) return;
    }
    while (renderer->in_flight() > 0) {
      if (finish()) return;
    }
  };
  draw();
  out.warnings = renderer->warnings();
  if (out.error) {
    // It says so again, whatever it is asked for.
    const Result<void> again = renderer->resize(kSize);
    REQUIRE_FALSE(again);
    CHECK(again.error().str() == out.error->str());
    out.frames.clear();
  }
  return out;
}

struct Way {
  const char* strategy;
  NodeForm form = NodeForm::automatic;
};
constexpr std::array kWays{Way{"inline"},
                           Way{"inline-queries"},
                           Way{"octree", NodeForm::secondaries},
                           Way{"octree", NodeForm::indirect},
                           Way{"queries-all", NodeForm::secondaries},
                           Way{"queries-all", NodeForm::indirect},
                           Way{"hi-z"},
                           Way{"adaptive", NodeForm::secondaries}};

RendererOptions options_of(const Way& way) {
  RendererOptions o = test_options();
  o.size = kSize;
  o.shadows = way.strategy == kWays[0].strategy;  // the same for all
  o.strategy = way.strategy;
  o.how.node_form = way.form;
  o.how.objects_per_node = 10;
  o.how.change_every = 2;
  return o;
}

void check_line(const Error& error) {
  CHECK(error.kind == ErrorKind::no_device);
  CHECK(error.str().starts_with("device '"));
  CHECK(error.str().size() < 200);
  CHECK(error.str().find('\n') == std::string::npos);
}

/// Depths are those of `inline`, whatever way was taken in the end.
void check_pictures(const Outcome& outcome, const Outcome& wanted) {
  REQUIRE(outcome.frames.size() == wanted.frames.size());
  for (std::size_t i = 0; i < wanted.frames.size(); ++i) {
    INFO("frame " << i);
    const bool same = outcome.frames[i].depth == wanted.frames[i].depth;
    CHECK(same);
  }
}

}  // namespace

TEST_CASE("every Vulkan call that can fail for want of memory does, once at each place that makes it") {
  FaultControl& control = faults();
  const Scene scene = wall_scene();
  RendererOptions options = options_of(kWays[0]);
  auto shared = share_device(options.device);
  REQUIRE(shared);
  options.shared_device = *shared;
  const Outcome wanted = play(scene, options);
  REQUIRE_FALSE(wanted.error);

  std::set<std::uint64_t> known;
  std::size_t refused = 0, while_drawing = 0, slower = 0, harmless = 0;
  for (const Way& way : kWays) {
    RendererOptions now = options_of(way);
    now.shared_device = *shared;
    control.reset();
    control.record = true;
    const auto play_now = [&] { return play(scene, now); };
    Outcome outcome = play_now();
    control.record = false;
    REQUIRE_FALSE(outcome.error);
    const std::vector<scenegen::test::FaultSite> sites = control.sites;
    for (std::size_t n = 0; n < sites.size(); ++n) {
      if (!known.insert(sites[n].stack).second) continue;
      INFO(way.strategy << ", " << static_cast<int>(way.form) << ", call " << n << ": " << sites[n].call);
      control.reset(n + 1, n % 2 == 0 ? VK_ERROR_OUT_OF_DEVICE_MEMORY : VK_ERROR_OUT_OF_HOST_MEMORY);
      outcome = play_now();
      CHECK(std::string(control.failed) == sites[n].call);
      control.reset();
      if (outcome.error) {
        check_line(*outcome.error);
        ++(outcome.created ? while_drawing : refused);
      } else {
        if (way.strategy != std::string("inline-queries")) check_pictures(outcome, wanted);
        ++(outcome.warnings.empty() ? harmless : slower);
        // Without consequence are only answers and times that are not read.
        if (outcome.warnings.empty()) CHECK(std::string(sites[n].call) == "vkGetQueryPoolResults");
      }
    }
  }
  INFO(known.size() << " places: " << refused << " refused, " << while_drawing << " errors while drawing, "
                    << slower << " slower, " << harmless << " harmless");
  CHECK(refused > 80);
  CHECK(while_drawing > 30);
  CHECK(slower > 50);
  CHECK(harmless >= 2);
  // What is left of them all at the end of the device is a leak, which the validation layer names.
  options.shared_device.reset();
  vkr::Device& device = **shared;
  REQUIRE(shared->use_count() == 1);
  device.queue = vk::raii::Queue{nullptr};
  device.device = vk::raii::Device{nullptr};
  for (const std::string& message : device.take_messages()) FAIL_CHECK(message);
}

TEST_CASE("memory of the host that runs out in the renderer is a line, or a slower way is taken") {
  (void)faults();
  const Scene scene = wall_scene();
  scenegen::test::FailingNew& memory = scenegen::test::failing_new();
  RendererOptions options = options_of(kWays[0]);
  options.device.validation = false;  // what it allocates would fail too
  auto shared = share_device(options.device);
  REQUIRE(shared);
  std::set<std::uint64_t> known;
  std::size_t errors = 0, slower = 0, harmless = 0;
  for (const Way& way : kWays) {
    RendererOptions now = options_of(way);
    now.shared_device = *shared;
    now.shadows = false;
    const auto play_now = [&] { return play(scene, now); };
    const Outcome wanted = play_now();
    memory.reset();
    memory.record = true;
    (void)play_now();
    const std::vector<std::uint64_t> stacks = std::move(memory.stacks);
    for (std::size_t n = 0; n < stacks.size(); ++n) {
      if (!known.insert(stacks[n]).second) continue;
      INFO(way.strategy << ", " << static_cast<int>(way.form) << ", allocation " << n);
      memory.reset(n + 1);
      const Outcome outcome = play_now();
      CHECK(memory.failed);
      memory.reset();
      if (outcome.error) {
        ++errors;
        CHECK(outcome.error->kind == ErrorKind::no_device);
        CHECK(outcome.error->str().find("out of host memory") != std::string::npos);
      } else {
        CHECK(outcome.warnings.size() <= 1);
        ++(outcome.warnings.empty() ? harmless : slower);
        if (way.strategy != std::string("inline-queries")) check_pictures(outcome, wanted);
      }
    }
  }
  INFO(known.size() << " places: " << errors << " errors, " << slower << " slower, " << harmless
                    << " harmless");
  CHECK(errors > 100);
  CHECK(slower > 80);
  CHECK(harmless < 20);  // a free piece of memory that could not be noted down
}

TEST_CASE("a device that is lost is a line, whatever is being done, and nothing is done after that") {
  FaultControl& control = faults();
  const Scene scene = wall_scene();
  RendererOptions options = options_of({"queries-all"});
  auto shared = share_device(options.device);
  REQUIRE(shared);
  options.shared_device = *shared;
  for (const char* call : {"vkQueueSubmit", "vkWaitForFences"}) {
    std::size_t at_creation = 0, while_drawing = 0;
    for (std::uint64_t n = 1;; ++n) {
      INFO(call << " " << n);
      control.reset(n, VK_ERROR_DEVICE_LOST, call);
      const Outcome outcome = play(scene, options);
      const bool lost = control.lost;
      control.reset();
      if (!lost) break;
      REQUIRE(outcome.error);
      check_line(*outcome.error);
      CHECK(outcome.error->str().find("was lost") != std::string::npos);
      ++(outcome.created ? while_drawing : at_creation);
    }
    CHECK(at_creation > 5);
    CHECK(while_drawing == 5);  // frames
  }
  for (const std::string& message : (*shared)->take_messages()) FAIL_CHECK(message);
}
