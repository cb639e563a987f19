// The core fit reported. Standard deviations by profile likelihood where the curvature at the best value misleads
// (Bates and Watts 1988, Nonlinear Regression Analysis and Its Applications, 6.1; Venzon and Moolgavkar 1988, Applied
// Statistics 37, 87).
#include "model/fit/fit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/linear/decompositions.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/core.hpp"
#include "model/fit/noise.hpp"
#include "model/fit/search.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct ProfileSigma {
  double searched = 0.0;  ///< of the searched parameter
  VectorXd sizes;         ///< of the slot's fitted columns
};

/// Rise of χ² at three standard deviations; a third of the way there is one.
constexpr double kRise = 9.0, kSigmas = 3.0;
/// Above this many readings the curvature is exact enough.
constexpr std::size_t kMostProfiled = 4000;
constexpr int kDoublings = 6, kProfileHalvings = 8;
constexpr double kSlopeStep = 1e-5;

/// Contribution of a slot at a value of its searched parameter: the columns of its fitted sizes, and what is held.
struct Contribution {
  MatrixXd columns;
  VectorXd held;
};
Contribution at_value(const Slot& slot, const Regressors& regressors, double value) {
  const Columns all = regressors.columns(slot.effect, value, slot.acting);
  const auto n = static_cast<Index>(regressors.data().size());
  Contribution at{MatrixXd(n, static_cast<Index>(slot.used.size())),
                  all.fixed.size() > 0 ? all.fixed : VectorXd(VectorXd::Zero(n))};
  for (Index j = 0; j < slot.held_sizes.size(); ++j)
    if (slot.held_sizes(j) != 0.0) at.held += slot.held_sizes(j) * all.of.col(j);
  for (std::size_t i = 0; i < slot.used.size(); ++i) at.columns.col(static_cast<Index>(i)) = all.of.col(slot.used[i]);
  return at;
}

/// What all other slots can make of the readings: their columns, and the slopes of their searched parameters.
MatrixXd columns_beside(const Assembly& assembly, const Regressors& regressors, const CoreFit& core, std::size_t own) {
  MatrixXd columns(static_cast<Index>(regressors.data().size()), 0);
  const auto add = [&](const MatrixXd& more) {
    columns.conservativeResize(Eigen::NoChange, columns.cols() + more.cols());
    columns.rightCols(more.cols()) = more;
  };
  for (std::size_t s = 0; s < assembly.slots.size(); ++s) {
    const Slot& slot = assembly.slots[s];
    if (s == own) continue;
    add(slot.columns);
    if (slot.formulas || slot.nonlinear.empty() || !slot.nonlinear_free.front() || !slot.has_slope()) continue;
    const VectorXd sizes = core.sizes.segment(assembly.first_column(s), slot.columns.cols());
    const double step = std::max(kSlopeStep * std::abs(slot.nonlinear.front()), kSlopeStep);
    const auto value_at = [&](double value) {
      const Contribution at = at_value(slot, regressors, value);
      return VectorXd(at.held + at.columns * sizes);
    };
    add(value_at(slot.nonlinear.front() + step) - value_at(slot.nonlinear.front() - step));
  }
  return columns;
}

class SlotProfile {
 public:
  SlotProfile(const Assembly& assembly, const Regressors& regressors, const CoreFit& core, std::size_t s)
      : slot_(assembly.slots[s]), regressors_(regressors), whitener_(regressors.data(), core.noise, core.left_out) {
    const Observations& data = regressors.data();
    VectorXd rest = Eigen::Map<const VectorXd>(data.reading.data(), static_cast<Index>(data.size()));
    for (std::size_t other = 0; other < assembly.slots.size(); ++other)
      if (other != s) rest -= assembly.slots[other].fixed;
    beside_.y = whitener_(rest);
    beside_.q.resize(beside_.y.size(), 0);
    absorb(beside_, whitener_(columns_beside(assembly, regressors, core, s)));
    const double freedom = std::max(1.0, static_cast<double>(data.size()) - static_cast<double>(core.rank));
    scale_ = std::max(1.0, core.chi2 / freedom);
    best_ = at(slot_.nonlinear.front()).chi2;
  }

