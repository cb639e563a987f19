// Models, fits and diagnoses as answers: text of 80 columns and JSON with the names of docs/verbs.md, values with
// sigmas, tests, shapes, the ladder; the diagnosis, headline first; what the library says of an effect. Measured lines
// of a data set, and how their points look, shared by pictures in files and on the terminal.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/answer_table.hpp"
#include "base/json_fwd.hpp"
#include "commissioning/plot/figure.hpp"
#include "core/axis.hpp"
#include "model/data/observations.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/compare.hpp"
#include "model/fit/fit.hpp"
#include "model/fit/model_file.hpp"

namespace ecs::commissioning {

/// Readings of one sense along one axis with the others parked at one place, or those along one path.
struct MeasuredLine {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  Vector3 parked_mm{};
  bool rotary = false;            ///< the axes are A, B, C
  std::string path{};             ///< "circle XY"; "": along the axis
  std::vector<std::size_t> rows;  ///< canonical order of the observations
};
/// By sense, axis and parked place; then the paths.
[[nodiscard]] std::vector<MeasuredLine> measured_lines(const model::Observations& data);
/// "EX along X at Y -700"
[[nodiscard]] std::string title_of(const MeasuredLine& line);

/// Where each reading lies: the coordinate of the axis [mm, machine coordinates, or deg], on a path the place along it.
[[nodiscard]] std::vector<double> places_along(const model::Observations& data, Axis axis);
/// "X position [mm]", "angle_deg"
[[nodiscard]] std::string label_along(const model::Observations& data, const MeasuredLine& line);

/// Points without a line, by approach (1, -1, 0 unknown).
[[nodiscard]] Mark reading_mark(int approach);
/// Lines, by approach.
[[nodiscard]] Mark line_mark(int approach);

/// A number of about `digits` significant digits, never in a form that people must decode.
[[nodiscard]] std::string few_digits(double value, int digits = 3);

/// To a thousandth, without needless zeros.
[[nodiscard]] std::string position_text(double mm);

/// "8.0003 +- 0.0012 mm", digits as far as the sigma goes; "12.5 um (fixed)"; "not determined by
/// these data".
[[nodiscard]] std::string value_text(const model::ParameterEstimate& parameter);

/// "period 8.0003 +- 0.0012 mm, amplitude 6.51 +- 0.05 um (k = 1)"; without those that are nothing.
[[nodiscard]] std::string parameters_text(const std::vector<model::ParameterEstimate>& parameters);

/// "rms [um]", of other readings "rms um/m", "[um,um/m]": a heading of nine columns at most.
[[nodiscard]] std::string rms_heading(std::string_view unit);
/// Unit of the readings that the effects of a model act on, as Observations::reading_unit().
[[nodiscard]] std::string_view unit_of_model(const model::Model& model);

/// "1.234 um"; of readings in both units "1.234 um and 5.678 um/m". @param all  over all readings, of this unit
[[nodiscard]] std::string in_each_unit(double all, const model::SizesByUnit& each, std::string_view unit);
/// Of readings in both units a size by its name in each: {"um": {"rms": …, …}, "um/m": …}; of one unit no key
/// `by_unit`.
void add_by_unit(Json& answer, std::string_view unit,
                 const std::vector<std::pair<std::string, model::SizesByUnit>>& sizes);
/// "parameters well separated (condition number 3.2)"
[[nodiscard]] std::string separation_text(double condition);
/// "0.52 um from repeats"
[[nodiscard]] std::string noise_text(const model::PureError& noise);

/// "Scale error" of positions, "Slope (squareness or alignment)" of straightness, "Slope" of an angle: title of an
/// effect of one parameter along its own axis, else the meaning of that parameter.
[[nodiscard]] std::string title_of(const model::EffectInstance& effect);

/// A property of a residual (model::LeftProperty) as an engineer asks for it: "over the position" of "position".
[[nodiscard]] std::string words_for_property(const std::string& property);
/// What it is, in words: "different in each run" of "session" and "run".
[[nodiscard]] std::string words_for_answer(const std::string& property, const std::string& is);

/// "forward", "reverse", "no approach"
[[nodiscard]] std::string_view direction_text(int approach);

/// One point of a shape, such as the mean residual of a bin.
struct ShapePoint {
  double at = 0.0;
  double um = 0.0;
};
/// A bar to either side of zero for each point, at most twelve of them (neighbours are averaged).
/// @param unit  of the readings
/// @param senses  of the readings, where the data have several; the chart shows their mean
[[nodiscard]] std::string shape_text(const std::string& variable, const std::vector<ShapePoint>& points,
                                     std::string_view unit, const std::vector<std::string>& senses = {});

/// "3, 17, 250 and 12 more"
[[nodiscard]] std::string rows_text(const std::vector<int>& rows, std::size_t most = 20);

/// Smaller than the noise of one reading, as a fit leaves it; far below it is another matter.
[[nodiscard]] inline bool is_just_below(double rms_um, double noise_um) {
  constexpr double kFar = 0.8;  // a choice
  return rms_um < noise_um && rms_um > kFar * noise_um;
}
/// Below a table with such an rms.
inline constexpr std::string_view kBelowNoise =
    "an rms a little below the noise is no mistake: the noise is an estimate, and the fit uses up degrees of freedom";

/// The ladder: step, effect, rms, peak, noise floor, held-out rms; the file of each step where they differ.
[[nodiscard]] Cell ladder_cell(const model::Model& model);

/// Paragraphs "note: …".
[[nodiscard]] std::string notes_text(const std::vector<std::string>& notes);

/// A variable with a smaller share of the residual variance gets no picture of its own.
inline constexpr double kWorthAShape = 0.1;
/// Its bars are shown from this many times the noise: below it only the sign changes with something else. A choice.
inline constexpr double kWorthABar = 0.3;

/// Pictures of variables in one answer.
inline constexpr std::size_t kMostShapes = 2;

[[nodiscard]] Cell comparison_cell(const model::Comparison& comparison, std::size_t readings);

/// "< 0.5 %" where no replicate of noise looks as good, "3.2 %", "-" where it has no meaning: the effect alone explains
/// nothing that noise would not.
[[nodiscard]] std::string chance_text(const model::Candidate& candidate, const model::Diagnosis& diagnosis);

/// The formula that is proposed, how it is added, and the fall to expect; "" where there is none.
[[nodiscard]] std::string formula_text(const model::Diagnosis& diagnosis);

/// JSON as docs/verbs.md has it; text of 80 columns.
[[nodiscard]] Cell diagnosis_cell(const model::Diagnosis& diagnosis);
[[nodiscard]] std::string diagnosis_text(const model::Diagnosis& diagnosis);

/// {"effect", "axis", "sense", "approach", "code", "sensor", "name"}, and "sensor2" where one applies; absent parts
/// null; `name` is "cyclic:X:EX".
[[nodiscard]] Json effect_json(const model::EffectInstance& effect);
/// The same place out of such an object; only "effect" must be there. Nothing where that is no effect of the library.
[[nodiscard]] std::optional<model::EffectInstance> effect_in(const Json& object);

/// {"F", "p"}, or null without repeats; "the model is not rejected at 1 % (p = 0.4)", "too few repeats to judge".
[[nodiscard]] Cell lack_of_fit_cell(const std::optional<model::LackOfFit>& test);
/// The same as text beside the rms of the residual, which the test may not see. @param rms_um  0: not compared
[[nodiscard]] std::string lack_of_fit_text(const std::optional<model::LackOfFit>& test, double rms_um, double noise_um);
/// name, unit, value, sigma, held, undetermined; the text of a value has as many digits as its sigma has meaning for.
[[nodiscard]] AnswerFields fields_of(const model::ParameterEstimate& parameter);
/// @param layout  of each; {label}: its name in words
[[nodiscard]] Cell parameters_cell(const model::EffectFit& effect, std::string_view layout = {});
/// {"p_mm", "value"}
[[nodiscard]] Json curve_json(const model::FittedCurve& curve);
/// A number that is not finite is null.
[[nodiscard]] Json numbers_json(const std::vector<double>& values);

/// The text to a thousandth.
[[nodiscard]] Cell position_cell(double position_mm);
/// Columns of a position in a table, "{x_mm:>10} {y_mm:>10} {z_mm:>10}", and what belongs there.
[[nodiscard]] std::string position_layout(bool rotary);
void add_position(AnswerFields& fields, const Vector3& position_mm, bool rotary);
/// {"x_mm", "y_mm", "z_mm"}; of rotary axes {"a_deg", "b_deg", "c_deg"}
[[nodiscard]] Json position_json(const Vector3& position_mm, bool rotary = false);
[[nodiscard]] std::string axis_json(Axis axis, bool rotary = false);

/// "error map", "parameters", "remove the cause", "no": what carries the compensation.
[[nodiscard]] std::string_view carrier_text(model::Carrier carrier);

/// "cause: lost motion in the drive"
struct EffectFact {
  std::string label;
  std::string text;
};
/// Formula, cause, what distinguishes it, how it is compensated.
[[nodiscard]] std::vector<EffectFact> facts_of(const model::EffectDefinition& effect);

/// A candidate opened: its facts, its values, what else it could be, what to check at the machine.
[[nodiscard]] std::vector<EffectFact> details_of(const model::Candidate& candidate);

/// The numbers of the proof, each with the word "holds" or "fails".
[[nodiscard]] std::vector<EffectFact> evidence_of(const model::Candidate& candidate, const model::Diagnosis& diagnosis);

/// "cyclic:X:EX (or servo_lag:X:EX)": with what the data could not tell it from when it was added.
[[nodiscard]] std::string name_with_alternatives(const model::EffectInstance& effect);
/// The same for an effect of `model` by its name, to_text(); a name that the model lacks stays as it is.
[[nodiscard]] std::string name_with_alternatives(const model::Model& model, const std::string& name);
/// Errors of the measurement among what the data could not tell an effect from, "cosine:X:EX or air_refraction:X:EX";
/// "" where there is none.
[[nodiscard]] std::string measurement_alternatives(const model::EffectInstance& effect);
/// What compensating an effect costs if it is such an error.
/// @param amount  of it, "11.2 um rms"  @pre measurement_alternatives() are there
[[nodiscard]] std::string cost_if_of_measurement(const model::EffectInstance& effect, const std::string& amount);
/// Keeps the alternatives with the effect, in model files too. Empty: it is decided. @pre no effect of the user
void keep_alternatives(model::EffectInstance& effect, const std::vector<model::EffectInstance>& alternatives);

/// The place of an effect by its name, "cyclic:X:EX". A `usage` problem names those that there are.
[[nodiscard]] Result<std::size_t> effect_in(const model::Model& model, const std::string& name);

/// The model without that effect, refitted, with a step more on its ladder.
struct WithoutEffect {
  model::Model model;
  model::Fit fit;
  std::string name;
  double rms_before_um = 0.0;
};
/// Refused where it is the only one. @param before  the fit with it
[[nodiscard]] Result<WithoutEffect> without_effect(const model::Model& model, const model::Observations& data,
                                                   std::size_t effect, const model::Fit& before,
                                                   const std::string& data_name);

}  // namespace ecs::commissioning
