// The datum routine of one axis: the unit watches the CNC reference the machine and finds the same marker (thesis 5.3).
#pragma once

#include <cstdint>

#include "core/fault.hpp"
#include "core/parameters.hpp"

namespace ecs {

/// What one axis module shows in one period.
struct DatumSignals {
  double travelled_mm = 0.0;   ///< transducer position, any origin, sign as the machine coordinate
  double speed_mm_min = 0.0;   ///< signed
  bool switch_closed = false;  ///< as wired; the switch polarity says what it means
  bool marker = false;         ///< the marker passed since the last period
  double marker_at_mm = 0.0;   ///< travelled_mm at that marker
};

struct DatumState {
  DatumStage stage = DatumStage::waiting;
  DatumFailure failure = DatumFailure::none;
  double began_at_mm = 0.0;  ///< where the axis stood when the routine began
  bool began = false;
  double stage_began_at_mm = 0.0;
  double datum_travelled_mm = 0.0;         ///< travelled_mm at the datum marker, once done
  Approach direction = Approach::unknown;  ///< direction of motion at the marker, once done
};

/// Motion below this distance is no start of the reference motion.
inline constexpr double kDatumStart_mm = 0.05;
/// Times the approach speed: an axis faster than this on its switch is too fast.
inline constexpr double kFastestApproach = 1.5;
/// No marker, or no end of the switch, within this travel fails the routine (several turns of any ordinary screw).
inline constexpr double kMarkerSearch_mm = 100.0;

/// One period of the routine. Total: it waits as long as the axis has not reached its switch, or is at rest; from the
/// switch on it ends in done or failed within 2 × kMarkerSearch_mm.
void step_datum(const DatumParameters& parameters, const DatumSignals& signals, DatumState& state) noexcept;

/// Machine coordinate at the datum marker: the reference position lies `null_offset_mm` beyond the marker.
[[nodiscard]] constexpr double marker_position_mm(const DatumParameters& parameters) noexcept {
  return parameters.reference_position_mm - parameters.null_offset_mm;
}

}  // namespace ecs
