// Lengths that had no part in a map beside the lengths that the map predicts: how much of the errors it explains, and
// where it fails. Thesis 4.1.2 tells of such a test of a synthesised volume by a double ball gauge (agreement "better
// than 84 %"); ISO 230-6 does the same along diagonals.
// Does not live here: files (length_test.hpp), what lengths alone say of the machine (identify.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "core/parameters.hpp"
#include "laser/map/error_map.hpp"
#include "modules/lengths/length_test.hpp"

namespace ecs::model {

/// The lengths of one set-up with one tool.
struct ComparedSetUp {
  std::string name, tool;
  std::size_t readings = 0;
  double error_um = 0.0;            ///< root mean square of the lengths, zeros and station fitted
  double left_um = 0.0;             ///< the same of what the map leaves
  Vector3 station_correction_mm{};  ///< with the map; 0 for an interferometer
};

struct ComparedLength {
  int line = 0;  ///< of the file
  double error_um = 0.0, left_um = 0.0;
};

struct LengthComparison {
  std::size_t readings = 0;
  int unknowns = 0;                 ///< zeros and stations that the lengths determine
  double error_um = 0.0;            ///< standard deviation of a length from nominal, by degrees of freedom
  double left_um = 0.0;             ///< the same from what the map predicts
  std::optional<double> repeat_um;  ///< of a single reading, from poses measured in several runs
  std::vector<ComparedSetUp> set_ups;
  std::vector<ComparedLength> worst;  ///< what the map leaves, the largest first
  /// 1 − left/error: 1 where the map explains everything, 0 or less where it explains nothing.
  [[nodiscard]] double agreement() const { return error_um > 0.0 ? 1.0 - left_um / error_um : 0.0; }
};

/// The zero of each run and the station of each set-up and tool are fitted, once without and once with the map: the
/// instrument states neither exactly. Refused: no more lengths than unknowns.
/// @param parameters  squareness, convention and measurement lines that the map is read with
/// @param worst       how many lengths to list
[[nodiscard]] Result<LengthComparison> compared_lengths(const LengthTest& test, const laser::ErrorMap& map,
                                                        const UnitParameters& parameters, std::size_t worst);

}  // namespace ecs::model
