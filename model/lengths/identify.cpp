#include "model/lengths/identify.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/units.hpp"

namespace ecs::model {
namespace {

constexpr double kNoSingular = 1e-9;   ///< of the greatest singular value of scaled columns: not determined
constexpr double kInNullSpace = 1e-5;  ///< share of a value that the lengths leave free
constexpr double kPartner = 0.05;      ///< share of a combination from which a component is named
constexpr int kLeastFreedom = 10;      ///< readings more than unknowns
constexpr double kBeyondTravel_mm = 0.5;
constexpr int kLinearisations = 4;
constexpr double kOutlierLevel = 0.01;  ///< chance to find one among all readings of normal noise
constexpr int kOutlierRounds = 6;
constexpr int kVolumePlaces = 5;  ///< along each axis
constexpr double kLeastSigma_um = 1e-9;
constexpr double kMostIntervals = 12.0;

/// One least-squares solution and what it leaves free.
struct LengthSolution {
  Eigen::VectorXd x;
  Eigen::MatrixXd covariance;   ///< of unit variance of the white noise
  Eigen::MatrixXd free;         ///< orthonormal basis of what is not determined, columns scaled by `norm`
  Eigen::VectorXd norm;         ///< of the columns
  Eigen::VectorXd residual_um;  ///< plain
  Eigen::VectorXd white;        ///< whitened, divided by √(1 − leverage)
  double squares = 0.0;         ///< of the whitened residuals
  int rank = 0;
};

/// Scale columns with their expected size as rows of their own.
Eigen::MatrixXd with_priors(const Eigen::MatrixXd& white, const NuisanceColumns& nuisance, double weight) {
  if (weight <= 0.0) return white;
  Eigen::MatrixXd out(white.rows() + static_cast<Eigen::Index>(nuisance.scale.size()), white.cols());
  out.topRows(white.rows()) = white;
  out.bottomRows(out.rows() - white.rows()).setZero();
  Eigen::Index row = white.rows();
  for (const auto& [set_up, column] : nuisance.scale) out(row++, column) = weight;
  return out;
}

/// Columns divided by their lengths; those of nothing but rounding become nothing.
Eigen::MatrixXd scaled_columns(const Eigen::MatrixXd& columns, Eigen::VectorXd& norm) {
  constexpr double kRounding = 1e-11;
  norm = columns.colwise().norm().transpose();
  const double longest = norm.maxCoeff();
  Eigen::MatrixXd scaled = columns;
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    if (norm(j) <= kRounding * longest) {
      norm(j) = 1.0;
      scaled.col(j).setZero();
    } else {
      scaled.col(j) /= norm(j);
    }
  }
  return scaled;
}

/// Values alone, by the normal equations: good enough to make linear about, and to choose the noise.
LengthSolution near_solution_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& y) {
  constexpr double kRidge = 1e-12;
  LengthSolution out;
  const Eigen::MatrixXd scaled = scaled_columns(columns, out.norm);
  Eigen::MatrixXd normal = scaled.transpose() * scaled;
  normal.diagonal().array() += kRidge;
  out.x = normal.ldlt().solve(scaled.transpose() * y).cwiseQuotient(out.norm);
  out.rank = static_cast<int>(columns.cols());
  out.squares = (y - columns * out.x).squaredNorm();
  return out;
}

/// By QR and the singular values of its triangle: what is determined, the solution of least norm, its covariance.
LengthSolution solution_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& y) {
  LengthSolution out;
  const Eigen::Index p = columns.cols();
  const Eigen::MatrixXd scaled = scaled_columns(columns, out.norm);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(scaled);
  const Eigen::MatrixXd r = qr.matrixQR().topRows(std::min(p, scaled.rows())).template triangularView<Eigen::Upper>();
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(r, Eigen::ComputeThinU | Eigen::ComputeFullV);
  const auto& s = svd.singularValues();
  while (out.rank < s.size() && s(out.rank) > kNoSingular * s(0)) ++out.rank;
  const Eigen::VectorXd inverse = s.head(out.rank).cwiseInverse();
  const Eigen::MatrixXd back_scaled = svd.matrixV().leftCols(out.rank) * inverse.asDiagonal();
  const Eigen::MatrixXd back = out.norm.cwiseInverse().asDiagonal() * back_scaled;
  const Eigen::MatrixXd basis = scaled * back_scaled;
  out.x = back * (basis.transpose() * y);
  const Eigen::VectorXd left = y - columns * out.x;
  out.x += back * (basis.transpose() * left);  // once more, for what rounding lost
  out.covariance = back * back.transpose();
  out.free = svd.matrixV().rightCols(p - out.rank);
  out.white = y - columns * out.x;
  out.squares = out.white.squaredNorm();
  constexpr double kLeastShare = 1e-6;
  for (Eigen::Index i = 0; i < out.white.size(); ++i)
    out.white(i) /= std::sqrt(std::max(kLeastShare, 1.0 - basis.row(i).squaredNorm()));
  return out;
}

