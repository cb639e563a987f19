#include "commissioning/memory/view.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/memory/names.hpp"
#include "commissioning/unit/status.hpp"
#include "laser/map/error_map.hpp"

namespace ecs::commissioning {
namespace {

Cell hex_cell(std::uint32_t number) { return word_cell(fmt::format("{:08X}", number)); }

Cell regions_cell(const MemoryDump& dump) {
  Cell regions{Json::array(), {}};
  for (const DumpRegion& region : dump.regions)
    regions.add(record_cell("{address}  {bytes:>7} bytes  {name}{intact}\n",
                            {{"name", word_cell(region.name)},
                             {"address", word_cell(hex_address(region.address))},
                             {"bytes", count_cell(region.bytes.size())},
                             {"expected_bytes", count_cell(region.size)},
                             {"intact", yes_cell(region.intact, "", " (damaged)")}}));
  return regions;
}

Cell commit_cell(const CommitSlot& slot) {
  const auto& commit = slot.commit;
  const std::string_view state = commit ? "valid" : (slot.blank ? "blank" : "corrupt");
  return record_cell(commit ? "commit record {address}: sequence {sequence}, bank {bank}, {image_bytes} bytes, block "
                              "check {image_check}{active}\n"
                            : "commit record {address}: {state}\n",
                     {{"address", word_cell(hex_address(slot.address))},
                      {"state", word_cell(state)},
                      {"active", yes_cell(slot.active, " (active)", "")},
                      {"sequence", commit ? count_cell(commit->sequence) : null_cell()},
                      {"bank", commit ? word_cell(commit->bank == 0 ? "A" : "B") : null_cell()},
                      {"image_bytes", commit ? count_cell(commit->image_bytes) : null_cell()},
                      {"image_check", commit ? hex_cell(commit->image_check) : null_cell()}});
}

Cell commits_cell(const DecodedMemory& memory) {
  Cell list{Json::array(), {}};
  if (memory.has_commits)
    for (const CommitSlot& slot : memory.commits) list.add(commit_cell(slot));
  return list;
}

std::string_view layout_for(const DecodedTable& table) {
  if (!table.fault.empty()) return "{number:>2} {name:<12} {entry_address}: {fault}\n";
  if (table.entry.declared_zero) return "{number:>2} {name:<12} declared zero\n";
  return "{number:>2} {name:<12} {address} {start_mm:>10} {increment_mm:>8} {count:>5} {least:>9} {most:>9} {unit}\n";
}

Cell table_cell(const DecodedTable& table) {
  const bool known = table.known_codes, has_values = !table.values.empty();
  const auto& entry = table.entry;
  const std::string address = hex_address(table.values_address);
  return record_cell(
      layout_for(table),
      {{"number", shown_cell(fmt::format("{}", table.number))},
       {"name", shown_cell(name_of(table))},
       {"component", known ? word_cell(ecs::name_of(entry.component)) : null_cell()},
       {"description", known ? word_cell(laser::description_of(entry.component)) : null_cell()},
       {"approach", known ? word_cell(name_of(entry.approach)) : null_cell()},
       {"declared_zero", yes_cell(entry.declared_zero, "", "")},
       {"entry_address", word_cell(hex_address(table.entry_address))},
       {"address", table.readable && has_values ? word_cell(address) : null_cell(address)},
       {"start_mm", plain_cell(entry.start_mm)},
       {"increment_mm", plain_cell(entry.increment_mm)},
       {"count", count_cell(entry.count)},
       {"resolution", plain_cell(entry.resolution)},
       {"unit", known ? word_cell(unit_of(entry.component)) : null_cell()},
       {"least", has_values ? number_cell(table.least, 2) : null_cell(fmt::format("{:.2f}", table.least))},
       {"most", has_values ? number_cell(table.most, 2) : null_cell(fmt::format("{:.2f}", table.most))},
       {"fault", text_cell(table.fault)}});
}

Cell tables_cell(const DecodedImage& image) {
  if (image.tables.empty()) return {Json::array(), "no tables\n"};
  return list_cell(image.tables, table_cell,
                   " # component    address    start/mm incr./mm count     least      most unit\n");
}

std::string bytes_text(const DecodedImage& image, const MemoryDump& dump) {
  const DumpRegion* region = region_at(dump, image.address);
  if (region == nullptr) return {};
  std::string text = "address   bytes                    field                                      value\n";
  for (const NamedPlace& field : fields_of(image, *region)) {
    const std::size_t at = field.first - region->address;
    if (at + field.bytes > region->bytes.size()) break;
    const ByteView bytes = ByteView(region->bytes).subspan(at, field.bytes);
    text += fmt::format("{}  {:<24} {:<42} {}\n", hex_address(field.first), hex_of(bytes), field.name, field.value);
  }
  return text;
}

Cell identity_cell(const DecodedImage& image) {
  if (!image.identity)
    return null_cell(image.format == kFormatWithoutIdentity ? "for no particular unit (format 1)\n" : "");
  return record_cell("for unit {serial_number}, machine {machine}, configuration {configuration}\n",
                     {{"serial_number", text_cell(image.identity->serial_number)},
                      {"machine", text_cell(image.identity->machine)},
                      {"configuration", hex_cell(image.identity->configuration)}});
}

Cell below_a_gap(Cell cell) {
  cell.text.insert(0, "\n");
  return cell;
}

Cell image_cell(const DecodedImage& image, const MemoryDump& dump, bool with_bytes) {
  const ImageVerdict& verdict = image.verdict;
  const Cell block_check =
      record_cell("block check {stored} stored, {computed} computed: {agrees}\n",
                  {{"stored", hex_cell(verdict.check_expected)},
                   {"computed", hex_cell(verdict.check_found)},
                   {"agrees", yes_cell(verdict.check_expected == verdict.check_found, "they agree", "they differ")}});
  return record_cell(
      "\n== {region} at {address}, {bytes} "
      "bytes{active}\n{identity}{block_check}{faults}{fields}{parameters}\n{tables}{header}",
      {{"region", word_cell(image.region)},
       {"address", word_cell(hex_address(image.address))},
       {"active", yes_cell(image.active, ", active", "")},
       {"bytes", count_cell(image.bytes)},
       {"sound", yes_cell(image.faults.empty(), "", "")},
       {"faults", lines_cell(image.faults, "FAULT: ")},
       {"format", count_cell(image.format)},
       {"identity", identity_cell(image)},
       {"block_check", block_check},
       {"fields", shown_cell(with_bytes ? "\n" + bytes_text(image, dump) : "")},
       {"parameters", image.parameters ? below_a_gap(parameters_cell(*image.parameters)) : null_cell()},
       {"tables", tables_cell(image)},
       {"header", image.header.empty() ? null_cell() : Cell{image.header, "\nheader\n" + image.header + "\n"}}});
}

Cell images_cell(const MemoryDump& dump, const DecodedMemory& memory, bool with_bytes) {
  return list_cell(
      memory.images, [&](const DecodedImage& image) { return image_cell(image, dump, with_bytes); },
      memory.images.empty() ? "no memory image\n" : "");
}

Cell status_when_taken(const MemoryDump& dump) {
  if (!dump.status) return null_cell();
  Cell status = status_cell(*dump.status);
  status.text = "\n== status when it was taken\n" + status.text;
  return status;
}

}  // namespace

Cell memory_cell(const MemoryDump& dump, const DecodedMemory& memory, bool with_bytes) {
  return record_cell(
      dump.taken.empty()
          ? "{faults}{regions}{commits}{images}{status}"
          : "unit {serial_number}, taken {taken}\nover {link}\n{faults}{regions}{commits}{images}{status}",
      {{"taken", text_cell(dump.taken)},
       {"link", text_cell(dump.link)},
       {"serial_number", text_cell(dump.serial_number)},
       {"sound", yes_cell(memory.sound(), "", "")},
       {"faults", lines_cell(memory.faults, "FAULT: ")},
       {"regions", regions_cell(dump)},
       {"commits", commits_cell(memory)},
       {"images", images_cell(dump, memory, with_bytes)},
       {"status", status_when_taken(dump)}});
}

Result<StatusFile> read_status_file(const std::string& path) {
  ECS_TRY(text, read_file(path));
  StatusFile file;
  file.name = std::filesystem::path(path).filename().string();
  if (const auto first = trimmed(text); !first.empty() && first.front() == '{') {
    ECS_TRY(snapshot, parse_snapshot(text, path));
    file.snapshot = std::move(snapshot);
    return file;
  }
  ECS_TRY(dump, dump_in(text, path));
  file.snapshot = dump.status;
  file.memory = owned_lines_of(memory_cell(dump, decoded(dump), false).text);
  return file;
}

}  // namespace ecs::commissioning
