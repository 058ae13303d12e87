#include "scene/import/import.h"

#include <assimp/postprocess.h>
#include <assimp/version.h>
#include <sys/stat.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>

#include "scene/gltf/write_sink.h"
#include "scene/import/child.h"
#include "scene/import/convert.h"
#include "scene/limits.h"

namespace scenegen::import {

namespace {

using nlohmann::json;

std::string extension_of(const std::string& path) {
  std::string out = std::filesystem::path(path).extension().string();
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out.empty() ? out : out.substr(1);
}

// ---- In the child: one line of JSON (an error, or the notes), then the .glb.

const aiScene& read_scene(Assimp::Importer& importer, const std::string& path, const ImportOptions& options) {
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, options.up != UpAxis::automatic);
  // Kinds of primitives apart, as glTF has them; its texture coordinates have their origin at the top.
  constexpr unsigned kSteps = aiProcess_Triangulate | aiProcess_SortByPType |
                              aiProcess_JoinIdenticalVertices | aiProcess_FindInvalidData |
                              aiProcess_GenUVCoords | aiProcess_TransformUVCoords | aiProcess_FlipUVs;
  const aiScene* const scene = importer.ReadFile(path, kSteps);
  const std::string error = importer.GetErrorString();
  if (error.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
  if (scene == nullptr || scene->mRootNode == nullptr)
    throw Refusal{error.empty() ? "Assimp cannot read it" : "Assimp: " + error};
  return *scene;
}

void convert(Conversion& c) {
  json& document = c.document.root;
  document["asset"] = {
      {"version", "2.0"},
      {"generator", "scenegen " SCENEGEN_VERSION ", Assimp " + std::to_string(aiGetVersionMajor()) + "." +
                        std::to_string(aiGetVersionMinor())}};
  json source = metadata_json(c.scene.mMetaData);
  if (const auto copyright = source.find("SourceAsset_Copyright"); copyright != source.end())
    document["asset"]["copyright"] = *copyright;
  if (!source.empty()) document["asset"]["extras"]["source"] = std::move(source);
  const std::vector<json> primitives = convert_meshes(c);
  if (std::all_of(primitives.begin(), primitives.end(), [](const json& p) { return p.is_null(); })) {
    throw Refusal{c.scene.mNumAnimations > 0 ? "nothing to draw: it holds animations and no meshes"
                                             : "nothing to draw: it holds no meshes"};
  }
  convert_nodes(c, primitives);
  if (c.scene.mNumAnimations != 0) c.notes.add("animations", c.scene.mNumAnimations);
}

void send(gltf::ByteSink& sink, const json& header) {
  const std::string line = header.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
  sink.write(line.data(), line.size());
}

void import_in_child(const std::string& path, const ImportOptions& options, int descriptor) {
  gltf::ByteSink sink(descriptor);
  try {
    Assimp::Importer importer;
    const aiScene& scene = read_scene(importer, path, options);
    const std::string folder = std::filesystem::path(path).parent_path().string();
    const std::string extension = extension_of(path);
    Conversion c{scene,
                 path,
                 folder.empty() ? "." : folder,
                 extension == "ifc" || extension == "ifczip",
                 metres_y_up(scene, path, options),
                 {},
                 {}};
    convert(c);
    json notes = json::array();
    for (const gltf::Ignored& note : c.notes.list()) notes.push_back({note.what, note.count});
    send(sink, {{"notes", notes}});
    c.document.write(sink);
  } catch (const Refusal& refusal) {
    send(sink, {{"error", refusal.what}});
  }
  sink.flush();
}

// ---- In the parent

ChildLimits limits_for(std::uint64_t file_bytes) {
  // Every model of assimp-testmodels stays far below; these bounds only end what would not end by itself (a
  // PLY file that stops in its middle).
  constexpr std::uint64_t kMega = 1 << 20;
  ChildLimits out;
  out.memory_bytes = 1024 * kMega + 500 * file_bytes;
  out.cpu_s = std::min<std::uint64_t>(20 + 20 * file_bytes / kMega, 7200);
  out.output_bytes = limits::kMaxGlbBytes;
  return out;
}

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, ' ');
  while (!text.empty() && text.back() == ' ') text.pop_back();
  constexpr std::size_t kMost = 300;
  if (text.size() > kMost) text.resize(kMost);
  return text;
}

Result<void> check_end(const ChildOutcome& outcome, const std::string& path, const ChildLimits& limits) {
  using End = ChildOutcome::End;
  const auto bad = [&](const std::string& what) { return fail(ErrorKind::bad_input, path, what); };
  switch (outcome.end) {
    case End::finished:
      return {};
    case End::not_started:
      return fail(ErrorKind::io, path,
                  std::string("no process to read it in: ") + std::strerror(outcome.code));
    case End::too_long:
      return bad("Assimp took more than " + std::to_string(limits.cpu_s) +
                 " s of processor time on it; the file is damaged or too large");
    case End::too_much_memory:
      return bad("Assimp wanted more than " + std::to_string(limits.memory_bytes >> 20) +
                 " MiB of memory for it; the file is damaged or too large");
    case End::too_much_output:
      return bad("it becomes more than 4 GiB of glTF");
    case End::crashed:
      break;
  }
  return bad("Assimp crashed on it" +
             (outcome.code != 0 ? " (signal " + std::to_string(outcome.code) + ")" : "") +
             "; the file is damaged or of a kind it cannot read");
}

