// Files of measurements: plans (samples/*/plan.toml) turned into requests for the workshop, readings as files of the
// instruments that the host can read. The host reads a plan for the titles and published bands of its table, which mean
// nothing here. Does not live here: the formats of readings (the writers of laser/).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"

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

/// By the extension of the name: .csv; Renishaw .rtl, .rta or .rts (whichever fits), .ren (means, compensation), .rtx
/// (captures); API .pos (means); ISO 230-2 assignments .dat; .env.pos: the weather in a SIOS log. Any other extension
/// is a `usage` problem, a set that the format cannot hold is refused with the reason.
[[nodiscard]] Result<void> write_measurement(const std::filesystem::path& path, const laser::MeasurementSet& set);

}  // namespace ecs::emulator
