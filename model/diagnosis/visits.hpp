// Points that are seen again and again, each time displaced and turned together as one rigid body: the machine or the
// workpiece arrives elsewhere. Internal to model/ (Eigen). Does not live here: the repeatability of a pose (ISO 9283:
// modules/standards).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "model/data/observations.hpp"

namespace ecs::model {

/// A rigid motion (three translations, three rotations) of its own for each group of readings.
struct MotionsOfGroups {
  std::string by;  ///< "run", "approach", or the column that numbers the groups
  std::size_t groups = 0;
  double rms_before_um = 0.0, rms_after_um = 0.0;  ///< off the mean of each point
  double held_out_rms_um = 0.0;                    ///< of readings that the motion of their group was not fitted to
  double p_value = 1.0;                            ///< of the F test
  double shift_um = 0.0, turn_um_per_m = 0.0;      ///< rms of a coordinate over the groups
};

/// The grouping that explains the readings best, if it does so beyond chance (F test) and predicts at least half of the
/// points that are left out within the groups; of a group of three points, in which the other two leave a turn free, a
/// reading is left out instead. Nothing without three points or more, not on a line, that several groups see in EX, EY
/// and EZ at once.
/// @param residual  um
[[nodiscard]] std::optional<MotionsOfGroups> motions_of_groups(const Observations& data,
                                                               const Eigen::VectorXd& residual);

/// Points in space: at least two coordinates change from point to point of a line, and no line along an axis has the
/// targets that a curve needs.
[[nodiscard]] bool are_scattered_points(const Observations& data);

/// How likely errors of the points themselves, without any law, are explained as well by an effect of position, which
/// does the same at each visit (F test over the means of the points in the directions on which it acts). 1 where it
/// leaves no point to be predicted; nothing for an effect that does not do the same at each visit, and of points seen
/// once, of which the noise is what they scatter.
/// @param others  columns of everything else that is fitted  @param effect  those of the effect
[[nodiscard]] std::optional<double> chance_of_points(const Observations& data, const std::vector<bool>& left_out,
                                                     const Eigen::MatrixXd& others, const Eigen::MatrixXd& effect,
                                                     const Eigen::VectorXd& target);

/// "Each visit (run) has a rigid motion of its own: …", as an answer begins.
[[nodiscard]] std::string words_for(const MotionsOfGroups& motions);

}  // namespace ecs::model
