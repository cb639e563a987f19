// Which readings share a zero of the readout: it is set when the optics move to another line, and usually again when a
// line is measured later.
#pragma once

#include <map>

#include "laser/measurement_set.hpp"
#include "model/data/observations.hpp"

namespace ecs::model {

/// Numbers the lines of each sense along each axis (Observations::line): another parked position or set-up is another
/// line.
void set_lines(Observations& data);

/// Finds the runs with which sessions begin (Observations::sessions): with a run of another file, on another clock, or
/// after a pause longer than the session before it has lasted, where every session has two runs or more.
/// @param set     that `data` is made from  @param clocks  by run the number of its clock; empty: one for all
void set_sessions(Observations& data, const laser::MeasurementSet& set, const std::map<int, int>& clocks);

}  // namespace ecs::model
