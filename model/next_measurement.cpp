#include "model/next_measurement.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "model/candidates.hpp"
#include "model/fit_core.hpp"
#include "model/fit_report.hpp"
#include "model/held_out.hpp"
#include "model/search.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// What can be changed from the present set-up, one thing at a time.
struct Variation {
  std::string condition;
  double feed = 1.0;  ///< times the present feed
  double warmer_degC = 0.0;
  double pressure_hPa = 0.0;
  double later_s = 0.0;
  bool unloaded = false;
  bool map_off = false;
  bool reversed = false;
  bool finer = false;       ///< targets between the present ones
  double lever_part = 0.0;  ///< part of the other axes' travel by which they are parked elsewhere
  double set_up_minutes = 5.0;
};

std::vector<Variation> variations(const Observations& data) {
  std::vector<Variation> list;
  const auto add = [&](const char* condition, double minutes) -> Variation& {
    list.emplace_back();
    list.back().condition = condition;
    list.back().set_up_minutes = minutes;
    return list.back();
  };
  add("as now, another run", 5.0);
  add("as now, targets between the present ones", 5.0).finer = true;
  if (!data.feed_mm_min.empty()) {
    add("at a quarter of the feed", 5.0).feed = 0.25;
    add("at twice the feed", 5.0).feed = 2.0;
  }
  if (!data.sensors_degC.empty()) add("with the machine 4 degC warmer", 120.0).warmer_degC = 4.0;
  if (!data.pressure_hPa.empty()) add("on a day with 15 hPa more", 1440.0).pressure_hPa = 15.0;
  if (!data.load_kg.empty()) add("without load", 20.0).unloaded = true;
  if (!data.time_s.empty()) {
    add("two hours later", 120.0).later_s = 7200.0;
    add("targets in reverse order", 5.0).reversed = true;
  }
  if (data.map) add("with compensation switched off", 2.0).map_off = true;
  add("on a parallel line, the other axes at the far end", 15.0).lever_part = 0.8;
  return list;
}

/// The present line of a sense as one more run, changed.
struct Extension {
  Observations data;      ///< present readings, then the new ones
  std::size_t first = 0;  ///< of the new ones
  MeasurementProposal proposal;
};

Extension extended(const Observations& data, Sense sense, Axis axis, const Variation& change) {
  Extension out;
  std::vector<std::size_t> rows(data.size());
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = k;
  const std::size_t n = rows.size();
  std::set<std::pair<double, int>> seen;
  int last_run = 0;
  double last_s = 0.0, step_s = 10.0;
  for (std::size_t k = 0; k < n; ++k) {
    last_run = std::max(last_run, data.run[k]);
    if (!data.time_s.empty() && !std::isnan(data.time_s[k])) last_s = std::max(last_s, data.time_s[k]);
  }
  if (last_s > 0.0) step_s = std::clamp(last_s / static_cast<double>(n), 2.0, 60.0);
  std::vector<std::size_t> line;
  for (std::size_t k = 0; k < n; ++k)
    if (data.sense[k] == sense && data.axis[k] == axis && seen.insert({data.p_mm(k, axis), data.approach[k]}).second)
      line.push_back(k);
  if (change.reversed) std::reverse(line.begin(), line.end());
  rows.insert(rows.end(), line.begin(), line.end());
  out.data = subset(data, rows);
  out.first = n;
  MeasurementProposal& plan = out.proposal;
  plan.axis = axis;
  plan.sense = sense;
  plan.condition = change.condition;
  std::set<double> targets;
  double travelled_mm = 0.0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const std::size_t k = n + i;
    out.data.run[k] = last_run + 1;
    Vector3& p = out.data.position_mm[k];
    if (change.finer && i + 1 < line.size() && data.approach[line[i]] == data.approach[line[i + 1]])
      p[index_of(axis)] =
          0.5 * (data.position_mm[line[i]][index_of(axis)] + data.position_mm[line[i + 1]][index_of(axis)]);
    for (const Axis other : kAllAxes) {
      const auto& facts = data.machine.axes[index_of(other)];
      if (other == axis || !facts || change.lever_part <= 0.0) continue;
      const double far =
          std::abs(facts->travel_mm[0] - p[index_of(other)]) > std::abs(facts->travel_mm[1] - p[index_of(other)])
              ? facts->travel_mm[0]
              : facts->travel_mm[1];
      p[index_of(other)] = std::lerp(p[index_of(other)], far, change.lever_part);
    }
    if (!out.data.time_s.empty()) out.data.time_s[k] = last_s + change.later_s + 60.0 + step_s * static_cast<double>(i);
    if (!out.data.feed_mm_min.empty()) out.data.feed_mm_min[k] *= change.feed;
    if (!out.data.load_kg.empty() && change.unloaded) out.data.load_kg[k] = 0.0;
    if (!out.data.pressure_hPa.empty()) out.data.pressure_hPa[k] += change.pressure_hPa;
    for (auto& sensor : out.data.sensors_degC) sensor.second[k] += change.warmer_degC;
    if (change.map_off) out.data.compensated[k] = false;
    targets.insert(p[index_of(axis)]);
    plan.parked_mm = p;
    plan.bidirectional = plan.bidirectional && data.approach[line[i]] != 0;
    if (i > 0) travelled_mm += std::abs(p[index_of(axis)] - out.data.position_mm[k - 1][index_of(axis)]);
  }
  plan.parked_mm[index_of(axis)] = 0.0;
  plan.targets_mm.assign(targets.begin(), targets.end());
  if (!out.data.feed_mm_min.empty() && !line.empty() && !std::isnan(out.data.feed_mm_min[n]) &&
      out.data.feed_mm_min[n] > 0.0)
    plan.feed_mm_min = out.data.feed_mm_min[n];
  if (!out.data.load_kg.empty() && !line.empty() && !std::isnan(out.data.load_kg[n]))
    plan.load_kg = out.data.load_kg[n];
  plan.minutes = change.set_up_minutes + travelled_mm / plan.feed_mm_min +
                 static_cast<double>(line.size()) * std::min(step_s, 15.0) / 60.0;
  return out;
}

