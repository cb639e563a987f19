// What is open after a diagnosis: rivals, dependences as straight lines between bins, and causes below the power of the
// present readings (noncentrality of the F test: Scheffé 1959): their whitened norm beside what the model absorbs.
// Sentences from numbers.
#include "model/planning/questions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/linear/decompositions.hpp"
#include "model/diagnosis/stepwise.hpp"
#include "model/diagnosis/words.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/compare.hpp"
#include "model/fit/search.hpp"
#include "model/fit/statistics.hpp"
#include "model/regression/candidates.hpp"
#include "model/regression/user_formula.hpp"

namespace ecs::model {
namespace {

std::string ways_of(const MeasurementProposal& p) {
  if (p.bidirectional) return "both ways";
  return p.approach < 0 ? "reverse only" : "forward only";
}

/// The first of many, and how many more.
std::string listed(const std::vector<std::string>& parts) {
  constexpr std::size_t kMost = 4;
  if (parts.size() == 1) return parts.front();
  if (parts.size() <= kMost)
    return fmt::format("{} and {}", fmt::join(parts.begin(), parts.end() - 1, ", "), parts.back());
  return fmt::format("{} and {} more", fmt::join(parts.begin(), parts.begin() + kMost, ", "), parts.size() - kMost);
}

/// How far the targets lie from equal steps at the utmost [mm].
double off_equal_steps_mm(const std::vector<double>& targets_mm) {
  if (is_even_between_ends(targets_mm)) return 0.0;
  double most_mm = 0.0;
  const double last = static_cast<double>(targets_mm.size()) - 1.0;
  for (std::size_t i = 0; i < targets_mm.size(); ++i)
    most_mm = std::max(most_mm, std::abs(targets_mm[i] - std::lerp(targets_mm.front(), targets_mm.back(),
                                                                   static_cast<double>(i) / std::max(last, 1.0))));
  return most_mm;
}

/// Whether the targets lie on a grid of more than a fiftieth of their mean distance: periods of the grid do not show.
bool are_on_a_grid(const std::vector<double>& targets_mm) {
  constexpr double kMicrometres = 1e3, kGrid = 0.02;
  std::int64_t grid = 0;
  for (const double target_mm : targets_mm)
    grid = std::gcd(grid, std::llround((target_mm - targets_mm.front()) * kMicrometres));
  const double range_mm = std::abs(targets_mm.back() - targets_mm.front());
  return static_cast<double>(grid) * static_cast<double>(targets_mm.size()) > kGrid * kMicrometres * range_mm;
}

/// A pair that a run separates by this many sigmas, whichever of the two is true.
struct Apart {
  std::string first, second;
  double sigma = 0.0;
};

std::vector<Apart> pairs_once(const MeasurementProposal& p) {
  std::vector<Apart> list;
  for (const PairSeparation& pair : p.pairs) {
    const auto back = std::ranges::find_if(
        list, [&](const Apart& one) { return one.first == pair.rival && one.second == pair.truth; });
    if (back == list.end())
      list.push_back({pair.truth, pair.rival, pair.sigma});
    else
      back->sigma = std::min(back->sigma, pair.sigma);
  }
  std::ranges::stable_sort(list, [](const Apart& a, const Apart& b) { return a.sigma > b.sigma; });
  return list;
}

/// The effect that every pair of the first contains, and none of the second; empty: there is none.
std::string apart_from_all(const std::vector<Apart>& apart, const std::vector<Apart>& together) {
  if (apart.size() < 2 || together.empty()) return {};
  for (const std::string& one : {apart.front().first, apart.front().second}) {
    const auto is_of = [&](const Apart& pair) { return pair.first == one || pair.second == one; };
    if (!one.empty() && std::ranges::all_of(apart, is_of) && std::ranges::none_of(together, is_of)) return one;
  }
  return {};
}

std::string names_of(const std::vector<Apart>& pairs) {
  std::vector<std::string> names;
  for (const Apart& pair : pairs)
    names.push_back(pair.second.empty() ? pair.first : fmt::format("{} from {}", pair.first, pair.second));
  return listed(names);
}

}  // namespace

std::string minutes_text(const MeasurementProposal& p) {
  return fmt::format("{:.0f} min{}", p.minutes, p.set_up_minutes > 0.0 ? " including set-up" : "");
}

std::string what_it_tells(const MeasurementProposal& p, Question question) {
  const std::string minutes = minutes_text(p);
  if (question == Question::repeat) return fmt::format("shows whether the residual repeats ({})", minutes);
  std::vector<Apart> apart, together;
  double least = kBeyondAll;
  for (const Apart& pair : pairs_once(p)) {
    if (pair.sigma < std::min(kSeparates, p.separation_sigma)) {
      together.push_back(pair);
      continue;
    }
    apart.push_back(pair);
    least = std::min(least, pair.sigma);
  }
  if (question == Question::see)
    return fmt::format(
        "A measurement of {} would show {} at {:.1f} sigma if this error were as large as the noise of "
        "one reading",
        minutes, names_of(apart), p.separation_sigma);
  if (question == Question::confirm)
    return fmt::format("confirms {}: {:.1f} sigma, {}", names_of(apart), least, minutes);
  if (apart.empty()) return fmt::format("rules out one of the group: {:.1f} sigma, {}", p.separation_sigma, minutes);
  const std::string alone = apart_from_all(apart, together);
  std::string text =
      fmt::format("distinguishes {} ({:.1f} sigma, {})",
                  alone.empty() ? names_of(apart) : fmt::format("{} from all the others", alone), least, minutes);
  if (!together.empty()) text += fmt::format(", but not {}", names_of(together));
  return text;
}

namespace {

std::string sentence_of_circle(const MeasurementProposal& p) {
  const Path& circle = *p.circle;
  std::string centre;
  for (const Axis axis : circle.plane)
    centre += fmt::format(" {}{:g}", letter_of(axis), circle.from_mm[index_of(axis)]);
  return fmt::format(
      "Measure {}, with a ball bar: radius {:g} mm about{}, {} {} in each direction, a reading every {:g} "
      "deg, feed {:g} mm/min.",
      p.condition, circle.radius_mm, centre, p.runs, p.runs == 1 ? "turn" : "turns", p.circle_step_deg, p.feed_mm_min);
}

/// "0, 90 and 180"
std::string enumerated(const std::vector<double>& values) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i)
    text += fmt::format("{}{:g}", i == 0 ? "" : i + 1 == values.size() ? " and " : ", ", values[i]);
  return text;
}

