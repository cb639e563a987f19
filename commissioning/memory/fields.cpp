#include "commissioning/memory/fields.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include <fmt/format.h>

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

void add_prefix(const DumpRegion& region, std::vector<ByteField>& out) {
  for (const PrefixField& field : kPrefixFields)
    out.push_back({region.address + field.at, field.bytes, fmt::format("prefix.{}", field.name),
                   prefix_value(region.bytes, field)});
}

void add_parameters(const DecodedImage& image, const DumpRegion& region, std::vector<ByteField>& out) {
  const auto& all = params::fields();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const FieldPlace place = parameter_places()[i];
    if (place.bytes == 0 || kPrefixBytes + place.first + place.bytes > region.bytes.size()) continue;
    const std::string value = image.parameters ? params::text_of(all[i], *image.parameters) : std::string("unreadable");
    out.push_back({region.address + kPrefixBytes + place.first, place.bytes, all[i].key,
                   all[i].unit.empty() ? value : fmt::format("{} {}", value, all[i].unit)});
  }
}

void add_identity(const DecodedImage& image, const DumpRegion& region, std::vector<ByteField>& out) {
  if (!image.identity) return;
  const auto add = [&](std::uint32_t at, std::uint32_t bytes, const char* name, std::string value) {
    out.push_back({region.address + kIdentityOffset + at, bytes, fmt::format("identity.{}", name), std::move(value)});
  };
  add(identity_at::serial_number, kMostSerialNumberBytes, "serial_number", image.identity->serial_number);
  add(identity_at::machine, kMostMachineBytes, "machine", image.identity->machine);
  add(identity_at::configuration, 4, "configuration", fmt::format("{:08X}", image.identity->configuration));
}

void add_table(const DecodedTable& table, std::vector<ByteField>& out) {
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

std::vector<ByteField> fields_of(const DecodedImage& image, const DumpRegion& region) {
  std::vector<ByteField> out;
  add_prefix(region, out);
  add_parameters(image, region, out);
  add_identity(image, region, out);
  for (const DecodedTable& table : image.tables) add_table(table, out);
  std::stable_sort(out.begin(), out.end(),
                   [](const ByteField& a, const ByteField& b) { return a.address < b.address; });
  return out;
}

std::string hex_of(ByteView bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) text += fmt::format("{}{:02X}", text.empty() ? "" : " ", byte);
  return text;
}

}  // namespace ecs::commissioning
