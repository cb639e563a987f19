// The true error components of the machine along its axes: what a volume is computed from.
// Does not live here: their sum at the tool (survey.hpp drives there).
#pragma once

#include <array>
#include <string>
#include <vector>

#include "ecs_emulator/machine/simulation.hpp"

namespace ecs::emulator {

/// Systematic part at the coordinates asked for [um, um/m]; empty for an axis that does not exist.
struct AxisComponents {
  std::array<std::vector<double>, kCurves> forward;
  std::array<std::vector<double>, kCurves> reverse;
  ComponentValues squareness{};
};

/// The other axes stand at the datum. Refused: a component that depends on where another axis stands, by its name.
/// @param places_mm  coordinates of each axis
[[nodiscard]] Result<AxisComponents> components_along(const Simulation& simulation,
                                                      const PerAxis<std::vector<double>>& places_mm);

/// A cause that the components above leave out: they are those of a machine at rest, as it was switched on.
struct LeftOut {
  std::string cause;  ///< "scatter", "load", …
  std::vector<Component> components;
};
/// Those that the errors file has: found by changing one condition after the other.
[[nodiscard]] std::vector<LeftOut> left_out(const Simulation& simulation);

/// The same of the rotary axes: by A, B, C and sense, at the angles asked for; location errors.
struct RotaryComponents {
  PerAxis<std::array<std::vector<double>, 6>> forward;
  PerAxis<std::array<std::vector<double>, 6>> reverse;
  PerAxis<SixOfAxis> location{};
};
[[nodiscard]] RotaryComponents rotary_components(const Simulation& simulation,
                                                 const PerAxis<std::vector<double>>& angles_deg);

}  // namespace ecs::emulator
