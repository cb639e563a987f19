// What to measure next: the run that tells rivals apart best per minute, and whether a planned set can determine a
// model at all. Does not live here: the diagnosis that leaves the rivals (model/diagnosis/diagnose.hpp), the same run
// as a part program (questions.hpp).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "model/diagnosis/diagnose.hpp"

namespace ecs::model {

/// How far a run separates one explanation, if true, from the best that the model with another can do.
struct PairSeparation {
  std::string truth;
  std::string rival;   ///< empty: the model as it is
  double sigma = 0.0;  ///< that the run adds to what the present readings say
};

/// The condition of a run that differs by that.
inline constexpr const char* kTurnedOver = "with the square or straight edge turned over";

/// Between two runs on a line the machine is warmed, the axis moved over its targets with the spindle turning, and
/// after the warmest run left to cool: what grows, shifts or bends with temperature shows beside one zero of the
/// readout.
struct Warming {
  int runs = 0;          ///< so many runs after the first begin warmer than the one before; later ones cooler
  double minutes = 0.0;  ///< before each run after the first
  double feed_mm_min = 6000.0;
  double spindle_rpm = 3000.0;
};

/// Readings of one ball by one tool while the rotary axes turn and X, Y, Z follow.
struct BallSet {
  /// One axis from target to target, there and back, the other one parked.
  struct Sweep {
    Axis axis = Axis::X;              ///< A, B or C
    std::vector<double> targets_deg;  ///< ascending
    Vector3 parked_deg{};
  };
  std::vector<Sweep> sweeps;
  Vector3 place_mm{};                    ///< of X, Y, Z at the ball, rotary axes at 0
  Vector3 tool_mm{};                     ///< from the tool reference point to the ball or probe in the spindle
  std::vector<laser::Reading> readings;  ///< of one run in order, every sense; their `error` means nothing
  std::string why;                       ///< what this set shows that the present one does not, a sentence
  /// Side from which A, B, C come to the first pose (1: from below), as their lost motion follows from the order of the
  /// readings so far and these.
  PerAxis<int> side{1, 1, 1};
};

/// One run as a person sets it up. Positions in machine coordinates.
struct MeasurementProposal {
  std::string condition;  ///< what differs from the present set-up, in words: "with the present set-up", "at a quarter
                          ///< of the feed", …
  Axis axis = Axis::X;    ///< moving
  Sense sense = Sense::EX;
  std::vector<double> targets_mm;  ///< ascending
  Vector3 parked_mm{};             ///< of the other axes; 0 for the moving one
  /// A circle of a ball bar in place of a line (model/data/path.hpp), a reading every this many degrees: axis and sense
  /// are of its first axis, there are no targets, and a run is a turn counter-clockwise and one clockwise.
  std::optional<Path> circle{};
  double circle_step_deg = 1.0;
  std::optional<BallSet> ball{};  ///< in place of a line: axis is the rotary one that tilts, there are no targets
  bool bidirectional = true;
  bool at_present_targets = false;  ///< those of the readings; the overrun may have moved the outermost
  bool ends_moved = false;          ///< the outermost inwards, so that the overrun stays within the travel
  int approach = 1;                 ///< of the first pass; of every pass where not bidirectional
  double overrun_mm = 5.0;          ///< motion in the sense of approach before the first target of a pass, at least
  bool short_overrun = false;       ///< that much before every target, after a reversal (pilgrim step)
  int runs = 1;
  std::optional<Warming> warming{};  ///< absent: one run begins when the one before ends
  int first_run = 1;                 ///< number of the first run, so that the run can join the present readings
  double feed_mm_min = 2000.0;
  std::optional<double> second_feed_mm_min;                      ///< all runs once more at this feed
  double dwell_s = 2.0;                                          ///< at a target before the reading; 0: on the fly
  double trigger_s = 1.0;                                        ///< between M08 and M09
  int set_up = 1;                                                ///< number of the optical set-up, column `set_up`
  bool new_set_up = false;                                       ///< optics aligned and reset again for this run
  bool other_line = false;                                       ///< the other axes stand elsewhere than now
  bool own_zero = false;                                         ///< the readout is set to zero at its first target
  std::map<std::string, double, std::less<>> temperatures_degC;  ///< to measure at, by sensor column
  std::optional<double> pressure_hPa, humidity_pct, load_kg;
  std::optional<bool> compensated;    ///< absent: no map is known
  bool against_square = false;        ///< an indicator against a square nulled along the axis of the sense
  std::optional<bool> reversed;       ///< the artefact turned over, column `reversed`; absent: the data have none
  double wait_minutes = 0.0;          ///< until the condition holds
  double set_up_minutes = 5.0;        ///< work before the first reading
  double minutes = 0.0;               ///< everything
  double separation_sigma = 0.0;      ///< that the group is sure to lose a member by, from the best mimicking
  std::vector<PairSeparation> pairs;  ///< none where the run is a repetition, which separates nothing on its own
  std::string tells;                  ///< what it separates and how surely, and how long it takes
  std::string sentence;               ///< what to do
};

/// "Nothing is in doubt …" where one cause is proved and named and neither another effect nor another value of its
/// parameters fits these data as well: no measurement would tell more.
[[nodiscard]] std::optional<std::string> nothing_in_doubt(const Diagnosis& diagnosis);

/// What work takes; the defaults are those of a machine shop with a laser interferometer: choices, of which the ratios
/// decide the order of proposals.
struct MeasuringTimes {
  double rapid_mm_min = 6000.0;
  double start_minutes = 5.0;              ///< same line again
  double line_minutes = 25.0;              ///< optics moved to another line
  double align_minutes = 15.0;             ///< beam aligned and reset again
  double load_minutes = 20.0;              ///< load put on or taken off
  double map_minutes = 2.0;                ///< compensation switched
  double warm_minutes_per_degC = 15.0;     ///< by moving the axes
  double room_minutes_per_degC = 45.0;     ///< the workshop and all in it
  double cold_minutes = 600.0;             ///< overnight
  double weather_minutes = 1440.0;         ///< another day
  double least_degC = 15.0;                ///< sensible range for machine and workshop
  double greatest_degC = 30.0;             ///<
  double greatest_feed_mm_min = 10'000.0;  ///<
  double circle_minutes = 15.0;            ///< ball bar set up for another circle
  double ball_minutes = 15.0;              ///< ball moved to another place
  double tool_minutes = 10.0;              ///< tool or probe changed and its length measured
  double pose_s = 15.0;                    ///< from one pose of the rotary axes to the reading at the next
  bool ball_bar = false;                   ///< one is at hand; where circles are measured already it is
  bool zeroed_each_run = false;            ///< the readout is set to zero at the start of each run
};

/// Sigmas beyond which more does not tell more.
inline constexpr double kEnoughSigma = 8.0;

/// Proposals, best separation per minute first; empty where nothing separates (said in `notes`, with the reason).
struct NextMeasurement {
  std::vector<std::string> rivals;  ///< what is to be distinguished
  std::vector<MeasurementProposal> proposals;
  std::vector<std::string> notes;
};

/// Runs along lines, and circles where a ball bar is at hand; after readings of a ball sets of a ball. For the first
/// group of rivals; for a lone cause its confirmation; for `unexplained_structure` the variables that the residual may
/// depend on; for `adequate` the alternatives that the model keeps, else the causes that could be there unseen.
/// @param data  what `diagnosis` was made from
[[nodiscard]] NextMeasurement next_measurement(const Model& model, const Observations& data, const Diagnosis& diagnosis,
                                               const MeasuringTimes& times = {});

/// What to measure after a diagnosis, the same in every answer: next_measurement(), or no proposal and a note where
/// nothing_in_doubt(), with the step that follows: compensate and confirm, or why the unit cannot. Named candidates and
/// their rivals that the first proposal decides between take its sentence as Candidate::next_measurement, in place of
/// the advice of their effect.
[[nodiscard]] NextMeasurement planned_next(const Model& model, const Observations& data, Diagnosis& diagnosis,
                                           const MeasuringTimes& times = {});

/// Whether readings at the rows of `plan` (their values do not count) determine the model.
struct PlanCheck {
  std::vector<EffectFit> effects;  ///< parameters with the sigma to expect
  double condition = 1.0;          ///< of the scaled problem
  std::vector<std::string> undetermined;
  std::vector<std::string> assumed;  ///< values taken for nonlinear parameters and sizes that the model does not give
  bool determines = false;
};
/// @param noise_um  standard deviation of one reading to expect, above 0
[[nodiscard]] Result<PlanCheck> check_plan(const Model& model, const Observations& plan, double noise_um);

}  // namespace ecs::model
