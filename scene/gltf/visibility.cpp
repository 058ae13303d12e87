#include "scene/gltf/visibility.h"

#include <algorithm>
#include <cstring>

#include "scene/random.h"

namespace scenegen::gltf::reading {

VisibilityTable::VisibilityTable(std::uint64_t most_keys) : entries_(1), keys_left_(most_keys) {}

std::span<const float> VisibilityTable::times_s(std::uint32_t id) const {
  return std::span(times_s_).subspan(entries_[id].first, entries_[id].count);
}

std::span<const std::uint8_t> VisibilityTable::shown(std::uint32_t id) const {
  return std::span(shown_).subspan(entries_[id].first, entries_[id].count);
}

std::uint32_t VisibilityTable::intern(std::span<const float> times, std::span<const std::uint8_t> values) {
  if (std::find(values.begin(), values.end(), std::uint8_t{0}) == values.end()) return kAlways;
  std::uint64_t hash = mix64(times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    std::uint32_t bits = 0;
    const float time = times[i] + 0.0F;  // -0 is 0
    std::memcpy(&bits, &time, 4);
    hash = mix64(hash ^ ((std::uint64_t{bits} << 1) | values[i]));
  }
  const auto [found, fresh] = by_hash_.emplace(hash, kAlways);
  for (std::uint32_t id = found->second; id != kAlways; id = entries_[id].next) {
    if (std::ranges::equal(times_s(id), times) && std::ranges::equal(shown(id), values)) return id;
  }
  const auto id = static_cast<std::uint32_t>(entries_.size());
  entries_.push_back({times_s_.size(), times.size(), found->second});
  times_s_.insert(times_s_.end(), times.begin(), times.end());
  shown_.insert(shown_.end(), values.begin(), values.end());
  found->second = id;
  return id;
}

std::uint32_t VisibilityTable::never() {
  constexpr float kStart[] = {0.0F};
  constexpr std::uint8_t kHidden[] = {0};
  return intern(kStart, kHidden);
}

std::uint32_t VisibilityTable::both(std::uint32_t a, std::uint32_t b, const Place& at) {
  if (a == b || b == kAlways) return a;
  if (a == kAlways) return b;
  const std::uint64_t pair = (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
  const auto [found, fresh] = by_pair_.emplace(pair, kAlways);
  if (!fresh) return found->second;
  const std::uint64_t work = entries_[a].count + entries_[b].count;
  if (work > keys_left_)
    reject(at, "visibility tracks of nested nodes unfold to more keys than the file has bytes");
  keys_left_ -= work;
  std::vector<float> times;
  std::vector<std::uint8_t> values;
  const std::span<const float> time[2] = {times_s(a), times_s(b)};
  const std::span<const std::uint8_t> value[2] = {shown(a), shown(b)};
  std::size_t next[2] = {0, 0};
  while (next[0] < time[0].size() || next[1] < time[1].size()) {
    const bool first =
        next[1] == time[1].size() || (next[0] < time[0].size() && time[0][next[0]] <= time[1][next[1]]);
    const float now = first ? time[0][next[0]] : time[1][next[1]];
    bool visible = true;
    for (int k = 0; k < 2; ++k) {
      if (next[k] < time[k].size() && time[k][next[k]] == now) ++next[k];
      visible = visible && value[k][next[k] == 0 ? 0 : next[k] - 1] != 0;
    }
    const auto shown_now = static_cast<std::uint8_t>(visible);
    if (!values.empty() && values.back() == shown_now) continue;
    times.push_back(now);
    values.push_back(shown_now);
  }
  const std::uint32_t id = intern(times, values);
  by_pair_[pair] = id;
  return id;
}

}  // namespace scenegen::gltf::reading
