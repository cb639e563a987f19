// `ecs model diagnose`: which effect is missing from a model, with the evidence.

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/answer_table.hpp"
#include "base/interrupt.hpp"
#include "commissioning/models/answer_check.hpp"
#include "commissioning/models/diagnosis_view.hpp"
#include "commissioning/models/plots.hpp"
#include "model/planning/next_measurement.hpp"

namespace ecs::app {
namespace {

struct DiagnoseArguments : VerbArguments {
  ModelOptions common{*this};
  const int& blanks = integer("--blanks", "simulated data sets of noise alone that a finding must beat",
                              static_cast<int>(model::DiagnoseOptions{}.noise_replicates), 50, 20'000);
  const bool& plain = flag("--plain", "ordinary least squares: no reading counts as an outlier");
  const std::string& plot = output_file("--plot", "measured against model, and what is left, as .svg or .png");
};

Result<void> draw(const ModelWork& work, const model::Diagnosis& diagnosis, const DiagnoseArguments& arguments) {
  ECS_TRY(figure, diagnosis_figure(work.model, work.data, diagnosis, arguments.plain));
  return write_plot(arguments.plot, figure);
}

Result<Outcome> diagnose(VerbContext& context, const DiagnoseArguments& arguments) {
  if (!arguments.plot.empty()) ECS_DO(plot_format_of(arguments.plot));
  ECS_TRY(work, model_work(context.console, arguments.common));
  model::DiagnoseOptions options;
  options.noise_replicates = static_cast<std::size_t>(arguments.blanks);
  options.plain = arguments.plain;
  options.cancelled = &interrupted();
  auto diagnosis = model::diagnose(work.model, work.data, options);
  if (!diagnosis) return tl::unexpected(in_file(diagnosis.error(), arguments.common.model));
  (void)model::planned_next(work.model, work.data, *diagnosis);  // the proposal of `ecs model next`
  Cell answer = diagnosis_cell(*diagnosis);
  ECS_DO(add_check_inputs(answer, arguments.common, work, arguments.plain));
  if (!arguments.plot.empty()) {
    ECS_DO(draw(work, *diagnosis, arguments));
    answer.text += "\nplot written to " + arguments.plot + "\n";
  }
  return outcome_of(answer);
}

}  // namespace

extern const VerbDefinition kModelDiagnose = verb<DiagnoseArguments>(
    "model diagnose", "which effect is missing from a model, with proof, rivals and doubts",
    "ecs model diagnose model.toml data.csv --machine machine.toml --plot residual.svg", diagnose);

}  // namespace ecs::app
