#include "commissioning/memory/decode.hpp"

#include <algorithm>
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

std::uint32_t word(ByteView bytes, std::uint32_t at) { return load_big<std::uint32_t>(bytes, at); }

// --- commit records
std::optional<Commit> commit_in_slot(ByteView slot) {
  std::array<std::uint8_t, 2 * kCommitSlotBytes> alone{};
  std::copy(slot.begin(), slot.end(), alone.begin());
  return active_commit(alone);
}

void decode_commits(const DumpRegion& region, DecodedMemory& memory) {
  if (region.bytes.size() < 2 * kCommitSlotBytes) return;
  memory.has_commits = true;
  const auto active = active_commit(region.bytes);
  for (std::uint32_t i = 0; i < memory.commits.size(); ++i) {
    CommitSlot& slot = memory.commits[i];
    const ByteView bytes = ByteView(region.bytes).subspan(i * kCommitSlotBytes, kCommitSlotBytes);
    slot.address = region.address + i * kCommitSlotBytes;
    slot.blank = std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte == 0 || byte == 0xFF; });
    slot.commit = commit_in_slot(bytes);
    slot.active = active.has_value() && slot.commit == active;
    if (!slot.blank && !slot.commit)
      memory.faults.push_back(fmt::format("commit record {} at {} is corrupt", i, hex_address(slot.address)));
  }
  if (active) return;
  if (std::ranges::all_of(memory.commits, &CommitSlot::blank))
    memory.notes.emplace_back("no map has been sent yet: both commit records are blank");
  else
    memory.faults.emplace_back("no commit record is valid: the unit has no active map");
}

const Commit* active_commit_of(const DecodedMemory& memory) {
  for (const CommitSlot& slot : memory.commits)
    if (slot.active) return &*slot.commit;
  return nullptr;
}

// --- tables
std::string fault_of(const DecodedTable& table, bool within) {
  if (!table.known_codes) return "its component or approach code does not exist";
  if (table.entry.declared_zero) return table.entry.count == 0 ? "" : "declared zero, but it has values";
  if (table.entry.count == 0) return "it has no values";
  if (!(table.entry.increment_mm > 0.0) || !(table.entry.resolution > 0.0))
    return "increment or resolution is not above zero";
  return within ? "" : "its values lie beyond the end of the image";
}

DecodedTable decode_table(ByteView image, Address address, std::uint32_t number) {
  DecodedTable table;
  table.number = number;
  const std::uint32_t at = directory_offset(ImageView(image).format()) + number * kEntryBytes;
  const auto approach = static_cast<std::int8_t>(image[at + 1]);
  table.entry_address = address + at;
  table.known_codes = image[at] < kCurves && approach >= -1 && approach <= 1;
  table.entry = ImageView(image).entry(number);
  const std::uint64_t first = std::uint64_t{word(image, prefix_at::values)} + 2ull * table.entry.first_value;
  const bool within = first + 2ull * table.entry.count <= image.size();
  table.values_address = within ? address + static_cast<Address>(first) : 0;
  table.fault = fault_of(table, within);
  table.readable = within && table.fault.empty();
  for (std::uint32_t k = 0; table.readable && k < table.entry.count; ++k) {
    const auto counts =
        static_cast<std::int16_t>(load_big<std::uint16_t>(image, static_cast<std::size_t>(first) + 2 * k));
    table.values.push_back(counts * table.entry.resolution);
  }
  if (!table.values.empty()) {
    table.least = *std::min_element(table.values.begin(), table.values.end());
    table.most = *std::max_element(table.values.begin(), table.values.end());
  }
  return table;
}

void decode_tables(ByteView image, DecodedImage& out) {
  std::uint32_t count = word(image, prefix_at::table_count);
  const std::uint32_t directory = directory_offset(ImageView(image).format());
  if (count > kMostTables) {
    out.faults.push_back(
        fmt::format("the prefix announces {} tables, but an image has at most {}", count, kMostTables));
    count = 0;
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (directory + (i + 1) * kEntryBytes > image.size()) {
      out.faults.push_back(fmt::format("the table directory is cut off after {} of {} tables", i, count));
      return;
    }
    DecodedTable table = decode_table(image, out.address, i);
    if (!table.fault.empty()) out.faults.push_back(fmt::format("table {} ({}): {}", i, name_of(table), table.fault));
    out.tables.push_back(std::move(table));
  }
}

