#include "scene/gltf/container.h"

#include <fcntl.h>
#include <simdjson.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <map>

#include "scene/limits.h"

namespace scenegen::gltf::reading {

namespace {

/// Closes what it opened.
struct Descriptor {
  int fd = -1;
  bool owned = true;
  Descriptor(int f, bool o) : fd(f), owned(o) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (owned && fd >= 0) ::close(fd);
  }
};

[[noreturn]] void reject_io(const Place& at, const std::string& path, const std::string& what) {
  reject(at, (at.up == nullptr ? "" : "'" + printable(path, 200) + "': ") + what, ErrorKind::io);
}

/// Bytes read; less than `size` at the end of the file.
std::uint64_t read_fully(int fd, std::uint8_t* to, std::uint64_t size, const Place& at,
                         const std::string& path) {
  std::uint64_t done = 0;
  while (done < size) {
    const ssize_t n = ::read(fd, to + done, std::min<std::uint64_t>(size - done, 1U << 30));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) reject_io(at, path, std::strerror(errno));
    if (n == 0) break;
    done += static_cast<std::uint64_t>(n);
  }
  return done;
}

Block read_stream(int fd, const Place& at, const std::string& path, std::uint64_t most) {
  Block block = make_block(1U << 16);
  std::uint64_t done = 0;
  for (;;) {
    done += read_fully(fd, block.data.get() + done, block.size - done, at, path);
    if (done < block.size) break;
    if (done > most) reject(at, "more than " + std::to_string(most) + " bytes");
    Block larger = make_block(block.size * 2);
    std::memcpy(larger.data.get(), block.data.get(), done);
    block = std::move(larger);
  }
  block.size = done;
  return block;
}

}  // namespace

Block make_block(std::uint64_t size) {
  Block block{std::make_unique_for_overwrite<std::uint8_t[]>(size + simdjson::SIMDJSON_PADDING), size};
  std::memset(block.data.get() + size, 0, simdjson::SIMDJSON_PADDING);
  return block;
}

Block read_file(const std::string& path, const Place& at, bool allow_stdin, std::uint64_t most) {
  const bool from_stdin = allow_stdin && path == "-";
  const Descriptor file(from_stdin ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK),
                        !from_stdin);
  if (file.fd < 0) reject_io(at, path, std::strerror(errno));
  struct stat status {};
  if (::fstat(file.fd, &status) != 0) reject_io(at, path, std::strerror(errno));
  if (from_stdin && !S_ISREG(status.st_mode)) return read_stream(file.fd, at, path, most);
  if (!S_ISREG(status.st_mode)) reject_io(at, path, "not a regular file");
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (from_stdin || (at.up == nullptr && size > most)) {
    if (size > most)
      reject(at, std::to_string(size) + " bytes; at most " + std::to_string(most) + " are read");
  }
  Block block = make_block(std::min(size, most));
  block.size = read_fully(file.fd, block.data.get(), block.size, at, path);
  return block;
}

namespace {
std::uint32_t u32_at(Bytes bytes, std::uint64_t offset) {
  std::uint32_t out = 0;
  std::memcpy(&out, bytes.data() + offset, 4);  // little-endian, as the machines we build for
  return out;
}
}  // namespace

Container split_container(Bytes file) {
  const Place root;
  const auto text = [](Bytes bytes) {
    return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  if (file.size() < 4 || std::memcmp(file.data(), "glTF", 4) != 0) {
    if (file.size() >= 3 && std::memcmp(file.data(), "\xEF\xBB\xBF", 3) == 0) file = file.subspan(3);
    const std::string_view json = text(file);
    const std::size_t first = json.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos) reject(root, "empty");
    if (json[first] != '{') reject(root, "is no glTF: it begins neither as a .glb nor as a JSON object");
    return {json, {}, false};
  }
  if (file.size() < 20)
    reject(root, "truncated: a .glb has at least 20 bytes, this one " + std::to_string(file.size()));
  if (u32_at(file, 4) != 2)
    reject(root, ".glb version " + std::to_string(u32_at(file, 4)) + "; this program reads 2");
  if (u32_at(file, 8) != file.size()) {
    reject(root, "truncated or damaged: the .glb header says " + std::to_string(u32_at(file, 8)) +
                     " bytes, there are " + std::to_string(file.size()));
  }
  constexpr std::uint32_t kJson = 0x4E4F534A;
  constexpr std::uint32_t kBin = 0x004E4942;
  Container out;
  std::uint64_t at = 12;
  for (std::uint64_t chunk = 0; at + 8 <= file.size(); ++chunk) {
    const std::uint64_t length = u32_at(file, at);
    const std::uint32_t type = u32_at(file, at + 4);
    at += 8;
    if (length > file.size() - at) {
      reject(root, ".glb chunk " + std::to_string(chunk) + " has " + std::to_string(length) + " bytes, " +
                       std::to_string(file.size() - at) + " are left");
    }
    const Bytes bytes = file.subspan(at, length);
    if (chunk == 0) {
      if (type != kJson) reject(root, "the first .glb chunk is not JSON");
      out.json = text(bytes);
    } else if (type == kBin && !out.has_bin) {
      out.bin = bytes;
      out.has_bin = true;
    }
    at += length;
  }
  return out;
}

