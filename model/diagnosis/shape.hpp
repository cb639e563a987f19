// What the remaining residual looks like over one variable, in words, where the data prove them: a wave, a chirp, a
// wave that dies, a jump, a bump, a straight line, a curve; a trend or another value in each run; a difference by
// direction. Does not live here: whether it depends on the variable at all (structure.hpp).
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "model/diagnosis/diagnose.hpp"

namespace ecs::model {

/// One sentence without a full stop: "a wave whose period grows from 40 to 110 mm along X"; "" where no shape is
/// proved.
/// @param residual  um or um/m, canonical order  @param left_out  outliers, not looked at
/// @param variable  as a dependence names it
[[nodiscard]] std::string shape_in_words(const Observations& data, const Eigen::VectorXd& residual, double noise_um,
                                         const std::vector<bool>& left_out, const std::string& variable);

/// The periods that make most of what is left along the axis that moves most, as "periods along X: 40 mm (60 %), 12 mm
/// (20 %)"; "" where no period is beyond noise.
[[nodiscard]] std::string spectrum_in_words(const Observations& data, const Eigen::VectorXd& residual, double noise_um,
                                            const std::vector<bool>& left_out);

/// Fills `looks_like` of what a diagnosis lists under `where`, and adds the spectrum to its notes.
/// @param residual  with the named effects, um or um/m, canonical order
void describe_what_is_left(Diagnosis& diagnosis, const Observations& data, const std::vector<double>& residual,
                           const std::vector<bool>& left_out);

}  // namespace ecs::model
