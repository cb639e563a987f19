// Marginal likelihoods with a normal prior of unknown variance (empirical Bayes: Berger 2006). The prior of a smooth
// curve is that of a cubic smoothing spline (Wahba 1978), its penalty as in Green and Silverman 1994, 2.3; that of
// single targets has the same variance at each, and no correlation.
#include "model/diagnosis/single_targets.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/linear/decompositions.hpp"
#include "model/data/curve_basis.hpp"
#include "model/diagnosis/waves.hpp"
#include "model/diagnosis/weighing.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Twice the logarithm of the evidence for so many coefficients that explain this fall of χ², against none: their prior
/// has the variance that they show.
double evidence_of(double gain, double coefficients) {
  return gain > coefficients ? gain - coefficients - coefficients * std::log(gain / coefficients) : 0.0;
}

/// Covariance of a cubic smoothing spline at these positions, without the straight line that it leaves free. A power of
/// its variances, the largest 1, makes it smoother.
MatrixXd smooth_covariance(const VectorXd& at, double power) {
  const Index n = at.size();
  MatrixXd second = MatrixXd::Zero(n, n - 2), weight = MatrixXd::Zero(n - 2, n - 2);
  for (Index i = 0; i < n - 2; ++i) {
    const double left = at(i + 1) - at(i), right = at(i + 2) - at(i + 1);
    second(i, i) = 1.0 / left;
    second(i + 1, i) = -1.0 / left - 1.0 / right;
    second(i + 2, i) = 1.0 / right;
    weight(i, i) = (left + right) / 3.0;
    if (i > 0) weight(i, i - 1) = weight(i - 1, i) = left / 6.0;
  }
  const Spectrum penalty = spectrum_of(second * solved_symmetric(weight, second.transpose()));
  VectorXd variance = VectorXd::Zero(n);  // values are in increasing order, those of the line are the first two
  for (Index i = 2; i < n; ++i) variance(i) = std::pow(penalty.values(2) / penalty.values(i), power);
  return penalty.vectors * variance.asDiagonal() * penalty.vectors.transpose();
}

/// Covariance of a sum of independent jumps along the axis (a Wiener process).
MatrixXd covariance_of_jumps(const VectorXd& at) {
  return MatrixXd::NullaryExpr(at.size(), at.size(), [&](Index i, Index j) { return at(std::min(i, j)) - at(0); });
}

/// Values at targets as the readings show them beside all else: `white` times the values, of which `y` is read with
/// noise of size one.
struct SeenValues {
  MatrixXd white;
  VectorXd y;
};

/// @param white  columns, one a target
SeenValues seen_beside(const Space& space, const MatrixXd& white) {
  constexpr double kLeastSeen = 1e-13;  // of the squares: the rounding of their products
  const MatrixXd values = ecs::without(space.q, white);
  const Spectrum squares = spectrum_of(values.transpose() * values);  // in increasing order
  const double least = kLeastSeen * std::max(squares.values.maxCoeff(), kLeastDivisor);
  const Index seen = (squares.values.array() > least).count();
  const MatrixXd vectors = squares.vectors.rightCols(seen);
  const VectorXd root = squares.values.tail(seen).cwiseSqrt();
  return {root.asDiagonal() * vectors.transpose(),
          (vectors.transpose() * (values.transpose() * space.y)).cwiseQuotient(root)};
}

/// Twice the logarithm of the evidence for values at targets with this covariance times an unknown factor, against
/// none.
double evidence_of_values(const SeenValues& values, const MatrixXd& covariance) {
  constexpr double kLeastFactor = 1e-3, kStep = 1.25;
  constexpr int kSteps = 155;  // to 1e12
  if (values.y.size() == 0) return 0.0;
  const Spectrum parts = spectrum_of(values.white * covariance * values.white.transpose());
  const VectorXd seen = parts.vectors.transpose() * values.y;
  const double largest = std::max(parts.values.maxCoeff(), kLeastDivisor);
  double best = 0.0;
  for (int step = 0; step < kSteps; ++step) {
    const double factor = kLeastFactor * std::pow(kStep, step);
    double evidence = 0.0;
    for (Index i = 0; i < seen.size(); ++i) {
      const double variance = factor * std::max(parts.values(i), 0.0) / largest;
      evidence += seen(i) * seen(i) * variance / (1.0 + variance) - std::log1p(variance);
    }
    best = std::max(best, evidence);
  }
  return best;
}

