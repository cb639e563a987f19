// Lengths as linear observations of a machine's curves and of the stations and zeros of the instruments.
// Does not live here: the noise that readings share (shared_noise.hpp), least squares (length_solution.hpp).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "model/lengths/curves.hpp"
#include "model/lengths/length_test.hpp"

namespace ecs::model {

/// Columns of what belongs to the measurement: of each set-up and tool a correction of the station [mm → um], of each
/// set-up, run and tool a zero [um], of each set-up a scale [um/m] of known standard deviation.
struct NuisanceColumns {
  std::map<std::pair<std::size_t, std::size_t>, Eigen::Index> station;     ///< by set-up and tool: first of three
  std::map<std::tuple<std::size_t, int, std::size_t>, Eigen::Index> zero;  ///< by set-up, run and tool
  std::map<std::size_t, Eigen::Index> scale;                               ///< by set-up
  std::optional<Eigen::Index> bar;  ///< in place of the zeros of ball bars, where the length of the bar is known
  Eigen::Index first = 0;           ///< behind the machine's unknowns
  Eigen::Index end = 0;
};
[[nodiscard]] NuisanceColumns nuisance_of(const LengthTest& test, Eigen::Index first);

/// Where the unknowns stand about which the observations are linear.
struct Linearised {
  Eigen::MatrixXd columns;     ///< by reading and unknown
  Eigen::VectorXd nominal_um;  ///< deviation at the values given
  Eigen::MatrixXd direction;   ///< unit vectors, a row each
};
/// @param values  of all unknowns; zeros to begin with
[[nodiscard]] Linearised linearised(const LengthTest& test, const MachineCurves& curves,
                                    const NuisanceColumns& nuisance, const Eigen::VectorXd& values);

}  // namespace ecs::model
