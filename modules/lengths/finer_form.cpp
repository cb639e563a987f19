// Form that is finer than the knots: the same lengths, with the same noise, fitted with knots about half as far apart.
// What both fits differ by, beyond what noise makes them differ, belongs to the uncertainty of the coarser one.

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include "modules/lengths/fitted_lengths.hpp"

namespace ecs::model {
namespace {

/// Times as many intervals, where there are targets enough; the second for components that the first tells too badly.
constexpr std::array kFiner{2.0, 1.5};
/// A difference of which the variance by noise is more times that of the value itself says nothing of the value.
constexpr double kMostNoise = 2.0;
constexpr std::size_t kMorePlaces = 3;  ///< than intervals of cubic splines must have been measured

/// Knots of the finer fit; nothing where no axis has targets enough.
std::optional<PerAxis<double>> finer_knots(const FittedLengths& fitted, double factor) {
  PerAxis<double> out{};
  bool any = false;
  for (const Axis axis : kAllAxes) {
    const std::size_t a = index_of(axis);
    std::set<long long> places;
    for (const LengthReading& r : fitted.test.readings) places.insert(std::llround(r.position_mm[a]));
    const int now = fitted.curves.intervals(axis);
    const int allowed = static_cast<int>(places.size()) - static_cast<int>(kMorePlaces);
    const int intervals = std::max(now, std::min(static_cast<int>(std::ceil(factor * now)), allowed));
    any = any || intervals > now;
    const auto& [low, high] = fitted.curves.machine().travel_mm[a];
    out[a] = (high - low) / intervals;
  }
  return any ? std::optional(out) : std::nullopt;
}

/// Two fits of the same whitened lengths. Each value is rows · x, x = back · basisᵀ · y, so the difference of two is as
/// uncertain as the difference of their weights of y is long, in units of the noise that the finer fit leaves.
class TwoFits {
 public:
  TwoFits(const FittedLengths& fitted, const MachineCurves& finer, const Eigen::VectorXd& known) : coarse_(fitted) {
    const auto m = fitted.curves.size(), m_finer = finer.size(), n = fitted.residual_um.size();
    const auto others = fitted.linear.columns.cols() - m;
    Eigen::MatrixXd columns(n, m_finer + others);
    for (Eigen::Index i = 0; i < n; ++i) {
      const LengthReading& r = fitted.test.readings[static_cast<std::size_t>(i)];
      columns.row(i).head(m_finer) = fitted.linear.direction.row(i) *
                                     finer.error_rows(r.position_mm, r.approach, fitted.test.tools[r.tool].offset_mm);
    }
    columns.rightCols(others) = fitted.linear.columns.rightCols(others);
    Eigen::VectorXd of_finer = Eigen::VectorXd::Zero(m_finer + others);
    of_finer.tail(others) = known.tail(others);
    const SharedNoise shared(fitted.test, fitted.curves, fitted.linear.direction);
    const Eigen::VectorXd lengths_um = fitted.residual_um + fitted.linear.columns * fitted.solution.x;
    const Eigen::MatrixXd both = whitened_lengths(shared, columns, lengths_um, of_finer, fitted.variances);
    finer_ = solution_of(both.leftCols(both.cols() - 1), both.col(both.cols() - 1));
    noise_ = finer_.squares / static_cast<double>(std::max<Eigen::Index>(1, both.rows() - finer_.rank));
  }

  /// Root of the mean square by which values differ, less what noise explains of it. Nothing where the finer fit tells
  /// them too badly.
  [[nodiscard]] std::optional<double> difference(const Eigen::MatrixXd& rows, Eigen::Index first,
                                                 const Eigen::MatrixXd& rows_finer, Eigen::Index first_finer) const {
    const auto p = rows.cols(), p_finer = rows_finer.cols();
    for (Eigen::Index i = 0; i < rows_finer.rows(); ++i)
      if (is_free(finer_, rows_finer.row(i), first_finer)) return std::nullopt;
    const Eigen::VectorXd d =
        rows_finer * finer_.x.segment(first_finer, p_finer) - rows * coarse_.solution.x.segment(first, p);
    const Eigen::MatrixXd weights =
        (rows_finer * finer_.back.middleRows(first_finer, p_finer)) * finer_.basis.transpose() -
        (rows * coarse_.solution.back.middleRows(first, p)) * coarse_.solution.basis.transpose();
    const double by_noise = noise_ * weights.squaredNorm();
    const double own = (rows * coarse_.solution.covariance.block(first, first, p, p)).cwiseProduct(rows).sum();
    if (by_noise > kMostNoise * own) return std::nullopt;
    return std::sqrt(std::max(0.0, d.squaredNorm() - by_noise) / static_cast<double>(d.size()));
  }

 private:
  const FittedLengths& coarse_;
  LengthSolution finer_;
  double noise_ = 1.0;  ///< variance of what the finer fit leaves, of that of the coarser one
};

/// Values of a component where they are reported.
Eigen::MatrixXd values_of(const MachineCurves& curves, Component component, const std::vector<double>& position_mm) {
  const auto count = is_squareness(component) ? 1 : static_cast<Eigen::Index>(position_mm.size());
  Eigen::MatrixXd rows(count, curves.block(component).size());
  for (Eigen::Index i = 0; i < count; ++i)
    rows.row(i) =
        curves.value_row(component, is_squareness(component) ? 0.0 : position_mm[static_cast<std::size_t>(i)], 0)
            .transpose();
  return rows;
}

Eigen::MatrixXd volume_rows(const MachineCurves& curves, const Vector3& tool_mm) {
  const auto places = volume_places(curves.machine(), kVolumePlaces);
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(3 * places.size()), curves.size());
  for (std::size_t i = 0; i < places.size(); ++i)
    rows.middleRows(static_cast<Eigen::Index>(3 * i), 3) =
        curves.volume_rows(places[i].position_mm, places[i].approach, tool_mm);
  return rows;
}

/// What a fit with these knots says of everything of which nothing is known yet.
void compare(const FittedLengths& fitted, const MachineCurves& finer, const Eigen::VectorXd& known, FinerForm& out) {
  const TwoFits fits(fitted, finer, known);
  for (std::size_t c = 0; c < kComponents; ++c) {
    const auto component = static_cast<Component>(c);
    const auto& block = fitted.curves.block(component);
    if (block.size() == 0 || out.u[c]) continue;
    std::vector<double> places;
    if (!is_squareness(component)) places = reported_mm(fitted.curves, moving_axis(component));
    out.u[c] = fits.difference(values_of(fitted.curves, component, places), block.first,
                               values_of(finer, component, places), finer.block(component).first);
  }
  const Vector3& tool_mm = fitted.test.tools.front().offset_mm;
  if (!out.volume_um)
    out.volume_um = fits.difference(volume_rows(fitted.curves, tool_mm), 0, volume_rows(finer, tool_mm), 0);
}

}  // namespace

FinerForm finer_form(const FittedLengths& fitted, CurveSettings settings, const Eigen::VectorXd& known) {
  FinerForm out;
  for (const double factor : kFiner) {
    const auto knots_mm = finer_knots(fitted, factor);
    if (!knots_mm) continue;
    settings.knots_mm = *knots_mm;
    const MachineCurves finer(fitted.curves.machine(), settings);
    const auto unknowns = finer.size() + fitted.nuisance.end - fitted.nuisance.first;
    if (fitted.residual_um.size() >= unknowns + kLeastFreedom) compare(fitted, finer, known, out);
  }
  return out;
}

}  // namespace ecs::model
