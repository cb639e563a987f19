// A proposed run as the operator takes it to the machine: a part program in the dialect of thesis appendix B, and a
// target list in the form of a measurement set. Does not live here: which run to propose (next_measurement.hpp).
#pragma once

#include <string>

#include "laser/measurement_set.hpp"
#include "model/planning/next_measurement.hpp"
#include "params/machine.hpp"

namespace ecs::model {

/// Blocks begin with ">", `$REP n` … `$END` repeat, ";" begins a comment. G90/G91 absolute/incremental, G00 rapid, G01
/// at feed F, G04H dwell [s], M08 takes a reading, M09 resets the switch. Equal steps become loops, others a line each.
/// The head tells the operator what to set up. No motion leaves the travel of the machine's axes: an overrun is cut
/// short at the end of travel, a target beyond it is left out and said in a comment.
[[nodiscard]] std::string part_program(const MeasurementProposal& proposal, const params::Machine& machine);

/// The rows to be measured, in the order of the program: one per reading, every known condition filled in, `reading` 0.
/// The metadata say that it holds no readings.
[[nodiscard]] laser::MeasurementSet target_set(const MeasurementProposal& proposal);
/// The same as CSV text (docs/laser.md).
[[nodiscard]] std::string target_list(const MeasurementProposal& proposal);

}  // namespace ecs::model
