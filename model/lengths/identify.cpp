#include "model/lengths/identify.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/units.hpp"
#include "model/lengths/fitted_lengths.hpp"

namespace ecs::model {
namespace {

constexpr int kLeastFreedom = 10;  ///< readings more than unknowns
constexpr double kBeyondTravel_mm = 0.5;
constexpr int kLinearisations = 4;
constexpr double kOutlierLevel = 0.01;  ///< chance to find one among all readings of normal noise
constexpr int kOutlierRounds = 6;
constexpr double kLeastSigma_um = 1e-9;
constexpr double kNoNoise_um = 1e-4;  ///< residuals below are rounding: there is no noise to divide
constexpr double kMostIntervals = 12.0;
/// Where the search for the variances begins: a good instrument on a common machine [um², (um/m)²].
constexpr ScatterVariances kCommonScatter{0.04, 1.0, 0.25, 0.02, 0.02};

class LengthFit {
 public:
  LengthFit(LengthTest test, const IdentifySettings& settings, MachineCurves curves)
      : settings_(settings), fitted_(std::move(test), std::move(curves)) {
    fitted_.variances = kCommonScatter;
  }

  FittedLengths run() {
    solve();
    if (!settings_.keep_outliers)
      for (int round = 0; round < kOutlierRounds && take_outliers(); ++round) solve();
    count_noise();
    return std::move(fitted_);
  }

 private:
  /// Of each unknown before anything is measured: of scales, and of the length of a ball bar.
  [[nodiscard]] Eigen::VectorXd precision() const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(fitted_.nuisance.end);
    if (settings_.scale_um_per_m > 0.0)
      for (const auto& [set_up, column] : fitted_.nuisance.scale)
        out(column) = 1.0 / (settings_.scale_um_per_m * settings_.scale_um_per_m);
    if (fitted_.nuisance.bar) out(*fitted_.nuisance.bar) = 1.0 / (*fitted_.test.bar_um * *fitted_.test.bar_um);
    return out;
  }

  void linearise_about(const Eigen::VectorXd& x) {
    fitted_.linear = linearised(fitted_.test, fitted_.curves, fitted_.nuisance, x);
    if (settings_.scale_um_per_m <= 0.0)
      for (const auto& [set_up, column] : fitted_.nuisance.scale) fitted_.linear.columns.col(column).setZero();
    y_ = -fitted_.linear.nominal_um + fitted_.linear.columns * x;
    for (Eigen::Index i = 0; i < y_.size(); ++i)
      y_(i) += fitted_.test.readings[static_cast<std::size_t>(i)].deviation_um;
  }

  /// Columns and lengths whitened; what is known beforehand as rows below.
  [[nodiscard]] Eigen::MatrixXd whitened(const SharedNoise& shared) const {
    const auto n = y_.size(), p = fitted_.nuisance.end;
    const Eigen::VectorXd known = precision();
    Eigen::MatrixXd both(n, p + 1);
    both << fitted_.linear.columns, y_;
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n + (known.array() > 0.0).count(), p + 1);
    out.topRows(n) = shared.whitened(both, fitted_.variances);
    Eigen::Index row = n;
    for (Eigen::Index j = 0; j < p; ++j)
      if (known(j) > 0.0) out(row++, j) = std::sqrt(known(j));
    return out;
  }

  void solve() {
    fitted_.nuisance = nuisance_of(fitted_.test, fitted_.curves.size());
    Eigen::VectorXd x = Eigen::VectorXd::Zero(fitted_.nuisance.end);
    const auto p = x.size();
    shared_.reset();  // by the directions of the poses that are wanted: the errors turn them by 1e-5
    for (int i = 0; i < kLinearisations; ++i) {
      linearise_about(x);
      if (!shared_) shared_.emplace(fitted_.test, fitted_.curves, fitted_.linear.direction);
      if (i + 1 == kLinearisations) break;
      if (i + 2 == kLinearisations && choose_noise(*shared_, x)) continue;
      const Eigen::MatrixXd both = whitened(*shared_);
      x = near_solution_of(both.leftCols(p), both.col(p));
    }
    const Eigen::MatrixXd both = whitened(*shared_);
    fitted_.solution = solution_of(both.leftCols(p), both.col(p));
    fitted_.degrees_of_freedom = static_cast<int>(both.rows()) - fitted_.solution.rank;
    const double unit =
        std::max(kLeastSigma_um * kLeastSigma_um, fitted_.solution.squares / std::max(1, fitted_.degrees_of_freedom));
    for (double& variance : fitted_.variances) variance *= unit;
    fitted_.solution.back *= std::sqrt(unit);
    fitted_.solution.covariance *= unit;
    fitted_.residual_um = y_ - fitted_.linear.columns * fitted_.solution.x;
    fitted_.single_um = std::sqrt(shared_->mean_variance(fitted_.variances));
    find_sigmas(*shared_);
  }

