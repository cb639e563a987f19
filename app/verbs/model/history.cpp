// `ecs model history`: the ladder of effects added so far, as a table and as bars.

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/answer_table.hpp"
#include "commissioning/models/plots.hpp"
#include "commissioning/models/view.hpp"

namespace ecs::app {
namespace {

struct HistoryArguments {
  std::string model;
  std::string machine;
  std::string plot;
};

Result<Outcome> history(const HistoryArguments& arguments) {
  const auto model = model::read_model(arguments.model);
  if (!model) return tl::unexpected(model.error());
  Cell ladder = ladder_cell(model->history);
  if (!arguments.plot.empty()) {
    if (const auto drawn = write_plot(arguments.plot, ladder_figure(model->history, "Error after every step")); !drawn)
      return tl::unexpected(drawn.error());
    ladder.text += "plot written to " + arguments.plot + "\n";
  }
  return outcome_of(record_cell("{history}", {{"model", word_cell(arguments.model)}, {"history", ladder}}));
}

}  // namespace

extern const VerbDefinition kModelHistory = verb<HistoryArguments>(
    "model history", "the ladder: how far the error fell with every effect",
    "ecs model history model.toml --plot ladder.svg",
    [](Verb& verb, HistoryArguments& arguments) {
      verb.text("MODEL", arguments.model, "model file (.toml)", Need::required)
          .text("--plot", arguments.plot, "bars falling towards the noise, as .svg or .png");
      take_machine(verb, arguments.machine);
    },
    [](VerbContext&, const HistoryArguments& arguments) { return history(arguments); });

}  // namespace ecs::app
