// Forward selection (Efroymson 1960) on several branches at once (beam search: Lowerre 1976), then exchange of earlier
// choices (Miller 2002); scores are falls of χ² less Schwarz's price (1978).
#include "model/diagnosis/stepwise.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "base/moved_targets.hpp"
#include "model/diagnosis/investigation.hpp"
#include "model/diagnosis/waves.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/statistics.hpp"
#include "model/regression/needs.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;

/// Fits that differ by less than this fall of χ² (three standard deviations) cannot be told apart.
constexpr double kIndistinguishable = 9.0;
/// The same for a period together with the two sizes of a harmonic (three degrees of freedom).
constexpr double kIndistinguishableHarmonic = 14.2;
/// A rival that needs more parameters for the same fit stays one while its score is at most this much lower: about two
/// coefficients at Schwarz's price for 1000 readings.
constexpr double kRivalScoreMargin = 15.0;
/// Evidence that differs by less than this does not speak against the simpler effect (2 ln of odds of 4.5 to 1; Kass
/// and Raftery 1995: positive from 2 to 6).
constexpr double kEven = 3.0;
/// One smooth curve in ten has fewer functions that count than any curve is searched with: 2 ln of that, an assumption.
constexpr double kCurveOfFew = 4.6;
/// Fits that differ by less than this fall of χ² are the same fit: rounding and the end of a refinement.
constexpr double kSame = 0.05;
/// Breadth of the search: choices, each trading processor time against a set that is not met.
constexpr std::size_t kFirstBranches = 24;
constexpr std::size_t kFirstExact = 14;  ///< of the first step, refined before they are ranked
constexpr std::size_t kLaterBranches = 5;
constexpr std::size_t kBesideOwn = 8;    ///< of the first step, started without a term of the model
constexpr std::size_t kHiddenPairs = 6;  ///< that are refined together
constexpr std::size_t kBeam = 12;
/// From this number of effects on, which only readings along several axes have, fewer sets are followed: the effects of
/// one axis leave those of another as they are.
constexpr std::size_t kDeep = 3;
constexpr std::size_t kDeepBranches = 3, kDeepBeam = 2;
constexpr std::size_t kExchangeExact = 5, kRivalExact = 4;  ///< refined where one effect is replaced; for its rivals
constexpr double kWorthFollowing = 0.2;                     ///< of the best score
constexpr int kExchanges = 3;
/// Standard uncertainties of the ratio of both mean squares from which more than noise is left (one case of 40 by
/// chance).
constexpr double kMoreThanNoise = 2.0;
/// An exchange must raise the score by this: less is rounding, and would go round in circles.
constexpr double kLeastProgress = 0.01;
/// Share of a member's gain that another needs to be looked at exactly; less where its nonlinear parameter can still
/// move. A choice: looking at more takes time, at fewer may miss a rival that refining would raise.
constexpr double kNearGain = 0.8, kNearGainMovable = 0.5;
/// Fits of equal evidence may differ by three times what cannot be told apart, where the other is simpler.
constexpr double kSimplerMargin = 3.0 * kIndistinguishable;
/// A rotation explains this share of what two opposite slopes explain where one is half of the other.
constexpr double kMostOfBoth = 0.9;
/// Weaker explanations kept for the list of a group.
constexpr std::size_t kMostWeaker = 6;
/// Values of a searched parameter listed, at the utmost; a peak on the grid may be lower than itself refined by this
/// share of its gain (three values tried a turn over the travel: the second harmonic is a third of a turn off at the
/// ends, and 1 - sinc²(π/3) of it is lost); a value is a fact of the machine within a percent.
constexpr std::size_t kMostValues = 200;
constexpr double kCoarse = 0.32;
/// Free functions that shapes over one axis may have together: two, and this share of its targets. More follow any
/// values at all.
constexpr double kFreeFunctions = 2.0, kFunctionsATarget = 0.7;

std::vector<std::size_t> key_of(const std::vector<Choice>& chosen) {
  std::vector<std::size_t> key;
  for (const Choice& choice : chosen) key.push_back(choice.family);
  std::ranges::sort(key);
  return key;
}

std::vector<Choice> with(std::vector<Choice> chosen, const Choice& one) {
  chosen.push_back(one);
  return chosen;
}

std::vector<Choice> without_member(std::vector<Choice> chosen, std::size_t i) {
  chosen.erase(chosen.begin() + static_cast<std::ptrdiff_t>(i));
  return chosen;
}

/// Whether one effect may act twice in a sense: as several of its kind, each with its sensors or each for its axis.
bool may_act_twice(const EffectInstance& one, const EffectInstance& other) {
  return one.traits().several_alike || one.ball != other.ball || one.line != other.line ||
         one.from_run != other.from_run || !same_sensors(one, other) ||
         (one.traits().one_per_axis && one.axis != other.axis);
}

/// Whether two shapes of position bend the same readings alike: over the same axis, no levers that tell them apart.
bool bend_alike(const Family& one, const Family& other) {
  const bool levers = one.lever_varies || other.lever_varies;
  return one.effect.axis == other.effect.axis && (!levers || one.effect.code == other.effect.code);
}

/// Whether two effects follow the reversals of one axis: beside the one the other is what its shape leaves.
bool follow_one_reversal(const EffectInstance& one, const EffectInstance& other) {
  return one.id != other.id && one.axis == other.axis && follows_reversal(one.definition()) &&
         follows_reversal(other.definition());
}