  /// The variances by the residuals, and the solution with them; nothing where there is nothing to divide.
  bool choose_noise(const SharedNoise& shared, Eigen::VectorXd& x) {
    const Eigen::VectorXd left = y_ - fitted_.linear.columns * x;
    const double rms_um = std::sqrt(left.squaredNorm() / static_cast<double>(left.size()));
    divided_ = left.size() - x.size() >= kLeastFreedom && rms_um >= kNoNoise_um;
    if (!divided_) {
      fitted_.variances = {1.0, 0.0, 0.0, 0.0, 0.0};
      return false;
    }
    const NoiseFit fit = fitted_noise(shared, fitted_.linear.columns, y_, precision(), fitted_.variances);
    fitted_.variances = fit.variances;
    x = fit.x;
    return true;
  }

  /// The covariance of the unknowns, with what it costs that the noise is known from the residuals alone.
  void count_noise() {
    if (fitted_.degrees_of_freedom < kLeastFreedom) {
      fitted_.certainty = NoiseCertainty(fitted_.solution.covariance);
      return;
    }
    std::array<bool, kScatters> estimated{true, divided_, divided_, divided_, divided_};
    fitted_.certainty =
        NoiseCertainty(*shared_, fitted_.solution.basis, fitted_.solution.back, fitted_.variances, estimated);
  }

  /// P·y over the root of its variance (the studentised deleted residual of correlated readings: J. Haslett, K. Hayes,
  /// J. R. Stat. Soc. B 60 (1998) 201).
  void find_sigmas(const SharedNoise& shared) {
    fitted_.sigmas.resize(fitted_.residual_um.size());
    for (const auto& block : shared.blocks()) {
      const Eigen::LLT<Eigen::MatrixXd> factor(SharedNoise::covariance_of(block, fitted_.variances));
      const auto m = static_cast<Eigen::Index>(block.readings.size());
      const Eigen::MatrixXd inverse = factor.matrixL().solve(Eigen::MatrixXd::Identity(m, m));
      const Eigen::MatrixXd taken_up = inverse.transpose() * rows_of(fitted_.solution.basis, block.readings);
      const Eigen::VectorXd force = factor.solve(rows_of(fitted_.residual_um, block.readings));
      for (Eigen::Index i = 0; i < m; ++i) {
        constexpr double kLeastPart = 1e-6;
        const double own = inverse.col(i).squaredNorm();
        fitted_.sigmas(block.readings[static_cast<std::size_t>(i)]) =
            force(i) / std::sqrt(std::max(kLeastPart * own, own - taken_up.row(i).squaredNorm()));
      }
    }
  }

  bool take_outliers() {
    LengthTest& test = fitted_.test;
    const double readings = static_cast<double>(test.readings.size());
    const double limit = std::sqrt(2.0 * std::log(readings / kOutlierLevel));  // tail of the normal distribution
    constexpr double kNearGreatest = 0.7;
    if (fitted_.single_um < 1e-6) return false;
    const double greatest = fitted_.sigmas.cwiseAbs().maxCoeff();
    if (!(greatest > limit)) return false;
    for (std::size_t i = test.readings.size(); i-- > 0;) {
      const auto at = static_cast<Eigen::Index>(i);
      const double sigmas = std::abs(fitted_.sigmas(at));
      if (!(sigmas > limit && sigmas > kNearGreatest * greatest)) continue;
      fitted_.outliers.push_back({test.readings[i].line, fitted_.residual_um(at), sigmas});
      test.readings.erase(test.readings.begin() + static_cast<std::ptrdiff_t>(i));
    }
    return true;
  }

  const IdentifySettings& settings_;
  FittedLengths fitted_;
  Eigen::VectorXd y_;
  std::optional<SharedNoise> shared_;
  bool divided_ = false;  ///< the noise, by its causes
};

