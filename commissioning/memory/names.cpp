#include "commissioning/memory/names.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include <fmt/format.h>

#include "core/axis.hpp"
#include "params/fields.hpp"

namespace ecs::commissioning {
namespace {

using Encoded = std::array<std::uint8_t, kParameterBytes>;

Encoded encoded(const UnitParameters& parameters) {
  Encoded block{};
  encode_parameters(parameters, block);
  return block;
}

/// Parameter sets between which every byte of the field changes.
std::vector<UnitParameters> variants(const params::Field& field) {
  std::vector<UnitParameters> sets(2);
  if (field.type == params::FieldType::text) {
    const bool chain = field.put_text && field.put_text(sets[0], "TXYZ");
    for (const char* word : {chain ? "XYZT" : "X", chain ? "ZTXY" : "YZ", chain ? "T" : "XYZ"}) {
      sets.emplace_back();
      if (field.put_text) static_cast<void>(field.put_text(sets.back(), word));
    }
  } else if (field.type == params::FieldType::number) {
    field.put(sets[0], std::bit_cast<double>(0x3FA5A5A5A5A5A5A5ull));
    field.put(sets[1], std::bit_cast<double>(0x405A5A5A5A5A5A5Aull));
  } else if (field.type == params::FieldType::choice) {
    for (std::size_t i = 0; i < field.choices.size(); ++i) {
      sets.emplace_back();
      field.put(sets.back(), static_cast<double>(i));
    }
  } else {
    field.put(sets[0], field.least);
    field.put(sets[1], std::max(field.most, 1.0));
  }
  return sets;
}

FieldPlace place_of(const params::Field& field) {
  const auto sets = variants(field);
  const Encoded first = encoded(sets.front());
  std::uint32_t from = kParameterBytes, to = 0;
  for (const UnitParameters& other : sets) {
    const Encoded bytes = encoded(other);
    for (std::uint32_t i = 0; i < kParameterBytes; ++i) {
      if (bytes[i] == first[i]) continue;
      from = std::min(from, i);
      to = std::max(to, i + 1);
    }
  }
  return {from, to > from ? to - from : 0};
}

struct PrefixField {
  std::uint32_t at;
  std::uint32_t bytes;
  const char* name;
};
constexpr std::array<PrefixField, 11> kPrefixFields{{{prefix_at::magic, 4, "magic"},
                                                     {prefix_at::format, 2, "format"},
                                                     {prefix_at::total_bytes, 4, "total_bytes"},
                                                     {prefix_at::check, 4, "block_check"},
                                                     {prefix_at::parameters, 4, "parameters_offset"},
                                                     {prefix_at::directory, 4, "directory_offset"},
                                                     {prefix_at::table_count, 4, "table_count"},
                                                     {prefix_at::values, 4, "values_offset"},
                                                     {prefix_at::value_count, 4, "value_count"},
                                                     {prefix_at::header, 4, "header_offset"},
                                                     {prefix_at::header_bytes, 4, "header_bytes"}}};

std::string prefix_value(ByteView bytes, const PrefixField& field) {
  if (field.at == prefix_at::magic) return std::string(bytes.begin(), bytes.begin() + 4);
  if (field.at == prefix_at::check) return fmt::format("{:08X}", load_big<std::uint32_t>(bytes, field.at));
  if (field.bytes == 2) return fmt::format("{}", load_big<std::uint16_t>(bytes, field.at));
  return fmt::format("{}", load_big<std::uint32_t>(bytes, field.at));
}

void add_prefix(const DumpRegion& region, std::vector<NamedPlace>& out) {
  for (const PrefixField& field : kPrefixFields)
    out.push_back({region.address + field.at, field.bytes, fmt::format("prefix.{}", field.name),
                   prefix_value(region.bytes, field)});
}

void add_parameters(const DecodedImage& image, const DumpRegion& region, std::vector<NamedPlace>& out) {
  const auto& all = params::fields();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const FieldPlace place = parameter_places()[i];
    if (place.bytes == 0 || kPrefixBytes + place.first + place.bytes > region.bytes.size()) continue;
    const std::string value = image.parameters ? params::text_of(all[i], *image.parameters) : std::string("unreadable");
    out.push_back({region.address + kPrefixBytes + place.first, place.bytes, all[i].key,
                   all[i].unit.empty() ? value : fmt::format("{} {}", value, all[i].unit)});
  }
}

void add_identity(const DecodedImage& image, const DumpRegion& region, std::vector<NamedPlace>& out) {
  if (!image.identity) return;
  const auto add = [&](std::uint32_t at, std::uint32_t bytes, const char* name, std::string value) {
    out.push_back({region.address + kIdentityOffset + at, bytes, fmt::format("identity.{}", name), std::move(value)});
  };
  add(identity_at::serial_number, kMostSerialNumberBytes, "serial_number", image.identity->serial_number);
  add(identity_at::machine, kMostMachineBytes, "machine", image.identity->machine);
  add(identity_at::configuration, 4, "configuration", fmt::format("{:08X}", image.identity->configuration));
}

void add_table(const DecodedTable& table, std::vector<NamedPlace>& out) {
  const Address at = table.entry_address;
  const TableEntry& e = table.entry;
  const auto add = [&](std::uint32_t offset, std::uint32_t bytes, const char* name, std::string value) {
    out.push_back({at + offset, bytes, fmt::format("table {} {}", table.number, name), std::move(value)});
  };
  add(0, 2, "component, approach", name_of(table));
  add(2, 1, "declared_zero", e.declared_zero ? "true" : "false");
  add(4, 4, "first_value", fmt::format("{}", e.first_value));
  add(8, 4, "count", fmt::format("{}", e.count));
  add(16, 8, "start_mm", fmt::format("{} mm", e.start_mm));
  add(24, 8, "increment_mm", fmt::format("{} mm", e.increment_mm));
  add(32, 8, "resolution", fmt::format("{}", e.resolution));
}

}  // namespace

