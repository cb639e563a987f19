// From single candidates to a set of missing effects: forward steps on several branches, exchange of earlier choices,
// and the rivals that do as well. Internal to model/ (Eigen). Does not live here: the gains themselves
// (model/fit/search.hpp).
#pragma once

#include <optional>
#include <vector>

#include "model/fit/search.hpp"

namespace ecs::model {

struct StepwiseOptions {
  std::size_t most_effects = 3;
  double entry_score = 10.0;  ///< least score of an effect that may be added
  double entry_gain = 0.0;    ///< least fall of χ² of the first two: what noise known imperfectly may fake
  double late_gain = 0.0;     ///< least fall of χ² of any further one
  /// Degrees of freedom of the estimate of the noise, and of the residual of the model. With few of the former the
  /// residual is used to estimate the size of the noise as well (joint likelihood). `freedom` 0: the noise is known.
  double noise_freedom = 0.0, freedom = 0.0;
};

/// The best set of effects; empty where none reaches the entry score. Does not depend on the order of the families.
[[nodiscard]] Solution best_solution(const Search& search, const StepwiseOptions& options);

/// Whether an effect acts along several directions, of which its cause may have one and another effect the others.
[[nodiscard]] bool has_directions(const EffectInstance& effect);

/// Effects along directions, each with those of its columns that are best beside the others.
struct DirectionSet {
  std::vector<Choice> chosen;
  double gain = 0.0, cost = 0.0;
  [[nodiscard]] double score() const { return gain - cost; }
};
/// For every set of at most so many of these effects its best columns, best score first.
/// @param beside  what is absorbed already
[[nodiscard]] std::vector<DirectionSet> direction_sets(const Search& search, const Space& beside, std::size_t most);

/// What may look like an effect: a slow wander of the readings, a zero that drifts alike in every run, errors of single
/// targets without any order, or a lost motion that depends on the travel since the reversal.
enum class Alias : std::uint8_t { none, wander, drift_in_runs, single_targets, travel_since_reversal };

/// A member of a solution and the rivals that these data cannot distinguish from it.
struct Group {
  Choice member;
  std::vector<Choice> rivals;  ///< equal in fit within what noise allows, with few parameters more
  std::vector<Choice> weaker;  ///< the next best, best first
  /// Of a member along several directions: another effect that explains as much as some of them do, beside the others.
  struct InPart {
    Choice kept, part, other;  ///< the member along the others; along those; what may take their place
  };
  std::vector<InPart> in_part;
  /// At all values of its searched parameter that fit within Δχ² 9 of the best (14.2 where they need one harmonic
  /// less), the facts of the machine first; of one without a derivative (a place) at the least and the greatest.
  std::vector<Choice> values;
  double hidden_by_sensor = 0.0;  ///< fall of χ² that the noise of its sensor takes from it
  bool denied = false;        ///< something speaks against it although it explains: a run, waves that can be anything
  double change = 0.0;        ///< gain of a change of this wave along the travel or in time
  Alias alias = Alias::none;  ///< what explains it nearly as well without being a cause
  std::optional<double> e_value;  ///< on readings it was not fitted to, for having been chosen among all candidates
  double p_value = 1.0;           ///< e_value.hpp, beside the other effects of the solution
  double p_value_alone = 1.0;     ///< the same beside the model
};
/// One group per effect of the solution, in its order.
[[nodiscard]] std::vector<Group> groups_of(const Search& search, const Solution& solution, double entry_score);

/// Probability of each of these alternatives for one cause, in their order; they add up to 1.
/// @param families  those of the search that made them
[[nodiscard]] std::vector<double> probabilities_of(const std::vector<Choice>& alternatives,
                                                   const std::vector<Family>& families);

}  // namespace ecs::model
