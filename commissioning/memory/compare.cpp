#include "commissioning/memory/compare.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <span>

#include <fmt/format.h>

#include "base/json.hpp"
#include "base/text.hpp"
#include "params/fields.hpp"

namespace ecs::commissioning {
namespace {

/// Every byte that differs, by address, until `visit` returns false; not of the thermal record, whose clock runs.
void visit_differences(const MemoryBytes& a, const MemoryBytes& b, const std::function<bool(Address)>& visit) {
  for (const MemoryRegion& region : a.regions()) {
    if (region.first == kThermalRecord.first) continue;
    for (std::uint32_t at = 0; at < region.size; at += kPageBytes) {
      const ByteView in_a = a.known(region.first + at, kPageBytes), in_b = b.known(region.first + at, kPageBytes);
      const std::size_t count = std::min(in_a.size(), in_b.size());
      if (std::equal(in_a.begin(), in_a.begin() + static_cast<std::ptrdiff_t>(count), in_b.begin())) continue;
      for (std::size_t k = 0; k < count; ++k)
        if (in_a[k] != in_b[k] && !visit(region.first + at + static_cast<Address>(k))) return;
    }
  }
}

std::string value_at(const MemoryBytes& memory, const MemoryNames& names, const NamedPlace& as, Address address) {
  const auto place = names.at(memory, address);
  if (place && place->name == as.name && !place->value.empty())
    return place->value.substr(0, place->value.find(" ("));  // without the counts
  return hex_of(memory.known(as.first, std::min(as.bytes, 8u)), "");
}

void add_missing(const MemoryBytes& a, const MemoryBytes& b, bool in_a, std::vector<DifferenceRow>& rows) {
  for (const MemoryRegion& region : a.regions())
    if (b.region_of(region.first) == nullptr)
      rows.push_back({region.first, 0, region.name, in_a ? "there" : "missing", in_a ? "missing" : "there"});
}

}  // namespace

bool differ_at(const MemoryBytes& a, const MemoryBytes& b, Address address) {
  const auto in_a = a.at(address), in_b = b.at(address);
  return in_a && in_b && *in_a != *in_b;
}

std::optional<Address> next_difference(const MemoryBytes& a, const MemoryBytes& b, Address address) {
  std::optional<Address> first, next;
  visit_differences(a, b, [&](Address at) {
    if (!first) first = at;
    if (at > address) next = at;
    return !next;
  });
  return next ? next : first;
}

std::vector<DifferenceRow> difference_rows(const MemoryBytes& a, const MemoryNames& names_a, const MemoryBytes& b,
                                           const MemoryNames& names_b) {
  std::vector<DifferenceRow> rows;
  const NamedStretch* stretch = nullptr;
  const MemoryRegion* region = nullptr;
  visit_differences(a, b, [&](Address at) {
    const NamedStretch* here = names_a.stretch_at(at);
    const MemoryRegion* in = a.region_of(at);
    if (!rows.empty() && here == stretch && in == region) {
      ++rows.back().bytes;
      return true;
    }
    stretch = here, region = in;
    const NamedPlace place = names_a.at(a, at).value_or(NamedPlace{at, 1, "bytes of " + in->name, ""});
    rows.push_back({at, 1, place.name, value_at(a, names_a, place, at), value_at(b, names_b, place, at)});
    return true;
  });
  add_missing(a, b, true, rows);
  add_missing(b, a, false, rows);
  return rows;
}

namespace {

using List = std::vector<MemoryDifference>;

std::string with_unit(const std::string& value, const std::string& unit) {
  return unit.empty() ? value : value + " " + unit;
}

void compare_parameters(const DecodedImage& a, const DecodedImage& b, List& out) {
  if (!a.parameters || !b.parameters) {
    if (a.parameters.has_value() != b.parameters.has_value())
      out.push_back({"parameters", a.parameters ? "readable" : "unreadable", b.parameters ? "readable" : "unreadable"});
    return;
  }
  for (const params::Difference& difference : params::diff(*a.parameters, *b.parameters))
    out.push_back({"parameter " + difference.key, with_unit(difference.a, difference.unit),
                   with_unit(difference.b, difference.unit)});
}

std::string identity_text(const DecodedImage& image) {
  const std::optional<DecodedIdentity>& identity = image.identity;
  if (!identity) return "none";
  return fmt::format("{}, {}, configuration {}",
                     identity->serial_number.empty() ? "no unit in particular" : "unit " + identity->serial_number,
                     identity->machine.empty() ? "no machine in particular" : "machine " + identity->machine,
                     configuration_text(image));
}

std::string shape_of(const DecodedTable& table) {
  if (table.entry.declared_zero) return "declared zero";
  return fmt::format("{} values from {} mm every {} mm", table.entry.count, table.entry.start_mm,
                     table.entry.increment_mm);
}

void compare_values(const std::string& name, const DecodedTable& a, const DecodedTable& b, List& out) {
  std::size_t count = 0, first = 0, largest = 0;
  double most = -1.0;
  for (std::size_t i = 0; i < std::min(a.values.size(), b.values.size()); ++i) {
    if (a.values[i] == b.values[i]) continue;
    if (count++ == 0) first = i;
    if (std::abs(a.values[i] - b.values[i]) > most) most = std::abs(a.values[i] - b.values[i]), largest = i;
  }
  if (count == 0) return;
  const auto position = [&](std::size_t i) { return a.entry.start_mm + a.entry.increment_mm * static_cast<double>(i); };
  const auto unit = unit_of(a.entry.component);
  const std::string where =
      fmt::format("{} mm ({})", position(first), hex_address(a.values_address + 2 * static_cast<Address>(first)));
  out.push_back({count == 1 ? fmt::format("{}: 1 value differs, at {}", name, where)
                            : fmt::format("{}: {} values differ, from {} on, most at {} mm", name, count, where,
                                          position(largest)),
                 fmt::format("{:.4g} {}", a.values[largest], unit), fmt::format("{:.4g} {}", b.values[largest], unit)});
}

std::map<std::string, const DecodedTable*> by_name(const DecodedImage& image) {
  std::map<std::string, const DecodedTable*> tables;
  for (const DecodedTable& table : image.tables)
    tables.emplace(table.known_codes ? name_of(table) : fmt::format("number {}", table.number), &table);
  return tables;
}

void compare_tables(const DecodedImage& a, const DecodedImage& b, List& out) {
  const auto in_a = by_name(a), in_b = by_name(b);
  std::set<std::string> names;
  for (const auto& [name, table] : in_a) names.insert(name);
  for (const auto& [name, table] : in_b) names.insert(name);
  for (const std::string& name : names) {
    const auto ta = in_a.find(name), tb = in_b.find(name);
    const std::string what = "table " + name;
    if (ta == in_a.end() || tb == in_b.end()) {
      out.push_back(
          {what, ta == in_a.end() ? "none" : shape_of(*ta->second), tb == in_b.end() ? "none" : shape_of(*tb->second)});
      continue;
    }
    if (shape_of(*ta->second) != shape_of(*tb->second))
      out.push_back({what, shape_of(*ta->second), shape_of(*tb->second)});
    else
      compare_values(what, *ta->second, *tb->second, out);
  }
}

/// Lines of a header by key; keys that come several times are numbered.
std::map<std::string, std::string> header_lines(const std::string& header) {
  std::map<std::string, std::string> lines;
  for (const std::string_view line : lines_of(header)) {
    const std::size_t colon = line.find(':');
    const std::string key(trimmed(line.substr(0, colon)));
    const std::string value(colon == std::string_view::npos ? "" : trimmed(line.substr(colon + 1)));
    std::string name = key;
    for (int n = 2; lines.contains(name); ++n) name = fmt::format("{} {}", key, n);
    lines.emplace(std::move(name), value);
  }
  return lines;
}

void compare_headers(const DecodedImage& a, const DecodedImage& b, List& out) {
  auto in_a = header_lines(a.header), in_b = header_lines(b.header);
  for (const auto& [key, value] : in_b) in_a.try_emplace(key, "");
  for (const auto& [key, value] : in_a)
    if (value != in_b[key]) out.push_back({"header " + key, value, in_b[key]});
}

void compare_commits(const DecodedMemory& a, const DecodedMemory& b, List& out) {
  for (std::size_t i = 0; a.has_commits && b.has_commits && i < a.commits.size(); ++i)
    if (text_of(a.commits[i]) != text_of(b.commits[i]))
      out.push_back({fmt::format("commit record {}", i), text_of(a.commits[i]), text_of(b.commits[i])});
}

/// Bytes of the main image have names already when it lies at the same place in both.
bool is_named(const DecodedImage* a, const DecodedImage* b, Address address) {
  if (a == nullptr || b == nullptr || a->address != b->address) return false;
  return address >= a->address && address - a->address < std::min(a->bytes, b->bytes);
}

void compare_bytes(const DumpRegion& a, const DumpRegion& b, const DecodedImage* image_a, const DecodedImage* image_b,
                   bool named_found, List& out) {
  std::size_t count = 0;
  Address first = 0;
  for (std::size_t i = 0; i < std::min(a.bytes.size(), b.bytes.size()); ++i) {
    const Address address = a.address + static_cast<Address>(i);
    if (a.bytes[i] == b.bytes[i] || (named_found && is_named(image_a, image_b, address))) continue;
    if (count++ == 0) first = address;
  }
  if (count > 0) {
    const std::size_t at = first - a.address;
    out.push_back({fmt::format("byte at {} of {}, the {}", hex_address(first), a.name,
                               count == 1 ? "only one that differs" : fmt::format("first of {} that differ", count)),
                   fmt::format("{:02X}", a.bytes[at]), fmt::format("{:02X}", b.bytes[at])});
  }
  if (a.bytes.size() != b.bytes.size())
    out.push_back({fmt::format("length of {}", a.name), fmt::format("{} bytes", a.bytes.size()),
                   fmt::format("{} bytes", b.bytes.size())});
}

std::span<const std::uint8_t> bytes_of(const MemoryDump& dump, const DecodedImage& image) {
  const DumpRegion& region = *region_at(dump, image.address);
  return std::span(region.bytes).first(std::min<std::size_t>(image.bytes, region.bytes.size()));
}

/// Wherever the images lie.
void compare_images(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b, List& out) {
  if (a.size() != b.size())
    out.push_back({"length of the image", fmt::format("{} bytes", a.size()), fmt::format("{} bytes", b.size())});
  const auto [in_a, in_b] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  if (in_a != a.end() && in_b != b.end())
    out.push_back({fmt::format("byte at {} of the image, the first that differs",
                               hex_address(static_cast<Address>(in_a - a.begin()))),
                   fmt::format("{:02X}", *in_a), fmt::format("{:02X}", *in_b)});
}

}  // namespace

std::vector<MemoryDifference> differences(const MemoryDump& a, const MemoryDump& b) {
  const DecodedMemory in_a = decoded(a), in_b = decoded(b);
  const DecodedImage* image_a = in_a.main_image();
  const DecodedImage* image_b = in_b.main_image();
  List out;
  if (image_a != nullptr && image_b != nullptr) {
    compare_parameters(*image_a, *image_b, out);
    if (image_a->identity != image_b->identity)
      out.push_back({"identity", identity_text(*image_a), identity_text(*image_b)});
    compare_tables(*image_a, *image_b, out);
    compare_headers(*image_a, *image_b, out);
  } else if (image_a != image_b) {
    out.push_back({"memory image", image_a ? "present" : "none", image_b ? "present" : "none"});
  }
  const bool named_found = !out.empty();
  if (a.image_alone || b.image_alone) {
    if (!named_found && image_a != nullptr && image_b != nullptr)
      compare_images(bytes_of(a, *image_a), bytes_of(b, *image_b), out);
    return out;
  }
  compare_commits(in_a, in_b, out);
  for (const DumpRegion& region : a.regions) {
    if (const DumpRegion* other = region_at(b, region.address))
      compare_bytes(region, *other, image_a, image_b, named_found, out);
    else
      out.push_back({"region " + region.name, "present", "none"});
  }
  for (const DumpRegion& region : b.regions)
    if (region_at(a, region.address) == nullptr) out.push_back({"region " + region.name, "none", "present"});
  return out;
}

}  // namespace ecs::commissioning
