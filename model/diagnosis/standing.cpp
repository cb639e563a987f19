// Alternatives by their probabilities (narrowest group: Spector and Janson 2022); proof by readings not fitted to, and
// the chance of a false name from replicates of noise (Westfall and Young 1993). The verdicts are those of
// docs/model.md.
#include "model/diagnosis/standing.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "model/diagnosis/bad_run.hpp"
#include "model/diagnosis/structure.hpp"
#include "model/diagnosis/visits.hpp"
#include "model/diagnosis/waves.hpp"
#include "model/diagnosis/weighing.hpp"
#include "model/diagnosis/words.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/core.hpp"
#include "model/fit/held_out.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

/// A credible set holds the cause with this probability.
constexpr double kCredible = 0.99;
/// A wave alone explains nearly all of what is above noise from this share on: one whose size changes by no more than
/// two fifths of it along the travel does (1 - 0.16/3).
constexpr double kNearlyAll = 0.95;
/// Least share of what an effect explains that it predicts at left-out targets where more is left than noise: as where
/// nothing but the effect speaks against noise (investigation.hpp).
constexpr double kLeastPredicted = kLeastCrossValidatedAlone;
/// Without repeats what a model leaves is no noise where readings left out are missed by more than this many times the
/// rms of those fitted: two, for four times the squares are no chance.
constexpr double kMostHeldOut = 2.0;
constexpr std::size_t kPartsLeftOut = 5;
/// Without repeats the noise has to be known to a third: two standard deviations of an estimate of so many degrees.
constexpr double kDegreesWithoutRepeats = 20.0;
/// Readings that tell little of the noise do not show that nothing is missing where noise explains as much as the
/// closest candidate does in fewer cases than this: the usual level of a test.
constexpr double kRareOfNoise = 0.05;
/// What is left is no noise beyond this many times what repeats or neighbours show (docs/model.md, verdicts).
constexpr double kMostOfNoise = 3.0;
/// What is left below this is rounding: no instrument reads a nanometre [um].
constexpr double kNothingLeft_um = 1e-3;

/// The fewest alternatives whose probabilities reach kCredible together (narrowest group: Spector and Janson 2022).
std::vector<SetMember> credible_set(std::vector<SetMember> alternatives) {
  sort_greatest_first(alternatives, [](const SetMember& member) { return member.probability; });
  double sum = 0.0;
  std::size_t count = 0;
  while (count < alternatives.size() && sum < kCredible) sum += alternatives[count++].probability;
  alternatives.resize(count);
  return alternatives;
}

/// The member first.
std::vector<Choice> alternatives_of(const Group& group) {
  std::vector<Choice> alternatives{group.member};
  alternatives.insert(alternatives.end(), group.rivals.begin(), group.rivals.end());
  alternatives.insert(alternatives.end(), group.weaker.begin(), group.weaker.end());
  return alternatives;
}

