#include "timeline/compare.h"

#include <string_view>
#include <unordered_map>
#include <utility>

#include "timeline/compare_report.h"
#include "timeline/compare_sweep.h"

namespace scenegen::timeline {

namespace {

/// By name. Where all names stand at equal indices nothing is stored; only the others go into a hash map.
Matching match_objects(const Scene& a, const Scene& b) {
  Matching out;
  if (a.objects.names == b.objects.names) return out;
  const NameTable& names_a = a.objects.names;
  const NameTable& names_b = b.objects.names;
  out.b_of_a.assign(names_a.size(), Matching::kNone);
  out.a_of_b.assign(names_b.size(), Matching::kNone);
  const auto join = [&](std::uint32_t in_a, std::uint32_t in_b) {
    out.b_of_a[in_a] = in_b;
    out.a_of_b[in_b] = in_a;
  };
  std::unordered_map<std::string_view, std::uint32_t> others;
  for (std::uint32_t i = 0; i < names_b.size(); ++i) {
    if (i < names_a.size() && names_a[i] == names_b[i]) {
      join(i, i);
    } else {
      others.emplace(names_b[i], i);
    }
  }
  for (std::uint32_t i = 0; i < names_a.size(); ++i) {
    if (out.b_of_a[i] != Matching::kNone) continue;
    if (const auto found = others.find(names_a[i]); found != others.end()) join(i, found->second);
  }
  return out;
}

void report_objects(const Scene& a, const Scene& b, const Matching& objects, DifferenceList& differences) {
  std::uint64_t displaced = 0;
  std::uint32_t first = 0;
  std::uint32_t last = 0;
  for (std::uint32_t i = 0; i < objects.b_of_a.size(); ++i) {
    const std::uint32_t in_b = objects.b_of_a[i];
    if (in_b == Matching::kNone) {
      differences.add([&] { return std::string(a.objects.names[i]); }, [] { return "only in A"; });
      continue;
    }
    if (in_b < last && displaced++ == 0) first = i;
    last = std::max(last, in_b);
  }
  for (std::uint32_t i = 0; i < objects.a_of_b.size(); ++i) {
    if (objects.a_of_b[i] != Matching::kNone) continue;
    differences.add([&] { return std::string(b.objects.names[i]); }, [] { return "only in B"; });
  }
  if (displaced == 0) return;
  differences.add_text("objects", text(displaced) +
                                      " in another order: " + std::string(a.objects.names[first]) +
                                      a_and_b(" is number", text(first), text(objects.b_of_a[first])));
}

/// By name; the n-th camera of a name with the n-th.
Matching match_cameras(const Scene& a, const Scene& b) {
  Matching out;
  out.b_of_a.assign(a.cameras.size(), Matching::kNone);
  out.a_of_b.assign(b.cameras.size(), Matching::kNone);
  std::unordered_map<std::string_view, std::vector<std::uint32_t>> by_name;
  for (std::size_t i = b.cameras.size(); i-- > 0;) {
    by_name[b.cameras[i].name].push_back(static_cast<std::uint32_t>(i));
  }
  for (std::uint32_t i = 0; i < a.cameras.size(); ++i) {
    const auto found = by_name.find(a.cameras[i].name);
    if (found == by_name.end() || found->second.empty()) continue;
    out.b_of_a[i] = found->second.back();
    out.a_of_b[found->second.back()] = i;
    found->second.pop_back();
  }
  return out;
}

std::string lens_difference(const Camera& a, const Camera& b) {
  if (a.orthographic != b.orthographic)
    return a.orthographic ? "orthographic in A only" : "orthographic in B only";
  const auto number = [](const char* name, float in_a, float in_b) {
    return in_a == in_b ? std::string() : a_and_b(name, text(in_a), text(in_b));
  };
  for (std::string difference : {a.orthographic ? number("half width", a.xmag_m, b.xmag_m) : std::string(),
                                 a.orthographic ? number("half height", a.ymag_m, b.ymag_m) : std::string(),
                                 a.orthographic ? std::string() : number("yfov", a.yfov_rad, b.yfov_rad),
                                 number("znear", a.znear_m, b.znear_m), number("zfar", a.zfar_m, b.zfar_m)}) {
    if (!difference.empty()) return difference;
  }
  return {};
}

void report_cameras(const Scene& a, const Scene& b, const Matching& cameras, DifferenceList& differences) {
  const auto named = [](const Camera& c) { return "camera '" + c.name + "'"; };
  for (std::size_t i = 0; i < a.cameras.size(); ++i) {
    if (cameras.b_of_a[i] == Matching::kNone) {
      differences.add_text(named(a.cameras[i]), "only in A");
      continue;
    }
    const std::string difference = lens_difference(a.cameras[i], b.cameras[cameras.b_of_a[i]]);
    if (!difference.empty()) differences.add_text(named(a.cameras[i]), difference);
  }
  for (std::size_t i = 0; i < b.cameras.size(); ++i) {
    if (cameras.a_of_b[i] == Matching::kNone) differences.add_text(named(b.cameras[i]), "only in B");
  }
}

}  // namespace

Comparison compare(const Scene& a, const Scene& b, const CompareOptions& options) {
  Comparison out;
  DifferenceList differences(out, options.most);
  const Matching objects = match_objects(a, b);
  report_objects(a, b, objects, differences);
  const Matching cameras = match_cameras(a, b);
  report_cameras(a, b, cameras, differences);
  if (a.duration_s != b.duration_s) {
    differences.add_text("duration", a_and_b("", text(a.duration_s) + " s", text(b.duration_s) + " s"));
  }
  Sweep(a, b, objects, cameras, options, out).run();
  return out;
}

}  // namespace scenegen::timeline
