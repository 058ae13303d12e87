// The parts of vk/ that are arithmetic: suballocation and the list of barriers.
#include <catch2/catch.hpp>
#include <map>

#include "render/vk/barrier.h"
#include "render/vk/free_list.h"
#include "scene/random.h"

using namespace scenegen;
using namespace scenegen::render::vkr;
using Stage = vk::PipelineStageFlagBits2;
using Access = vk::AccessFlagBits2;
using Layout = vk::ImageLayout;

TEST_CASE("suballocation: aligned, disjoint, inside; everything given back joins up again") {
  const Random random(11, "free list");
  FreeList list(1 << 20);
  std::map<std::uint64_t, std::uint64_t> taken;
  std::uint64_t refused = 0;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    if (random.below(4 * i, 5) < 3) {
      const std::uint64_t bytes = 1 + random.below(4 * i + 1, 20000);
      const std::uint64_t alignment = std::uint64_t{1} << random.below(4 * i + 2, 13);
      const auto offset = list.allocate(bytes, alignment);
      if (!offset) {
        ++refused;
        continue;
      }
      REQUIRE(*offset % alignment == 0);
      REQUIRE(*offset + bytes <= list.size());
      const auto next = taken.lower_bound(*offset);
      REQUIRE((next == taken.end() || *offset + bytes <= next->first));
      if (next != taken.begin()) REQUIRE(std::prev(next)->first + std::prev(next)->second <= *offset);
      taken[*offset] = bytes;
    } else if (!taken.empty()) {
      auto it = taken.lower_bound(random.below(4 * i + 3, list.size()));
      if (it == taken.end()) it = taken.begin();
      list.release(it->first, it->second);
      taken.erase(it);
    }
    std::uint64_t sum = 0;
    for (const auto& [offset, bytes] : taken) sum += bytes;
    REQUIRE(list.free_bytes() == list.size() - sum);
  }
  CHECK(refused > 0);
  for (const auto& [offset, bytes] : taken) list.release(offset, bytes);
  CHECK(list.unused());
  CHECK(list.piece_count() == 1);
  CHECK(list.allocate(list.size(), 1) == 0U);
  CHECK_FALSE(list.allocate(1, 1));
}

TEST_CASE("a write is made visible to what reads it") {
  Barriers barriers;
  barriers.buffer({}, Use::transfer_write, Use::shader_data);
  REQUIRE(barriers.buffers().size() == 1);
  const auto& b = barriers.buffers()[0];
  CHECK(b.srcStageMask == Stage::eAllTransfer);
  CHECK(b.srcAccessMask == Access::eTransferWrite);
  CHECK(static_cast<bool>(b.dstStageMask & Stage::eVertexInput));
  CHECK(static_cast<bool>(b.dstStageMask & Stage::eVertexShader));
  CHECK(static_cast<bool>(b.dstAccessMask & Access::eShaderStorageRead));
  CHECK(static_cast<bool>(b.dstAccessMask & Access::eUniformRead));
  CHECK(b.size == VK_WHOLE_SIZE);
}

TEST_CASE("a read before a write is ordered, and makes nothing visible") {
  Barriers barriers;
  barriers.buffer({}, Use::shader_data, Use::transfer_write);
  const auto& b = barriers.buffers()[0];
  CHECK(static_cast<bool>(b.srcStageMask & Stage::eVertexShader));
  CHECK(static_cast<bool>(b.srcStageMask & Stage::eFragmentShader));
  CHECK(b.srcAccessMask == vk::AccessFlags2{});
  CHECK(b.dstStageMask == Stage::eAllTransfer);
}