class Identifier {
 public:
  Identifier(LengthTest test, const LengthMachine& machine, const IdentifySettings& settings, MachineCurves curves)
      : test_(std::move(test)), settings_(settings), curves_(std::move(curves)), machine_(machine) {}

  void run(Identification& out) {
    prepare();
    solve();
    if (!settings_.keep_outliers)
      for (int round = 0; round < kOutlierRounds && take_outliers(out); ++round) {
        prepare();
        solve();
      }
    report(out);
  }

 private:
  void prepare() {
    nuisance_ = nuisance_of(test_, curves_.size());
    shared_.emplace(test_, machine_);
  }

  /// A row to weigh the expected size of a scale against the noise of a reading; without one it is no unknown.
  [[nodiscard]] double prior_weight() const {
    return settings_.scale_um_per_m > 0.0 ? std::max(white_um_, kLeastSigma_um) / settings_.scale_um_per_m : 0.0;
  }

  void solve() {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(nuisance_.end);
    Eigen::VectorXd deviation(static_cast<Eigen::Index>(test_.readings.size()));
    for (Eigen::Index i = 0; i < deviation.size(); ++i)
      deviation(i) = test_.readings[static_cast<std::size_t>(i)].deviation_um;
    for (int i = 0; i < kLinearisations; ++i) {
      linear_ = linearised(test_, curves_, nuisance_, x);
      if (settings_.scale_um_per_m <= 0.0)
        for (const auto& [set_up, column] : nuisance_.scale) linear_.columns.col(column).setZero();
      const Eigen::VectorXd y = deviation - linear_.nominal_um + linear_.columns * x;
      if (i + 2 == kLinearisations) choose_noise(y - linear_.columns * x);
      Eigen::MatrixXd both(linear_.columns.rows(), linear_.columns.cols() + 1);
      both << linear_.columns, y;
      both = with_priors(shared_->whitened(both, linear_.direction, ratios_, nullptr), nuisance_, prior_weight());
      const Eigen::MatrixXd columns = both.leftCols(linear_.columns.cols());
      solution_ = i + 1 < kLinearisations ? near_solution_of(columns, both.rightCols(1))
                                          : solution_of(columns, both.rightCols(1));
      x = solution_.x;
      const double freedom = std::max(1.0, static_cast<double>(both.rows() - solution_.rank));
      white_um_ = std::max(kLeastSigma_um, std::sqrt(solution_.squares / freedom));
      degrees_of_freedom_ = static_cast<int>(both.rows()) - solution_.rank;
      solution_.residual_um = y - linear_.columns * x;
    }
  }

  /// Minus twice the restricted log likelihood, but for a constant.
  [[nodiscard]] double likelihood(const Eigen::MatrixXd& both, const NoiseRatios& ratios, double* white_um) const {
    double half_log_determinant = 0.0;
    Eigen::MatrixXd white = shared_->whitened(both, linear_.direction, ratios, &half_log_determinant);
    white = with_priors(white, nuisance_, prior_weight());
    const Eigen::Index p = both.cols() - 1;
    const Eigen::MatrixXd scaled = white.leftCols(p) * solution_.norm.cwiseInverse().asDiagonal();
    Eigen::MatrixXd normal = scaled.transpose() * scaled;
    constexpr double kRidge = 1e-10;
    normal.diagonal().array() += kRidge;
    const Eigen::LLT<Eigen::MatrixXd> factor(normal);
    const Eigen::VectorXd right = scaled.transpose() * white.col(p);
    const double squares = std::max(white.col(p).squaredNorm() - right.dot(factor.solve(right)),
                                    kLeastSigma_um * kLeastSigma_um * static_cast<double>(white.rows()));
    const double freedom = static_cast<double>(white.rows() - solution_.rank);
    *white_um = std::sqrt(squares / freedom);
    return freedom * std::log(squares) + 2.0 * half_log_determinant +
           2.0 * factor.matrixLLT().diagonal().array().log().sum();
  }

