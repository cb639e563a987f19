// `ecs model fit`: the parameters of a model from measured data, with how far they can be trusted.
#include <cmath>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/file.hpp"
#include "base/paragraph.hpp"
#include "commissioning/models/effect_words.hpp"
#include "commissioning/models/json.hpp"
#include "commissioning/models/plots.hpp"
#include "commissioning/models/view.hpp"
#include "commissioning/volume/fitted_rotary.hpp"
#include "model/diagnosis/ladder.hpp"
#include "volume/rotary_errors.hpp"

namespace ecs::app {
namespace {

using model::EffectFit;
using model::Fit;

constexpr double kStrongCorrelation = 0.9;

struct FitArguments : VerbArguments {
  ModelOptions common{*this};
  const bool& plain = flag("--plain", "ordinary least squares: every reading counts the same");
  const std::string& output = output_file("-o,--output", "the model with its values; may be MODEL itself");
  const std::string& rotary =
      output_file("--rotary", "errors of the rotary axes that were found, for `ecs volume --rotary` (.csv)");
  const std::string& plot = output_file("--plot", "measured against model, as .svg or .png");
};

Cell effect_cell(const EffectFit& effect) {
  AnswerFields fields{
      {"", {effect_json(effect.effect), ""}},
      {"place", shown_cell(padded(name_with_alternatives(effect.effect), 67))},
      {"parameters", parameters_cell(effect.parameters, "  {name:<26} {value:>13} {sigma:>13}  {unit}\n")},
      {"rms_um", {number_or_null(effect.rms_um), effect.readings > 0 ? fmt::format(" {:>12.3f}", effect.rms_um) : ""}},
      {"readings", {effect.readings, ""}},
      {"skipped", {effect.skipped, ""}}};
  if (!effect.effect.curve.empty()) fields.push_back({"curve", {curve_json(effect.effect.curve), ""}});
  return record_cell("{place}{rms_um}\n{parameters}", fields);
}

Cell effects_cell(const Fit& fit) {
  if (fit.effects.empty()) return {Json::array(), ""};
  return list_cell(fit.effects, effect_cell,
                   fmt::format("\n{} {:>13} {:>13}  {:<13} {:>8}\n", padded("effect and parameter", 28), "value",
                               "sigma", "unit", rms_heading(fit.noise.unit)));
}

/// All strong correlations as JSON; the strongest as text, and how many more there are.
Cell correlations_cell(const Fit& fit) {
  constexpr std::size_t kMostLines = 5;
  Cell list{Json::array(), {}};
  for (const model::Correlation& one : fit.correlations) {
    if (std::abs(one.value) < kStrongCorrelation) continue;
    const std::string text = fmt::format("correlated {:+.3f}: {} and {}", one.value, one.first, one.second);
    list.add({{{"first", one.first}, {"second", one.second}, {"value", number_or_null(one.value)}},
              list.json.size() < kMostLines ? paragraph(text, 0, 2) : ""});
  }
  if (list.json.size() > kMostLines)
    list.text += paragraph(fmt::format("correlated: {} more pairs above {:g} (--json lists them)",
                                       list.json.size() - kMostLines, kStrongCorrelation),
                           0, 2);
  return list;
}

Cell noise_cell(const Fit& fit, bool rotary) {
  Cell list{Json::array(), fit.noise_by_sense.empty() ? "" : "noise [um, um/m]\n"};
  for (const model::NoiseReport& one : fit.noise_by_sense)
    list.add(record_cell(
        one.correlated_um > 0.0 ? "  {sense} along {axis}: white {white_um}, correlated {correlated_um} "
                                  "over {correlation_time_s} (s, or readings without time)\n"
                                : "  {sense} along {axis}: white {white_um}\n",
        {{"sense", word_cell(one.path.empty() ? std::string(name_of(one.sense)) : one.path)},
         {"axis", word_cell(axis_json(one.axis, rotary))},
         {"white_um", number_cell(one.white_um, 3)},
         {"correlated_um", number_cell(one.correlated_um, 3)},
         {"correlation_time_s", {number_or_null(one.correlation_time_s), few_digits(one.correlation_time_s, 2)}}}));
  return list;
}

std::string outliers_text(const Fit& fit) {
  if (fit.outliers.empty()) return {};
  return paragraph(fmt::format("outliers: rows {} ({} readings): they weigh little, and stay in the rms",
                               rows_text(fit.outliers), fit.outliers.size()),
                   0, 2);
}

Cell fit_cell(const Fit& fit, std::size_t readings, bool rotary, const std::string& output) {
  const Cell lack_of_fit = lack_of_fit_cell(fit.lack_of_fit);
  std::string undetermined;
  for (const std::string& one : fit.undetermined) undetermined += paragraph("undetermined: " + one, 0, 2);
  return record_cell(
      "{observations} readings, {fitted_parameters} fitted parameters: rms {rms_um} {unit}, peak {peak_um} {unit}\n"
      "{condition}{effects}{undetermined}{correlations}{noise}{outliers}{notes}",
      {{"observations", count_cell(readings)},
       {"unit", shown_cell(std::string(fit.noise.unit))},
       {"rms_um", number_cell(fit.rms_um, 3)},
       {"peak_um", number_cell(fit.peak_um, 3)},
       {"noise_um", {number_or_null(fit.noise.noise_um), ""}},
       {"noise_from_repeats", {fit.noise.from_repeats, ""}},
       {"lack_of_fit", lack_of_fit},
       {"fitted_parameters", count_cell(fit.fitted_parameters)},
       {"condition",
        {number_or_null(fit.condition),
         paragraph(fmt::format("noise of one reading {}; lack of fit: {}; condition {}", noise_text(fit.noise),
                               lack_of_fit.text, few_digits(fit.condition)))}},
       {"effects", effects_cell(fit)},
       {"correlations", correlations_cell(fit)},
       {"undetermined", {fit.undetermined, undetermined}},
       {"outliers", {fit.outliers, outliers_text(fit)}},
       {"noise", noise_cell(fit, rotary)},
       {"notes", {fit.notes, notes_text(fit.notes)}},
       {"model", text_cell(output)}});
}

Result<void> write(const model::Model& model, const ModelWork& work, const Fit& fit, const FitArguments& arguments) {
  if (!arguments.output.empty())
    if (auto kept = model::write_model(arguments.output, model_to_keep(model, fit, work.data, work.data_name),
                                       arguments.common.model);
        !kept)
      return kept;
  if (arguments.plot.empty()) return {};
  return write_plot(arguments.plot,
                    fit_figure(fit, work.data,
                               fmt::format("rms {:.2f} {}, noise {:.2f} {}", fit.rms_um, plot_unit(fit.noise.unit),
                                           fit.noise.noise_um, plot_unit(fit.noise.unit))));
}

Result<Outcome> fit(VerbContext& context, const FitArguments& arguments) {
  if (!arguments.plot.empty()) ECS_DO(plot_format_of(arguments.plot));
  for (const std::string& output : {arguments.output, arguments.plot, arguments.rotary})
    ECS_DO(check_output_not_input(output, arguments.common.data));
  ECS_TRY(work, model_work(context.console, arguments.common));
  auto result = model::fit(work.model, work.data, {arguments.plain});
  if (!result) return tl::unexpected(in_file(result.error(), arguments.common.model));
  const auto ties = model::decided_ties(work.model, work.data);
  if (!ties) return tl::unexpected(in_file(ties.error(), arguments.common.model));
  result->notes.insert(result->notes.end(), ties->notes.begin(), ties->notes.end());
  ECS_DO(write(ties->model, work, *result, arguments));
  Cell answer = fit_cell(*result, work.data.size(), work.data.rotary, arguments.output);
  if (!arguments.output.empty()) answer.text += fmt::format("model written to {}\n", arguments.output);
  if (!arguments.rotary.empty()) {
    ECS_TRY(found, fitted_rotary(ties->model, *result, work.machine, work.data));
    const std::string text = volume::rotary_csv(found.errors, work.machine ? work.machine->name : "");
    ECS_DO(write_file(arguments.rotary, text));
    for (const std::string& one : found.not_told) answer.text += paragraph(one, 0, 2);
    for (const std::string& one : found.left_out) answer.text += paragraph("left out of the file: " + one, 0, 2);
    answer.text += fmt::format("errors of rotary axes written to {}\n", arguments.rotary);
  }
  if (!arguments.plot.empty()) answer.text += fmt::format("plot written to {}\n", arguments.plot);
  return outcome_of(answer);
}

}  // namespace

extern const VerbDefinition kModelFit =
    verb<FitArguments>("model fit", "the parameters of a model from measured data, with sigmas and correlations",
                       "ecs model fit model.toml data.csv --machine machine.toml -o fitted.toml", fit);

}  // namespace ecs::app
