// What only the virtual workshop knows about its machine: the table `[emulator]` of the machine file
// (docs/emulator.md), with its axes and its instruments. The rest of that file is read by params/machine.hpp. Does not
// live here: what an axis does (ecs_emulator/machine/machine_tool.hpp), what the instruments show
// (ecs_emulator/instruments/laser.hpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/axis.hpp"
#include "core/parameters.hpp"
#include "ecs_emulator/drive/servo_drive.hpp"
#include "params/machine.hpp"

namespace ecs::emulator {

enum class DriveKind : std::uint8_t {
  servo,  ///< the drive of appendix A in its closed loop, step by step (ecs_emulator/machine/machine_tool.hpp)
  ideal,  ///< follows its command with one lag, to any fineness
};
/// Where the transducer sits.
enum class Feedback : std::uint8_t {
  scale,  ///< on the slide
  motor,  ///< on the screw: play and wind-up stay outside the loop
};

/// Drive, transducer wiring and reference switch of one axis.
struct AxisSettings {
  DriveKind drive = DriveKind::servo;
  Feedback feedback = Feedback::scale;
  double friction_Nm = 0.02538878;  ///< at the motor, Coulomb
  double breakaway_Nm = 0.0;        ///< at standstill, where it is more: stick-slip
  double slip_mm_s = 1.0;           ///< speed over which friction falls from the one to the other; above 0
  SlideSettings slide{};
  TransducerSettings transducer{};
  double dac_um_per_count = 0.1;        ///< what one D/A count moves the axis; the sign is the wiring of the amplifier
  double kv_per_s = 30.0;               ///< gain of the position loop, above 0
  double acceleration_mm_s2 = 500.0;    ///< above 0
  double rapid_mm_min = 10'000.0;       ///< above 0
  double servo_lag_um_per_m_min = 0.0;  ///< how far the axis lags behind a reading taken on the fly
  int count_polarity = 1;               ///< −1: the transducer counts backwards
  // referencing
  DatumKind reference_kind = DatumKind::fanuc;
  Approach reference_direction = Approach::forward;  ///< onto the switch
  double reference_speed_mm_min = 1000.0;            ///< above 0
  double creep_speed_mm_min = 300.0;                 ///< from the switch to the marker; above 0
  double marker_pitch_mm = 10.0;                     ///< one marker a revolution; above 0
  double null_offset_mm = 0.0;                       ///< from the datum marker to the reference position
  double switch_width_mm = 10.0;                     ///< above 0
  int switch_polarity = 1;                           ///< +1: closed while the axis stands on it
};

/// What the display makes of air or material.
enum class Compensation : std::uint8_t {
  off,       ///< reckons with the reference: 20 °C, 1013.25 hPa, 50 %; material 20 °C
  manual,    ///< air: measured once at set-up and held; material: the entered temperature
  automatic  ///< sensors all the while
};
[[nodiscard]] std::string_view name_of(Compensation compensation);
[[nodiscard]] std::optional<Compensation> compensation_named(std::string_view name);

/// Standard deviations of one reading, resolutions, and how well the instruments are set up. The defaults are good
/// instruments, set up perfectly but for the straight-edge.
struct LaserSettings {
  double linear_noise_um = 0.1;
  double straightness_noise_um = 0.5;
  double angular_noise_um_per_m = 0.5;
  double level_noise_um_per_m = 1.0;
  double indicator_noise_um = 0.5;
  double linear_resolution_um = 0.01;
  double straightness_resolution_um = 0.1;
  double angular_resolution_um_per_m = 0.1;
  double level_resolution_um_per_m = 1.0;
  double indicator_resolution_um = 1.0;
  double setup_slope_um_per_m = 20.0;  ///< standard deviation of the slope between straight-edge and axis
  double setup_offset_um = 10.0;       ///< standard deviation