  struct Fitted {
    double chi2 = 0.0;
    VectorXd sizes;
  };
  [[nodiscard]] Fitted at(double value) const {
    const Contribution own = at_value(slot_, regressors_, value);
    const MatrixXd columns = beyond(own.columns);
    const VectorXd y = beside_.y - beyond(own.held);
    Fitted fitted;
    fitted.sizes = PivotedQr(columns).solve(y);
    fitted.chi2 = (y - columns * fitted.sizes).squaredNorm();
    return fitted;
  }
  [[nodiscard]] bool far(double value) const { return (at(value).chi2 - best_) / scale_ > kRise; }

  /// Where χ² has risen by kRise on one side, at most `end`.
  [[nodiscard]] double edge(double step, double end) const {
    const double best = slot_.nonlinear.front();
    const auto within = [&](double value) { return step > 0.0 ? std::min(value, end) : std::max(value, end); };
    double inside = best, outside = within(best + step);
    for (int i = 0; i < kDoublings && !far(outside); ++i) {
      inside = outside;
      step *= 2.0;
      outside = within(best + step);
      if (outside == inside) return outside;
    }
    for (int i = 0; i < kProfileHalvings; ++i) {
      const double middle = 0.5 * (inside + outside);
      (far(middle) ? outside : inside) = middle;
    }
    return outside;
  }

 private:
  [[nodiscard]] MatrixXd beyond(const MatrixXd& raw) const {
    MatrixXd white = whitener_(raw);
    white -= beside_.q * (beside_.q.transpose() * white).eval();
    return white;
  }

  const Slot& slot_;
  const Regressors& regressors_;
  Whitener whitener_;
  Space beside_;
  double scale_ = 1.0, best_ = 0.0;
};

/// A third of the longer way on which χ² rises by 9, all else fitted again (other searched parameters linearly); of the
/// sizes a third of what they change on it. Nothing for periods (their peaks are listed one by one), user formulas,
/// places, and more readings than a profile is worth.
/// @param sigma  by the curvature, where the search for the way begins
std::optional<ProfileSigma> profile_sigma(const Assembly& assembly, const Regressors& regressors, const CoreFit& core,
                                          std::size_t s, double sigma) {
  const Slot& slot = assembly.slots[s];
  const EffectDefinition& definition = slot.effect.definition();
  if (slot.formulas || slot.nonlinear.size() != 1 || !slot.nonlinear_free.front() || !slot.has_slope() ||
      definition.traits.periodic || slot.columns.cols() == 0 || slot.acting.rows.empty() ||
      definition.search.limits == nullptr || regressors.data().size() > kMostProfiled || !(sigma > 0.0))
    return std::nullopt;
  const double best = slot.nonlinear.front();
  const ValueRange range = definition.search.limits(regressors.motions(), slot.effect, slot.acting, best);
  const SlotProfile profile(assembly, regressors, core, s);
  const VectorXd sizes = profile.at(best).sizes;
  ProfileSigma result{0.0, VectorXd::Zero(sizes.size())};
  for (const double step : {-kSigmas * sigma, kSigmas * sigma}) {
    const double edge = profile.edge(step, step < 0.0 ? std::min(best, range.least) : std::max(best, range.greatest));
    result.searched = std::max(result.searched, std::abs(edge - best) / kSigmas);
    result.sizes = result.sizes.cwiseMax((profile.at(edge).sizes - sizes).cwiseAbs() / kSigmas);
  }
  return result;
}

