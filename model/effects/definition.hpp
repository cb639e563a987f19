// An effect at its place in a machine, as a model holds it, and what the library knows of it: its words, parameters and
// limits, how it acts on readings, at which values it is searched and where it may be a candidate. Each effect is
// defined in a file of its own (<id>.cpp, listed in registry.cpp); algorithms ask for traits, never for an id.
// Does not live here: columns over observations (model/regression/regressors.hpp), model files
// (model/fit/model_file.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/axis.hpp"
#include "model/data/observations.hpp"

namespace ecs::model {

struct EffectDefinition;
struct EffectTraits;

/// Which effect of the library: its definition, compared by identity. Null only before it is set.
using EffectId = const EffectDefinition*;

/// The name of model files, "cyclic". @pre not null
[[nodiscard]] std::string_view name_of(EffectId id);
/// Null where the library has no effect of that name.
[[nodiscard]] EffectId effect_named(std::string_view name);

/// Readings on which an effect with an `approach` acts.
enum class ApproachMode : std::uint8_t { both, forward, reverse };
[[nodiscard]] std::string_view name_of(ApproachMode mode);
[[nodiscard]] std::optional<ApproachMode> approach_mode_named(std::string_view name);

/// One formula of a user effect: its contribution to readings of one sense.
struct UserFormula {
  Sense sense = Sense::EX;
  std::string text;  ///< muParser; variables: parameters and any numeric column of the measurement set
  friend bool operator==(const UserFormula&, const UserFormula&) = default;
};

/// A parameter of a user effect: held where a value is given, else fitted from `start`, inside the range if there is
/// one.
struct UserParameter {
  std::string name;
  std::string unit;
  std::optional<double> value;
  std::optional<double> start;
  std::optional<double> least;
  std::optional<double> greatest;
  friend bool operator==(const UserParameter&, const UserParameter&) = default;
};

/// A fitted curve, to be drawn, kept in the model file and compiled into a map; linear between points.
struct FittedCurve {
  std::vector<double> p_mm;   ///< machine coordinates, ascending
  std::vector<double> value;  ///< um, um/m for angular
  [[nodiscard]] bool empty() const { return p_mm.empty(); }
  friend bool operator==(const FittedCurve&, const FittedCurve&) = default;
};

/// An effect at its place in a machine.
struct EffectInstance {
  EffectId id = nullptr;
  std::optional<Axis> axis;       ///< absent where the effect has none (the whole map)
  std::optional<Sense> sense;     ///< absent for `angular`, `squareness` and the whole map; of a set-up its rotation,
                                  ///< of a location error its first letter: EX of XOC, EA of AOC
  std::optional<Component> code;  ///< of angular, squareness, measurement_line; of a map fault of one component
  bool rotary = false;            ///< `axis` is A, B or C: positions and lengths are in degrees
  ApproachMode approach = ApproachMode::both;
  int ball = 1;           ///< of a ball on the table or a tool: which, in the order of the readings
  int line = 0;           ///< of an offset: 0 in all readings of its sense, 1 in all lines along its axis, n in the nth
  int from_run = 0;       ///< of an offset: acts along its axis in this run and later ones only; 0: in all
  std::string sensor;     ///< column of the sensor, where one is used
  std::string sensor2;    ///< of the second, where their difference is
  std::string name;       ///< of a user effect
  std::string tied_with;  ///< what the data cannot tell it from: names with commas between them
  std::vector<UserFormula> formulas;         ///< of a user effect
  std::vector<UserParameter> user;           ///< of a user effect
  std::map<std::string, double> parameters;  ///< given: held. Absent ones are fitted from the data
  std::map<std::string, double> fitted;      ///< values of the last fit; used where there are no data to fit
  FittedCurve curve;                         ///< of the last fit, for effects that are curves
  /// Present: the readings of the last fit do not determine its values, beside the effects of these names; none: the
  /// readings do not show it.
  std::optional<std::vector<std::string>> undetermined;

