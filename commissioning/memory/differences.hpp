// Where two memories differ, by place: as many as are known on both sides. By meaning:
// commissioning/memory/compare.hpp.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commissioning/memory/names.hpp"

namespace ecs::commissioning {

struct DifferenceRow {
  Address first = 0;        ///< first byte that differs
  std::uint32_t bytes = 0;  ///< that differ; 0: the region is in one of the two only
  std::string name;         ///< field, table or region
  std::string a;
  std::string b;
};

/// One row for each field, table or, where bytes have no name, region.
[[nodiscard]] std::vector<DifferenceRow> difference_rows(const MemoryBytes& a, const MemoryNames& names_a,
                                                         const MemoryBytes& b, const MemoryNames& names_b);
[[nodiscard]] bool differ_at(const MemoryBytes& a, const MemoryBytes& b, Address address);
/// The next byte after `address` that differs, else the first one; nothing: there is none.
[[nodiscard]] std::optional<Address> next_difference(const MemoryBytes& a, const MemoryBytes& b, Address address);

}  // namespace ecs::commissioning
