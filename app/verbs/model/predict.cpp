// `ecs model predict`: what a model says at given places.
#include <memory>

#include <fmt/format.h>

#include "app/verbs/laser/import_arguments.hpp"
#include "app/verbs/model/menu.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "commissioning/models/json.hpp"
#include "commissioning/models/plan.hpp"
#include "commissioning/models/view.hpp"
#include "laser/writers/measurement_writer.hpp"

namespace ecs::app {
namespace {

struct PredictArguments {
  std::string model;
  std::string points;
  std::string machine;
  std::string output;
  ImportArguments import;
};

/// The rows with the prediction as reading; what the file had there goes into the column `measured`.
struct Predicted {
  laser::MeasurementSet set;
  bool has_readings = true;
};

Result<Predicted> predicted(const model::Model& model, const std::optional<params::Machine>& machine, Plan plan,
                            const std::string& model_file) {
  const model::Observations at = model::observations_of(plan.set, model, machine);
  const auto values = model::predicted(model, at);
  if (!values) return tl::unexpected(in_file(values.error(), model_file));
  for (std::size_t k = 0; k < at.size(); ++k) {
    laser::Reading& reading = plan.set.readings[at.file_order[k]];
    if (plan.has_readings) reading.extras["measured"] = reading.error;
    reading.error = (*values)[k];
  }
  plan.set.metadata.push_back({"predicted_by", model_file});
  return Predicted{std::move(plan.set), plan.has_readings};
}

std::string text_of(const Predicted& p) {
  constexpr std::size_t kMostRows = 40;
  std::string text = "   row axis sense          x          y          z dir  predicted";
  text += p.has_readings ? "   measured\n" : "\n";
  std::size_t shown_rows = 0;
  for (const laser::Reading& r : p.set.readings) {
    if (shown_rows++ == kMostRows) {
      text += fmt::format("… {} rows more: give -o OUT.csv for all of them\n", p.set.readings.size() - kMostRows);
      break;
    }
    const int approach = static_cast<int>(r.approach);
    text += fmt::format("{:>6} {:<4} {:<5} {:>10} {:>10} {:>10} {:>3} {:>10.3f}", r.row, letter_of(r.axis),
                        name_of(r.sense), position_text(r.position_mm[0]), position_text(r.position_mm[1]),
                        position_text(r.position_mm[2]), approach == 0 ? "" : (approach > 0 ? "fwd" : "rev"), r.error);
    if (p.has_readings) text += fmt::format(" {:>10.3f}", r.extras.at("measured"));
    text += "\n";
  }
  return text;
}

Json json_of_predicted(const Predicted& p, const std::string& output) {
  Json rows = Json::array();
  for (const laser::Reading& r : p.set.readings) {
    Json row{{"row", r.row}, {"axis", axis_json(r.axis)}, {"sense", name_of(r.sense)}};
    row.update(position_json(r.position_mm));
    row["approach"] = static_cast<int>(r.approach);
    row["unit"] = laser::unit_of(r.sense);
    row["predicted"] = number_or_null(r.error);
    row["measured"] = p.has_readings ? number_or_null(r.extras.at("measured")) : Json(nullptr);
    rows.push_back(std::move(row));
  }
  return {{"points", p.set.readings.size()}, {"output", text_or_null(output)}, {"predictions", std::move(rows)}};
}

Result<Outcome> predict(VerbContext& context, const PredictArguments& arguments) {
  if (const auto spared =
          check_output_not_input(arguments.output, {arguments.points, arguments.model, arguments.machine});
      !spared)
    return tl::unexpected(spared.error());
  const auto model = model::read_model(arguments.model);
  if (!model) return tl::unexpected(model.error());
  const auto machine = machine_in(context.console, arguments.machine);
  if (!machine) return tl::unexpected(machine.error());
  auto plan = plan_in(arguments.points, arguments.import);
  if (!plan) return tl::unexpected(plan.error());
  const auto result = predicted(*model, *machine, std::move(*plan), arguments.model);
  if (!result) return tl::unexpected(result.error());
  std::string text = text_of(*result);
  if (!arguments.output.empty()) {
    if (const auto written = laser::write_measurement_set(arguments.output, result->set); !written)
      return tl::unexpected(written.error());
    text = fmt::format("{} predictions written to {}\n", result->set.readings.size(), arguments.output);
  }
  return Outcome{text, one_line(json_of_predicted(*result, arguments.output)), kDone};
}

}  // namespace

void add_model_predict(Menu& menu) {
  const auto arguments = std::make_shared<PredictArguments>();
  Verb verb = menu.verb("predict", "what a fitted model says at given places",
                        "ecs model predict fitted.toml points.csv --machine machine.toml -o predicted.csv");
  verb.text("MODEL", arguments->model, "model file (.toml) with values: given, or from `model fit -o`", Need::required)
      .text("POINTS", arguments->points, "measurement set; the column reading does not count and may be absent",
            Need::required)
      .text("-o,--output", arguments->output, "measurement set to write, predictions in the column reading");
  take_machine(verb, arguments->machine);
  take_import_options(verb, arguments->import);
  verb.runs([arguments](VerbContext& context) { return predict(context, *arguments); });
}

}  // namespace ecs::app
