// Heat in and around the machine: what its bodies' temperatures are at the simulated time, and what sensors show of
// them. Depends on simulated time, motion and seed alone.
// Does not live here: the tables of the file (ecs_emulator/errors/heat_reader.cpp), the air by itself (day.hpp),
// formulas (ecs_emulator/errors/true_errors.hpp).
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/terms.hpp"
#include "ecs_emulator/thermal/day.hpp"
#include "ecs_emulator/thermal/screw_heat.hpp"

namespace ecs::emulator {

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
