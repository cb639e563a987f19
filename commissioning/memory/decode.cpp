#include "commissioning/memory/decode.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/json.hpp"
#include "commissioning/unit/status.hpp"

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
  if (!active) memory.faults.push_back("no commit record is valid: the unit has no active map");
}

const Commit* active_commit_of(const DecodedMemory& memory) {
  for (const CommitSlot& slot : memory.commits)
    if (slot.active) return &*slot.commit;
  return nullptr;
}

// --- tables
std::string fault_of(const DecodedTable& table, bool within) {
  if (!table.known_codes) return "its component or approach code does not exist";
  if (table.entry.declared_zero) return table.entry.count == 0 ? "" : "declared zero, yet it has values";
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
    out.faults.push_back(fmt::format("the prefix announces {} tables, an image holds at most {}", count, kMostTables));
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
  if (!out.parameters) out.faults.push_back("the parameters hold a word or number that cannot be");
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
          fmt::format("the commit record names {} bytes, the image {}", commit.image_bytes, image.bytes));
    if (image.verdict.check_expected != commit.image_check)
      image.faults.push_back(fmt::format("the commit record names block check {:08X}, the image {:08X}",
                                         commit.image_check, image.verdict.check_expected));
    return;
  }
  memory.faults.push_back(
      fmt::format("the active commit record names bank {}, which holds no image here", commit.bank == 0 ? "A" : "B"));
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
  return fmt::format("sequence {}, bank {}, {} bytes, check {:08X}", slot.commit->sequence,
                     slot.commit->bank == 0 ? "A" : "B", slot.commit->image_bytes, slot.commit->image_check);
}

}  // namespace ecs::commissioning
