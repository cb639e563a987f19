// `ecs model add` and `ecs model undo`: one effect more or less, and how far the error falls.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "app/verbs/laser/import_arguments.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/paragraph.hpp"
#include "commissioning/models/effect_words.hpp"
#include "commissioning/models/json.hpp"
#include "commissioning/models/view.hpp"
#include "model/diagnosis/ladder.hpp"

namespace ecs::app {
namespace {

struct AddArguments : VerbArguments {
  const std::string& model = text("MODEL", "model file (.toml)", Need::required);
  const std::string& effect = text(
      "EFFECT", "effect[:axis[:sense or code]], as in cyclic:X:EX; `ecs model effects` lists them", Need::required);
  const std::vector<std::string>& data = texts("--data", "measurement files to fit to", Need::required);
  const std::string& output = output_file("-o,--output", "the model with the effect; may be MODEL itself");
  const std::string& approach = choice("--approach", {"both", "forward", "reverse"}, "on which approach it acts");
  const std::string& sensor = text("--sensor", "column of the sensor that it follows");
  const std::string& sensor2 = text("--sensor2", "column of the second sensor, where it follows the difference of two");
  const std::string& sense = choice("--sense", {"EX", "EY", "EZ", "EA", "EB", "EC"}, "of the effect");
  const std::string& code =
      text("--code",
           "component of angular, squareness or map faults, such as ECX; EA, EB or EC of set_up_rotation; XOC "
           "and so on of location");
  const std::string& machine = text("--machine", kMachineHelp);
  const std::vector<std::string>& alternatives =
      texts("--or", "what `diagnose` cannot tell it from: kept with it until a measurement decides");
  ImportArguments import;
  AddArguments() { take_import_options(*this, import, "--reading-sense"); }
};

/// "servo_lag:X:EX, scale:X:EX", as a model keeps them.
Result<std::string> tied_with(const std::vector<std::string>& alternatives) {
  for (const std::string& one : alternatives) ECS_DO(model::parse_add_request(one));
  return fmt::format("{}", fmt::join(alternatives, ", "));
}

Result<model::AddRequest> request_of(const AddArguments& arguments) {
  auto request = model::parse_add_request(arguments.effect);
  if (!request) return request;
  if (!arguments.approach.empty()) request->approach = model::approach_mode_named(arguments.approach);
  if (!arguments.sensor.empty()) request->sensor = arguments.sensor;
  if (!arguments.sensor2.empty()) request->sensor2 = arguments.sensor2;
  if (!arguments.sense.empty()) request->sense = sense_named(arguments.sense);
  if (arguments.code.empty()) return request;
  if (const auto coded = model::code_named(request->id, arguments.code)) {
    if (coded->axis) {
      request->axis = coded->axis;
      request->rotary = true;
    }
    if (coded->sense) request->sense = coded->sense;
    if (coded->code) request->code = coded->code;
    return request;
  }
  return problem(ProblemKind::usage,
                 fmt::format("--code: expected one of the 21 components, such as ECX or C0Y, or EA, "
                             "EB, EC of set_up_rotation, XOC … of location, got \"{}\"",
                             arguments.code));
}

/// --sense means the effect's here.
Problem with_hint(Problem why) {
  if (const std::size_t at = why.message.find("--sense EX"); at != std::string::npos)
    why.message.replace(at, 7, "--reading-sense");
  return why;
}

Cell added_cell(const model::Added& added, std::string_view unit, const std::string& output) {
  Json effect = effect_json(added.effect.effect);
  effect["parameters"] = parameters_cell(added.effect.parameters).json;
  const int outliers = added.step.outliers;
  const std::string summary = paragraph(fmt::format(
      "added {}: rms {:.3f} -> {:.3f} {}{}, noise of one reading {:.3f} {}",
      name_with_alternatives(added.effect.effect), added.rms_before_um, added.rms_after_um, unit,
      outliers > 0 ? fmt::format(" with {} outlier{}", outliers, outliers == 1 ? "" : "s") : "", added.noise_um, unit));
  return record_cell("{summary}{effect}\n{history}{model}\n",
                     {{"summary", shown_cell(summary)},
                      {"rms_before_um", {number_or_null(added.rms_before_um), ""}},
                      {"rms_after_um", {number_or_null(added.rms_after_um), ""}},
                      {"noise_um", {number_or_null(added.noise_um), ""}},
                      {"peak_um", {number_or_null(added.step.peak_um), ""}},
                      {"held_out_rms_um", {number_or_null(added.step.held_out_rms_um), ""}},
                      {"effect", {std::move(effect), paragraph(parameters_text(added.effect.parameters), 2, 4)}},
                      {"history", ladder_cell(added.model)},
                      {"model", output.empty() ? null_cell("nothing written: give -o MODEL to keep it")
                                               : Cell{output, "model written to " + output}}});
}

Result<Outcome> add(VerbContext& context, const AddArguments& arguments) {
  ECS_TRY(request, request_of(arguments));
  ECS_TRY(alternatives, tied_with(arguments.alternatives));
  std::vector<std::string> inputs = arguments.data;
  inputs.push_back(arguments.machine);
  ECS_DO(check_output_not_input(arguments.output, inputs));
  const auto work = model_work(context.console, {arguments.model, arguments.data, arguments.machine, arguments.import});
  if (!work) return tl::unexpected(with_hint(work.error()));
  if (!work->data.clock_note.empty()) context.console.note(work->data.clock_note);
  auto added = model::add_effect(work->model, work->data, request, work->data_name);
  if (!added) return tl::unexpected(in_file(added.error(), arguments.model));
  added->effect.effect.tied_with = added->model.effects.back().tied_with = alternatives;
  if (!arguments.output.empty()) ECS_DO(model::write_model(arguments.output, added->model, arguments.model));
  return outcome_of(added_cell(*added, work->data.reading_unit(), arguments.output));
}

struct UndoArguments : VerbArguments {
  const std::string& model = text("MODEL", "model file (.toml)", Need::required);
  const std::string& output = output_file("-o,--output", "the model to write; MODEL itself if not given");
  const std::string& machine = text("--machine", kMachineHelp);
};

/// A ladder that holds nothing but its beginning has nothing to take back.
bool nothing_added(const model::Model& model) {
  return std::all_of(model.history.begin(), model.history.end(),
                     [](const model::LadderStep& step) { return step.effect.empty(); });
}

Result<Outcome> undo(VerbContext&, const UndoArguments& arguments) {
  const auto model = model::read_model(arguments.model);
  if (!model) return tl::unexpected(model.error());
  if (nothing_added(*model))
    return tl::unexpected(
        Problem{ProblemKind::refused, "nothing to undo: no effect was added to this model", arguments.model, 0, 0, {}});
  ECS_TRY(before, model::undo(*model));
  const std::string output = arguments.output.empty() ? arguments.model : arguments.output;
  ECS_DO(model::write_model(output, before, arguments.model));
  const std::string taken = model->history.back().effect;
  return outcome_of(
      record_cell("taken back: {undone}\n\n{history}model written to {model}\n",
                  {{"undone", word_cell(taken)}, {"history", ladder_cell(before)}, {"model", word_cell(output)}}));
}

}  // namespace

extern const VerbDefinition kModelAdd = verb<AddArguments>(
    "model add", "an effect more, in the place that fits best; shows how far the error falls",
    "ecs model add model.toml cyclic:X:EX --data data.csv --machine machine.toml -o model.toml", add);

extern const VerbDefinition kModelUndo = verb<UndoArguments>(
    "model undo", "a model without the effect that was added last", "ecs model undo model.toml", undo);

}  // namespace ecs::app