/// @param standings  of the members of the solution; the proved ones come first, then what is likely
std::vector<RankedCandidate> ranked_candidates(const Found& found, const std::vector<Standing>& standings) {
  std::vector<RankedCandidate> list;
  const auto instance = [&](const Choice& choice) { return effect_of(found.families[choice.family].effect, choice); };
  std::vector<const Group*> groups;
  for (const Group& group : found.groups) groups.push_back(&group);
  const auto standing_of = [&](const Group* group) {
    return standings[static_cast<std::size_t>(group - found.groups.data())];
  };
  sort_greatest_first(groups, [](const Group* group) { return group->member.gain; });
  std::ranges::stable_sort(groups, [&](const Group* a, const Group* b) { return standing_of(a) > standing_of(b); });
  const auto listed = [&](const EffectInstance& effect) {
    return std::ranges::any_of(list, [&](const RankedCandidate& t) { return same_candidate(t.effect, effect); });
  };
  std::vector<std::map<std::string, double>> probability_in(groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const Group& group = *groups[g];
    const std::vector<Choice> alternatives = alternatives_of(group);
    const std::vector<double> shares = probabilities_of(alternatives, found.families);
    std::vector<SetMember> members;
    for (std::size_t i = 0; i < alternatives.size(); ++i) {
      const EffectInstance member = instance(alternatives[i]);
      members.push_back({to_text(member), shares[i], place_text(member)});
      probability_in[g].try_emplace(members.back().name, shares[i]);
    }
    RankedCandidate one{instance(group.member),
                        group.member,
                        standing_of(&group),
                        {},
                        shares.front(),
                        credible_set(std::move(members)),
                        group.values,
                        group.e_value,
                        group.alias,
                        group.p_value,
                        group.p_value_alone};
    one.found = true;
    for (const Choice& rival : group.rivals) one.rivals.push_back(instance(rival));
    for (const Choice& weaker : group.weaker)  // which sensor it follows is open, too
      if (const EffectInstance other = instance(weaker);
          follows_other_sensor(other, one.effect) &&
          std::ranges::find(one.set, place_text(other), &SetMember::place) != one.set.end())
        one.rivals.push_back(other);
    for (const Group::InPart& part : group.in_part)
      one.in_part.push_back({instance(part.kept), instance(part.part), instance(part.other)});
    list.push_back(std::move(one));
  }
  const std::size_t members = list.size();
  const auto probability_of = [&](std::size_t g, const EffectInstance& effect) {
    const auto found_in = probability_in[g].find(to_text(effect));
    return found_in == probability_in[g].end() ? 0.0 : found_in->second;
  };
  for (std::size_t g = 0; g < members; ++g)
    for (const Choice& rival : groups[g]->rivals) {
      if (listed(instance(rival))) continue;
      RankedCandidate one{
          instance(rival), rival, Standing::possible, {list[g].effect}, probability_of(g, instance(rival)),
          list[g].set};
      for (const Choice& other : groups[g]->rivals)
        if (other.family != rival.family) one.rivals.push_back(instance(other));
      list.push_back(std::move(one));
    }
  for (std::size_t g = 0; g < members; ++g)
    for (const Choice& weaker : groups[g]->weaker)
      if (!listed(instance(weaker)) && list.size() < kMostListed)
        list.push_back({instance(weaker), weaker, Standing::possible, {}, probability_of(g, instance(weaker)), {}});
  if (list.empty()) {  // nothing found: the closest, against none, beforehand as likely as all candidates together
    std::vector<Choice> alternatives = found.closest;
    alternatives.emplace_back().gain =
        2.0 * std::log(static_cast<double>(std::max<std::size_t>(found.candidates_tried, 1)));
    const std::vector<double> shares = probabilities_of(alternatives, found.families);
    for (std::size_t i = 0; i < found.closest.size(); ++i)
      list.push_back({instance(found.closest[i]), found.closest[i], Standing::possible, {}, shares[i], {}});
  }
  const double least = 1.0 / (static_cast<double>(found.replicate_scores.size()) + 1.0);  // they show no less
  for (RankedCandidate& one : list) one.false_naming = std::max(least, found.false_naming(one.choice.score()));
  return list;
}

/// Share of what is above noise that some of the effects found explain together.
/// @param chosen  which, by their number
double share_of_found(const ReportInput& in, const std::vector<std::size_t>& chosen) {
  LinearProblem all = in.problem;
  for (const std::size_t g : chosen) {
    const Choice& choice = in.found.groups[g].member;
    all = joined_with(all, columns_on(in.regressors, in.found.families[choice.family].effect, choice));
  }
  return share_explained(in, all);
}

/// Whether an effect predicts, beside the others that are proved, at targets that it was not fitted to at least half of
/// what it explains at those that it was: what is left besides repeats from run to run, and so do the errors of a fit
/// to it.
bool predicts_at_targets(const ReportInput& in, const std::vector<std::size_t>& proved, std::size_t g) {
  const Observations& data = in.regressors.data();
  if (!has_targets_to_leave_out(data)) return true;
  const auto with = [&](const LinearProblem& problem, std::size_t i) {
    const Choice& choice = in.found.groups[i].member;
    return joined_with(problem, columns_on(in.regressors, in.found.families[choice.family].effect, choice));
  };
  LinearProblem others = in.problem;
  for (const std::size_t i : proved)
    if (i != g) others = with(others, i);
  const LinearProblem all = with(others, g);
  const CoreFit& core = in.base.core;
  const Whitener whitener(data, core.noise, core.left_out);
  const Parts parts = parts_by_target(data);
  const auto square = [](double value) { return value * value; };
  const auto fitted = [&](const LinearProblem& of) {
    return square(rms_without(residual_of(of, whitener), core.left_out));
  };
  const auto held_out = [&](const LinearProblem& of) {
    return square(held_out_rms(data, core.noise, core.left_out, parts, of.columns, of.target));
  };
  return held_out(others) - held_out(all) >= kLeastPredicted * (fitted(others) - fitted(all));
}

/// Whether these effects may stand although more is left: any shape can be written as enough waves, so each wave is a
/// pitch of the machine, or all are whole fractions of one period.
bool may_be_part(const Found& found, const std::vector<std::size_t>& chosen) {
  std::vector<Choice> members;
  for (const std::size_t g : chosen) members.push_back(found.groups[g].member);
  return are_pitches_or_fractions(found.families, members);
}

