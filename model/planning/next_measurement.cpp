// Discrimination between rival models: the run that is expected to separate them best, whichever is true (Hunter and
// Reiner 1965; T-optimality: Atkinson and Fedorov 1975), per minute of work. Does not live here: the separation itself
// (separation.cpp), the sentences (questions.cpp).
#include "model/planning/next_measurement.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "model/data/motions.hpp"
#include "model/diagnosis/investigation.hpp"
#include "model/diagnosis/ladder.hpp"
#include "model/diagnosis/left.hpp"
#include "model/diagnosis/waves.hpp"
#include "model/diagnosis/words.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/statistics.hpp"
#include "model/planning/questions.hpp"
#include "model/planning/run.hpp"
#include "model/regression/needs.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Least separation [sigma] worth a proposal: below one a run is more likely to mislead than to tell.
constexpr double kTelling = 1.0;
/// Separation that the next diagnosis takes for certain in spite of chance: three sigmas of difference, three of luck.
constexpr double kDecides = 6.0;
/// Lines whose runs are weighed, and proposals listed: choices of processor time and of what a person reads.
constexpr std::size_t kMostLines = 6;
constexpr std::size_t kMostProposals = 8;
/// To confirm a lone cause any run does, and where none separates all are alike: the best few.
constexpr std::size_t kFewProposals = 3;
/// Causes that could be there unseen, the most hidden first: a choice of what a person reads.
constexpr std::size_t kMostUnseen = 12;
/// Numbers of runs weighed; ISO 230-2:2014, 5.3 has five.
constexpr std::array kRuns{1, 2, 3, 5};
constexpr int kMostRuns = kRuns.back();
/// Readings beyond which the power of a set is judged on an even choice of them: as many as a search takes.
constexpr std::size_t kManyReadings = 4000;

struct Worth {
  double sure_sigma = 0.0;  ///< the group loses a member by, whichever is true; to see: of the causes seen
  double mean_sigma = 0.0;  ///< mean over what is asked, capped
};

Worth worth_of(const MatrixXd& sigma, Question question) {
  const Index count = sigma.rows();
  Worth worth;
  double asked = 0.0;
  if (question != Question::separate) {
    std::vector<double> seen;
    for (Index i = 0; i < count; ++i) {
      worth.mean_sigma += std::min(sigma(i, count), kEnoughSigma);
      asked += 1.0;
      if (sigma(i, count) >= kSeparates) seen.push_back(sigma(i, count));
    }
    worth.sure_sigma = seen.empty() ? sigma.col(count).maxCoeff() : *std::ranges::min_element(seen);
  } else {
    worth.sure_sigma = kBeyondAll;
    for (Index i = 0; i < count; ++i) {
      double most = 0.0;
      for (Index j = 0; j < count; ++j) {
        if (i == j) continue;
        most = std::max(most, sigma(i, j));
        worth.mean_sigma += std::min(sigma(i, j), kEnoughSigma);
        asked += 1.0;
      }
      worth.sure_sigma = std::min(worth.sure_sigma, most);
    }
  }
  worth.mean_sigma /= std::max(asked, 1.0);
  return worth;
}

int tier_of(double sigma) { return sigma >= kDecides ? 2 : sigma >= kSeparates ? 1 : 0; }

/// Whether a is to be proposed before b.
bool before(const MeasurementProposal& a, double mean_a, const MeasurementProposal& b, double mean_b) {
  const int tier_a = tier_of(a.separation_sigma), tier_b = tier_of(b.separation_sigma);
  if (tier_a != tier_b) return tier_a > tier_b;
  if (tier_a == 0) return a.separation_sigma > b.separation_sigma;
  return mean_a / a.minutes > mean_b / b.minutes;
}

struct Weighed {
  MeasurementProposal proposal;
  double mean_sigma = 0.0;
};

std::vector<PairSeparation> pairs_of(const MatrixXd& sigma, const std::vector<std::string>& names, Question question) {
  std::vector<PairSeparation> pairs;
  const Index count = sigma.rows();
  for (Index i = 0; i < count; ++i) {
    const std::string& truth = names[static_cast<std::size_t>(i)];
    if (question != Question::separate) {
      pairs.push_back({truth, "", sigma(i, count)});
      continue;
    }
    for (Index j = 0; j < count; ++j)
      if (i != j) pairs.push_back({truth, names[static_cast<std::size_t>(j)], sigma(i, j)});
  }
  return pairs;
}

