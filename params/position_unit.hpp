// How positions of the machine are shown to a person: in mm, or in inches where the parameters say that its control
// does (thesis 5.3, "machine measurement system"). The only place that knows this. Values in files, JSON and the
// program stay in mm; errors and compensation are in um in both systems.
#pragma once

#include <string>
#include <string_view>

#include "core/parameters.hpp"

namespace ecs::params {

struct PositionUnit {
  std::string_view length;  ///< "mm" or "in"
  std::string_view speed;   ///< "mm/min" or "in/min"
  double mm;                ///< length of the unit
  int decimals;             ///< of a position: as fine as a control shows it
  int speed_decimals;       ///< of a speed

  /// A number without its unit.
  [[nodiscard]] std::string position(double position_mm) const;
  [[nodiscard]] std::string speed_of(double mm_min) const;
  /// "254.0000 mm", "10.00000 in"
  [[nodiscard]] std::string with_unit(double position_mm) const;
};

[[nodiscard]] const PositionUnit& position_unit(MeasurementSystem system);

}  // namespace ecs::params
