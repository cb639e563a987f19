// On which machine a set was measured, as its header says. Does not live here: whether that is the machine at hand.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "laser/csv_table.hpp"

namespace ecs::laser {

/// Empty: not said.
struct MeasuredMachine {
  std::string name;
  std::string serial_number;
};

/// Our own `machine` and `serial_number`, and what instruments write: `Machine`, `Serial No`. The first of each counts.
[[nodiscard]] MeasuredMachine measured_machine(const std::vector<MetadataEntry>& metadata);

/// "measured on \"a\", the machine file is of \"b\"" where both say a name, or a serial number, and they differ;
/// nothing where they do not contradict each other.
/// @param whose  "the machine file is of"
[[nodiscard]] std::optional<std::string> other_machine(const MeasuredMachine& measured, const MeasuredMachine& at_hand,
                                                       std::string_view whose);

}  // namespace ecs::laser
