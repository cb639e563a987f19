// What only the virtual workshop knows about its machine: the table `[emulator]` of the machine file
// (docs/emulator.md). The rest of that file is read by params/machine.hpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "core/parameters.hpp"
#include "params/machine.hpp"

namespace ecs::emulator {

/// Drive, transducer wiring and reference switch of one axis.
struct AxisSettings {
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
  double marker_pitch_mm = 10.0;                     ///< one marker a revolution; above 0
  double null_offset_mm = 0.0;                       ///< from the datum marker to the reference position
  double switch_width_mm = 10.0;                     ///< above 0
  int switch_polarity = 1;                           ///< +1: closed while the axis stands on it
};

/// The instruments: standard deviations of one reading, resolutions, and how badly they are set up.
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
};

struct EmulatorSettings {
  std::string serial_number = "EMULATOR-1";  ///< up to 16 characters
  std::uint64_t seed = 1;
  double load_kg = 0.0;
  Vector3 tool_offset_mm{};      ///< from the point that the unlevered machine carries to the tool point
  std::filesystem::path errors;  ///< errors file; empty: a perfect machine
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