/// The wave that explains nearly all on its own, although a weak one beside it beats with it or it changes a little: of
/// a wave whose size grows from nothing the best steady one explains three quarters (between repeats it grows too: what
/// they show of noise is part of the change). Nothing where there is none.
std::optional<std::size_t> nearly_steady_wave(const ReportInput& in) {
  const Found& found = in.found;
  if (found.bad_run) return std::nullopt;
  for (std::size_t g = 0; g < found.groups.size(); ++g) {
    const Group& group = found.groups[g];
    if (found.families[group.member.family].effect.traits().periodic && group.denied &&
        group.alias != Alias::single_targets && group.e_value.value_or(0.0) >= kProved &&
        share_of_found(in, {g}) >= kNearlyAll && group.member.gain >= kNearlyAll * (group.member.gain + group.change) &&
        predicts_at_targets(in, {g}, g))
      return g;
  }
  return std::nullopt;
}

/// Whether the residual beside the best effects still depends on the position along the axis of one of them.
bool leaves_shape(const Found& found, std::size_t g, const Observations& data) {
  const std::optional<Axis>& axis = found.families[found.groups[g].member.family].effect.axis;
  return axis && std::ranges::any_of(found.after, [&](const StructureTest& test) {
           return test.variable == data.position_name(*axis) && probability_from(test.minus_log_p) < kTellingChance;
         });
}

/// A curve, or what looks like one, that leaves a shape: the whole is no smooth one, and a curve follows the most of
/// any (physics: faster shapes are other effects).
bool bends_to_structure(const Found& found, std::size_t g, const Observations& data) {
  const auto is_curve = [&](const Choice& choice) { return found.families[choice.family].effect.traits().is_curve; };
  const Group& group = found.groups[g];
  return (is_curve(group.member) || std::ranges::any_of(group.rivals, is_curve)) && leaves_shape(found, g, data);
}

/// Whether this is a wave along a linear axis beside such a curve, in the same sense: a part of what is no smooth one.
/// A pitch of the machine, its fractions and its double (whose second harmonic it is) are causes of their own, and a
/// curve of the lost motion leaves nothing that is the same in both directions.
bool is_beside_bend(const Found& found, std::size_t g, const Observations& data) {
  const auto effect_of = [&](std::size_t i) -> const EffectInstance& {
    return found.families[found.groups[i].member.family].effect;
  };
  const EffectInstance& wave = effect_of(g);
  if (!wave.traits().periodic || wave.rotary) return false;
  if (const auto pitch = pitch_matching(model::effect_of(wave, found.groups[g].member), std::nullopt, data);
      pitch && pitch->times <= 2)
    return false;
  for (std::size_t i = 0; i < found.groups.size(); ++i) {
    const EffectInstance& curve = effect_of(i);
    if (curve.traits().is_curve && curve.axis == wave.axis && curve.sense == wave.sense &&
        (!curve.traits().of_approach || wave.approach != ApproachMode::both) && bends_to_structure(found, i, data))
      return true;
  }
  return false;
}

/// Whether this is an effect along a rotary axis whose scale error leaves a shape: such a ramp is a part of that shape,
/// as a wave is, and what was found beside it, too.
bool is_beside_ramp(const Found& found, std::size_t g, const Observations& data) {
  const auto axis_of = [&](std::size_t i) { return found.families[found.groups[i].member.family].effect.axis; };
  for (std::size_t i = 0; i < found.groups.size(); ++i)
    if (found.families[found.groups[i].member.family].effect.traits().adds_up && axis_of(i) == axis_of(g) &&
        leaves_shape(found, i, data))
      return true;
  return false;
}

/// Whether what these readings cannot tell from an effect holds the effect itself: beside others that are no causes
/// another one may follow the same shape far better. A lost motion is known by its sign, not by a shape.
bool is_in_own_set(const Found& found, std::size_t g) {
  const EffectTraits& traits = found.families[found.groups[g].member.family].effect.traits();
  if (traits.of_approach && !traits.shape_of_position) return true;
  return probabilities_of(alternatives_of(found.groups[g]), found.families).front() >= 1.0 - kCredible;
}

/// An effect that explains nearly all alone and predicts it at left-out targets, where so few readings were taken that
/// no half of them can speak for or against it: what little is left does not hide it.
bool is_nearly_all_of_few(const ReportInput& in, std::size_t g) {
  return in.found.noise.pure.dof < kManyDegrees && !in.found.groups[g].e_value &&
         share_of_found(in, {g}) >= kNearlyAll && predicts_at_targets(in, {g}, g) &&
         !bends_to_structure(in.found, g, in.regressors.data());
}