  void choose_noise(const Eigen::VectorXd& residual_um) {
    constexpr double kNoNoise_um = 1e-4;
    if (white_um_ < kNoNoise_um || degrees_of_freedom_ < kLeastFreedom) return;  // there is nothing to divide
    Eigen::MatrixXd both(linear_.columns.rows(), linear_.columns.cols() + 1);
    both << linear_.columns, residual_um;
    double best_um = white_um_, best = likelihood(both, ratios_, &best_um);
    const auto attempt = [&](const NoiseRatios& ratios) {
      double um = 0.0;
      const double value = likelihood(both, ratios, &um);
      if (!(value < best)) return;
      best = value;
      best_um = um;
      ratios_ = ratios;
    };
    if (shared_->any_parked())
      for (const double stop : {1.0, 5.0, 25.0}) attempt({stop, ratios_.pass});
    for (const double pass : {0.1, 0.5, 2.0}) attempt({ratios_.stop, pass});
    if (ratios_.stop > 0.0)
      for (const double factor : {0.45, 2.2}) attempt({ratios_.stop * factor, ratios_.pass});
    white_um_ = best_um;
  }

  bool take_outliers(Identification& out) {
    const double readings = static_cast<double>(test_.readings.size());
    const double limit = std::sqrt(2.0 * std::log(readings / kOutlierLevel));  // tail of the normal distribution
    if (white_um_ < 1e-6) return false;
    std::vector<std::size_t> found;
    double greatest = 0.0;
    for (std::size_t i = 0; i < test_.readings.size(); ++i)
      greatest = std::max(greatest, std::abs(solution_.white(static_cast<Eigen::Index>(i))) / white_um_);
    if (greatest <= limit) return false;
    for (std::size_t i = 0; i < test_.readings.size(); ++i) {
      const double sigmas = std::abs(solution_.white(static_cast<Eigen::Index>(i))) / white_um_;
      if (sigmas > limit && sigmas > 0.7 * greatest) found.push_back(i);
    }
    for (auto i = found.rbegin(); i != found.rend(); ++i) {
      const auto at = static_cast<Eigen::Index>(*i);
      out.outliers.push_back(
          {test_.readings[*i].line, solution_.residual_um(at), std::abs(solution_.white(at)) / white_um_});
      test_.readings.erase(test_.readings.begin() + static_cast<std::ptrdiff_t>(*i));
    }
    return true;
  }

  [[nodiscard]] bool is_free(const Eigen::VectorXd& row, Eigen::Index first) const {
    if (solution_.free.cols() == 0) return false;
    const Eigen::VectorXd scaled = row.cwiseQuotient(solution_.norm.segment(first, row.size()));
    const Eigen::VectorXd share = solution_.free.middleRows(first, row.size()).transpose() * scaled;
    return share.norm() > kInNullSpace * std::max(scaled.norm(), 1e-30);
  }

  /// Components in the combinations that are free together with this one.
  [[nodiscard]] std::vector<Component> together_with(Component component) const {
    const auto& own = curves_.block(component);
    const Eigen::MatrixXd weights = solution_.free.middleRows(own.first, own.size()) * solution_.free.transpose();
    std::vector<Component> out;
    for (std::size_t c = 0; c < kComponents; ++c) {
      const auto& other = curves_.block(static_cast<Component>(c));
      if (other.size() == 0 || static_cast<Component>(c) == component) continue;
      if (weights.middleCols(other.first, other.size()).norm() > kPartner * weights.norm())
        out.push_back(static_cast<Component>(c));
    }
    return out;
  }

