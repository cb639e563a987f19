// An investigation to its end: measure, diagnose, take the run that separates the rivals best per minute, again, until
// one cause is left; then the cause is added to the model, the machine compensated by its map and measured again.
// The runs that it begins with, and the full programme of ISO 230-2 on the same lines, against which its minutes are
// held. The readings of all runs as one set, and the model with the zeros of the runs: every run begins with an
// instrument set to zero again, so that what shifts a whole run says nothing. Its ledger: a step for each run, the
// causes that a diagnosis leaves possible, minutes and errors; as text and JSON. Where it measures (two workshops are
// there, workshops.hpp). An investigation as somebody watches it: its steps, the run under way, what was said, as rows
// of a screen too (a falling staircase of the causes that are still possible); and the readings it was given, so that
// one that was stopped goes on where it was. Does not live here: the diagnosis (model/diagnosis/diagnose.hpp), the
// choice of the run (model/planning/next_measurement.hpp).
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/json_fwd.hpp"
#include "base/result.hpp"
#include "commissioning/session/message.hpp"
#include "laser/measurement_set.hpp"
#include "model/data/observations.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/fit/fit.hpp"
#include "model/fit/model_file.hpp"
#include "model/planning/next_measurement.hpp"
#include "params/machine.hpp"

namespace ecs::commissioning {

/// Readings of one sense along one axis, the other axes on its measurement line.
struct InvestigatedLine {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  bool against_square = false;  ///< the model has a squareness of these axes: the slope is of the machine
  friend bool operator==(const InvestigatedLine&, const InvestigatedLine&) = default;
};

/// The lines on which effects of the model act; of a model without effects the positioning of every axis.
[[nodiscard]] std::vector<InvestigatedLine> lines_of_model(const model::Model& model, const params::Machine& machine);
/// Positioning of the axes that the model does not speak of.
[[nodiscard]] std::vector<InvestigatedLine> other_lines(const std::vector<InvestigatedLine>& lines,
                                                        const params::Machine& machine);

/// Times of an investigation in the virtual workshop, where instruments are set up by a request: three minutes a line,
/// one to start another run on it. Choices, the same for the programme of ISO 230-2.
[[nodiscard]] model::MeasuringTimes workshop_times();

inline constexpr const char* kFirstLook = "first look";
/// Two bidirectional runs, so that repeats show the noise, over targets moved from even places by up to a fifth of the
/// step (ISO 230-2:2014, 5.2, so that no period hides between them). @pre the machine has the axis
[[nodiscard]] model::MeasurementProposal first_look(const InvestigatedLine& line, const params::Machine& machine,
                                                    const model::MeasuringTimes& times);

/// Temperatures are wired to the unit: what depends on them can be compensated, so it is looked for.
[[nodiscard]] bool follows_temperatures(const params::Machine& machine);
/// A first look in several runs, the first of the cold machine, the next ones while it is warmed, the last ones while
/// it cools: a drift with time alone does not turn round with the temperatures. Nothing where `minutes` are too short.
[[nodiscard]] std::optional<model::MeasurementProposal> look_cold_and_warm(const model::MeasurementProposal& look,
                                                                           const params::Machine& machine,
                                                                           const model::MeasuringTimes& times,
                                                                           double minutes);
/// The same again when the other lines were looked at: a body that warms with the day is nearer to its end by then,
/// which tells it from the air and from a drift with time.
[[nodiscard]] model::MeasurementProposal look_later(const model::MeasurementProposal& look,
                                                    const params::Machine& machine);

/// The line of a first look again, on targets between its own.
[[nodiscard]] model::MeasurementProposal look_between(const model::MeasurementProposal& look,
                                                      const model::MeasuringTimes& times);
/// The same line once both ways without stops: what depends on the feed shows only in motion.
[[nodiscard]] model::MeasurementProposal look_in_motion(const model::MeasurementProposal& look,
                                                        const model::MeasuringTimes& times);
inline constexpr const char* kWithLoad = "with a load";
/// The same line once both ways with a load on the machine. @param is_on  the load is on already
[[nodiscard]] model::MeasurementProposal look_with_load(const model::MeasurementProposal& look,
                                                        const model::MeasuringTimes& times, bool is_on);

/// The same line once both ways with its artefact turned over: what is the artefact's changes its sign (ISO 230-1).
[[nodiscard]] model::MeasurementProposal look_turned_over(const model::MeasurementProposal& look,
                                                          const model::MeasuringTimes& times);

/// ISO 230-2:2014, 5.3: five bidirectional runs a line; targets every 50 mm as in thesis 6.3, 25 at least.
struct IsoProgramme {
  static constexpr int kRuns = 5;
  std::size_t targets = 0;  ///< of all lines
  std::size_t lines = 0;
  double dwell_s = 0.0;         ///< at each target, the time of the trigger included
  double set_up_minutes = 0.0;  ///< for each line
  double minutes = 0.0;         ///< everything
};
[[nodiscard]] IsoProgramme iso_programme(const std::vector<InvestigatedLine>& lines, const params::Machine& machine,
                                         const model::MeasuringTimes& times);

/// Whether the name is that of a zero that an InvestigationReadings added to the model.
[[nodiscard]] bool is_zero_of_run(std::string_view effect_name);

class InvestigationReadings {
 public:
  explicit InvestigationReadings(model::Model base) : base_(std::move(base)) {}

