// What is left of a machine's error once a control adds what it adds: along the measurement lines and over the volume.
// Does not live here: the tables (tables.hpp), where the error is known from (a map, or a model in app/).
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "modules/controllers/tables.hpp"

namespace ecs::controllers {

/// Largest and root mean square of |residual| along X, Y, Z and of the vector, um.
struct ResidualSize {
  std::array<double, kAxes + 1> largest_um{};
  std::array<double, kAxes + 1> rms_um{};
};

/// One set of places, the error there, and what is left with each way of compensating.
struct ResidualRow {
  std::string where;  ///< "line of X", "volume"
  std::size_t places = 0;
  ResidualSize before;   ///< not compensated
  ResidualSize unit;     ///< the whole map in our unit, as its parameters tell it to
  ResidualSize control;  ///< only the exported tables, in the control
};

using commissioning::ErrorsAt;

/// The error that a map says the machine has: minus its compensation, every term of the chain, straight lines between
/// its points. What the map does not hold counts as zero.
[[nodiscard]] ErrorsAt errors_of_map(const ExportSource& source);

/// Places along the line of each axis (201 by each approach, the others parked) and over the volume (11 or 21 on each
/// axis, all axes forward, then all reverse). Every residual is counted from the reference point, mean of both
/// approaches: a constant shift of the machine is in every work offset.
/// @param lines  from which the control levers rotations
[[nodiscard]] Result<std::vector<ResidualRow>> residuals(const ExportSource& source, const ControllerTables& control,
                                                         const MeasurementLines& lines, const ErrorsAt& errors);

}  // namespace ecs::controllers