/// What the effects of one line act on: means of both approaches, half their differences, or each approach on its own.
enum class Acts : std::uint8_t { on_mean, on_reversal, on_one_way };
struct Line {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  Acts acts = Acts::on_mean;
  bool operator<(const Line& other) const {
    return std::tie(axis, sense, acts) < std::tie(other.axis, other.sense, other.acts);
  }
};

/// Targets of a line, in increasing order. One-way effects have two values a target: one of each approach.
struct Targets {
  VectorXd at;                ///< position
  MatrixXd values;            ///< a column for the value at each
  std::vector<int> approach;  ///< of each; 0: of both
};
Targets targets_of_line(const Observations& data, const Line& line) {
  std::map<std::pair<int, long long>, Index> targets;
  const auto is_here = [&](std::size_t k) { return data.axis[k] == line.axis && data.sense[k] == line.sense; };
  const auto target_of = [&](std::size_t k) {
    return std::pair{line.acts == Acts::on_one_way ? data.approach[k] : 0,
                     std::llround(data.along_of(k) / kSamePlace_mm)};
  };
  for (std::size_t k = 0; k < data.size(); ++k)
    if (is_here(k)) targets[target_of(k)] = 0;
  VectorXd at(static_cast<Index>(targets.size()));
  std::vector<int> approach;
  Index number = 0;
  for (auto& [target, index] : targets) {
    at(number) = static_cast<double>(target.second) * kSamePlace_mm;
    approach.push_back(target.first);
    index = number++;
  }
  MatrixXd values = MatrixXd::Zero(static_cast<Index>(data.size()), at.size());
  for (std::size_t k = 0; k < data.size(); ++k)
    if (is_here(k))
      values(static_cast<Index>(k), targets.at(target_of(k))) =
          line.acts == Acts::on_reversal ? static_cast<double>(data.approach[k]) : 1.0;
  return {at, values, approach};
}

/// Variances of separate errors at these targets: of all alike, and of those of one approach only.
std::vector<MatrixXd> separate_errors(const Targets& targets) {
  std::vector<MatrixXd> all{MatrixXd::Identity(targets.at.size(), targets.at.size())};
  for (const int way : {1, -1}) {
    VectorXd variance = VectorXd::Zero(targets.at.size());
    for (std::size_t i = 0; i < targets.approach.size(); ++i)
      if (targets.approach[i] == way) variance(static_cast<Index>(i)) = 1.0;
    if (!variance.isZero(0.0)) all.emplace_back(variance.asDiagonal());
  }
  return all;
}

/// What the readings of a line have in common: a constant, or backlash where the approach matters.
MatrixXd level_of_line(const Observations& data, const Line& line) {
  MatrixXd level = MatrixXd::Zero(static_cast<Index>(data.size()), 1);
  for (std::size_t k = 0; k < data.size(); ++k)
    if (data.axis[k] == line.axis && data.sense[k] == line.sense)
      level(static_cast<Index>(k), 0) = line.acts == Acts::on_mean ? 1.0 : static_cast<double>(data.approach[k]);
  return level;
}

}  // namespace

