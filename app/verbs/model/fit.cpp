// `ecs model fit`: the parameters of a model from measured data, with how far they can be trusted. `compare`: where a
// model fails, what it says at one place, and over the whole volume.

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/cli/module.hpp"
#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/models/place.hpp"
#include "commissioning/models/plots.hpp"
#include "commissioning/models/view.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/plot/figure.hpp"
#include "commissioning/volume/fitted_rotary.hpp"
#include "model/diagnosis/ladder.hpp"
#include "model/diagnosis/words.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/noise.hpp"
#include "volume/rotary_errors.hpp"

namespace ecs::app {
namespace {

using model::EffectFit;
using model::Fit;

constexpr double kStrongCorrelation = 0.9;
constexpr double kDistinguished = 2.0;  // sigmas: zero lies outside 95 % of what the readings allow

struct FitRequest {
  ModelArguments common;
  bool plain = false;
  std::string output, rotary, plot;
  static Fields<FitRequest> fields() {
    using R = FitRequest;
    return {&R::common,
            {"--plain", &R::plain, "use ordinary least squares: every reading has the same weight"},
            {"-o,--output", &R::output, "model file to write, with its values; may be MODEL itself", Is::output},
            {"--rotary", &R::rotary, "CSV file for the fitted errors of the rotary axes, for `ecs volume --rotary`",
             Is::output},
            {"--plot", &R::plot, "plot of measured and modelled values, as .svg or .png", Is::output}};
  }
};

Cell effect_cell(const EffectFit& effect, const model::Observations& data) {
  const std::string ball = model::ball_text(effect.effect, data);
  AnswerFields fields = described(
      inlined({effect_json(effect.effect), ""}), "place"_shown(padded(name_with_alternatives(effect.effect), 67)),
      "ball_of_several"_shown(ball.empty() ? "" : fmt::format("  {}\n", ball)),
      "parameters"_is(parameters_cell(effect, "  {label:<31} {value:>10} {sigma:>12}  {unit}\n")),
      "rms_um"_is(effect.rms_um, effect.readings > 0 ? fmt::format(" {:>12.3f}", effect.rms_um) : ""),
      "readings"_is(effect.readings), "skipped"_is(effect.skipped));
  if (!effect.effect.curve.empty()) fields.push_back("curve"_is(curve_json(effect.effect.curve)));
  return record_cell("{place}{rms_um}\n{ball_of_several}{parameters}", fields);
}

Cell effects_cell(const Fit& fit, const model::Observations& data) {
  if (fit.effects.empty()) return {Json::array(), ""};
  Cell list = list_cell(
      fit.effects, [&](const EffectFit& effect) { return effect_cell(effect, data); },
      fmt::format("\n{} {:>10} {:>12}  {:<12} {:>8}\n", padded("effect and parameter", 33), "value", "sigma", "unit",
                  rms_heading(fit.noise.unit)));
  const auto any = [&](bool held) {
    return std::ranges::any_of(fit.effects, [&](const EffectFit& effect) {
      return std::ranges::any_of(effect.parameters, [&](const model::ParameterEstimate& one) {
        return held ? one.held : !one.held && !one.undetermined && !one.sigma;
      });
    });
  };
  list.text += fmt::format(
      "sigma: standard uncertainty (k = 1); rms: contribution of the effect to the readings on which it acts{}{}{}\n",
      is_just_below(fit.rms_um, fit.noise.noise_um) ? fmt::format("\n{}", kBelowNoise) : "",
      any(true) ? "\nfixed: the fit does not change it (given, exact, or without effect)" : "",
      any(false) ? "\n-: no sigma is computed (a curve, a place found by trying, or a value at its limit)" : "");
  return list;
}

/// All strong correlations as JSON; the strongest as text, and how many more there are.
Cell correlations_cell(const Fit& fit) {
  constexpr std::size_t kMostLines = 5;
  Cell list{Json::array(), {}};
  for (const model::Correlation& one : fit.correlations) {
    if (std::abs(one.value) < kStrongCorrelation) continue;
    const std::string text = fmt::format("correlation {:+.3f} between {} and {}", one.value, one.first, one.second);
    list.add({object_of("first"_is(one.first), "second"_is(one.second), "value"_is(one.value)),
              list.json.size() < kMostLines ? paragraph(text, 0, 2) : ""});
  }
  if (list.json.size() > kMostLines)
    list.text += paragraph(fmt::format("correlated: {} more pairs above {:g} (--json lists them)",
                                       list.json.size() - kMostLines, kStrongCorrelation),
                           0, 2);
  return list;
}

Cell noise_cell(const Fit& fit, bool rotary, bool has_time) {
  Cell list{Json::array(),
            fit.noise_by_sense.empty() ? "" : "noise [um, um/m] (white: independent between readings)\n"};
  for (const model::NoiseReport& one : fit.noise_by_sense)
    list.add(record_cell(one.correlated_um > 0.0
                             ? "  {sense} along {axis}: white {white_um}, correlated {correlated_um} "
                               "over {correlation_time_s} {of}\n"
                             : "  {sense} along {axis}: white {white_um}\n",
                         "sense"_is(one.path.empty() ? std::string(name_of(one.sense)) : one.path),
                         "axis"_is(axis_json(one.axis, rotary)), "white_um"_is(one.white_um, 3),
                         "correlated_um"_is(one.correlated_um, 3),
                         "correlation_time_s"_is(one.correlation_time_s, few_digits(one.correlation_time_s, 2)),
                         "of"_shown(has_time ? "s" : "readings")));
  return list;
}

/// Effects of one amount that may as well be zero. An offset is one of the instrument, and stays.
std::vector<std::string> not_distinguished(const Fit& fit) {
  std::vector<std::string> names;
  for (const EffectFit& one : fit.effects)
    if (one.parameters.size() == 1 && one.parameters[0].sigma && !one.parameters[0].undetermined &&
        name_of(one.effect.id) != "offset" &&
        std::abs(one.parameters[0].value) < kDistinguished * *one.parameters[0].sigma)
      names.push_back(to_text(one.effect));
  return names;
}

std::string not_distinguished_text(const std::vector<std::string>& names) {
  if (names.empty()) return {};
  return paragraph(fmt::format("not distinguished from zero (less than {:g} sigma): {}. The model fits about as "
                               "well without {} (`ecs model remove`)",
                               kDistinguished, fmt::join(names, ", "), names.size() == 1 ? "it" : "them"),
                   0, 2);
}

std::string outliers_text(const Fit& fit) {
  if (fit.outliers.empty()) return {};
  return paragraph(fmt::format("outliers: rows {} ({} readings): they have little weight and are included in the rms",
                               rows_text(fit.outliers), fit.outliers.size()),
                   0, 2);
}

Cell fit_cell(const Fit& fit, const model::Observations& data, bool rotary, const std::string& output) {
  const Cell lack_of_fit = lack_of_fit_cell(fit.lack_of_fit);
  std::string undetermined;
  for (const std::string& one : fit.undetermined) undetermined += paragraph("undetermined: " + one, 0, 2);
  const std::vector<std::string> zero = not_distinguished(fit);
  const std::string_view unit = fit.noise.unit;
  Cell answer = record_cell(
      "{observations} readings, fitted parameters: {fitted_parameters}. Residual: rms {rms_um}, peak {peak_um}\n"
      "{condition}{effects}{not_distinguished}{undetermined}{correlations}{noise}{outliers}{notes}",
      "observations"_is(data.size()), "rms_um"_is(fit.rms_um, in_each_unit(fit.rms_um, fit.rms_by_unit, unit)),
      "peak_um"_is(fit.peak_um, in_each_unit(fit.peak_um, fit.peak_by_unit, unit)), "noise_um"_is(fit.noise.noise_um),
      "noise_from_repeats"_is(fit.noise.from_repeats), "lack_of_fit"_is(lack_of_fit),
      "fitted_parameters"_is(fit.fitted_parameters),
      "condition"_is(fit.condition,
                     paragraph(fmt::format(
                         "noise of one reading {}; lack-of-fit test: {}{}", noise_text(fit.noise),
                         lack_of_fit_text(fit.lack_of_fit, fit.outliers.empty() ? fit.rms_um : 0.0, fit.noise.noise_um),
                         fit.fitted_parameters > 0 ? "; " + separation_text(fit.condition) : ""))),
      "effects"_is(effects_cell(fit, data)), "correlations"_is(correlations_cell(fit)),
      "not_distinguished"_is(zero, not_distinguished_text(zero)), "undetermined"_is(fit.undetermined, undetermined),
      "outliers"_is(fit.outliers, outliers_text(fit)), "noise"_is(noise_cell(fit, rotary, !data.time_s.empty())),
      "notes"_is(fit.notes, notes_text(fit.notes)), "model"_is(text_cell(output)));
  add_by_unit(answer.json, unit, {{"rms", fit.rms_by_unit}, {"peak", fit.peak_by_unit}, {"noise", fit.noise.by_unit}});
  return answer;
}

/// What the file states of its readings beside what they show; no key where it states nothing.
void add_uncertainty(Cell& answer, const Fit& fit, const model::Observations& data) {
  if (const auto stated = model::stated_uncertainty(data, fit.residual, fit.noise.noise_um))
    answer.json["uncertainty"] = object_of("stated_um"_is(stated->um), "residual_ratio"_is(stated->of_residual),
                                           "noise_ratio"_is(stated->of_noise));
}

Result<void> write(const model::Model& model, const ModelWork& work, const Fit& fit, const FitRequest& request) {
  if (!request.output.empty())
    if (auto kept = model::write_model(request.output, model_to_keep(model, fit, work.data, work.data_name),
                                       request.common.model);
        !kept)
      return kept;
  if (request.plot.empty()) return {};
  return write_plot(request.plot,
                    fit_figure(fit, work.data,
                               fmt::format("rms {:.2f} {}, noise {:.2f} {}", fit.rms_um, plot_unit(fit.noise.unit),
                                           fit.noise.noise_um, plot_unit(fit.noise.unit))));
}

Result<Outcome> fit(VerbContext& context, const FitRequest& request) {
  if (!request.plot.empty()) ECS_DO(plot_format_of(request.plot));
  for (const std::string& output : {request.output, request.plot, request.rotary})
    ECS_DO(check_output_not_input(output, request.common.data));
  ECS_TRY(work, model_work(context.console, request.common));
  ECS_TRY(result, in_file(model::fit(work.model, work.data, {request.plain}), request.common.model));
  ECS_TRY(ties, in_file(model::decided_ties(work.model, work.data), request.common.model));
  result.notes.insert(result.notes.end(), ties.notes.begin(), ties.notes.end());
  ECS_DO(write(ties.model, work, result, request));
  Cell answer = fit_cell(result, work.data, work.data.rotary, request.output);
  add_uncertainty(answer, result, work.data);
  if (!request.output.empty()) answer.text += fmt::format("model written to {}\n", request.output);
  if (!request.rotary.empty()) {
    ECS_TRY(found, fitted_rotary(ties.model, result, work.machine, work.data));
    const std::string text = volume::rotary_csv(found.errors, work.machine ? work.machine->name : "");
    ECS_DO(write_file(request.rotary, text));
    answer.text += fmt::format("errors of rotary axes written to {}\n", request.rotary);
    for (const std::string& one : found.not_told) answer.text += paragraph(one, 0, 2);
    for (const std::string& one : found.left_out)
      answer.text += paragraph(fmt::format("not written to {}: {}", request.rotary, one), 0, 2);
  }
  if (!request.plot.empty()) answer.text += fmt::format("plot written to {}\n", request.plot);
  return outcome_of(answer);
}

struct CompareRequest {
  ModelArguments common;
  bool refit = false;
  int worst = 10;
  std::string at, output, plot, residual_plot;
  int volume = 0;
  static Fields<CompareRequest> fields() {
    using R = CompareRequest;
    return {&R::common,
            {"--refit", &R::refit, "fit the model to these data first; otherwise its values stay unchanged"},
            {"--worst", &R::worst, "number of worst positions to list", Range{0, 10'000}},
            {"--at", &R::at, "show the share of each effect at one position: x=..,y=..,z=..,axis=X,approach=1"},
            {"--volume", &R::volume, "predict the error over the volume at this number of positions along each axis",
             Range{2, 60}},
            {"-o,--output", &R::output, "CSV file for the predictions of --volume", Is::output},
            {"--plot", &R::plot, "plot of measured and modelled values, as .svg or .png", Is::output},
            {"--plot-residual", &R::residual_plot,
             "plot of the residual against run, time, temperatures and travel since reversal, as .svg or .png",
             Is::output}};
  }
};

Result<void> sound(const CompareRequest& request) {
  for (const std::string& plot : {request.plot, request.residual_plot})
    if (!plot.empty()) ECS_DO(plot_format_of(plot));
  if (request.output.empty()) return {};
  if (request.volume == 0) return problem(ProblemKind::usage, "-o writes the predictions of --volume N: give both");
  std::vector<std::string> inputs = request.common.data;
  inputs.push_back(request.common.model);
  inputs.push_back(request.common.machine);
  return check_output_not_input(request.output, inputs);
}

Result<void> tell_place(Cell& answer, const ModelWork& work, const model::Model& fitted,
                        const CompareRequest& request) {
  if (request.at.empty()) return {};
  ECS_TRY(shares, shares_at(fitted, work.machine, request.at));
  const Cell cell = shares_cell(shares);
  answer.text += cell.text;
  answer.json["at"] = cell.json;
  return {};
}

Result<void> tell_volume(Cell& answer, const ModelWork& work, const model::Model& fitted,
                         const CompareRequest& request) {
  if (request.volume == 0) return {};
  ECS_TRY(volume, volume_of(fitted, work.machine, static_cast<std::size_t>(request.volume)));
  const Cell cell = volume_cell(volume);
  answer.text += cell.text;
  answer.json["volume"] = cell.json;
  if (request.output.empty()) return {};
  answer.text += "  written to " + request.output + "\n";
  answer.json["volume"]["output"] = request.output;
  return write_file(request.output, to_csv(volume));
}

/// The residual of the lines where it is largest, against each variable that changes along them.
PlotFigure residual_figure(const model::Fit& fit, const model::Observations& data) {
  constexpr std::size_t kMostLines = 3;
  std::vector<std::pair<double, MeasuredLine>> lines;
  for (MeasuredLine& line : measured_lines(data)) {
    double sum = 0.0;
    for (const std::size_t k : line.rows) sum += fit.residual[k] * fit.residual[k];
    lines.emplace_back(sum / static_cast<double>(line.rows.size()), std::move(line));
  }
  std::ranges::stable_sort(lines, std::greater<>(), [](const auto& one) { return one.first; });
  lines.resize(std::min(lines.size(), kMostLines));
  PlotFigure figure{"residual of the model", {}, 2, false};
  for (const auto& [weight, line] : lines)
    for (PlotPanel& panel : residual_panels_of_variables(data, fit, line)) {
      if (!panel.title.starts_with("residual against")) continue;  // over a period: of all lines, and in --plot
      panel.title = fmt::format("{}: {}", title_of(line), panel.title);
      for (PlotSeries& series : panel.series) {
        if (series.mark == Mark::forward_reading) series.name = "forward";
        if (series.mark == Mark::reverse_reading) series.name = "reverse";
      }
      figure.panels.push_back(std::move(panel));
    }
  return figure;
}

Result<void> draw(Cell& answer, const ModelWork& work, const model::Fit& fit, const CompareRequest& request) {
  if (!request.plot.empty()) {
    answer.text += "\nplot written to " + request.plot + "\n";
    ECS_DO(write_plot(request.plot, fit_figure(fit, work.data, "model against measurement")));
  }
  if (request.residual_plot.empty()) return {};
  const PlotFigure figure = residual_figure(fit, work.data);
  if (figure.panels.empty())
    return problem(
        ProblemKind::refused,
        "--plot-residual: apart from position and approach, no variable (run, time, ...) changes in these readings");
  answer.text += "\nplot of the residual written to " + request.residual_plot + "\n";
  return write_plot(request.residual_plot, figure);
}

/// The module that compares such data, if one of the files holds any.
const Module* module_for(const std::vector<std::string>& files) {
  for (const Module* module : modules())
    if (module->has_data_for != nullptr && std::any_of(files.begin(), files.end(), module->has_data_for)) return module;
  return nullptr;
}

/// A recorded step has no places, no volume and no company.
Result<Outcome> compare_step(const CompareRequest& request, const Module& module) {
  if (request.common.data.size() != 1)
    return problem(ProblemKind::usage, "a recorded step (time_s, dac_V) is compared on its own: give only that file");
  if (!request.at.empty() || request.volume != 0 || !request.residual_plot.empty())
    return problem(ProblemKind::usage,
                   "--at, --volume and --plot-residual apply to measurement files, not to a recorded step");
  ECS_TRY(comparison, module.compare(request.common.model, request.common.data.front()));
  if (!request.plot.empty()) {
    ECS_DO(write_plot(request.plot, comparison.figure));
    comparison.outcome.text += "\nplot written to " + request.plot + "\n";
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
    if (effect.effect.traits().fixed_size || effect.readings == 0) continue;
    if (const auto& all = effect.parameters; std::any_of(all.begin(), all.end(), [](const auto& p) { return !p.held; }))
      fitted += (fitted.empty() ? "" : ", ") + to_text(effect.effect);
  }
  if (!fitted.empty())
    fit->notes.push_back(
        fmt::format("the model has no values for these effects, so they were fitted to these data: {}", fitted));
  return fit;
}

Result<Outcome> compare(VerbContext& context, const CompareRequest& request) {
  ECS_DO(sound(request));
  if (const Module* module = module_for(request.common.data)) return compare_step(request, *module);
  ECS_TRY(work, model_work(context.console, request.common));
  ECS_TRY(fit, in_file(fit_of(work, request.refit), request.common.model));
  const model::Comparison comparison = model::compare(fit, work.data, static_cast<std::size_t>(request.worst));
  Cell answer = comparison_cell(comparison, work.data.size());
  answer.json["notes"] = fit.notes;
  add_uncertainty(answer, fit, work.data);
  if (!fit.notes.empty()) answer.text += "\n" + notes_text(fit.notes);
  const model::Model fitted = with_values(work.model, fit);
  ECS_DO(tell_place(answer, work, fitted, request));
  ECS_DO(tell_volume(answer, work, fitted, request));
  ECS_DO(draw(answer, work, fit, request));
  return outcome_of(answer);
}

}  // namespace

extern const std::vector<Action> kModelFitting{
    action("model fit", "fit the parameters of a model to measured data, with sigmas and correlations",
           "ecs model fit model.toml data.csv --machine machine.toml -o fitted.toml", fit,
           {.logged = Logged::always, .kind = "model"}),
    action("model compare", "show where a model fails: residuals by direction and by every variable",
           "ecs model compare model.toml data.csv --machine machine.toml --at x=-100,y=0,z=0,axis=X\n  "
           "ecs model compare drive_as_printed.toml step_recorded.csv",
           compare, {.logged = Logged::always, .kind = "test"})};

}  // namespace ecs::app