/// Columns of an effect and its contribution at the values found, on any observations.
struct Effect {
  MatrixXd columns;
  VectorXd contribution;
};

Effect effect_on(const Regressors& regressors, const Regressors& extended_regressors, const EffectInstance& effect,
                 const VectorXd& residual) {
  const auto value = effect.fitted.find(std::string(nonlinear_parameter_of(effect.id)));
  const double nonlinear = value == effect.fitted.end() ? 0.0 : value->second;
  const Columns now = regressors.columns(effect, nonlinear);
  const Columns then = extended_regressors.columns(effect, nonlinear);
  if (then.fixed.size() > 0) return {MatrixXd(then.fixed), then.fixed};
  const VectorXd sizes = least_squares(now.of, residual);
  return {then.of, then.of * sizes};
}

/// Distance in sigmas between the contribution of one effect and the best that the model with the other can do.
double separation(const MatrixXd& base, const Effect& truth, const Effect& rival, const Whitener& whitener) {
  Space space;
  space.y = whitener(truth.contribution);
  space.q.resize(space.y.size(), 0);
  absorb(space, whitener(base));
  absorb(space, whitener(rival.columns));
  return std::sqrt(space.chi2());
}

std::string sentence_of(const MeasurementProposal& p, const std::vector<std::string>& rivals) {
  std::string text = fmt::format("Measure {} along {} {}: {} targets, {}, feed {:.0f} mm/min; about {:.0f} min",
                                 name_of(p.sense), letter_of(p.axis), p.condition, p.targets_mm.size(),
                                 p.bidirectional ? "both ways" : "one way", p.feed_mm_min, p.minutes);
  if (rivals.size() > 1)
    text += fmt::format("; it separates {} by {:.1f} sigma", fmt::join(rivals, " and "), p.separation_sigma);
  return text + ".";
}

}  // namespace

