// Scale error of an axis and the constant of its tool or probe from lengths of artefacts (laser/standards/
// gauge_blocks.hpp): error of length i = scale·Lᵢ − constant·tᵢ, tᵢ = 1 touched outside, −1 inside, 0 as a step.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "laser/standards/gauge_blocks.hpp"

namespace ecs::laser {

/// A fitted value with its parts of uncertainty.
struct BlockValue {
  double value = 0.0;
  std::optional<double> u_readings;  ///< standard uncertainty from the scatter of the readings; none: it is not known
  double u_calibration = 0.0;        ///< from certificates and expansion coefficient
  double U = 0.0;                    ///< expanded (95.45 %)
};

/// All readings of one block touched in one way.
struct BlockMean {
  std::string block;
  Touch touch = Touch::outside;
  double nominal_mm = 0.0;
  std::size_t count = 0;
  double error_um = 0.0;                ///< error_um_of(), mean
  std::optional<double> residual_um{};  ///< from the fit; none: nothing was separated
};

struct BlockFit {
  std::optional<BlockValue> scale_um_per_m;  ///< error of a travel per metre, actual − target
  /// By which the tool or probe is larger than assumed; the lost motion of the axis is a part of it.
  std::optional<BlockValue> constant_um;
  std::optional<BlockValue> error_um;  ///< over the only length, where the two above cannot be separated
  std::optional<double> correlation;   ///< of scale and constant, where both are given
  std::optional<double> noise_um;      ///< standard deviation of one reading
  double degrees_of_freedom = 0.0;     ///< of it
  double coverage_factor = 0.0;        ///< of the readings' part of U (Student's t); of the calibration's it is 2
  double coverage_degrees = 0.0;       ///< degrees of freedom to which that factor belongs
  bool noise_from_repeats = false;     ///< else from the residuals of different lengths
  std::optional<double> lack_of_fit_p;
  std::vector<BlockMean> means;    ///< in the order of the file
  std::vector<std::string> notes;  ///< what these readings cannot say, in words
};

/// Lack of fit with a smaller p enlarges the uncertainties to the scatter of the lengths about the straight line.
inline constexpr double kBlocksLackFit = 0.01;

[[nodiscard]] BlockFit block_fit_of(const BlockTest& test);

}  // namespace ecs::laser