  /// Rows and runs are numbered on; times before the end of the last run are moved behind it.
  /// @param pause_minutes  between the last run and this one, where its times start again
  /// @param against_square  its slope is that of the machine, not of a straight edge
  void add(laser::MeasurementSet run, double pause_minutes, bool against_square = false);

  /// The base model with a zero for each run; a straight edge has a slope of its own as well. The first run of a sense
  /// needs none where the model has an offset of that sense.
  [[nodiscard]] model::Model model_with_zeros() const;
  [[nodiscard]] model::Observations observations(const params::Machine& machine) const;
  /// What the unit knows of those of one sense: the temperatures at its inputs, no other sensor.
  /// @param clock  with the times, which it does not know
  [[nodiscard]] model::Observations observations_of_unit(const params::Machine& machine, Sense sense, bool clock) const;
  [[nodiscard]] std::vector<Sense> senses() const;  ///< in the order in which they were measured first
  [[nodiscard]] const laser::MeasurementSet& all() const { return all_; }

 private:
  struct Zero {
    Sense sense = Sense::EX;
    int number = 0;
    bool offset = true;
    bool slope = false;
  };
  model::Model base_;
  laser::MeasurementSet all_;
  std::vector<Zero> zeros_;
  double last_s_ = 0.0;
};

/// The model without the zeros of runs.
[[nodiscard]] model::Model without_zeros(model::Model model);

/// The usual slope of the line is set so that all that a map carries of it is level over the travel (least squares):
/// then compensating the line does not turn the axis, from which squareness counts. A slope that a person gave stays.
[[nodiscard]] Result<void> make_level(model::Model& model, const InvestigatedLine& line,
                                      const params::Machine& machine);

using model::SetMember;

/// The credible set that holds one candidate, likeliest first; without the zeros of runs.
[[nodiscard]] std::vector<SetMember> credible_set_of(const model::Candidate& candidate);

/// The sets of all candidates of the answer, proved or likely; empty where it has none.
[[nodiscard]] std::vector<SetMember> members_left(const model::Diagnosis& diagnosis);

/// The answer has causes, and none has a rival.
[[nodiscard]] bool causes_are_single(const model::Diagnosis& diagnosis);

/// One run, and what all readings so far say.
struct InvestigationStep {
  double minutes = 0.0;  ///< of this run: waiting, setting up, measuring
  std::string measured;  ///< what was measured, in words
  std::size_t readings = 0;
  model::Verdict verdict = model::Verdict::adequate;
  std::vector<SetMember> set;  ///< causes that are still possible; empty where nothing is named
  double rms_um = 0.0;         ///< that the model leaves of all readings so far
};

struct InvestigatedCause {
  std::string name;  ///< "cyclic:X:EX"
  std::vector<model::ParameterEstimate> parameters;
  double probability = 0.0;      ///< its share of the set that holds it
  double rms_um = 0.0;           ///< of its contribution to the readings on which it acts
  std::vector<SetMember> set{};  ///< that holds it: where there are others, these data do not tell them apart
};

struct Investigation {
  std::vector<InvestigationStep> steps;
  std::optional<model::Verdict> verdict;  ///< absent: nothing was measured
  std::vector<InvestigatedCause> causes;  ///< largest first
  double minutes = 0.0;                   ///< of all steps
  IsoProgramme programme;                 ///< the full programme of the same lines
  std::optional<double> rms_before_um;    ///< of the readings of the first look, each line about its mean
  /// Of the same targets measured again with the new map active; absent: no map could be made or sent.
  std::optional<double> rms_compensated_um;
  double compensated_minutes = 0.0;        ///< of measuring again; not part of `minutes`
  model::Model model;                      ///< with the causes on the lines, fitted
  std::optional<model::Model> ball_model;  ///< of the readings of a ball, with their causes, fitted
  std::vector<std::string> notes;          ///< what was left out, and why
};

/// " #   min  total  rms um causes", and the numbers of a step below it.
/// @param number  of the step, from 1 @param total_minutes  up to and with this step
[[nodiscard]] std::string ledger_numbers_head();
[[nodiscard]] std::string ledger_numbers(std::size_t number, const InvestigationStep& step, double total_minutes);
/// The head of the table and the lines of each step with what was measured, without the last line end.
[[nodiscard]] std::string ledger_head();
[[nodiscard]] std::string ledger_line(std::size_t number, const InvestigationStep& step, double total_minutes);
/// {"minutes", "measured", "readings", "verdict", "set", "rms_um"}; no text.
[[nodiscard]] Cell step_cell(const InvestigationStep& step);
/// In JSON the keys of `investigate` in docs/verbs.md; in the text verdict, causes, minutes against the programme,
/// errors before and after.
[[nodiscard]] Cell investigation_cell(const Investigation& investigation);
[[nodiscard]] std::string summary_text(const Investigation& investigation);  ///< the text of it

/// Pairs of + and - angles of the tilting axis while a ball on the table is followed, off the middle of the travels as
/// far as the most poses are in reach. Nothing: the machine has no rotary axes, or lacks one of X, Y, Z.
[[nodiscard]] std::optional<model::MeasurementProposal> first_look_at_ball(const params::Machine& machine,
                                                                           const model::MeasuringTimes& times);

/// Sets of a ball, which are a measurement of their own: positions of the ball and the tool and all location errors are
/// in its model, as in `ecs model new`.
class BallInvestigation {
 public:
  BallInvestigation(const params::Machine& machine, const model::MeasuringTimes& times);