/// The same effect with these of its columns only. @param space  what is left beside the other effects
Choice with_columns(const Search& search, const Space& space, Choice whole, const std::vector<Index>& columns) {
  const Family& family = search.families()[whole.family];
  whole.cost -= family.ln_readings * static_cast<double>(whole.columns.size() - columns.size());
  whole.parameters -= whole.columns.size() - columns.size();
  whole.columns = columns;
  Space with = space;
  absorb(with, search.white_columns_of(whole));
  whole.gain = space.chi2() - with.chi2();
  return whole;
}

/// The functions of a curve are about as large as one another: that all but the first are as small as the noise is a
/// coincidence, and has its price (empirical Bayes: George and Foster 2000). Without it a bow is as likely to be a
/// curve as to be the one effect that is nothing but a bow.
double price_of_shape(const Choice& choice, const Family& family) {
  if (!family.effect.traits().is_curve || choice.parameters < 2) return 0.0;
  const auto functions = static_cast<double>(choice.parameters);
  const double mean_square = choice.gain / (std::exp(family.ln_readings) * functions);  // in units of the noise
  return (functions - 1.0) * std::log(std::max(1.0, mean_square));
}

/// 2 ln of the odds of an alternative for one cause, up to a term that all have.
double ln_odds(const Choice& choice, const std::vector<Family>& families) {
  return choice.score() - (choice.parameters > 0 ? price_of_shape(choice, families[choice.family]) : 0.0);
}

/// A curve with as few of its leading functions as suffice, at the price of so few: what is to be explained may be
/// nothing but a bow. Every other effect, and a curve that needs all of them, as it is.
/// @param space  what is left beside the other effects
Choice with_functions_needed(const Search& search, const Space& space, const Choice& whole) {
  if (!search.families()[whole.family].effect.traits().is_curve) return whole;
  Choice best = whole;
  double odds = ln_odds(whole, search.families());
  std::vector<Index> columns = whole.columns;
  while (columns.size() > 1) {
    columns.pop_back();
    Choice few = with_columns(search, space, whole, columns);
    few.cost += kCurveOfFew;
    if (const double of_few = ln_odds(few, search.families()); of_few > odds) {
      best = few;
      odds = of_few;
    }
  }
  return best;
}

/// Whether even targets show the most of a wave as fewer than two turns over the travel: that is a bow, and any bow of
/// these targets is such a wave of a pitch that is hardly changed (docs/physics.md, 5).
/// @param space  what is left beside the other effects
bool is_seen_as_bow(const Search& search, const Space& space, const Choice& choice) {
  constexpr double kFewestTurns = 2.0, kShownTurns = 0.5, kMostOfGain = 0.5;
  const Family& family = search.families()[choice.family];
  if (!family.effect.traits().periodic || family.effect.rotary || choice.nonlinear >= 2.0 * family.shortest_seen)
    return false;
  const auto step_mm = even_step_mm(acting_positions(search.motions(), family.acting, *family.effect.axis));
  if (!step_mm) return false;
  const auto is_slow = [&](double harmonic) {
    const double turns = harmonic * *step_mm / choice.nonlinear;
    return turns > kShownTurns && std::abs(turns - std::round(turns)) * family.travel / *step_mm < kFewestTurns;
  };
  if (is_slow(1.0)) return true;
  const std::vector<Index> fundamental{0, 1};
  return choice.columns.size() > fundamental.size() && is_slow(2.0) &&
         with_columns(search, space, choice, fundamental).gain < kMostOfGain * choice.gain;
}

/// Whether effects may be missing together: one cause occurs once in one place; three free shapes that bend alike
/// explain anything (what the directions share and what they do not are apart), and so do four drifts of the same
/// sense, or as many parameters as readings; a size outside its physical range is another cause.
bool plausible(const Search& search, const std::vector<Choice>& chosen) {
  constexpr std::size_t kMostShapes = 2, kMostDrifts = 3;
  constexpr std::size_t kSmooth = 11;  // functions of a curve that leaves faster shapes to others
  const Solution& alone = search.alone();
  auto spare = static_cast<double>(search.data().size()) - static_cast<double>(alone.space.q.cols()) -
               static_cast<double>(alone.own.size());
  for (const Choice& one : chosen) spare -= static_cast<double>(one.parameters);
  // one effect may take nearly all that is left; several need what any search needs
  if (!chosen.empty() && spare < (chosen.size() > 1 ? kFewestSpare : 1.0)) return false;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const EffectInstance& one = search.families()[chosen[i].family].effect;
    std::size_t shapes = 0, functions = 0, most = 0, drifts = 0;
    for (std::size_t j = 0; j < chosen.size(); ++j) {
      const EffectInstance& other = search.families()[chosen[j].family].effect;
      if (one.traits().is_drift && other.traits().is_drift && one.sense == other.sense) ++drifts;
      if (one.traits().shape_of_position && other.traits().shape_of_position &&
          one.traits().of_approach == other.traits().of_approach &&
          bend_alike(search.families()[chosen[i].family], search.families()[chosen[j].family])) {
        ++shapes;
        functions += chosen[j].parameters;
        if (other.traits().is_curve) most = std::max(most, chosen[j].columns.size());
      }
      if (j < i && follow_one_reversal(one, other)) return false;
      if (j >= i || one.id != other.id) continue;
      const bool twice = one.sense == other.sense && one.code == other.code;
      if (twice && !may_act_twice(one, other)) return false;
    }
    if (drifts > kMostDrifts || shapes > kMostShapes || (shapes > 1 && most > kSmooth)) return false;
    const auto targets = one.axis ? static_cast<double>(search.targets(*one.axis)) : 0.0;
    if (shapes > 1 && static_cast<double>(functions) > kFreeFunctions + kFunctionsATarget * targets) return false;
  }
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const Space space = search.solution(without_member(chosen, i)).space;
    if (!search.beats_free_values(space, chosen[i]) || is_seen_as_bow(search, space, chosen[i])) return false;
  }
  return search.in_ranges(chosen);
}

