// `ecs model effects`: the effect library, or one effect explained. `new`: a model to begin with, of what every
// measured curve has. `predict`: the predictions of a model at given places.

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/text.hpp"
#include "commissioning/measurements/files.hpp"
#include "commissioning/models/view.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/session/commands.hpp"
#include "laser/writers/writers.hpp"
#include "model/diagnosis/support.hpp"
#include "model/effects/definition.hpp"

namespace ecs::app {
namespace {

using model::EffectDefinition;
using model::ParameterDefinition;

Cell parameter_cell(const ParameterDefinition& parameter) {
  const auto& limits = parameter.limits;
  const AnswerFields fields = described(
      "name"_is(parameter.name),
      "unit"_is(parameter.unit, parameter.unit.empty() ? std::string() : fmt::format(" [{}]", parameter.unit)),
      "least"_is(limits ? Cell{limits->least, fmt::format(", {} to ", shortest(limits->least))} : null_cell()),
      "greatest"_is(limits ? Cell{limits->greatest, shortest(limits->greatest)} : null_cell()),
      "searched"_is(parameter.coding == model::Coding::searched, " (found by trial)", ""),
      "meaning"_is(parameter.meaning));
  return {object_of(fields),
          paragraph(laid_out("parameter:    {name}{unit}: {meaning}{least}{greatest}{searched}", fields), 2, 16)};
}

std::string label_before(std::string_view label) { return fmt::format("{:<14}", fmt::format("{}: ", label)); }

constexpr std::string_view kSymbols =
    "In the formulas p is the position, d the approach (+1 forward, -1 reverse), t the time and v the speed. m is the "
    "load, dn the change of the refractive index of air, u the travel since the last reversal, L a lever arm and s(p) "
    "a "
    "curve. b is an angle in effects of rotary axes, T a temperature in effects of heat. Other letters are fitted.";

AnswerFields fields_of(const EffectDefinition& effect) {
  Cell parameters = list_cell(effect.parameters, parameter_cell);
  std::map<std::string, std::string> facts;
  for (const commissioning::EffectFact& fact : commissioning::facts_of(effect))
    facts[fact.label] = paragraph(label_before(fact.label) + fact.text, 2, 16);
  return described("effect"_is(effect.id), "title"_is(effect.title), "formula"_is(effect.formula, facts["formula"]),
                   "cause"_is(effect.cause, facts["cause"]),
                   "tells_apart"_is(effect.tells_apart, facts["distinguished by"]),
                   "check"_is(effect.check, facts["check"]), "parameters"_is(std::move(parameters)),
                   "of_approach"_is(effect.traits.of_approach,
                                    "  acts only on readings of its own moving axis with known approach\n", ""),
                   "carrier"_is(commissioning::carrier_text(effect.carrier)), "compensated"_is(effect.is_carried()),
                   "how"_is(effect.how, facts["compensated"]));
}

Result<Outcome> one_effect(const std::string& name) {
  const model::EffectId id = model::effect_named(name);
  if (id)
    return outcome_of(
        record_cell("{effect}: {title}\n{formula}{cause}{tells_apart}{check}{parameters}{of_approach}{how}" +
                        paragraph(std::string(kSymbols)),
                    fields_of(*id)));
  std::vector<std::string> names;
  for (const EffectDefinition& effect : model::effect_library()) names.emplace_back(effect.id);
  const std::string like = nearest_word(name, names);
  return problem(ProblemKind::usage, "no effect \"{}\"{} There are {}", name,
                 like.empty() ? "." : fmt::format("; did you mean \"{}\"?", like), fmt::join(names, ", "));
}

/// A formula that is wider than its column continues below.
std::string row_of(const EffectDefinition& effect) {
  constexpr std::size_t kFormula = 42;
  std::string text, formula(effect.formula);
  for (bool is_first = true; is_first || !formula.empty(); is_first = false) {
    const std::size_t end = formula.size() <= kFormula ? formula.size() : formula.rfind(' ', kFormula);
    const std::string_view carrier =
        effect.carrier == model::Carrier::none ? "not by the unit" : commissioning::carrier_text(effect.carrier);
    text += is_first ? fmt::format("{:<19} {:<42} {}\n", effect.id, formula.substr(0, end), carrier)
                     : fmt::format("{:<20}  {}\n", "", formula.substr(0, end));
    formula = end < formula.size() ? formula.substr(end + 1) : "";
  }
  return text;
}

struct EffectsRequest {
  std::string name, machine;
  static Fields<EffectsRequest> fields() {
    using R = EffectsRequest;
    return {{"EFFECT", &R::name, "effect to explain"},
            {"--machine", &R::machine, "ignored here, since the library is the same for all machines"}};
  }
};

Result<Outcome> effects(VerbContext&, const EffectsRequest& request) {
  if (!request.name.empty()) return one_effect(request.name);
  Cell all{Json::array(), fmt::format("{:<19} {:<42} {}\n", "effect", "contribution to a reading", "remedy")};
  for (const EffectDefinition& effect : model::effect_library())
    all.add({object_of(fields_of(effect)), row_of(effect)});
  return outcome_of(
      record_cell("{effects}" + paragraph(std::string(kSymbols)) +
                      "`ecs model effects NAME` explains one. Thermal rows are the part of a map that follows\n"
                      "temperatures, load and motion; `ecs utility inputs` shows them\n",
                  "effects"_is(std::move(all))));
}

struct NewRequest {
  ModelArguments common;
  static Fields<NewRequest> fields() {
    using R = NewRequest;
    return {&R::common};
  }
};

Result<Outcome> begin(VerbContext& context, const NewRequest& given) {
  const ModelArguments& request = given.common;
  ECS_TRY(work, begun_model(context.console, request));
  Cell effects{Json::array(), {}};
  std::string brackets;
  for (const model::EffectInstance& effect : work.model.effects) {
    const std::string name = name_with_alternatives(effect);
    if (!effect.tied_with.empty()) brackets = "An effect in brackets would give the same readings at these places.\n";
    effects.add({name, fmt::format("  {} {}\n", padded(name, 26), title_of(effect))});
  }
  std::vector<std::string> next{"ecs", "model", "diagnose", request.model};
  next.insert(next.end(), request.data.begin(), request.data.end());
  if (!request.machine.empty()) next.insert(next.end(), {"--machine", request.machine});
  const std::vector<std::string> import = commissioning::import_words(request.import);
  next.insert(next.end(), import.begin(), import.end());
  return outcome_of(record_cell(
      "{model}: a new model with {usual}{of_paths}\n{effects}{brackets}next: {next}\n", "model"_is(request.model),
      "usual"_shown(usual_in_words(work)),
      "of_paths"_shown(
          work.data.paths.empty() ? "" : ". For circles, diagonals and gauge blocks no effects are entered in advance"),
      "effects"_is(std::move(effects)), "brackets"_shown(brackets), "next"_shown(shell_command(next))));
}

struct PredictRequest {
  std::string model, points, output, machine;
  std::vector<std::string> fitted_to;
  ImportArguments import;
  static Fields<PredictRequest> fields() {
    using R = PredictRequest;
    return {
        {"MODEL", &R::model, "model file (.toml) with values, entered or written by `model fit -o`", Need::required},
        {"POINTS", &R::points, "measurement file; the column reading is ignored and may be absent", Need::required},
        {"-o,--output", &R::output, "measurement file to write, with the predictions in the column reading",
         Is::output},
        {"--machine", &R::machine, kMachineHelp},
        {"--fitted-to", &R::fitted_to,
         "readings to which the model was fitted: with the standard uncertainty of each prediction, and whether it is "
         "extrapolated"},
        &R::import};
  }
};

/// The rows with the prediction as reading; what the file had there goes into the column `measured`.
struct Predicted {
  laser::MeasurementSet set;
  bool has_readings = true;
  std::string clock_note{};               ///< as of Observations
  std::vector<model::Support> support{};  ///< as the readings of the set; empty: not asked for
  std::vector<std::string> notes{};
  bool fit_notes = false;  ///< some of them are about uncertainties that do not follow from the parameters
};

/// @param fitted_to  readings to which the model was fitted; null: without uncertainties
Result<Predicted> predicted(const model::Model& model, const std::optional<params::Machine>& machine, Plan plan,
                            const std::string& model_file, const laser::MeasurementSet* fitted_to) {
  const model::Observations at = model::all_observations_of(plan.set, model, machine);
  ECS_TRY(values, in_file(model::predicted(model, at), model_file));
  ECS_TRY(notes, in_file(model::notes_of_lacking(model, at), model_file));
  std::vector<model::Support> support;
  bool fit_notes = false;
  if (fitted_to != nullptr) {
    ECS_TRY(found,
            in_file(model::support_of(model, model::observations_of(*fitted_to, model, machine), at), model_file));
    support.resize(at.size());
    for (std::size_t k = 0; k < at.size(); ++k) support[at.file_order[k]] = found.places[k];
    if (found.is_other_fit)
      notes.emplace_back(
          "a fit to the readings of --fitted-to has clearly different values than the model: the uncertainties are "
          "those of that fit. Give the readings to which the model was fitted");
    notes.insert(notes.end(), found.notes.begin(), found.notes.end());
    fit_notes = !found.notes.empty();
  }
  for (std::size_t k = 0; k < at.size(); ++k) {
    laser::Reading& reading = plan.set.readings[at.file_order[k]];
    if (fitted_to != nullptr) {
      reading.extras["sigma"] = support[at.file_order[k]].sigma;
      reading.extras["extrapolated"] = support[at.file_order[k]].extrapolated ? 1.0 : 0.0;
    }
    if (plan.has_readings) reading.extras["measured"] = reading.error;
    reading.error = values[k] + at.of_map_in(k);
  }
  plan.set.metadata.push_back({"predicted_by", model_file});
  return Predicted{std::move(plan.set), plan.has_readings, at.clock_note,
                   std::move(support),  std::move(notes),  fit_notes};
}

/// @param support  null: without uncertainties
Cell prediction_cell(const laser::Reading& r, bool has_readings, const model::Support* support) {
  const bool forward = r.approach == Approach::forward;
  AnswerFields fields =
      described("row"_is(r.row), "axis"_is(axis_json(r.axis, r.rotary)), "sense"_is(name_of(r.sense)));
  add_position(fields, r.rotary ? r.angle_deg : r.position_mm, r.rotary);
  append(fields,
         "approach"_is(static_cast<int>(r.approach), r.approach == Approach::unknown ? "" : (forward ? "fwd" : "rev")),
         "unit"_is(laser::unit_of(r.sense)), "predicted"_is(r.error, 3),
         "measured"_is(has_readings ? std::optional(r.extras.at("measured")) : std::nullopt, 3));
  if (support != nullptr)
    append(fields, "sigma"_is(support->sigma, 3), "extrapolated"_is(support->extrapolated, " *", ""));
  const char* const last = support != nullptr ? " {sigma:>9}{extrapolated}" : has_readings ? " {measured:>10}" : "";
  return record_cell(fmt::format("{{row:>6}} {{axis:<4}} {{sense:<5}} {} {{approach:>3}} {{predicted:>10}}{}\n",
                                 position_layout(r.rotary), last),
                     fields);
}

/// The text has the first rows only.
Cell predictions_cell(const Predicted& p) {
  constexpr std::size_t kMostRows = 40;
  const auto& rows = p.set.readings;
  const bool rotary = !rows.empty() && rows.front().rotary;
  Cell list{Json::array(), fmt::format("   row axis sense          {} dir  predicted",
                                       rotary ? "a          b          c" : "x          y          z")};
  list.text += !p.support.empty() ? "     sigma\n" : p.has_readings ? "   measured\n" : "\n";  // a row has 80 columns
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Cell one = prediction_cell(rows[i], p.has_readings, p.support.empty() ? nullptr : &p.support[i]);
    if (i >= kMostRows) one.text.clear();
    list.add(one);
  }
  if (rows.size() > kMostRows)
    list.text += fmt::format("… {} more rows: give -o OUT.csv for all of them\n", rows.size() - kMostRows);
  return list;
}

Result<Outcome> predict(VerbContext& context, const PredictRequest& request) {
  std::vector<std::string> inputs = request.fitted_to;
  inputs.insert(inputs.end(), {request.points, request.model, request.machine});
  ECS_DO(check_output_not_input(request.output, inputs));
  const auto model = model::read_model(request.model);
  if (!model) return tl::unexpected(model.error());
  ECS_TRY(machine, machine_in(context.console, request.machine));
  ECS_TRY(plan, plan_in(request.points, request.import));
  laser::MeasurementSet fitted_to;
  if (!request.fitted_to.empty()) {
    ECS_TRY(set, measured_in(context.console, request.fitted_to, request.import));
    fitted_to = std::move(set);
  }
  ECS_TRY(result,
          predicted(*model, machine, std::move(plan), request.model, request.fitted_to.empty() ? nullptr : &fitted_to));
  const bool of_fit = std::any_of(model->history.begin(), model->history.end(),
                                  [&](const model::LadderStep& step) { return step.data == request.points; });
  if (!result.clock_note.empty() && !of_fit) context.console.note(result.clock_note);
  for (const std::string& note : result.notes) context.console.note(note);
  Cell predictions = predictions_cell(result);
  if (!request.output.empty()) {
    ECS_DO(laser::write_measurement_set(request.output, result.set));
    predictions.text = fmt::format("{} predictions written to {}\n", result.set.readings.size(), request.output);
  }
  AnswerFields fields = described("points"_is(result.set.readings.size()), "output"_is(text_cell(request.output)),
                                  "predictions"_is(predictions));
  if (request.fitted_to.empty()) return outcome_of(record_cell("{predictions}", fields));
  const auto count = static_cast<std::size_t>(std::ranges::count_if(result.support, &model::Support::extrapolated));
  const std::string few = fmt::format(
      "{} of {} predictions are extrapolated (*): beyond the readings, or clearly less certain than at any of these.",
      count, result.support.size());
  append(fields, "extrapolated"_is(count),
         "words"_shown(paragraph(fmt::format("sigma: standard uncertainty (k = 1) that follows from those of the "
                                             "fitted parameters, if the model is right{}. {}",
                                             result.fit_notes ? ", or as the note says" : "",
                                             count > 0 ? few : "No prediction is extrapolated."),
                                 0, 2)));
  return outcome_of(record_cell("{predictions}{words}", fields));
}

}  // namespace

extern const std::vector<Action> kModelBeginning{
    action("model effects", "list the library of effects: cause, formula, how to distinguish each from similar ones",
           "ecs model effects cyclic", effects),
    action(
        "model new",
        "create an initial model: offset, slope and backlash of the measured lines; for a ball measured on the table "
        "(five axes), the position of its centre",
        "ecs model new model.toml data.csv --machine machine.toml", begin,
        {.logged = Logged::when_written, .kind = "model"}),
    action("model predict", "predict readings at given positions with a fitted model",
           "ecs model predict fitted.toml points.csv --machine machine.toml -o predicted.csv", predict)};

}  // namespace ecs::app