  /// The first look, then the set that separates best per minute what the diagnosis leaves open. Nothing: nothing is
  /// open, no set separates it, or none takes so few minutes.
  [[nodiscard]] std::optional<model::MeasurementProposal> next(double minutes);
  /// No sets can be measured here.
  void end() { is_over_ = true; }
  /// Behind the readings so far, and diagnosed with them.
  Result<void> add(const laser::MeasurementSet& set, const model::DiagnoseOptions& options);
  [[nodiscard]] const std::optional<model::Diagnosis>& diagnosis() const { return diagnosis_; }

  struct Causes {
    model::Model model;  ///< with the causes, fitted
    std::vector<InvestigatedCause> found;
  };
  /// @pre diagnosis()
  [[nodiscard]] Result<Causes> causes() const;

 private:
  [[nodiscard]] model::Observations observations() const;

  const params::Machine& machine_;
  model::MeasuringTimes times_;
  std::optional<model::MeasurementProposal> first_;
  bool is_over_ = false;
  laser::MeasurementSet all_;
  model::Model model_;
  std::optional<model::Diagnosis> diagnosis_;
};

struct RequestedRun {
  int number = 1;  ///< of the run in the investigation, from 1
  model::MeasurementProposal proposal;
  bool with_new_map = false;  ///< with the map active that activate() sent
};

struct RunReadings {
  laser::MeasurementSet set;
  double minutes = 0.0;  ///< waiting, setting up, measuring
};

class Workshop {
 public:
  Workshop() = default;
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;
  virtual ~Workshop() = default;

