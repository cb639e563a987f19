#include "modules/lengths/identify.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "base/linear/decompositions.hpp"
#include "base/units.hpp"
#include "model/fit/statistics.hpp"
#include "modules/lengths/fitted_lengths.hpp"

namespace ecs::model {
namespace {

constexpr double kBeyondTravel_mm = 0.5;
constexpr int kLinearisations = 4;
constexpr double kOutlierLevel = 0.01;  ///< chance to find one among all readings of normal noise
constexpr int kOutlierRounds = 6;
/// On either side of a jump; fewer readings that lie aside are outliers.
constexpr std::size_t kFewestAside = 3;
constexpr double kLeastSigma_um = 1e-9;
constexpr double kLeastNoise_um = 1e-6;  ///< exact lengths: nothing stands out of rounding
constexpr double kNoNoise_um = 1e-4;     ///< residuals below are rounding: there is no noise to divide
constexpr double kMostIntervals = 12.0;
/// Where the search for the variances begins: a good instrument on a common machine [um², (um/m)²].
constexpr ScatterVariances kCommonScatter{0.04, 1.0, 0.25, 0.02, 0.02};

/// Of each unknown before anything is measured 1/variance: of scales, and of the length of a ball bar.
Eigen::VectorXd known_of(const FittedLengths& fitted, const IdentifySettings& settings) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(fitted.nuisance.end);
  if (settings.scale_um_per_m > 0.0)
    for (const auto& [set_up, column] : fitted.nuisance.scale)
      out(column) = 1.0 / (settings.scale_um_per_m * settings.scale_um_per_m);
  if (fitted.nuisance.bar) out(*fitted.nuisance.bar) = 1.0 / (*fitted.test.bar_um * *fitted.test.bar_um);
  return out;
}

class LengthFit {
 public:
  LengthFit(LengthTest test, const IdentifySettings& settings, MachineCurves curves)
      : settings_(settings), fitted_(std::move(test), std::move(curves)) {
    fitted_.variances = kCommonScatter;
  }

  FittedLengths run() {
    solve();
    for (int round = 0; round < kOutlierRounds && (take_jump() || take_outliers()); ++round) solve();
    count_noise();
    find_misplaced();
    return std::move(fitted_);
  }

 private:
  [[nodiscard]] Eigen::VectorXd precision() const { return known_of(fitted_, settings_); }

  void linearise_about(const Eigen::VectorXd& x) {
    fitted_.linear = linearised(fitted_.test, fitted_.curves, fitted_.nuisance, x);
    if (settings_.scale_um_per_m <= 0.0)
      for (const auto& [set_up, column] : fitted_.nuisance.scale) fitted_.linear.columns.col(column).setZero();
    y_ = -fitted_.linear.nominal_um + fitted_.linear.columns * x;
    for (Eigen::Index i = 0; i < y_.size(); ++i)
      y_(i) += fitted_.test.readings[static_cast<std::size_t>(i)].deviation_um;
  }

  [[nodiscard]] Eigen::MatrixXd whitened(const SharedNoise& shared) const {
    return whitened_lengths(shared, fitted_.linear.columns, y_, precision(), fitted_.variances);
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
    const auto n = fitted_.residual_um.size();
    fitted_.sigmas.resize(n);
    force_.resize(n);
    information_.resize(n);
    taken_up_.resize(n, fitted_.solution.basis.cols());
    inverse_.clear();
    for (const auto& block : shared.blocks()) {
      const Cholesky factor(SharedNoise::covariance_of(block, fitted_.variances));
      const auto m = static_cast<Eigen::Index>(block.readings.size());
      const Eigen::MatrixXd inverse = factor.by_l(Eigen::MatrixXd::Identity(m, m));
      const Eigen::MatrixXd taken_up = inverse.transpose() * rows_of(fitted_.solution.basis, block.readings);
      const Eigen::VectorXd force = factor.solve(rows_of(fitted_.residual_um, block.readings));
      Eigen::VectorXd later = Eigen::VectorXd::Zero(m);  // sum of the columns of the readings behind this one
      for (Eigen::Index i = m; i-- > 0;) {
        constexpr double kLeastPart = 1e-6;
        const double own = inverse.col(i).squaredNorm();
        const Eigen::Index reading = block.readings[static_cast<std::size_t>(i)];
        fitted_.sigmas(reading) = force(i) / std::sqrt(std::max(kLeastPart * own, own - taken_up.row(i).squaredNorm()));
        force_(reading) = force(i);
        taken_up_.row(reading) = taken_up.row(i);
        information_(reading) = own + 2.0 * inverse.col(i).dot(later);
        later += inverse.col(i);
      }
      inverse_.push_back(inverse);
    }
  }

