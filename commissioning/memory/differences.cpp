#include "commissioning/memory/differences.hpp"

#include <algorithm>
#include <functional>

#include <fmt/format.h>

namespace ecs::commissioning {
namespace {

/// Every byte that differs, by address, until `visit` returns false.
void visit_differences(const MemoryBytes& a, const MemoryBytes& b, const std::function<bool(Address)>& visit) {
  for (const MemoryRegion& region : a.regions()) {
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
  const ByteView bytes = memory.known(as.first, std::min(as.bytes, 8u));
  std::string text;
  for (const std::uint8_t byte : bytes) text += fmt::format("{:02X}", byte);
  return text;
}

void add_missing(const MemoryBytes& a, const MemoryBytes& b, bool in_a, std::vector<DifferenceRow>& rows) {
  for (const MemoryRegion& region : a.regions())
    if (b.region_of(region.first) == nullptr)
      rows.push_back({region.first, 0, region.name, in_a ? "there" : "not there", in_a ? "not there" : "there"});
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

}  // namespace ecs::commissioning