/// Whether a shape replaces another because it is the same, not because it bends to anything: at most one free
/// parameter more, free curves among themselves apart.
bool is_alike(const Search& search, const Choice& member, const Choice& other) {
  const EffectTraits& a = search.families()[member.family].effect.traits();
  const EffectTraits& b = search.families()[other.family].effect.traits();
  constexpr std::size_t kOfShape = 3;  // place or period, size, form, however little of them these targets show
  if (a.is_smooth && b.is_smooth) return true;
  const bool bends = b.shape_of_position && !b.is_curve;
  const std::size_t parameters = bends ? std::max(other.parameters, kOfShape) : other.parameters;
  return parameters <= member.parameters + 1;
}

/// Place of a value among the facts of the machine, the most trusted first; their number where it is none. Of a turn
/// any whole number of waves is as usual as another.
std::size_t place_in_facts(const Family& family, double value) {
  const auto found = std::ranges::find_if(family.facts, [&](double fact) { return is_in_step(family, fact, value); });
  return found != family.facts.end() && family.effect.rotary ? 0
                                                             : static_cast<std::size_t>(found - family.facts.begin());
}

/// Whether a value of a wave fits as well as the member: with fewer harmonics it may fit a little worse, with more it
/// is another wave's harmonic unless they are worth their price.
bool fits_as_well(const Choice& choice, const Choice& member) {
  const bool simpler = choice.parameters < member.parameters;
  if (choice.parameters > member.parameters && choice.score() < member.score()) return false;
  return choice.gain >= member.gain - (simpler ? kIndistinguishableHarmonic : kIndistinguishable);
}

/// Values of a searched parameter that fit within Δχ² 9 of the best (a profile likelihood), those of the machine first,
/// of these the most trusted where the fit does not speak against it.
std::vector<Choice> values_that_fit(const Search& search, const Space& space, const Choice& member) {
  const Family& family = search.families()[member.family];
  const EffectDefinition& definition = family.effect.definition();
  const bool periodic = definition.traits.periodic;
  if (!periodic && definition.search.has_slope) return {};
  std::vector<Choice> values{member};
  std::vector<Choice> peaks = search.peaks_of(space, member.family);
  const double coarse = periodic ? kIndistinguishableHarmonic + kCoarse * member.gain : kIndistinguishable;
  std::erase_if(peaks, [&](const Choice& peak) { return peak.gain < member.gain - coarse; });
  if (periodic && !family.grid.empty())
    if (const double seen = frequency_seen(search.data(), family, member.nonlinear);
        seen * std::ranges::max(family.grid) > 1.0) {  // what even targets show, though the grid may pass by it
      peaks.push_back(member);
      peaks.back().nonlinear = 1.0 / seen;
    }
  for (const Choice& peak : peaks) {
    if (values.size() >= kMostValues) break;
    const Choice choice = search.refined_choice(space, member.family, peak.nonlinear);
    if (!fits_as_well(choice, member)) continue;
    const bool known = periodic && std::ranges::any_of(values, [&](const Choice& value) {
                         const ValueRange peak_range =
                             definition.search.limits(search.motions(), family.effect, family.acting, value.nonlinear);
                         return choice.nonlinear >= peak_range.least && choice.nonlinear <= peak_range.greatest;
                       });
    if (!known) values.push_back(choice);
  }
  if (!definition.search.has_slope) {
    const auto [least, greatest] =
        std::ranges::minmax_element(values, [](const Choice& a, const Choice& b) { return a.nonlinear < b.nonlinear; });
    const std::vector<double> targets = acting_positions(search.motions(), family.acting, *family.effect.axis);
    const auto after = std::ranges::upper_bound(targets, greatest->nonlinear);
    const auto before = std::ranges::lower_bound(targets, least->nonlinear);
    Choice low = *least, high = *greatest;
    if (before != targets.begin()) low.nonlinear = *(before - 1);
    if (after != targets.end()) high.nonlinear = *after;
    return {low, high};
  }
  std::ranges::stable_sort(values, {}, [&](const Choice& value) {
    const std::size_t place = place_in_facts(family, value.nonlinear), facts = family.facts.size();
    return place == facts ? facts + 1 : value.gain < member.gain - kEven ? facts : place;
  });
  return values;
}

/// The score from which so many effects together are better than none.
double enough(const StepwiseOptions& options, std::size_t effects) {
  return 0.5 * options.entry_score * static_cast<double>(effects);
}

/// What a solution is worth beside others; of a noise that is known little the readings say the size too.
double worth(const Search& search, const Solution& solution, const StepwiseOptions& options) {
  const double before = solution.chi2_before, left = solution.space.chi2(), known = options.noise_freedom;
  const double explained =
      options.freedom > 0.0
          ? (known + options.freedom) * std::log((known + before) / std::max(known + left, kLeastDivisor))
          : before - left;
  double worth = explained - solution.cost - enough(options, solution.chosen.size());
  for (const Choice& choice : solution.chosen) worth -= price_of_shape(choice, search.families()[choice.family]);
  return worth;
}