TEST_CASE("an image goes from its last use to the next, and remembers it") {
  Image image;
  image.aspect = vk::ImageAspectFlagBits::eDepth;
  Barriers barriers;
  barriers.discard(image, Use::depth_attachment);
  barriers.image(image, Use::sampled);
  barriers.discard(image, Use::depth_attachment);
  REQUIRE(barriers.images().size() == 3);
  const auto& fresh = barriers.images()[0];
  CHECK(fresh.srcStageMask == Stage::eNone);
  CHECK(fresh.oldLayout == Layout::eUndefined);
  CHECK(fresh.newLayout == Layout::eDepthStencilAttachmentOptimal);
  const auto& read = barriers.images()[1];
  CHECK(read.srcStageMask == (Stage::eEarlyFragmentTests | Stage::eLateFragmentTests));
  CHECK(static_cast<bool>(read.srcAccessMask & Access::eDepthStencilAttachmentWrite));
  CHECK(read.oldLayout == Layout::eDepthStencilAttachmentOptimal);
  CHECK(read.newLayout == Layout::eShaderReadOnlyOptimal);
  CHECK(read.dstStageMask == Stage::eFragmentShader);
  // The next frame must wait for this one's reads before it clears, though it keeps nothing.
  const auto& again = barriers.images()[2];
  CHECK(again.srcStageMask == Stage::eFragmentShader);
  CHECK(again.oldLayout == Layout::eUndefined);
  CHECK(static_cast<bool>(again.dstAccessMask & Access::eDepthStencilAttachmentWrite));
  CHECK(image.last_use == Use::depth_attachment);
}

TEST_CASE("results of queries reach the predicates, and the next frame's ones wait for them") {
  Barriers barriers;
  barriers.buffer({}, Use::transfer_write, Use::compute_read)
      .buffer({}, Use::predicate, Use::compute_write)
      .buffer({}, Use::compute_write, Use::predicate)
      .buffer({}, Use::predicate, Use::transfer_write)
      .buffer({}, Use::transfer_write, Use::predicate);
  const auto& b = barriers.buffers();
  REQUIRE(b.size() == 5);
  CHECK(b[0].srcAccessMask == Access::eTransferWrite);
  CHECK(b[0].dstStageMask == Stage::eComputeShader);
  CHECK(b[0].dstAccessMask == Access::eShaderStorageRead);
  CHECK(b[1].srcStageMask == Stage::eConditionalRenderingEXT);
  CHECK(b[1].srcAccessMask == vk::AccessFlags2{});
  CHECK(b[1].dstAccessMask == Access::eShaderStorageWrite);
  CHECK(b[2].srcAccessMask == Access::eShaderStorageWrite);
  CHECK(b[2].dstStageMask == Stage::eConditionalRenderingEXT);
  CHECK(b[2].dstAccessMask == Access::eConditionalRenderingReadEXT);
  CHECK(b[3].srcStageMask == Stage::eConditionalRenderingEXT);
  CHECK(b[3].dstAccessMask == Access::eTransferWrite);
  CHECK(b[4].srcAccessMask == Access::eTransferWrite);
  CHECK(b[4].dstStageMask == Stage::eConditionalRenderingEXT);
}

TEST_CASE("what the first part of a pass drew is there for the second") {
  Image image;
  image.aspect = vk::ImageAspectFlagBits::eDepth;
  Barriers barriers;
  barriers.discard(image, Use::depth_attachment).image(image, Use::depth_attachment);
  const auto& kept = barriers.images()[1];
  CHECK(kept.oldLayout == Layout::eDepthStencilAttachmentOptimal);
  CHECK(static_cast<bool>(kept.srcAccessMask & Access::eDepthStencilAttachmentWrite));
  CHECK(static_cast<bool>(kept.dstAccessMask & Access::eDepthStencilAttachmentRead));
}

TEST_CASE("readback reaches the processor") {
  Barriers barriers;
  barriers.buffer({}, Use::transfer_write, Use::host_read);
  CHECK(barriers.buffers()[0].dstStageMask == Stage::eHost);
  CHECK(barriers.buffers()[0].dstAccessMask == Access::eHostRead);
}

TEST_CASE("--barriers full adds a full barrier, and only then") {
  CHECK(Barriers(false).memory().empty());
  const auto all = Barriers(true).memory();
  REQUIRE(all.size() == 1);
  CHECK(all[0].srcStageMask == Stage::eAllCommands);
  CHECK(all[0].dstStageMask == Stage::eAllCommands);
  CHECK(all[0].srcAccessMask == (Access::eMemoryRead | Access::eMemoryWrite));
  CHECK(all[0].dstAccessMask == (Access::eMemoryRead | Access::eMemoryWrite));
}
