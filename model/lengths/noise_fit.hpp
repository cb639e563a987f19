// How large each scatter is, from the residuals of the lengths themselves: restricted maximum likelihood.
// Sources: H. D. Patterson, R. Thompson, Biometrika 58 (1971) 545; the steps by average information: A. R. Gilmour,
// R. Thompson, B. R. Cullis, Biometrics 51 (1995) 1440; where they fail, those of H. Zhou, L. Hu, J. Zhou, K. Lange,
// J. Comput. Graph. Statist. 28 (2019) 350, which never make the likelihood less.
// Does not live here: which readings share what (shared_noise.hpp).
#pragma once

#include "model/lengths/shared_noise.hpp"

namespace ecs::model {

struct NoiseFit {
  ScatterVariances variances{};
  Eigen::VectorXd x;  ///< solution with these variances
  int steps = 0;
};

/// @param precision  of each unknown before anything is measured: 1/variance, 0 where nothing is known
/// @param start      where to begin; each above 0
[[nodiscard]] NoiseFit fitted_noise(const SharedNoise& shared, const Eigen::MatrixXd& columns, const Eigen::VectorXd& y,
                                    const Eigen::VectorXd& precision, const ScatterVariances& start);

}  // namespace ecs::model
