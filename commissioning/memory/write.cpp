#include "commissioning/memory/write.hpp"

#include <fmt/format.h>

#include "base/json.hpp"
#include "commissioning/memory/names.hpp"
#include "commissioning/session/records.hpp"
#include "core/fault.hpp"

namespace ecs::commissioning {
namespace {

/// Why the host may not write there, and what does instead.
std::string_view reason_of(const MemoryRegion& region) {
  if (region.first == kEprom.first) return "it holds the unit's program and cannot be changed over the link";
  if (region.first == kCommitRecords.first)
    return "only the unit writes there, when it takes over a map; `map send` and `memory load` lead to that";
  if (in_axis_memory(region.first))
    return "parameters and maps are written whole, beside the active ones; use `params send`, `map send` or `memory "
           "load`";
  return "the host may not write there";
}

/// Of bytes in the unit's memory; where writing failed perhaps a part of them is there.
void record_write(const std::string& serial_number, Address address, ByteView bytes, const Result<void>& written) {
  const std::string place = hex_address(address);
  Json content{{"direction", "to the unit"}, {"address", place}, {"bytes", bytes.size()}};
  if (!written) content["problem"] = to_text(written.error());
  record({.kind = "memory write",
          .serial_number = serial_number,
          .summary = written ? fmt::format("{} bytes written from {} on", bytes.size(), place)
                             : fmt::format("not confirmed: {} bytes from {} on: {}", bytes.size(), place,
                                           to_text(written.error())),
          .content = one_line(content),
          .files = {{"memory", place, std::make_shared<const std::string>(bytes.begin(), bytes.end())}}});
}

}  // namespace

std::string short_hex(ByteView bytes, std::size_t most) {
  if (bytes.size() <= most) return hex_of(bytes);
  return fmt::format("{} ... ({} bytes)", hex_of(bytes.first(most)), bytes.size());
}

Result<void> may_write(const MemoryBytes& memory, Address address, std::size_t bytes) {
  const MemoryRegion* region = memory.region_of(address);
  if (region == nullptr)
    return problem(ProblemKind::refused, fmt::format("the unit has no memory at {}", hex_address(address)));
  if (!region->writable)
    return problem(ProblemKind::refused, fmt::format("{} is protected: {}", region->name, reason_of(*region)));
  if (address - region->first + bytes > region->size)
    return problem(ProblemKind::refused, fmt::format("{} bytes from {} go beyond {}, which ends at {}", bytes,
                                                     hex_address(address), region->name, hex_address(region->last())));
  return {};
}

Result<void> may_write_in(UnitMode mode) {
  if (mode == UnitMode::integration) return {};
  return problem(ProblemKind::refused, fmt::format("the unit is {}: it lets memory be written in integration mode "
                                                   "only; ECS UTILITY, `utility mode integrate` first",
                                                   ecs::name_of(mode)));
}

Result<void> write_logged(protocol::UnitClient& client, const std::string& serial_number, Address address,
                          ByteView bytes, const protocol::ProgressCallback& progress) {
  auto written = client.write_memory(address, bytes, progress);
  const bool may_be_part = written || written.error().kind == ProblemKind::link;
  if (may_be_part) record_write(serial_number, address, bytes, written);
  return written;
}

Result<void> write_checked(protocol::UnitClient& client, const std::string& serial_number, const ByteWrite& write) {
  ECS_TRY(identity, client.identity());
  if (identity.serial_number != serial_number)
    return problem(ProblemKind::refused,
                   fmt::format("unit {} answers now, the bytes were of unit {}; nothing was written",
                               identity.serial_number, serial_number));
  ECS_TRY(status, client.status());
  if (const auto may = may_write_in(status.mode); !may) return may;
  ECS_TRY(present, client.read_memory(write.address, write.after.size()));
  if (present != write.before)
    return problem(ProblemKind::refused,
                   fmt::format("{} holds {} now, not the bytes that were shown; nothing was written, look again",
                               hex_address(write.address), short_hex(present)));
  if (auto written = write_logged(client, serial_number, write.address, write.after); !written) return written;
  ECS_TRY(back, client.read_memory(write.address, write.after.size()));
  if (back == write.after) return {};
  return problem(ProblemKind::link, fmt::format("{} holds {} after writing {}: run the RAM test",
                                                hex_address(write.address), short_hex(back), short_hex(write.after)));
}

}  // namespace ecs::commissioning