NextMeasurement next_measurement(const Model& model, const Observations& data, const Diagnosis& diagnosis) {
  NextMeasurement next;
  if (diagnosis.candidates.empty()) {
    next.notes.emplace_back("nothing to separate: the model is adequate for these data");
    return next;
  }
  const Candidate& first = diagnosis.candidates.front();
  std::vector<EffectInstance> effects{first.effect};
  next.rivals.push_back(to_text(first.effect));
  for (const Candidate& other : diagnosis.candidates) {
    const auto& group = first.indistinguishable_from;
    if (&other == &first || std::find(group.begin(), group.end(), to_text(other.effect)) == group.end()) continue;
    effects.push_back(other.effect);
    next.rivals.push_back(to_text(other.effect));
  }
  const Regressors regressors(data);
  auto assembly = Assembly::of(model, regressors);
  if (!assembly) {
    next.notes.push_back(to_text(assembly.error()));
    return next;
  }
  const CoreFit core = fitted(*assembly, regressors, {});
  const Sense sense = first.effect.sense.value_or(data.sense.front());
  Axis axis = first.effect.axis.value_or(data.axis.front());
  const auto measured = [&](Sense s, Axis a) {
    for (std::size_t k = 0; k < data.size(); ++k)
      if (data.sense[k] == s && data.axis[k] == a) return true;
    return false;
  };
  Sense along = sense;
  if (!measured(along, axis))
    for (std::size_t k = 0; k < data.size(); ++k)
      if (data.axis[k] == axis) along = data.sense[k];
  if (!measured(along, axis)) {
    along = data.sense.front();
    axis = data.axis.front();
  }
  for (const Variation& change : variations(data)) {
    Extension extension = extended(data, along, axis, change);
    const Regressors more(extension.data);
    auto base = Assembly::of(model, more);
    if (!base) continue;
    for (std::size_t s = 0; s < base->slots.size(); ++s) {
      base->slots[s].nonlinear = assembly->slots[s].nonlinear;
      base->renew(s, more);
    }
    NoiseModel noise = core.noise;
    const Observations& all = extension.data;
    NoiseModel wide = plain_noise(all, core.noise.pure.noise_um);
    for (NoiseGroup& group : wide.groups)
      for (const NoiseGroup& known : noise.groups)
        if (known.sense == group.sense && known.axis == group.axis) group.white = known.sigma();
    const Whitener whitener(all, wide, std::vector<bool>(all.size(), false));
    std::vector<Effect> shapes;
    for (const EffectInstance& effect : effects) shapes.push_back(effect_on(regressors, more, effect, core.residual));
    double worst = 1e300;
    for (std::size_t i = 0; i < shapes.size(); ++i)
      for (std::size_t j = 0; j < shapes.size(); ++j)
        if (i != j) worst = std::min(worst, separation(base->columns(), shapes[i], shapes[j], whitener));
    if (shapes.size() == 1) {  // to confirm one effect: how far it stands above what the model alone can do
      const Effect nothing{MatrixXd(shapes[0].columns.rows(), 0), VectorXd::Zero(shapes[0].columns.rows())};
      worst = separation(base->columns(), shapes[0], nothing, whitener);
    }
    MeasurementProposal proposal = extension.proposal;
    proposal.separation_sigma = worst;
    proposal.sentence = sentence_of(proposal, next.rivals);
    next.proposals.push_back(std::move(proposal));
  }
  constexpr double kSeparates = 1.0;
  std::erase_if(next.proposals, [](const MeasurementProposal& p) { return p.separation_sigma < kSeparates; });
  std::stable_sort(
      next.proposals.begin(), next.proposals.end(), [](const MeasurementProposal& a, const MeasurementProposal& b) {
        constexpr double kEnough = 6.0;  // sigmas beyond which more does not tell more
        return std::min(a.separation_sigma, kEnough) / a.minutes > std::min(b.separation_sigma, kEnough) / b.minutes;
      });
  if (next.proposals.empty())
    next.notes.emplace_back(
        "no single run along this line separates them; measure another sense, or the cause itself (a sensor, a "
        "level, a square)");
  return next;
}

Result<PlanCheck> check_plan(const Model& model, const Observations& plan, double noise_um) {
  if (!(noise_um > 0.0))
    return problem(ProblemKind::usage, fmt::format("expected a noise above 0 um, got {}", noise_um));
  Observations expected = plan;
  if (const auto values = predicted(model, plan)) expected.reading = *values;
  const Regressors regressors(expected);
  auto assembly = Assembly::of(model, regressors);
  if (!assembly) return tl::unexpected(assembly.error());
  CoreOptions options;
  options.plain = true;
  CoreFit core = fitted(*assembly, regressors, options);
  const MatrixXd columns = assembly->columns();
  const Whitener whitener(expected, plain_noise(expected, noise_um), std::vector<bool>(expected.size(), false));
  const MatrixXd white = whitener(columns);
  if (white.cols() > 0) {
    const Index linear = white.cols();
    const Eigen::CompleteOrthogonalDecomposition<MatrixXd> cod(white.transpose() * white);
    MatrixXd covariance = MatrixXd::Zero(core.covariance.rows(), core.covariance.cols());
    covariance.topLeftCorner(linear, linear) = cod.pseudoInverse();
    core.covariance = covariance;
  }
  const Fit fit = told(*assembly, regressors, core);
  PlanCheck check;
  check.effects = fit.effects;
  check.condition = fit.condition;
  check.undetermined = fit.undetermined;
  for (const EffectFit& effect : fit.effects)
    if (effect.readings == 0)
      check.undetermined.push_back(fmt::format("{}: the plan does not show it", to_text(effect.effect)));
  check.determines = check.undetermined.empty();
  return check;
}

}  // namespace ecs::model
