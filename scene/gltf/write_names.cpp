#include "scene/gltf/write_names.h"

#include <algorithm>
#include <map>
#include <vector>

namespace scenegen::gltf {

void UniqueNames::wish(std::string_view name) {
  names_.push_back(name);
}

void UniqueNames::settle(const NameTable& objects) {
  if (names_.empty()) return;
  // Rounds: whoever collides gets another name, until nobody does. The set holds the few names asked for, not
  // the million names of objects, which are looked up in it.
  const NameTable wished = names_;
  std::map<std::string_view, std::uint32_t> suffix;  // by wish: a thousand equal wishes settle in one round
  for (bool settled = false; !settled;) {
    Dedup taken;
    std::vector<std::uint32_t> owner;
    std::vector<std::uint8_t> collides(names_.size(), 0);
    const auto same_as = [&](std::string_view name) {
      return [&, name](std::uint32_t i) { return names_[owner[i]] == name; };
    };
    for (std::uint32_t i = 0; i < names_.size(); ++i) {
      bool is_new = false;
      taken.add(fast_hash(names_[i]), same_as(names_[i]), is_new);
      if (is_new) {
        owner.push_back(i);
      } else {
        collides[i] = 1;
      }
    }
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const std::uint32_t at = taken.find(fast_hash(objects[i]), same_as(objects[i]));
      if (at != Dedup::kMissing) collides[owner[at]] = 1;
    }
    settled = std::find(collides.begin(), collides.end(), 1) == collides.end();
    if (settled) break;
    NameTable next;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (collides[i] == 0) {
        next.push_back(names_[i]);
      } else {
        next.push_back(std::string(wished[i]) + "~" +
                       std::to_string(++suffix.try_emplace(wished[i], 1).first->second));
      }
    }
    names_ = std::move(next);
  }
}

void write_leb128(std::uint64_t value, ByteSink& sink) {
  char* to = sink.reserve(10);
  for (; value >= 0x80; value >>= 7) *to++ = static_cast<char>(value | 0x80);
  *to++ = static_cast<char>(value);
  sink.commit(to);
}

void write_front_coded(const NameTable& names, ByteSink& sink) {
  std::string_view before;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string_view name = names[i];
    const std::size_t most = std::min(before.size(), name.size());
    std::size_t shared = 0;
    while (shared < most && name[shared] == before[shared]) ++shared;
    write_leb128(shared, sink);
    write_leb128(name.size() - shared, sink);
    sink.write(name.data() + shared, name.size() - shared);
    before = name;
  }
}

}  // namespace scenegen::gltf
