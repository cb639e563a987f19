// Heat in and around the machine: the air over the day and bodies that follow it with a lag (closed form: no state, any
// time), screws that their nuts warm, what sensors show. Depends on simulated time, motion and seed alone.
// Does not live here: the tables of the file (ecs_emulator/errors/body_reader.cpp), formulas
// (ecs_emulator/errors/true_errors.hpp), what air does to light (ecs_emulator/instruments/interferometer.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/axis.hpp"
#include "core/terms.hpp"

namespace ecs::emulator {

struct Air {
  double temperature_degC = 20.0;
  double pressure_hPa = 1013.25;
  double humidity_pct = 50.0;  ///< relative, over water
};

/// `[air]` of the errors file; without it the air stays as `Air` has it.
struct DaySettings {
  double mean_degC = 20.0;
  double swing_degC = 0.0;   ///< half of the difference between the warmest and the coldest hour
  double warmest_h = 15.0;   ///< hour of the day, 0 … 24
  double start_h = 8.0;      ///< hour of the day at which simulated time begins
  double wander_degC = 0.0;  ///< standard deviation of slow changes from day to day (half an hour to six hours long)
  double pressure_hPa = 1013.25;
  double pressure_wander_hPa = 0.0;
  double humidity_pct = 50.0;
  double humidity_wander_pct = 0.0;
};

/// What follows the air with the time constant `lag_s` once it has stood in it long enough:
/// a wave a·cos(ωt + φ) becomes a/√(1+ω²τ²)·cos(ωt + φ − atan ωτ) (first order lag; two lags act one after the other).
class Day {
 public:
  Day() : Day(DaySettings{}, 0) {}
  /// @param seed  of the slow changes
  Day(const DaySettings& settings, std::uint64_t seed);

  /// @param time_s  simulated
  [[nodiscard]] double air_degC(double time_s) const { return following_degC(time_s, 0.0, 0.0); }
  /// A body that follows the air, seen by a sensor that follows the body. @pre lags 0 or more
  [[nodiscard]] double following_degC(double time_s, double body_lag_s, double sensor_lag_s = 0.0) const;
  [[nodiscard]] Air air(double time_s) const;

 private:
  struct Wave {
    double size = 0.0;  ///< amplitude
    double rad_per_s = 0.0;
    double phase_rad = 0.0;
  };
  static constexpr std::size_t kWander = 3;
  using Waves = std::array<Wave, kWander>;
  [[nodiscard]] static Waves wander(double deviation, std::uint64_t seed);
  [[nodiscard]] static double sum(const Waves& waves, double time_s);

  DaySettings settings_;
  std::array<Wave, 1 + kWander> temperature_{};
  Waves pressure_{};
  Waves humidity_{};
};

/// `[screw.X]`
struct ScrewSettings {
  Axis axis = Axis::X;
  double fixed_bearing_mm = 0.0;            ///< coordinate of the nut at the bearing that holds the screw
  double expansion_um_per_m_degC = 11.5;    ///< steel
  double friction_N = 0.0;                  ///< nut and bearings: force whose work becomes heat
  double friction_N_per_m_min = 0.0;        ///< its part that grows with speed
  double heat_capacity_J_per_m_degC = 0.0;  ///< of a metre of screw; above 0
  double loss_s = 1800.0;                   ///< time constant of the loss to the air; above 0
  double diffusivity_mm2_s = 12.0;          ///< steel
  double cell_mm = 20.0;                    ///< above 0
  bool positions = true;                    ///< the feedback is on the screw: what it grows is error
};

/// Diffusion in explicit steps of one second is stable, and no temperature overshoots, up to this diffusivity / cell².
inline constexpr double kMostDiffusion_per_s = 0.25;

/// Temperature of the screw above that of a screw at rest, in cells along the travel.
class ScrewHeat {
 public:
  /// @param travel_mm  of the axis; the screw reaches from the fixed bearing over all of it
  ScrewHeat(const ScrewSettings& settings, const std::array<double, 2>& travel_mm);

  /// The nut went from … to within `period_s`: what it rubs warms the cell it is in with the next step.
  void moved(double from_mm, double to_mm, double period_s) {
    const double way_mm = to_mm > from_mm ? to_mm - from_mm : from_mm - to_mm;
    if (way_mm == 0.0) return;
    const double m_min = way_mm / period_s * 0.06;
    work_J_[cell_at(to_mm)] += way_mm * 1e-3 * (settings_.friction_N + settings_.friction_N_per_m_min * m_min);
  }
  /// One second passes: dT/dt = work / capacity − T/τ + a ∂²T/∂x², no heat through the ends.
  void step();

  [[nodiscard]] double rise_degC(double at_mm) const { return rise_degC_[cell_at(at_mm)]; }
  /// What the rise and a temperature common to the whole screw add to the place of the nut:
  /// coefficient · ∫ (T − 20 °C) dx from the fixed bearing.
  [[nodiscard]] double growth_um(double at_mm, double common_degC) const;
  [[nodiscard]] const ScrewSettings& settings() const { return settings_; }