Result<std::uint64_t> size_of_model(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return fail(ErrorKind::io, path, std::strerror(errno));
  if (!S_ISREG(status.st_mode)) return fail(ErrorKind::io, path, "not a regular file");
  if (status.st_size == 0) return fail(ErrorKind::bad_input, path, "empty");
  return static_cast<std::uint64_t>(status.st_size);
}

/// Assimp takes an IFC file that was cut off for a smaller model. What stands behind the end (blanks,
/// comments, signatures) is not looked at.
Result<void> check_ifc_is_whole(const std::string& path, std::uint64_t size) {
  constexpr std::string_view kBegin = "ISO-10303-21;", kEnd = "END-ISO-10303-21";
  constexpr std::uint64_t kPart = 1 << 16;
  std::ifstream file(path, std::ios::binary);
  const auto part = [&](std::uint64_t begin) {
    std::string out(std::min(kPart, size), '\0');
    file.seekg(static_cast<std::streamoff>(begin));
    file.read(out.data(), static_cast<std::streamsize>(out.size()));
    return out;
  };
  const std::string head = part(0), tail = part(size - std::min(kPart, size));
  if (!file) return fail(ErrorKind::io, path, "cannot be read");
  const bool step = head.find(kBegin) != std::string::npos;  // else Assimp says what is wrong
  if (step && tail.find(kEnd) == std::string::npos)
    return fail(ErrorKind::bad_input, path, "ends before " + std::string(kEnd) + ";: it is not whole");
  return {};
}

Result<gltf::ReadResult> read_answer(ChildOutcome& outcome, const std::string& path) {
  const auto end = std::find(outcome.bytes.begin(), outcome.bytes.end(), '\n');
  const json header = json::parse(outcome.bytes.begin(), end, nullptr, false);
  if (end == outcome.bytes.end() || !header.is_object())
    return fail(ErrorKind::bad_input, path, "Assimp ended on it without a word");
  if (header.contains("error"))
    return fail(ErrorKind::bad_input, path, one_line(header["error"].get<std::string>()));
  outcome.bytes.erase(outcome.bytes.begin(), end + 1);
  gltf::ReadOptions options;
  options.keep_source = true;
  auto read = gltf::read_memory(std::move(outcome.bytes), path + " as glTF", "", options);
  if (!read) return read;
  if (read->scene.objects.size() == 0)
    return fail(ErrorKind::bad_input, path, "nothing to draw: no node has a mesh");
  std::vector<gltf::Ignored> notes;
  for (const json& note : header["notes"]) notes.push_back({path, note[0], note[1]});
  read->ignored.insert(read->ignored.begin(), notes.begin(), notes.end());
  return read;
}

}  // namespace

bool is_gltf(const std::string& path) {
  const std::string extension = extension_of(path);
  return path == "-" || extension == "glb" || extension == "gltf";
}

std::vector<std::string> model_extensions() {
  std::string list;
  Assimp::Importer().GetExtensionList(list);  // "*.3ds;*.obj;…"
  std::vector<std::string> out{"glb", "gltf"};
  std::istringstream stream(list);
  for (std::string entry; std::getline(stream, entry, ';');) {
    const std::size_t dot = entry.find('.');
    if (dot != std::string::npos) out.push_back(entry.substr(dot + 1));
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

Result<gltf::ReadResult> read_model(const std::string& path, const ImportOptions& options) {
  if (is_gltf(path)) {
    gltf::ReadOptions native;
    native.keep_source = true;
    return gltf::read(path, native);
  }
  auto size = size_of_model(path);
  if (!size) return forward_error(size);
  const std::vector<std::string> known = model_extensions();
  const std::string extension = extension_of(path);
  if (!std::binary_search(known.begin(), known.end(), extension)) {
    return fail(ErrorKind::bad_input, path,
                (extension.empty() ? "a name without an extension"
                                   : "'." + extension + "' is no model format that is read") +
                    std::string(" (glTF and what Assimp reads: .fbx .ifc .obj .dae .stl .3mf …)"));
  }
  if (extension == "ifc") {
    if (auto whole = check_ifc_is_whole(path, *size); !whole) return forward_error(whole);
  }
  const ChildLimits limits = limits_for(*size);
  ChildOutcome outcome =
      run_in_child([&](int descriptor) { import_in_child(path, options, descriptor); }, limits);
  if (auto ended = check_end(outcome, path, limits); !ended) return forward_error(ended);
  return read_answer(outcome, path);
}

}  // namespace scenegen::import
