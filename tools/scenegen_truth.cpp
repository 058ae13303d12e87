// scenegen truth FILE -o OUT: which objects are visible when, for renderers that are measured elsewhere.
#include <algorithm>
#include <array>
#include <charconv>

#include "scene/gltf/read.h"
#include "scene/gltf/write_sink.h"
#include "scene/limits.h"
#include "timeline/player.h"
#include "tools/frame_times.h"
#include "tools/output.h"
#include "tools/read_gltf.h"
#include "tools/scenegen.h"
#include "tools/verb.h"

namespace scenegen::tools {
namespace {

struct TruthRequest {
  std::string file, output, times;
  std::uint32_t threads = 1;
  bool quiet = false;
};

/// What differs from the moment before; everything that is visible, at the first one.
struct Moment {
  double time_s = 0;
  std::size_t visible = 0;
  std::vector<std::uint32_t> appear, vanish;  ///< ascending
};

/// In the form of docs/GROUND_TRUTH.md; nothing of a moment is kept when it has been written.
class TruthWriter {
 public:
  TruthWriter(gltf::ByteSink& out, const TruthRequest& request, const Scene& scene)
      : out_(out), names_(scene.objects.names), json_(request.output.ends_with(".json")) {
    json_ ? begin_json(request.file, scene) : text("time_s,visible,change,object,name\n");
  }

  void write(const Moment& moment) {
    json_ ? write_json(moment) : write_csv(moment);
    first_ = false;
  }

  void end() {
    if (json_) text("\n  ]\n}\n");
    out_.flush();
  }

 private:
  static std::string quoted(const std::string& name) {
    return nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
  static std::string cell(std::string_view name) {
    if (name.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(name);
    std::string out = "\"";
    for (const char c : name) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
  }
  void text(std::string_view words) { out_.write(words.data(), words.size()); }
  /// Digits that give the same number again: a time of a key must not fall before it.
  template <class Number>
  void number(Number value) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    text({digits.data(), static_cast<std::size_t>(end - digits.data())});
  }

  void rows(const Moment& moment, std::string_view change, const std::vector<std::uint32_t>& objects) {
    for (const std::uint32_t object : objects) {
      number(moment.time_s);
      text(",");
      number(moment.visible);
      text(",");
      text(change);
      text(",");
      number(object);
      text(",");
      text(cell(names_[object]));
      text("\n");
    }
  }
  void write_csv(const Moment& moment) {
    rows(moment, "appear", moment.appear);
    rows(moment, "vanish", moment.vanish);
    if (!moment.appear.empty() || !moment.vanish.empty()) return;
    number(moment.time_s);
    text(",");
    number(moment.visible);
    text(",,,\n");
  }

  void begin_json(const std::string& file, const Scene& scene) {
    text("{\n  \"schema\": \"scenegen/truth\",\n  \"version\": 1,\n  \"file\": ");
    text(quoted(file));
    text(",\n  \"durationS\": ");
    number(static_cast<double>(scene.duration_s));
    text(",\n  \"objects\": [");
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
      text(i == 0 ? "\n    " : ",\n    ");
      text(quoted(std::string(names_[i])));
    }
    text("\n  ],\n  \"moments\": [");
  }

  void list(std::string_view name, const std::vector<std::uint32_t>& objects) {
    text(name);
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (i > 0) text(",");
      number(objects[i]);
    }
    text("]");
  }
  void write_json(const Moment& moment) {
    text(first_ ? "\n    {\"timeS\":" : ",\n    {\"timeS\":");
    number(moment.time_s);
    text(",\"visible\":");
    number(moment.visible);
    list(",\"appear\":[", moment.appear);
    list(",\"vanish\":[", moment.vanish);
    text("}");
  }

  gltf::ByteSink& out_;
  const NameTable& names_;
  bool json_;
  bool first_ = true;
};

/// Goes to moments; `next` makes the state of the moment the one that what follows is compared with.
class Changes {
 public:
  explicit Changes(const Scene& scene) : scene_(scene), player_(timeline::compile(scene)) {}

  [[nodiscard]] std::span<const float> event_times_s() const { return player_.timeline().event_times_s(); }
  const Moment& next(double time_s) {
    const timeline::ChangeSet& changes = player_.seek(time_s);
    moment_.time_s = time_s;
    moment_.visible = player_.visible_count();
    moment_.appear.clear();
    moment_.vanish.clear();
    if (first_) {
      for (std::uint32_t i = 0; i < scene_.objects.size(); ++i)
        if (player_.visible(ObjectId(i))) moment_.appear.push_back(i);
    } else {
      for (const ObjectId id : changes.shown) moment_.appear.push_back(id.value);
      for (const ObjectId id : changes.hidden) moment_.vanish.push_back(id.value);
      std::sort(moment_.appear.begin(), moment_.appear.end());
      std::sort(moment_.vanish.begin(), moment_.vanish.end());
    }
    first_ = false;
    return moment_;
  }

