// The unknowns of a test by lengths as fitted: what identify.cpp solves and identified.cpp puts into words and numbers.
// Does not live here: least squares and noise (shared_noise.hpp).
#pragma once

#include <optional>
#include <vector>

#include "modules/lengths/identify.hpp"
#include "modules/lengths/shared_noise.hpp"

namespace ecs::model {

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
};

/// Fills in what the unknowns mean: curves, squareness, set-ups, the volume; what is not determined, and why.
void report_on(const FittedLengths& fitted, Identification& out);

}  // namespace ecs::model
