#include "scene/gltf/names.h"

#include <simdjson.h>

#include <bit>
#include <cstring>

#include "scene/random.h"

namespace scenegen::gltf::reading {

std::uint64_t UniqueNames::hash_of(std::string_view text) {
  std::uint64_t hash = text.size();
  while (text.size() >= 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, text.data(), 8);
    hash = (hash ^ word) * 0x9e3779b97f4a7c15ULL;
    hash ^= hash >> 32;
    text.remove_prefix(8);
  }
  std::uint64_t rest = 0;
  std::memcpy(&rest, text.data(), text.size());
  return mix64(hash ^ rest);
}

UniqueNames::UniqueNames(NameTable& names, std::size_t count)
    : names_(names), slots_(std::bit_ceil(std::max<std::size_t>(16, count * 2))) {}

bool UniqueNames::insert(std::string_view name, std::uint64_t hash) {
  const std::uint64_t tag = hash & 0xFFFFFFFF00000000ULL;
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t i = hash & mask;; i = (i + 1) & mask) {
    if (slots_[i] == 0) {
      slots_[i] = tag | (names_.size() + 1);
      names_.push_back(name);
      return true;
    }
    const bool candidate = (slots_[i] & 0xFFFFFFFF00000000ULL) == tag;
    if (candidate && names_[(slots_[i] & 0xFFFFFFFFULL) - 1] == name) return false;
  }
}

void UniqueNames::add(std::string_view wanted, std::uint64_t hash) {
  const auto is_free = [&](std::string_view name) {
    return reserved_.empty() || reserved_.find(std::string(name)) == reserved_.end();
  };
  if (is_free(wanted) && insert(wanted, hash)) return;
  const std::string base(wanted);
  std::uint32_t& suffix = next_suffix_.emplace(base, 2).first->second;
  for (;;) {
    const std::string name = base + "_" + std::to_string(suffix++);
    if (is_free(name) && insert(name, hash_of(name))) return;
  }
}

namespace {

std::uint64_t leb128(Bytes bytes, std::size_t& at, const Place& place) {
  std::uint64_t out = 0;
  for (unsigned shift = 0; shift <= 28; shift += 7) {
    if (at >= bytes.size()) reject(place, "the table is truncated");
    const std::uint8_t byte = bytes[at++];
    out |= std::uint64_t{byte & 0x7FU} << shift;
    if ((byte & 0x80U) == 0) return out;
  }
  reject(place, "a number in the table is beyond 2^35");
}

}  // namespace

std::vector<std::uint32_t> decode_ids(const NameList& list, Data& data, const Place& at) {
  const Bytes bytes = data.view(list.view, at.key("bufferView"));
  if (list.count > bytes.size()) {
    reject(at.key("count"),
           std::to_string(list.count) + " indices in " + std::to_string(bytes.size()) + " bytes");
  }
  data.budget().take(list.count * sizeof(std::uint32_t), at);
  std::vector<std::uint32_t> out;
  out.reserve(list.count);
  std::size_t from = 0;
  std::int64_t id = 0;
  for (std::uint64_t i = 0; i < list.count; ++i) {
    const std::uint64_t code = leb128(bytes, from, at);
    id += static_cast<std::int64_t>(code >> 1) ^ -static_cast<std::int64_t>(code & 1);
    if (id < 0 || id >= std::int64_t{kNone}) reject(at, "index " + std::to_string(i) + " is out of range");
    out.push_back(static_cast<std::uint32_t>(id));
  }
  return out;
}

NameTable decode_names(const NameList& list, Data& data, const Place& at) {
  const Bytes bytes = data.view(list.view, at.key("bufferView"));
  if (list.count > bytes.size() / 2) {
    reject(at.key("count"),
           std::to_string(list.count) + " names in " + std::to_string(bytes.size()) + " bytes");
  }
  NameTable out;
  out.reserve(list.count, bytes.size());
  std::string name;
  std::size_t from = 0;
  for (std::uint64_t i = 0; i < list.count; ++i) {
    const std::uint64_t shared = leb128(bytes, from, at);
    const std::uint64_t rest = leb128(bytes, from, at);
    if (shared > name.size())
      reject(at, "name " + std::to_string(i) + " shares more than its predecessor has");
    if (rest > bytes.size() - from) reject(at, "the name table is truncated");
    name.resize(shared);
    name.append(reinterpret_cast<const char*>(bytes.data()) + from, rest);
    from += rest;
    data.budget().take(name.size(), at);
    out.push_back(name);
    if (name.empty() || !simdjson::validate_utf8(name))
      reject(at, "name " + std::to_string(i) + " is empty or not UTF-8");
  }
  return out;
}

}  // namespace scenegen::gltf::reading