  /// Readings of the line that was asked for. `usage` and `refused`: this run cannot be made here, another may be;
  /// every other problem ends the investigation.
  [[nodiscard]] virtual Result<RunReadings> measure(const RequestedRun& run) = 0;
  /// Makes a map of the model, sends it and has the unit compensate with it.
  [[nodiscard]] virtual Result<void> activate(const model::Model& model) = 0;
  /// After each step.
  virtual void keep(const InvestigationStep& step) = 0;
};

struct InvestigationOptions {
  double minutes = 0.0;  ///< that the runs may take; measuring again with the map is not counted
  model::MeasuringTimes times;
  const std::atomic<bool>* cancelled = nullptr;  ///< set by another thread: ends it with a `refused` problem
};

/// Ends where one cause is left, where nothing is missing, where no run separates what is left, or where the next run
/// would take more than the minutes that remain; the verdict and the notes say which. Problems are those of the
/// workshop and of the diagnosis.
[[nodiscard]] Result<Investigation> investigate(const model::Model& model, const params::Machine& machine,
                                                Workshop& workshop, const InvestigationOptions& options);

struct InvestigationProgress {
  std::vector<InvestigationStep> steps;
  std::string doing;              ///< "run 3: Measure EX along X, …"; empty: nothing is measured
  std::vector<std::string> said;  ///< notes and warnings, newest last
};

/// What an investigation leaves behind when it is stopped; its functions may be called from any thread.
class FollowedInvestigation final : public MessageSink {
 public:
  void note(std::string_view text) override;
  void warn(std::string_view text) override;

  [[nodiscard]] InvestigationProgress progress() const;
  /// Forgets what was said; steps and readings stay.
  void forget_messages();

 private:
  friend class FollowedWorkshop;
  mutable std::mutex mutex_;
  InvestigationProgress progress_;
  std::map<std::pair<int, std::string>, RunReadings> given_;  ///< by number of the run and what was asked for
};

/// Another workshop, followed. A run that was measured before the investigation was stopped is not measured again.
class FollowedWorkshop final : public Workshop {
 public:
  /// @param changed  called after every change, in the thread of the investigation; may be empty
  FollowedWorkshop(FollowedInvestigation& followed, Workshop& workshop, std::function<void()> changed = {})
      : followed_(followed), workshop_(workshop), changed_(std::move(changed)) {}

  [[nodiscard]] Result<RunReadings> measure(const RequestedRun& run) override;
  [[nodiscard]] Result<void> activate(const model::Model& model) override;
  void keep(const InvestigationStep& step) override;

 private:
  void say_doing(std::string text);

  FollowedInvestigation& followed_;
  Workshop& workshop_;
  std::function<void()> changed_;
  std::size_t kept_ = 0;  ///< steps of this investigation
};

struct LedgerRow {
  std::string numbers;      ///< number, minutes, minutes in all, rms, members left; below ledger_numbers_head()
  std::size_t members = 0;  ///< left in the set; 0: nothing is named
  bool settled = false;     ///< one cause is left, or nothing is missing
  std::string measured;
};

struct LedgerView {
  std::vector<LedgerRow> rows;
  std::string set;    ///< "sag:X:EX 0.97, progressive:X:EX 0.03"; what the last verdict is where it is empty
  std::string doing;  ///< empty: nothing
  std::vector<std::string> said;  ///< newest last
};

[[nodiscard]] LedgerView view_of(const InvestigationProgress& progress);

/// The view as lines that fit `columns`, bars as '#'; for a terminal that is redrawn.
[[nodiscard]] std::vector<std::string> lines_of(const LedgerView& view, std::size_t columns);

}  // namespace ecs::commissioning
