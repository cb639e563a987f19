// Machines that the tests of the virtual workshop measure and compensate.
#pragma once

#include "ecs_emulator/instruments/measurement.hpp"
#include "ecs_emulator/machine/simulation.hpp"
#include "laser/measurement_set.hpp"
#include "tests/support/test.hpp"

namespace ecs::emulator::test {

/// Instruments without noise, fine, perfectly set up.
inline constexpr const char* kPerfectInstruments = R"(
[emulator.laser]
linear_noise_um = 0
straightness_noise_um = 0
angular_noise_um_per_m = 0
level_noise_um_per_m = 0
indicator_noise_um = 0
linear_resolution_um = 0
straightness_resolution_um = 0
angular_resolution_um_per_m = 0
level_resolution_um_per_m = 0
indicator_resolution_um = 0
setup_slope_um_per_m = 0
setup_offset_um = 0
)";

/// A machine of three short axes, datum at 0.
inline std::string small_machine(const std::string& configuration = "TXYZ") {
  return "name = \"test machine\"\nconfiguration = \"" + configuration + R"("
[axis.X]
travel_mm = [-500.0, 0.0]
[axis.Y]
travel_mm = [-400.0, 0.0]
[axis.Z]
travel_mm = [-300.0, 0.0]
)";
}

/// The same with drives that follow to any fineness, where whole pulses would hide what is tested.
inline std::string ideal_machine(const std::string& configuration = "TXYZ") {
  std::string text = small_machine(configuration);
  for (const char* axis : {"X", "Y", "Z"}) text += std::string("[emulator.axis.") + axis + "]\ndrive = \"ideal\"\n";
  return text;
}

/// A table that tilts and turns.
inline constexpr const char* kTrunnion = R"(
name = "trunnion"
configuration = "XYACTZ"
[axis.X]
travel_mm = [0.0, 1200.0]
[axis.Y]
travel_mm = [0.0, 600.0]
[axis.Z]
travel_mm = [-600.0, 0.0]
[axis.A]
travel_deg = [-110.0, 30.0]
pivot_mm = [600.0, 300.0, -560.0]
resolution_deg = 0.001
[axis.C]
travel_deg = [0.0, 360.0]
pivot_mm = [600.0, 300.0, -560.0]
resolution_deg = 0.001
)";

inline WorkshopMachine machine_of(const std::string& text) {
  return must(parse_workshop_machine(text, "machine.toml", "."));
}

inline TrueErrors errors_of(const std::string& text) { return must(TrueErrors::parse(text, "errors.toml", ".")); }

/// Why the errors are refused.
inline std::string refused_errors(const std::string& text) {
  return to_text(must_fail(TrueErrors::parse(text, "errors.toml", ".")));
}

inline Simulation simulation_of(const std::string& errors, const std::string& machine = small_machine(),
                                std::uint64_t seed = 1) {
  return Simulation(machine_of(machine + kPerfectInstruments), errors_of(errors), seed);
}

inline laser::MeasurementSet measured(Simulation& simulation, const MeasurementPlan& plan) {
  return must(measure(simulation, plan));
}

inline double reading_at(const laser::MeasurementSet& set, double target_mm, Approach approach) {
  for (const auto& reading : set.readings)
    if (laser::target_mm(reading) == target_mm && reading.approach == approach) return reading.error;
  FAIL("no reading at " << target_mm);
  return 0.0;
}

}  // namespace ecs::emulator::test
