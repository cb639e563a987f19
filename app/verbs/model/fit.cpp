// `ecs model fit`: the parameters of a model from measured data, with how far they can be trusted.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/json.hpp"
#include "base/paragraph.hpp"
#include "commissioning/models/json.hpp"
#include "commissioning/models/plots.hpp"
#include "commissioning/models/view.hpp"

namespace ecs::app {
namespace {

using model::EffectFit;
using model::Fit;
using model::ParameterEstimate;

constexpr double kStrongCorrelation = 0.9;

struct FitArguments {
  ModelArguments common;
  bool plain = false;
  std::string output;
  std::string plot;
};

std::vector<model::Correlation> strong(const Fit& fit) {
  std::vector<model::Correlation> list;
  for (const model::Correlation& one : fit.correlations)
    if (std::abs(one.value) >= kStrongCorrelation) list.push_back(one);
  return list;
}

// --- as text

std::string sigma_cell(const ParameterEstimate& parameter) {
  if (parameter.held) return "held";
  if (parameter.undetermined) return "undetermined";
  return parameter.sigma ? few_digits(*parameter.sigma, 2) : "-";
}

/// As many digits as the sigma has meaning for.
std::string value_cell(const ParameterEstimate& parameter) {
  if (parameter.held || parameter.undetermined || !parameter.sigma || *parameter.sigma < 1e-9)
    return few_digits(parameter.value, 5);
  const double size = std::max(std::abs(parameter.value), *parameter.sigma);
  return few_digits(parameter.value,
                    2 + std::max(0, static_cast<int>(std::floor(std::log10(size / *parameter.sigma)))));
}

std::string parameter_table(const Fit& fit) {
  std::string text = fmt::format("{} {:>13} {:>13}  {:<13} {:>8}\n", padded("effect and parameter", 28), "value",
                                 "sigma", "unit", "rms [um]");
  for (const EffectFit& effect : fit.effects) {
    text += padded(place_text(effect.effect), 67) +
            (effect.readings > 0 ? fmt::format(" {:>12.3f}\n", effect.rms_um) : std::string("\n"));
    for (const ParameterEstimate& one : effect.parameters)
      text += fmt::format("  {} {:>13} {:>13}  {}\n", padded(one.name, 26), value_cell(one), sigma_cell(one), one.unit);
  }
  return text;
}

std::string noise_by_sense_text(const Fit& fit) {
  std::string text;
  for (const model::NoiseReport& one : fit.noise_by_sense) {
    text += fmt::format("  {} along {}: white {:.3f}", name_of(one.sense), letter_of(one.axis), one.white_um);
    if (one.correlated_um > 0.0)
      text += fmt::format(", correlated {:.3f} over {} ", one.correlated_um, few_digits(one.correlation_time_s, 2)) +
              "(s, or readings without time)";
    text += "\n";
  }
  return text.empty() ? text : "noise [um, um/m]\n" + text;
}

std::string fit_text(const Fit& fit, std::size_t readings) {
  std::string text = fmt::format("{} readings, {} fitted parameters: rms {:.3f} um, peak {:.3f} um\n", readings,
                                 fit.fitted_parameters, fit.rms_um, fit.peak_um);
  text += paragraph(fmt::format("noise of one reading {}; lack of fit: {}; condition {}", noise_text(fit.noise),
                                lack_of_fit_text(fit.lack_of_fit), few_digits(fit.condition)));
  if (!fit.effects.empty()) text += "\n" + parameter_table(fit);
  for (const std::string& one : fit.undetermined) text += paragraph("undetermined: " + one, 0, 2);
  for (const model::Correlation& one : strong(fit))
    text += paragraph(fmt::format("correlated {:+.3f}: {} and {}", one.value, one.first, one.second), 0, 2);
  text += noise_by_sense_text(fit);
  if (!fit.outliers.empty())
    text += paragraph(fmt::format("outliers: rows {} ({} readings): they weigh little, and stay in the rms",
                                  rows_text(fit.outliers), fit.outliers.size()),
                      0, 2);
  return text + notes_text(fit.notes);
}

// --- as JSON

Json effect_json(const EffectFit& effect) {
  Json object = json_of(effect.effect);
  object["parameters"] = json_of(effect.parameters);
  object["rms_um"] = number_or_null(effect.rms_um);
  object["readings"] = effect.readings;
  object["skipped"] = effect.skipped;
  if (!effect.effect.curve.empty()) object["curve"] = json_of(effect.effect.curve);
  return object;
}

Json correlations_json(const Fit& fit) {
  Json out = Json::array();
  for (const model::Correlation& one : strong(fit))
    out.push_back({{"first", one.first}, {"second", one.second}, {"value", number_or_null(one.value)}});
  return out;
}

Json fit_json(const Fit& fit, std::size_t readings, const std::string& output) {
  Json effects = Json::array(), noise = Json::array();
  for (const EffectFit& effect : fit.effects) effects.push_back(effect_json(effect));
  for (const model::NoiseReport& one : fit.noise_by_sense)
    noise.push_back({{"sense", name_of(one.sense)},
                     {"axis", axis_json(one.axis)},
                     {"white_um", number_or_null(one.white_um)},
                     {"correlated_um", number_or_null(one.correlated_um)},
                     {"correlation_time_s", number_or_null(one.correlation_time_s)}});
  return {{"observations", readings},
          {"rms_um", number_or_null(fit.rms_um)},
          {"peak_um", number_or_null(fit.peak_um)},
          {"noise_um", number_or_null(fit.noise.noise_um)},
          {"noise_from_repeats", fit.noise.from_repeats},
          {"lack_of_fit", json_of(fit.lack_of_fit)},
          {"fitted_parameters", fit.fitted_parameters},
          {"condition", number_or_null(fit.condition)},
          {"effects", std::move(effects)},
          {"correlations", correlations_json(fit)},
          {"undetermined", fit.undetermined},
          {"outliers", fit.outliers},
          {"noise", std::move(noise)},
          {"notes", fit.notes},
          {"model", text_or_null(output)}};
}

/// The model with what was fitted; its ladder begins here, if it has none.
model::Model with_start(const ModelWork& work, const Fit& fit) {
  model::Model fitted = with_values(work.model, fit);
  if (!fitted.history.empty()) return fitted;
  double square = 0.0;
  for (const double reading : work.data.reading) square += reading * reading;
  fitted.history.push_back({"",
                            work.data_name,
                            std::sqrt(square / static_cast<double>(work.data.size())),
                            fit.rms_um,
                            fit.peak_um,
                            fit.noise.noise_um,
                            {}});
  return fitted;
}

Result<void> write(const ModelWork& work, const Fit& fit, const FitArguments& arguments) {
  if (!arguments.output.empty())
    if (const auto kept = keep_model(arguments.output, with_start(work, fit), arguments.common.model); !kept)
      return kept;
  if (arguments.plot.empty()) return {};
  return write_plot(
      arguments.plot,
      fit_figure(fit, work.data, fmt::format("rms {:.2f} µm, noise {:.2f} µm", fit.rms_um, fit.noise.noise_um)));
}

Result<Outcome> fit(VerbContext& context, const FitArguments& arguments) {
  if (!arguments.plot.empty())
    if (const auto format = plot_format_of(arguments.plot); !format) return tl::unexpected(format.error());
  const auto work = model_work(context.console, arguments.common);
  if (!work) return tl::unexpected(work.error());
  const auto result = model::fit(work->model, work->data, {arguments.plain});
  if (!result) return tl::unexpected(in_file(result.error(), arguments.common.model));
  if (const auto written = write(*work, *result, arguments); !written) return tl::unexpected(written.error());
  std::string text = fit_text(*result, work->data.size());
  if (!arguments.output.empty()) text += fmt::format("model written to {}\n", arguments.output);
  if (!arguments.plot.empty()) text += fmt::format("plot written to {}\n", arguments.plot);
  return Outcome{text, one_line(fit_json(*result, work->data.size(), arguments.output)), kDone};
}

}  // namespace

extern const VerbDefinition kModelFit = verb<FitArguments>(
    "model fit", "the parameters of a model from measured data, with sigmas and correlations",
    "ecs model fit model.toml data.csv --machine machine.toml -o fitted.toml",
    [](Verb& verb, FitArguments& arguments) {
      take_model_and_data(verb, arguments.common);
      verb.flag("--plain", arguments.plain, "ordinary least squares: every reading counts the same")
          .text("-o,--output", arguments.output, "the model with its values; may be MODEL itself")
          .text("--plot", arguments.plot, "measured against model, as .svg or .png");
    },
    fit);

}  // namespace ecs::app