const std::vector<FieldPlace>& parameter_places() {
  static const std::vector<FieldPlace> places = [] {
    std::vector<FieldPlace> found;
    for (const params::Field& field : params::fields()) found.push_back(place_of(field));
    return found;
  }();
  return places;
}

std::vector<NamedPlace> fields_of(const DecodedImage& image, const DumpRegion& region) {
  std::vector<NamedPlace> out;
  add_prefix(region, out);
  add_parameters(image, region, out);
  add_identity(image, region, out);
  for (const DecodedTable& table : image.tables) add_table(table, out);
  std::stable_sort(out.begin(), out.end(), [](const NamedPlace& a, const NamedPlace& b) { return a.first < b.first; });
  return out;
}

namespace {

void add_image(const DecodedImage& image, const DumpRegion& region, std::vector<NamedStretch>& out) {
  for (NamedPlace& field : fields_of(image, region)) out.push_back({std::move(field)});
  for (const DecodedTable& table : image.tables)
    if (table.readable && table.entry.count > 0)
      out.push_back({{table.values_address, 2 * table.entry.count, "table " + name_of(table),
                      fmt::format("{} values from {} mm every {} mm", table.entry.count, table.entry.start_mm,
                                  table.entry.increment_mm)},
                     true,
                     table.entry});
  if (!image.header.empty() && region.bytes.size() >= kPrefixBytes)
    out.push_back({{image.address + load_big<std::uint32_t>(region.bytes, prefix_at::header),
                    static_cast<std::uint32_t>(image.header.size()), "header", "text of the map's header"}});
}

std::string text_of(const DecodedImage& image, const DecodedMemory& memory) {
  std::string text = fmt::format("{}: {} bytes, {}", image.active ? "ACTIVE" : "not active", image.bytes,
                                 image.tables.empty() ? "parameters only" : "map");
  for (const CommitSlot& slot : memory.commits)
    if (slot.active && image.active && slot.commit) text += fmt::format(", commit no. {}", slot.commit->sequence);
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
      stretches_.push_back({{meaning.commits[i].address, kCommitSlotBytes, fmt::format("commit record {}", i),
                             text_of(meaning.commits[i]) + (meaning.commits[i].active ? ", active" : "")}});
  for (const DecodedImage& image : meaning.images) {
    const DumpRegion* region = region_at(dump, image.address);
    if (region == nullptr) continue;
    add_image(image, *region, stretches_);
    contents_.push_back({image.address, text_of(image, meaning)});
    if (image.active) active_ = image.address;
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