/// Whether another cause that repeats explains nearly as much: one of both is there. A wander is noise, and repeats
/// nothing.
bool is_beside_other_cause(const Group& group) { return group.alias != Alias::none && group.alias != Alias::wander; }

/// Whether readings that it was not fitted to speak for an effect. That one of approach coincides with passes was
/// planned: where these wander, it is not the one of all candidates that happens to look like them.
bool is_spoken_for(const Found& found, const Group& group) {
  const bool planned = found.wander_is_evident && !found.bad_run && !found.step &&
                       found.families[group.member.family].effect.traits().of_approach;
  const double enough = planned ? kPositive / static_cast<double>(found.candidates_tried) : kSpeaksFor;
  return group.e_value.value_or(0.0) >= enough;
}

/// How sure each effect found is. What leaves noise, or explains half of what is above it, is proved by readings that
/// it was not fitted to, or likely where these do not suffice; where no split shows it, noise replicates decide, and
/// prove it where the noise is known. Where more is left, noise replicates decide nothing: likely is what those
/// readings speak for.
std::vector<Standing> standings_of(const ReportInput& in, bool noise) {
  const Found& found = in.found;
  const bool explained = noise && found.objection.empty();
  const bool replicates_prove = explained && found.noise.pure.dof >= kManyDegrees;
  std::vector<Standing> standings(found.groups.size(), Standing::possible);
  std::vector<std::size_t> proved, likely;
  for (std::size_t g = 0; g < found.groups.size(); ++g) {
    const Group& group = found.groups[g];
    if (!explained && is_beside_ramp(found, g, in.regressors.data())) continue;
    if (group.denied || (found.stands_out && group.e_value.value_or(kSpeaksFor) < kSpeaksFor)) continue;
    if (group.alias == Alias::none && !found.proves_nothing &&
        (group.e_value ? *group.e_value >= kProved : replicates_prove))
      proved.push_back(g);
    else if (!(found.step && is_like_wander(found.families[group.member.family].effect)) &&
             (explained || is_beside_other_cause(group) || is_spoken_for(found, group) ||
              is_nearly_all_of_few(in, g)) &&
             found.false_naming(group.member.score()) <= kLikelyChance)
      likely.push_back(g);
  }
  if (!explained) {
    const std::vector<std::size_t> all = proved;
    std::erase_if(proved, [&](std::size_t g) { return !predicts_at_targets(in, all, g); });
    std::erase_if(proved, [&](std::size_t g) {
      return bends_to_structure(found, g, in.regressors.data()) || is_beside_bend(found, g, in.regressors.data()) ||
             !is_in_own_set(found, g);
    });
    if (!may_be_part(found, proved)) proved.clear();
  }
  if (const auto wave = nearly_steady_wave(in)) proved.insert(proved.begin(), *wave);
  for (const std::size_t g : proved) standings[g] = Standing::proved;
  std::vector<std::size_t> all = proved;
  all.insert(all.end(), likely.begin(), likely.end());
  if (!explained) {  // beyond what is proved
    const double before = proved.empty() ? 0.0 : share_of_found(in, proved);
    const double beyond = (share_of_found(in, all) - before) / std::max(1.0 - before, kLeastDivisor);
    if (!may_be_part(found, all) || beyond < kPartExplained) return standings;
  }
  for (const std::size_t g : likely) standings[g] = Standing::likely;
  return standings;
}

bool found_proved(const std::vector<Standing>& standings) {
  return std::ranges::find(standings, Standing::proved) != standings.end();
}

bool found_any(const std::vector<Standing>& standings) {
  return std::ranges::any_of(standings, [](Standing one) { return one != Standing::possible; });
}

