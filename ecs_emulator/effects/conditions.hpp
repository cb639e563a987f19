// What an effect depends on, at one reading or at one instant of the machine.
#pragma once

#include <string>

namespace ecs::emulator {

class Conditions {
 public:
  Conditions() = default;
  Conditions(const Conditions&) = delete;
  Conditions& operator=(const Conditions&) = delete;
  virtual ~Conditions() = default;

  double p_mm = 0.0;      ///< of the effect's axis, from its datum
  double approach = 1.0;  ///< 1 or −1
  double curve = 0.0;     ///< value at p of the effect's curve, if it has one [um or um/m]
  double time_s = 0.0;
  double feed_mm_min = 0.0;
  double load_kg = 0.0;
  double travel_since_reversal_mm = 0.0;

  [[nodiscard]] virtual double material_degC() const = 0;
  /// At the place of a sensor.
  [[nodiscard]] virtual double degC(const std::string& sensor) const = 0;
  /// The same at time 0.
  [[nodiscard]] virtual double first_degC(const std::string& sensor) const = 0;
  /// n − n of the reference air.
  [[nodiscard]] virtual double missing_refraction() const { return 0.0; }
  /// The component that was measured separately [um or um/m].
  [[nodiscard]] virtual double known_value() const { return 0.0; }
};

/// A value that is being read from a map: what a fault of the unit changes.
struct MapReading {
  double position_mm = 0.0;
  int approach = 0;  ///< 0: the axis of the map stands still
  double gain = 1.0;
};

}  // namespace ecs::emulator