  /// @pre id is set
  [[nodiscard]] const EffectDefinition& definition() const { return *id; }
  [[nodiscard]] const EffectTraits& traits() const;
  /// Written by the user as formulas.
  [[nodiscard]] bool is_user() const;
  friend bool operator==(const EffectInstance&, const EffectInstance&) = default;
};

/// The value of a parameter; nothing: it is neither given nor fitted.
[[nodiscard]] std::optional<double> given_or_fitted(const EffectInstance& effect, std::string_view parameter);

/// X, Y, Z; of a rotary axis A, B, C. @pre it has an axis
[[nodiscard]] char axis_letter(const EffectInstance& effect);

/// "cyclic:X:EX", "cyclic:C:EC", "angular:X:ECX", "set_up_rotation:EC", "ball_on_table:2", "map_polarity" (the whole
/// map), "user:encoder tilt".
[[nodiscard]] std::string to_text(const EffectInstance& effect);

/// "cyclic:X:EX, reverse", "thermal_drift:X:EX with t_spindle_degC": the same with approach and sensors.
[[nodiscard]] std::string place_text(const EffectInstance& effect);

/// Sense and code as model files and JSON name them, "" where there is none; the rotation of a set-up is its code.
[[nodiscard]] std::string_view sense_text(const EffectInstance& effect);
[[nodiscard]] std::string_view code_text(const EffectInstance& effect);
/// What `code = "…"` says.
struct Coded {
  std::optional<Axis> axis;  ///< of a location error: the rotary axis
  std::optional<Sense> sense;
  std::optional<Component> code;
};
/// Nothing: no such component, for a set-up no rotation EA, EB, EC, for a location error none such as XOC.
[[nodiscard]] std::optional<Coded> code_named(EffectId id, std::string_view word);
/// Sets it. False: none, or of another axis than the effect has.
[[nodiscard]] bool set_code(EffectInstance& effect, std::string_view word);

/// "t_spindle_degC", "t_front_degC and t_back_degC", "" where no sensor is used.
[[nodiscard]] std::string sensors_text(const EffectInstance& effect);

/// Same cause at the same place; parameters, approach and sensors may differ.
[[nodiscard]] bool same_place(const EffectInstance& a, const EffectInstance& b);
[[nodiscard]] bool same_sensors(const EffectInstance& a, const EffectInstance& b);
/// Same place, approach and sensors; parameters may differ.
[[nodiscard]] bool same_candidate(const EffectInstance& a, const EffectInstance& b);

struct ValueRange {
  double least = 0.0;
  double greatest = 0.0;
};

/// How a parameter that people read follows from the linear coefficients of the fit.
enum class Coding : std::uint8_t {
  coefficient,    ///< neutral value + the next coefficient
  amplitude,      ///< hypot of the next two coefficients, of sine and cosine
  phase,          ///< their atan2; follows its amplitude
  square_root,    ///< root of the next coefficient
  searched,       ///< none: the contribution is not proportional to it
  size_of_curve,  ///< none: root mean square of the fitted curve
  fixed,          ///< none: always 1
};

/// A parameter as model files and JSON name it.
struct ParameterDefinition {
  std::string_view name;
  std::string_view unit;  ///< "" for a pure number
  std::string_view meaning;
  Coding coding = Coding::coefficient;
  std::optional<ValueRange> limits{};  ///< physical range, kept by search and fit; absent: any value
  double neutral = 0.0;                ///< value at which the effect contributes nothing
  bool optional = false;               ///< searched: a model file without it means `neutral`, held
};

/// A parameter with its value from a fit.
struct ParameterEstimate {
  std::string name;  ///< as the library has it
  std::string unit;  ///< of positions on a rotary axis "deg"
  double value = 0.0;
  std::optional<double> sigma;  ///< absent: held, or the data do not determine it
  bool held = false;            ///< the fit does not change it: given in the model file, exact, or without effect
  bool undetermined = false;    ///< another term of the model does the same on these data; value is one of many
  bool is_direction = false;    ///< of an axis line: shown as um_per_m
};

/// A name of the library as model files and JSON show it: of a rotary axis "period_deg" for "period_mm"; of the
/// direction of an axis line "um_per_m" for "um".
[[nodiscard]] std::string shown_name(std::string_view parameter, const EffectInstance& effect);
[[nodiscard]] std::string shown_name(const ParameterEstimate& parameter);
/// A shown name as people read it before its value: "period" of "period_mm", nothing of "um_per_m".
/// @param unit  that follows the value; empty: nothing of the name is left out
[[nodiscard]] std::string spoken_name(std::string_view shown, std::string_view unit);
/// The name of the library for what a model file or JSON shows.
[[nodiscard]] std::string library_name(std::string_view shown, const EffectInstance& effect);
/// Of a parameter at its place: "deg" for "mm" of a rotary axis, "um/m" for "um" in readings of a rotation and of the
/// direction of an axis line.
[[nodiscard]] std::string unit_of(const EffectInstance& effect, const ParameterDefinition& parameter);
/// A location error AO., BO., CO.: in um/m.
[[nodiscard]] bool is_direction(const EffectInstance& effect);

/// What the unit can do about an effect.
enum class Carrier : std::uint8_t {
  error_map,   ///< a table of the error map
  parameters,  ///< a value among the unit's parameters (squareness, polarity, scaling, datum)
  set_up,      ///< nothing to compensate: the measurement or the commissioning is to be put right
  inputs,      ///< thermal rows of the unit that follow its live inputs (core/thermal.hpp)
  none,        ///< varies with something the unit does not see
};

/// What a row of the unit follows for an effect.
enum class LiveSource : std::uint8_t { material, sensor, difference, motion, load };
/// A coefficient of an effect as an error motion of the rotary axis next to the tool.
struct MotionTerm {
  std::string_view parameter;
  Sense sense = Sense::EX;                      ///< in the frame that carries the axis
  double (*shape)(double angle_deg) = nullptr;  ///< of a coefficient of 1
};

/// A coefficient of an effect as a row of the unit.
struct LiveTerm {
  std::string_view parameter;
  ThermalLaw law = ThermalLaw::shift;
  LiveSource source = LiveSource::sensor;
};

/// Which of axis, sense and code an instance has, and so which readings it acts on.
enum class Place : std::uint8_t {
  sense,            ///< readings of `sense`; the axis may be left out: it is the natural one of the sense
  axis_and_sense,   ///< readings of `sense`, by the coordinate of `axis`
  known_component,  ///< as axis_and_sense; `code` names a rotation among [[known]]
  rotation,         ///< `code` EAX … ECZ: every direction in which the terms give it a lever
  squareness,       ///< `code` C0Y, B0Z, A0Z: likewise
  set_up,           ///< `code` EA, EB, EC (kept as the sense): translations across that axis, whichever axis moved
  location,         ///< `code` XOC, AOC … (kept as `sense` and the rotary axis): through the chain of the machine
  artefact,         ///< no axis, sense or code: translations in readings through a chain
  map,              ///< compensated readings, through the tables of the map: all, of one axis or of one component
  formulas,         ///< the senses of the user's formulas
};

/// Facts by which search, fit, planning and words treat effects; each says what follows from it.
struct EffectTraits {
  // what is fitted
  bool is_curve = false;     ///< smooth functions of rising roughness, as many as the evidence asks for
  bool keeps_mean = false;   ///< of a curve: its mean is no other effect and comes first among its columns
  bool keeps_slope = false;  ///< of a curve: its slope is no other effect and comes next
  bool fixed_size = false;   ///< no coefficient: the data say yes or no
  bool has_lag = false;      ///< its searched parameter is the time constant with which it follows its sensors
  bool periodic = false;     ///< sines and cosines of its searched parameter; searched in frequency
  // what it looks like
  bool of_approach = false;        ///< acts only on readings of known approach of its own moving axis
  bool shape_of_position = false;  ///< free shape over one axis: three together follow any curve
  bool is_smooth = false;          ///< bends slowly over the travel
  bool adds_up = false;            ///< of a rotary axis: is not the same again after a whole turn
  bool is_drift = false;           ///< changes in time, the same at all positions: three together follow any drift
  bool of_condition = false;       ///< its size depends on a condition that a run can set
  bool in_motion = false;          ///< shows only in readings taken on the fly
  bool shows_at_zero = false;      ///< shows at the place where the readout was zeroed
  bool of_lines = false;           ///< may act in the lines along its axis only, or in one of them
  bool until_new_set_up = false;   ///< ends when the optics are aligned and reset again (column `set_up`)
  bool of_measurement = false;     ///< the readings show it, the machine does not have it
  bool from_origin = false;        ///< counts time or a temperature from Observations::origin
  // how often it can be there
  bool is_usual = false;       ///< every measured line has it: part of a new model
  bool one_per_axis = false;   ///< may act in a sense once for each axis; else once, whatever the axis
  bool several_alike = false;  ///< may act several times at one place
  // of which axes it is an error
  bool on_rotary_axes = false;  ///< of A, B, C too

