// What differs between two memories, by name: parameters by key, tables by component and position, header by line,
// commit records; then the bytes that have no name.
#pragma once

#include <string>
#include <vector>

#include "commissioning/memory/decode.hpp"

namespace ecs::commissioning {

struct MemoryDifference {
  std::string what;  ///< "parameter axis.X.deadband_um", "table EXX forward", "header date", "bytes of system RAM"
  std::string a;
  std::string b;
};

/// Empty exactly if every region that both hold has the same bytes, and both hold the same regions.
[[nodiscard]] std::vector<MemoryDifference> differences(const MemoryDump& a, const MemoryDump& b);

}  // namespace ecs::commissioning
