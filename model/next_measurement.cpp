#include "model/next_measurement.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "model/measuring_options.hpp"
#include "model/measuring_questions.hpp"
#include "model/words.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Least separation worth telling.
constexpr double kTelling = 1.0;
/// Separation that a person calls one.
constexpr double kSeparates = 3.0;
/// Separation that the next diagnosis takes for certain in spite of chance: three sigmas of difference, three of luck.
constexpr double kDecides = 6.0;
/// Sigmas beyond which more does not tell more.
constexpr double kEnough = 8.0;
constexpr std::size_t kMostLines = 3;
constexpr std::size_t kMostProposals = 8;
constexpr std::size_t kMostUnseen = 12;
/// Readings beyond which the power of a set is judged on an even choice of them.
constexpr std::size_t kManyReadings = 4000;

/// What is asked of a run.
enum class Question { separate, confirm, see };

struct Worth {
  double sure_sigma = 0.0;  ///< the group loses a member by, whichever is true; to see: of the causes seen
  double told = 0.0;        ///< mean over what is asked, capped
};

Worth worth_of(const MatrixXd& sigma, Question question) {
  const Index count = sigma.rows();
  Worth worth;
  double asked = 0.0;
  if (question != Question::separate) {
    std::vector<double> seen;
    for (Index i = 0; i < count; ++i) {
      worth.told += std::min(sigma(i, count), kEnough);
      asked += 1.0;
      if (sigma(i, count) >= kSeparates) seen.push_back(sigma(i, count));
    }
    worth.sure_sigma = seen.empty() ? sigma.col(count).maxCoeff() : *std::min_element(seen.begin(), seen.end());
  } else {
    worth.sure_sigma = 1e300;
    for (Index i = 0; i < count; ++i) {
      double most = 0.0;
      for (Index j = 0; j < count; ++j) {
        if (i == j) continue;
        most = std::max(most, sigma(i, j));
        worth.told += std::min(sigma(i, j), kEnough);
        asked += 1.0;
      }
      worth.sure_sigma = std::min(worth.sure_sigma, most);
    }
  }
  worth.told /= std::max(asked, 1.0);
  return worth;
}

int tier_of(double sigma) { return sigma >= kDecides ? 2 : sigma >= kSeparates ? 1 : 0; }

/// Whether a is to be proposed before b.
bool before(const MeasurementProposal& a, double told_a, const MeasurementProposal& b, double told_b) {
  const int tier_a = tier_of(a.separation_sigma), tier_b = tier_of(b.separation_sigma);
  if (tier_a != tier_b) return tier_a > tier_b;
  if (tier_a == 0) return a.separation_sigma > b.separation_sigma;
  return told_a / a.minutes > told_b / b.minutes;
}

