// `ecs model history`: the ladder of effects added so far, as a table and as bars.

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/answer_table.hpp"
#include "commissioning/models/plots.hpp"
#include "commissioning/models/view.hpp"

namespace ecs::app {
namespace {

struct HistoryArguments : VerbArguments {
  const std::string& model = text("MODEL", "model file (.toml)", Need::required);
  const std::string& plot = output_file("--plot", "bars falling towards the noise, as .svg or .png");
  const std::string& machine = text("--machine", kMachineHelp);
};

Result<Outcome> history(VerbContext&, const HistoryArguments& arguments) {
  ECS_TRY(model, model::read_model(arguments.model));
  Cell ladder = ladder_cell(model);
  if (!arguments.plot.empty()) {
    ECS_DO(write_plot(arguments.plot, ladder_figure(model.history, "Error after every step")));
    ladder.text += "plot written to " + arguments.plot + "\n";
  }
  return outcome_of(record_cell("{history}", {{"model", word_cell(arguments.model)}, {"history", ladder}}));
}

}  // namespace

extern const VerbDefinition kModelHistory =
    verb<HistoryArguments>("model history", "the ladder: how far the error fell with every effect",
                           "ecs model history model.toml --plot ladder.svg", history);

}  // namespace ecs::app