  /// Of optics set up for a line: no bar of a circle and no diagonal has it.
  [[nodiscard]] bool of_optics() const { return until_new_set_up && of_measurement; }
};

/// What data must have for an effect to act.
enum class Need : std::uint8_t {
  time,
  sensor,
  two_sensors,
  material_temperature,
  air,
  feed,
  speed,
  load,
  travel_since_reversal,
  time_since_reversal,
  reversed,
  known
};

/// Targets from which a curve over a line is looked for: ISO 230-2:2014 asks for five a line at least.
inline constexpr std::size_t kFewestCurveTargets = 5;
/// And a wave, which has a size, a phase and a period beside the zero and the slope of the line.
inline constexpr std::size_t kFewestWaveTargets = 6;

/// What an effect looks like at a limit of a searched parameter or of its data.
enum class Limit : std::uint8_t { at_least, at_greatest, tied_to_runs };
struct Becomes {
  Limit limit = Limit::at_greatest;
  std::string_view effect;  ///< id
};

/// The measurement that confirms an effect or separates it from its rivals.
struct SeparatingMeasurement {
  int precedence = 100;         ///< among rivals the one with the least is proposed
  std::string_view sentence;    ///< fmt; {axis}: the letter, {tenth}: a tenth of the period with its unit
  bool also_for_rivals = true;  ///< false: only where the effect itself is the first candidate
};

/// Readings on which an effect acts.
struct Acting {
  std::vector<std::size_t> rows;      ///< of Observations::motions(), ascending
  std::vector<std::size_t> readings;  ///< those made up of them, ascending; without paths the same
  std::size_t skipped = 0;            ///< readings on which it would act, but the row lacks a cell
  std::string lacking;                ///< the column that is missing, "" if none
};

/// One reading, for a contribution. @pre the effect acts on it
struct ReadingAt {
  const Observations& data;
  std::size_t k = 0;  ///< canonical order
  const EffectInstance& effect;
  double searched = 0.0;                ///< value of the searched parameter
  std::span<const double> late_degC{};  ///< per reading, of an effect that may follow its sensors late