/// The other members, refined. A curve that is left alone may bend more than beside the one that is gone.
Solution refined_without(const Search& search, const Solution& solution, std::size_t i) {
  Solution rest = search.refined(without_member(solution.chosen, i), solution.own);
  if (rest.chosen.size() != 1 || !search.families()[rest.chosen.front().family].effect.traits().is_curve) return rest;
  const Space space = search.solution({}, rest.own).space;
  Solution alone = search.solution({search.refined_choice(space, rest.chosen.front().family, 0.0)}, rest.own);
  return alone.score() > rest.score() ? alone : rest;
}

/// Tries to put another effect in the place of each, and to do without it.
Solution exchanged(const Search& search, Solution best, const StepwiseOptions& options) {
  for (int round = 0; round < kExchanges; ++round) {
    bool changed = false;
    for (std::size_t i = 0; i < best.chosen.size() && best.chosen.size() > 1; ++i) {
      const Solution rest = refined_without(search, best, i);
      if (best.score() - rest.score() < options.entry_score &&  // beside the others it would not have been added
          plausible(search, rest.chosen)) {
        best = rest;
        changed = true;
        break;
      }
      for (const Choice& other : search.expand(rest.space, kExchangeExact)) {
        if (other.score() < best.chosen[i].score() - 2.0 * kIndistinguishable) break;
        if (other.family == best.chosen[i].family) continue;
        Solution tried = search.refined(with(rest.chosen, other), rest.own);
        if (!plausible(search, tried.chosen)) continue;
        if (worth(search, tried, options) > worth(search, best, options) + kLeastProgress) {
          best = std::move(tried);
          changed = true;
          break;
        }
      }
      if (changed) break;
    }
    if (!changed) break;
  }
  return best;
}

bool leaves_more_than_noise(const Search& search, const Solution& solution, const StepwiseOptions& options) {
  const double freedom = static_cast<double>(search.data().size()) - static_cast<double>(solution.space.q.cols());
  if (freedom <= 0.0 || options.noise_freedom <= 0.0) return false;
  return solution.space.chi2() / freedom >
         1.0 + kMoreThanNoise * std::sqrt(2.0 / freedom + 2.0 / options.noise_freedom);
}

/// Whether two effects are each of one line only, and of different lines: no pair stands for both of them that two
/// steps, one a line, do not find.
bool are_of_different_lines(const EffectInstance& one, const EffectInstance& other) {
  return one.axis && one.sense && other.axis && other.sense && (one.axis != other.axis || one.sense != other.sense);
}

/// Steps that replace one effect may pass by two. Where more than noise is left, pairs are tried beside all effects
/// found but one, and beside all but two of the same line.
Solution exchanged_in_pairs(const Search& search, Solution best, const StepwiseOptions& options) {
  if (best.chosen.size() < 2 || !leaves_more_than_noise(search, best, options)) return best;
  const auto effect_of = [&](const Choice& one) -> const EffectInstance& {
    return search.families()[one.family].effect;
  };
  std::vector<std::vector<Choice>> kept;
  for (std::size_t i = 0; i < best.chosen.size(); ++i) {
    const std::vector<Choice> but_one = without_member(best.chosen, i);
    if (but_one.size() + 2 <= options.most_effects) kept.push_back(but_one);
    for (std::size_t j = 0; j < i && but_one.size() > 1; ++j)
      if (!are_of_different_lines(effect_of(best.chosen[i]), effect_of(best.chosen[j])))
        kept.push_back(without_member(but_one, j));
  }
  const std::vector<Choice> own = best.own;
  for (const std::vector<Choice>& others : kept)
    for (const auto& [one, other] : search.pairs_of(search.refined(others, own).space, kHiddenPairs, 0.0)) {
      Solution tried = search.refined(with(with(others, one), other), own);
      if (plausible(search, tried.chosen) &&
          worth(search, tried, options) > worth(search, best, options) + kLeastProgress)
        best = std::move(tried);
    }
  return best;
}

/// Whether one effect may be what two others are together: they act in one approach each, or in one sense each.
bool may_stand_for_both(const EffectInstance& both, const EffectInstance& one, const EffectInstance& other) {
  if (same_place(one, other))
    return one.approach != other.approach && same_place(both, one) && both.approach == ApproachMode::both;
  return both.definition().place == Place::set_up && one.sense != other.sense;
}

/// Whether a curve that keeps its slope may be what a curve without it and a slope are together: the same shape.
bool may_be_curve_and_slope(const EffectInstance& whole, const EffectInstance& curve) {
  return whole.traits().is_curve && whole.traits().keeps_slope && whole.axis == curve.axis && curve.traits().is_curve &&
         !curve.traits().keeps_slope;
}