  void report(Identification& out) {
    const double variance = white_um_ * white_um_;
    covariance_ = variance * solution_.covariance;
    for (std::size_t c = 0; c < kCurves; ++c) out.curves.push_back(curve_of_component(static_cast<Component>(c)));
    for (const Component c : {Component::C0Y, Component::B0Z, Component::A0Z}) out.squareness.push_back(square_of(c));
    out.readings = test_.readings.size();
    out.unknowns = solution_.rank;
    out.degrees_of_freedom = degrees_of_freedom_;
    out.white_um = white_um_;
    out.stop_um = white_um_ * std::sqrt(ratios_.stop);
    out.pass_um = white_um_ * std::sqrt(ratios_.pass);
    out.residual_um = white_um_ * std::sqrt(1.0 + 3.0 * (ratios_.stop + ratios_.pass));
    out.repeat_um = repeats();
    report_set_ups(out);
    if (out.whole()) {
      const Eigen::MatrixXd weight = volume_weight(curves_, {test_.tools.front().offset_mm}, kVolumePlaces);
      const auto m = curves_.size();
      out.volume_um = std::sqrt(std::max(0.0, (weight * covariance_.topLeftCorner(m, m)).trace()));
    }
    compare_repeats(out);
  }

  IdentifiedCurve curve_of_component(Component component) {
    IdentifiedCurve out;
    out.component = component;
    const auto& block = curves_.block(component);
    out.acts = curves_.acts(component);
    if (!out.acts || block.size() == 0) return out;
    const std::size_t a = index_of(moving_axis(component));
    const int points = 2 * curves_.intervals(moving_axis(component)) + 1;
    const Eigen::MatrixXd own = covariance_.block(block.first, block.first, block.size(), block.size());
    Eigen::MatrixXd rows(points, block.size());
    out.determined = true;
    for (int i = 0; i < points; ++i) {
      const double p = std::lerp(machine_.travel_mm[a][0], machine_.travel_mm[a][1], i / (points - 1.0));
      out.position_mm.push_back(p);
      rows.row(i) = curves_.value_row(component, p, 0).transpose();
      for (const int side : {1, -1}) {
        const Eigen::VectorXd row = curves_.value_row(component, p, side);
        if (is_free(row, block.first)) out.determined = false;
        const double value = row.dot(solution_.x.segment(block.first, block.size()));
        const double u = std::sqrt(std::max(0.0, row.dot(own * row)));
        (side > 0 ? out.forward : out.reverse).push_back(value);
        (side > 0 ? out.u_forward : out.u_reverse).push_back(u);
      }
    }
    if (!out.determined) {
      out.why_not = what_is_missing(component, test_, curves_, linear_.direction, together_with(component));
      out.forward.clear(), out.reverse.clear(), out.u_forward.clear(), out.u_reverse.clear();
      return out;
    }
    state_for_map(out, rows * own * rows.transpose());
    return out;
  }

  /// Two numbers for the header of a map, which counts errors from the reference: what lies between neighbours, and
  /// what is common to the table.
  static void state_for_map(IdentifiedCurve& out, const Eigen::MatrixXd& covariance) {
    const auto n = covariance.rows();
    double second = 0.0;
    for (Eigen::Index i = 0; i + 2 < n; ++i) {
      Eigen::VectorXd d = Eigen::VectorXd::Zero(n);
      d(i) = d(i + 2) = 1.0;
      d(i + 1) = -2.0;
      second += d.dot(covariance * d);
    }
    constexpr double kOfNoise = 6.0;  // variance of a second difference of unit noise
    const double value2 = second / kOfNoise / std::max<double>(1.0, static_cast<double>(n - 2));
    double mean2 = 0.0;
    for (std::size_t i = 0; i < out.u_forward.size(); ++i)
      mean2 += 0.5 * (out.u_forward[i] * out.u_forward[i] + out.u_reverse[i] * out.u_reverse[i]);
    mean2 /= static_cast<double>(out.u_forward.size());
    out.value = std::sqrt(std::min(value2, 0.5 * mean2));
    // from the reference the shapes of a pass differ by about √2 of their own size (volume/shapes.hpp)
    out.pass = std::sqrt(std::max(0.0, 0.5 * mean2 - out.value * out.value));
  }

  IdentifiedSquareness square_of(Component component) {
    IdentifiedSquareness out;
    out.component = component;
    const auto& block = curves_.block(component);
    out.acts = curves_.acts(component);
    if (!out.acts || block.size() == 0) return out;
    out.determined = !is_free(Eigen::VectorXd::Ones(1), block.first);
    if (!out.determined) {
      out.why_not = what_is_missing(component, test_, curves_, linear_.direction, together_with(component));
      return out;
    }
    out.um_per_m = solution_.x(block.first);
    out.u_um_per_m = std::sqrt(covariance_(block.first, block.first));
    return out;
  }

