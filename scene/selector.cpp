#include "scene/selector.h"

#include <re2/re2.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <span>

#include "scene/glob.h"
#include "scene/gltf/source_nodes.h"

namespace scenegen {

using gltf::SourceNodes;

// ---- ObjectFacts

struct ObjectFacts::State {
  const Scene* scene = nullptr;
  std::vector<std::uint32_t> node_of_object;
  SourceNodes nodes;
  std::vector<std::uint32_t> first_extra;  ///< by node, one more: into nodes.extras
  std::vector<bool> path_is_guid;          ///< by nodes.paths

  // Nodes in the order of a walk, parents before children: a subtree is a range of places, and so of objects.
  std::vector<std::uint32_t> place, place_end;  ///< by node
  std::vector<std::uint32_t> first_object;      ///< by place, one more: into objects_by_place
  std::vector<std::uint32_t> objects_by_place;

  // Only after index(): ascending by text.
  std::vector<std::uint32_t> objects_by_name, nodes_by_name;
  std::vector<std::uint32_t> extras_by_text;  ///< by path, then text
  bool indexed = false;

  void walk();
  void place_objects();
  [[nodiscard]] std::string_view extra_text(std::uint32_t extra) const {
    return nodes.extra_texts[nodes.extras[extra].text];
  }
  template <class PathTest>
  [[nodiscard]] bool holds(std::uint32_t node, const PathTest& wanted) const {
    for (std::uint32_t e = first_extra[node]; e < first_extra[node + 1]; ++e) {
      if (wanted(nodes.extras[e].path)) return true;
    }
    return false;
  }
};

namespace {

/// Depth-first places of all nodes; `end` is behind the last node below.
void depth_first(const std::vector<std::uint32_t>& parent, std::vector<std::uint32_t>& place,
                 std::vector<std::uint32_t>& end) {
  const auto count = static_cast<std::uint32_t>(parent.size());
  std::vector<std::uint32_t> first(count + 1), children(count), roots;
  for (const std::uint32_t p : parent) {
    if (p != SourceNodes::kNone) ++first[p + 1];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> next = first;
  for (std::uint32_t node = 0; node < count; ++node) {
    if (parent[node] == SourceNodes::kNone) {
      roots.push_back(node);
    } else {
      children[next[parent[node]]++] = node;
    }
  }
  place.assign(count, 0);
  end.assign(count, 0);
  next.assign(first.begin(), first.end());
  std::uint32_t here = 0;
  std::vector<std::uint32_t> stack;
  for (const std::uint32_t root : roots) {
    stack.push_back(root);
    place[root] = here++;
    while (!stack.empty()) {
      const std::uint32_t node = stack.back();
      if (next[node] < first[node + 1]) {
        const std::uint32_t child = children[next[node]++];
        place[child] = here++;
        stack.push_back(child);
      } else {
        end[node] = here;
        stack.pop_back();
      }
    }
  }
}

bool is_guid_key(std::string_view key) {
  std::string plain;
  for (const char c : key.substr(0, 32)) {
    if (c != '_') plain += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return plain == "guid" || plain == "globalid" || plain == "ifcguid" || plain == "ifcglobalid";
}

/// The part of `sorted` whose texts begin with `prefix`.
template <class TextOf>
std::span<const std::uint32_t> with_prefix(std::span<const std::uint32_t> sorted, std::string_view prefix,
                                           const TextOf& text_of) {
  const auto begin = std::partition_point(sorted.begin(), sorted.end(),
                                          [&](std::uint32_t i) { return text_of(i) < prefix; });
  const auto end = std::partition_point(
      begin, sorted.end(), [&](std::uint32_t i) { return text_of(i).substr(0, prefix.size()) == prefix; });
  return sorted.subspan(static_cast<std::size_t>(begin - sorted.begin()),
                        static_cast<std::size_t>(end - begin));
}

}  // namespace

void ObjectFacts::State::walk() {
  depth_first(nodes.parent, place, place_end);
}

void ObjectFacts::State::place_objects() {
  first_object.assign(nodes.parent.size() + 1, 0);
  for (const std::uint32_t node : node_of_object) ++first_object[place[node] + 1];
  std::partial_sum(first_object.begin(), first_object.end(), first_object.begin());
  objects_by_place.resize(node_of_object.size());
  std::vector<std::uint32_t> next = first_object;
  for (std::uint32_t i = 0; i < node_of_object.size(); ++i)
    objects_by_place[next[place[node_of_object[i]]]++] = i;
}

ObjectFacts::ObjectFacts(std::unique_ptr<State> state) : state_(std::move(state)) {}
ObjectFacts::~ObjectFacts() = default;
ObjectFacts::ObjectFacts(ObjectFacts&&) noexcept = default;
ObjectFacts& ObjectFacts::operator=(ObjectFacts&&) noexcept = default;

Result<ObjectFacts> ObjectFacts::make(const Scene& scene, const gltf::SourceDocument& source) {
  auto nodes = gltf::read_source_nodes(source);
  if (!nodes) return forward_error(nodes);
  auto state = std::make_unique<State>();
  state->scene = &scene;
  state->node_of_object = source.node_of_object;
  state->nodes = std::move(*nodes);
  for (const std::uint32_t node : state->node_of_object) {
    if (node >= state->nodes.parent.size())
      return fail(ErrorKind::bad_input, source.path, "an object without a node in the document");
  }
  const auto count = static_cast<std::uint32_t>(state->nodes.parent.size());
  state->first_extra.assign(count + 1, 0);
  for (const SourceNodes::Extra& extra : state->nodes.extras) ++state->first_extra[extra.node + 1];
  std::partial_sum(state->first_extra.begin(), state->first_extra.end(), state->first_extra.begin());
  for (const SourceNodes::ExtraPath& path : state->nodes.paths)
    state->path_is_guid.push_back(is_guid_key(path.key));
  state->walk();
  state->place_objects();
  return ObjectFacts(std::move(state));
}

void ObjectFacts::index() {
  State& s = *state_;
  if (s.indexed) return;
  s.indexed = true;
  s.objects_by_name.resize(s.node_of_object.size());
  s.nodes_by_name.resize(s.nodes.parent.size());
  s.extras_by_text.resize(s.nodes.extras.size());
  for (auto* const list : {&s.objects_by_name, &s.nodes_by_name, &s.extras_by_text})
    std::iota(list->begin(), list->end(), 0U);
  const auto sort_by = [](std::vector<std::uint32_t>& list, const auto& key_of) {
    std::sort(list.begin(), list.end(), [&](std::uint32_t a, std::uint32_t b) {
      const auto ka = key_of(a), kb = key_of(b);
      return ka != kb ? ka < kb : a < b;
    });
  };
  sort_by(s.objects_by_name, [&](std::uint32_t i) { return s.scene->objects.names[i]; });
  sort_by(s.nodes_by_name, [&](std::uint32_t i) { return s.nodes.names[i]; });
  sort_by(s.extras_by_text,
          [&](std::uint32_t i) { return std::pair(s.nodes.extras[i].path, s.extra_text(i)); });
}

std::string_view ObjectFacts::guid(ObjectId object) const {
  const State& s = *state_;
  std::uint32_t node = s.node_of_object[object.value];
  for (; node != SourceNodes::kNone; node = s.nodes.parent[node]) {
    for (std::uint32_t e = s.first_extra[node]; e < s.first_extra[node + 1]; ++e) {
      if (s.path_is_guid[s.nodes.extras[e].path]) return s.extra_text(e);
    }
  }
  return {};
}

std::vector<ObjectId> ObjectFacts::in_order() const {
  return {state_->objects_by_place.begin(), state_->objects_by_place.end()};
}

std::vector<std::uint32_t> ObjectFacts::path(ObjectId object) const {
  std::vector<std::uint32_t> out;
  for (std::uint32_t node = state_->node_of_object[object.value]; node != SourceNodes::kNone;
       node = state_->nodes.parent[node])
    out.push_back(node);
  std::reverse(out.begin(), out.end());
  return out;
}

std::string_view ObjectFacts::node_name(std::uint32_t node) const {
  return state_->nodes.names[node];
}

std::vector<ObjectFacts::Extra> ObjectFacts::node_extras(std::uint32_t node) const {
  const State& s = *state_;
  std::vector<Extra> out;
  for (std::uint32_t e = s.first_extra[node]; e < s.first_extra[node + 1]; ++e) {
    const SourceNodes::ExtraPath* path = &s.nodes.paths[s.nodes.extras[e].path];
    std::string key = path->key;
    while (path->parent != SourceNodes::kNone) {
      path = &s.nodes.paths[path->parent];
      key.insert(0, path->key + ".");
    }
    out.push_back({std::move(key), s.extra_text(e)});
  }
  return out;
}

// ---- Selector

namespace {

using Kind = Selector::Kind;

/// A glob or a regular expression, and what its matches begin with.
struct Pattern {
  Glob glob = Glob::literal("");
  std::unique_ptr<RE2> expression;
  std::string prefix;

  [[nodiscard]] bool matches(std::string_view text) const {
    if (expression == nullptr) return glob.matches(text);
    return RE2::PartialMatch(re2::StringPiece(text.data(), text.size()), *expression);
  }
};

Pattern literal(std::string_view text) {
  return {Glob::literal(text), nullptr, std::string(text)};
}

constexpr std::size_t kMostPatternBytes = 4096;

Result<Pattern> parse_pattern(std::string_view text, bool expression) {
  Pattern out;
  if (!expression) {
    auto glob = Glob::parse(text);
    if (!glob) return forward_error(glob);
    out.prefix = glob->prefix();
    out.glob = std::move(*glob);
    return out;
  }
  RE2::Options options;
  options.set_log_errors(false);
  out.expression = std::make_unique<RE2>(re2::StringPiece(text.data(), text.size()), options);
  if (!out.expression->ok()) {
    return fail(ErrorKind::usage, "",
                "'" + std::string(text) + "' is no regular expression: " + out.expression->error());
  }
  // Matches of an expression that is surely anchored at the beginning lie in a range, which gives a prefix.
  const bool anchored = text.size() > 1 && text[0] == '^' && text.find('|') == std::string_view::npos &&
                        std::string_view("*+?{").find(text[1]) == std::string_view::npos;
  std::string low, high;
  if (anchored && out.expression->PossibleMatchRange(&low, &high, 64)) {
    const auto ends = std::mismatch(low.begin(), low.end(), high.begin(), high.end());
    out.prefix.assign(low.begin(), ends.first);
  }
  return out;
}

constexpr std::array<std::string_view, 3> kPlainKinds{"name", "material", "subtree"};
constexpr std::string_view kAllowed = "name, extras.KEY, material, subtree";

std::optional<Kind> kind_of(std::string_view word) {
  if (word == "name") return Kind::name;
  if (word == "material") return Kind::material;
  if (word == "subtree") return Kind::subtree;
  if (word.starts_with("extras.") && word.size() > 7) return Kind::extras;
  return std::nullopt;
}

/// The kind that shares the longest beginning with `word`: these words differ from the first letter on.
std::string suggestion(std::string_view word) {
  for (const std::string_view kind : kPlainKinds) {
    if (word.size() >= 2 && kind.starts_with(word.substr(0, 2)))
      return " (did you mean '" + std::string(kind) + "'? one of: " + std::string(kAllowed) + ")";
  }
  return " (one of: " + std::string(kAllowed) + ")";
}

}  // namespace

struct Selector::State {
  Kind kind = Kind::name;
  std::string key;  ///< of extras: "ifc.guid"
  Pattern pattern;

  void by_name(const ObjectFacts::State& facts, std::vector<ObjectId>& out) const;
  void by_extras(const ObjectFacts::State& facts, std::vector<ObjectId>& out) const;
  void by_material(const ObjectFacts::State& facts, std::vector<ObjectId>& out) const;
  void by_subtree(const ObjectFacts::State& facts, std::vector<ObjectId>& out) const;
  [[nodiscard]] std::vector<bool> wanted_paths(const SourceNodes& nodes) const;
  [[nodiscard]] std::vector<std::uint32_t> holders(const ObjectFacts::State& facts,
                                                   const std::vector<bool>& wanted) const;
};

void Selector::State::by_name(const ObjectFacts::State& facts, std::vector<ObjectId>& out) const {
  const NameTable& names = facts.scene->objects.names;
  const auto text_of = [&](std::uint32_t i) { return names[i]; };
  if (facts.indexed) {
    for (const std::uint32_t i : with_prefix(facts.objects_by_name, pattern.prefix, text_of)) {
      if (pattern.matches(names[i])) out.emplace_back(i);
    }
    return;
  }
  for (std::uint32_t i = 0; i < facts.node_of_object.size(); ++i) {
    if (pattern.matches(names[i])) out.emplace_back(i);
  }
}

/// Whether each path of extras is meant: its members joined by dots are `key`, or its last one is an
/// identifier.
std::vector<bool> Selector::State::wanted_paths(const SourceNodes& nodes) const {
  std::vector<bool> wanted(nodes.paths.size());
  for (std::uint32_t id = 0; id < wanted.size(); ++id) {
    std::string_view rest = key;
    for (std::uint32_t path = id;;) {  // from the last member to the first, so that keys may hold dots
      const SourceNodes::ExtraPath& p = nodes.paths[path];
      if (!rest.ends_with(p.key)) break;
      rest.remove_suffix(p.key.size());
      path = p.parent;
      if (path == SourceNodes::kNone) {
        wanted[id] = rest.empty();
        break;
      }
      if (!rest.ends_with('.')) break;
      rest.remove_suffix(1);
    }
  }
  return wanted;
}

/// Nodes whose extras have a matching value, ascending.
std::vector<std::uint32_t> Selector::State::holders(const ObjectFacts::State& facts,
                                                    const std::vector<bool>& wanted) const {
  std::vector<std::uint32_t> out;
  const auto& extras = facts.nodes.extras;
  const auto take = [&](std::uint32_t e) {
    if (pattern.matches(facts.extra_text(e))) out.push_back(extras[e].node);
  };
  if (!facts.indexed) {
    for (std::uint32_t e = 0; e < extras.size(); ++e) {
      if (wanted[extras[e].path]) take(e);
    }
  } else {
    for (std::uint32_t path = 0; path < wanted.size(); ++path) {
      if (!wanted[path]) continue;
      const auto of_path = [&](std::uint32_t e) { return extras[e].path < path; };
      const auto up_to_path = [&](std::uint32_t e) { return extras[e].path <= path; };
      const auto& all = facts.extras_by_text;
      const auto begin = std::partition_point(all.begin(), all.end(), of_path);
      const auto end = std::partition_point(begin, all.end(), up_to_path);
      const std::span<const std::uint32_t> here(begin, end);
      for (const std::uint32_t e :
           with_prefix(here, pattern.prefix, [&](auto i) { return facts.extra_text(i); }))
        take(e);
    }
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

void Selector::State::by_extras(const ObjectFacts::State& facts, std::vector<ObjectId>& out) const {
  const std::vector<bool> wanted = kind == Kind::guid ? facts.path_is_guid : wanted_paths(facts.nodes);
  const auto is_wanted = [&](std::uint32_t path) { return wanted[path]; };
  const std::vector<std::uint32_t> found = holders(facts, wanted);
  const auto each_object = [&](std::uint32_t node, const auto& f) {
    const std::uint32_t begin = facts.first_object[facts.place[node]];
    const std::uint32_t end = facts.first_object[facts.place_end[node]];
    for (std::uint32_t k = begin; k < end; ++k) f(facts.objects_by_place[k]);
  };
  for (const std::uint32_t node : found) {
    each_object(node, [&](std::uint32_t object) {
      std::uint32_t holder = facts.node_of_object[object];
      while (holder != node && !facts.holds(holder, is_wanted)) holder = facts.nodes.parent[holder];
      if (holder == node) out.emplace_back(object);
    });
  }
  if (kind != Kind::guid || !out.empty()) return;
  for (const std::uint32_t node : found)
    each_object(node, [&](std::uint32_t object) { out.emplace_back(object); });
}

void Selector::State::by_material(const ObjectFacts::State& facts, std::vector<ObjectId>& out) const {
  const Scene& scene = *facts.scene;
  std::vector<bool> material(scene.materials.size()), mesh(scene.meshes.size());
  for (std::size_t i = 0; i < material.size(); ++i) material[i] = pattern.matches(scene.materials[i].name);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const auto& primitives = scene.meshes[i].primitives;
    mesh[i] = std::any_of(primitives.begin(), primitives.end(), [&](const Primitive& p) {
      return p.material.valid() && material[p.material.value];
    });
  }
  for (std::uint32_t i = 0; i < facts.node_of_object.size(); ++i) {
    if (mesh[scene.objects.mesh[i].value]) out.emplace_back(i);
  }
}

void Selector::State::by_subtree(const ObjectFacts::State& facts, std::vector<ObjectId>& out) const {
  const NameTable& names = facts.nodes.names;
  const auto take = [&](std::uint32_t node) {
    if (names[node].empty() || !pattern.matches(names[node])) return;
    const std::uint32_t begin = facts.first_object[facts.place[node]];
    const std::uint32_t end = facts.first_object[facts.place_end[node]];
    for (std::uint32_t k = begin; k < end; ++k) out.emplace_back(facts.objects_by_place[k]);
  };
  if (facts.indexed) {
    const auto text_of = [&](std::uint32_t i) { return names[i]; };
    for (const std::uint32_t node : with_prefix(facts.nodes_by_name, pattern.prefix, text_of)) take(node);
  } else {
    for (std::uint32_t node = 0; node < names.size(); ++node) take(node);
  }
}

Selector::Selector(std::unique_ptr<State> state) : state_(std::move(state)) {}
Selector::~Selector() = default;
Selector::Selector(Selector&&) noexcept = default;
Selector& Selector::operator=(Selector&&) noexcept = default;

Result<Selector> Selector::parse(std::string_view text) {
  if (text.empty()) return fail(ErrorKind::usage, "", "a selector is empty");
  if (text.size() > kMostPatternBytes) {
    return fail(ErrorKind::usage, "",
                "a selector of " + std::to_string(text.size()) + " bytes; allowed up to " +
                    std::to_string(kMostPatternBytes));
  }
  auto state = std::make_unique<State>();
  std::string_view value = text;
  bool expression = false;
  const std::size_t tilde = text.find('~'), equals = text.find('=');
  if (tilde < equals && kind_of(text.substr(0, tilde))) {
    state->kind = *kind_of(text.substr(0, tilde));
    expression = true;
    if (state->kind == Kind::extras) state->key = text.substr(7, tilde - 7);
    value = text.substr(tilde + 1);
  } else if (equals != std::string_view::npos) {
    const std::string_view word = text.substr(0, equals);
    const std::optional<Kind> kind = kind_of(word);
    if (!kind)
      return fail(ErrorKind::usage, "", "unknown selector '" + std::string(word) + "'" + suggestion(word));
    state->kind = *kind;
    if (*kind == Kind::extras) state->key = word.substr(7);
    value = text.substr(equals + 1);
  }
  if (value.empty()) return fail(ErrorKind::usage, "", "'" + std::string(text) + "' has no value");
  auto pattern = parse_pattern(value, expression);
  if (!pattern) return forward_error(pattern);
  state->pattern = std::move(*pattern);
  return Selector(std::move(state));
}

Selector Selector::with_literal(Kind kind, std::string_view value) {
  auto state = std::make_unique<State>();
  state->kind = kind;
  state->pattern = literal(value);
  return Selector(std::move(state));
}

Selector Selector::with_name(std::string_view name) {
  return with_literal(Kind::name, name);
}

Selector Selector::with_guid(std::string_view guid) {
  return with_literal(Kind::guid, guid);
}

Selector Selector::with_extra(std::string_view key, std::string_view value) {
  Selector out = with_literal(Kind::extras, value);
  out.state_->key = key;
  return out;
}

Selector Selector::with_subtree(std::string_view node_name) {
  return with_literal(Kind::subtree, node_name);
}

Selector::Kind Selector::kind() const {
  return state_->kind;
}

bool Selector::is_literal() const {
  return state_->pattern.expression == nullptr && state_->pattern.glob.is_literal();
}

std::vector<ObjectId> Selector::select(const ObjectFacts& facts) const {
  std::vector<ObjectId> out;
  switch (state_->kind) {
    case Kind::name:
      state_->by_name(*facts.state_, out);
      break;
    case Kind::extras:
    case Kind::guid:
      state_->by_extras(*facts.state_, out);
      break;
    case Kind::material:
      state_->by_material(*facts.state_, out);
      break;
    case Kind::subtree:
      state_->by_subtree(*facts.state_, out);
      break;
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace scenegen