/// "B from -90 to 90 deg in steps of 22.5 deg, with C at 0, 90, 180 and 270 deg": sweeps with the same targets
/// together.
std::string sweeps_text(const std::vector<BallSet::Sweep>& sweeps) {
  std::string text;
  for (std::size_t i = 0; i < sweeps.size();) {
    const BallSet::Sweep& first = sweeps[i];
    std::vector<double> parked_deg;
    std::optional<std::size_t> other;  // the parked axis
    for (; i < sweeps.size() && sweeps[i].axis == first.axis && sweeps[i].targets_deg == first.targets_deg; ++i) {
      for (std::size_t a = 0; a < kAxes; ++a)
        if (sweeps[i].parked_deg[a] != 0.0) other = a;
      parked_deg.push_back(0.0);
      if (other) parked_deg.back() = sweeps[i].parked_deg[*other];
    }
    text += fmt::format("{}{} from {:g} to {:g} deg in steps of {:g} deg", text.empty() ? "" : "; ",
                        laser::letter_of(first.axis, true), first.targets_deg.front(), first.targets_deg.back(),
                        first.targets_deg[1] - first.targets_deg[0]);
    if (other)
      text +=
          fmt::format(", with {} at {} deg", laser::letter_of(static_cast<Axis>(*other), true), enumerated(parked_deg));
  }
  return text;
}