struct Weighed {
  MeasurementProposal proposal;
  double told = 0.0;
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

/// The best number of runs of each option; of options under one condition the best one.
std::vector<Weighed> weighed(const std::vector<MeasurementProposal>& options, const Separations& separations,
                             const std::vector<std::string>& names, Question question, const MeasuringTimes& times) {
  std::vector<Weighed> best;
  for (std::size_t i = 0; i < options.size(); ++i)
    for (const int runs : {1, 2, 3, 5}) {
      Weighed one{options[i], 0.0};
      one.proposal.runs = runs;
      one.proposal.minutes = minutes_of(one.proposal, times);
      const MatrixXd sigma = separations.of(i, runs);
      const Worth worth = worth_of(sigma, question);
      one.proposal.separation_sigma = worth.sure_sigma;
      one.told = worth.told;
      if (worth.sure_sigma < kTelling) continue;
      one.proposal.pairs = pairs_of(sigma, names, question);
      const auto same = std::find_if(best.begin(), best.end(), [&](const Weighed& w) {
        return w.proposal.condition == one.proposal.condition && w.proposal.axis == one.proposal.axis &&
               w.proposal.sense == one.proposal.sense;
      });
      if (same == best.end())
        best.push_back(std::move(one));
      else if (before(one.proposal, one.told, same->proposal, same->told))
        *same = std::move(one);
    }
  std::stable_sort(best.begin(), best.end(),
                   [](const Weighed& a, const Weighed& b) { return before(a.proposal, a.told, b.proposal, b.told); });
  if (best.size() > kMostProposals) best.resize(kMostProposals);
  return best;
}

std::string ways_of(const MeasurementProposal& p) {
  if (p.bidirectional) return "both ways";
  return p.approach < 0 ? "downwards only" : "upwards only";
}

std::string what_it_tells(const MeasurementProposal& p, Question question) {
  std::vector<std::string> apart, together;
  for (const PairSeparation& pair : p.pairs) {
    if (question == Question::separate && pair.truth > pair.rival) continue;  // told once
    double sigma = pair.sigma;
    for (const PairSeparation& back : p.pairs)
      if (back.truth == pair.rival && back.rival == pair.truth) sigma = std::min(sigma, back.sigma);
    const bool enough = sigma >= std::min(kSeparates, p.separation_sigma);
    if (question != Question::separate) {
      if (enough) apart.push_back(fmt::format("{} by {:.1f} sigma", pair.truth, sigma));
    } else if (enough) {
      apart.push_back(fmt::format("{} from {} by {:.1f} sigma", pair.truth, pair.rival, sigma));
    } else {
      together.push_back(fmt::format("{} from {}", pair.truth, pair.rival));
    }
  }
  if (question == Question::see) return fmt::format("; as large as the noise it would show {}", fmt::join(apart, ", "));
  if (question == Question::confirm) return fmt::format("; it confirms {}", fmt::join(apart, ", "));
  std::string text = apart.empty() ? fmt::format("; by {:.1f} sigma one of the group falls", p.separation_sigma)
                                   : fmt::format("; it separates {}", fmt::join(apart, ", "));
  if (!together.empty()) text += fmt::format(", but not {}", fmt::join(together, ", "));
  return text;
}

std::string sentence_of(const MeasurementProposal& p, Question question) {
  std::string text =
      fmt::format("Measure {} along {} {}: {} targets from {:g} to {:g} mm, {}, {} {}, feed {:g} mm/min",
                  name_of(p.sense), letter_of(p.axis), p.condition, p.targets_mm.size(), p.targets_mm.front(),
                  p.targets_mm.back(), ways_of(p), p.runs, p.runs == 1 ? "run" : "runs", p.feed_mm_min);
  if (p.second_feed_mm_min) text += fmt::format(" and {:g} mm/min", *p.second_feed_mm_min);
  text += p.dwell_s > 0.0 ? fmt::format(", {:g} s dwell", p.dwell_s) : ", readings on the fly";
  text += fmt::format("; about {:.0f} min", p.minutes);
  return text + what_it_tells(p, question) + ".";
}

std::vector<MeasurementProposal> all_options(const Observations& data, const std::vector<EffectInstance>& rivals,
                                             const MeasuringTimes& times) {
  const bool on_the_fly =
      std::any_of(rivals.begin(), rivals.end(), [](const EffectInstance& e) { return e.id == EffectId::servo_lag; });
  const bool of_approach = std::any_of(rivals.begin(), rivals.end(), [](const EffectInstance& e) {
    return info_of(e.id).of_approach || e.approach != ApproachMode::both;
  });
  std::vector<MeasuredLine> lines = measured_lines(data, times);
  const auto concerns = [&](const MeasuredLine& line) {
    return std::any_of(rivals.begin(), rivals.end(), [&](const EffectInstance& e) {
      return (!e.sense || *e.sense == line.sense) && (!e.axis || *e.axis == line.axis || !e.sense);
    });
  };
  std::stable_partition(lines.begin(), lines.end(), concerns);
  if (lines.size() > kMostLines) lines.resize(kMostLines);
  std::vector<MeasurementProposal> options;
  for (const MeasuredLine& line : lines)
    for (MeasurementProposal& option : measuring_options(data, line, times, of_approach, on_the_fly))
      options.push_back(std::move(option));
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

void take_proposals(NextMeasurement& next, std::vector<Weighed> best, Question question) {
  for (Weighed& one : best) {
    one.proposal.sentence = sentence_of(one.proposal, question);
    next.proposals.push_back(std::move(one.proposal));
  }
}

/// Why nothing separates a group.
std::string why_not(const OpenGroup& group, const Separations& separations, std::size_t options,
                    const Observations& data) {
  double most = 0.0;
  const auto count = static_cast<Index>(group.rivals.size());
  for (std::size_t i = 0; i < options; ++i) {
    const MatrixXd sigma = separations.of(i, 5);
    most = std::max(most, count > 1 ? sigma.leftCols(count).maxCoeff() : sigma.maxCoeff());
  }
  const std::vector<EffectInstance> others(group.rivals.begin() + 1, group.rivals.end());
  if (most < kSeparates)
    return fmt::format(
        "no run can separate {}: on every line, at every condition that could be set they contribute alike; look at "
        "the "
        "cause itself (a setting, a level, a square)",
        fmt::join(group.names, ", "));
  return fmt::format(
      "no single run of up to five repeats separates {} by {:.0f} sigma or more whichever is true; the most that any "
      "would do is {:.1f} sigma for some of them. {}",
      fmt::join(group.names, ", "), kTelling, most, separating_measurement(group.rivals.front(), others, data));
}

Result<void> ask_group(NextMeasurement& next, const Setting& in, const OpenGroup& group) {
  next.rivals = group.names;
  const auto options = all_options(in.data, group.rivals, in.times);
  const WithProposals all = with_proposals(in.data, options);
  const Regressors regressors(all.data);
  const auto belief = belief_of(in.model, group.settled, {group.rivals.front()}, in.data, regressors);
  if (!belief) return tl::unexpected(belief.error());
  std::vector<Explanation> explanations;
  bool zero_matters = false;
  for (std::size_t i = 0; i < group.rivals.size(); ++i) {
    explanations.push_back(explained_by(group.names[i], group.rivals[i], *belief, all, regressors));
    zero_matters = zero_matters || shows_at_zero(group.rivals[i].id);
  }
  const Separations separations(all, options, *belief, explanations, zero_matters);
  const Question question = group.rivals.size() > 1 ? Question::separate : Question::confirm;
  take_proposals(next, weighed(options, separations, group.names, question, in.times), question);
  if (next.proposals.empty()) next.notes.push_back(why_not(group, separations, options.size(), in.data));
  return {};
}

Result<void> ask_structure(NextMeasurement& next, const Setting& in, const Diagnosis& diagnosis) {
  constexpr std::size_t kMostVariables = 3;
  const auto options = all_options(in.data, {}, in.times);
  const WithProposals all = with_proposals(in.data, options);
  const Regressors regressors(all.data);
  const auto belief = belief_of(in.model, {}, {}, in.data, regressors);
  if (!belief) return tl::unexpected(belief.error());
  std::vector<Explanation> explanations;
  for (const Dependence& dependence : diagnosis.where) {
    if (explanations.size() == kMostVariables) break;
    explanations.push_back(depends_on(dependence, all.data));
    next.rivals.push_back(dependence.variable);
  }
  const Separations separations(all, options, *belief, explanations, false);
  const Question question = explanations.size() > 1 ? Question::separate : Question::confirm;
  take_proposals(next, weighed(options, separations, next.rivals, question, in.times), question);
  next.notes.push_back(fmt::format(
      "no effect of the library explains what is left: the run is to show whether it depends on {}; repeat it as it is "
      "before changing anything else",
      fmt::join(next.rivals, " or ")));
  return {};
}

Result<void> ask_power(NextMeasurement& next, const Setting& in) {
  const Observations part = in.data.size() > kManyReadings ? evenly(in.data, kManyReadings) : in.data;
  const auto options = all_options(part, {}, in.times);
  const WithProposals all = with_proposals(part, options);
  const Regressors regressors(all.data);
  const auto belief = belief_of(in.model, {}, {}, part, regressors);
  if (!belief) return tl::unexpected(belief.error());
  const std::vector<Explanation> unseen = unseen_causes(*belief, all, regressors, in.model, kMostUnseen);
  const double noise_um = belief->noise.pure.noise_um;
  if (unseen.empty()) {
    next.notes.push_back(fmt::format(
        "nothing to separate: the model is adequate, and any cause of one size as large as the noise of one reading "
        "({:.2g} um) would have been seen",
        noise_um));
    return {};
  }
  std::vector<std::string> names;
  for (const Explanation& one : unseen) names.push_back(one.name);
  next.rivals = names;
  next.notes.push_back(fmt::format(
      "the model is adequate, but these could be there unseen, as large as the noise of one reading ({:.2g} um): {}",
      noise_um, fmt::join(names, ", ")));
  const bool zero_matters = true;
  const Separations separations(all, options, *belief, unseen, zero_matters);
  take_proposals(next, weighed(options, separations, names, Question::see, in.times), Question::see);
  std::erase_if(next.proposals, [](const MeasurementProposal& p) { return p.separation_sigma < kSeparates; });
  if (next.proposals.empty())
    next.notes.emplace_back("no single run of up to five repeats along the lines measured now would show any of them");
  return {};
}

}  // namespace

NextMeasurement next_measurement(const Model& model, const Observations& data, const Diagnosis& diagnosis,
                                 const MeasuringTimes& times) {
  NextMeasurement next;
  if (data.size() == 0) {
    next.notes.emplace_back("no readings: nothing to go on from");
    return next;
  }
  const Setting setting{model, data, times};
  Result<void> asked;
  if (diagnosis.verdict == Verdict::missing_effect && !diagnosis.candidates.empty())
    asked = ask_group(next, setting, open_group(diagnosis));
  else if (diagnosis.verdict == Verdict::unexplained_structure && !diagnosis.where.empty())
    asked = ask_structure(next, setting, diagnosis);
  else
    asked = ask_power(next, setting);
  if (!asked) next.notes.push_back(to_text(asked.error()));
  return next;
}

}  // namespace ecs::model
