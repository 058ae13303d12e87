#include "scene/gltf/patch.h"

#include <algorithm>
#include <new>

#include "scene/gltf/parse.h"
#include "scene/gltf/patch_assets.h"
#include "scene/gltf/patch_buffers.h"
#include "scene/gltf/patch_plan.h"
#include "scene/gltf/patch_text.h"
#include "scene/gltf/write_check.h"
#include "scene/gltf/write_content.h"
#include "scene/gltf/write_info.h"

namespace scenegen::gltf {

namespace {

using namespace patching;
using reading::Path;

/// The document with its splices, as a file's content.
class PatchedDocument : public FileContent {
 public:
  PatchedDocument(const PatchInput& in, const NodePatch& nodes, const Scene& tracks,
                  const BufferPatch& buffers, const TextPatch& text, std::string_view json)
      : in_(in), nodes_(nodes), tracks_(tracks), buffers_(buffers), text_(text), json_(json) {
    if (!text.carried.channels.empty()) plan_carried();
  }

  void emit_json(std::string_view /*buffer_uri: in the splices*/, ByteSink& sink) const override {
    TextOut out(sink);
    text_.splices.emit(json_, {0, json_.size()}, out, [&](Part part) { emit_part(part, out); });
  }
  [[nodiscard]] std::uint64_t buffer_bytes() const override { return buffers_.bytes; }
  void emit_buffer(ByteSink& sink) const override {
    write_patched_buffer(in_, nodes_, tracks_, buffers_, sink);
  }
  [[nodiscard]] WriteReport report() const override {
    WriteReport report;
    report.nodes = in_.document.nodes.size() + nodes_.new_nodes.size();
    report.channels = nodes_.channels.size() + text_.carried.channels.size();
    report.samplers = nodes_.animation.samplers.size() + carried_samplers_.size();
    report.accessors = in_.document.accessors.size() + buffers_.animation.accessor_count;
    report.notes = buffers_.notes;
    report.notes.insert(report.notes.end(), text_.notes.begin(), text_.notes.end());
    return report;
  }

 private:
  void plan_carried() {
    new_index_.assign(text_.carried.samplers.size(), kNone);
    for (const CarriedChannel& c : text_.carried.channels) new_index_.at(c.sampler_index) = 0;
    for (std::uint32_t s = 0; s < new_index_.size(); ++s) {
      if (new_index_[s] == kNone) continue;
      new_index_[s] = static_cast<std::uint32_t>(nodes_.animation.samplers.size() + carried_samplers_.size());
      carried_samplers_.push_back(s);
    }
  }
  void emit_part(Part part, TextOut& out) const;
  void emit_animation(TextOut& out) const;
  void emit_new_nodes(TextOut& out) const;
  void emit_mesh(const NewNode& node, TextOut& out) const;
  void emit_extras(const NewNode& node, TextOut& out) const;
  void emit_views(TextOut& out) const;

