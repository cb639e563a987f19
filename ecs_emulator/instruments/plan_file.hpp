// A plan of measurements as TOML (samples/*/plan.toml), turned into requests for the workshop. The host reads the same
// file for the titles and published bands of its table, which mean nothing here.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/result.hpp"

namespace ecs::emulator {

struct PlanChoice {
  std::string phase;             ///< "before" or "after": rows of that phase, and of both; empty: every row
  std::filesystem::path folder;  ///< each row is written to `<folder>/<name>.csv`
  std::string date;              ///< into the metadata; empty: none
  std::string engineer;
  bool moved = false;  ///< targets moved off equal steps (base/moved_targets.hpp)
};

/// One `measure` request (docs/emulator.md) for each row, in file order. Every wrong key or value is reported with its
/// line.
[[nodiscard]] Result<std::vector<std::string>> requests_of(const std::filesystem::path& plan, const PlanChoice& choice);

}  // namespace ecs::emulator
