// What the next measurement is asked: which explanations are open after a diagnosis, as shapes over present and new
// readings; the runs that a person could do next; a proposed run in one sentence, as a part program in the dialect of
// thesis appendix B, and as a target list. Internal to model/ (Eigen). Does not live here: how far runs separate
// explanations (separation.hpp), which run to propose (next_measurement.hpp).
#pragma once

#include <string>
#include <vector>

#include "laser/measurement_set.hpp"
#include "model/data/observations.hpp"
#include "model/planning/next_measurement.hpp"
#include "model/planning/run.hpp"
#include "model/planning/separation.hpp"
#include "params/machine.hpp"

namespace ecs::model {

/// Separation that counts as one [sigma]: three, one case of 370 by chance; the convention of control charts (Shewhart
/// 1931).
inline constexpr double kSeparates = 3.0;

/// Targets of a fine line, a choice: 41 show eight to ten waves. Only a repetition of the readings has more.
inline constexpr std::size_t kManyTargets = 41;

/// What is asked of a run.
enum class Question {
  separate,  ///< rivals from each other
  confirm,   ///< a lone cause
  see,       ///< causes that may be there unseen
  repeat,    ///< whether what is left comes back
};

/// "26 min including set-up"
[[nodiscard]] std::string minutes_text(const MeasurementProposal& proposal);

/// "tells backlash:X:EX from servo_lag:X:EX: 12.0 sigma, 9 min"; the surest pairs first.
[[nodiscard]] std::string what_it_tells(const MeasurementProposal& proposal, Question question);

/// What to measure and how, in one sentence.
[[nodiscard]] std::string sentence_of(const MeasurementProposal& proposal);

/// A group of rivals of a diagnosis.
struct OpenGroup {
  std::vector<EffectInstance> rivals;
  std::vector<std::string> names;       ///< one per rival
  std::vector<EffectInstance> settled;  ///< named effects outside the group
};
/// With a name for each rival, behind that of a wave its period where several are of one place.
[[nodiscard]] OpenGroup named(OpenGroup group);
/// Every group of several; then every effect of which a part may be another one, along with those; then every wave of
/// which several periods fit; of a diagnosis without any of these its first cause alone. Not empty where there are
/// candidates.
[[nodiscard]] std::vector<OpenGroup> open_groups(const Diagnosis& diagnosis);
/// Its settled effects free along all their directions: beside another rival they may have taken others.
[[nodiscard]] OpenGroup with_free_directions(OpenGroup group);

/// "thermal_drift:X:EX (t_spindle_degC)"
[[nodiscard]] std::string name_with_sensor(const EffectInstance& effect);

/// Extra columns that the formulas of a user effect read; none for effects of the library.
[[nodiscard]] std::vector<std::string> extra_columns_of(const EffectInstance& effect, const Observations& data);

/// Whether a dependence on the variable says what a new run shows: not where each run is another, or each hour.
[[nodiscard]] bool says_what_comes(const std::string& variable);

/// The residual as a function of one variable, for structure that no effect explains.
[[nodiscard]] Explanation depends_on(const Dependence& dependence, const Observations& all);

/// Causes with one size to fit that the present readings could hold unseen although as large as the noise, each with
/// that size, at most `most`.
[[nodiscard]] std::vector<Explanation> unseen_causes(const Belief& belief, const WithProposals& all,
                                                     const Regressors& regressors, const Model& model,
                                                     std::size_t most);

/// The condition of a run that changes nothing.
inline constexpr std::string_view kAnotherRun = "with the present set-up, another run";

/// One line as it is measured now: the most frequent parked place of an axis moved and a sense read.
struct PresentLine {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  MeasurementProposal now;  ///< the line as it is, one run
  std::size_t readings = 0;
};
/// Most readings first.
[[nodiscard]] std::vector<PresentLine> present_lines(const Observations& data, const MeasuringTimes& times);

/// The same line over the travel of its axis, where all its readings are at one target; nothing: there are more
/// targets, or no travel is known.
[[nodiscard]] std::optional<MeasurementProposal> over_the_travel(const Observations& data, const PresentLine& line,
                                                                 const MeasuringTimes& times);

/// The way that an axis may take: its travel, else what was measured.
[[nodiscard]] Range range_of(const Observations& data, Axis axis);

/// Whether targets lie at equal steps, apart from the outermost, which the overrun may have moved.
[[nodiscard]] bool is_even_between_ends(const std::vector<double>& targets_mm);
/// The targets chosen for a run, moved where the present ones lie at equal steps: there a period has aliases.
[[nodiscard]] std::vector<double> off_equal_steps(const std::vector<double>& present_mm, std::vector<double> chosen_mm,
                                                  std::optional<double> pitch_mm = {});

/// Runs worth weighing, one run of each: every condition with many and with few targets, both ways and one way.
/// @param of_approach  causes that depend on the approach are in question: both ways only
/// @param on_the_fly   readings without a dwell, as a following error needs
[[nodiscard]] std::vector<MeasurementProposal> measuring_options(const Observations& data, const PresentLine& line,
                                                                 const MeasuringTimes& times, bool of_approach,
                                                                 bool on_the_fly);

/// Blocks begin with ">", `$REP n` … `$END` repeat, ";" begins a comment. G90/G91 absolute/incremental, G00 rapid, G01
/// at feed F, G04H dwell [s], M08 takes a reading, M09 resets the switch. Equal steps become loops, others a line each.
/// The head tells the operator what to set up. No motion leaves the travel of the machine's axes: an overrun is cut
/// short at the end of travel, a target beyond it is left out and said in a comment.
[[nodiscard]] std::string part_program(const MeasurementProposal& proposal, const params::Machine& machine);

/// The rows to be measured, in the order of the program: one per reading, every known condition filled in, `reading` 0.
/// The metadata say that it holds no readings.
[[nodiscard]] laser::MeasurementSet target_set(const MeasurementProposal& proposal);
/// The same as CSV text (docs/laser.md).
[[nodiscard]] std::string target_list(const MeasurementProposal& proposal);

}  // namespace ecs::model