Verdict verdict_of(const ReportInput& in, const std::vector<Standing>& standings, bool noise) {
  if (standings.empty()) return noise ? Verdict::adequate : Verdict::unexplained_structure;
  if (in.found.bad_run || (in.found.step && !found_proved(standings))) return Verdict::unexplained_structure;
  std::vector<std::size_t> proved;
  std::vector<Choice> members, all;
  for (std::size_t g = 0; g < standings.size(); ++g) {
    const Choice& member = in.found.groups[g].member;
    if (standings[g] != Standing::possible) all.push_back(member);
    if (standings[g] != Standing::proved) continue;
    proved.push_back(g);
    members.push_back(member);
  }
  if (all.empty() && noise && in.found.stands_out) return Verdict::adequate;  // or too little known of it
  const auto repeat = [&](const std::vector<Choice>& of) { return are_shape_that_repeats(in.found.families, of); };
  const auto is_nearly_all = [&](std::size_t g) { return share_of_found(in, {g}) >= kNearlyAll; };
  // a turn has many waves of its own, and a wave that is nearly all is a cause of that period
  const bool is_shape = !in.regressors.data().rotary && repeat(all) && std::ranges::none_of(proved, is_nearly_all);
  if (proved.empty()) return all.empty() || is_shape ? Verdict::unexplained_structure : Verdict::likely_effect;
  if (noise && in.found.objection.empty() && all.size() == standings.size() && !is_shape)
    return Verdict::missing_effect;
  // a wave that is no pitch of the machine and leaves a shape is the first term of that shape
  const bool begins_shape = !in.regressors.data().rotary && std::ranges::any_of(proved, [&](std::size_t g) {
    const Choice& member = in.found.groups[g].member;
    return !is_pitch_or_no_wave(in.found.families[member.family], member) && !is_nearly_all(g) &&
           leaves_shape(in.found, g, in.regressors.data());
  });
  return share_of_found(in, proved) >= kPartExplained && !repeat(members) && !begins_shape
             ? Verdict::partly_explained
             : Verdict::unexplained_structure;
}

/// Effects of the model, one of them with a free searched parameter, that cancel each other beyond the range of the
/// readings that they act on: the readings do not determine them, and whatever is missing is hidden in their freedom.
/// @param own  those with a free searched parameter, by their number
std::vector<std::string> cancelling_effects(const Observations& data, const Fit& fit,
                                            const std::vector<std::size_t>& own) {
  std::vector<std::string> names;
  bool any_free = false;
  for (std::size_t i = 0; i < fit.effects.size(); ++i) {
    const EffectFit& effect = fit.effects[i];
    if (!effect.effect.undetermined || effect.effect.undetermined->empty()) continue;
    double least = kBeyondAll, greatest = -kBeyondAll, low = kBeyondAll, high = -kBeyondAll;
    for (std::size_t k = 0; k < data.size(); ++k) {
      if (effect.contribution[k] == 0.0) continue;
      least = std::min(least, effect.contribution[k]);
      greatest = std::max(greatest, effect.contribution[k]);
      low = std::min(low, data.reading[k]);
      high = std::max(high, data.reading[k]);
    }
    if (greatest - least <= high - low) continue;
    names.push_back(to_text(effect.effect));
    any_free = any_free || std::ranges::find(own, i) != own.end();
  }
  return any_free ? names : std::vector<std::string>();
}

/// Every target was repeated, and its readings have the mean zero to the last digits: positions less their own mean.
bool are_off_their_means(const Observations& data) {
  constexpr double kLastDigits = 1e-6;
  std::map<std::tuple<Channel, Axis, Vector3, int>, std::pair<double, std::size_t>> sums;
  double largest = 0.0;
  for (std::size_t k = 0; k < data.size(); ++k) {
    auto& [sum, count] = sums[{data.channel(k), data.axis[k], data.position_mm[k], data.approach[k]}];
    sum += data.reading[k];
    ++count;
    largest = std::max(largest, std::abs(data.reading[k]));
  }
  return std::ranges::all_of(sums, [&](const auto& one) {
    const auto& [sum, count] = one.second;
    return count > 1 && std::abs(sum) < kLastDigits * largest;
  });
}