  // linear
  double wavelength_nm = 632.9908;        ///< in vacuum
  double fringe_parts = 0.0;              ///< counts for each fringe of half a wavelength; 0: without steps
  double dead_path_m = 0.0;               ///< from interferometer to reflector where the display is set to zero
  bool dead_path_compensation = false;    ///< the length of the dead path has been entered
  double misalignment_mrad = 0.0;         ///< between beam and axis, towards the next axis (X → Y → Z → X)
  double head_drift_um_per_h = 0.0;       ///< of head or fixtures, along the axis
  double turbulence_um_per_sqrt_m = 0.0;  ///< standard deviation, times the root of the path
  double turbulence_time_s = 2.0;         ///< correlation time; of the straightness optics too
  double nonlinearity_nm = 0.0;           ///< amplitude of mixed polarisations
  double nonlinearity_cycles = 1.0;       ///< for each fringe: 1 (period half a wavelength) or 2 (a quarter)
  Compensation air_compensation = Compensation::automatic;
  double air_sensor_error_degC = 0.0;  ///< what the sensor reads too much; so the next three
  double pressure_sensor_error_hPa = 0.0;
  double humidity_sensor_error_pct = 0.0;
  double material_sensor_error_degC = 0.0;
  Compensation material_compensation = Compensation::off;
  double material_degC = 20.0;            ///< entered
  double expansion_um_per_m_degC = 11.7;  ///< entered

  // on the fly
  double trigger_latency_s = 0.0;  ///< from the position pulse to the reading
  double trigger_rate_Hz = 0.0;    ///< the reading waits for the next tick of this clock; 0: for none

  // straightness
  double straightness_noise_um_per_m = 0.0;       ///< grows with the axial range, added in quadrature
  double straightness_turbulence_um_per_m = 0.0;  ///< standard deviation for each metre of range, correlated
  double air_gradient_degC_per_m = 0.0;           ///< across the beam, in the direction of the sense

  // angular
  double angular_scale_error_pct = 0.0;  ///< the reflectors stand closer together than the display thinks
  double angular_drift_um_per_m_h = 0.0;

  // level
  double level_settling_s = 0.0;           ///< time constant; 0: at once
  double level_hysteresis_um_per_m = 0.0;  ///< between tilting one way and the other
  double level_zero_um_per_m = 0.0;        ///< what it shows where it should show zero

  // indicator against a square
  double square_error_um_per_m = 0.0;    ///< by which the square's angle exceeds the right one
  double indicator_hysteresis_um = 0.0;  ///< between plunging in and out
};

/// What a person sets at the instrument for one measurement; absent: as in the machine file.
struct InstrumentSetting {
  std::optional<Compensation> air;
  std::optional<Compensation> material;
  std::optional<double> material_degC;
  std::optional<double> dead_path_m;
  std::optional<double> misalignment_mrad;
  std::optional<double> trigger_latency_s;
  std::optional<bool> reversed;  ///< square or straight edge turned over; absent: as it was first, nothing is written
};
[[nodiscard]] LaserSettings with(LaserSettings settings, const InstrumentSetting& setting);

/// A tool of the machine's magazine.
struct MagazineTool {
  std::uint16_t number = 0;
  Vector3 offset_mm{};  ///< true, as `tool_offset_mm` of EmulatorSettings
};

struct EmulatorSettings {
  std::string serial_number = "EMULATOR-1";  ///< up to 16 characters
  std::uint64_t seed = 1;
  double load_kg = 0.0;
  Vector3 tool_offset_mm{};  ///< from the point that the unlevered machine carries to the tool point
  std::vector<MagazineTool> tools;
  bool tool_wires = false;        ///< the control's tool number is wired to the unit
  bool power_on_wire = false;     ///< the control's "power on" is wired to the unit
  std::optional<Axis> deviation;  ///< an instrument on the machine shows the unit the error of the tool along it
  std::filesystem::path errors;   ///< errors file; empty: a perfect machine
  PerAxis<AxisSettings> axes{};
  LaserSettings laser{};
};

/// The machine file as the workshop sees it.
struct WorkshopMachine {
  params::Machine machine{};
  EmulatorSettings settings{};
};

/// Both halves of a machine file; relative names in it count from its folder.
[[nodiscard]] Result<WorkshopMachine> load_workshop_machine(const std::filesystem::path& path);
[[nodiscard]] Result<WorkshopMachine> parse_workshop_machine(std::string_view text, const std::string& file,
                                                             const std::filesystem::path& folder);

}  // namespace ecs::emulator
