// `ecs model compare`: where a model fails, what it says at one place, and over the whole volume.
#include <algorithm>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "commissioning/models/compare_view.hpp"
#include "commissioning/models/place.hpp"
#include "commissioning/models/plots.hpp"
#include "commissioning/models/trace.hpp"
#include "commissioning/models/view.hpp"
#include "model/effects/definition.hpp"

namespace ecs::app {
namespace {

struct CompareArguments : VerbArguments {
  ModelOptions common{*this};
  const bool& refit = flag("--refit", "fit the model to these data first; otherwise its values are kept");
  const int& worst = integer("--worst", "so many of the worst places", 10, 0, 10'000);
  const std::string& at = text("--at", "each effect's share at one place: x=..,y=..,z=..,axis=X,approach=1");
  const int& volume = integer("--volume", "predicted error over the volume, so many places along each axis", 0, 2, 60);
  const std::string& output = output_file("-o,--output", "CSV of the volume to write");
  const std::string& plot = output_file("--plot", "measured against model, as .svg or .png");
};

Result<void> sound(const CompareArguments& arguments) {
  if (!arguments.plot.empty()) ECS_DO(plot_format_of(arguments.plot));
  if (arguments.output.empty()) return {};
  if (arguments.volume == 0) return problem(ProblemKind::usage, "-o takes the map of --volume N: give both");
  std::vector<std::string> inputs = arguments.common.data;
  inputs.push_back(arguments.common.model);
  inputs.push_back(arguments.common.machine);
  return check_output_not_input(arguments.output, inputs);
}

Result<void> tell_place(Cell& answer, const ModelWork& work, const model::Model& fitted,
                        const CompareArguments& arguments) {
  if (arguments.at.empty()) return {};
  ECS_TRY(shares, shares_at(fitted, work.machine, arguments.at));
  const Cell cell = shares_cell(shares);
  answer.text += cell.text;
  answer.json["at"] = cell.json;
  return {};
}

Result<void> tell_volume(Cell& answer, const ModelWork& work, const model::Model& fitted,
                         const CompareArguments& arguments) {
  if (arguments.volume == 0) return {};
  ECS_TRY(volume, volume_of(fitted, work.machine, static_cast<std::size_t>(arguments.volume)));
  const Cell cell = volume_cell(volume);
  answer.text += cell.text;
  answer.json["volume"] = cell.json;
  if (arguments.output.empty()) return {};
  answer.text += "  written to " + arguments.output + "\n";
  answer.json["volume"]["output"] = arguments.output;
  return write_file(arguments.output, to_csv(volume));
}

Result<void> draw(Cell& answer, const ModelWork& work, const model::Fit& fit, const CompareArguments& arguments) {
  if (arguments.plot.empty()) return {};
  answer.text += "\nplot written to " + arguments.plot + "\n";
  return write_plot(arguments.plot, fit_figure(fit, work.data, "model against measurement"));
}

bool any_trace(const std::vector<std::string>& files) {
  return std::any_of(files.begin(), files.end(), [](const std::string& file) { return is_trace_file(file); });
}

/// A recorded step has no places, no volume and no company.
Result<Outcome> compare_step(const CompareArguments& arguments) {
  if (arguments.common.data.size() != 1)
    return problem(ProblemKind::usage, "a recorded step (time_s, dac_V) is compared alone: give that one file");
  if (!arguments.at.empty() || arguments.volume != 0)
    return problem(ProblemKind::usage, "--at and --volume are for measurement sets, not for a recorded step");
  ECS_TRY(comparison, compare_trace(arguments.common.model, arguments.common.data.front()));
  if (!arguments.plot.empty()) {
    ECS_DO(write_plot(arguments.plot, comparison.figure));
    comparison.outcome.text += "\nplot written to " + arguments.plot + "\n";
  }
  return std::move(comparison.outcome);
}

/// At the values of the model; what was never fitted is fitted, and so is everything with --refit.
Result<model::Fit> fit_of(const ModelWork& work, bool refit) {
  if (refit) return model::fit(work.model, work.data);
  auto fit = model::fit(with_values_held(work.model), work.data);
  if (!fit) return fit;
  std::string fitted;
  for (const model::EffectFit& effect : fit->effects) {
    if (effect.effect.traits().fixed_size) continue;
    if (const auto& all = effect.parameters; std::any_of(all.begin(), all.end(), [](const auto& p) { return !p.held; }))
      fitted += (fitted.empty() ? "" : ", ") + to_text(effect.effect);
  }
  if (!fitted.empty())
    fit->notes.push_back(fmt::format("fitted to these data, since the model has no values for it: {}", fitted));
  return fit;
}

Result<Outcome> compare(VerbContext& context, const CompareArguments& arguments) {
  ECS_DO(sound(arguments));
  if (any_trace(arguments.common.data)) return compare_step(arguments);
  ECS_TRY(work, model_work(context.console, arguments.common));
  const auto fit = fit_of(work, arguments.refit);
  if (!fit) return tl::unexpected(in_file(fit.error(), arguments.common.model));
  const model::Comparison comparison = model::compare(*fit, work.data, static_cast<std::size_t>(arguments.worst));
  Cell answer = comparison_cell(comparison, work.data.size());
  answer.json["notes"] = fit->notes;
  if (!fit->notes.empty()) answer.text += "\n" + notes_text(fit->notes);
  const model::Model fitted = with_values(work.model, *fit);
  ECS_DO(tell_place(answer, work, fitted, arguments));
  ECS_DO(tell_volume(answer, work, fitted, arguments));
  ECS_DO(draw(answer, work, *fit, arguments));
  return outcome_of(answer);
}

}  // namespace

extern const VerbDefinition kModelCompare =
    verb<CompareArguments>("model compare", "where a model fails: residuals by direction and by every variable",
                           "ecs model compare model.toml data.csv --machine machine.toml --at x=-100,y=0,z=0,axis=X\n  "
                           "ecs model compare drive_as_printed.toml step_recorded.csv",
                           compare);

}  // namespace ecs::app