void decode_header(ByteView image, DecodedImage& out) {
  const std::uint64_t first = word(image, prefix_at::header);
  const std::uint64_t size = word(image, prefix_at::header_bytes);
  if (first + size > image.size()) {
    out.faults.push_back("the header text lies beyond the end of the image");
    return;
  }
  const ByteView text = image.subspan(first, size);
  out.header.assign(text.begin(), text.end());
}

std::string printable(std::string_view text) {
  std::string shown(text);
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, '?');
  return shown;
}

std::string words_for(const DecodedImage& image) {
  std::string text = fmt::format("the image {}", ecs::text_of(image.verdict.fault));
  if (image.verdict.fault == ImageFault::block_check)
    text += fmt::format(": {:08X} stored, {:08X} computed", image.verdict.check_expected, image.verdict.check_found);
  return text;
}

/// @pre region.bytes begins with a prefix
DecodedImage decode_image(const DumpRegion& region) {
  DecodedImage out;
  out.region = region.name;
  out.address = region.address;
  const ByteView bank(region.bytes);
  out.verdict = check_image(bank);
  out.bytes = word(bank, prefix_at::total_bytes);
  if (out.verdict.fault != ImageFault::none) out.faults.push_back(words_for(out));
  const ByteView image = bank.first(std::min<std::size_t>(bank.size(), out.bytes));
  out.format = load_big<std::uint16_t>(bank, prefix_at::format);
  if (image.size() < directory_offset(out.format)) return out;
  if (const auto identity = ImageView(image).identity())
    out.identity =
        DecodedIdentity{printable(identity->serial_number), printable(identity->machine), identity->configuration};
  out.parameters = decode_parameters(image.subspan(kPrefixBytes, kParameterBytes));
  if (!out.parameters) out.faults.push_back("the parameters contain an impossible word or number");
  decode_tables(image, out);
  decode_header(image, out);
  return out;
}

void match_commit(const Commit& commit, DecodedMemory& memory) {
  const Address address = commit.bank == 0 ? kBankA.first : kBankB.first;
  for (DecodedImage& image : memory.images) {
    if (image.address != address) continue;
    image.active = true;
    if (image.bytes != commit.image_bytes)
      image.faults.push_back(
          fmt::format("the commit record states {} bytes, the image {}", commit.image_bytes, image.bytes));
    if (image.verdict.check_expected != commit.image_check)
      image.faults.push_back(fmt::format("the commit record states checksum {:08X}, the image {:08X}",
                                         commit.image_check, image.verdict.check_expected));
    return;
  }
  memory.faults.push_back(fmt::format("the active commit record refers to bank {}, which contains no image here",
                                      commit.bank == 0 ? "A" : "B"));
}

}  // namespace

bool DecodedMemory::sound() const {
  const bool one_is_active = std::any_of(images.begin(), images.end(), [](const auto& image) { return image.active; });
  return faults.empty() && std::all_of(images.begin(), images.end(), [one_is_active](const DecodedImage& image) {
           return image.faults.empty() || (one_is_active && !image.active);
         });
}

const DecodedImage* DecodedMemory::main_image() const {
  for (const DecodedImage& image : images)
    if (image.active) return &image;
  return images.size() == 1 ? &images.front() : nullptr;
}

DecodedMemory decoded(const MemoryDump& dump) {
  DecodedMemory memory;
  memory.faults = dump.damage;
  for (const DumpRegion& region : dump.regions) {
    if (region.address == kCommitRecords.first) decode_commits(region, memory);
    const bool is_bank = region.address == kBankA.first || region.address == kBankB.first;
    if (is_bank && region.bytes.size() >= kPrefixBytes && word(region.bytes, prefix_at::magic) == kImageMagic)
      memory.images.push_back(decode_image(region));
  }
  if (const Commit* commit = active_commit_of(memory)) match_commit(*commit, memory);
  if (!memory.has_commits && memory.images.size() == 1) memory.images.front().active = true;
  return memory;
}

