// Two error maps, or two measurements such as meshes of a bed, beside each other: last year's and today's, those of two
// machines, before and after a repair. How far their curves differ, how much of the difference is a slope and a
// reversal, and the difference as a measurement that `ecs model diagnose` can name the cause of.
// Does not live here: a map beside the unit's memory (map_in_unit.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "core/axis.hpp"
#include "laser/map/error_map.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::commissioning {

/// One curve: error by the second file less error by the first [um, um/m].
struct CurveChange {
  Component component = Component::EXX;
  bool by_approach = false;         ///< one of the files has a table for each approach
  Vector3 parked_mm{};              ///< position of the other axes of a measured line; 0 of a map
  std::vector<double> position_mm;  ///< points of either file where both reach, ascending, at least two
  std::vector<double> forward;      ///< as many
  std::vector<double> reverse;      ///< the same as `forward` unless by_approach
};

struct ChangeFigures {
  double largest = 0.0;  ///< with its sign
  double at_mm = 0.0;
  Approach approach = Approach::unknown;  ///< of the largest; unknown: both
  double rms = 0.0;
  double mean = 0.0;
  double slope_per_m = 0.0;  ///< of the least squares line through both approaches
  double reversal = 0.0;     ///< mean forward less mean reverse
  double left_rms = 0.0;     ///< without mean, slope and reversal
};
[[nodiscard]] ChangeFigures figures_of(const CurveChange& change);

/// A location error or a curve of a rotary axis, or a size of bending: error by the second map less error by the first.
struct RotaryChange {
  std::string name;                       ///< "XOC", "EXC", "machine_bending x_sin"
  std::string unit;                       ///< um, um/m
  double largest = 0.0;                   ///< with its sign
  std::optional<double> at_deg;           ///< of a curve
  Approach approach = Approach::unknown;  ///< of the largest; unknown: both
};

struct MapChange {
  std::vector<CurveChange> curves;
  std::vector<RotaryChange> rotary;  ///< of the axes of both maps, what is not zero in both
  std::vector<std::string> notes;    ///< other machine or chain, curves that one map lacks or that share no travel
};

/// A curve declared zero counts as zero, and so does a curve that a rotary axis does not have. Neither curves nor
/// rotary axes: the notes say why.
[[nodiscard]] MapChange change_between(const laser::ErrorMap& first, const laser::ErrorMap& second);

/// The same of the measured lines of X, Y and Z: means of the readings at each target, of the lines with the same
/// component and parked position (to 0.001 mm). The notes name the lines that only one file has, and what else is not
/// compared. @pre readings along lines of linear axes only
[[nodiscard]] MapChange change_between(const laser::MeasurementSet& first, const laser::MeasurementSet& second);

/// Readings at every point of the curves of X, Y and Z, one for each approach; without approaches where neither file
/// knows them.
/// @param machine  of the second file; may be empty
/// @param names    of the two files
[[nodiscard]] laser::MeasurementSet measurement_of(const MapChange& change, const std::string& machine,
                                                   const std::vector<std::string>& names);

/// A row for each curve.
[[nodiscard]] Cell change_cell(const MapChange& change);
/// A row for each location error and curve of rotary axes; no text where there are none.
[[nodiscard]] Cell rotary_change_cell(const MapChange& change);
/// No curve or location error differs by half of the last digit of a map file.
[[nodiscard]] bool is_without_change(const MapChange& change);
/// What the files show, and what they do not.
[[nodiscard]] std::string closing_text(const MapChange& change, const std::string& first, const std::string& second);

}  // namespace ecs::commissioning