/// The curve of a slot at a grid of machine coordinates, with the measured positions among them.
FittedCurve curve_of(const Slot& slot, const Regressors& regressors, const VectorXd& sizes) {
  FittedCurve curve;
  const CurveBasis& basis = regressors.basis_of(slot.effect);
  const Observations& data = regressors.motions();
  const double datum = data.datum_mm[index_of(*slot.effect.axis)];
  std::vector<double> places;
  constexpr int kPoints = 120;
  for (int i = 0; i <= kPoints; ++i)
    places.push_back(basis.least_mm() + (basis.greatest_mm() - basis.least_mm()) * i / kPoints);
  for (const std::size_t k : slot.acting.rows) places.push_back(data.p_mm(k, *slot.effect.axis));
  places = distinct(places, 1e-6);
  for (const double p : places) {
    double value = 0.0;
    for (std::size_t j = 0; j < slot.used.size(); ++j)
      value += sizes(static_cast<Index>(j)) *
               curve_function(slot.effect.definition(), basis, static_cast<std::size_t>(slot.used[j]), p);
    curve.p_mm.push_back(p + datum);
    curve.value.push_back(value);
  }
  return curve;
}

/// A period, length or time constant whose sigma is this many times its value is not determined.
constexpr double kLost = 100.0;

std::vector<ParameterEstimate> user_estimates(const Slot& slot, const VectorXd& sizes, const MatrixXd& covariance,
                                              const std::vector<std::optional<double>>& nonlinear_sigma) {
  std::vector<ParameterEstimate> out(slot.effect.user.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].name = slot.effect.user[i].name;
    out[i].unit = slot.effect.user[i].unit;
  }
  for (std::size_t j = 0; j < slot.user_linear.size(); ++j) {
    out[slot.user_linear[j]].value = sizes(static_cast<Index>(j));
    out[slot.user_linear[j]].sigma = std::sqrt(std::max(0.0, covariance(static_cast<Index>(j), static_cast<Index>(j))));
  }
  for (std::size_t j = 0; j < slot.user_nonlinear.size(); ++j) {
    ParameterEstimate& estimate = out[slot.user_nonlinear[j]];
    estimate.value = slot.nonlinear[j];
    estimate.held = !slot.nonlinear_free[j];
    if (!estimate.held) estimate.sigma = nonlinear_sigma[j];
  }
  return out;
}

/// Sizes and covariance of all columns of the effect, those held included.
struct AllColumns {
  VectorXd sizes;
  MatrixXd covariance;
};
AllColumns all_columns(const Slot& slot, const VectorXd& sizes, const MatrixXd& covariance) {
  AllColumns all{slot.held_sizes, MatrixXd::Zero(slot.held_sizes.size(), slot.held_sizes.size())};
  for (std::size_t i = 0; i < slot.used.size(); ++i) {
    all.sizes(slot.used[i]) = sizes(static_cast<Index>(i));
    for (std::size_t j = 0; j < slot.used.size(); ++j)
      all.covariance(slot.used[i], slot.used[j]) = covariance(static_cast<Index>(i), static_cast<Index>(j));
  }
  return all;
}

void name_held(std::vector<ParameterEstimate>& estimates, const EffectInstance& effect) {
  for (ParameterEstimate& estimate : estimates) {
    if (!effect.parameters.contains(estimate.name)) continue;
    estimate.held = true;
    estimate.sigma = std::nullopt;
  }
}

/// What no fit changes though nobody gave it: a whole fraction of a turn, and the phase of an amplitude given as 0.
void name_exact(std::vector<ParameterEstimate>& estimates, const EffectInstance& effect) {
  const ParameterEstimate* before = nullptr;
  for (ParameterEstimate& estimate : estimates) {
    const auto& all = effect.definition().parameters;
    const auto found = std::ranges::find(all, estimate.name, &ParameterDefinition::name);
    if (found == all.end()) continue;
    estimate.held = estimate.held || (found->coding == Coding::searched && has_exact_period(effect)) ||
                    (found->coding == Coding::phase && before != nullptr && before->held && before->value == 0.0);
    before = &estimate;
  }
}