std::string name_of(const DecodedTable& table) {
  if (!table.known_codes) return "unknown component";
  std::string name(ecs::name_of(table.entry.component));
  if (table.entry.approach != Approach::unknown) name += fmt::format(" {}", name_of(table.entry.approach));
  return name;
}

std::string text_of(const CommitSlot& slot) {
  if (!slot.commit) return slot.blank ? "blank" : "corrupt";
  return fmt::format("commit no. {}, bank {}, {} bytes, checksum {:08X}", slot.commit->sequence,
                     slot.commit->bank == 0 ? "A" : "B", slot.commit->image_bytes, slot.commit->image_check);
}

// --- in words and as JSON
std::string configuration_text(const DecodedImage& image) {
  const std::string code = fmt::format("code {:08X}", image.identity->configuration);
  const bool fits = image.parameters && configuration_hash(*image.parameters) == image.identity->configuration;
  return fits ? fmt::format("{} ({})", configuration_of(*image.parameters), code) : code;
}

namespace {

Cell hex_cell(std::uint32_t number) { return cell_of(fmt::format("{:08X}", number)); }

Cell regions_cell(const MemoryDump& dump) {
  return list_cell(dump.regions, [](const DumpRegion& region) {
    return record_cell("{address}  {bytes:>7} bytes  {name}{intact}\n", "name"_is(region.name),
                       "address"_is(hex_address(region.address)), "bytes"_is(region.bytes.size()),
                       "expected_bytes"_is(region.size), "intact"_is(region.intact, "", " (damaged)"));
  });
}

Cell commit_cell(const CommitSlot& slot) {
  const auto& commit = slot.commit;
  const std::string_view state = commit ? "valid" : (slot.blank ? "blank" : "corrupt");
  return record_cell(commit ? "commit record {address}: commit no. {sequence}, bank {bank}, {image_bytes} bytes, "
                              "checksum (CRC-32) {image_check}{active}\n"
                            : "commit record {address}: {state}\n",
                     "address"_is(hex_address(slot.address)), "state"_is(state),
                     "active"_is(slot.active, " (active)", ""),
                     "sequence"_is(commit ? cell_of(commit->sequence) : null_cell()),
                     "bank"_is(commit ? cell_of(commit->bank == 0 ? "A" : "B") : null_cell()),
                     "image_bytes"_is(commit ? cell_of(commit->image_bytes) : null_cell()),
                     "image_check"_is(commit ? hex_cell(commit->image_check) : null_cell()));
}

Cell commits_cell(const DecodedMemory& memory) {
  return memory.has_commits ? list_cell(memory.commits, commit_cell) : Cell{Json::array(), {}};
}

std::string_view layout_for(const DecodedTable& table) {
  if (!table.fault.empty()) return "{number:>2} {name:<12} {entry_address}: {fault}\n";
  if (table.entry.declared_zero) return "{number:>2} {name:<12} declared zero\n";
  return "{number:>2} {name:<12} {address} {start_mm:>10} {increment_mm:>8} {count:>6} {least:>9} {most:>9} {unit}\n";
}

Cell table_cell(const DecodedTable& table) {
  const bool known = table.known_codes, has_values = !table.values.empty();
  const auto& entry = table.entry;
  const std::string address = hex_address(table.values_address);
  return record_cell(
      layout_for(table), "number"_shown(table.number), "name"_shown(name_of(table)),
      "component"_is(known ? cell_of(ecs::name_of(entry.component)) : null_cell()),
      "description"_is(known ? cell_of(laser::description_of(entry.component)) : null_cell()),
      "approach"_is(known ? cell_of(name_of(entry.approach)) : null_cell()), "declared_zero"_is(entry.declared_zero),
      "entry_address"_is(hex_address(table.entry_address)),
      "address"_is(table.readable && has_values ? cell_of(address) : null_cell(address)), "start_mm"_is(entry.start_mm),
      "increment_mm"_is(entry.increment_mm), "count"_is(entry.count), "resolution"_is(entry.resolution),
      "unit"_is(known ? cell_of(unit_of(entry.component)) : null_cell()),
      "least"_is(has_values ? number_cell(table.least, 2) : null_cell(fmt::format("{:.2f}", table.least))),
      "most"_is(has_values ? number_cell(table.most, 2) : null_cell(fmt::format("{:.2f}", table.most))),
      "fault"_is(text_cell(table.fault)));
}

Cell tables_cell(const DecodedImage& image) {
  if (image.tables.empty()) return {Json::array(), "no tables\n"};
  return list_cell(image.tables, table_cell,
                   " # component    address    start/mm incr./mm points  smallest   largest unit\n");
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
  const auto stated = [](const std::string& text) { return text.empty() ? Cell{"", "not stated"} : text_cell(text); };
  const std::string code = fmt::format("{:08X}", image.identity->configuration);
  return record_cell("for unit {serial_number}, machine {machine}, configuration {configuration}\n",
                     "serial_number"_is(stated(image.identity->serial_number)),
                     "machine"_is(stated(image.identity->machine)),
                     "configuration"_is(code, configuration_text(image)));
}

Cell below_a_gap(Cell cell) {
  cell.text.insert(0, "\n");
  return cell;
}

Cell image_cell(const DecodedImage& image, const MemoryDump& dump, bool with_bytes) {
  const ImageVerdict& verdict = image.verdict;
  Cell block_check =
      record_cell(verdict.check_expected == verdict.check_found
                      ? "checksum (CRC-32) {stored}: the stored and the computed value agree\n"
                      : "checksum (CRC-32) {stored} stored, {computed} computed: {agrees}\n",
                  "stored"_is(hex_cell(verdict.check_expected)), "computed"_is(hex_cell(verdict.check_found)),
                  "agrees"_is(verdict.check_expected == verdict.check_found, "", "they differ"));
  if (verdict.fault == ImageFault::block_check) block_check.text.clear();  // the fault states both
  return record_cell(
      "\n== {region} at {address}, {bytes} "
      "bytes{active}\n{identity}{block_check}{faults}{fields}{parameters}\n{tables}{header}",
      "region"_is(image.region), "address"_is(hex_address(image.address)), "active"_is(image.active, ", active", ""),
      "bytes"_is(image.bytes), "sound"_is(image.faults.empty()), "faults"_is(lines_cell(image.faults, "FAULT: ")),
      "format"_is(image.format), "identity"_is(identity_cell(image)), "block_check"_is(block_check),
      "fields"_shown(with_bytes ? "\n" + bytes_text(image, dump) : ""),
      "parameters"_is(image.parameters ? below_a_gap(parameters_cell(*image.parameters)) : null_cell()),
      "tables"_is(tables_cell(image)),
      "header"_is(image.header.empty() ? null_cell() : Cell{image.header, "\nheader\n" + image.header + "\n"}));
}

Cell images_cell(const MemoryDump& dump, const DecodedMemory& memory, bool with_bytes) {
  return list_cell(
      memory.images, [&](const DecodedImage& image) { return image_cell(image, dump, with_bytes); },
      memory.images.empty() ? "no memory image\n" : "");
}

Cell status_when_taken(const MemoryDump& dump) {
  if (!dump.status) return null_cell();
  Cell status = status_cell(*dump.status);
  status.text = "\n== status at the time of the dump\n" + status.text;
  return status;
}

}  // namespace

Cell memory_cell(const MemoryDump& dump, const DecodedMemory& memory, bool with_bytes) {
  return record_cell(dump.taken.empty() ? "{faults}{notes}{regions}{commits}{images}{status}"
                                        : "dump of unit {serial_number}, taken {taken}\nover "
                                          "{link}\n{faults}{notes}{regions}{commits}{images}{status}",
                     "taken"_is(text_cell(dump.taken)), "link"_is(text_cell(dump.link)),
                     "serial_number"_is(text_cell(dump.serial_number)), "sound"_is(memory.sound()),
                     "faults"_is(lines_cell(memory.faults, "FAULT: ")), "notes"_is(lines_cell(memory.notes, "note: ")),
                     "regions"_is(regions_cell(dump)), "commits"_is(commits_cell(memory)),
                     "images"_is(images_cell(dump, memory, with_bytes)), "status"_is(status_when_taken(dump)));
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