/// One effect in the place of two of which each is a part of it, where that is as good. Slopes of both senses that are
/// nearly equal and opposite are a rotation of the set-up, which hardly anybody avoids, and beside it the small rest of
/// one of them: the same readings, and no coincidence.
Solution merged(const Search& search, Solution best, const StepwiseOptions& options) {
  const auto instance = [&](const Choice& choice) -> const EffectInstance& {
    return search.families()[choice.family].effect;
  };
  for (std::size_t i = 0; i < best.chosen.size(); ++i)
    for (std::size_t j = i + 1; j < best.chosen.size(); ++j) {
      const Solution rest = search.solution(without_member(without_member(best.chosen, j), i), best.own);
      for (std::size_t f = 0; f < search.candidates(); ++f) {
        const EffectInstance& both = search.families()[f].effect;
        const EffectInstance &one = instance(best.chosen[i]), &other = instance(best.chosen[j]);
        const bool is_shape = may_be_curve_and_slope(both, one) || may_be_curve_and_slope(both, other);
        if (!is_shape && !may_stand_for_both(both, one, other)) continue;
        const Choice choice = search.refined_choice(rest.space, f, best.chosen[i].nonlinear);
        Solution tried = search.refined(with(rest.chosen, choice), rest.own);
        if (is_shape && choice.gain > 0.0 && tried.score() >= best.score() - kIndistinguishable)
          return merged(search, std::move(tried), options);
        if (choice.gain > 0.0 && worth(search, tried, options) >= worth(search, best, options))
          return merged(search, std::move(tried), options);
        if (both.definition().place != Place::set_up || one.definition().place == Place::set_up ||
            choice.gain < kMostOfBoth * (rest.space.chi2() - best.space.chi2()))
          continue;
        const std::size_t kept = best.chosen[i].gain < best.chosen[j].gain ? i : j;  // what it is beside the rotation
        tried = search.refined(with(with(rest.chosen, choice), best.chosen[kept]), rest.own);
        if (worth(search, tried, options) >= worth(search, best, options) - kIndistinguishable) return tried;
      }
    }
  return best;
}

/// The reverse: a curve that keeps its slope may stand for a curve without it and another effect that is nearly a
/// slope. The pair takes its place where that is clearly better; step by step the search passes it by, for either of
/// the two is far behind the whole at first.
Solution parted(const Search& search, Solution best, const StepwiseOptions& options) {
  for (std::size_t i = 0; i < best.chosen.size(); ++i) {
    const EffectInstance& whole = search.families()[best.chosen[i].family].effect;
    const Solution rest = search.solution(without_member(best.chosen, i), best.own);
    for (std::size_t f = 0; f < search.candidates(); ++f) {
      if (!may_be_curve_and_slope(whole, search.families()[f].effect)) continue;
      const Choice curve = search.refined_choice(rest.space, f, 0.0);
      if (curve.gain <= 0.0) continue;
      const Solution with_curve = search.solution(with(rest.chosen, curve), rest.own);
      if (with_curve.chosen.size() >= options.most_effects) continue;
      for (const Choice& other : search.expand(with_curve.space, kExchangeExact)) {
        Solution tried = search.refined(with(with_curve.chosen, other), rest.own);
        if (tried.score() > best.score() + kIndistinguishable && plausible(search, tried.chosen))
          return parted(search, std::move(tried), options);
      }
    }
  }
  return best;
}

/// A wave whose second harmonic was found beside fewer effects may be that harmonic alone: by the information
/// criterion, for the price of a period that uneven targets alone show is the same for both.
std::optional<Choice> second_harmonic_alone(const Search& search, const Space& space, const Choice& wave) {
  const std::vector<Index> fundamental{0, 1};
  if (wave.columns.size() <= fundamental.size()) return std::nullopt;
  const Choice half = search.refined_choice(space, wave.family, 0.5 * wave.nonlinear);
  if (half.columns.empty()) return std::nullopt;
  const Choice alone = with_columns(search, space, half, fundamental);
  const double price =
      search.families()[wave.family].ln_readings * static_cast<double>(wave.parameters - alone.parameters);
  if (alone.gain < wave.gain - price) return std::nullopt;
  return alone;
}

/// Sets of its columns that are a part of those it uses.
std::vector<std::vector<Index>> parts_of_columns(const Search& search, const Choice& whole) {
  std::vector<std::vector<Index>> parts;
  for (const auto& set : search.families()[whole.family].effect.definition().column_sets) {
    const bool is_part = std::ranges::all_of(
        set, [&](Index column) { return std::ranges::find(whole.columns, column) != whole.columns.end(); });
    if (is_part && set.size() < whole.columns.size()) parts.push_back(set);
  }
  return parts;
}

/// The effects along directions of a solution and its others.
struct SplitSolution {
  std::vector<Choice> others, along;
};
SplitSolution split_by_directions(const Search& search, const std::vector<Choice>& chosen) {
  SplitSolution split;
  for (const Choice& choice : chosen)
    (has_directions(search.families()[choice.family].effect) ? split.along : split.others).push_back(choice);
  return split;
}

/// The best set of effects along directions, and of their directions, in place of those that steps have found.
Solution with_best_directions(const Search& search, Solution best, const StepwiseOptions& options) {
  const auto [others, along] = split_by_directions(search, best.chosen);
  if (along.empty()) return best;
  const Solution rest = search.solution(others, best.own);
  for (const DirectionSet& set : direction_sets(search, rest.space, options.most_effects - others.size())) {
    std::vector<Choice> chosen = others;
    chosen.insert(chosen.end(), set.chosen.begin(), set.chosen.end());
    Solution tried = search.solution(chosen, best.own);
    if (worth(search, tried, options) > worth(search, best, options) + kLeastProgress &&
        plausible(search, tried.chosen))
      best = std::move(tried);
  }
  return best;
}

