// The unit's 19 inch sub-rack: which module sits in which slots (thesis 5.2).
// Does not live here: what the modules do (unit.hpp, axis_module.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/axis.hpp"
#include "core/parameters.hpp"

namespace ecs::emulator {

/// The axis modules of the rack by the transducer that they decode; nothing: no module for this axis.
using AxisModules = PerAxis<std::optional<Transducer>>;

/// Slots of 4 HP in a rack of 84 HP. The thesis gives 8 encoder or 5 resolver modules and 5 axis memory modules; that
/// they have ten and five slots of their own is our reading.
inline constexpr int kRackSlots = 21;

struct RackModule {
  std::string name;  ///< "microprocessor", "axis memory 1", "resolver axis X", …
  int first_slot = 1;
  int slots = 1;  ///< a resolver module is two boards, piggy-backed
};

/// Every module from the left. @pre 1 … 5 axis memory modules
[[nodiscard]] std::vector<RackModule> rack_of(std::uint8_t memory_modules, const AxisModules& axis_modules);

}  // namespace ecs::emulator
