// A servo axis answering a demanded move, by the equations of thesis 3.2.1 and appendix A: position error counter and
// D/A converter, velocity loop with PI regulator, lag of the current, torque against inertia and friction, screw. Its
// constants as appendix A names them, with the values printed there, and their TOML form.
// Does not live here: recordings (trace.hpp).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace ecs::model {

enum class DriveConstant : std::uint8_t { Kd, K, Ka, Ti, Tc, Kt, Jm, J1, T1, Kw, Ke, Ks, pitch, dac_limit };
inline constexpr std::size_t kDriveConstants = 14;
[[nodiscard]] constexpr std::size_t index_of(DriveConstant constant) { return static_cast<std::size_t>(constant); }

struct DriveConstantInfo {
  DriveConstant id = DriveConstant::Kd;
  std::string_view name;     ///< the thesis's symbol: "Kw"
  std::string_view key;      ///< of the [drive] table: "Kw_V_s_per_rad"; the bare symbol is taken too
  std::string_view unit;     ///< "V s/rad"
  double printed = 0.0;      ///< appendix A; pitch: section 3.5 with figure 3.10
  std::string_view meaning;  ///< plain words
};
[[nodiscard]] const std::array<DriveConstantInfo, kDriveConstants>& drive_constants();
[[nodiscard]] const DriveConstantInfo& info_of(DriveConstant constant);

/// Every constant is positive, in the unit of its info.
struct DriveParameters {
  std::array<double, kDriveConstants> value;
  DriveParameters();  ///< as printed
  [[nodiscard]] double operator[](DriveConstant c) const { return value[index_of(c)]; }
  [[nodiscard]] double& operator[](DriveConstant c) { return value[index_of(c)]; }
  friend bool operator==(const DriveParameters&, const DriveParameters&) = default;
};

/// Reads the [drive] table of a model file; absent keys, and a file without the table, mean "as printed". The other
/// tables of a model file are left to its own reader. Refuses unknown keys and values that are not positive.
[[nodiscard]] Result<DriveParameters> parse_drive(std::string_view text, const std::string& file_name);
[[nodiscard]] Result<DriveParameters> read_drive(const std::filesystem::path& path);

/// What can be measured at the axis from outside.
enum class DriveSignal : std::uint8_t { dac, tacho, current, speed, slide };
inline constexpr std::size_t kDriveSignals = 5;
[[nodiscard]] constexpr std::size_t index_of(DriveSignal signal) { return static_cast<std::size_t>(signal); }

struct DriveSignalInfo {
  DriveSignal id = DriveSignal::dac;
  std::string_view name;  ///< as a column of a recording: "tacho_V"
  std::string_view unit;  ///< "V"
  std::string_view words;
};
[[nodiscard]] const std::array<DriveSignalInfo, kDriveSignals>& drive_signals();
[[nodiscard]] const DriveSignalInfo& info_of(DriveSignal signal);

/// A move from rest at constant feed, as the controller demands it.
struct DriveMove {
  double feed_mm_min = 1200.0;  ///< > 0
  double distance_mm = 10.0;    ///< not 0; below 0: backwards
  [[nodiscard]] double duration_s() const { return 60.0 * std::abs(distance_mm) / feed_mm_min; }
};

/// Signals at 0, step, 2 step … from the start of the move.
struct DriveResponse {
  double step_s = 0.0;
  std::array<std::vector<double>, kDriveSignals> signal;
  bool bounded = true;  ///< false: the loop is unstable; the signals end where it ran away
  /// Linear between steps; before the start as at rest, beyond the end the last value.
  [[nodiscard]] double at(DriveSignal which, double time_s) const;
};

/// The axis between two events (the D/A converter reaching or leaving its limit, the motor stopping, turning round or
/// breaking away, the end of the demand) obeys linear equations: these are advanced exactly, and the events are found
/// inside a step. The position error is taken as a continuous count: whole pulses would add about half a pulse.
/// @pre  duration_s > 0, step_s > 0; step_s below the current regulator's time constant finds every event
[[nodiscard]] DriveResponse simulated(const DriveParameters& drive, const DriveMove& move, double duration_s,
                                      double step_s = 1e-4);

}  // namespace ecs::model
