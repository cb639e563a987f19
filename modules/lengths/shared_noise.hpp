// What does not repeat, as lengths see it: noise of each reading, scatter of every component at a stop, and a shape of
// every pass of an axis. Translations and angles scatter alike, and act through the levers of the carriage that moves;
// an axis that is parked keeps the scatter of its last stop.
// How large each scatter is, from the residuals of the lengths themselves: restricted maximum likelihood.
// Sources: H. D. Patterson, R. Thompson, Biometrika 58 (1971) 545; the steps by average information: A. R. Gilmour,
// R. Thompson, B. R. Cullis, Biometrics 51 (1995) 1440; where they fail, those of H. Zhou, L. Hu, J. Zhou, K. Lange,
// J. Comput. Graph. Statist. 28 (2019) 350, which never make the likelihood less.
// What it costs that these variances are themselves estimates: the covariance of the unknowns grows, and the
// coverage factor of an expanded uncertainty is that of Student's t with the degrees of freedom of this very value.
// Sources: M. G. Kenward, J. H. Roger, Biometrics 53 (1997) 983; before them R. N. Kackar, D. A. Harville, J. Am. Stat.
// Assoc. 79 (1984) 853 (the first part), F. E. Satterthwaite, Biometrics Bull. 2 (1946) 110 (degrees of freedom), and
// the Guide to the expression of uncertainty in measurement (JCGM 100:2008), annex G.
// Linear least squares of whitened observations: the solution, its covariance, and what the observations leave free.
// Does not live here: what the unknowns mean (identify.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "modules/lengths/curves.hpp"
#include "modules/lengths/length_test.hpp"

namespace ecs::model {

struct LengthSolution {
  Eigen::VectorXd x;
  Eigen::MatrixXd covariance;  ///< where the whitened observations have unit variance
  Eigen::MatrixXd free;        ///< orthonormal basis of what is not determined, columns scaled by `norm`
  Eigen::VectorXd norm;        ///< of the columns
  Eigen::MatrixXd basis;       ///< orthonormal, of what the columns reach
  Eigen::MatrixXd back;        ///< from coordinates in it to unknowns; covariance = back · backᵀ
  double squares = 0.0;        ///< of the whitened residuals
  int rank = 0;
};

/// By orthogonal decomposition: of what is not determined, the solution of least norm.
[[nodiscard]] LengthSolution solution_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& y);

/// Values alone, by the normal equations: good enough to make linear about.
[[nodiscard]] Eigen::VectorXd near_solution_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& y);

/// Columns divided by their lengths; those of nothing but rounding become nothing, their `norm` 1.
[[nodiscard]] Eigen::MatrixXd scaled_columns(const Eigen::MatrixXd& columns, Eigen::VectorXd& norm);

/// Whether the observations leave a linear value of unknowns free. @param first  of the unknowns that `row` weighs
[[nodiscard]] bool is_free(const LengthSolution& solution, const Eigen::VectorXd& row, Eigen::Index first);

enum class Scatter : std::uint8_t {
  reading,     ///< of each reading on its own [um]
  stop,        ///< of each translation of each axis at a stop [um]
  stop_angle,  ///< of each angle of each axis at a stop [um/m]
  pass,        ///< shape of each translation of each axis in a pass [um]
  pass_angle,  ///< shape of each angle of each axis in a pass [um/m]
};
inline constexpr std::size_t kScatters = 5;
/// um², of angles (um/m)²
using ScatterVariances = std::array<double, kScatters>;
[[nodiscard]] constexpr std::size_t index_of(Scatter scatter) { return static_cast<std::size_t>(scatter); }

/// The covariance of readings, block by block: readings of different blocks share nothing.
class SharedNoise {
 public:
  /// @param direction  of each reading, a row each
  SharedNoise(const LengthTest& test, const MachineCurves& curves, const Eigen::MatrixXd& direction);

  struct Block {
    std::vector<Eigen::Index> readings;                     ///< in the order in which they were taken
    std::array<Eigen::MatrixXd, kScatters - 1> covariance;  ///< of unit variance of each scatter but that of a reading
  };
  [[nodiscard]] const std::vector<Block>& blocks() const { return blocks_; }
  [[nodiscard]] static Eigen::MatrixXd covariance_of(const Block& block, const ScatterVariances& variances);
  /// Rows multiplied by the inverse Cholesky factor of their covariance.
  [[nodiscard]] Eigen::MatrixXd whitened(const Eigen::MatrixXd& rows, const ScatterVariances& variances) const;
  /// Of a single reading: all scatter together, mean over the readings.
  [[nodiscard]] double mean_variance(const ScatterVariances& variances) const;

 private:
  std::vector<Block> blocks_;
};

/// The rows of some readings, in their order.
[[nodiscard]] Eigen::MatrixXd rows_of(const Eigen::MatrixXd& all, const std::vector<Eigen::Index>& readings);

struct NoiseFit {
  ScatterVariances variances{};
  Eigen::VectorXd x;  ///< solution with these variances
  int steps = 0;
};

/// @param precision  of each unknown before anything is measured: 1/variance, 0 where nothing is known
/// @param start      where to begin; each above 0
[[nodiscard]] NoiseFit fitted_noise(const SharedNoise& shared, const Eigen::MatrixXd& columns, const Eigen::VectorXd& y,
                                    const Eigen::VectorXd& precision, const ScatterVariances& start);

class NoiseCertainty {
 public:
  NoiseCertainty() = default;
  /// As if the noise were known: the covariance as it is.
  explicit NoiseCertainty(const Eigen::MatrixXd& covariance) : covariance_(covariance), plain_(covariance) {}
  /// @param basis      orthonormal, of the columns whitened with these variances; rows of prior knowledge below
  /// @param back       from coordinates in it to the unknowns
  /// @param variances  as estimated
  /// @param estimated  which of them are; the others are known
  NoiseCertainty(const SharedNoise& shared, const Eigen::MatrixXd& basis, const Eigen::MatrixXd& back,
                 const ScatterVariances& variances, const std::array<bool, kScatters>& estimated);

  /// Of the unknowns, with what the estimated variances add.
  [[nodiscard]] const Eigen::MatrixXd& covariance() const { return covariance_; }
  /// Of the estimates: inverse of the expected information.
  [[nodiscard]] const Eigen::MatrixXd& spread() const { return spread_; }
  /// Effective ones of the variance trace(weights · covariance), weights of the unknowns from `first` on.
  [[nodiscard]] double degrees_of_freedom(const Eigen::MatrixXd& weights, Eigen::Index first) const;
  /// The same of a linear value.
  [[nodiscard]] double degrees_of_freedom(const Eigen::VectorXd& row, Eigen::Index first) const;

 private:
  [[nodiscard]] double freedom_of(double variance, const Eigen::VectorXd& slopes) const;
  Eigen::MatrixXd covariance_, plain_;   ///< with and without what is added
  std::vector<Eigen::MatrixXd> change_;  ///< of `plain_` with each estimated variance
  Eigen::MatrixXd spread_;
};

}  // namespace ecs::model