/// Sets of effects one larger than a state: the best solution of every set.
class NextSets {
 public:
  NextSets(const Search& search, const StepwiseOptions& options, std::size_t depth)
      : search_(search), options_(options), depth_(depth) {}

  /// Tries the best of a list beside a state.
  void follow(const Solution& state, const std::vector<Choice>& list, std::size_t branches, bool again) {
    for (std::size_t i = 0; i < std::min(branches, list.size()); ++i) {
      if (list[i].score() < options_.entry_score || list[i].score() < kWorthFollowing * list.front().score()) break;
      if (list[i].gain < (depth_ < 2 ? options_.entry_gain : options_.late_gain * share_along_axis(list[i]))) continue;
      try_set(with(state.chosen, list[i]), state.own, again);
    }
  }

  /// @param again  also if it was tried
  void try_set(const std::vector<Choice>& chosen, const std::vector<Choice>& own, bool again) {
    const auto [at, is_new] = best_.try_emplace(key_of(chosen));
    if (!is_new && !again) return;
    Solution tried = search_.refined(chosen, own);
    if (!plausible(search_, tried.chosen)) return;
    if (!at->second || tried.score() > at->second->score()) at->second = std::move(tried);
  }

  [[nodiscard]] std::vector<Solution> best_first() && {
    std::vector<Solution> list;
    for (auto& [key, solution] : best_)
      if (solution) list.push_back(std::move(*solution));
    sort_greatest_first(list, [](const Solution& solution) { return solution.score(); });
    const std::size_t most = depth_ < kDeep ? kBeam : kDeepBeam;
    if (list.size() > most) list.resize(most);
    return list;
  }

 private:
  /// Of all readings, those along the axis of an effect: what is little of a whole set may be much of one line. Of
  /// paths and of a ball every reading shows errors of several axes.
  [[nodiscard]] double share_along_axis(const Choice& choice) const {
    const std::optional<Axis> axis = search_.families()[choice.family].effect.axis;
    const Observations& data = search_.data();
    if (!axis || !data.paths.empty() || !data.through_chain.empty()) return 1.0;
    return static_cast<double>(std::ranges::count(data.axis, *axis)) / static_cast<double>(data.size());
  }

  const Search& search_;
  const StepwiseOptions& options_;
  std::size_t depth_;
  std::map<std::vector<std::size_t>, std::optional<Solution>> best_;
};

/// Zeros and slopes of lines of their own take the place of effects that need no fewer parameters to explain the same:
/// with as many as there are lines any zeros can be written as angles and slopes of the axes on which the lines differ.
Solution with_zeros_of_lines(const Search& search, Solution best) {
  const auto is_zero = [&](std::size_t f) {
    const EffectInstance& effect = search.families()[f].effect;
    return effect.traits().of_lines && effect.line > 1 && effect.from_run == 0;
  };
  const auto parameters = [](const std::vector<Choice>& chosen) {
    std::size_t sum = 0;
    for (const Choice& one : chosen) sum += one.parameters;
    return sum;
  };
  if (best.chosen.size() < 2) return best;
  std::vector<Choice> chosen;
  for (std::size_t f = 0; f < search.candidates(); ++f)
    if (is_zero(f)) chosen.push_back(search.choice_at(search.alone().space, f, 0.0));
  if (chosen.size() < 2) return best;  // one zero is a rival like any other
  for (const Choice& one : best.chosen)
    if (!is_zero(one.family)) chosen.push_back(one);
  const double limit = best.space.chi2() + kIndistinguishable;
  if (search.solution(chosen, best.own).space.chi2() > limit) return best;
  for (std::size_t i = chosen.size(); i-- > 0;) {  // the effects first, then zeros that are none
    std::vector<Choice> fewer = without_member(chosen, i);
    if (search.solution(fewer, best.own).space.chi2() <= limit) chosen = std::move(fewer);
  }
  const auto count = [&](const std::vector<Choice>& of) {
    return std::ranges::count_if(of, [&](const Choice& one) { return is_zero(one.family); });
  };
  const auto others = [&](const std::vector<Choice>& of) { return static_cast<std::ptrdiff_t>(of.size()) - count(of); };
  std::set<int> lines;
  for (const Choice& one : chosen)
    if (is_zero(one.family)) lines.insert(search.families()[one.family].effect.line);
  const std::ptrdiff_t replaced = others(best.chosen) - others(chosen);
  // zero and slope of a single line are two causes where an angle is one
  if (count(chosen) < 2 || replaced < (lines.size() > 1 ? 1 : count(chosen))) return best;
  Solution zeros = search.refined(chosen, best.own);
  return parameters(chosen) <= parameters(best.chosen) || zeros.score() > best.score() ? zeros : best;
}

}  // namespace

