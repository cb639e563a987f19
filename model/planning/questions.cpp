// What is open after a diagnosis: rivals, dependences as straight lines between bins, and causes below the power of the
// present readings (noncentrality of the F test: Scheffé 1959): their whitened norm beside what the model absorbs.
#include "model/planning/questions.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "model/effects/definition.hpp"
#include "model/fit/compare.hpp"
#include "model/fit/search.hpp"
#include "model/linear/decompositions.hpp"
#include "model/planning/sentences.hpp"
#include "model/regression/candidates.hpp"
#include "model/regression/user_formula.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool lists(const Candidate& candidate, const EffectInstance& other) {
  const auto& list = candidate.indistinguishable_from;
  return std::find(list.begin(), list.end(), to_text(other)) != list.end();
}

/// Least separation [sigma] at which a cause counts as seen: as what separates rivals.
constexpr double kSeen = kSeparates;

double rms_where_not_zero(const VectorXd& column) {
  double sum = 0.0, count = 0.0;
  for (Index k = 0; k < column.size(); ++k) {
    sum += column(k) * column(k);
    count += column(k) != 0.0 ? 1.0 : 0.0;
  }
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

}  // namespace

std::string name_with_sensor(const EffectInstance& effect) {
  std::string name = to_text(effect);
  if (!effect.sensor.empty()) name += fmt::format(" ({})", sensors_text(effect));
  if (effect.approach != ApproachMode::both) name += fmt::format(" ({})", name_of(effect.approach));
  return name;
}

OpenGroup open_group(const Diagnosis& diagnosis) {
  OpenGroup group;
  if (diagnosis.candidates.empty()) return group;
  const Candidate* first = &diagnosis.candidates.front();
  for (const Candidate& candidate : diagnosis.candidates)
    if (candidate.in_answer() && !candidate.indistinguishable_from.empty()) {
      first = &candidate;
      break;
    }
  group.rivals.push_back(first->effect);
  for (const Candidate& other : diagnosis.candidates) {
    if (&other == first) continue;
    const bool rival = lists(*first, other.effect) && !same_candidate(other.effect, first->effect);
    if (rival && !other.in_answer())
      group.rivals.push_back(other.effect);
    else if (other.in_answer())
      group.settled.push_back(other.effect);
  }
  for (const EffectInstance& rival : group.rivals) group.names.push_back(name_with_sensor(rival));
  return group;
}

std::vector<std::string> extra_columns_of(const EffectInstance& effect, const Observations& data) {
  if (!effect.is_user()) return {};
  const auto formulas = UserFormulas::compile(effect, data);
  if (!formulas) return {};
  std::vector<std::string> names = formulas->optional_columns();
  std::erase_if(names, [&](const std::string& name) { return name == "set_up" || !data.extras.contains(name); });
  return names;
}

bool says_what_comes(const std::string& variable) {
  return variable != "run" && variable != "time_s" && variable != "row";
}

Explanation depends_on(const Dependence& dependence, const Observations& all) {
  const auto n = static_cast<Index>(all.size());
  const std::vector<double>& at = dependence.at;
  Explanation one;
  one.name = dependence.variable;
  one.fixed = one.truth = VectorXd::Zero(n);
  one.columns = MatrixXd::Zero(n, static_cast<Index>(at.size()));
  const bool unknown_beyond = !says_what_comes(one.name);
  for (Index k = 0; k < n; ++k) {
    const double value = variable_of(all, static_cast<std::size_t>(k), one.name);
    if (std::isnan(value) || at.empty()) continue;
    if (unknown_beyond && (value < at.front() || value > at.back())) continue;
    const auto above = std::upper_bound(at.begin(), at.end(), value);
    const auto j = static_cast<Index>(
        std::clamp<std::ptrdiff_t>(above - at.begin() - 1, 0, std::max<std::ptrdiff_t>(0, std::ssize(at) - 2)));
    if (at.size() == 1) {
      one.columns(k, 0) = 1.0;
      continue;
    }
    const auto jj = static_cast<std::size_t>(j);
    const double part = std::clamp((value - at[jj]) / (at[jj + 1] - at[jj]), 0.0, 1.0);
    one.columns(k, j) = 1.0 - part;
    one.columns(k, j + 1) = part;
  }
  one.truth = one.columns * Eigen::Map<const VectorXd>(dependence.mean_um.data(), std::ssize(dependence.mean_um));
  return one;
}

std::vector<Explanation> unseen_causes(const Belief& belief, const WithProposals& all, const Regressors& regressors,
                                       const Model& model, std::size_t most) {
  const auto present = static_cast<Index>(all.present);
  NoiseModel noise = belief.noise;
  const Observations now = present_of(all);
  const Whitener whitener(now, noise, belief.left_out);
  Space base;
  base.y = VectorXd::Zero(present);
  base.q.resize(present, 0);
  absorb(base, whitener(MatrixXd(belief.columns.topRows(present))));
  std::vector<std::pair<double, Explanation>> unseen;
  for (const EffectInstance& effect : candidate_instances(now)) {
    const EffectTraits& traits = effect.traits();
    const bool free_shape = (traits.is_curve && !traits.keeps_mean) || traits.fixed_size ||
                            !effect.definition().searched_parameter().empty();
    const bool believed = std::any_of(model.effects.begin(), model.effects.end(),
                                      [&](const EffectInstance& e) { return same_candidate(e, effect); });
    if (free_shape || believed) continue;
    const MatrixXd columns = regressors.columns(effect, 0.0).of;
    // of an angle its slope: the mean is lost where the readout is zeroed on another line; of a shift and a change of
    // slope with a condition each by itself
    const Index first = traits.keeps_mean ? 1 : 0;
    const Index last = traits.of_condition ? columns.cols() - 1 : first;
    for (Index shown = first; shown <= last; ++shown) {
      Explanation one;
      one.name = name_with_sensor(effect);
      if (last > first)
        one.name += fmt::format(" ({})", effect.definition().parameters[static_cast<std::size_t>(shown)].meaning);
      one.columns = columns.leftCols(shown + 1);
      const VectorXd shape = columns.col(shown);
      double size = rms_where_not_zero(shape.head(present));
      if (traits.of_condition || size <= 0.0)
        size = std::max(size, rms_where_not_zero(shape.tail(shape.size() - present)));
      if (size <= 0.0) continue;
      one.truth = shape * (noise.pure.noise_um / size);
      one.fixed = VectorXd::Zero(one.truth.size());
      const double left = without(base.q, whitener(VectorXd(one.truth.head(present)))).norm();
      if (left < kSeen) unseen.emplace_back(left, std::move(one));
    }
  }
  std::stable_sort(unseen.begin(), unseen.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (unseen.size() > most) unseen.resize(most);
  std::vector<Explanation> list;
  for (auto& each : unseen) list.push_back(std::move(each.second));
  return list;
}

}  // namespace ecs::model