  const PatchInput& in_;
  const NodePatch& nodes_;
  const Scene& tracks_;
  const BufferPatch& buffers_;
  const TextPatch& text_;
  std::string_view json_;
  std::vector<std::uint32_t> new_index_, carried_samplers_;
};

void PatchedDocument::emit_part(Part part, TextOut& out) const {
  switch (part) {
    case Part::new_nodes:
      return emit_new_nodes(out);
    case Part::accessors:
      return emit_accessors(tracks_, NodePlan(tracks_), nodes_.animation, buffers_.animation, out);
    case Part::views:
      return emit_views(out);
    case Part::animation:
      return emit_animation(out);
    case Part::none:
      return;
  }
}

void PatchedDocument::emit_views(TextOut& out) const {
  emit_buffer_views(tracks_, buffers_.animation, out);
  for (std::size_t i = 0; i < buffers_.images.size(); ++i) {
    const EmbeddedImage& image = buffers_.images[i];
    if (i > 0 || buffers_.animation.view_count > 0) out.raw(",");
    out.raw(R"({"buffer":0,"byteOffset":)");
    out.number(image.offset);
    out.raw(R"(,"byteLength":)");
    out.number(in_.scene.images[image.image].bytes.size());
    out.raw("}");
  }
}

void PatchedDocument::emit_mesh(const NewNode& node, TextOut& out) const {
  if (node.mesh == kNone) return;
  out.raw(R"(,"mesh":)");
  out.number(node.mesh);
  const auto taken = std::lower_bound(text_.companions.begin(), text_.companions.end(), node.source,
                                      [](const MeshCompanions& c, std::uint32_t n) { return c.node < n; });
  if (taken == text_.companions.end() || taken->node != node.source) return;
  const auto copy = [&](std::string_view key, Span span) {
    if (span.empty()) return;
    out.raw(key);
    out.raw(json_.substr(span.begin, span.end - span.begin));
  };
  copy(R"(,"skin":)", taken->skin);
  copy(R"(,"weights":)", taken->weights);
}

void PatchedDocument::emit_extras(const NewNode& node, TextOut& out) const {
  if (node.kind == NewNode::Kind::frame) return;
  out.raw(R"(,"extras":{"scenegen":{)");
  if (node.kind == NewNode::Kind::look) {
    out.raw(R"("look":)");
    out.number(node.look);
  } else {
    out.raw(R"("name":)");
    out.string(in_.scene.objects.names[node.object.value]);
    out.raw(R"(,"standsFor":)");
    out.number(node.stands_for);
    if (node.object_mesh != kNone) {
      out.raw(R"(,"mesh":)");
      out.number(node.object_mesh);
    }
    if (node.object_index != kNone) {
      out.raw(R"(,"object":)");
      out.number(node.object_index);
    }
  }
  out.raw("}}");
}

void PatchedDocument::emit_new_nodes(TextOut& out) const {
  Commas commas(out);
  auto child = std::lower_bound(nodes_.added.begin(), nodes_.added.end(), nodes_.first_new,
                                [](const auto& a, std::uint64_t first) { return a.first < first; });
  for (std::size_t i = 0; i < nodes_.new_nodes.size() && !out.sink().failed(); ++i) {
    const NewNode& node = nodes_.new_nodes[i];
    commas.next().raw(R"({"name":)");
    out.string(nodes_.new_names[node.name]);
    emit_transform(node.local, out);
    emit_mesh(node, out);
    Commas children(out);
    for (; child != nodes_.added.end() && child->first == nodes_.first_new + i; ++child) {
      if (children.empty()) out.raw(R"(,"children":[)");
      children.next().number(child->second);
    }
    if (!children.empty()) out.raw("]");
    if (node.pointer) out.raw(R"(,"extensions":{"KHR_node_visibility":{}})");
    emit_extras(node, out);
    out.raw("}");
  }
}

void PatchedDocument::emit_animation(TextOut& out) const {
  out.raw(R"({"name":)");
  out.string(text_.animation_name);
  out.raw(R"(,"samplers":[)");
  Commas samplers(out);
  for (const AnimationSampler& sampler : nodes_.animation.samplers) {
    samplers.next();
    emit_sampler(buffers_.animation.first_input + sampler.input, buffers_.animation.accessor_of(sampler),
                 sampler.interpolation, out);
  }
  for (const std::uint32_t s : carried_samplers_) {
    const Span span = text_.carried.samplers[s];
    samplers.next().raw(json_.substr(span.begin, span.end - span.begin));
  }
  out.raw(R"(],"channels":[)");
  ChannelText text(out);
  for (const PatchChannel& c : nodes_.channels) {
    switch (c.path) {
      case Path::visibility:
        text.visible(c.sampler, c.target);
        break;
      case Path::base_color:
        text.pointer(c.sampler, "/materials/", c.target, "/pbrMetallicRoughness/baseColorFactor");
        break;
      case Path::translation:
        text.node(c.sampler, c.target, "translation");
        break;
      case Path::rotation:
        text.node(c.sampler, c.target, "rotation");
        break;
      default:
        text.node(c.sampler, c.target, "scale");
    }
  }
  for (const CarriedChannel& c : text_.carried.channels) {
    Splices numbers;
    numbers.replace(c.sampler, std::to_string(new_index_[c.sampler_index]));
    if (!c.node.empty()) numbers.replace(c.node, std::to_string(c.node_index));
    numbers.sort();
    text.next();
    numbers.emit(json_, c.whole, out);
  }
  out.raw("]}");
}

Result<WriteReport> patch_document(const SourceDocument& source, const Scene& scene, const std::string& path,
                                   const PatchOptions& options) {
  const Result<FileForm> form = form_of(path);
  if (!form) return tl::unexpected<Error>(form.error());
  SourceText text(source.json);
  reading::Document document;
  reading::parse_document(text.text(), document);
  const reading::Hierarchy hierarchy = reading::build_hierarchy(document);
  const NodeUses uses = text.survey(document);
  const PatchInput input{source, scene, options, document, hierarchy, uses};
  Scene tracks;
  const NodePatch nodes = plan_patch(input, tracks);
  AssetPatch assets = plan_assets(input);
  const std::string binary = *form == FileForm::gltf ? free_binary_path(input, path) : std::string();
  const BufferPatch buffers = plan_buffers(input, nodes, tracks, *form, path, binary);
  const TextPatch patched = make_splices(text, input, nodes, buffers, assets);
  return write_content(PatchedDocument(input, nodes, tracks, buffers, patched, text.text()), *form, path,
                       binary, options.later);
}

}  // namespace

Result<WriteReport> patch(const SourceDocument& source, const Scene& scene, const std::string& path,
                          const PatchOptions& options) {
  if (Result<void> writable = check_patchable(scene); !writable) return forward_error(writable);
  try {
    return patch_document(source, scene, path, options);
  } catch (reading::Fault& fault) {
    Error& error = fault.error;
    error.where = error.where.empty() ? source.path : source.path + ": " + error.where;
    return tl::unexpected<Error>(std::move(error));
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::bad_input, source.path, "not enough memory for what the file holds");
  }
}

}  // namespace scenegen::gltf