/// Whether b tells no more than a of anything. @param readings  of b for each of a
bool tells_no_more(const MeasurementProposal& b, const MeasurementProposal& a, double readings) {
  constexpr double kNoMore = 1.02;
  if (a.pairs.size() != b.pairs.size()) return false;
  for (std::size_t i = 0; i < a.pairs.size(); ++i)
    if (b.pairs[i].sigma > kNoMore * std::sqrt(readings) * a.pairs[i].sigma) return false;
  return true;
}

/// Whether b tells no more than a of anything, and takes no less time.
bool outdone(const MeasurementProposal& a, const MeasurementProposal& b) {
  return a.minutes <= b.minutes && tells_no_more(b, a, 1.0);
}

/// Leaves out runs at another feed or with other reversals that tell no more than the same readings without: these
/// conditions are then no reason, whatever minutes they save.
void without_idle_motions(std::vector<Weighed>& runs) {
  const auto passes = [](const MeasurementProposal& p) { return p.runs * (p.second_feed_mm_min ? 2.0 : 1.0); };
  const std::vector<Weighed> all = runs;
  std::erase_if(runs, [&](const Weighed& one) {
    return std::ranges::any_of(all, [&](const Weighed& plain) {
      const MeasurementProposal &a = plain.proposal, &b = one.proposal;
      return a.condition == kAnotherRun && a.axis == b.axis && a.sense == b.sense &&
             (a.feed_mm_min != b.feed_mm_min || b.short_overrun) && tells_no_more(b, a, passes(b) / passes(a));
    });
  });
}

/// @param ranked  best first
std::vector<Weighed> worth_telling(std::vector<Weighed> ranked, Question question) {
  const bool any_separates = !ranked.empty() && ranked.front().proposal.separation_sigma >= kSeparates;
  std::vector<Weighed> kept;
  const std::size_t most = any_separates && question != Question::confirm ? kMostProposals : kFewProposals;
  for (Weighed& one : ranked) {
    if (kept.size() == most) break;
    if (any_separates && one.proposal.separation_sigma < kSeparates) continue;
    if (std::ranges::none_of(kept, [&](const Weighed& w) { return outdone(w.proposal, one.proposal); }))
      kept.push_back(std::move(one));
  }
  return kept;
}

/// The best number of runs of each option; of options under one condition the best one.
std::vector<Weighed> weighed(const std::vector<MeasurementProposal>& options, const Separations& separations,
                             const std::vector<std::string>& names, Question question, const MeasuringTimes& times) {
  std::vector<Weighed> best;
  for (std::size_t i = 0; i < options.size(); ++i)
    for (const int runs : kRuns) {
      Weighed one{options[i], 0.0};
      one.proposal.runs = runs;
      one.proposal.minutes = minutes_of(one.proposal, times);
      const MatrixXd sigma = separations.of(i, runs, question == Question::separate);
      const Worth worth = worth_of(sigma, question);
      one.proposal.separation_sigma = worth.sure_sigma;
      one.mean_sigma = worth.mean_sigma;
      if (worth.sure_sigma < kTelling) continue;
      one.proposal.pairs = pairs_of(sigma, names, question);
      const auto same = std::ranges::find_if(best, [&](const Weighed& w) {
        return w.proposal.condition == one.proposal.condition && w.proposal.axis == one.proposal.axis &&
               w.proposal.sense == one.proposal.sense;
      });
      if (same == best.end())
        best.push_back(std::move(one));
      else if (before(one.proposal, one.mean_sigma, same->proposal, same->mean_sigma))
        *same = std::move(one);
    }
  without_idle_motions(best);
  std::ranges::stable_sort(best, [](const Weighed& a, const Weighed& b) {
    return before(a.proposal, a.mean_sigma, b.proposal, b.mean_sigma);
  });
  return worth_telling(std::move(best), question);
}

/// Readings of a ball that the machine of the file can follow.
bool is_of_ball(const Observations& data) { return data.ball_machine && data.not_followed.empty(); }