/// The effect that owns a column.
std::size_t slot_of_column(const Assembly& assembly, Index column) {
  std::size_t s = 0;
  while (column >= assembly.first_column(s) + assembly.slots[s].columns.cols()) ++s;
  return s;
}

/// Adds the names of the other effects with which a column collides.
void add_colliding(const Assembly& assembly, Index column, const CoreFit& core, std::vector<std::string>& names) {
  const std::string own = to_text(assembly.slots[slot_of_column(assembly, column)].effect);
  for (const Index other : core.collides[static_cast<std::size_t>(column)]) {
    const std::string name = to_text(assembly.slots[slot_of_column(assembly, other)].effect);
    if (name != own && std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
}

/// Of either side of a collision, for only one of two columns lists the other.
std::vector<std::string> colliding_effects(const Assembly& assembly, std::size_t s, const CoreFit& core) {
  std::vector<std::string> names;
  const Index first = assembly.first_column(s), end = first + assembly.slots[s].columns.cols();
  for (Index column = first; column < end; ++column) add_colliding(assembly, column, core, names);
  const std::string own = to_text(assembly.slots[s].effect);
  for (std::size_t other = 0; other < core.collides.size(); ++other) {
    const auto& list = core.collides[other];
    if (std::ranges::none_of(list, [&](Index column) { return column >= first && column < end; })) continue;
    const std::string name = to_text(assembly.slots[slot_of_column(assembly, static_cast<Index>(other))].effect);
    if (name != own && std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

/// The covariance with standard deviations of at least `sigma`, correlations kept.
void widen(MatrixXd& covariance, const VectorXd& sigma) {
  for (Index i = 0; i < sigma.size(); ++i) {
    const double now = std::sqrt(std::max(covariance(i, i), 0.0));
    if (!(sigma(i) > now) || now <= 0.0) continue;
    covariance.row(i) *= sigma(i) / now;
    covariance.col(i) *= sigma(i) / now;
  }
}

EffectFit effect_fit(const Assembly& assembly, std::size_t s, const Regressors& regressors, const CoreFit& core,
                     Index first_nonlinear) {
  const Slot& slot = assembly.slots[s];
  EffectFit fit;
  fit.effect = slot.effect;
  fit.readings = slot.acting.readings.size();
  fit.skipped = slot.acting.skipped;
  const Index at = assembly.first_column(s), count = slot.columns.cols();
  const VectorXd sizes = core.sizes.segment(at, count);
  MatrixXd covariance = core.covariance.block(at, at, count, count);
  const VectorXd contribution = assembly.contribution(s, sizes);
  fit.contribution.assign(contribution.data(), contribution.data() + contribution.size());
  double square = 0.0;
  for (const std::size_t k : slot.acting.readings) square += fit.contribution[k] * fit.contribution[k];
  fit.rms_um = fit.readings == 0 ? 0.0 : std::sqrt(square / static_cast<double>(fit.readings));

  std::vector<std::optional<double>> nonlinear_sigma(slot.nonlinear.size());
  Index n = first_nonlinear;
  for (std::size_t j = 0; j < slot.nonlinear.size(); ++j)
    if (slot.nonlinear_free[j] && slot.has_slope()) {
      nonlinear_sigma[j] = std::sqrt(std::max(0.0, core.covariance(n, n)));
      ++n;
    }
  if (nonlinear_sigma.size() == 1 && nonlinear_sigma.front())
    if (const auto profile = profile_sigma(assembly, regressors, core, s, *nonlinear_sigma.front())) {
      nonlinear_sigma.front() = std::max(*nonlinear_sigma.front(), profile->searched);
      widen(covariance, profile->sizes);
    }
  if (slot.formulas) {
    fit.parameters = user_estimates(slot, sizes, covariance, nonlinear_sigma);
  } else if (slot.effect.traits().is_curve) {
    if (count > 0) fit.effect.curve = curve_of(slot, regressors, sizes);
    fit.parameters.push_back({"rms_um",
                              unit_of(slot.effect, slot.effect.definition().parameters.front()),
                              rms_of(fit.effect.curve.value),
                              {},
                              count == 0,
                              false});
  } else {
    const AllColumns all = all_columns(slot, sizes, covariance);
    std::optional<double> nonlinear, sigma;
    if (!slot.nonlinear.empty()) {
      nonlinear = slot.nonlinear.front();
      sigma = nonlinear_sigma.front();
    }
    fit.parameters = parameters_from(slot.effect, all.sizes, all.covariance, nonlinear, sigma);
    name_held(fit.parameters, slot.effect);
    if (!slot.at_limit.empty())
      for (ParameterEstimate& estimate : fit.parameters) estimate.sigma = std::nullopt;
  }
  fit.effect.undetermined.reset();
  bool undetermined =
      std::any_of(core.undetermined.begin() + at, core.undetermined.begin() + at + count, [](bool u) { return u; });
  for (std::size_t j = 0; j < slot.nonlinear.size(); ++j)  // its sizes follow from a place or length that nothing shows
    undetermined = undetermined || (nonlinear_sigma[j] && *nonlinear_sigma[j] > kLost * std::abs(slot.nonlinear[j]));
  for (ParameterEstimate& estimate : fit.parameters) {
    if (estimate.held) continue;
    estimate.undetermined = undetermined;
    if (undetermined) estimate.sigma = std::nullopt;
    fit.effect.fitted[estimate.name] = estimate.value;
  }
  if (undetermined) fit.effect.undetermined = colliding_effects(assembly, s, core);
  name_exact(fit.parameters, slot.effect);
  return fit;
}

void name_undetermined(const Assembly& assembly, const CoreFit& core, Fit& fit) {
  for (std::size_t column = 0; column < core.collides.size(); ++column) {
    const std::size_t s = slot_of_column(assembly, static_cast<Index>(column));
    if (!core.undetermined[column]) continue;
    std::vector<std::string> others;
    add_colliding(assembly, static_cast<Index>(column), core, others);
    const bool dependent = !core.collides[column].empty();
    if (!dependent && core.sizes(static_cast<Index>(column)) != 0.0) continue;
    std::string text = to_text(assembly.slots[s].effect);
    text += others.empty() ? ": these data do not determine it"
                           : fmt::format(" cannot be distinguished from {}", fmt::join(others, ", "));
    if (std::ranges::find(fit.undetermined, text) == fit.undetermined.end()) fit.undetermined.push_back(text);
  }
}

/// The parameter that a fitted column stands for; of a wave its sine or cosine, of a curve one of its functions.
std::string column_name(const Slot& slot, std::size_t within) {
  if (slot.formulas) return slot.effect.user[slot.user_linear[within]].name;
  const auto column = static_cast<std::size_t>(slot.used[within]);
  if (slot.effect.traits().periodic)
    return fmt::format("{}{}", column < 2 ? "" : "second ", column % 2 == 0 ? "sine" : "cosine");
  if (slot.effect.traits().is_curve) return fmt::format("function {}", column + 1);
  std::vector<std::string_view> sizes;
  for (const ParameterDefinition& parameter : slot.effect.definition().parameters)
    if (parameter.coding != Coding::searched) sizes.push_back(parameter.name);
  return std::string(sizes[std::min(column, sizes.size() - 1)]);
}

void add_correlations(const Assembly& assembly, const CoreFit& core, Fit& fit) {
  constexpr double kWorthTelling = 0.5;
  const auto name = [&](Index column) {
    const std::size_t s = slot_of_column(assembly, column);
    return fmt::format("{} {}", to_text(fit.effects[s].effect),
                       column_name(assembly.slots[s], static_cast<std::size_t>(column - assembly.first_column(s))));
  };
  for (Index i = 0; i < core.sizes.size(); ++i)
    for (Index j = 0; j < i; ++j) {
      const std::size_t a = slot_of_column(assembly, i), b = slot_of_column(assembly, j);
      if (a == b || core.undetermined[static_cast<std::size_t>(i)] || core.undetermined[static_cast<std::size_t>(j)])
        continue;
      const double value = core.covariance(i, j) / std::sqrt(core.covariance(i, i) * core.covariance(j, j));
      if (std::abs(value) >= kWorthTelling) fit.correlations.push_back({name(j), name(i), value});
    }
  std::ranges::stable_sort(fit.correlations, [](const Correlation& a, const Correlation& b) {
    return std::abs(a.value) > std::abs(b.value);
  });
}

std::optional<Problem> unusable(const Observations& data) {
  if (data.size() == 0) return problem(ProblemKind::bad_input, "no readings to fit").value();
  return std::nullopt;
}

}  // namespace

std::optional<LackOfFit> lack_of_fit_of(const Observations& data, const VectorXd& residual, const NoiseModel& noise,
                                        const std::vector<bool>& left_out, double fitted_parameters) {
  const Repeats repeats = repeats_of(data);
  const std::vector<double> sigma = noise.sigma_by_row(data.size());
  std::vector<double> sum(repeats.nodes, 0.0), weights(repeats.nodes, 0.0);
  double total = 0.0, readings = 0.0;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (left_out[k]) continue;
    const double r = residual(static_cast<Index>(k)) / sigma[k];
    const double relative = noise.relative_of(k);  // of the same group in a node
    sum[repeats.node_of[k]] += r / relative;
    weights[repeats.node_of[k]] += 1.0 / (relative * relative);
    total += r * r;
    readings += 1.0;
  }
  double between = 0.0, nodes = 0.0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (weights[i] <= 0.0) continue;
    between += sum[i] * sum[i] / weights[i];
    nodes += 1.0;
  }
  const double pure_freedom = readings - nodes, freedom = nodes - fitted_parameters;
  if (pure_freedom < 4.0 || freedom < 1.0) return std::nullopt;
  const double pure = std::max((total - between) / pure_freedom, noise.pure.is_of_step ? 1.0 : 1e-12);
  LackOfFit test;
  test.F = between / freedom / pure;
  test.p = std::exp(ln_f_tail(test.F, freedom, pure_freedom));
  return test;
}

std::string note_of_no_reading(const EffectInstance& effect, const Observations& data, const Acting& acting) {
  if (!acting.rows.empty() || acting.skipped > 0) return "";
  const Observations& motions = data.motions();
  bool has_sense = false, has_axis = false;
  int lines = 0;
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const bool of_sense = effect.sense && motions.sense[k] == *effect.sense;
    const bool along = effect.axis && motions.axis[k] == *effect.axis;
    has_sense = has_sense || of_sense;
    has_axis = has_axis || along;
    if (of_sense && along) lines = std::max(lines, motions.line_of(k));
  }
  std::string why;
  if (effect.sense && !has_sense)
    why = fmt::format(": none is of {}", name_of(*effect.sense));
  else if (effect.axis && !has_axis)
    why = fmt::format(": none is along {}", axis_letter(effect));
  else if (effect.line > lines)
    why = fmt::format(": {} was measured along {} in {} line{}", name_of(*effect.sense), axis_letter(effect), lines,
                      lines == 1 ? "" : "s");
  else
    why = ": none has the combination of axis, sense and approach that it needs";
  return fmt::format("{}: acts on none of these readings{}", to_text(effect), why);
}

SizesByUnit rms_by_unit(const Observations& data, std::span<const double> residual, const std::vector<bool>& left_out) {
  std::vector<double> lengths, angles;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (left_out.empty() || !left_out[k]) (is_rotation(data.sense[k]) ? angles : lengths).push_back(residual[k]);
  return {rms_of(lengths), rms_of(angles)};
}

Fit reported(const Assembly& assembly, const Regressors& regressors, const CoreFit& core) {
  const Observations& data = regressors.data();
  Fit fit;
  Index nonlinear = core.sizes.size();
  for (std::size_t s = 0; s < assembly.slots.size(); ++s) {
    fit.effects.push_back(effect_fit(assembly, s, regressors, core, nonlinear));
    const Slot& slot = assembly.slots[s];
    if (slot.has_slope()) nonlinear += std::ranges::count(slot.nonlinear_free, true);
    if (slot.acting.skipped > 0)
      fit.notes.push_back(fmt::format("{}: {} of {} readings skipped, they lack {}", to_text(slot.effect),
                                      slot.acting.skipped, slot.acting.skipped + slot.acting.readings.size(),
                                      slot.acting.lacking));
    if (!slot.at_limit.empty())
      fit.notes.push_back(fmt::format(
          "{}: {} is at the limit of its physical range, {:g}{}{}. The readings require a value beyond it: that part "
          "has another cause",
          to_text(slot.effect), fit.effects[s].parameters.front().name, fit.effects[s].parameters.front().value,
          fit.effects[s].parameters.front().unit.empty() ? "" : " ", fit.effects[s].parameters.front().unit));
    if (std::string note = note_of_no_reading(slot.effect, data, slot.acting); !note.empty())
      fit.notes.push_back(std::move(note));
  }
  fit.residual.assign(core.residual.data(), core.residual.data() + core.residual.size());
  for (std::size_t k = 0; k < data.size(); ++k) fit.predicted.push_back(data.reading[k] - fit.residual[k]);
  fit.rms_um = rms_of(fit.residual);
  fit.rms_by_unit = rms_by_unit(data, fit.residual);
  for (std::size_t k = 0; k < data.size(); ++k) {
    const double size = std::abs(fit.residual[k]);
    double& of_unit = is_rotation(data.sense[k]) ? fit.peak_by_unit.um_per_m : fit.peak_by_unit.um;
    of_unit = std::max(of_unit, size);
    fit.peak_um = std::max(fit.peak_um, size);
  }
  fit.fitted_parameters =
      static_cast<std::size_t>(core.rank) + static_cast<std::size_t>(core.covariance.rows() - core.sizes.size());
  fit.condition = core.condition;
  name_undetermined(assembly, core, fit);
  add_correlations(assembly, core, fit);
  const std::vector<bool> unusable = rows_unusable(data);
  for (std::size_t k = 0; k < data.size(); ++k)
    if (core.left_out[k] && !unusable[k]) fit.outliers.push_back(data.row[k]);
  std::ranges::sort(fit.outliers);
  fit.noise = core.noise.pure;
  for (const NoiseGroup& group : core.noise.groups)
    fit.noise_by_sense.push_back({group.sense, group.axis, group.white, group.correlated, group.time, group.path});
  fit.lack_of_fit =
      lack_of_fit_of(data, core.residual, core.noise, core.left_out, static_cast<double>(fit.fitted_parameters));
  fit.origin = data.origin;
  if (const auto note = note_of_missing_sensors(data)) fit.notes.push_back(*note);
  fit.notes.insert(fit.notes.end(), data.notes.begin(), data.notes.end());
  if (!core.noise.relative.empty())
    fit.notes.push_back(words_for(stated_uncertainty(data, fit.residual, fit.noise.noise_um), fit.noise.unit));
  return fit;
}

Result<Fit> fit(const Model& model, const Observations& data, const FitOptions& options) {
  if (auto wrong = unusable(data)) return tl::unexpected(std::move(*wrong));
  const Regressors regressors(data);
  ECS_TRY(assembly, Assembly::of(with_best_starts(model, regressors), regressors));
  CoreOptions core;
  core.plain = options.plain;
  core.from_values = options.from_values;
  const CoreFit result = fitted(assembly, regressors, core);
  return reported(assembly, regressors, result);
}

Model with_values(Model model, const Fit& fit) {
  for (std::size_t i = 0; i < std::min(model.effects.size(), fit.effects.size()); ++i) {
    model.effects[i].fitted = fit.effects[i].effect.fitted;
    if (!fit.effects[i].effect.curve.empty()) model.effects[i].curve = fit.effects[i].effect.curve;
    model.effects[i].undetermined = fit.effects[i].effect.undetermined;
  }
  if (fit.origin.time_s || !fit.origin.sensors_degC.empty()) model.origin = fit.origin;
  return model;
}

LadderStep rung_of(const std::string& effect, const std::string& data_name, const std::vector<double>& before,
                   const Fit& fit, const Observations& data) {
  LadderStep rung{effect, data_name, 0.0, 0.0, 0.0, fit.noise.noise_um, {}, static_cast<int>(fit.outliers.size())};
  std::vector<double> kept_before, kept;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (std::ranges::binary_search(fit.outliers, data.row[k])) continue;
    kept_before.push_back(before[k]);
    kept.push_back(fit.residual[k]);
    rung.peak_um = std::max(rung.peak_um, std::abs(fit.residual[k]));
  }
  rung.rms_before_um = rms_of(kept_before);
  rung.rms_um = rms_of(kept);
  return rung;
}

