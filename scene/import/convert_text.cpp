// Names, metadata, notes.
#include <cmath>

#include "scene/import/convert.h"

namespace scenegen::import {

namespace {

using nlohmann::json;

bool continuation(const std::string& s, std::size_t at) {
  return at < s.size() && (static_cast<unsigned char>(s[at]) & 0xC0U) == 0x80U;
}

bool is_utf8(const std::string& s) {
  for (std::size_t i = 0; i < s.size();) {
    const auto c = static_cast<unsigned char>(s[i]);
    const std::size_t more = c < 0x80                ? 0
                             : c >= 0xC2 && c < 0xE0 ? 1
                             : c >= 0xE0 && c < 0xF0 ? 2
                             : c >= 0xF0 && c < 0xF5 ? 3
                                                     : 9;
    if (more == 9) return false;
    for (std::size_t k = 1; k <= more; ++k) {
      if (!continuation(s, i + k)) return false;
    }
    const auto second = static_cast<unsigned char>(more > 0 ? s[i + 1] : 0);
    const bool overlong = (c == 0xE0 && second < 0xA0) || (c == 0xF0 && second < 0x90);
    const bool beyond = (c == 0xED && second >= 0xA0) || (c == 0xF4 && second >= 0x90);
    if (overlong || beyond) return false;
    i += more + 1;
  }
  return true;
}

}  // namespace

std::string text(const aiString& string) {
  const std::string raw(string.data, std::min<std::size_t>(string.length, sizeof string.data));
  const bool utf8 = is_utf8(raw);
  std::string out;
  out.reserve(raw.size());
  for (const char c : raw) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) {
      out += '?';
    } else if (byte >= 0x80 && !utf8) {
      out += static_cast<char>(0xC0U | (byte >> 6));
      out += static_cast<char>(0x80U | (byte & 0x3FU));
    } else {
      out += c;
    }
  }
  return out;
}

json metadata_json(const aiMetadata* metadata, unsigned depth) {
  json out = json::object();
  if (metadata == nullptr || depth > 8) return out;
  for (unsigned i = 0; i < metadata->mNumProperties; ++i) {
    const aiMetadataEntry& entry = metadata->mValues[i];
    if (entry.mData == nullptr) continue;
    json& value = out[text(metadata->mKeys[i])];
    const auto number = [&value](double v) {
      if (std::isfinite(static_cast<float>(v))) value = v;
    };
    switch (entry.mType) {
      case AI_BOOL:
        value = *static_cast<const bool*>(entry.mData);
        break;
      case AI_INT32:
        value = *static_cast<const std::int32_t*>(entry.mData);
        break;
      case AI_UINT64:
        value = *static_cast<const std::uint64_t*>(entry.mData);
        break;
      case AI_FLOAT:
        number(*static_cast<const float*>(entry.mData));
        break;
      case AI_DOUBLE:
        number(*static_cast<const double*>(entry.mData));
        break;
      case AI_AISTRING:
        value = text(*static_cast<const aiString*>(entry.mData));
        break;
      case AI_AIVECTOR3D: {
        const auto& v = *static_cast<const aiVector3D*>(entry.mData);
        if (std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z)) value = {v.x, v.y, v.z};
        break;
      }
      case AI_AIMETADATA:
        value = metadata_json(static_cast<const aiMetadata*>(entry.mData), depth + 1);
        break;
      default:
        break;
    }
  }
  return out;
}

void Notes::add(const std::string& what, std::uint64_t count) {
  for (gltf::Ignored& known : list_) {
    if (known.what != what) continue;
    known.count += count;
    return;
  }
  list_.push_back({"", what, count});
}

}  // namespace scenegen::import
