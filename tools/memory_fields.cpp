#include "tools/memory_fields.h"

#include <algorithm>

#include "tools/output.h"
#include "tools/text.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;
using render::MemoryAccount;
using render::MemoryShare;

ordered_json megabytes(std::uint64_t bytes) {
  return bytes == 0 ? ordered_json() : ordered_json(static_cast<double>(bytes) * 1e-6);
}

}  // namespace

ordered_json memory_json(const MemoryAccount& account) {
  ordered_json kinds;
  for (std::size_t i = 0; i < render::kMemoryKinds; ++i) {
    const MemoryShare& share = account.kinds[i];
    kinds[std::string(render::kMemoryKindNames[i])] = {
        {"hostBytes", share.host}, {"deviceBytes", share.device}, {"spilledBytes", share.spilled}};
  }
  ordered_json out{{"memory", std::move(kinds)},
                   {"ownBytes", account.own_bytes()},
                   {"bytesPerObject", account.bytes_per_object()},
                   {"commandMemory", nullptr}};
  const render::CommandMemoryReport& commands = account.commands;
  if (commands.buffers == 0) return out;
  out["commandMemory"] = {
      {"buffers", commands.buffers},
      {"draws", commands.draws},
      {"predictedBytes", commands.predicted},
      {"measuredBytes", commands.measured > 0 ? ordered_json(commands.measured) : ordered_json()},
      {"driverBytes", commands.driver},
      {"processBytes", commands.process}};
  return out;
}

std::string memory_table(const MemoryAccount& account) {
  Table table(
      {{"kind", "memory"}, {"hostMb", "host MB"}, {"deviceMb", "device MB"}, {"each", "B an object"}});
  const double objects = std::max(1.0, static_cast<double>(account.objects));
  for (std::size_t i = 0; i < render::kMemoryKinds; ++i) {
    const MemoryShare& share = account.kinds[i];
    if (share.total() == 0) continue;
    std::string name(render::kMemoryKindNames[i]);
    if (share.spilled > 0) name += " (" + human_bytes(share.spilled) + " did not fit the device)";
    const bool own = render::is_own(static_cast<render::MemoryKind>(i));
    table.row({name, megabytes(share.host), megabytes(share.device),
               own ? ordered_json(static_cast<double>(share.total()) / objects) : ordered_json()});
  }
  table.row({"all but geometry, textures, pictures", nullptr, nullptr, account.bytes_per_object()});
  std::string out = table.str(Format::table);
  const render::CommandMemoryReport& commands = account.commands;
  if (commands.buffers == 0) return out;
  out += "driver, for " + human_count(commands.buffers) + " kept command buffers with " +
         human_count(commands.draws) + " draws: ";
  out += commands.measured > 0 ? human_bytes(commands.measured) : "not known";
  return out + " (the model says " + human_bytes(static_cast<std::uint64_t>(commands.predicted)) + ")\n";
}

}  // namespace scenegen::tools