  void report_set_ups(Identification& out) {
    for (std::size_t s = 0; s < test_.set_ups.size(); ++s) {
      IdentifiedSetUp one;
      one.name = test_.set_ups[s].name;
      double squares = 0.0;
      bool first = true;
      for (std::size_t i = 0; i < test_.readings.size(); ++i) {
        const LengthReading& r = test_.readings[i];
        if (r.set_up != s) continue;
        ++one.readings;
        squares += std::pow(solution_.residual_um(static_cast<Eigen::Index>(i)), 2);
        if (!std::exchange(first, false)) continue;
        const auto station = nuisance_.station.find({r.set_up, r.tool});
        if (station != nuisance_.station.end())
          for (std::size_t a = 0; a < kAxes; ++a)
            one.station_correction_mm[a] = solution_.x(station->second + static_cast<Eigen::Index>(a)) / kUmPerMm;
      }
      if (one.readings > 0) one.rms_um = std::sqrt(squares / static_cast<double>(one.readings));
      out.set_ups.push_back(one);
    }
  }

  /// Of a single reading, from poses that were measured again in another run; the zero of each run is taken off.
  [[nodiscard]] std::optional<double> repeats() const {
    std::map<std::tuple<std::size_t, std::size_t, Vector3, PerAxis<int>>, std::map<int, double>> poses;
    for (const LengthReading& r : test_.readings)
      poses[{r.set_up, r.tool, r.position_mm, r.approach}][r.run] = r.deviation_um;
    std::map<std::tuple<std::size_t, std::size_t, int, int>, std::vector<double>> differences;
    for (const auto& [pose, runs] : poses)
      for (auto a = runs.begin(); a != runs.end(); ++a)
        if (const auto b = std::next(a); b != runs.end())
          differences[{std::get<0>(pose), std::get<1>(pose), a->first, b->first}].push_back(b->second - a->second);
    double squares = 0.0, freedom = 0.0;
    for (const auto& [runs, list] : differences) {
      const double mean = std::accumulate(list.begin(), list.end(), 0.0) / static_cast<double>(list.size());
      for (const double d : list) squares += (d - mean) * (d - mean);
      freedom += static_cast<double>(list.size()) - 1.0;
    }
    if (freedom < kLeastFreedom) return std::nullopt;
    return std::sqrt(squares / freedom / 2.0);
  }

  void compare_repeats(Identification& out) const {
    if (!out.repeat_um) {
      out.notes.push_back("no pose is measured in two runs: noise is known from the residuals alone");
      return;
    }
    constexpr double kMuchMore = 1.3;
    if (out.residual_um > kMuchMore * *out.repeat_um)
      out.notes.push_back(
          fmt::format("residuals {:.2f} um, repeats {:.2f} um: the machine holds form that the curves do not: take "
                      "knots closer together (--knots) or look for drift; uncertainties count the residuals",
                      out.residual_um, *out.repeat_um));
  }

  LengthTest test_;
  const IdentifySettings& settings_;
  MachineCurves curves_;
  const LengthMachine& machine_;
  NuisanceColumns nuisance_;
  std::optional<SharedNoise> shared_;
  NoiseRatios ratios_;
  Linearised linear_;
  LengthSolution solution_;
  Eigen::MatrixXd covariance_;
  double white_um_ = 0.2;
  int degrees_of_freedom_ = 0;
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
Problem too_few(const LengthTest& test, const LengthMachine& machine, IdentifySettings settings, MachineCurves curves,
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
  Identifier(test, machine, settings, std::move(curves)).run(tried);
  const auto add = [&](const std::string& why_not) {
    if (!why_not.empty()) problems.push_back({ProblemKind::bad_input, why_not, test.source, 0, 0, {}});
  };
  for (const IdentifiedCurve& curve : tried.curves) add(curve.why_not);
  for (const IdentifiedSquareness& square : tried.squareness) add(square.why_not);
  return folded(std::move(problems));
}

}  // namespace

bool Identification::whole() const {
  const auto right = [](const auto& one) { return one.why_not.empty(); };
  return std::all_of(curves.begin(), curves.end(), right) && std::all_of(squareness.begin(), squareness.end(), right);
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
    return tl::unexpected(too_few(test, *known, settings, std::move(made), out.knots_mm));
  Identifier(test, *known, settings, std::move(made)).run(out);
  return out;
}

}  // namespace ecs::model
