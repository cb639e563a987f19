// Generalised least squares (Aitken 1935) with the covariance of the readings: noise of each, error of each block. The
// noise follows from repeats; without them it is the variance with which the residuals are as large as expected (Mandel
// and Paule 1970). Lack of fit enlarges the uncertainties by the ratio of Birge (1932).
#include "modules/standards/gauge_block_fit.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "base/linear/decompositions.hpp"
#include "base/units.hpp"
#include "laser/standards/iso230_uncertainty.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::laser {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

/// Half the width within which ISO 3650 requires the expansion coefficient of steel gauge blocks.
constexpr double kExpansionHalfWidth_um_per_m_degC = 1.0;
/// Columns of which less than this part is left beside the others are not separated from them.
constexpr double kSeparated = 1e-6;
/// Keeps the covariance positive where readings and certificates are taken as exact: a picometre.
constexpr double kLeastVariance_um2 = 1e-12;
/// Of the search for the noise: halvings of an interval, far beyond double precision.
constexpr int kHalvings = 100;

struct BlockData {
  VectorXd error_um;
  MatrixXd columns;      ///< length [m], minus the sign of the touch
  MatrixXd certificate;  ///< covariance of the certificates, of different blocks independent [um²]
  MatrixXd shared;       ///< standard uncertainties that act on all readings together, a column for each [um]
  std::vector<std::vector<Index>> groups;  ///< readings of one block touched in one way
};

BlockData block_data(const BlockTest& test) {
  const auto n = static_cast<Index>(test.readings.size());
  BlockData data{VectorXd(n), MatrixXd(n, 2), MatrixXd::Zero(n, n), MatrixXd::Zero(n, 2), {}};
  std::map<std::pair<std::string, Touch>, std::size_t> known;
  for (Index i = 0; i < n; ++i) {
    const BlockReading& one = test.readings[static_cast<std::size_t>(i)];
    const double length_m = one.nominal_mm / kMmPerM;
    data.error_um[i] = error_um_of(test, one);
    data.columns.row(i) << length_m, -static_cast<double>(one.touch);
    data.shared(i, 0) = test.common_U_um_per_m / kCoverage * length_m;
    if (one.block_degC)
      data.shared(i, 1) =
          u_of_range(2.0 * kExpansionHalfWidth_um_per_m_degC) * (*one.block_degC - kBlockReference_degC) * length_m;
    for (Index k = 0; k <= i; ++k) {
      const BlockReading& other = test.readings[static_cast<std::size_t>(k)];
      if (other.block == one.block)
        data.certificate(i, k) = data.certificate(k, i) = one.U_um / kCoverage * other.U_um / kCoverage;
    }
    const auto [place, is_new] = known.try_emplace({one.block, one.touch}, data.groups.size());
    if (is_new) data.groups.emplace_back();
    data.groups[place->second].push_back(i);
  }
  return data;
}

/// The fit with a given variance of a reading.
struct Solution {
  VectorXd sizes, left;
  MatrixXd weights;   ///< sizes = weights·errors
  double chi2 = 0.0;  ///< of the residuals
};

Solution solved(const BlockData& data, const MatrixXd& columns, double variance_um2) {
  MatrixXd covariance = data.certificate;
  covariance.diagonal().array() += variance_um2;
  const Cholesky root(covariance);
  const MatrixXd x = root.by_l(columns);
  Solution solution;
  solution.weights = product(pseudo_inverse(x), root.by_l(MatrixXd::Identity(columns.rows(), columns.rows())));
  solution.sizes = solution.weights * data.error_um;
  solution.left = data.error_um - columns * solution.sizes;
  solution.chi2 = root.by_l(solution.left).squaredNorm();
  return solution;
}

/// Of the readings about the mean of their group.
double squares_of_repeats(const BlockData& data) {
  double squares = 0.0;
  for (const auto& group : data.groups) {
    double mean = 0.0;
    for (const Index i : group) mean += data.error_um[i] / static_cast<double>(group.size());
    for (const Index i : group) squares += std::pow(data.error_um[i] - mean, 2);
  }
  return squares;
}

/// Rounding of the display is a part of the noise that identical repeats do not show (GUM F.2.2.1).
double with_resolution(const BlockTest& test, double noise_um) {
  return std::max(noise_um, u_of_range(test.resolution_um));
}

void noise_of_repeats(const BlockTest& test, const BlockData& data, BlockFit& fit) {
  for (const auto& group : data.groups) fit.degrees_of_freedom += static_cast<double>(group.size()) - 1.0;
  fit.noise_from_repeats = fit.degrees_of_freedom > 0.0;
  if (fit.noise_from_repeats)
    fit.noise_um = with_resolution(test, std::sqrt(squares_of_repeats(data) / fit.degrees_of_freedom));
}

/// The variance at which the residuals have as many squares as degrees of freedom; 0 where certificates explain more.
void noise_of_residuals(const BlockTest& test, const BlockData& data, const MatrixXd& columns, BlockFit& fit) {
  fit.degrees_of_freedom = static_cast<double>(columns.rows() - columns.cols());
  if (fit.degrees_of_freedom <= 0.0) return;
  double low = 0.0, high = least_squares(columns, data.error_um).squares_left;
  if (solved(data, columns, kLeastVariance_um2).chi2 > fit.degrees_of_freedom)
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = (low + high) / 2.0;
      (solved(data, columns, middle + kLeastVariance_um2).chi2 > fit.degrees_of_freedom ? low : high) = middle;
    }
  fit.noise_um = with_resolution(test, std::sqrt(low));
}

