#include "scene/gltf/write_content.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "scene/gltf/write_files.h"
#include "scene/limits.h"

namespace scenegen::gltf {

Result<FileForm> form_of(const std::string& path) {
  if (path == "-") return FileForm::glb;
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  if (extension == ".glb") return FileForm::glb;
  if (extension == ".gltf") return FileForm::gltf;
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  if (std::filesystem::is_character_file(status) || std::filesystem::is_fifo(status)) return FileForm::glb;
  return fail(ErrorKind::usage, path,
              "the name must end in .glb or .gltf (or be - for a .glb on standard output)");
}

std::string binary_path(const std::string& path) {
  return std::filesystem::path(path).replace_extension(".bin").string();
}

std::string percent_encoded(std::string_view path) {
  constexpr std::string_view kHex = "0123456789ABCDEF";
  std::string uri;
  for (const char c : path) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       std::string_view("-._~/").find(c) != std::string_view::npos;
    if (plain) {
      uri += c;
    } else {
      const auto byte = static_cast<unsigned char>(c);
      uri += {'%', kHex[byte >> 4], kHex[byte & 15]};
    }
  }
  return uri;
}

namespace {

std::string uri_of(const std::string& path) {
  return percent_encoded(std::filesystem::path(path).filename().string());
}

constexpr std::uint64_t kGlbHeaderBytes = 12, kChunkHeaderBytes = 8;
constexpr std::uint64_t padding4(std::uint64_t n) {
  return (4 - n % 4) % 4;
}

std::uint64_t glb_bytes(std::uint64_t json_padded, std::uint64_t buffer) {
  return kGlbHeaderBytes + kChunkHeaderBytes + json_padded + (buffer > 0 ? kChunkHeaderBytes + buffer : 0);
}

void put_u32(std::uint64_t value, ByteSink& sink) {
  const auto narrow = static_cast<std::uint32_t>(value);
  sink.write(&narrow, 4);
}

void put_glb_header(std::uint64_t json_padded, std::uint64_t buffer, ByteSink& sink) {
  sink.write("glTF", 4);
  put_u32(2, sink);
  put_u32(glb_bytes(json_padded, buffer), sink);
  put_u32(json_padded, sink);
  sink.write("JSON", 4);
}

std::string in_gb(std::uint64_t bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f GB", static_cast<double>(bytes) * 1e-9);
  return text;
}

std::string shown(const std::string& path) {
  return path == "-" ? "standard output" : path;
}

Result<void> check_json_size(const std::string& path, std::uint64_t bytes) {
  if (bytes <= limits::kMaxJsonBytes) return {};
  return fail(ErrorKind::bad_input, shown(path),
              in_gb(bytes) + " of JSON; readers take at most 4.3 GB: use layout instances");
}

Result<void> check_glb_size(const std::string& path, std::uint64_t json_padded, std::uint64_t buffer) {
  if (Result<void> json = check_json_size(path, json_padded); !json) return json;
  const std::uint64_t bytes = glb_bytes(json_padded, buffer);
  if (bytes <= limits::kMaxGlbBytes) return {};
  return fail(ErrorKind::bad_input, shown(path),
              in_gb(bytes) + "; a .glb holds at most 4.3 GB: write a .gltf, or use layout instances");
}

/// JSON text with the padding of a chunk.
std::uint64_t count_json(const FileContent& content) {
  ByteSink counter;
  content.emit_json({}, counter);
  return counter.total() + padding4(counter.total());
}

/// Whether it is worth counting first, rather than finding out when gigabytes are on the disk.
bool may_be_too_large(const FileContent& content) {
  const WriteReport report = content.report();
  constexpr std::uint64_t kMostTextEach = 300;  // a node with a long name, a channel, an accessor
  return content.buffer_bytes() + kMostTextEach * (report.nodes + report.channels + report.accessors) >
         limits::kMaxGlbBytes / 2;
}

void put_buffer_chunk(const FileContent& content, ByteSink& sink) {
  if (content.buffer_bytes() == 0) return;
  put_u32(content.buffer_bytes(), sink);
  sink.write("BIN\0", 4);
  content.emit_buffer(sink);
}

/// The JSON's length stands before the JSON. In a file it is filled in afterwards; a stream needs a counting
/// pass first.
Result<std::uint64_t> put_glb(const FileContent& content, const std::string& path, OutputFile& file) {
  const std::uint64_t buffer = content.buffer_bytes();
  std::uint64_t json_padded = 0;
  if (file.streams() || may_be_too_large(content)) json_padded = count_json(content);
  if (Result<void> size = check_glb_size(path, json_padded, buffer); !size) return forward_error(size);

  ByteSink sink(file.descriptor());
  put_glb_header(json_padded, buffer, sink);
  const std::uint64_t json_start = sink.total();
  content.emit_json({}, sink);
  sink.fill(' ', padding4(sink.total() - json_start));
  json_padded = sink.total() - json_start;
  if (Result<void> size = check_glb_size(path, json_padded, buffer); !size) return forward_error(size);
  put_buffer_chunk(content, sink);
  sink.flush();
  if (sink.failed()) return file.error(sink.error());
  if (!file.streams()) {
    if (::lseek(file.descriptor(), 0, SEEK_SET) != 0) return file.error(errno);
    ByteSink header(file.descriptor());
    put_glb_header(json_padded, buffer, header);
    header.flush();
    if (header.failed()) return file.error(header.error());
  }
  return json_padded;
}

/// Closed files: to their places, or to who does that later.
Result<void> place(std::vector<OutputFile> files, std::vector<OutputFile>* later) {
  if (later == nullptr) return commit_all(files);
  for (OutputFile& file : files) later->push_back(std::move(file));
  return {};
}

Result<WriteReport> write_glb(const FileContent& content, const std::string& path,
                              std::vector<OutputFile>* later) {
  Result<OutputFile> file = OutputFile::open(path);
  if (!file) return forward_error(file);
  const Result<std::uint64_t> json_bytes = put_glb(content, path, *file);
  if (!json_bytes) return tl::unexpected<Error>(json_bytes.error());
  if (Result<void> closed = file->close(); !closed) return forward_error(closed);
  std::vector<OutputFile> files;
  files.push_back(std::move(*file));
  if (Result<void> placed = place(std::move(files), later); !placed) return forward_error(placed);
  WriteReport report = content.report();
  report.json_bytes = *json_bytes;
  report.bytes = glb_bytes(*json_bytes, content.buffer_bytes());
  return report;
}

Result<WriteReport> write_gltf(const FileContent& content, const std::string& path, const std::string& binary,
                               std::vector<OutputFile>* later) {
  Result<OutputFile> json_file = OutputFile::open(path);
  if (!json_file) return forward_error(json_file);
  std::optional<OutputFile> binary_file;
  if (content.buffer_bytes() > 0) {
    Result<OutputFile> opened = OutputFile::open(binary);
    if (!opened) return forward_error(opened);
    binary_file.emplace(std::move(*opened));
    ByteSink sink(binary_file->descriptor());
    content.emit_buffer(sink);
    sink.flush();
    if (sink.failed()) return binary_file->error(sink.error());
  }
  ByteSink sink(json_file->descriptor());
  content.emit_json(uri_of(binary), sink);
  sink.write("\n", 1);
  sink.flush();
  if (sink.failed()) return json_file->error(sink.error());
  if (Result<void> size = check_json_size(path, sink.total()); !size) return forward_error(size);

  // Both are complete before either is put in its place.
  if (Result<void> closed = json_file->close(); !closed) return forward_error(closed);
  std::vector<OutputFile> files;
  if (binary_file) {
    if (Result<void> closed = binary_file->close(); !closed) return forward_error(closed);
    files.push_back(std::move(*binary_file));
  }
  files.push_back(std::move(*json_file));
  if (Result<void> placed = place(std::move(files), later); !placed) return forward_error(placed);
  WriteReport report = content.report();
  report.json_bytes = sink.total();
  report.bytes = sink.total() + content.buffer_bytes();
  return report;
}

}  // namespace

Result<void> check_glb_buffer(const std::string& path, std::uint64_t bytes) {
  return check_glb_size(path, 0, bytes);
}

Result<WriteReport> write_content(const FileContent& content, FileForm form, const std::string& path,
                                  const std::string& binary, std::vector<OutputFile>* later) {
  const BlockSigpipe no_signal;
  return form == FileForm::glb ? write_glb(content, path, later) : write_gltf(content, path, binary, later);
}

Result<WriteReport> predict_content(const FileContent& content, FileForm form, const std::string& path,
                                    const std::string& binary) {
  WriteReport report = content.report();
  if (form == FileForm::glb) {
    report.json_bytes = count_json(content);
    report.bytes = glb_bytes(report.json_bytes, content.buffer_bytes());
    if (Result<void> size = check_glb_size(path, report.json_bytes, content.buffer_bytes()); !size)
      return forward_error(size);
  } else {
    ByteSink counter;
    content.emit_json(uri_of(binary), counter);
    report.json_bytes = counter.total() + 1;
    report.bytes = report.json_bytes + content.buffer_bytes();
    if (Result<void> size = check_json_size(path, report.json_bytes); !size) return forward_error(size);
  }
  return report;
}

}  // namespace scenegen::gltf
