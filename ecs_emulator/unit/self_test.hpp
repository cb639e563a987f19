// What the unit checks before it compensates (thesis 5.3): axis memory, block check, parameters, map.
// Does not live here: when it does so, and what follows (unit.hpp).
#pragma once

#include <optional>

#include "core/fault.hpp"
#include "core/tick.hpp"
#include "ecs_emulator/unit/memory.hpp"
#include "ecs_emulator/unit/rack.hpp"

namespace ecs::emulator {

struct TestVerdict {
  Fault fault = Fault::none;
  Address address = 0;         ///< of the failing location, or of the image at fault
  std::optional<Axis> axis;    ///< an axis that the parameters name and the rack has no such module for
  std::uint32_t expected = 0;  ///< block check stored with the active image
  std::uint32_t found = 0;     ///< block check computed over it
};

/// First address of axis memory (both banks) that does not hold what is written; its content is restored. The commit
/// records are not written to: they carry their own check.
[[nodiscard]] std::optional<Address> test_axis_memory(UnitMemory& memory);

/// The image that the commit records name, from its first byte to the end of its bank.
struct ActiveImage {
  Commit commit{};
  Address first = 0;
};
[[nodiscard]] std::optional<ActiveImage> active_image(const UnitMemory& memory);
/// The first byte of a commit record that is neither erased nor sound.
[[nodiscard]] std::optional<Address> damaged_record(const UnitMemory& memory);
/// What the unit knows of itself and, by the active image if it is sound, of its machine.
[[nodiscard]] OwnIdentity own_identity_of(const UnitMemory& memory, std::string_view serial_number);
/// The bank that holds no active image.
[[nodiscard]] Address inactive_bank(const UnitMemory& memory);
/// The address lies in the bank of the active image, which nothing but the unit's own tests may write.
[[nodiscard]] bool in_active_bank(const UnitMemory& memory, Address address);

/// Block check, parameters and map of the active image; `map` is built on success.
/// An axis that the parameters name needs a module in the rack, for the transducer that they name.
[[nodiscard]] TestVerdict test_map(const UnitMemory& memory, const AxisModules& axis_modules, CompiledMap& map);

/// The parameters of the active image if its block check holds.
[[nodiscard]] std::optional<UnitParameters> stored_parameters(const UnitMemory& memory);

}  // namespace ecs::emulator