/// @param birge  by which the scatter about the straight line exceeds that of repeats and certificates together
BlockValue value_of(const BlockData& data, const Solution& solution, Index place, const BlockFit& fit, double birge) {
  const VectorXd weights = solution.weights.row(place).transpose();
  const double of_certificates = weights.dot(data.certificate * weights);
  BlockValue made{solution.sizes[place], {}, 0.0, 0.0};
  made.u_calibration = std::sqrt(of_certificates + (data.shared.transpose() * weights).squaredNorm());
  if (fit.noise_um) {
    const double of_noise = std::pow(*fit.noise_um, 2) * weights.squaredNorm();
    made.u_readings = std::sqrt(birge * birge * (of_noise + of_certificates) - of_certificates);
  }
  made.U = std::hypot(fit.coverage_factor * made.u_readings.value_or(0.0), kCoverage * made.u_calibration);
  return made;
}

void add_means(const BlockTest& test, const BlockData& data, const VectorXd* left, BlockFit& fit) {
  for (const auto& group : data.groups) {
    const BlockReading& first = test.readings[static_cast<std::size_t>(group.front())];
    BlockMean mean{first.block, first.touch, first.nominal_mm, group.size(), 0.0, {}};
    if (left != nullptr) mean.residual_um = 0.0;
    for (const Index i : group) {
      mean.error_um += data.error_um[i] / static_cast<double>(group.size());
      if (left != nullptr) *mean.residual_um += (*left)[i] / static_cast<double>(group.size());
    }
    fit.means.push_back(std::move(mean));
  }
}

void add_notes(const BlockTest& test, BlockFit& fit) {
  const auto note = [&](std::string text) { fit.notes.push_back(std::move(text)); };
  if (fit.error_um)
    note(fmt::format(
        "scale and constant cannot be separated: all lengths are {:g} mm, touched {}. Measure a second length as well, "
        "or the same {}",
        test.readings.front().nominal_mm, name_of(test.readings.front().touch),
        test.readings.front().touch == Touch::outside ? "inside" : "outside"));
  else if (!fit.constant_um)
    note("steps do not show the constant: both faces are touched in the same direction");
  if (!fit.noise_um)
    note(
        "as many unknowns as lengths, and no length was measured twice: the scatter of the readings is unknown and not "
        "in the uncertainties. Repeat the readings");
  else if (!fit.noise_from_repeats)
    note("no length was measured twice: the scatter is that about the straight line, and lack of fit cannot be tested");
  if (fit.lack_of_fit_p.value_or(1.0) < kBlocksLackFit)
    note(
        "the errors deviate from a straight line by more than the scatter of repeated readings explains: the error of "
        "the axis is not proportional to the length. The uncertainties include this deviation. Measure the axis with "
        "`ecs laser` or a step gauge");
  const auto any = [&](auto member) {
    return std::ranges::any_of(test.readings, [&](const BlockReading& one) { return (one.*member).has_value(); });
  };
  if (any(&BlockReading::machine_degC) && !test.machine_expansion_um_per_m_degC)
    note(
        "t_machine_degC is not used: the scale error is that at the temperature of the machine. To refer "
        "it to 20 degC, state the expansion of the machine [um/(m degC)], as in `# machine_expansion: 11.5`");
  if (!any(&BlockReading::block_degC)) note("no t_block_degC: the blocks are assumed to be at 20 degC");
}

}  // namespace

BlockFit block_fit_of(const BlockTest& test) {
  const BlockData data = block_data(test);
  BlockFit fit;
  const auto lengths = data.columns.col(0);
  const bool any_touch = data.columns.col(1).squaredNorm() > 0.0;
  MatrixXd unit = data.columns;
  unit.col(0) /= lengths.norm();
  if (any_touch) unit.col(1).normalize();
  const bool separated = any_touch && PivotedQr(unit, kSeparated).rank() == 2;
  // One length, touched in one way: its mean error is all that the readings show.
  const MatrixXd columns = separated    ? data.columns
                           : !any_touch ? MatrixXd(lengths)
                                        : MatrixXd(VectorXd::Ones(data.columns.rows()));
  noise_of_repeats(test, data, fit);
  if (!fit.noise_from_repeats) noise_of_residuals(test, data, columns, fit);
  const double variance = std::pow(fit.noise_um.value_or(0.0), 2) + kLeastVariance_um2;
  const Solution solution = solved(data, columns, variance);
  double birge = 1.0, freedom = fit.degrees_of_freedom;
  const double beyond = static_cast<double>(data.groups.size()) - static_cast<double>(columns.cols());
  if (fit.noise_from_repeats && beyond > 0.0) {
    const double ratio = std::max(0.0, solution.chi2 - squares_of_repeats(data) / variance) / beyond;
    fit.lack_of_fit_p = std::exp(model::ln_f_tail(ratio, beyond, freedom));
    if (*fit.lack_of_fit_p < kBlocksLackFit) {
      birge = std::sqrt(ratio);
      freedom = beyond;
    }
  }
  fit.coverage_degrees = freedom;
  fit.coverage_factor = model::coverage_factor(freedom);
  const auto value = [&](Index place) { return value_of(data, solution, place, fit, birge); };
  if (separated || !any_touch) fit.scale_um_per_m = value(0);
  if (separated) {
    fit.constant_um = value(1);
    const MatrixXd spread = solution.weights * solution.weights.transpose();
    fit.correlation = spread(0, 1) / std::sqrt(spread(0, 0) * spread(1, 1));
  }
  if (any_touch && !separated) fit.error_um = value(0);
  add_means(test, data, fit.error_um ? nullptr : &solution.left, fit);
  add_notes(test, fit);
  return fit;
}

}  // namespace ecs::laser