std::vector<MeasurementProposal> all_options(const Observations& data, const std::vector<EffectInstance>& rivals,
                                             const MeasuringTimes& times) {
  if (is_of_ball(data)) return ball_options(data, times);
  const bool on_the_fly = std::ranges::any_of(rivals, [](const EffectInstance& e) { return e.traits().in_motion; });
  const bool of_approach = std::ranges::any_of(
      rivals, [](const EffectInstance& e) { return e.traits().of_approach || e.approach != ApproachMode::both; });
  const Observations on_lines = without_paths(data);
  std::vector<PresentLine> lines = present_lines(on_lines, times);
  const auto concerns = [&](const PresentLine& line) {
    return std::ranges::any_of(rivals, [&](const EffectInstance& e) {
      const bool in_sense = sense_text(e).empty() || *e.sense == line.sense;
      return in_sense && (!e.axis || *e.axis == line.axis || !e.sense);
    });
  };
  std::stable_partition(lines.begin(), lines.end(), concerns);
  if (lines.size() > kMostLines) lines.resize(kMostLines);
  std::vector<MeasurementProposal> options;
  for (const PresentLine& line : lines)
    for (MeasurementProposal& option : measuring_options(on_lines, line, times, of_approach, on_the_fly))
      options.push_back(std::move(option));
  if (times.ball_bar)
    for (MeasurementProposal& option : circle_options(data, times)) options.push_back(std::move(option));
  return options;
}

Observations evenly(const Observations& data, std::size_t most) {
  std::vector<std::size_t> rows;
  const std::size_t step = (data.size() + most - 1) / most;
  for (std::size_t k = 0; k < data.size(); k += step) rows.push_back(k);
  return subset(data, rows);
}

/// Everything that the answers share.
struct Setting {
  const Model& model;
  const Observations& data;
  const MeasuringTimes& times;
};

/// Sigmas by which a run separates two causes, whichever is true.
double sigma_of(const MeasurementProposal& run, const PairSeparation& of) {
  double least = kBeyondAll;
  for (const PairSeparation& pair : run.pairs)
    if ((pair.truth == of.truth && pair.rival == of.rival) || (pair.truth == of.rival && pair.rival == of.truth))
      least = std::min(least, pair.sigma);
  return least;
}

/// Of each pair that the first proposal leaves together: the proposal that separates it, or the advice of the effects.
void note_pairs_together(NextMeasurement& next, const OpenGroup& group) {
  const std::vector<MeasurementProposal>& runs = next.proposals;
  for (std::size_t i = 0; i < group.rivals.size(); ++i)
    for (std::size_t j = i + 1; j < group.rivals.size(); ++j) {
      const PairSeparation pair{group.names[i], group.names[j], 0.0};
      const auto other = std::ranges::find_if(runs, [&](const auto& run) { return sigma_of(run, pair) >= kSeparates; });
      if (other == runs.end())
        next.notes.push_back(fmt::format("no proposed run separates {} from {}. {}", pair.truth, pair.rival,
                                         separating_measurement(group.rivals[i], {group.rivals[j]})));
      else if (other != runs.begin())
        next.notes.push_back(
            fmt::format("proposal {} separates {} from {}", other - runs.begin() + 1, pair.truth, pair.rival));
    }
}

void take_proposals(NextMeasurement& next, std::vector<Weighed> best, Question question) {
  for (Weighed& one : best) {
    one.proposal.tells = what_it_tells(one.proposal, question);
    one.proposal.sentence = sentence_of(one.proposal);
    next.proposals.push_back(std::move(one.proposal));
  }
}

/// Why nothing separates a group.
std::string why_not(const OpenGroup& group, const Separations& separations,
                    const std::vector<MeasurementProposal>& proposals) {
  const std::size_t options = proposals.size();
  double apart = 0.0, seen = 0.0;
  const auto count = static_cast<Index>(group.rivals.size());
  for (std::size_t i = 0; i < options; ++i) {
    const MatrixXd sigma = separations.of(i, kMostRuns);
    apart = std::max(apart, sigma.leftCols(count).maxCoeff());
    seen = std::max(seen, sigma.col(count).maxCoeff());
  }
  const std::string names = fmt::format("{}", fmt::join(group.names, ", "));
  const bool only_circles = std::ranges::all_of(proposals, [](const auto& one) { return one.circle.has_value(); });
  if (apart < kSeparates && seen >= kSeparates && only_circles)
    return fmt::format(
        "no circle that can be proposed separates {}. Measure a line along one of their axes; with --machine circles "
        "in other planes are proposed too",
        names);
  if (apart < kSeparates && seen >= kSeparates)
    return fmt::format(
        "no run can separate {}: they contribute equally on every line and at every condition that can be set; check "
        "the cause itself (a setting, a level, a square)",
        names);
  if (apart < kSeparates)
    return fmt::format("too weak to separate {}: no single measurement of up to five runs adds more than {:.1f} sigma",
                       names, std::max(apart, seen));
  const std::vector<EffectInstance> others(group.rivals.begin() + 1, group.rivals.end());
  return fmt::format(
      "no single measurement of up to five runs is certain to distinguish between {}; the best run achieves {:.1f} "
      "sigma, "
      "for some of them. {}",
      names, apart, separating_measurement(group.rivals.front(), others));
}