Solution best_solution(const Search& search, const StepwiseOptions& options) {
  Solution best = search.alone();
  std::vector<Solution> beam{best};
  for (std::size_t depth = 0; depth < options.most_effects && (depth < 2 || !beam.empty()); ++depth) {
    NextSets next(search, options, depth);
    for (const Solution& state : beam)
      next.follow(state, search.expand(state.space, depth == 0 ? kFirstExact : kLaterBranches + 1),
                  depth == 0      ? kFirstBranches
                  : depth < kDeep ? kLaterBranches
                                  : kDeepBranches,
                  false);
    // what is hidden may live in the freedom of a term of the model: begin without that term too
    for (std::size_t i = 0; depth == 0 && i < best.own.size(); ++i) {
      const Solution& alone = beam.front();
      const Space without = search.solution({}, without_member(alone.own, i)).space;
      next.follow(alone, search.expand(without, kBesideOwn), kBesideOwn, true);
    }
    if (depth == 1)
      for (const auto& [one, other] : search.pairs_of(search.alone().space, kHiddenPairs, kAlikeOfPair))
        if (one.score() + other.score() >= options.entry_score && one.gain + other.gain >= 2.0 * options.entry_gain)
          next.try_set({one, other}, search.alone().own, false);
    beam = std::move(next).best_first();
    for (const Solution& solution : beam) {
      const double more = best.chosen.empty() ? solution.score() - enough(options, solution.chosen.size())
                                              : worth(search, solution, options) - worth(search, best, options);
      if (more > kLeastProgress) best = solution;
    }
  }
  best = exchanged_in_pairs(search, exchanged(search, std::move(best), options), options);
  best = parted(search, merged(search, std::move(best), options), options);
  return with_best_directions(search, with_zeros_of_lines(search, std::move(best)), options);
}

namespace {

/// Effects that may be what a member along several directions is along some of them, each once: beside the most of the
/// member with which it explains as much, with no more parameters. None that is a rival of the whole.
std::vector<Group::InPart> rivals_of_parts(const Search& search, const Solution& solution, const Group& group,
                                           const Space& rest) {
  std::vector<Group::InPart> found;
  const Choice& whole = group.member;
  if (!has_directions(search.families()[whole.family].effect)) return found;
  std::vector<std::vector<Index>> parts = parts_of_columns(search, whole);
  std::ranges::stable_sort(parts, std::greater{}, &std::vector<Index>::size);
  for (const std::vector<Index>& columns : parts) {
    Group::InPart one;
    one.kept = with_columns(search, rest, whole, columns);
    std::vector<Index> others = whole.columns;
    std::erase_if(others, [&](Index column) { return std::ranges::find(columns, column) != columns.end(); });
    one.part = with_columns(search, rest, whole, others);
    Space beside = rest;
    absorb(beside, search.white_columns_of(one.kept));
    const double of_part = whole.gain - one.kept.gain;
    if (of_part < 2.0 * kIndistinguishable) continue;  // nothing to speak of
    for (std::size_t f = 0; f < search.candidates(); ++f) {
      const auto is_it = [&](const Choice& choice) { return choice.family == f; };
      if (!has_directions(search.families()[f].effect) || std::ranges::any_of(solution.chosen, is_it) ||
          std::ranges::any_of(group.rivals, is_it) ||
          std::ranges::any_of(found, [&](const Group::InPart& before) { return is_it(before.other); }))
        continue;
      one.other = search.choice_at(beside, f, 0.0);
      if (one.other.parameters <= others.size() && one.other.gain >= of_part - kIndistinguishable) found.push_back(one);
    }
  }
  return found;
}

/// An effect that may take the place of a member along directions where the other members may take other directions.
struct RivalOfSet {
  std::size_t member = 0;  ///< its family
  Choice rival;            ///< its gain and cost are those of the member with what the set gains and costs more
};

/// Beside the directions that the other members have taken, only one effect may explain the rest. With other directions
/// of theirs another one may: sets of as many effects are compared as a whole, by the margins of single rivals.
std::vector<RivalOfSet> rivals_along_directions(const Search& search, const Solution& solution) {
  std::vector<RivalOfSet> found;
  const SplitSolution split = split_by_directions(search, solution.chosen);
  const std::vector<Choice>& along = split.along;
  if (along.size() < 2) return found;
  const Solution rest = search.solution(split.others, solution.own);
  double cost = 0.0;
  for (const Choice& choice : along) cost += choice.cost;
  const double gain = rest.space.chi2() - solution.space.chi2();
  const auto is_in = [](const std::vector<Choice>& list, const Choice& choice) {
    return std::ranges::find(list, choice.family, &Choice::family) != list.end();
  };
  for (const DirectionSet& set : direction_sets(search, rest.space, along.size())) {
    if (set.chosen.size() < along.size() || set.gain < gain - kIndistinguishable ||
        set.score() < gain - cost - kRivalScoreMargin)
      continue;
    std::vector<Choice> left_out = along, new_ones = set.chosen;
    std::erase_if(left_out, [&](const Choice& choice) { return is_in(set.chosen, choice); });
    std::erase_if(new_ones, [&](const Choice& choice) { return is_in(along, choice); });
    if (left_out.size() != 1) continue;
    new_ones.front().gain = left_out.front().gain + set.gain - gain;
    new_ones.front().cost = left_out.front().cost + set.cost - cost;
    found.push_back({left_out.front().family, new_ones.front()});
  }
  return found;
}

}  // namespace

