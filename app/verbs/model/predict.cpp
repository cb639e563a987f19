// `ecs model predict`: the predictions of a model at given places.

#include <algorithm>
#include <span>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/verbs/laser/import_arguments.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/answer_table.hpp"
#include "commissioning/models/json.hpp"
#include "commissioning/models/plan.hpp"
#include "commissioning/models/view.hpp"
#include "laser/writers/measurement_writer.hpp"

namespace ecs::app {
namespace {

struct PredictArguments : VerbArguments {
  const std::string& model =
      text("MODEL", "model file (.toml) with values: given, or from `model fit -o`", Need::required);
  const std::string& points =
      text("POINTS", "measurement set; the column reading does not count and may be absent", Need::required);
  const std::string& output = output_file("-o,--output", "measurement set to write, predictions in the column reading");
  const std::string& machine = text("--machine", kMachineHelp);
  ImportOptions import{*this};
};

/// The rows with the prediction as reading; what the file had there goes into the column `measured`.
struct Predicted {
  laser::MeasurementSet set;
  bool has_readings = true;
  std::string clock_note{};  ///< as of Observations
};

Result<Predicted> predicted(const model::Model& model, const std::optional<params::Machine>& machine, Plan plan,
                            const std::string& model_file) {
  const model::Observations at = model::all_observations_of(plan.set, model, machine);
  const auto values = model::predicted(model, at);
  if (!values) return tl::unexpected(in_file(values.error(), model_file));
  for (std::size_t k = 0; k < at.size(); ++k) {
    laser::Reading& reading = plan.set.readings[at.file_order[k]];
    if (plan.has_readings) reading.extras["measured"] = reading.error;
    reading.error = (*values)[k];
  }
  plan.set.metadata.push_back({"predicted_by", model_file});
  return Predicted{std::move(plan.set), plan.has_readings, at.clock_note};
}

Cell prediction_cell(const laser::Reading& r, bool has_readings) {
  const bool forward = r.approach == Approach::forward;
  AnswerFields fields{{"row", integer_cell(r.row)},
                      {"axis", word_cell(axis_json(r.axis, r.rotary))},
                      {"sense", word_cell(name_of(r.sense))}};
  add_position(fields, r.rotary ? r.angle_deg : r.position_mm, r.rotary);
  fields.insert(
      fields.end(),
      {{"approach", {static_cast<int>(r.approach), r.approach == Approach::unknown ? "" : (forward ? "fwd" : "rev")}},
       {"unit", word_cell(laser::unit_of(r.sense))},
       {"predicted", number_cell(r.error, 3)},
       {"measured", number_cell(has_readings ? std::optional(r.extras.at("measured")) : std::nullopt, 3)}});
  return record_cell(fmt::format("{{row:>6}} {{axis:<4}} {{sense:<5}} {} {{approach:>3}} {{predicted:>10}}{}\n",
                                 position_layout(r.rotary), has_readings ? " {measured:>10}" : ""),
                     fields);
}

/// The text has the first rows only.
Cell predictions_cell(const Predicted& p) {
  constexpr std::size_t kMostRows = 40;
  const auto& rows = p.set.readings;
  const bool rotary = !rows.empty() && rows.front().rotary;
  Cell list{Json::array(), fmt::format("   row axis sense          {} dir  predicted",
                                       rotary ? "a          b          c" : "x          y          z")};
  list.text += p.has_readings ? "   measured\n" : "\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Cell one = prediction_cell(rows[i], p.has_readings);
    if (i >= kMostRows) one.text.clear();
    list.add(one);
  }
  if (rows.size() > kMostRows)
    list.text += fmt::format("… {} rows more: give -o OUT.csv for all of them\n", rows.size() - kMostRows);
  return list;
}

Result<Outcome> predict(VerbContext& context, const PredictArguments& arguments) {
  if (const auto distinct =
          check_output_not_input(arguments.output, {arguments.points, arguments.model, arguments.machine});
      !distinct)
    return tl::unexpected(distinct.error());
  const auto model = model::read_model(arguments.model);
  if (!model) return tl::unexpected(model.error());
  ECS_TRY(machine, machine_in(context.console, arguments.machine));
  ECS_TRY(plan, plan_in(arguments.points, arguments.import));
  ECS_TRY(result, predicted(*model, machine, std::move(plan), arguments.model));
  const bool of_fit = std::any_of(model->history.begin(), model->history.end(),
                                  [&](const model::LadderStep& step) { return step.data == arguments.points; });
  if (!result.clock_note.empty() && !of_fit) context.console.note(result.clock_note);
  Cell predictions = predictions_cell(result);
  if (!arguments.output.empty()) {
    ECS_DO(laser::write_measurement_set(arguments.output, result.set));
    predictions.text = fmt::format("{} predictions written to {}\n", result.set.readings.size(), arguments.output);
  }
  return outcome_of(record_cell("{predictions}", {{"points", count_cell(result.set.readings.size())},
                                                  {"output", text_cell(arguments.output)},
                                                  {"predictions", predictions}}));
}

}  // namespace

extern const VerbDefinition kModelPredict =
    verb<PredictArguments>("model predict", "the predictions of a fitted model at given places",
                           "ecs model predict fitted.toml points.csv --machine machine.toml -o predicted.csv", predict);

}  // namespace ecs::app