Result<void> checked(const LengthTest& test, const params::Machine& named, const LengthMachine& machine) {
  if (!test.configuration.empty() && test.configuration != named.configuration)
    return tl::unexpected(Problem{ProblemKind::bad_input,
                                  fmt::format("the lengths are of a machine {}, the machine file of {}: expected one "
                                              "machine",
                                              test.configuration, named.configuration),
                                  test.source,
                                  0,
                                  0,
                                  {}});
  std::vector<Problem> problems;
  for (const LengthReading& r : test.readings)
    for (std::size_t a = 0; a < kAxes; ++a)
      if (r.position_mm[a] < machine.travel_mm[a][0] - kBeyondTravel_mm ||
          r.position_mm[a] > machine.travel_mm[a][1] + kBeyondTravel_mm)
        problems.push_back(
            {ProblemKind::bad_input,
             fmt::format("expected {} within its travel {:g} to {:g} mm, found {:g}", letter_of(kAllAxes[a]),
                         machine.travel_mm[a][0], machine.travel_mm[a][1], r.position_mm[a]),
             test.source,
             r.line,
             0,
             {}});
  constexpr std::size_t kShown = 20;
  if (problems.size() > kShown) problems.resize(kShown);
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  return {};
}

/// What is missing, component by component, where there are too few readings to say how certain anything would be.
Problem too_few(const LengthTest& test, IdentifySettings settings, MachineCurves curves,
                const PerAxis<double>& knots_mm) {
  const auto unknowns = curves.size() + nuisance_of(test, 0).end;
  std::vector<Problem> problems{
      {ProblemKind::bad_input,
       fmt::format("expected at least {} readings for {} unknowns (knots {:.0f}, {:.0f}, {:.0f} mm), found {}: measure "
                   "more lines, or take knots farther apart (--knots)",
                   unknowns + kLeastFreedom, unknowns, knots_mm[0], knots_mm[1], knots_mm[2], test.readings.size()),
       test.source,
       0,
       0,
       {}}};
  settings.keep_outliers = true;
  Identification tried;
  report_on(LengthFit(test, settings, std::move(curves)).run(), tried);
  const auto add = [&](const std::string& why_not) {
    if (!why_not.empty()) problems.push_back({ProblemKind::bad_input, why_not, test.source, 0, 0, {}});
  };
  for (const IdentifiedCurve& curve : tried.curves) add(curve.why_not);
  for (const IdentifiedSquareness& square : tried.squareness) add(square.why_not);
  return folded(std::move(problems));
}

}  // namespace

PerAxis<double> knots_for(const LengthTest& test, const LengthMachine& machine,
                          const PerAxis<std::optional<double>>& asked) {
  PerAxis<double> out{};
  for (std::size_t a = 0; a < kAxes; ++a) {
    const double span_mm = machine.travel_mm[a][1] - machine.travel_mm[a][0];
    std::set<long long> places;
    for (const LengthReading& r : test.readings) places.insert(std::llround(r.position_mm[a]));
    const double step_mm = span_mm / std::max(1.0, static_cast<double>(places.size()) - 1.0);
    out[a] = std::min(span_mm, std::max(2.0 * step_mm, span_mm / kMostIntervals));
    if (test.knots_mm[a]) out[a] = std::min(span_mm, *test.knots_mm[a]);
    if (asked[a]) out[a] = std::min(span_mm, *asked[a]);
  }
  return out;
}

Result<Identification> identify(const LengthTest& test, const params::Machine& machine,
                                const IdentifySettings& settings) {
  const auto known = length_machine(machine);
  if (!known) return tl::unexpected(known.error());
  if (const auto right = checked(test, machine, *known); !right) return tl::unexpected(right.error());
  CurveSettings curves;
  curves.knots_mm = knots_for(test, *known, settings.knots_mm);
  curves.reversal_degree = settings.reversal_degree;
  curves.zero = settings.zero;
  curves.tools_mm.clear();
  std::set<std::size_t> used;
  std::set<PerAxis<int>> sides;
  for (const LengthReading& r : test.readings) {
    if (used.insert(r.tool).second) curves.tools_mm.push_back(test.tools[r.tool].offset_mm);
    sides.insert(r.approach);
  }
  Identification out;
  if (sides.size() == 1 && curves.reversal_degree >= 0) {
    curves.reversal_degree = -1;
    out.notes.push_back("every pose is approached from the same side: nothing is known of the reversal errors");
  }
  out.knots_mm = curves.knots_mm;
  MachineCurves made(*known, curves);
  const auto unknowns = made.size() + nuisance_of(test, 0).end;
  if (static_cast<Eigen::Index>(test.readings.size()) < unknowns + kLeastFreedom)
    return tl::unexpected(too_few(test, settings, std::move(made), out.knots_mm));
  report_on(LengthFit(test, settings, std::move(made)).run(), out);
  return out;
}

}  // namespace ecs::model