/// Why readings whose residual looks like noise do not show that nothing is missing, as a sentence; "" where they do.
std::string why_cannot_tell(const ReportInput& in) {
  const Observations& data = in.regressors.data();
  const std::vector<std::string> cancelling = cancelling_effects(data, in.base.fit, in.base.own);
  if (!cancelling.empty())
    return fmt::format("the readings do not determine {}, which cancel each other: fix one of them, or measure more",
                       fmt::join(cancelling, " and "));
  const auto lack_of_fit = lack_of_fit_of(data, in.base.residual, in.base.core.noise, in.base.core.left_out,
                                          static_cast<double>(in.base.core.rank));
  const double rms_um = rms_without(in.base.residual, in.base.core.left_out);
  if (rms_um < kNothingLeft_um) return "";
  if (lack_of_fit && lack_of_fit->fails())
    return fmt::format(
        "the residual is {} {}, and repeats show that it is not noise (lack-of-fit test: p < 0.0001): measure at "
        "more positions",
        in_digits(rms_um), in.found.noise.pure.unit);
  if (are_off_their_means(data))
    return "every target is the mean of its own readings, so they show how well a position repeats (`ecs test poses` "
           "compares ways of approach), but not where it should be: give the nominal positions";
  if (rms_um > kMostOfNoise * in.found.noise.pure.noise_um)
    return fmt::format(
        "the residual is {} {}, {} times the noise, and so few readings do not show its cause: measure the same lines "
        "again",
        in_digits(rms_um), in.found.noise.pure.unit, in_digits(rms_um / in.found.noise.pure.noise_um, 2));
  std::optional<Choice> closest = in.found.stands_out;
  if (!closest && !in.found.closest.empty()) closest = in.found.closest.front();
  if (in.found.stands_out && in.found.chance_of_closest.value_or(1.0) <= kLikelyChance) {
    const bool is_contradicted =
        !in.found.groups.empty() && in.found.groups.front().e_value.value_or(kSpeaksFor) < kSpeaksFor;
    const std::string_view but =
        in.found.groups.empty() ? "fitted without some of the targets or runs it does not predict these: measure at "
                                  "targets between the present ones too"
        : is_contradicted       ? "held-out readings do not confirm it: measure the same lines again"
                                : std::string_view(in.found.objection);
    if (!but.empty())
      return fmt::format(
          "{} would explain the residual, and noise alone looks like it in less than 1 % of cases, but {}",
          place_text(in.found.families[closest->family].effect), but);
  }
  if (closest && in.found.chance_of_closest.value_or(1.0) < kRareOfNoise)
    return fmt::format(
        "these readings do not determine the noise well enough: {} would explain the residual, but noise alone looks "
        "like it in {:.1g} % of cases: measure the same lines again",
        place_text(in.found.families[closest->family].effect), kPercent * *in.found.chance_of_closest);
  const bool is_wander = closest && is_like_wander(in.found.families[closest->family].effect);
  if (closest && (is_wander || (lack_of_fit && lack_of_fit->is_in_doubt())) &&
      in.found.false_naming(closest->score()) <= in.options.false_naming_limit)
    return fmt::format(
        "{}{} would explain a part of the residual, and noise alone hardly ever looks like that, but held-out readings "
        "do not confirm it: measure the same lines again",
        place_text(in.found.families[closest->family].effect), is_wander ? ", or a zero that wanders," : "");
  if (!in.found.noise.pure.from_repeats && in.found.noise.pure.dof < kDegreesWithoutRepeats)
    return "no line was repeated, and so few readings cannot distinguish noise from a missing effect: measure the same "
           "lines again";
  if (lack_of_fit || data.size() > in.options.largest_search) return "";
  Parts parts{std::vector<std::size_t>(data.size()), kPartsLeftOut, false};  // between readings rather than beyond them
  for (std::size_t k = 0; k < data.size(); ++k) parts.of[k] = k % kPartsLeftOut;
  const double held_out_um =
      held_out_rms(data, in.base.core.noise, in.base.core.left_out, parts, in.problem.columns, in.problem.target);
  if (held_out_um <= kMostHeldOut * rms_um) return "";
  return fmt::format(
      "no line was repeated, and the residual is {} {} for held-out readings but {} for fitted ones: measure "
      "the same lines again",
      in_digits(held_out_um), in.found.noise.pure.unit, in_digits(rms_um));
}

/// Takes the part in the answer from effects of position that errors of the points themselves would look like, of
/// points in space. @return whether any had a part
bool deny_errors_of_points(const ReportInput& in, std::vector<Standing>& standings) {
  const Observations& data = in.regressors.data();
  if (!found_any(standings) || !are_scattered_points(data)) return false;
  std::vector<std::size_t> answer, denied;
  for (std::size_t g = 0; g < standings.size(); ++g)
    if (standings[g] != Standing::possible) answer.push_back(g);
  const auto columns_of = [&](std::size_t g) {
    const Choice& choice = in.found.groups[g].member;
    return columns_on(in.regressors, in.found.families[choice.family].effect, choice);
  };
  // any set of as many candidates could have been found
  const double sets = std::pow(static_cast<double>(in.found.candidates_tried), static_cast<double>(answer.size()));
  for (const std::size_t g : answer) {
    LinearProblem others = in.problem;
    for (const std::size_t other : answer)
      if (other != g) others = joined_with(others, columns_of(other));
    const auto chance = chance_of_points(data, in.base.core.left_out, others.columns, columns_of(g).of, others.target);
    if (chance && *chance * sets > in.options.false_naming_limit) denied.push_back(g);
  }
  for (const std::size_t g : denied) standings[g] = Standing::possible;
  return !denied.empty();
}

