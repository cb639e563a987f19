// Location errors of rotary axes that readings of a ball cannot tell from what a model has.
#pragma once

#include <vector>

#include <Eigen/Dense>

#include "model/regression/regressors.hpp"

namespace ecs::model {

/// An effect of which the columns of others do all but this share is not told from them: what is known of it is fifty
/// times less than by itself.
inline constexpr double kLeastOwnShare = 0.02;

/// Which part of an effect's column the columns of others do not do, 0 to 1.
[[nodiscard]] double own_share(const Eigen::MatrixXd& others, const Eigen::VectorXd& column);

/// The zero of a rotary axis: COC of C. The workpiece is set up with it.
[[nodiscard]] bool is_zero_of_axis(const EffectInstance& location);

struct Exchangeable {
  EffectInstance effect;
  double stands_for = 0.0;  ///< um, um/m: size at which it would do what fitted values of the model do in its place
};
/// Location errors, zeros of axes apart, that are not in the model and that the readings do not tell from its effects.
/// None without readings of a ball.
/// @param fitted  with the values of the fit; without them `stands_for` is 0
[[nodiscard]] std::vector<Exchangeable> exchangeable_locations(const Observations& data,
                                                               const std::vector<EffectInstance>& fitted);

}  // namespace ecs::model
