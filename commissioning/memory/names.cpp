#include "commissioning/memory/names.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "commissioning/memory/decode.hpp"
#include "commissioning/memory/fields.hpp"
#include "core/axis.hpp"

namespace ecs::commissioning {
namespace {

void add_image(const DecodedImage& image, const DumpRegion& region, std::vector<NamedStretch>& out) {
  for (ByteField& field : fields_of(image, region))
    out.push_back({field.address, field.bytes, std::move(field.name), std::move(field.value), false, {}});
  for (const DecodedTable& table : image.tables)
    if (table.readable && table.entry.count > 0)
      out.push_back({table.values_address, 2 * table.entry.count, "table " + name_of(table),
                     fmt::format("{} values from {} mm every {} mm", table.entry.count, table.entry.start_mm,
                                 table.entry.increment_mm),
                     true, table.entry});
  if (!image.header.empty() && region.bytes.size() >= kPrefixBytes)
    out.push_back({image.address + load_big<std::uint32_t>(region.bytes, prefix_at::header),
                   static_cast<std::uint32_t>(image.header.size()),
                   "header",
                   "text of the map's header",
                   false,
                   {}});
}

std::string text_of(const DecodedImage& image, const DecodedMemory& memory) {
  std::string text = fmt::format("{}map of {} bytes", image.active ? "ACTIVE " : "", image.bytes);
  for (const CommitSlot& slot : memory.commits)
    if (slot.active && image.active && slot.commit) text += fmt::format(", commit {}", slot.commit->sequence);
  return text;
}

NamedPlace value_at(const MemoryBytes& memory, const NamedStretch& table, Address address) {
  const std::uint32_t index = (address - table.first) / 2;
  NamedPlace place{table.first + 2 * index, 2,
                   fmt::format("{} at {} mm", table.name,
                               table.entry.start_mm + table.entry.increment_mm * static_cast<double>(index)),
                   ""};
  const ByteView bytes = memory.known(place.first, 2);
  if (bytes.size() < 2) return place;
  const auto counts = static_cast<std::int16_t>(load_big<std::uint16_t>(bytes, 0));
  place.value =
      fmt::format("{:.6g} {} ({} counts)", counts * table.entry.resolution, unit_of(table.entry.component), counts);
  return place;
}

}  // namespace

MemoryNames::MemoryNames(const MemoryBytes& memory) {
  const MemoryDump dump = memory.as_dump();
  const DecodedMemory meaning = decoded(dump);
  if (meaning.has_commits)
    for (std::size_t i = 0; i < meaning.commits.size(); ++i)
      stretches_.push_back({meaning.commits[i].address,
                            kCommitSlotBytes,
                            fmt::format("commit record {}", i),
                            text_of(meaning.commits[i]) + (meaning.commits[i].active ? ", active" : ""),
                            false,
                            {}});
  for (const DecodedImage& image : meaning.images) {
    const DumpRegion* region = region_at(dump, image.address);
    if (region == nullptr) continue;
    add_image(image, *region, stretches_);
    contents_.push_back({image.address, text_of(image, meaning)});
  }
  for (const MemoryRegion& region : memory.regions()) {
    const bool is_bank = region.first == kBankA.first || region.first == kBankB.first;
    if (is_bank && memory.at(region.first) && content_of(region).empty()) contents_.push_back({region.first, "no map"});
  }
  std::stable_sort(stretches_.begin(), stretches_.end(),
                   [](const NamedStretch& a, const NamedStretch& b) { return a.first < b.first; });
}

const NamedStretch* MemoryNames::stretch_at(Address address) const {
  auto after = std::upper_bound(stretches_.begin(), stretches_.end(), address,
                                [](Address a, const NamedStretch& stretch) { return a < stretch.first; });
  if (after == stretches_.begin()) return nullptr;
  const NamedStretch& stretch = *std::prev(after);
  return stretch.contains(address) ? &stretch : nullptr;
}

std::optional<NamedPlace> MemoryNames::at(const MemoryBytes& memory, Address address) const {
  const NamedStretch* stretch = stretch_at(address);
  if (stretch == nullptr) return std::nullopt;
  if (stretch->table) return value_at(memory, *stretch, address);
  const bool read = memory.known(stretch->first, stretch->bytes).size() == stretch->bytes;
  return NamedPlace{stretch->first, stretch->bytes, stretch->name, read ? stretch->value : "not read yet"};
}

std::optional<Address> MemoryNames::next(Address address) const {
  for (const NamedStretch& stretch : stretches_)
    if (stretch.first > address) return stretch.first;
  return std::nullopt;
}

std::optional<Address> MemoryNames::previous(Address address) const {
  for (auto stretch = stretches_.rbegin(); stretch != stretches_.rend(); ++stretch)
    if (stretch->first < address) return stretch->first;
  return std::nullopt;
}

std::string MemoryNames::content_of(const MemoryRegion& region) const {
  for (const Content& content : contents_)
    if (content.region == region.first) return content.text;
  return "";
}

std::vector<Stretch> MemoryNames::structure(const MemoryBytes& memory) {
  std::vector<Stretch> wanted;
  for (const MemoryRegion& region : memory.regions()) {
    if (region.first == kCommitRecords.first) wanted.push_back({region.first, region.size});
    const bool is_bank = region.first == kBankA.first || region.first == kBankB.first;
    const ByteView magic = memory.known(region.first, 4);
    if (is_bank && (magic.size() < 4 || load_big<std::uint32_t>(magic, 0) == kImageMagic))
      wanted.push_back({region.first, std::min(region.size, directory_offset() + kMostTables * kEntryBytes)});
  }
  return wanted;
}

std::string numbers_at(const MemoryBytes& memory, Address address) {
  const ByteView bytes = memory.known(address, 8);
  if (bytes.empty()) return "";
  std::string text = fmt::format("u8 {}", bytes[0]);
  if (bytes.size() >= 2) text += fmt::format("  s16 {}", static_cast<std::int16_t>(load_big<std::uint16_t>(bytes, 0)));
  if (bytes.size() >= 4) text += fmt::format("  u32 {}", load_big<std::uint32_t>(bytes, 0));
  if (bytes.size() >= 8) text += fmt::format("  f64 {:.6g}", load_double(bytes, 0));
  return text;
}

}  // namespace ecs::commissioning
