// The machine tool that a unit stands on: axes, travels, transducers and facts, from its TOML file (docs/design.md,
// "Files"), and its rotary axes (docs/five_axes.md): a unit deals with the linear ones. The unit's own parameters live
// in core/parameters.hpp; the emulator's hidden truths are read by the emulator.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/parameters.hpp"
#include "core/thermal.hpp"
#include "kinematics/machine_pose.hpp"

namespace ecs::params {

/// One axis, machine coordinates.
struct MachineAxis {
  std::array<double, 2> travel_mm{};  ///< lower end, upper end; lower < upper
  double datum_mm = 0.0;              ///< coordinate of the reference position; scale-like errors count from here
  Transducer transducer = Transducer::encoder;
  double resolution_um = 1.0;  ///< of one position count; above 0
  // facts that an effect may use; absent: unknown
  std::optional<double> screw_pitch_mm;                  ///< above 0
  std::optional<double> scale_pitch_mm;                  ///< above 0
  std::optional<double> expansion_um_per_m_degC;         ///< of screw or scale
  PerAxis<std::optional<double>> measurement_line_mm{};  ///< coordinates of the other axes while this one was measured
  friend bool operator==(const MachineAxis&, const MachineAxis&) = default;
};

/// One rotary axis (kinematics/machine_pose.hpp).
struct MachineRotaryAxis {
  std::array<double, 2> travel_deg{};  ///< lower end, upper end; lower < upper; 360 apart: whole turns
  Vector3 direction{};                 ///< of positive rotation of the tool against the workpiece, length 1
  Vector3 pivot_mm{};                  ///< a point on its axis, all axes at 0
  /// Of one count of its absolute transducer at the unit, its sign the wiring; absent: the unit has no input for it.
  std::optional<double> resolution_deg;
  double transducer_zero_deg = 0.0;  ///< angle at 0 counts
  friend bool operator==(const MachineRotaryAxis&, const MachineRotaryAxis&) = default;
};

struct Machine {
  std::string name;
  std::string configuration;                   ///< chain string, e.g. "TXYZ" (core/terms.hpp)
  PerAxis<std::optional<MachineAxis>> axes{};  ///< absent: the machine has no such axis, though the chain may name it
  std::string rotary_configuration;            ///< with the letters of its rotary axes, "XYACTZ"; empty: it has none
  PerAxis<std::optional<MachineRotaryAxis>> rotary{};  ///< A, B, C
  /// Column of the sensor at each temperature input of the unit, "t_spindle_degC"; empty: none is connected.
  std::array<std::string, kTemperatureInputs> inputs{};
  bool states_load = false;                           ///< a host states the mass of the workpiece
  PerAxis<std::optional<double>> full_duty_mm_min{};  ///< mean speed at which motion warms the machine as measured
  /// Number of the input of a sensor, from 0; nothing: the unit has none for it.
  [[nodiscard]] std::optional<std::size_t> input_of(std::string_view sensor) const;
  friend bool operator==(const Machine&, const Machine&) = default;
};

struct MachineFile {
  Machine machine{};
  std::vector<Problem> warnings;  ///< unknown keys outside `[emulator]`, a datum outside the travel
};

/// A machine out of TOML text; every wrong value in one pass with line and column. Needed: `configuration` and, for at
/// least one axis, `travel_mm`. @param name  the file as problems name it
[[nodiscard]] Result<MachineFile> parse_machine(std::string_view text, const std::string& name);
[[nodiscard]] Result<MachineFile> read_machine(const std::filesystem::path& path);

/// The chain of the axes that exist. @pre `machine` came from parse_machine() or has a valid configuration
[[nodiscard]] std::optional<Chain> chain_of(const Machine& machine);

/// Where axis b was measured, 0 where the file says nothing.
[[nodiscard]] MeasurementLines measurement_lines_of(const Machine& machine);

/// Parameters that fit the machine to start from: its chain, axes and transducers, position scale = resolution,
/// deadband = five counts, measurement lines, reference position at the datum, onto its switch from the farther end of
/// the travel, and the widest scope its axes allow. What only the control knows (datum kind, output scale, polarity)
/// keeps the default.
[[nodiscard]] UnitParameters default_parameters_for(const Machine& machine);

struct RotaryMachine {
  Machine machine;                                     ///< the linear axes; its chain has their letters only
  std::string configuration;                           ///< as in the file: "XYACTZ"
  PerAxis<std::optional<MachineRotaryAxis>> rotary{};  ///< A, B, C: those of the configuration
};

/// The same file as parse_machine(), with the same problems: a letter without its table, a table without its letter, a
/// travel, pivot or direction that is missing or none.
[[nodiscard]] Result<RotaryMachine> parse_rotary_machine(std::string_view text, const std::string& name);
[[nodiscard]] Result<RotaryMachine> read_rotary_machine(const std::filesystem::path& path);

[[nodiscard]] bool has_rotary_axes(const RotaryMachine& machine);
/// The chain of all axes that exist.
[[nodiscard]] std::optional<kinematics::JointChain> joint_chain_of(const RotaryMachine& machine);

/// Chain, terms, directions, pivots and measurement lines; nothing if the machine has no rotary axes.
[[nodiscard]] std::optional<kinematics::JointMachine> joint_machine_of(const Machine& machine);

}  // namespace ecs::params