std::string sentence_of_ball(const MeasurementProposal& p) {
  const BallSet& ball = *p.ball;
  return fmt::format(
      "Measure the ball {}: X {:.3f} Y {:.3f} Z {:.3f} mm with the rotary axes at 0. Turn {}; both ways, {} {}. {}",
      p.condition, ball.place_mm[0], ball.place_mm[1], ball.place_mm[2], sweeps_text(ball.sweeps), p.runs,
      p.runs == 1 ? "run" : "runs", ball.why);
}

std::string targets_text(const MeasurementProposal& p) {
  const std::vector<double>& targets_mm = p.targets_mm;
  if (targets_mm.size() == 1) return fmt::format("1 target at {:g} mm", targets_mm.front());
  if (p.at_present_targets && p.ends_moved)
    return fmt::format("at the {} targets of the present file, the outermost moved to {:g} and {:g} mm for the overrun",
                       targets_mm.size(), targets_mm.front(), targets_mm.back());
  return fmt::format("{}{} targets{} from {:g} to {:g} mm", p.at_present_targets ? "at the " : "", targets_mm.size(),
                     p.at_present_targets ? " of the present file," : "", targets_mm.front(), targets_mm.back());
}

}  // namespace

std::string sentence_of(const MeasurementProposal& p) {
  if (p.ball) return sentence_of_ball(p);
  if (p.circle) return sentence_of_circle(p);
  std::string what = readings_word(p.sense, p.axis);
  if (what.starts_with("Angles")) what.front() = 'a';
  std::string text = fmt::format("Measure {} {}: {}, {}, {} {}, feed {:g} mm/min", what, p.condition, targets_text(p),
                                 ways_of(p), p.runs, p.runs == 1 ? "run" : "runs", p.feed_mm_min);
  if (p.second_feed_mm_min) text += fmt::format(" and {:g} mm/min", *p.second_feed_mm_min);
  text += p.dwell_s > 0.0 ? fmt::format(", {:g} s dwell", p.dwell_s) : ", readings on the fly";
  constexpr double kWorthSaying_mm = 0.1;
  if (const double off_mm = off_equal_steps_mm(p.targets_mm);
      off_mm > kWorthSaying_mm && !p.at_present_targets && !are_on_a_grid(p.targets_mm))
    text += fmt::format(
        ". The targets are up to {:.1f} mm off equal steps, so that a short period is not mistaken for a long one",
        off_mm);
  return text + ".";
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool lists(const Candidate& candidate, const EffectInstance& other) {
  const auto& list = candidate.indistinguishable_from;
  return std::ranges::find(list, to_text(other)) != list.end();
}

/// Least separation [sigma] at which a cause counts as seen: as what separates rivals.
constexpr double kSeen = kSeparates;

/// Whether two parts of one effect have the same sizes held.
bool same_columns(const EffectInstance& one, const EffectInstance& other) { return one.parameters == other.parameters; }

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

namespace {

/// A cause with its rivals, beside the others of the answer.
OpenGroup group_around(const Candidate& first, const Diagnosis& diagnosis) {
  OpenGroup group{{first.effect}, {}, {}};
  for (const Candidate& other : diagnosis.candidates) {
    if (&other == &first) continue;
    const bool rival =
        lists(first, other.effect) && first.is_open(other.effect) && !same_candidate(other.effect, first.effect);
    if (rival && !other.in_answer())
      group.rivals.push_back(other.effect);
    else if (other.in_answer())
      group.settled.push_back(other.effect);
  }
  return group;
}

/// A part of a cause, with what may take its place.
OpenGroup group_of_part(const Candidate& whole, const Diagnosis& diagnosis) {
  const RivalOfPart& first = whole.in_part.front();
  OpenGroup group{{first.part}, {}, {first.kept}};
  for (const RivalOfPart& one : whole.in_part)
    if (same_columns(one.part, first.part)) group.rivals.push_back(one.other);
  for (const Candidate& other : diagnosis.candidates)
    if (other.in_answer() && &other != &whole) group.settled.push_back(other.effect);
  return group;
}

/// A wave at the periods that fit as well.
OpenGroup group_of_periods(const Candidate& wave, const Diagnosis& diagnosis) {
  constexpr std::size_t kMostPeriods = 4;  // as many as a sentence lists
  OpenGroup group;
  const std::string period(wave.effect.definition().searched_parameter());
  const auto values = wave.parameters_set.find(period);
  if (!wave.effect.traits().periodic || values == wave.parameters_set.end()) return group;
  for (std::size_t i = 0; i < std::min(kMostPeriods, values->second.size()); ++i) {
    group.rivals.push_back(wave.effect);
    group.rivals.back().fitted[period] = values->second[i];
  }
  for (const Candidate& other : diagnosis.candidates)
    if (other.in_answer() && &other != &wave) group.settled.push_back(other.effect);
  return group;
}

}  // namespace

OpenGroup named(OpenGroup group) {
  for (const EffectInstance& rival : group.rivals) {
    const auto alike =
        std::ranges::count_if(group.rivals, [&](const EffectInstance& other) { return same_candidate(other, rival); });
    group.names.push_back(name_with_sensor(rival));
    if (const auto period = searched_value(rival); period && alike > 1)
      group.names.back() += fmt::format(" at {:.4g}", *period);
  }
  return group;
}

std::vector<OpenGroup> open_groups(const Diagnosis& diagnosis) {
  std::vector<OpenGroup> groups;
  for (const Candidate& one : diagnosis.candidates)
    if (one.in_answer() && !one.indistinguishable_from.empty())
      if (OpenGroup group = group_around(one, diagnosis); group.rivals.size() > 1) groups.push_back(std::move(group));
  for (const Candidate& one : diagnosis.candidates)
    if (one.in_answer() && !one.in_part.empty()) groups.push_back(group_of_part(one, diagnosis));
  for (const Candidate& one : diagnosis.candidates)
    if (one.in_answer())
      if (OpenGroup group = group_of_periods(one, diagnosis); group.rivals.size() > 1)
        groups.push_back(std::move(group));
  if (groups.empty() && !diagnosis.candidates.empty())
    groups.push_back(group_around(diagnosis.candidates.front(), diagnosis));
  for (OpenGroup& group : groups) group = named(std::move(group));
  return groups;
}

OpenGroup with_free_directions(OpenGroup group) {
  for (EffectInstance& effect : group.settled) {
    const bool is_rival_too = std::ranges::find(group.rivals, effect.id, &EffectInstance::id) != group.rivals.end();
    if (!has_directions(effect) || is_rival_too) continue;
    for (const ParameterDefinition& size : effect.definition().parameters)
      effect.parameters.erase(std::string(size.name));
  }
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
    const auto above = std::ranges::upper_bound(at, value);
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
    const bool free_shape = (traits.is_curve && !traits.keeps_mean) || traits.fixed_size || is_searched(effect);
    const bool believed =
        std::ranges::any_of(model.effects, [&](const EffectInstance& e) { return same_candidate(e, effect); });
    if (free_shape || believed) continue;
    const MatrixXd columns = regressors.columns(effect, 0.0).of;
    // of an angle its slope: the mean is lost where the readout is zeroed on another line; of a shift and a change of
    // slope with a condition each on its own
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
  std::ranges::stable_sort(unseen, [](const auto& a, const auto& b) { return a.first < b.first; });
  if (unseen.size() > most) unseen.resize(most);
  std::vector<Explanation> list;
  for (auto& each : unseen) list.push_back(std::move(each.second));
  return list;
}

}  // namespace ecs::model
