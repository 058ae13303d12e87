#include "scene/gltf/read.h"

#include <simdjson.h>

#include <cstring>
#include <new>

#include "scene/gltf/build.h"
#include "scene/gltf/parse.h"
#include "scene/limits.h"

namespace scenegen::gltf {

namespace {

using namespace reading;

std::shared_ptr<const SourceDocument> keep_source(const std::string& name, const Container& container,
                                                  const Buffers& buffers, const Scene& scene,
                                                  const Motions& motions, Origins origins) {
  auto out = std::make_shared<SourceDocument>();
  out->path = name;
  out->json.reserve(container.json.size() + simdjson::SIMDJSON_PADDING);  // patch() reads it again
  out->json = container.json;
  for (std::uint32_t i = 0; i < buffers.size(); ++i)
    out->buffers.emplace_back(buffers[i].begin(), buffers[i].end());
  out->node_of_object = std::move(origins.node);
  out->instance_of_object = std::move(origins.instance);
  out->merged = origins.merged;
  out->node_of_frame = std::move(origins.node_of_frame);
  out->track_count = static_cast<std::uint32_t>(scene.tracks.size());
  if (out->track_count != 0) out->visibility_of_object = scene.objects.visibility;
  out->scale_visibility = motions.scale_visibility;
  return out;
}

ReadResult read_block(const Block& file, const std::string& name, const std::string& folder,
                      const ReadOptions& options) {
  ReadResult out;
  const Container container = split_container(file.bytes());
  Document document;
  parse_document(container.json, document);
  Buffers buffers;
  buffers.load(document, container, folder);
  const std::uint64_t input_bytes = file.size + buffers.external_bytes();
  Data data(document, buffers, input_bytes);
  out.file_bytes = input_bytes;
  out.json_bytes = container.json.size();

  build_materials(document, data, folder, out.scene);
  settle_merged(document, data);
  build_meshes(document, data, out.scene);
  const Hierarchy hierarchy = build_hierarchy(document);
  VisibilityTable visibility((1ULL << 20) + input_bytes);
  const Motions motions = build_motions(document, data, visibility, out.scene);
  Origins origins = build_objects(document, data, hierarchy, motions, visibility, out.scene);
  origins.merged = !document.instance_sets.empty();
  out.scene.info = std::move(document.info);
  out.ignored = document.ignored.take();
  if (options.keep_source)
    out.source = keep_source(name, container, buffers, out.scene, motions, std::move(origins));
  return out;
}

/// Runs `body` and turns what it throws into an Error about file `name`.
template <class Body>
Result<ReadResult> guarded(const std::string& name, const Body& body) {
  try {
    return body();
  } catch (Fault& fault) {
    Error& error = fault.error;
    error.where = error.where.empty() ? name : name + ": " + error.where;
    return tl::unexpected<Error>(std::move(error));
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::bad_input, name, "not enough memory for what the file holds");
  } catch (const std::length_error&) {
    return fail(ErrorKind::bad_input, name, "not enough memory for what the file holds");
  }
}

}  // namespace

Result<ReadResult> read(const std::string& path, const ReadOptions& options) {
  const std::string name = path == "-" ? "stdin" : path;
  return guarded(name, [&] {
    const Block file = read_file(path, Place(), true, limits::kMaxGlbBytes);
    const std::size_t slash = path.rfind('/');
    const std::string folder = slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
    return read_block(file, name, folder, options);
  });
}

Result<ReadResult> read_memory(std::vector<std::uint8_t> bytes, const std::string& name,
                               const std::string& folder, const ReadOptions& options) {
  return guarded(name, [&] {
    const Block file = make_block(bytes.size());
    if (!bytes.empty()) std::memcpy(file.data.get(), bytes.data(), bytes.size());
    std::vector<std::uint8_t>().swap(bytes);
    return read_block(file, name, folder, options);
  });
}

}  // namespace scenegen::gltf
