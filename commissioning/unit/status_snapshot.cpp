#include "commissioning/unit/status_snapshot.hpp"

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "commissioning/unit/status_view.hpp"
#include "commissioning/unit/transfer.hpp"
#include "core/memory_image.hpp"
#include "protocol/registers/register_map.hpp"
#include "protocol/registers/unit_registers.hpp"

namespace ecs::commissioning {
namespace {

using protocol::Block;
using protocol::Registers;

constexpr int kFormat = 1;
constexpr std::uint16_t kIdentityOfProtocol1 = 32;  ///< registers; what was added behind them reads as not known

Result<void> decode(StatusSnapshot& snapshot) {
  ECS_TRY(identity, protocol::identity_in(snapshot.identity_registers));
  ECS_TRY(status, protocol::status_in(snapshot.status_registers));
  snapshot.identity = identity;
  snapshot.status = status;
  for (const Registers& block : snapshot.event_blocks) {
    ECS_TRY(page, protocol::event_page_in(block));
    for (const protocol::HostEvent& event : page.events)
      if (event.number != 0) snapshot.events.push_back(event);
  }
  return protocol::take_pointers(snapshot.pointer_registers, snapshot.status);
}

/// The value at a pointer; nothing if no table of the image holds that address.
std::optional<SelectedValue> value_at(protocol::UnitClient& client, ByteView head, Address bank, std::size_t curve,
                                      Address address) {
  const ImageView image(head);
  const std::uint32_t tables = std::min(image.table_count(), kMostTables);
  for (std::uint32_t i = 0; i < tables && directory_offset(image.format()) + (i + 1) * kEntryBytes <= head.size();
       ++i) {
    const TableEntry entry = image.entry(i);
    if (index_of(entry.component) != curve || entry.declared_zero) continue;
    const Address first = bank + image.value_offset(entry.first_value);
    if (address < first || address >= first + 2 * entry.count) continue;
    const auto bytes = client.read_memory(address, 2);
    if (!bytes) return std::nullopt;
    const auto counts = static_cast<std::int16_t>(load_big<std::uint16_t>(*bytes, 0));
    return SelectedValue{counts, counts * entry.resolution};
  }
  return std::nullopt;
}

void read_selected(protocol::UnitClient& client, StatusSnapshot& snapshot) {
  const protocol::UnitStatus& status = snapshot.status;
  constexpr std::uint32_t kHeadBytes = directory_offset() + kMostTables * kEntryBytes;
  if (status.active_bank == protocol::Bank::none ||
      status.image_length_bytes < directory_offset(kFormatWithoutIdentity))
    return;
  const Address bank = address_of(status.active_bank);
  std::optional<std::vector<std::uint8_t>> head;
  for (std::size_t curve = 0; curve < kCurves; ++curve) {
    const Address address = status.pointers[curve].address;
    if (address == protocol::kUnused) continue;
    if (!head) {
      auto bytes = client.read_memory(bank, std::min(kHeadBytes, status.image_length_bytes));
      if (!bytes || load_big<std::uint32_t>(*bytes, prefix_at::magic) != kImageMagic) return;
      head = std::move(*bytes);
    }
    snapshot.selected[curve] = value_at(client, *head, bank, curve, address);
  }
}

/// Empty: it is no list of so many registers.
Registers registers_in(const Json& list, const Block& block) {
  Registers registers;
  if (!list.is_array() || list.size() != block.count) return registers;
  for (const Json& word : list) {
    if (!word.is_number_unsigned() || word.get<std::uint64_t>() > 0xFFFF) return {};
    registers.push_back(word.get<std::uint16_t>());
  }
  return registers;
}

Result<Registers> registers_at(const Json& raw, const char* key, const Block& block, const std::string& name) {
  const auto found = raw.find(key);
  Registers registers = found == raw.end() ? Registers() : registers_in(*found, block);
  const bool is_older = registers.empty() && block == protocol::kIdentity && found != raw.end();
  if (is_older) registers = registers_in(*found, {block.first, kIdentityOfProtocol1});
  if (is_older && !registers.empty()) registers.resize(block.count, 0);
  if (registers.size() == block.count) return registers;
  return problem_at(name, 0, 0, fmt::format("raw.{}: expected {} registers of 0 to 65535", key, block.count));
}

/// Files of before have no events.
Result<std::vector<Registers>> event_blocks_in(const Json& raw, const std::string& name) {
  std::vector<Registers> blocks;
  const auto list = raw.find("events");
  if (list == raw.end() || !list->is_array()) return blocks;
  for (const Json& one : *list) {
    blocks.push_back(registers_in(one, protocol::kEvents));
    if (blocks.back().size() != protocol::kEvents.count)
      return problem_at(
          name, 0, 0, fmt::format("raw.events: expected lists of {} registers of 0 to 65535", protocol::kEvents.count));
  }
  return blocks;
}

void take_selected(const Json& raw, StatusSnapshot& snapshot) {
  const auto list = raw.find("selected");
  if (list == raw.end() || !list->is_array() || list->size() != kCurves) return;
  for (std::size_t i = 0; i < kCurves; ++i) {
    const Json& one = (*list)[i];
    if (!one.is_array() || one.size() != 2 || !one[0].is_number_integer() || !one[1].is_number()) continue;
    snapshot.selected[i] = SelectedValue{one[0].get<std::int16_t>(), one[1].get<double>()};
  }
}

Json raw_json(const StatusSnapshot& snapshot) {
  Json selected = Json::array();
  for (const auto& value : snapshot.selected)
    selected.push_back(value ? Json::array({value->counts, number_or_null(value->value)}) : Json(nullptr));
  return Json{{"identity", snapshot.identity_registers},
              {"status", snapshot.status_registers},
              {"pointers", snapshot.pointer_registers},
              {"selected", selected},
              {"events", snapshot.event_blocks}};
}

std::string text_at(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

Result<StatusSnapshot> take_snapshot(protocol::UnitClient& client, const std::string& link, std::size_t events) {
  StatusSnapshot snapshot;
  snapshot.taken = now_utc();
  snapshot.link = link;
  const auto read = [&client](const Block& block) { return client.link().ask(protocol::kEcho, Registers{0}, block); };
  for (const auto& [block, into] : {std::pair{protocol::kIdentity, &snapshot.identity_registers},
                                    std::pair{protocol::kStatus, &snapshot.status_registers},
                                    std::pair{protocol::kPointers, &snapshot.pointer_registers}}) {
    ECS_TRY(registers, read(block));
    *into = std::move(registers);
  }
  ECS_TRY(blocks, client.event_blocks(events));
  snapshot.event_blocks = std::move(blocks);
  ECS_DO(decode(snapshot));
  read_selected(client, snapshot);
  return snapshot;
}

Json json_with_registers(const StatusSnapshot& snapshot) {
  Json object{{"ecs_status", kFormat}};
  object.update(status_cell(snapshot).json);
  object["raw"] = raw_json(snapshot);
  return object;
}

Result<void> write_snapshot(const std::filesystem::path& path, const StatusSnapshot& snapshot) {
  return write_file(path, json_with_registers(snapshot).dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

Result<StatusSnapshot> parse_snapshot(std::string_view text, const std::string& name) {
  if (auto why = why_no_text(text, name)) return tl::unexpected(std::move(*why));
  const Json object = Json::parse(text, nullptr, false);
  if (object.is_discarded() || !object.is_object() || !object.contains("ecs_status"))
    return problem_at(name, 0, 0, "expected a status file as `ecs utility status --save` writes it (JSON)");
  if (object["ecs_status"] != kFormat)
    return problem_at(name, 0, 0,
                      fmt::format("expected a status file of format {}, found format {}: use a newer ecs", kFormat,
                                  one_line(object["ecs_status"])));
  const auto raw = object.find("raw");
  if (raw == object.end() || !raw->is_object()) return problem_at(name, 0, 0, "expected the registers under \"raw\"");
  StatusSnapshot snapshot;
  snapshot.taken = text_at(object, "taken");
  snapshot.link = text_at(object, "link");
  for (const auto& [key, block, into] : {std::tuple{"identity", protocol::kIdentity, &snapshot.identity_registers},
                                         std::tuple{"status", protocol::kStatus, &snapshot.status_registers},
                                         std::tuple{"pointers", protocol::kPointers, &snapshot.pointer_registers}}) {
    ECS_TRY(registers, registers_at(*raw, key, block, name));
    *into = std::move(registers);
  }
  ECS_TRY(blocks, event_blocks_in(*raw, name));
  snapshot.event_blocks = std::move(blocks);
  if (const auto decoded = decode(snapshot); !decoded) return problem_at(name, 0, 0, decoded.error().message);
  take_selected(*raw, snapshot);
  return snapshot;
}

Result<StatusSnapshot> read_snapshot(const std::filesystem::path& path) {
  ECS_TRY(text, read_file(path));
  return parse_snapshot(text, path.string());
}

}  // namespace ecs::commissioning