 private:
  const Scene& scene_;
  timeline::Player player_;
  Moment moment_;
  bool first_ = true;
};

struct Written {
  std::uint64_t moments = 0, changes = 0;
};

Written write_moments(const Scene& scene, const std::optional<std::vector<double>>& times_s,
                      TruthWriter& writer) {
  Changes changes(scene);
  Written written;
  const auto go_to = [&](double time_s, bool even_without_changes) {
    const Moment& moment = changes.next(time_s);
    const std::size_t count = moment.appear.size() + moment.vanish.size();
    if (count == 0 && !even_without_changes) return;
    writer.write(moment);
    ++written.moments;
    written.changes += count;
  };
  if (times_s) {
    for (const double time_s : *times_s) go_to(time_s, true);
  } else {
    go_to(0.0, true);
    for (const float time_s : changes.event_times_s())
      if (time_s > 0.0F) go_to(static_cast<double>(time_s), false);
  }
  writer.end();
  return written;
}

Result<void> save(const TruthRequest& r) {
  gltf::ReadOptions options;
  options.threads = r.threads;
  auto read = read_gltf(r.file, options);
  if (!read) return forward_error(read);
  const Scene& scene = read->scene;
  std::optional<std::vector<double>> times_s;
  if (!r.times.empty()) {
    const auto& calendar = scene.info.calendar;
    auto parsed =
        parse_times(r.times, static_cast<double>(scene.duration_s), calendar ? &*calendar : nullptr);
    if (!parsed) {
      parsed.error().where = "--times";
      return forward_error(parsed);
    }
    times_s = std::move(*parsed);
  }
  auto file = gltf::OutputFile::open(r.output);
  if (!file) return forward_error(file);
  const gltf::BlockSigpipe block;
  gltf::ByteSink sink(file->descriptor());
  TruthWriter writer(sink, r, scene);
  const Written written = write_moments(scene, times_s, writer);
  if (sink.failed()) return file->error(sink.error());
  if (auto closed = file->close(); !closed) return closed;
  if (auto committed = file->commit(); !committed) return committed;
  if (r.quiet || r.output == "-") return {};
  return write_stdout(r.output + "  " + human_bytes(sink.total()) + "  " +
                      counted(scene.objects.size(), "object") + "  " + counted(written.moments, "moment") +
                      "  " + counted(written.changes, "change") + "\n");
}

}  // namespace

int truth_verb(std::span<const std::string> arguments) {
  TruthRequest r;
  Options options("scenegen truth", {"scenegen truth FILE -o OUT.csv"},
                  "writes which objects are visible when: what a renderer must show that is measured "
                  "elsewhere (docs/GROUND_TRUTH.md).");
  options.positional("FILE", r.file, "a .glb or .gltf file (- is stdin)");
  options.group("Output");
  options.add("-o,--output", text_value(r.output, "FILE"), ".csv or .json; - for CSV on stdout");
  options.add("--times", text_value(r.times, "LIST", "as of sceneplay frames"),
              "these moments, each against the one before, instead of all at which something appears or "
              "vanishes");
  options.group("General");
  options.add("--threads", whole_value<std::uint32_t>(r.threads, 1, limits::kMaxThreads), "threads to use");
  options.add_general(r.quiet);
  const auto check = [&]() -> Result<void> {
    if (r.output.empty())
      return fail(ErrorKind::usage, "--output", "missing (usage: scenegen truth FILE -o OUT.csv)");
    if (r.output != "-" && !r.output.ends_with(".csv") && !r.output.ends_with(".json"))
      return fail(ErrorKind::usage, "--output",
                  "'" + r.output + "'; a name that ends in .csv or .json, or -");
    if (auto writable = r.output == "-" ? Result<void>() : check_output_file(r.output); !writable)
      return writable;
    return check_distinct_files({{"--output", r.output}}, {{"FILE", r.file}});
  };
  return run_verb(options, arguments, {.check = check, .work = [&]() -> Result<int> {
                                         auto saved = save(r);
                                         return saved ? Result<int>(0) : forward_error(saved);
                                       }});
}

}  // namespace scenegen::tools
