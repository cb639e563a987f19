// Lengths as linear observations of a machine's curves, of the stations and zeros of the instruments, and the noise
// that readings share. Does not live here: least squares (identify.hpp).
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
  Eigen::Index first = 0;                                                  ///< behind the machine's unknowns
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

/// How the scatter of a machine that stops goes into lengths, relative to the variance of a single reading by the
/// instrument: a parked axis keeps its scatter until it moves again, a pass of an axis has a shape of its own.
struct NoiseRatios {
  double stop = 0.0;  ///< variance along each direction, of each axis
  double pass = 0.0;
};

/// Which readings share what.
class SharedNoise {
 public:
  SharedNoise(const LengthTest& test, const LengthMachine& machine);
  /// Rows multiplied by the inverse Cholesky factor of their covariance; adds half the log of its determinant.
  [[nodiscard]] Eigen::MatrixXd whitened(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& direction,
                                         const NoiseRatios& ratios, double* half_log_determinant) const;
  [[nodiscard]] bool any_parked() const { return any_parked_; }

 private:
  struct Key {
    PerAxis<int> stop{}, pass{};
    PerAxis<double> part{};
  };
  [[nodiscard]] double covariance(std::size_t i, std::size_t k, double cosine, const NoiseRatios& ratios) const;
  std::vector<Key> keys_;
  std::vector<std::vector<std::size_t>> groups_;  ///< readings that may share something
  bool any_parked_ = false;
};

}  // namespace ecs::model