void hold_against_single_targets(const Observations& data, const Search& search, const Whitener& whitener,
                                 Found& found) {
  constexpr Index kFewestTargets = 4, kMostTargets = 60;
  if (!data.paths.empty() || !data.through_chain.empty()) return;
  const std::vector<Choice>& chosen = found.solution.chosen;
  const auto effect_of = [&](std::size_t i) -> const EffectInstance& {
    return found.families[chosen[i].family].effect;
  };
  std::map<Line, std::vector<std::size_t>> lines;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const EffectInstance& effect = effect_of(i);
    if (!effect.traits().shape_of_position || effect.traits().of_measurement || !effect.axis || !effect.sense ||
        found.groups[i].denied)
      continue;
    lines[{*effect.axis, *effect.sense,
           effect.traits().of_approach             ? Acts::on_reversal
           : effect.approach != ApproachMode::both ? Acts::on_one_way
                                                   : Acts::on_mean}]
        .push_back(i);
  }
  for (auto& [line, members] : lines) {  // waves of each approach beside a lost motion may be the rest of its shape
    if (line.acts != Acts::on_one_way) continue;
    const auto reversal = lines.find({line.axis, line.sense, Acts::on_reversal});
    if (reversal == lines.end()) continue;
    members.insert(members.end(), reversal->second.begin(), reversal->second.end());
    reversal->second.clear();
  }
  for (const auto& [line, members] : lines) {
    if (members.empty()) continue;
    const Targets errors = targets_of_line(data, line);
    // a curve beside waves of one approach is a lost motion
    const Targets targets =
        line.acts == Acts::on_one_way ? targets_of_line(data, {line.axis, line.sense, Acts::on_reversal}) : errors;
    if (targets.at.size() < kFewestTargets || targets.at.size() > kMostTargets) continue;
    bool curve = false;
    double parameters = 0.0, coefficients = 0.0, choice = 0.0;
    std::vector<Choice> rest, beside_curve;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const bool is_member = std::ranges::find(members, i) != members.end();
      const bool is_curve = is_member && effect_of(i).traits().is_curve;
      curve = curve || is_curve;
      if (!is_member) rest.push_back(chosen[i]);
      if (!is_curve) beside_curve.push_back(chosen[i]);
      if (!is_member) continue;
      const double own = static_cast<double>(chosen[i].parameters);
      parameters += own;
      if (is_curve) continue;
      coefficients += own;
      choice += std::max(0.0, chosen[i].cost - own * found.families[chosen[i].family].ln_readings);
    }
    const auto space_of = [&](const std::vector<Choice>& set) {
      return search.solution(set, found.solution.own).space;
    };
    const MatrixXd white_errors = whitener(errors.values), white_targets = whitener(targets.values);
    const Space without = space_of(rest), with = space_of(beside_curve);
    Space with_each = without;
    absorb(with_each, white_errors);
    const double free = static_cast<double>(with_each.q.cols() - without.q.cols());
    double together = 0.0;
    if (coefficients > 0.0) {
      // what a curve takes is counted there; without one, what effects leave beyond the noise is for other tests
      const double most = without.chi2() - with_each.chi2() - std::max(0.0, free - coefficients);
      together = evidence_of(curve ? without.chi2() - with.chi2() : most, coefficients) - choice;
    }
    MatrixXd straight(targets.at.size(), 2);
    straight << VectorXd::Ones(targets.at.size()), targets.at;
    const auto evidence_along = [&](const Space& beside, const std::vector<MatrixXd>& covariances) {
      Space beside_line = beside;  // the straight part has a size of its own
      absorb(beside_line, white_targets * straight);
      const SeenValues seen = seen_beside(beside_line, white_targets);
      double most = 0.0;
      for (const MatrixXd& covariance : covariances) most = std::max(most, evidence_of_values(seen, covariance));
      return most + evidence_of(beside.chi2() - beside_line.chi2(),
                                static_cast<double>(beside_line.q.cols() - beside.q.cols()));
    };
    const std::vector<MatrixXd> smooth{smooth_covariance(targets.at, 1.0), smooth_covariance(targets.at, 2.0)};
    if (curve) together += evidence_along(with, smooth);
    // a shape that needs half as many parameters as there are values, or leaves more than a curve may, follows jumps
    // too
    const double left = found.solution.space.chi2() - with_each.chi2() - std::max(0.0, free - parameters);
    const bool follows_jumps =
        2.0 * parameters >= free || left > kLeastBesideCurve * (without.chi2() - with_each.chi2());
    const bool jumps = line.acts != Acts::on_mean && targets.at.size() > Index{kFreeTargets} && follows_jumps &&
                       evidence_along(without, {covariance_of_jumps(targets.at)}) >
                           std::max(together, evidence_along(without, smooth)) + 2.0 * std::log(kProved);
    Space beside_level = without;  // single targets may have a level in common, such as backlash
    absorb(beside_level, whitener(level_of_line(data, line)));
    const double level = evidence_of(without.chi2() - beside_level.chi2(), 1.0);
    double separate = 0.0;
    const auto try_errors = [&](const Targets& of, const MatrixXd& white) {
      const SeenValues beside = seen_beside(beside_level, white), alone = seen_beside(without, white);
      for (const MatrixXd& variances : separate_errors(of))
        separate =
            std::max({separate, level + evidence_of_values(beside, variances), evidence_of_values(alone, variances)});
    };
    try_errors(errors, white_errors);
    if (line.acts == Acts::on_one_way) try_errors(targets, white_targets);  // or a lost motion without any order
    const double better = together - separate;
    if (better > 2.0 * std::log(kProved) && !jumps) continue;
    const bool open = better > -2.0 * std::log(kShapeBeforehand) && !jumps;  // proof does without it
    std::vector<std::string> names;
    for (const std::size_t i : members) {
      names.push_back(to_text(effect_of(i)));
      found.groups[i].alias = Alias::single_targets;
      found.groups[i].denied = !open;
    }
    if (!open && found.objection.empty())
      found.objection = fmt::format("{} are more probable than {}: measure at targets between the present ones",
                                    jumps ? "jumps from one place to the next, or errors of single targets,"
                                          : "errors of single targets, without any order,",
                                    fmt::join(names, " and "));
  }
}

}  // namespace ecs::model