/// Whether the effects of the answer explain the factor between this line and the others: fitted to the others alone,
/// they predict it as well as that multiple of the others does, or to within noise; or one of them acts on this line by
/// that factor more than on the others, as an angular error does by the ratio of their distances from the axis. With
/// another ratio, the factor of the readings would be chance.
bool explain_factor(const ReportInput& in, const std::vector<Standing>& standings, const ScaledLine& line) {
  constexpr double kSameFactor = 0.05, kWithinNoise = 1.6;
  const Observations& data = in.regressors.data();
  LinearProblem all = in.problem;
  for (std::size_t g = 0; g < standings.size(); ++g) {
    if (standings[g] == Standing::possible) continue;
    const Choice& choice = in.found.groups[g].member;
    const Columns of = columns_on(in.regressors, in.found.families[choice.family].effect, choice);
    all = joined_with(all, of);
    double products = 0.0, squares = 0.0;
    for (const auto& [a, b] : same_targets(data, line)) {
      products += of.of.row(static_cast<Eigen::Index>(a)).dot(of.of.row(static_cast<Eigen::Index>(b)));
      squares += of.of.row(static_cast<Eigen::Index>(b)).squaredNorm();
    }
    if (squares > 0.0 && std::abs(products / squares / line.factor - 1.0) < kSameFactor) return true;
  }
  std::vector<bool> without = in.base.core.left_out;
  double count = 0.0, squares = 0.0;
  for (std::size_t k = 0; k < data.size(); ++k) without[k] = without[k] || is_on(data, line, k);
  const Whitener others(data, in.base.core.noise, without);
  const Eigen::VectorXd left = residual_of(all, others);
  const std::vector<double> sigma = in.found.noise.sigma_by_row(data.size());
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (!is_on(data, line, k) || in.base.core.left_out[k]) continue;
    count += 1.0;
    squares += left(static_cast<Eigen::Index>(k)) * left(static_cast<Eigen::Index>(k));
  }
  return squares <= count * std::pow(std::max(line.left_um, kWithinNoise * sigma[line.first]), 2);
}

}  // namespace

/// Why the best effects of the library do not count as an explanation.
std::string why_not_explained(const Found& found) {
  if (!found.objection.empty()) return found.objection;
  if (!found.doubt.empty()) return found.doubt;
  if (found.noisy) return words_for(*found.noisy) + ": check that run first";
  if (found.odd_pass)
    return fmt::format("run {} differs from the other runs by {:.3g} in one approach: check that run first",
                       found.odd_pass->run, found.odd_pass->off_um);
  if (found.wanders)
    return "readings of one run drift by more than three times the scatter of neighbouring readings: this is not noise";
  if (found.wave)
    return fmt::format("a periodic error of about {:.3g} {} is left whose phase differs from pass to pass",
                       found.wave->period, found.wave->unit);
  if (found.cross_validated_share < kLeastCrossValidated)
    return fmt::format("the best effects of the library predict only {:.0f} % of the residual at held-out targets",
                       kPercent * std::max(0.0, found.cross_validated_share));
  const auto most = std::ranges::max_element(
      found.after, [](const StructureTest& a, const StructureTest& b) { return a.minus_log_p < b.minus_log_p; });
  if (most == found.after.end()) return "structure remains after the best effects of the library";
  constexpr double kLeastStated = 1e-60;
  return fmt::format(
      "with the best effects of the library the residual still depends on {} (probability in noise alone: {})",
      most->variable,
      found.structure_p_after < kLeastStated ? "below 1e-60" : fmt::format("{:.2g}", found.structure_p_after));
}

std::string why_not_named(const ReportInput& in) {
  const std::vector<Group>& groups = in.found.groups;
  const auto most = std::ranges::max_element(
      groups, [](const Group& one, const Group& other) { return one.member.gain < other.member.gain; });
  if (most == groups.end() || most->denied || in.found.bad_run) return in.found.objection;
  const auto g = static_cast<std::size_t>(most - groups.begin());
  const std::string name = to_text(in.found.families[most->member.family].effect);
  if (most->e_value && *most->e_value < kProved)
    return fmt::format(
        "held-out readings do not decide {} (e-value {:.2g}; {:g} is proof): measure the same lines again", name,
        *most->e_value, kProved);
  if (!predicts_at_targets(in, {g}, g))
    return fmt::format(
        "{} does not predict the residual at targets that it is not fitted to: measure at targets "
        "between the present ones",
        name);
  if (bends_to_structure(in.found, g, in.regressors.data()))
    return fmt::format("{} leaves a shape that no smooth curve follows: measure at targets between the present ones",
                       name);
  return in.found.objection;
}