  /// Beyond what normal noise gives once in a hundred files among all readings.
  [[nodiscard]] double outlier_limit() const {
    return std::sqrt(2.0 * std::log(static_cast<double>(fitted_.test.readings.size()) / kOutlierLevel));
  }

  /// The same of a change in proportion to the number of the reading within its run: drift.
  [[nodiscard]] double drift_sigmas(const std::vector<Eigen::Index>& readings) const {
    Eigen::VectorXd ramp = Eigen::VectorXd::Zero(fitted_.residual_um.size());
    for (std::size_t k = 0; k < readings.size(); ++k) ramp(readings[k]) = static_cast<double>(k);
    double left = -(ramp.transpose() * taken_up_).squaredNorm();
    for (std::size_t b = 0; b < inverse_.size(); ++b)
      left += (inverse_[b] * rows_of(ramp, shared_->blocks()[b].readings)).squaredNorm();
    return std::abs(ramp.dot(force_)) / std::sqrt(std::max(kLeastNoise_um, left));
  }

  /// A constant from one reading of a run on, by the score test of its column at the fitted noise: zᵀ·P·y over the root
  /// of zᵀ·P·z (C. R. Rao, Proc. Camb. Phil. Soc. 44 (1948) 50). The readings from there on become a run of their own,
  /// so that their zero is free.
  bool take_jump() {
    LengthTest& test = fitted_.test;
    if (fitted_.single_um < kLeastNoise_um) return false;
    std::map<std::tuple<std::size_t, int, std::size_t>, std::vector<Eigen::Index>> runs;
    for (std::size_t i = 0; i < test.readings.size(); ++i) {
      const LengthReading& r = test.readings[i];
      const bool known_bar = test.bar_um && test.set_ups[r.set_up].instrument == LengthInstrument::ball_bar;
      if (!known_bar && test.set_ups[r.set_up].instrument != LengthInstrument::points)
        runs[{r.set_up, r.run, r.tool}].push_back(static_cast<Eigen::Index>(i));
    }
    double greatest = std::max(outlier_limit(), fitted_.sigmas.cwiseAbs().maxCoeff());
    const std::vector<Eigen::Index>* where = nullptr;
    std::size_t from = 0;
    for (const auto& [run, readings] : runs) {
      double force = 0.0, information = 0.0;
      Eigen::RowVectorXd taken_up = Eigen::RowVectorXd::Zero(taken_up_.cols());
      for (std::size_t k = readings.size(); k-- > kFewestAside;) {
        force += force_(readings[k]);
        information += information_(readings[k]);
        taken_up += taken_up_.row(readings[k]);
        constexpr double kLeastPart = 1e-6;  // the rest is taken up by what is unknown anyway
        const double left = information - taken_up.squaredNorm();
        if (readings.size() - k < kFewestAside || left <= kLeastPart * information) continue;
        const double sigmas = std::abs(force) / std::sqrt(left);
        if (sigmas <= greatest) continue;
        greatest = sigmas;
        where = &readings;
        from = k;
      }
    }
    if (where == nullptr || drift_sigmas(*where) >= greatest) return false;
    const LengthReading first = test.readings[static_cast<std::size_t>((*where)[from])];
    int fresh = first.run;
    for (const LengthReading& r : test.readings) fresh = std::max(fresh, r.run + 1);
    for (std::size_t k = from; k < where->size(); ++k) test.readings[static_cast<std::size_t>((*where)[k])].run = fresh;
    fitted_.jumps.push_back({first.set_up, first.tool, first.run, fresh, first.line});
    return true;
  }

