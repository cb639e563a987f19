// The ladder of a model. `ecs model add` and `undo`: one effect more or less, and how far the error falls. `remove` and
// `decide`: an effect taken out, one kept without its alternatives. `history`: the steps as a table and as bars.

#include <algorithm>
#include <cctype>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "base/answer_table.hpp"
#include "base/text.hpp"
#include "commissioning/measurements/files.hpp"
#include "commissioning/models/plots.hpp"
#include "commissioning/models/view.hpp"
#include "commissioning/models/work.hpp"
#include "model/diagnosis/ladder.hpp"

namespace ecs::app {
namespace {

struct AddRequest {
  std::string model, effect, output, approach, sensor, sensor2, sense, code, machine;
  std::vector<std::string> data, more_data, alternatives, formulas;
  ImportArguments import;
  static Fields<AddRequest> fields() {
    using R = AddRequest;
    return {
        {"MODEL", &R::model, "model file (.toml)", Need::required},
        {"EFFECT", &R::effect,
         "effect[:axis[:sense or code]], as in cyclic:X:EX; `ecs model effects` lists them; \"formula\": the formula "
         "that `diagnose` proposes for the residual; user:NAME: your own formula, given by --formula",
         Need::required},
        {"DATA", &R::data, "measurement files to fit to"},
        {"--data", &R::more_data, "measurement files to fit to: the same as DATA"},
        {"-o,--output", &R::output, "model file to write, with the effect; may be MODEL itself", Is::output},
        {"--approach", &R::approach, "approach in which the effect acts", Words{"both", "forward", "reverse"}},
        {"--sensor", &R::sensor, "column of the sensor that the effect follows"},
        {"--sensor2", &R::sensor2, "column of the second sensor, for an effect that follows the difference of two"},
        {"--sense", &R::sense, "sense in which the effect acts", Words{"EX", "EY", "EZ", "EA", "EB", "EC"}},
        {"--code", &R::code,
         "component: such as ECX for angular and map faults, C0Y for squareness, XOC for location; EA, EB or EC for "
         "set_up_rotation"},
        {"--machine", &R::machine, kMachineHelp},
        {"--or", &R::alternatives,
         "an alternative that `diagnose` cannot distinguish from it, as in \"thermal_drift:X:EX with t_bed_degC\": "
         "kept in the model until a measurement decides"},
        {"--formula", &R::formulas,
         "formula of user:NAME for a sense, as in \"EY = h * (run >= 5)\"; names other than columns are fitted"},
        {&R::import, ImportArguments::fields("--reading-sense")}};
  }
};

/// "servo_lag:X:EX, scale:X:EX", as a model keeps them.
Result<std::string> tied_with(const std::vector<std::string>& alternatives) {
  for (const std::string& one : alternatives) ECS_DO(model::parse_add_request(one));
  return fmt::format("{}", fmt::join(alternatives, ", "));
}

/// An effect of the user's formulas, read as a model file is.
Result<model::AddRequest> user_effect(const std::string& name, const std::vector<std::string>& formulas) {
  std::string rows;
  for (const std::string& one : formulas) {
    const std::size_t at = one.find('=');
    const std::string sense(trimmed(one.substr(0, at)));
    if (at == std::string::npos || !sense_named(sense))
      return problem(ProblemKind::usage,
                     "--formula: expected a sense and its formula, as in \"EY = h * (run >= 5)\", got \"{}\"", one);
    rows += fmt::format("formula.{} = {}\n", sense, Json(std::string(trimmed(one.substr(at + 1)))).dump());
  }
  ECS_TRY(model, model::parse_model(fmt::format("[[effect]]\nid = \"user\"\nname = {}\n{}", Json(name).dump(), rows),
                                    "--formula", {}));
  return model::request_of(model.effects.front());
}

Result<model::AddRequest> request_of(const AddRequest& request) {
  auto wanted = model::parse_add_request(request.effect);
  if (!wanted) return wanted;
  if (!request.formulas.empty()) {
    if (wanted->name.empty()) return problem(ProblemKind::usage, "--formula: expected a name for it, as in user:jump");
    return user_effect(wanted->name, request.formulas);
  }
  if (!request.approach.empty()) wanted->approach = model::approach_mode_named(request.approach);
  if (!request.sensor.empty()) wanted->sensor = request.sensor;
  if (!request.sensor2.empty()) wanted->sensor2 = request.sensor2;
  if (!request.sense.empty()) wanted->sense = sense_named(request.sense);
  if (request.code.empty()) return wanted;
  if (const auto coded = model::code_named(wanted->id, request.code)) {
    if (coded->axis) {
      wanted->axis = coded->axis;
      wanted->rotary = true;
    }
    if (coded->sense) wanted->sense = coded->sense;
    if (coded->code) wanted->code = coded->code;
    return wanted;
  }
  return problem(ProblemKind::usage,
                 "--code: expected one of the 21 components, such as ECX or C0Y; EA, EB or EC for set_up_rotation; XOC "
                 "… of location, got \"{}\"",
                 request.code);
}

/// --sense means the effect's here.
Problem with_hint(Problem why) {
  if (const std::size_t at = why.message.find("--sense EX"); at != std::string::npos)
    why.message.replace(at, 7, "--reading-sense");
  return why;
}

/// Of an effect that may act several times: that the model had one already.
std::string second_text(const model::Added& added) {
  const auto& effects = added.model.effects;
  const auto like = std::ranges::count_if(
      effects, [&](const model::EffectInstance& one) { return model::same_candidate(one, added.effect.effect); });
  return like < 2
             ? std::string()
             : paragraph(fmt::format("The model contained {} already: it now contains it {} times, each with values "
                                     "of its own.",
                                     to_text(added.effect.effect), like));
}

/// Of the first effect, before which no error of held-out readings is known: that it does not lower it visibly.
std::string no_prediction_text(const model::Added& added, std::string_view unit) {
  const auto& held_out = added.step.held_out_rms_um;
  if (!held_out || *held_out < added.step.rms_before_um) return {};
  return paragraph(
      fmt::format("For readings left out of the fit the rms is {:.3f} {}, not less than the rms of all readings before "
                  "the effect was added ({:.3f} {}).",
                  *held_out, unit, added.step.rms_before_um, unit));
}

/// Where the effect does not lower the error of readings that were not used for the fit: that, and how to take it back.
std::string no_better_text(const model::Added& added, std::string_view unit, const std::string& output) {
  const std::vector<model::LadderStep>& steps = added.model.history;
  if (steps.size() < 2) return no_prediction_text(added, unit);
  const auto &before = steps[steps.size() - 2].held_out_rms_um, &after = steps.back().held_out_rms_um;
  if (!before) return no_prediction_text(added, unit);
  if (!after || *after < *before) return {};
  return paragraph(fmt::format("{} does not lower the error of held-out readings: {:.3f} -> {:.3f} {}.{}",
                               to_text(added.effect.effect), *before, *after, unit,
                               output.empty() ? "" : fmt::format(" `ecs model undo {}` removes it.", output)));
}

/// A value without a name gets the label that a table gives it.
std::string values_text(const model::EffectFit& effect) {
  std::string values = parameters_text(effect.parameters);
  if (effect.parameters.size() != 1 || values.empty() || std::isalpha(static_cast<unsigned char>(values.front())) != 0)
    return values;
  return fmt::format("{} {}", parameters_cell(effect, "{label}").text, values);
}

Cell added_cell(const model::Added& added, std::string_view unit, const std::string& output) {
  Json effect = effect_json(added.effect.effect);
  effect["parameters"] = parameters_cell(added.effect).json;
  const int outliers = added.step.outliers;
  const std::string summary = paragraph(
      fmt::format("added {}: rms {:.3f} -> {:.3f} {}{}, noise of one reading {}{:.3f} {}",
                  name_with_alternatives(added.effect.effect), added.step.rms_before_um, added.step.rms_um, unit,
                  outliers > 0 ? fmt::format(" without {} outlier{}", outliers, outliers == 1 ? "" : "s") : "",
                  added.noise_is_upper_limit ? "at most " : "", added.noise_um, unit));
  return record_cell("{summary}{effect}\n{history}{second}{no_better}{model}\n", "summary"_shown(summary),
                     "second"_shown(second_text(added)), "rms_before_um"_is(added.rms_before_um),
                     "rms_after_um"_is(added.rms_after_um), "noise_um"_is(added.noise_um),
                     "peak_um"_is(added.step.peak_um), "held_out_rms_um"_is(added.step.held_out_rms_um),
                     "effect"_is(std::move(effect), paragraph(values_text(added.effect), 2, 4)),
                     "history"_is(ladder_cell(added.model)),
                     "model"_is(output.empty() ? null_cell("not saved: give -o MODEL to save it")
                                               : Cell{output, "model written to " + output}),
                     "no_better"_shown(no_better_text(added, unit, output)));
}

/// The formula that a diagnosis of these data proposes.
Result<model::AddRequest> proposed_formula(const ModelWork& work) {
  ECS_TRY(diagnosis, model::diagnose(work.model, work.data));
  if (!diagnosis.formula)
    return problem(ProblemKind::refused, "no formula is proposed: none predicts held-out readings");
  return model::request_of(diagnosis.formula->effect);
}

/// The effect as a diagnosis of these data names it, where it does: a search for this effect alone could find another
/// period or another part of it, which explains nearly as much.
Result<void> take_as_named(const ModelWork& work, model::AddRequest& wanted) {
  const bool has_shape = !wanted.id->searched_parameter().empty() || !wanted.id->column_sets.empty();
  if (!has_shape || wanted.as_named) return {};
  ECS_TRY(diagnosis, model::diagnose(work.model, work.data));
  const auto named = std::ranges::find_if(diagnosis.candidates, [&](const model::Candidate& one) {
    return one.in_answer() && model::is_requested(one.effect, wanted);
  });
  if (named != diagnosis.candidates.end()) wanted.as_named = named->effect;
  return {};
}

Result<Outcome> add(VerbContext& context, const AddRequest& request) {
  const bool is_formula = request.effect == "formula";
  model::AddRequest wanted;
  if (!is_formula) {
    ECS_TRY(given, request_of(request));
    wanted = std::move(given);
  }
  ECS_TRY(alternatives, tied_with(request.alternatives));
  std::vector<std::string> data = request.data;
  data.insert(data.end(), request.more_data.begin(), request.more_data.end());
  if (data.empty()) return problem(ProblemKind::usage, "DATA is required: the measurement files to fit to");
  std::vector<std::string> inputs = data;
  inputs.push_back(request.machine);
  ECS_DO(check_output_not_input(request.output, inputs));
  const auto work = model_work(context.console, {request.model, data, request.machine, request.import});
  if (!work) return tl::unexpected(with_hint(work.error()));
  if (!work->data.clock_note.empty()) context.console.note(work->data.clock_note);
  if (is_formula) {
    ECS_TRY(proposed, in_file(proposed_formula(*work), request.model));
    wanted = std::move(proposed);
  }
  ECS_DO(in_file(take_as_named(*work, wanted), request.model));
  ECS_TRY(added, in_file(model::add_effect(work->model, work->data, wanted, work->data_name), request.model));
  std::string& tied = added.model.effects.back().tied_with;  // other periods that fit as well
  if (!alternatives.empty()) tied = alternatives + (tied.empty() ? "" : ", " + tied);
  added.effect.effect.tied_with = tied;
  if (!request.output.empty()) ECS_DO(model::write_model(request.output, added.model, request.model));
  return outcome_of(added_cell(added, work->data.reading_unit(), request.output));
}

struct UndoRequest {
  std::string model, output, machine;
  static Fields<UndoRequest> fields() {
    using R = UndoRequest;
    return {{"MODEL", &R::model, "model file (.toml)", Need::required},
            {"-o,--output", &R::output, "model file to write; MODEL itself if not given", Is::output},
            {"--machine", &R::machine, kMachineHelp}};
  }
};

/// A ladder that holds nothing but its beginning has nothing to take back.
bool nothing_added(const model::Model& model) {
  return std::all_of(model.history.begin(), model.history.end(),
                     [](const model::LadderStep& step) { return step.effect.empty(); });
}

Result<Outcome> undo(VerbContext&, const UndoRequest& request) {
  const auto model = model::read_model(request.model);
  if (!model) return tl::unexpected(model.error());
  if (nothing_added(*model))
    return tl::unexpected(Problem{
        ProblemKind::refused, "nothing to undo: no effect has been added to this model", request.model, 0, 0, {}});
  ECS_TRY(before, model::undo(*model));
  const std::string output = request.output.empty() ? request.model : request.output;
  ECS_DO(model::write_model(output, before, request.model));
  const std::string taken = model->history.back().effect;
  return outcome_of(record_cell("undone: {undone}\n\n{history}model written to {model}\n", "undone"_is(taken),
                                "history"_is(ladder_cell(before)), "model"_is(output)));
}

struct RemoveRequest {
  std::string effect, output;
  ModelArguments common;
  static Fields<RemoveRequest> fields() {
    using R = RemoveRequest;
    return {{"EFFECT", &R::effect, "effect of the model, as in cyclic:X:EX", Need::required},
            &R::common,
            {"-o,--output", &R::output, "model file to write; MODEL itself if not given", Is::output}};
  }
};

/// The order of EFFECT and MODEL is another than that of `model add`.
Result<void> effect_comes_first(const std::string& effect, const std::string& model) {
  if (!std::filesystem::exists(effect) || std::filesystem::exists(model)) return {};
  return problem(ProblemKind::usage,
                 "EFFECT and MODEL are swapped: {} is a file; give the effect first, then the model", effect);
}

Result<Outcome> remove(VerbContext& context, const RemoveRequest& given) {
  const ModelArguments& request = given.common;
  const std::string output = given.output.empty() ? request.model : given.output;
  ECS_DO(effect_comes_first(given.effect, request.model));
  ECS_DO(check_output_not_input(output, request.data));
  ECS_TRY(work, model_work(context.console, request));
  ECS_TRY(effect, effect_in(work.model, given.effect));
  ECS_TRY(before, in_file(model::fit(work.model, work.data), request.model));
  ECS_TRY(without, in_file(without_effect(work.model, work.data, effect, before, work.data_name), request.model));
  const model::Model kept = model_to_keep(without.model, without.fit, work.data, work.data_name);
  ECS_DO(model::write_model(output, kept, request.model));
  return outcome_of(record_cell(
      "removed {effect}: rms {rms_before_um} -> {rms_after_um} {unit}\n\n{history}model written to {model}\n",
      "effect"_is(without.name), "rms_before_um"_is(without.rms_before_um, 3), "rms_after_um"_is(without.fit.rms_um, 3),
      "unit"_shown(work.data.reading_unit()), "history"_is(ladder_cell(kept)), "model"_is(output)));
}

struct DecideRequest {
  std::string effect, model, output;
  static Fields<DecideRequest> fields() {
    using R = DecideRequest;
    return {{"EFFECT", &R::effect, "effect of the model, as in cyclic:X:EX", Need::required},
            {"MODEL", &R::model, "model file (.toml)", Need::required},
            {"-o,--output", &R::output, "model file to write; MODEL itself if not given", Is::output}};
  }
};

Result<Outcome> decide(VerbContext&, const DecideRequest& request) {
  ECS_DO(effect_comes_first(request.effect, request.model));
  auto model = model::read_model(request.model);
  if (!model) return tl::unexpected(model.error());
  ECS_TRY(effect, effect_in(*model, request.effect));
  model::EffectInstance& decided = model->effects[effect];
  const std::string alternatives = decided.tied_with;
  if (alternatives.empty())
    return tl::unexpected(Problem{ProblemKind::refused,
                                  fmt::format("{} has no alternatives: no decision is needed", request.effect),
                                  request.model,
                                  0,
                                  0,
                                  {}});
  keep_alternatives(decided, {});
  const std::string output = request.output.empty() ? request.model : request.output;
  ECS_DO(model::write_model(output, *model, request.model));
  return outcome_of(record_cell("decided for {effect}, not {alternatives}\nmodel written to {model}\n",
                                "effect"_is(request.effect), "alternatives"_is(alternatives), "model"_is(output)));
}

struct HistoryRequest {
  std::string model, plot, machine;
  static Fields<HistoryRequest> fields() {
    using R = HistoryRequest;
    return {{"MODEL", &R::model, "model file (.toml)", Need::required},
            {"--plot", &R::plot, "bar chart of the rms after every step, as .svg or .png", Is::output},
            {"--machine", &R::machine, kMachineHelp}};
  }
};

Result<Outcome> history(VerbContext&, const HistoryRequest& request) {
  ECS_TRY(model, model::read_model(request.model));
  Cell ladder = ladder_cell(model);
  if (!request.plot.empty()) {
    ECS_DO(write_plot(request.plot, ladder_figure(model.history, "Error after every step")));
    ladder.text += "plot written to " + request.plot + "\n";
  }
  std::vector<std::string> effects;
  for (const model::EffectInstance& one : model.effects) effects.push_back(to_text(one));
  return outcome_of(
      record_cell("{history}", "model"_is(request.model), "history"_is(ladder), "effects"_is(effects, "")));
}

}  // namespace

extern const std::vector<Action> kModelLadder{
    action("model add",
           "add an effect to the axis and sense where it fits best, and show the residual before and after",
           "ecs model add model.toml cyclic:X:EX data.csv --machine machine.toml -o model.toml", add,
           {.logged = Logged::always, .kind = "model"}),
    action("model undo", "remove the effect that was added last", "ecs model undo model.toml", undo,
           {.logged = Logged::when_written, .kind = "model"}),
    action("model remove", "remove an effect and fit the model to the data again",
           "ecs model remove cyclic:X:EX model.toml data.csv --machine machine.toml", remove,
           {.logged = Logged::when_written, .kind = "model"}),
    action("model decide", "keep an effect and discard the alternatives added by `model add --or`",
           "ecs model decide cyclic:X:EX model.toml", decide, {.logged = Logged::when_written, .kind = "model"}),
    action("model history", "show the ladder: how far the error fell with every effect",
           "ecs model history model.toml --plot ladder.svg", history)};

}  // namespace ecs::app