std::vector<Group> groups_of(const Search& search, const Solution& solution, double entry_score) {
  std::vector<Group> groups;
  const std::vector<RivalOfSet> of_sets = rivals_along_directions(search, solution);
  for (std::size_t i = 0; i < solution.chosen.size(); ++i) {
    const Solution rest = search.solution(without_member(solution.chosen, i), solution.own);
    Group group;
    group.member = search.choice_at(rest.space, solution.chosen[i].family, solution.chosen[i].nonlinear);
    group.member.columns = solution.chosen[i].columns;
    std::vector<Choice> all = search.expand(rest.space, kRivalExact);
    const auto instance = [&](const Choice& choice) -> const EffectInstance& {
      return search.families()[choice.family].effect;
    };
    for (Choice& other : all) {
      const auto is_other = [&](const Choice& choice) { return choice.family == other.family; };
      if (std::ranges::any_of(solution.chosen, is_other) ||
          std::ranges::any_of(groups, [&](const Group& before) { return is_other(before.member); }))
        continue;
      if (same_candidate(instance(other), instance(group.member))) continue;  // the lag decides between them
      const bool movable = is_searched(instance(other));
      if (other.gain < (movable ? kNearGainMovable : kNearGain) * group.member.gain - kIndistinguishable) {
        if (other.score() >= entry_score && group.weaker.size() < kMostWeaker) group.weaker.push_back(other);
        continue;
      }
      const Choice exactly = search.refined_choice(rest.space, other.family, other.nonlinear);
      if (exactly.score() > other.score()) other = exactly;
      if (!solution.own.empty())  // the model's own terms may take another place beside the rival
        other.gain = std::max(other.gain, group.member.gain + solution.space.chi2() -
                                              search.refined(with(rest.chosen, other), rest.own).space.chi2());
      // a lag that nothing but this rival asks for is no reason to doubt an effect that needs none
      const auto is_late = [&](const Choice& one) {
        return instance(one).traits().has_lag && is_searched(instance(one));
      };
      const bool asks_for_lag = is_late(other) && !is_late(group.member) && other.score() < group.member.score();
      const double hidden = search.hidden_by_sensor(rest.space, other);
      const bool same_fit = is_alike(search, group.member, other) &&
                            other.gain >= group.member.gain - kIndistinguishable - hidden &&
                            other.score() >= group.member.score() - kRivalScoreMargin - hidden;
      const bool same_evidence = other.parameters <= group.member.parameters &&
                                 other.gain >= group.member.gain - kSimplerMargin - hidden &&
                                 other.score() >= group.member.score() - kIndistinguishable - hidden;
      if (!asks_for_lag && (same_fit || same_evidence))
        group.rivals.push_back(other);
      else if (other.score() >= entry_score && group.weaker.size() < kMostWeaker)
        group.weaker.push_back(other);
    }
    // of equals the one with fewer parameters, then of equally likely ones the first in the library, but the zero of a
    // session where it is more probable; a rotation that stands for slopes of both senses stays, and so does its rest
    for (Choice& rival : group.rivals) {
      const bool is_part = std::ranges::any_of(rest.chosen, [&](const Choice& other) {
        return may_stand_for_both(instance(group.member), instance(rival), instance(other)) ||
               may_stand_for_both(instance(other), instance(group.member), instance(rival));
      });
      if (is_part) continue;
      const bool zero = instance(rival).from_run > 0 &&
                        ln_odds(rival, search.families()) > ln_odds(group.member, search.families()) + kSame;
      const bool same_evidence =
          rival.parameters < group.member.parameters && rival.score() >= group.member.score() - kEven;
      if (!zero && std::abs(rival.gain - group.member.gain) > kSame && !same_evidence) continue;
      const bool simpler = rival.parameters < group.member.parameters ||
                           (rival.parameters == group.member.parameters && rival.family < group.member.family &&
                            rival.score() >= group.member.score() - kSame);
      if (simpler || zero) std::swap(rival, group.member);
    }
    std::erase_if(group.rivals, [&](const Choice& rival) { return !is_alike(search, group.member, rival); });
    for (const RivalOfSet& one : of_sets) {
      const bool is_known = std::ranges::find(group.rivals, one.rival.family, &Choice::family) != group.rivals.end();
      if (one.member != group.member.family || is_known) continue;
      group.rivals.push_back(one.rival);
      std::erase_if(group.weaker, [&](const Choice& choice) { return choice.family == one.rival.family; });
    }
    group.in_part = rivals_of_parts(search, solution, group, rest.space);
    if (instance(group.member).traits().periodic)
      if (const auto half = second_harmonic_alone(search, rest.space, group.member)) group.member = *half;
    group.values = values_that_fit(search, rest.space, group.member);
    if (instance(group.member).traits().periodic && !group.values.empty() &&
        group.values.front().nonlinear != group.member.nonlinear) {  // one of the machine's pitches that fits as well
      const Choice pitch = search.refined_choice(rest.space, group.member.family, group.values.front().nonlinear);
      if (is_fact(search.families()[group.member.family], pitch.nonlinear) &&
          !second_harmonic_alone(search, rest.space, pitch))
        group.member = pitch;
    }
    group.hidden_by_sensor = search.hidden_by_sensor(rest.space, group.member);
    for (std::vector<Choice>* others : {&group.rivals, &group.weaker})
      for (Choice& other : *others) other = with_functions_needed(search, rest.space, other);
    groups.push_back(std::move(group));
  }
  return groups;
}

std::vector<double> probabilities_of(const std::vector<Choice>& alternatives, const std::vector<Family>& families) {
  std::vector<double> shares;
  for (const Choice& choice : alternatives) shares.push_back(ln_odds(choice, families));
  const double best = *std::ranges::max_element(shares);
  double sum = 0.0;
  for (double& share : shares) sum += share = std::exp(0.5 * (share - best));
  for (double& share : shares) share /= sum;
  return shares;
}

}  // namespace ecs::model