double share_explained(const ReportInput& in, const LinearProblem& with) {
  const Whitener whitener(in.regressors.data(), in.base.core.noise, in.base.core.left_out);
  const std::vector<double> sigma = in.found.noise.sigma_by_row(in.regressors.data().size());
  const auto rms = [&](Eigen::VectorXd residual) {
    for (std::size_t k = 0; k < sigma.size(); ++k) residual(static_cast<Eigen::Index>(k)) /= sigma[k];
    return rms_without(residual, in.base.core.left_out);
  };
  return explainable_share(rms(in.base.residual), rms(residual_of(with, whitener)), 1.0);
}

namespace {

Doubt doubt_about(const RankedCandidate& ranked, const Found& found, bool noise) {
  const std::string again = "Measure the same lines again in both directions";
  if (ranked.alias == Alias::wander && is_like_wander(ranked.effect))
    return {"a zero that wanders without any law explains the same nearly as well", again};
  if (ranked.alias == Alias::single_targets)
    return {"errors of single targets without any order cannot be excluded",
            "Measure the same lines again on targets between the present ones"};
  if (ranked.alias == Alias::drift_in_runs)
    return {"a zero that drifts alike in every run explains it equally well",
            "Measure the same lines again with a pause of several minutes at the turning point"};
  if (ranked.alias == Alias::travel_since_reversal)
    return {"a lost motion that changes with the travel since the reversal explains it equally well",
            "Measure the same lines again with further reversals in the middle of the travel"};
  if (ranked.alias == Alias::wander)
    return {"no line was measured twice, and a slow drift of the readings explains it equally well", again};
  if (ranked.e_value && (noise || (*ranked.e_value < kProved && !found.bad_run)))
    return {fmt::format("held-out readings do not decide it (e-value {:.2g}; {:g} is proof)", *ranked.e_value, kProved),
            again};
  if (!noise)
    return {why_not_explained(found),
            found.bad_run ? again : "Measure the same lines again on targets between the present ones"};
  return {"neither half of the readings shows it on its own", again};
}

}  // namespace

Answer answer_of(const ReportInput& in) {
  const bool noise = noise_left(in.found, in.options);
  std::vector<Standing> standings = standings_of(in, noise);
  const bool of_points = deny_errors_of_points(in, standings);
  Answer answer;
  answer.verdict = verdict_of(in, standings, noise);
  answer.explained = noise && in.found.objection.empty();
  if (answer.verdict != Verdict::adequate)
    if (const auto scaled = scaled_line(in.regressors.data());
        scaled && !(noise && found_any(standings) && in.found.objection.empty() && !in.found.bad_run &&
                    explain_factor(in, standings, *scaled))) {
      answer.other_unit = words_for(*scaled, in.regressors.data());
      answer.verdict = Verdict::unexplained_structure;
      std::ranges::fill(standings, Standing::possible);
    }
  answer.order = ranked_candidates(in.found, standings);
  for (RankedCandidate& one : answer.order)
    if (one.standing == Standing::likely) one.doubt = doubt_about(one, in.found, noise);
  if (of_points && !found_any(standings)) {
    answer.verdict = Verdict::cannot_tell;
    answer.cannot_tell = fmt::format(
        "the residual differs from point to point, and errors of the points themselves would look like any "
        "cause on so few points: measure lines of at least {} targets along each axis",
        kFewestCurveTargets);
  }
  if (answer.verdict != Verdict::adequate) return answer;
  answer.cannot_tell = why_cannot_tell(in);
  if (!answer.cannot_tell.empty()) answer.verdict = Verdict::cannot_tell;
  return answer;
}

std::string_view name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::adequate:
      return "adequate";
    case Verdict::missing_effect:
      return "missing_effect";
    case Verdict::partly_explained:
      return "partly_explained";
    case Verdict::likely_effect:
      return "likely_effect";
    case Verdict::cannot_tell:
      return "cannot_tell";
    default:
      return "unexplained_structure";
  }
}

std::string_view title_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::adequate:
      return "the model explains the readings";
    case Verdict::missing_effect:
      return "an effect is missing";
    case Verdict::partly_explained:
      return "an effect is missing, and structure remains";
    case Verdict::likely_effect:
      return "an effect is probably missing (not proved)";
    case Verdict::cannot_tell:
      return "these data cannot show whether an effect is missing";
    default:
      return "the residual is more than noise";
  }
}

std::string_view name_of(Standing standing) {
  switch (standing) {
    case Standing::proved:
      return "proved";
    case Standing::likely:
      return "likely";
    default:
      return "possible";
  }
}

}  // namespace ecs::model