Model with_values_held(Model model) {
  for (EffectInstance& effect : model.effects) {
    if (effect.is_user()) {
      for (UserParameter& parameter : effect.user)
        if (const auto value = effect.fitted.find(parameter.name); !parameter.value && value != effect.fitted.end())
          parameter.value = value->second;
    } else if (effect.traits().is_curve) {
      if (!effect.curve.empty()) effect.parameters["rms_um"] = 0.0;
    } else {
      for (const auto& [name, value] : effect.fitted) effect.parameters.try_emplace(name, value);
    }
  }
  return model;
}

namespace {

/// Nothing of it is left to be fitted, or some of it is given and the rest is nothing.
bool has_values(const EffectInstance& held) {
  if (held.is_user()) return std::ranges::all_of(held.user, [](const UserParameter& p) { return p.value.has_value(); });
  if (held.traits().is_curve) return !held.curve.empty();
  return held.definition().parameters.empty() || std::ranges::any_of(held.parameters, [&](const auto& one) {
           return !is_left_out(held, one.first, one.second);
         });
}

}  // namespace

std::vector<Problem> problems_without_values(const Model& model) {
  std::vector<Problem> problems;
  for (const EffectInstance& effect : with_values_held(model).effects) {
    if (has_values(effect)) continue;
    problems.push_back(
        problem(ProblemKind::bad_input,
                fmt::format("{}: has no values; fit the model to data first, or give its parameters", to_text(effect)))
            .value());
  }
  return problems;
}

Result<std::vector<double>> predicted(const Model& model, const Observations& at) {
  if (auto missing = problems_without_values(model); !missing.empty())
    return tl::unexpected(folded(std::move(missing)));
  const Regressors regressors(at);
  const Model held = with_values_held(model);
  ECS_TRY(assembly, Assembly::of(held, regressors));
  for (std::size_t s = 0; s < assembly.slots.size(); ++s) assembly.renew(s, regressors);
  const VectorXd sum = assembly.fixed(at.size());
  return std::vector<double>(sum.data(), sum.data() + sum.size());
}

Result<std::vector<std::string>> notes_of_lacking(const Model& model, const Observations& at) {
  const Regressors regressors(at);
  ECS_TRY(assembly, Assembly::of(with_values_held(model), regressors));
  std::vector<std::string> notes;
  for (const Slot& slot : assembly.slots)
    if (slot.acting.skipped > 0)
      notes.push_back(fmt::format("{} is left out of {} of {} predictions: they lack {}", to_text(slot.effect),
                                  slot.acting.skipped, slot.acting.skipped + slot.acting.readings.size(),
                                  slot.acting.lacking));
  return notes;
}

}  // namespace ecs::model