 private:
  [[nodiscard]] std::size_t cell_at(double at_mm) const {
    const double place = (at_mm - low_mm_) * cells_per_mm_;
    if (!(place > 0.0)) return 0;
    const auto cell = static_cast<std::size_t>(place);
    return cell < rise_degC_.size() ? cell : rise_degC_.size() - 1;
  }
  /// ∫ of the rise from the low end [mm·degC].
  [[nodiscard]] double integral_to(double at_mm) const;

  ScrewSettings settings_;
  double low_mm_ = 0.0;
  double cell_mm_ = 1.0;
  double cells_per_mm_ = 1.0;
  double kept_ = 1.0;        ///< part of the rise that a second leaves
  double degC_per_J_ = 0.0;  ///< of work spread over one second
  double diffusion_ = 0.0;
  std::vector<double> rise_degC_;
  std::vector<double> work_J_;
};

/// A sensor and what it reads.
using NamedTemperature = std::pair<std::string, double>;

/// `[column]`, `[material]`: follows the air with a lag.
struct BodySettings {
  double lag_s = 3600.0;             ///< above 0
  std::optional<double> start_degC;  ///< absent: has stood in the air for days
};

/// `[spindle]`: its own heat makes it longer and tilts it.
struct SpindleSettings {
  double lag_s = 1500.0;            ///< of its own heat and to the air; above 0
  double degC_per_1000_rpm = 0.0;   ///< of the rise, once it has turned long enough
  Axis axis = Axis::Z;              ///< along which it lies
  double growth_um_per_degC = 0.0;  ///< of rise; positive: the tool goes along + of the axis
  std::optional<Sense> tilt;        ///< rotation
  double tilt_um_per_m_degC = 0.0;
  std::vector<std::array<double, 2>> steps;  ///< [time_s, rpm], ascending times; the first command ends them
};

struct SensorSettings {
  enum class Of { air, material, column, spindle, screw };
  std::string name;
  Of of = Of::air;
  Axis axis = Axis::X;  ///< of a screw
  double at_mm = 0.0;   ///< where along a screw
  double lag_s = 0.0;
  double offset_degC = 0.0;
  double noise_degC = 0.0;        ///< standard deviation
  double resolution_degC = 0.01;  ///< 0: none
};

struct HeatSettings {
  std::optional<DaySettings> air;
  BodySettings column;
  BodySettings material;
  std::optional<SpindleSettings> spindle;
  std::vector<ScrewSettings> screws;
  std::vector<SensorSettings> sensors;
};

class Heat {
 public:
  Heat() : Heat(HeatSettings{}, {}, 0) {}
  /// @param travel_mm  of each axis
  Heat(const HeatSettings& settings, const PerAxis<std::array<double, 2>>& travel_mm, std::uint64_t seed);

  /// Something warms with motion.
  [[nodiscard]] bool rubs() const { return !screws_.empty(); }
  /// The carriages went from … to within a period.
  void moved(const Vector3& from_mm, const Vector3& to_mm, double period_s) {
    for (ScrewHeat& screw : screws_) {
      const std::size_t a = index_of(screw.settings().axis);
      screw.moved(from_mm[a], to_mm[a], period_s);
    }
  }
  /// Simulated time has come to `time_s`: whole seconds are stepped through, however far apart the calls are.
  void advance(double time_s) {
    while (time_s >= next_s_ - 1e-6) step();
  }
  /// The spindle turns at this speed from the next whole second on; the list of the file counts no more.
  void spindle(double rpm) { commanded_rpm_ = rpm; }

  [[nodiscard]] Air air(double time_s) const { return day_.air(time_s); }
  [[nodiscard]] bool has_air() const { return settings_.air.has_value(); }
  [[nodiscard]] double material_degC(double time_s) const;
  [[nodiscard]] std::size_t sensors() const { return settings_.sensors.size(); }
  /// True temperature at the place of a sensor, without its lag and its errors. @pre sensor < sensors()
  [[nodiscard]] double degC_at(std::size_t sensor, double time_s) const;
  /// The same when the machine was switched on.
  [[nodiscard]] double first_degC_at(std::size_t sensor) const { return first_degC_[sensor]; }
  /// What all sensors show, in the order of the file.
  [[nodiscard]] std::vector<NamedTemperature> readings(double time_s) const;
  /// Adds what screws and spindle do to the components [um, um/m].
  void add_errors(const Vector3& position_mm, double time_s, ComponentValues& values) const;

 private:
  void step();
  [[nodiscard]] double rpm_at(double time_s) const;
  [[nodiscard]] double lag_of(const SensorSettings& sensor) const;
  /// What the machine, not the air, adds at a sensor's place.
  [[nodiscard]] double own_degC(const SensorSettings& sensor) const;

  HeatSettings settings_;
  Day day_;
  std::uint64_t seed_;
  double next_s_ = 1.0;  ///< end of the step that comes next
  std::vector<ScrewHeat> screws_;
  std::optional<double> commanded_rpm_;
  double spindle_degC_ = 0.0;  ///< rise
  double column_degC_ = 0.0;   ///< above a column that has stood in the air for days
  double material_degC_ = 0.0;
  std::vector<double> shown_degC_;  ///< of own_degC(), after the sensor's lag
  std::vector<double> first_degC_;
};

}  // namespace ecs::emulator