  /// Coordinate of the effect's axis from the datum; 0 where it has none.
  [[nodiscard]] double p_mm() const { return effect.axis ? data.p_mm(k, *effect.axis) : 0.0; }
  [[nodiscard]] double p_m() const { return p_mm() / 1000.0; }
  /// Of the effect's axis.
  [[nodiscard]] double approach() const {
    return data.through_chain.empty() ? data.approach[k] : data.approach_of(k, *effect.axis);
  }
};

/// Values at which a searched parameter is tried: fine enough not to step over anything, facts of the machine apart.
struct TriedValues {
  std::vector<double> values;
  std::vector<double> facts{};  ///< suggested by the machine
  double independent = 1.0;     ///< about how many of the values are different trials
  std::optional<double> far{};  ///< values below are far from likely: only where nothing else makes the model fit
};

/// How far a search goes.
struct SearchExtent {
  std::size_t most = 0;      ///< values at the utmost
  bool is_of_model = false;  ///< a term of the user's model: it is there, however unlikely its value
};

/// Where the single nonlinear parameter of an effect is sought.
struct SearchDefinition {
  TriedValues (*tried)(const Observations& data, const EffectInstance& effect, const Acting& acting,
                       const SearchExtent& extent) = nullptr;
  /// Value to plan with where neither the model nor a fit gives one. @param plan  readings still to be taken
  double (*assumed)(const Observations& plan, const EffectInstance& effect, const Acting& acting) = nullptr;
  /// Range in which a search or a fit that begins at `start` keeps it; beyond, the effect is another one
  /// (`turns_into`). Null: any value of the sign of the start.
  ValueRange (*limits)(const Observations& data, const EffectInstance& effect, const Acting& acting,
                       double start) = nullptr;
  bool has_slope = true;     ///< the contribution has a derivative in it
  bool either_sign = false;  ///< a fit may take it through 0
};

/// A sense and an axis of a data set at which candidates are sought.
struct Site {
  const Observations& data;
  Sense sense = Sense::EX;
  Axis axis = Axis::X;
  std::size_t places = 0;        ///< different coordinates of the axis in readings of the sense
  bool any_axis_varies = false;  ///< some coordinate varies in readings of the sense