  bool take_outliers() {
    LengthTest& test = fitted_.test;
    const double limit = outlier_limit();
    constexpr double kNearGreatest = 0.7;
    if (settings_.keep_outliers || fitted_.single_um < kLeastNoise_um) return false;
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

  /// The score test of the coordinates of each station: what they change in the lengths with the corrections of the
  /// stations held is their directions alone. Of several the most certain: the others take up what it lacks.
  void find_misplaced() {
    const LengthTest& test = fitted_.test;
    const auto n = fitted_.residual_um.size();
    if (fitted_.single_um < kLeastNoise_um || fitted_.degrees_of_freedom < kLeastFreedom) return;
    double least_ln_p = std::log(kOutlierLevel / static_cast<double>(test.set_ups.size()));
    for (std::size_t s = 0; s < test.set_ups.size(); ++s) {
      if (test.set_ups[s].instrument == LengthInstrument::interferometer || has_points(test)) continue;
      Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(n, 3);
      for (Eigen::Index i = 0; i < n; ++i) {
        const LengthReading& r = test.readings[static_cast<std::size_t>(i)];
        if (r.set_up != s) continue;
        const Vector3 point = point_of(test, r), &place = test.set_ups[s].place;
        const Eigen::Vector3d nominal(point[0] - place[0], point[1] - place[1], point[2] - place[2]);
        moved.row(i) = kUmPerMm * (nominal.normalized().transpose() - fitted_.linear.direction.row(i));
      }
      Eigen::Matrix3d information = -(moved.transpose() * taken_up_) * (moved.transpose() * taken_up_).transpose();
      for (std::size_t b = 0; b < inverse_.size(); ++b) {
        const Eigen::MatrixXd whitened = inverse_[b] * rows_of(moved, shared_->blocks()[b].readings);
        information += whitened.transpose() * whitened;
      }
      const PivotedQr solver(information);
      if (solver.rank() < 3) continue;
      const Eigen::Vector3d force = moved.transpose() * force_, off_mm = solver.solve(force);
      const double ln_p = ln_f_tail(force.dot(off_mm) / 3.0, 3.0, fitted_.degrees_of_freedom);
      if (ln_p >= least_ln_p) continue;
      least_ln_p = ln_p;
      const Eigen::Vector3d along = off_mm.normalized();
      const double u_mm = std::sqrt(std::max(0.0, along.dot(solver.solve(along))));
      fitted_.misplaced = MisplacedStation{s, {off_mm(0), off_mm(1), off_mm(2)}, u_mm};
    }
  }

  const IdentifySettings& settings_;
  FittedLengths fitted_;
  Eigen::VectorXd y_;
  Eigen::VectorXd force_;                 ///< inverse covariance · residual
  Eigen::VectorXd information_;           ///< of a constant: what a reading adds to those behind it in its run
  Eigen::MatrixXd taken_up_;              ///< of a reading by the unknowns
  std::vector<Eigen::MatrixXd> inverse_;  ///< of the Cholesky factor of each block
  std::optional<SharedNoise> shared_;
  bool divided_ = false;  ///< the noise, by its causes
};

/// @pre determined in `found`, where it was free
std::string contradiction(Component component, const Identification& found) {
  std::string size;
  if (is_squareness(component)) {
    const IdentifiedSquareness& square = found.squareness[index_of(component) - kCurves];
    size = fmt::format("{:.1f} um/m (U = {:.1f})", square.um_per_m, square.U_um_per_m);
  } else {
    const IdentifiedCurve& curve = found.curves[index_of(component)];
    double most = -1.0, U = 0.0, at_mm = 0.0;
    for (std::size_t i = 0; i < curve.position_mm.size(); ++i)
      for (const auto& [value, own_U] :
           {std::pair(curve.forward[i], curve.U_forward[i]), std::pair(curve.reverse[i], curve.U_reverse[i])}) {
        if (std::abs(value) <= most) continue;
        most = std::abs(value);
        U = own_U;
        at_mm = curve.position_mm[i];
      }
    size = fmt::format("up to {:.1f} {} (U = {:.1f}) at {} {:g} mm", most, unit_of(component), U,
                       letter_of(moving_axis(component)), at_mm);
  }
  return fmt::format(
      "{0} is declared zero, but the lengths show {1} if it is fitted: the other components absorb its error. Fit "
      "without --zero {0}, or find the cause",
      name_of(component), size);
}

Result<void> checked(const LengthTest& test, const params::Machine& named, const LengthMachine& machine) {
  if (!test.configuration.empty() && test.configuration != named.configuration)
    return problem_at(test.source, 0, 0,
                      "the lengths are of a machine {}, the machine file of {}: expected one machine",
                      test.configuration, named.configuration);
  std::vector<Problem> problems;
  for (const LengthReading& r : test.readings)
    for (std::size_t a = 0; a < kAxes; ++a)
      if (r.position_mm[a] < machine.travel_mm[a][0] - kBeyondTravel_mm ||
          r.position_mm[a] > machine.travel_mm[a][1] + kBeyondTravel_mm)
        problems.push_back(
            problem_at(test.source, r.line, 0, "expected {} within its travel {:g} to {:g} mm, found {:g}",
                       letter_of(kAllAxes[a]), machine.travel_mm[a][0], machine.travel_mm[a][1], r.position_mm[a])
                .value());
  constexpr std::size_t kShown = 20;
  if (problems.size() > kShown) problems.resize(kShown);
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  return {};
}

/// Components that were declared zero and that the same lengths show: fitted with them free, a curve that is not zero
/// by the F test at the level of outliers, shared among those declared.
std::vector<std::string> contradicted_zeros(const LengthTest& test, const IdentifySettings& settings,
                                            const LengthMachine& machine, CurveSettings curves) {
  std::vector<std::string> notes;
  const auto declared = std::ranges::count(settings.zero, true);
  curves.zero = {};
  MachineCurves free(machine, curves);
  const auto unknowns = free.size() + nuisance_of(test, 0).end;
  if (declared == 0 || static_cast<Eigen::Index>(test.readings.size()) < unknowns + kLeastFreedom) return notes;
  const FittedLengths fitted = LengthFit(test, settings, std::move(free)).run();
  Identification found;
  report_on(fitted, found);
  for (std::size_t c = 0; c < kComponents; ++c) {
    if (!settings.zero[c]) continue;
    const auto component = static_cast<Component>(c);
    const auto& block = fitted.curves.block(component);
    const bool square = is_squareness(component);
    const bool determined = square ? found.squareness[c - kCurves].determined : found.curves[c].determined;
    if (!determined) continue;
    const Eigen::VectorXd x = fitted.solution.x.segment(block.first, block.size());
    const Eigen::MatrixXd own = fitted.certainty.covariance().block(block.first, block.first, x.size(), x.size());
    const double count = static_cast<double>(x.size());
    const double ln_p = ln_f_tail(x.dot(SymmetricSolver(own).solve(x)) / count, count, fitted.degrees_of_freedom);
    if (ln_p >= std::log(kOutlierLevel / static_cast<double>(declared))) continue;
    notes.push_back(contradiction(component, found));
  }
  return notes;
}

/// What is missing, component by component, where there are too few readings to say how certain anything would be.
Problem too_few(const LengthTest& test, IdentifySettings settings, MachineCurves curves,
                const PerAxis<double>& knots_mm) {
  const auto unknowns = curves.size() + nuisance_of(test, 0).end;
  std::vector<Problem> problems{
      problem_at(test.source, 0, 0,
                 "expected at least {} readings for {} unknowns (knots {:.0f}, {:.0f}, {:.0f} mm), found {}: "
                 "measure more lines, or use a larger knot spacing (--knots)",
                 unknowns + kLeastFreedom, unknowns, knots_mm[0], knots_mm[1], knots_mm[2], test.readings.size())
          .value()};
  settings.keep_outliers = true;
  Identification tried;
  report_on(LengthFit(test, settings, std::move(curves)).run(), tried);
  const auto add = [&](const std::string& why_not) {
    if (!why_not.empty()) problems.push_back(problem_at(test.source, 0, 0, why_not).value());
  };
  for (const IdentifiedCurve& curve : tried.curves) add(curve.why_not);
  for (const IdentifiedSquareness& square : tried.squareness) add(square.why_not);
  return folded(std::move(problems));
}

}  // namespace

Eigen::MatrixXd whitened_lengths(const SharedNoise& shared, const Eigen::MatrixXd& columns,
                                 const Eigen::VectorXd& lengths_um, const Eigen::VectorXd& known,
                                 const ScatterVariances& variances) {
  const auto n = lengths_um.size(), p = columns.cols();
  Eigen::MatrixXd both(n, p + 1);
  both << columns, lengths_um;
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n + (known.array() > 0.0).count(), p + 1);
  out.topRows(n) = shared.whitened(both, variances);
  Eigen::Index row = n;
  for (Eigen::Index j = 0; j < p; ++j)
    if (known(j) > 0.0) out(row++, j) = std::sqrt(known(j));
  return out;
}

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
  ECS_TRY(known, length_machine(machine));
  ECS_DO(checked(test, machine, known));
  CurveSettings curves;
  curves.knots_mm = knots_for(test, known, settings.knots_mm);
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
    out.notes.push_back("every pose is approached from the same side: the reversal errors are unknown");
  }
  out.knots_mm = curves.knots_mm;
  MachineCurves made(known, curves);
  const auto unknowns = made.size() + nuisance_of(test, 0).end;
  if (static_cast<Eigen::Index>(test.readings.size()) < unknowns + kLeastFreedom)
    return tl::unexpected(too_few(test, settings, std::move(made), out.knots_mm));
  FittedLengths fitted = LengthFit(test, settings, std::move(made)).run();
  if (fitted.degrees_of_freedom >= kLeastFreedom) fitted.finer = finer_form(fitted, curves, known_of(fitted, settings));
  report_on(fitted, out);
  out.contradictions = contradicted_zeros(test, settings, known, std::move(curves));
  out.notes.insert(out.notes.end(), out.contradictions.begin(), out.contradictions.end());
  return out;
}

}  // namespace ecs::model
