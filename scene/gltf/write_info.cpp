#include "scene/gltf/write_info.h"

#include "scene/gltf/write_calendar.h"

namespace scenegen::gltf {

namespace {

std::string_view name_of(VisibilityEncoding encoding) {
  switch (encoding) {
    case VisibilityEncoding::scale:
      return "scale";
    case VisibilityEncoding::pointer:
      return "pointer";
    case VisibilityEncoding::both:
      return "both";
  }
  return "scale";
}

void emit_appearance(const AppearanceInfo& a, TextOut& out) {
  const auto text = [&](std::string_view key, std::string_view value) {
    out.raw(key);
    out.string(value);
  };
  const auto value = [&](std::string_view key, auto number) {
    out.raw(key);
    out.number(number);
  };
  text(R"(,"appearance":{"curve":)", a.curve);
  text(R"(,"curveVariant":)", a.curve_variant);
  text(R"(,"order":)", a.order);
  value(R"(,"cells":[)", a.cells.x);
  value(",", a.cells.y);
  value(",", a.cells.z);
  out.raw(R"(],"gridMinZUp":)");
  out.numbers(a.grid_z_up_m.lo);
  out.raw(R"(,"gridMaxZUp":)");
  out.numbers(a.grid_z_up_m.hi);
  value(R"(,"interval":)", a.interval_s);
  value(R"(,"hold":)", a.hold_s);
  value(R"(,"coherence":)", a.coherence_given);
  value(R"(,"coherenceMeasured":)", a.coherence_measured);
  value(R"(,"displaced":)", a.displaced_objects);
  value(R"(,"timed":)", a.timed_objects);
  value(R"(,"moments":)", a.moments);
  value(R"(,"locality":)", a.locality_cells);
  out.raw("}");
}

}  // namespace

void emit_scenegen(const Scene& scene, const FileInfo& file, TextOut& out) {
  const SceneInfo& info = scene.info;
  out.raw(R"({"format":1,"version":")" SCENEGEN_VERSION "\"");
  if (file.source_generator.data() != nullptr) {
    out.raw(R"(,"source":{"generator":)");
    out.string(file.source_generator);
    out.raw("}");
  }
  if (info.seed) {
    out.raw(R"(,"seed":)");
    out.number(*info.seed);
  }
  out.raw(R"(,"arguments":[)");
  Commas commas(out);
  for (const std::string& argument : info.arguments) commas.next().string(argument);
  out.raw(R"(],"objects":)");
  out.number(scene.objects.size());
  out.raw(R"(,"layout":")");
  out.raw(file.layout);
  out.raw(R"(","visibility":")");
  out.raw(name_of(file.visibility));
  out.raw(R"(","time":{"unit":"s","start":0,"end":)");
  out.number(scene.duration_s);
  out.raw("}");
  if (info.appearance) emit_appearance(*info.appearance, out);
  if (info.calendar) emit_calendar(*info.calendar, out);
  out.raw("}");
}

void emit_transform(const Transform& transform, TextOut& out) {
  if (transform.translation_m != glm::vec3(0.0F)) {
    out.raw(R"(,"translation":)");
    out.numbers(transform.translation_m);
  }
  if (transform.rotation != glm::quat(1.0F, 0.0F, 0.0F, 0.0F)) {
    out.raw(R"(,"rotation":)");
    out.numbers(transform.rotation);
  }
  if (transform.scale != glm::vec3(1.0F)) {
    out.raw(R"(,"scale":)");
    out.numbers(transform.scale);
  }
}

void emit_sampler(std::uint32_t input, std::uint32_t output, Interpolation interpolation, TextOut& out) {
  out.raw(R"({"input":)");
  out.number(input);
  out.raw(R"(,"output":)");
  out.number(output);
  switch (interpolation) {
    case Interpolation::step:
      out.raw(R"(,"interpolation":"STEP"})");
      break;
    case Interpolation::linear:
      out.raw(R"(,"interpolation":"LINEAR"})");
      break;
    case Interpolation::cubic_spline:
      out.raw(R"(,"interpolation":"CUBICSPLINE"})");
      break;
  }
}

std::string_view path_of(Property property) {
  switch (property) {
    case Property::translation:
      return "translation";
    case Property::rotation:
      return "rotation";
    default:
      return "scale";
  }
}

void ChannelText::open(std::uint32_t sampler) {
  commas_.next().raw(R"({"sampler":)");
  out_.number(sampler);
  out_.raw(R"(,"target":{)");
}

void ChannelText::node(std::uint32_t sampler, std::uint32_t node, std::string_view path) {
  open(sampler);
  out_.raw(R"("node":)");
  out_.number(node);
  out_.raw(R"(,"path":")");
  out_.raw(path);
  out_.raw("\"}}");
}

void ChannelText::pointer(std::uint32_t sampler, std::string_view list, std::uint32_t index,
                          std::string_view rest) {
  open(sampler);
  out_.raw(R"("path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":")");
  out_.raw(list);
  out_.number(index);
  out_.raw(rest);
  out_.raw("\"}}}}");
}

}  // namespace scenegen::gltf
