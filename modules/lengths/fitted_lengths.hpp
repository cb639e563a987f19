// The unknowns of a test by lengths as fitted: what identify.cpp solves and identified.cpp puts into words and numbers.
// Does not live here: least squares and noise (shared_noise.hpp).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "modules/lengths/identify.hpp"
#include "modules/lengths/shared_noise.hpp"

namespace ecs::model {

inline constexpr int kLeastFreedom = 10;  ///< readings more than unknowns
inline constexpr int kVolumePlaces = 5;   ///< along each axis

/// A zero that was taken again within a run: the readings from a line on are a run of their own.
struct ZeroJump {
  std::size_t set_up = 0, tool = 0;
  int run = 1;        ///< as the file has it
  int run_after = 1;  ///< of the readings from `line` on
  int line = 0;       ///< of the file
};

/// A station whose place in the file is not the one that the directions of its lengths show.
struct MisplacedStation {
  std::size_t set_up = 0;
  Vector3 off_mm{};   ///< from where the file puts it
  double u_mm = 0.0;  ///< standard uncertainty of the distance
};

/// Form that the curves cannot follow because their knots are too far apart.
struct FinerForm {
  /// What it adds to the standard uncertainty, mean over the travel [um, um/m]; empty: the lengths do not tell.
  std::array<std::optional<double>, kComponents> u{};
  std::optional<double> volume_um;  ///< the same of the error vector, over the volume
};

struct FittedLengths {
  FittedLengths(LengthTest measured, MachineCurves made) : test(std::move(measured)), curves(std::move(made)) {}

  LengthTest test;  ///< without what was left out
  MachineCurves curves;
  NuisanceColumns nuisance;
  Linearised linear;
  LengthSolution solution;
  NoiseCertainty certainty;     ///< covariance of all unknowns
  Eigen::VectorXd residual_um;  ///< plain
  Eigen::VectorXd sigmas;       ///< of each residual, of the standard deviation that it has without its own reading
  ScatterVariances variances{};
  double single_um = 0.0;  ///< standard deviation of a single reading, all scatter together
  std::vector<LengthOutlier> outliers;
  std::vector<ZeroJump> jumps;
  std::optional<MisplacedStation> misplaced;
  int degrees_of_freedom = 0;
  FinerForm finer;
};

/// Where the curves of an axis are reported: both ends, the knots and the middles between them.
[[nodiscard]] std::vector<double> reported_mm(const MachineCurves& curves, Axis axis);

/// Columns and lengths whitened side by side; what is known beforehand as rows below.
/// @param known  of each unknown 1/variance before anything is measured, or 0
[[nodiscard]] Eigen::MatrixXd whitened_lengths(const SharedNoise& shared, const Eigen::MatrixXd& columns,
                                               const Eigen::VectorXd& lengths_um, const Eigen::VectorXd& known,
                                               const ScatterVariances& variances);

/// By the same lengths with about twice as many knots.
/// @param settings  of the curves of `fitted`
/// @param known     as in whitened_lengths(), of the unknowns of `fitted`
[[nodiscard]] FinerForm finer_form(const FittedLengths& fitted, CurveSettings settings, const Eigen::VectorXd& known);

/// Fills in what the unknowns mean: curves, squareness, set-ups, the volume; what is not determined, and why.
void report_on(const FittedLengths& fitted, Identification& out);

}  // namespace ecs::model