  [[nodiscard]] bool is_positioning() const { return !is_rotation(sense) && direction_of(sense) == axis; }
  /// Readings of a translation across the axis.
  [[nodiscard]] bool is_across() const { return !is_rotation(sense) && direction_of(sense) != axis; }
  /// One instance here (its `id` is set by the caller), or none.
  [[nodiscard]] std::vector<EffectInstance> once(bool worth_trying = true) const;
  /// One instance on each line of the sense along the axis but the first; none of readings along paths.
  [[nodiscard]] std::vector<EffectInstance> on_further_lines() const;
};
using CandidatesAt = std::vector<EffectInstance> (*)(const Site& site);

/// One cause. Functions may be null where the effect has no such part.
struct EffectDefinition {
  std::string_view id;           ///< "cyclic"
  std::string_view title;        ///< "Periodic error"
  std::string_view formula;      ///< contribution to a reading, as printed in the manual
  std::string_view cause;        ///< physical cause, plain words
  std::string_view tells_apart;  ///< what tells it from its neighbours
  std::string_view check;        ///< what to look at on the machine or its set-up, without another run of the laser
  /// fmt; what is wrong, how much and where, as an answer begins: parameters by name, with unit; {where}, {readings},
  /// {slope}, {axis}, {code}, {pair}, {turn}, {map}, {sensor}, {sensor2}, {name}, {sizes} (model/diagnosis/words.cpp).
  std::string_view headline;
  std::vector<ParameterDefinition> parameters{};
  Carrier carrier = Carrier::none;
  std::vector<LiveTerm> live{};  ///< of Carrier::inputs
  std::vector<MotionTerm> motions{};
  /// Its parameters in their order are the sizes of bending that a map has beside its curves.
  std::array<double, 6> RotaryBending::*bending = nullptr;
  std::string_view how{};  ///< how the unit compensates it, or why it cannot
  SeparatingMeasurement separated_by{};
  std::vector<Becomes> turns_into{};

  EffectTraits traits{};
  Place place = Place::axis_and_sense;
  std::vector<Need> needs{};
  int preference = 0;  ///< among effects that do equally well the one with the least is named first

  // Contribution to a reading = columns · coefficients, or the fixed part, in um (um/m in readings of a rotation).
  void (*columns)(const ReadingAt& at, std::span<double> row) = nullptr;
  /// In place of `columns` where only position and searched parameter matter; `row` may be shorter than all columns.
  void (*columns_of_place)(double p_mm, double searched, std::span<double> row) = nullptr;
  double (*fixed_part)(const ReadingAt& at) = nullptr;    ///< of an effect of fixed size
  double (*curve_factor)(const ReadingAt& at) = nullptr;  ///< what the curve is multiplied by
  /// Columns that may be used together; empty: all. The second where the axis is not the natural one of the sense.
  std::vector<std::vector<std::ptrdiff_t>> column_sets{};
  std::vector<std::vector<std::ptrdiff_t>> column_sets_elsewhere{};
  SearchDefinition search{};

