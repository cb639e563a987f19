// What differs between two memories: by place, as many bytes as are known on both sides; and by name: parameters by
// key, tables by component and position, header by line, commit records, then the bytes that have no name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commissioning/memory/decode.hpp"
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

struct MemoryDifference {
  std::string what;  ///< "parameter axis.X.deadband_um", "table EXX forward", "header date", "bytes of system RAM"
  std::string a;
  std::string b;
};

/// Empty exactly if every region that both hold has the same bytes, and both hold the same regions. With an image
/// alone: if it has the same bytes as the active image of the other.
[[nodiscard]] std::vector<MemoryDifference> differences(const MemoryDump& a, const MemoryDump& b);

}  // namespace ecs::commissioning
