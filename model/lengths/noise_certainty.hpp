// What it costs that the variances of the noise are themselves estimates: the covariance of the unknowns grows, and the
// coverage factor of an expanded uncertainty is that of Student's t with the degrees of freedom of this very value.
// Sources: M. G. Kenward, J. H. Roger, Biometrics 53 (1997) 983; before them R. N. Kackar, D. A. Harville, J. Am. Stat.
// Assoc. 79 (1984) 853 (the first part), F. E. Satterthwaite, Biometrics Bull. 2 (1946) 110 (degrees of freedom), and
// the Guide to the expression of uncertainty in measurement (JCGM 100:2008), annex G.
// Does not live here: the estimates (noise_fit.hpp).
#pragma once

#include "model/lengths/shared_noise.hpp"

namespace ecs::model {

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

/// Half width over standard uncertainty that holds 95.45 % (of the normal distribution: 2).
[[nodiscard]] double coverage_factor(double degrees_of_freedom);

}  // namespace ecs::model