  // Where it may be a candidate; `needs` are met already.
  CandidatesAt of_sense = nullptr;     ///< once a sense, at its natural axis
  CandidatesAt along_axis = nullptr;   ///< for each axis whose coordinate varies
  CandidatesAt of_reversal = nullptr;  ///< for each axis that was moved both ways

  /// Name of its searched parameter, "" if it has none.
  [[nodiscard]] std::string_view searched_parameter() const;
  /// Number of linear coefficients; of a curve 0.
  [[nodiscard]] std::size_t column_count() const;
  /// Physical range of linear coefficient j, from the limits of its parameter; nothing: any value.
  [[nodiscard]] std::optional<ValueRange> coefficient_range(std::size_t j) const;
  [[nodiscard]] bool has_need(Need need) const;
  /// Acts where people set feed, load or the map, from one run to the next: that it coincides with runs is no fault.
  [[nodiscard]] bool is_set_by_hand() const {
    return has_need(Need::feed) || has_need(Need::load) || place == Place::map;
  }
  /// Columns of a curve that come before its smooth functions: mean and slope, or what it keeps of them.
  [[nodiscard]] std::size_t leading_columns() const {
    return static_cast<std::size_t>(traits.keeps_mean) + static_cast<std::size_t>(traits.keeps_slope);
  }
  /// The unit can compensate it.
  [[nodiscard]] bool is_carried() const {
    return carrier == Carrier::error_map || carrier == Carrier::parameters || carrier == Carrier::inputs;
  }
  /// Acts through a lever or an angle between axes: has a code and no sense.
  [[nodiscard]] bool has_lever() const { return place == Place::rotation || place == Place::squareness; }
};

/// All effects, in the order in which they are listed; effects of the user last.
[[nodiscard]] const std::vector<EffectDefinition>& effect_library();

/// The effect at places of this kind. @pre one effect of the library is
[[nodiscard]] EffectId effect_at(Place place);

/// A location error, an error motion of a rotary axis, a sum of such or bending of a head: what the rotary axes of a
/// map can hold.
[[nodiscard]] bool is_rotary_error(const EffectInstance& effect);
/// Why a unit at that machine compensates no error of a rotary axis; empty: it can.
[[nodiscard]] std::string rotary_axes_refused(const params::Machine& machine);

/// The unit can compensate it on that machine: along an axis that it has, and with the inputs that its file names.
/// @param machine  without axes: not known
[[nodiscard]] bool is_carried(const EffectInstance& effect, const params::Machine& machine);
/// The axis whose motion stands for the heat of the machine: the effect's own, else the first that the file names.
[[nodiscard]] std::optional<Axis> live_motion_of(const EffectInstance& effect, const params::Machine& machine);
/// Why an offset or slope of a further line, or from a later run on, says nothing of the machine: it is a zero of the
/// readout, or the alignment of the optics; "" of every other effect.
[[nodiscard]] std::string_view not_of_machine(const EffectInstance& effect);
/// The readings have it and the machine does not: by its definition, or such an offset or slope.
[[nodiscard]] bool is_of_measurement(const EffectInstance& effect);
/// The sensor of the scale or workpiece.
inline constexpr std::string_view kMaterialSensor = "t_material_degC";
/// How the unit compensates it, or why it cannot.
[[nodiscard]] std::string how_compensated(const EffectInstance& effect, const params::Machine& machine);

inline const EffectTraits& EffectInstance::traits() const { return definition().traits; }
inline bool EffectInstance::is_user() const { return definition().place == Place::formulas; }

}  // namespace ecs::model
