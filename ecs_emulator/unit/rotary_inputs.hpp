// The rotary axes of a map at the inputs of the rack: which of them have an input, their counts, and what is wrong with
// them. Does not live here: what the core makes of the counts (core/rotary.hpp), raising a fault (unit.hpp).
#pragma once

#include <optional>

#include "core/fault.hpp"
#include "core/rotary.hpp"
#include "ecs_emulator/machine/machine_tool.hpp"

namespace ecs::emulator {

/// A fault of a rotary axis; its letter is the address of the fault.
struct RotaryInputFault {
  Fault fault = Fault::none;
  char letter = '\0';
};

class RotaryInputs {
 public:
  /// What the machine shows in this period.
  void take(const RotaryWires& wires);
  /// From now on the axes of a map. @param working  its places; without rotary axes: none
  void use(const std::optional<RotarySetup>& map, const RotaryWorking& working);
  /// What its transducer shows; nothing: not wired, or its signal is lost. It is absolute.
  [[nodiscard]] std::optional<double> angle_deg(const RotaryAxis& axis) const;

  /// A rotary axis of a map whose angle the rack does not get.
  [[nodiscard]] std::optional<char> lacking(const RotarySetup& map) const;
  /// A lost transducer, or an axis that moved further in one period than it can.
  [[nodiscard]] std::optional<RotaryInputFault> fault(double period_s) const;
  /// By place. @pre no fault
  [[nodiscard]] PerRotary<std::int64_t> counts() const;
  /// By place. @pre no fault
  [[nodiscard]] PerRotary<double> angles_deg() const;

 private:
  [[nodiscard]] const std::optional<RotarySignals>& wire_of(char letter) const;

  PerRotary<RotaryAxis> axes_{};  ///< of the map, by place
  RotaryWires wires_{}, wires_before_{};
};

}  // namespace ecs::emulator
