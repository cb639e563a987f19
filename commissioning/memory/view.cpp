#include "commissioning/memory/view.hpp"

#include <fmt/format.h>

#include "base/json.hpp"
#include "base/text.hpp"
#include "commissioning/memory/fields.hpp"
#include "commissioning/unit/parameters_view.hpp"
#include "commissioning/unit/status_view.hpp"
#include "laser/map/error_map.hpp"

namespace ecs::commissioning {
namespace {

// --- JSON
Json commits_json(const DecodedMemory& memory) {
  Json out = Json::array();
  for (const CommitSlot& slot : memory.commits) {
    if (!memory.has_commits) break;
    const auto& commit = slot.commit;
    out.push_back({{"address", hex_address(slot.address)},
                   {"state", commit       ? "valid"
                             : slot.blank ? "blank"
                                          : "corrupt"},
                   {"active", slot.active},
                   {"sequence", commit ? Json(commit->sequence) : Json(nullptr)},
                   {"bank", commit ? Json(commit->bank == 0 ? "A" : "B") : Json(nullptr)},
                   {"image_bytes", commit ? Json(commit->image_bytes) : Json(nullptr)},
                   {"image_check", commit ? Json(fmt::format("{:08X}", commit->image_check)) : Json(nullptr)}});
  }
  return out;
}

Json table_json(const DecodedTable& table) {
  const bool has_values = !table.values.empty();
  return Json{{"component", table.known_codes ? Json(ecs::name_of(table.entry.component)) : Json(nullptr)},
              {"description", table.known_codes ? Json(laser::description_of(table.entry.component)) : Json(nullptr)},
              {"approach", table.known_codes ? Json(name_of(table.entry.approach)) : Json(nullptr)},
              {"declared_zero", table.entry.declared_zero},
              {"entry_address", hex_address(table.entry_address)},
              {"address", table.readable && has_values ? Json(hex_address(table.values_address)) : Json(nullptr)},
              {"start_mm", number_or_null(table.entry.start_mm)},
              {"increment_mm", number_or_null(table.entry.increment_mm)},
              {"count", table.entry.count},
              {"resolution", number_or_null(table.entry.resolution)},
              {"unit", table.known_codes ? Json(unit_of(table.entry.component)) : Json(nullptr)},
              {"least", has_values ? number_or_null(table.least) : Json(nullptr)},
              {"most", has_values ? number_or_null(table.most) : Json(nullptr)},
              {"fault", text_or_null(table.fault)}};
}

Json image_json(const DecodedImage& image) {
  Json tables = Json::array();
  for (const DecodedTable& table : image.tables) tables.push_back(table_json(table));
  return Json{{"region", image.region},
              {"address", hex_address(image.address)},
              {"active", image.active},
              {"bytes", image.bytes},
              {"sound", image.faults.empty()},
              {"faults", image.faults},
              {"block_check",
               {{"stored", fmt::format("{:08X}", image.verdict.check_expected)},
                {"computed", fmt::format("{:08X}", image.verdict.check_found)},
                {"agrees", image.verdict.check_expected == image.verdict.check_found}}},
              {"parameters", image.parameters ? json_of(*image.parameters) : Json(nullptr)},
              {"tables", tables},
              {"header", text_or_null(image.header)}};
}

Json regions_json(const MemoryDump& dump) {
  Json out = Json::array();
  for (const DumpRegion& region : dump.regions)
    out.push_back({{"name", region.name},
                   {"address", hex_address(region.address)},
                   {"bytes", region.bytes.size()},
                   {"expected_bytes", region.size},
                   {"intact", region.intact}});
  return out;
}

// --- text
std::string commits_text(const DecodedMemory& memory) {
  std::string text;
  for (const CommitSlot& slot : memory.commits) {
    if (!memory.has_commits) break;
    text += fmt::format("commit record {}: ", hex_address(slot.address));
    if (slot.commit)
      text += fmt::format("sequence {}, bank {}, {} bytes, block check {:08X}{}\n", slot.commit->sequence,
                          slot.commit->bank == 0 ? "A" : "B", slot.commit->image_bytes, slot.commit->image_check,
                          slot.active ? " (active)" : "");
    else
      text += slot.blank ? "blank\n" : "corrupt\n";
  }
  return text;
}

std::string tables_text(const DecodedImage& image) {
  if (image.tables.empty()) return "no tables\n";
  std::string text = " # component    address    start/mm incr./mm count     least      most unit\n";
  for (const DecodedTable& table : image.tables) {
    text += fmt::format("{:>2} {:<12} ", table.number, name_of(table));
    if (!table.fault.empty())
      text += fmt::format("{}: {}\n", hex_address(table.entry_address), table.fault);
    else if (table.entry.declared_zero)
      text += "declared zero\n";
    else
      text += fmt::format("{} {:>10} {:>8} {:>5} {:>9.2f} {:>9.2f} {}\n", hex_address(table.values_address),
                          table.entry.start_mm, table.entry.increment_mm, table.entry.count, table.least, table.most,
                          unit_of(table.entry.component));
  }
  return text;
}

std::string bytes_text(const DecodedImage& image, const MemoryDump& dump) {
  const DumpRegion* region = region_at(dump, image.address);
  if (region == nullptr) return {};
  std::string text = "address   bytes                    field                                      value\n";
  for (const ByteField& field : fields_of(image, *region)) {
    const std::size_t at = field.address - region->address;
    if (at + field.bytes > region->bytes.size()) break;
    const ByteView bytes = ByteView(region->bytes).subspan(at, field.bytes);
    text += fmt::format("{}  {:<24} {:<42} {}\n", hex_address(field.address), hex_of(bytes), field.name, field.value);
  }
  return text;
}

std::string image_text(const DecodedImage& image, const MemoryDump& dump, bool with_bytes) {
  std::string text = fmt::format("\n== {} at {}, {} bytes{}\n", image.region, hex_address(image.address), image.bytes,
                                 image.active ? ", active" : "");
  text += fmt::format("block check {:08X} stored, {:08X} computed: {}\n", image.verdict.check_expected,
                      image.verdict.check_found,
                      image.verdict.check_expected == image.verdict.check_found ? "they agree" : "they differ");
  for (const std::string& fault : image.faults) text += fmt::format("FAULT: {}\n", fault);
  if (with_bytes) text += "\n" + bytes_text(image, dump);
  if (image.parameters) text += "\n" + table_of(*image.parameters);
  text += "\n" + tables_text(image);
  if (!image.header.empty()) text += fmt::format("\nheader\n{}\n", image.header);
  return text;
}

}  // namespace

Json json_of(const MemoryDump& dump, const DecodedMemory& memory) {
  Json images = Json::array();
  for (const DecodedImage& image : memory.images) images.push_back(image_json(image));
  return Json{{"taken", text_or_null(dump.taken)},
              {"link", text_or_null(dump.link)},
              {"serial_number", text_or_null(dump.serial_number)},
              {"sound", memory.sound()},
              {"faults", memory.faults},
              {"regions", regions_json(dump)},
              {"commits", commits_json(memory)},
              {"images", images},
              {"status", dump.status ? json_of(*dump.status) : Json(nullptr)}};
}

std::string text_of(const MemoryDump& dump, const DecodedMemory& memory, bool with_bytes) {
  std::string text;
  if (!dump.taken.empty())
    text += fmt::format("unit {}, taken {}\nover {}\n", dump.serial_number, dump.taken, dump.link);
  for (const std::string& fault : memory.faults) text += fmt::format("FAULT: {}\n", fault);
  for (const DumpRegion& region : dump.regions)
    text += fmt::format("{}  {:>7} bytes  {}{}\n", hex_address(region.address), region.bytes.size(), region.name,
                        region.intact ? "" : " (damaged)");
  text += commits_text(memory);
  for (const DecodedImage& image : memory.images) text += image_text(image, dump, with_bytes);
  if (memory.images.empty()) text += "no memory image\n";
  if (dump.status) text += "\n== status when it was taken\n" + text_of(*dump.status);
  return text;
}

}  // namespace ecs::commissioning