namespace {

int hex(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string percent_decoded(std::string_view text, const Place& at) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    const int hi = i + 2 < text.size() ? hex(text[i + 1]) : -1;
    const int lo = i + 2 < text.size() ? hex(text[i + 2]) : -1;
    if (hi < 0 || lo < 0) reject(at, "broken percent-encoding");
    out += static_cast<char>(hi * 16 + lo);
    i += 2;
  }
  return out;
}

void decode_base64(std::string_view text, const Place& at, std::vector<std::uint8_t>& out) {
  static const std::array<std::int8_t, 256> digits = [] {
    std::array<std::int8_t, 256> table{};
    table.fill(-1);
    const std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < alphabet.size(); ++i)
      table[static_cast<unsigned char>(alphabet[i])] = static_cast<std::int8_t>(i);
    table[static_cast<unsigned char>('-')] = 62;  // URL-safe variant
    table[static_cast<unsigned char>('_')] = 63;
    return table;
  }();
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  out.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::int8_t digit = digits[static_cast<unsigned char>(c)];
    if (digit < 0) reject(at, "a character that is not base64");
    bits = (bits << 6) | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count >= 8) {
      count -= 8;
      out.push_back(static_cast<std::uint8_t>(bits >> count));
    }
  }
}

bool has_scheme(std::string_view uri) {
  for (const char c : uri) {
    if (c == ':') return true;
    const bool part = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                      c == '+' || c == '.' || c == '-';
    if (!part) return false;
  }
  return false;
}

}  // namespace

bool decode_data_uri(std::string_view uri, const Place& at, std::vector<std::uint8_t>& out,
                     std::string* media_type) {
  if (uri.substr(0, 5) != "data:") return false;
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos) reject(at, "data URI without a comma");
  const std::string_view head = uri.substr(5, comma - 5);
  if (media_type != nullptr) *media_type = head.substr(0, head.find(';'));
  const std::string_view body = uri.substr(comma + 1);
  if (head.size() >= 7 && head.substr(head.size() - 7) == ";base64") {
    if (body.find('%') == std::string_view::npos) {
      decode_base64(body, at, out);
    } else {
      decode_base64(percent_decoded(body, at), at, out);
    }
  } else {
    const std::string text = percent_decoded(body, at);
    out.assign(text.begin(), text.end());
  }
  return true;
}

std::string resolve_uri(std::string_view uri, const std::string& folder, const Place& at) {
  if (has_scheme(uri)) reject(at, "'" + printable(uri) + "': only relative paths and data: are read");
  const std::string path = percent_decoded(uri, at);
  if (path.empty()) reject(at, "empty");
  if (path.front() == '/' || path.front() == '\\')
    reject(at, "'" + printable(path) + "': absolute paths are not read");
  if (path.find('\0') != std::string::npos) reject(at, "a path with a zero byte");
  if (folder.empty()) reject(at, "'" + printable(path) + "': other files are not read here");
  return folder + "/" + path;
}

void Buffers::load(const Document& document, const Container& container, const std::string& folder) {
  const Place root;
  const Place list = root.key("buffers");
  std::map<std::string, std::size_t> opened;  // one file, one block: a document may name it a million times
  for (std::size_t i = 0; i < document.buffers.size(); ++i) {
    const Buffer& buffer = document.buffers[i];
    const Place at = list.at(i);
    const Place uri = at.key("uri");
    Bytes bytes;
    if (!buffer.has_uri) {
      if (i == 0 && container.has_bin) bytes = container.bin;
      if (i != 0 || !container.has_bin) {
        // Only an error when something reads from it (EXT_meshopt_compression has such fallback buffers).
        bytes_.emplace_back();
        continue;
      }
    } else if (std::vector<std::uint8_t> decoded; decode_data_uri(buffer.uri, uri, decoded, nullptr)) {
      bytes = decoded_.emplace_back(std::move(decoded));
    } else {
      const std::string path = resolve_uri(buffer.uri, folder, uri);
      const auto [entry, fresh] = opened.emplace(path, files_.size());
      if (fresh) files_.push_back(read_file(path, uri, false, limits::kMaxGlbBytes));
      bytes = files_[entry->second].bytes();
      if (fresh) external_bytes_ += bytes.size();
    }
    if (bytes.size() < buffer.byte_length) {
      reject(at.key("byteLength"), std::to_string(buffer.byte_length) + " bytes, but only " +
                                       std::to_string(bytes.size()) + " are there");
    }
    bytes_.push_back(bytes.first(buffer.byte_length));
  }
}

}  // namespace scenegen::gltf::reading