/// Whether the new readings can be computed for the effect; says what is assumed of the extra columns that it reads.
bool can_be_foretold(const EffectInstance& effect, const WithProposals& all, NextMeasurement& next) {
  bool known = true;
  for (const std::string& column : extra_columns_of(effect, all.data)) {
    const auto follows = all.extras_follow.find(column);
    known = known && follows != all.extras_follow.end();
    std::string note = fmt::format("{} reads column {}", to_text(effect), column);
    if (follows == all.extras_follow.end())
      note += ": its value in a new run is not known, so runs are not ranked by it";
    else if (follows->second.empty())
      note += ", which is constant in these data: a new run is assumed to have the same value";
    else
      note += fmt::format(", which follows {} in these data: a new run is assumed to do the same", follows->second);
    if (std::ranges::find(next.notes, note) == next.notes.end()) next.notes.push_back(std::move(note));
  }
  return known;
}

void note_model(NextMeasurement& next, const Setting& in, const WithProposals& all) {
  for (const EffectInstance& effect : in.model.effects) static_cast<void>(can_be_foretold(effect, all, next));
}

/// Leaves the rivals whose new readings can be computed. False: too few are left for the question.
bool keep_foretold(OpenGroup& group, const WithProposals& all, NextMeasurement& next) {
  const std::size_t before = group.rivals.size();
  for (std::size_t i = group.rivals.size(); i-- > 0;) {
    if (can_be_foretold(group.rivals[i], all, next)) continue;
    group.rivals.erase(group.rivals.begin() + static_cast<std::ptrdiff_t>(i));
    group.names.erase(group.names.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return group.rivals.size() >= std::min<std::size_t>(2, before);
}

/// Without the runs after which the condition that a rival follows would still take too few levels, all tied to runs.
std::vector<MeasurementProposal> without_ties(std::vector<MeasurementProposal> options, const Observations& data,
                                              const std::vector<EffectInstance>& rivals) {
  if (std::ranges::none_of(rivals, [](const EffectInstance& rival) { return may_be_tied_to_runs(rival.definition()); }))
    return options;
  const WithProposals all = with_proposals(data, options);
  std::vector<MeasurementProposal> kept;
  for (std::size_t i = 0; i < options.size(); ++i) {
    std::vector<std::size_t> rows(all.present);
    std::iota(rows.begin(), rows.end(), std::size_t{0});
    for (std::size_t k = 0; k < all.count[i]; ++k) rows.push_back(all.first[i] + k);
    const Observations joined = subset(all.data, rows);
    if (std::ranges::none_of(rivals, [&](const EffectInstance& rival) { return is_tied_to_runs(joined, rival); }))
      kept.push_back(options[i]);
  }
  return kept;
}

/// Until the slowest of causes that follow temperatures with a delay, as fitted, has reached 95 %; 0: none is late.
double minutes_to_settle(const std::vector<EffectInstance>& rivals) {
  constexpr double kTimeConstants = 3.0;
  double lag_s = 0.0;
  for (const EffectInstance& rival : rivals)
    if (const auto lag = rival.fitted.find(std::string(kLag)); lag != rival.fitted.end())
      lag_s = std::max(lag_s, lag->second);
  return std::ceil(kTimeConstants * lag_s / kSecondsAMinute);
}

/// @param options  runs to choose from
Result<void> ask_group_by(NextMeasurement& next, const Setting& in, OpenGroup group,
                          const std::vector<MeasurementProposal>& options) {
  const WithProposals all = with_proposals(in.data, options);
  note_model(next, in, all);
  if (!keep_foretold(group, all, next)) return {};
  const Regressors regressors(all.data);
  ECS_TRY(belief, belief_of(in.model, group.settled, {group.rivals.front()}, in.data, regressors));
  std::vector<Explanation> explanations;
  bool zero_matters = false;
  for (std::size_t i = 0; i < group.rivals.size(); ++i) {
    explanations.push_back(explained_by(group.names[i], group.rivals[i], belief, all, regressors));
    zero_matters = zero_matters || group.rivals[i].traits().shows_at_zero;
  }
  const Separations separations(all, options, belief, explanations, zero_matters);
  const Question question = group.rivals.size() > 1 ? Question::separate : Question::confirm;
  take_proposals(next, weighed(options, separations, group.names, question, in.times), question);
  if (const double minutes = minutes_to_settle(group.rivals); minutes > 0.0)
    for (MeasurementProposal& one : next.proposals)
      one.sentence += fmt::format(
          " Before this run, keep the machine in one state for {:.0f} min, for example at rest or with the spindle at "
          "one speed. Then every delay between sensor and error has died out, and the possible causes predict "
          "different readings.",
          minutes);
  if (next.proposals.empty())
    next.notes.push_back(why_not(group, separations, options));
  else if (next.proposals.front().separation_sigma < kSeparates)
    next.notes.push_back(
        fmt::format("no measurement of up to five runs reaches {:.0f} sigma; these are the best", kSeparates));
  else
    note_pairs_together(next, group);
  return {};
}

/// An angle of which these readings do not say the size: its lever is the same in all of them.
bool is_unsized_angle(const OpenGroup& group, const Diagnosis& diagnosis) {
  const EffectInstance& effect = group.rivals.front();
  return group.rivals.size() == 1 && effect.definition().place == Place::rotation &&
         std::ranges::any_of(diagnosis.candidates, [&](const Candidate& one) {
           return same_candidate(one.effect, effect) &&
                  std::ranges::any_of(one.parameters, [](const ParameterEstimate& p) { return p.undetermined; });
         });
}

/// @param other_lines  leaves the runs along the lines measured now where there are others
Result<void> ask_group(NextMeasurement& next, const Setting& in, const OpenGroup& group, bool other_lines) {
  next.rivals = group.names;
  std::vector<MeasurementProposal> options = all_options(in.data, group.rivals, in.times);
  if (other_lines && std::ranges::any_of(options, &MeasurementProposal::other_line))
    std::erase_if(options, [](const MeasurementProposal& one) { return !one.other_line; });
  NextMeasurement decisive = next;
  auto asked = ask_group_by(decisive, in, group, without_ties(options, in.data, group.rivals));
  if (!decisive.proposals.empty() || !asked) {
    next = std::move(decisive);
    return asked;
  }
  return ask_group_by(next, in, group, options);  // levels of a condition add up
}

/// The causes listed that are not part of the answer: of a ball one set shows many causes at once.
std::optional<OpenGroup> listed_group(const Diagnosis& diagnosis) {
  constexpr std::size_t kMostListed = 6;  // as many as a person weighs
  OpenGroup listed;
  for (const Candidate& candidate : diagnosis.candidates) {
    if (candidate.in_answer()) {
      listed.settled.push_back(candidate.effect);
    } else if (listed.rivals.size() < kMostListed) {
      listed.rivals.push_back(candidate.effect);
      listed.names.push_back(name_with_sensor(candidate.effect));
    }
  }
  return listed.rivals.size() > 1 ? std::optional(listed) : std::nullopt;
}

/// The groups of the answer, the first first. Of a ball: where none is left, and more is missing, the causes listed.
std::vector<OpenGroup> groups_to_ask(const Diagnosis& diagnosis, bool of_ball) {
  std::vector<OpenGroup> groups = open_groups(diagnosis);
  const bool is_open = !groups.empty() && groups.front().rivals.size() > 1;
  if (of_ball && !is_open && diagnosis.verdict != Verdict::missing_effect)
    if (auto listed = listed_group(diagnosis)) return {*listed};
  return groups;
}

/// The run that separates a group whatever directions the other causes have; where there is none, at theirs of now.
Result<NextMeasurement> asked_of(const Setting& in, const OpenGroup& group, bool other_lines) {
  const OpenGroup free = with_free_directions(group);
  NextMeasurement asked;
  ECS_DO(ask_group(asked, in, free, other_lines));
  if (!asked.proposals.empty() || free.settled == group.settled) return asked;
  asked = {};
  ECS_DO(ask_group(asked, in, group, other_lines));
  return asked;
}

bool is_separated(const NextMeasurement& next) {
  return !next.proposals.empty() && next.proposals.front().separation_sigma >= kSeparates;
}

/// Of several open groups the first that a run separates: what no reading can separate must not hide what one can.
Result<void> ask_groups(NextMeasurement& next, const Setting& in, const Diagnosis& diagnosis) {
  std::optional<NextMeasurement> first;
  for (const OpenGroup& group : groups_to_ask(diagnosis, is_of_ball(in.data))) {
    ECS_TRY(asked, asked_of(in, group, is_unsized_angle(group, diagnosis)));
    const bool separates = is_separated(asked);
    if (!first || separates) {
      if (first) asked.notes.insert(asked.notes.begin(), first->notes.begin(), first->notes.end());
      first = std::move(asked);
    }
    if (separates) break;
  }
  next = std::move(*first);
  return {};
}

/// Effects of the model from the alternatives that it keeps. @return a run separates some
Result<bool> ask_undecided(NextMeasurement& next, const Setting& in) {
  for (const Undecided& one : undecided_effects(in.model, in.data)) {
    NextMeasurement asked;
    ECS_DO(ask_group(asked, {one.without, in.data, in.times}, named({one.possible, {}, {}}), false));
    if (is_separated(asked)) {
      next = std::move(asked);
      return true;
    }
    next.notes.insert(next.notes.end(), asked.notes.begin(), asked.notes.end());
  }
  return false;
}

/// The line as it is measured now, once more and both ways: whether what is left comes back. What changes in time
/// comes at other places on the way back.
void take_repetition(NextMeasurement& next, const Setting& in) {
  const bool of_ball = is_of_ball(in.data);
  const auto lines = of_ball ? std::vector<PresentLine>{} : present_lines(without_paths(in.data), in.times);
  const auto others = of_ball                ? ball_options(in.data, in.times)
                      : has_circles(in.data) ? circle_options(in.data, in.times)
                                             : std::vector<MeasurementProposal>{};
  if (lines.empty() && others.empty()) return;
  MeasurementProposal again = lines.empty() ? others.front() : lines.front().now;
  const std::vector<double> present_mm = again.targets_mm;
  again.targets_mm = off_equal_steps(present_mm, present_mm);
  again.at_present_targets = again.targets_mm == present_mm;
  again.bidirectional = true;
  constexpr int kTwice = 2;
  again.runs = kTwice;
  again.minutes = minutes_of(again, in.times);
  again.tells = what_it_tells(again, Question::repeat);
  again.sentence = sentence_of(again);
  next.proposals.push_back(std::move(again));
}

Result<void> ask_structure(NextMeasurement& next, const Setting& in, const Diagnosis& diagnosis) {
  constexpr std::size_t kMostVariables = 3;
  const auto options = all_options(in.data, {}, in.times);
  const WithProposals all = with_proposals(in.data, options);
  note_model(next, in, all);
  const Regressors regressors(all.data);
  ECS_TRY(belief, belief_of(in.model, {}, {}, in.data, regressors));
  std::vector<Explanation> explanations;
  std::vector<std::string> names;
  for (const Dependence& dependence : diagnosis.where) {
    if (next.rivals.size() == kMostVariables) break;
    next.rivals.push_back(dependence.variable);
    if (!says_what_comes(dependence.variable)) continue;
    explanations.push_back(depends_on(dependence, all.data));
    names.push_back(dependence.variable);
  }
  next.notes.push_back(fmt::format(
      "no effect of the library explains the residual. This measurement shows whether the residual depends on {} again",
      fmt::join(next.rivals, " or ")));
  // a bad run or an hour of drift foretells nothing: only a repetition shows whether it comes back
  const bool foretold = !diagnosis.where.empty() && says_what_comes(diagnosis.where.front().variable);
  if (foretold) {
    const Separations separations(all, options, belief, explanations, false);
    const Question question = explanations.size() > 1 ? Question::separate : Question::confirm;
    take_proposals(next, weighed(options, separations, names, question, in.times), question);
    std::erase_if(next.proposals, [](const MeasurementProposal& p) { return p.separation_sigma < kSeparates; });
  }
  if (next.proposals.empty()) take_repetition(next, in);
  return {};
}

/// Readings that do not tell whether anything is missing: the same again.
void ask_again(NextMeasurement& next, const Setting& in, const Diagnosis& diagnosis) {
  next.notes.push_back(fmt::format("these data cannot show whether an effect is missing: {}", diagnosis.cannot_tell));
  take_repetition(next, in);
}

/// @param few  too few readings to say whether an effect is missing
Result<void> ask_power(NextMeasurement& next, const Setting& in, bool few) {
  ECS_TRY(is_asked, few ? Result<bool>(false) : ask_undecided(next, in));
  if (is_asked) return {};
  const Observations part = in.data.size() > kManyReadings ? evenly(in.data, kManyReadings) : in.data;
  const auto options = all_options(part, {}, in.times);
  const WithProposals all = with_proposals(part, options);
  note_model(next, in, all);
  const Regressors regressors(all.data);
  ECS_TRY(belief, belief_of(in.model, {}, {}, part, regressors));
  const std::vector<Explanation> unseen = unseen_causes(belief, all, regressors, in.model, kMostUnseen);
  const double noise_um = belief.noise.pure.noise_um;
  if (unseen.empty()) {
    next.notes.push_back(fmt::format(
        "no causes to separate: any cause as large as the noise of one reading ({:.2g} {}) would have been detected",
        noise_um, part.reading_unit()));
    return {};
  }
  std::vector<std::string> names;
  for (const Explanation& one : unseen) names.push_back(one.name);
  next.rivals = names;
  next.notes.push_back(fmt::format(
      "{}. If as large as the noise of one reading ({:.2g} {}), these causes could be present and undetected: "
      "{}",
      few ? "too few readings to decide whether an effect is missing" : "the model explains the readings", noise_um,
      part.reading_unit(), fmt::join(names, ", ")));
  const bool zero_matters = true;
  const Separations separations(all, options, belief, unseen, zero_matters);
  take_proposals(next, weighed(options, separations, names, Question::see, in.times), Question::see);
  std::erase_if(next.proposals, [](const MeasurementProposal& p) { return p.separation_sigma < kSeparates; });
  if (next.proposals.empty())
    next.notes.emplace_back("no single measurement of up to five runs along the present lines would show any of them");
  return {};
}

/// Before all others where a line has readings at one target only: nothing is known of the rest of its travel.
void take_line_over_travel(NextMeasurement& next, const Setting& in) {
  for (const PresentLine& line : present_lines(without_paths(in.data), in.times)) {
    if (line.now.targets_mm.size() > 1) continue;
    if (auto over = over_the_travel(in.data, line, in.times))
      next.proposals.insert(next.proposals.begin(), std::move(*over));
    else
      next.notes.push_back(fmt::format(
          "all readings along {} are at one target. Measure the line over the travel, at five targets or more; with "
          "--machine and its travel_mm this is planned",
          in.data.letter(line.axis)));
    return;
  }
}

/// The step after a proof: compensate and confirm, or why the unit cannot.
std::string step_after_proof(const EffectInstance& effect, const params::Machine& machine, bool of_ball) {
  if (is_carried(effect, machine) && of_ball && effect.rotary && effect.traits().periodic)
    return " Before you compensate the wave, measure the straightness of X, Y and Z: an uncompensated straightness "
           "error looks like such a wave. Then add the wave to the model, compensate, and repeat this measurement.";
  if (is_carried(effect, machine))
    return " Add it to the model, compensate, and repeat the same measurement to confirm it.";
  if (is_rotary_error(effect) && machine.rotary_configuration.empty())
    return " Add it to the model. Whether the unit can compensate it is known only with a machine file that has rotary "
           "axes (--machine).";
  return fmt::format(" Add it to the model. The unit cannot compensate it ({}).", how_compensated(effect, machine));
}

/// ", and the other effects that could be tried have a total probability below 0.01 %", beside the least likely
/// cause;
/// "" where the cause is not that likely.
std::string odds_of_others(const Diagnosis& diagnosis) {
  constexpr double kLeastShown = 1e-4, kMostShown = 0.01;
  double others = 0.0;
  for (const Candidate& candidate : diagnosis.candidates)
    if (candidate.in_answer()) others = std::max(others, 1.0 - candidate.probability);
  if (others > kMostShown) return {};
  return fmt::format(", and the other effects that could be tried have a total probability {} {:.1g} %",
                     others < kLeastShown ? "below" : "of", kPercent * std::max(others, kLeastShown));
}

/// Whether neither another effect nor another value of its parameters fits as well as a proved cause.
bool is_settled(const Candidate& cause) {
  return cause.named && cause.open_rivals().empty() && cause.in_part.empty() && cause.parameters_set.empty() &&
         cause.e_value.value_or(0.0) >= kProved &&
         std::ranges::none_of(cause.parameters, [](const ParameterEstimate& one) { return one.undetermined; });
}

}  // namespace

std::optional<std::string> nothing_in_doubt(const Diagnosis& diagnosis) {
  if (diagnosis.verdict != Verdict::missing_effect) return std::nullopt;
  for (const Candidate& candidate : diagnosis.candidates)
    if (candidate.in_answer() && !is_settled(candidate)) return std::nullopt;
  return "No further measurement is needed to name the cause: it is proved" + odds_of_others(diagnosis) + ".";
}

NextMeasurement planned_next(const Model& model, const Observations& data, Diagnosis& diagnosis,
                             const MeasuringTimes& times) {
  const bool may_be_waves = std::ranges::any_of(
      diagnosis.candidates, [&](const Candidate& one) { return one.in_answer() && may_be_wave(one.effect, data); });
  if (const auto settled = nothing_in_doubt(diagnosis);
      settled && !may_be_waves && beside_formulas(model, diagnosis).empty()) {
    NextMeasurement next;
    bool is_said = diagnosis.headline.find(diagnosis.reservation) != std::string::npos;
    for (Candidate& candidate : diagnosis.candidates) {
      if (!candidate.in_answer()) continue;
      candidate.next_measurement = *settled + step_after_proof(candidate.effect, data.machine, is_of_ball(data)) +
                                   (is_said || diagnosis.reservation.empty() ? "" : " " + diagnosis.reservation);
      is_said = true;
      if (next.notes.empty()) next.notes.push_back(candidate.next_measurement);
    }
    return next;
  }
  NextMeasurement next = next_measurement(model, data, diagnosis, times);
  if (next.proposals.empty() || diagnosis.candidates.empty() || !diagnosis.candidates.front().in_answer()) return next;
  const std::vector<OpenGroup> groups = open_groups(diagnosis);
  const auto group = std::ranges::find(groups, next.rivals, &OpenGroup::names);
  if (group == groups.end()) return next;
  for (Candidate& candidate : diagnosis.candidates) {
    if (diagnosis.verdict == Verdict::missing_effect && group->rivals.size() > 1 && is_settled(candidate))
      candidate.next_measurement = "No further measurement is needed for this cause: it is proved.";
    if (!candidate.decide.empty() && candidate.open_rivals().empty()) continue;  // what decides a doubt comes first
    const auto rival = std::ranges::find_if(
        group->rivals, [&](const EffectInstance& one) { return same_candidate(one, candidate.effect); });
    if (rival == group->rivals.end()) continue;
    const std::string& name = group->names[static_cast<std::size_t>(rival - group->rivals.begin())];
    const auto tells = std::ranges::find_if(next.proposals, [&](const MeasurementProposal& p) {
      return p.pairs.empty() || std::ranges::any_of(p.pairs, [&](const PairSeparation& pair) {
               return pair.sigma >= kSeparates && (pair.truth == name || pair.rival == name);
             });
    });
    if (tells == next.proposals.end()) continue;
    candidate.next_measurement = tells->sentence;
    std::set<std::string> together;
    for (const PairSeparation& pair : tells->pairs)
      if (pair.sigma < std::min(kSeparates, tells->separation_sigma) && !pair.rival.empty() &&
          (pair.truth == name || pair.rival == name))
        together.insert(pair.truth == name ? pair.rival : pair.truth);
    if (!together.empty())
      candidate.next_measurement +=
          fmt::format(" This measurement does not distinguish {} from {}.", name, fmt::join(together, ", "));
  }
  return next;
}

NextMeasurement next_measurement(const Model& model, const Observations& data, const Diagnosis& diagnosis,
                                 const MeasuringTimes& times) {
  NextMeasurement next;
  if (data.size() == 0) {
    next.notes.emplace_back("no readings: no basis for a proposal");
    return next;
  }
  if (data.rotary && !is_of_ball(data)) {
    next.notes.emplace_back(
        "measurements are proposed only for linear axes and for a ball. For readings of a ball give --machine with a "
        "file that describes the rotary axes; X, Y and Z must follow the ball. To check a rotary axis itself, measure "
        "the full turn again in both directions, at targets that are not equally spaced");
    return next;
  }
  MeasuringTimes own = times;
  own.ball_bar = times.ball_bar || has_circles(data);
  const Observations present = own.ball_bar ? data : without_paths(data);
  if (present.size() == 0) {
    next.notes.emplace_back(
        "plans cover lines along one axis and circles, but these readings are of diagonals: measure a line along each "
        "axis of the volume and give both files together");
    return next;
  }
  const Setting setting{model, present, own};
  Result<void> asked;
  const bool is_named = diagnosis.verdict == Verdict::missing_effect ||
                        diagnosis.verdict == Verdict::partly_explained || diagnosis.verdict == Verdict::likely_effect;
  const bool few = diagnosis.verdict == Verdict::cannot_tell && diagnosis.candidates_tried == 0;  // not even searched
  if (diagnosis.verdict == Verdict::cannot_tell && !few)
    ask_again(next, setting, diagnosis);
  else if (!diagnosis.candidates.empty() &&
           (is_named || (diagnosis.verdict == Verdict::unexplained_structure && is_of_ball(data))))
    asked = ask_groups(next, setting, diagnosis);
  else if (diagnosis.verdict == Verdict::unexplained_structure && !diagnosis.where.empty())
    asked = ask_structure(next, setting, diagnosis);
  else
    asked = ask_power(next, setting, few);
  if (!is_named && !is_of_ball(present)) take_line_over_travel(next, setting);
  if (!asked) next.notes.push_back(to_text(asked.error()));
  return next;
}

}  // namespace ecs::model
