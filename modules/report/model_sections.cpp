// Effects found with their evidence, the ladder, and what was predicted beside what was achieved.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commissioning/measurements/fields.hpp"
#include "commissioning/models/view.hpp"
#include "commissioning/models/what_if.hpp"
#include "model/effects/definition.hpp"
#include "modules/report/page.hpp"

namespace ecs::app {
namespace {

std::string um(double value) { return quantity_text(value, decimals_for(value), "um"); }
std::string percent(double share) { return fmt::format("{}\u202f%", number_text(100.0 * share, 1)); }

// --- predicted against achieved

constexpr const char* kByTheMap =
    "By the map: the compensation that the unit outputs at each position and approach, by the same calculation as in "
    "the unit, is added to the readings taken before; the sum is the predicted error. Scatter is part of both. ";

constexpr const char* kAboutMean =
    "The rms values are those after removal of the mean of each line, so that a shift of the laser's zero or of the "
    "datum does not count. In the table by the error model it counts.";

/// A map that was made from these readings holds their noise; with means of n runs noise alone gives √((n + 1)/(n −
/// 1)).
std::string noise_ratio_text(const std::vector<TableRow>& rows) {
  std::size_t fewest = 0;
  for (const TableRow& row : rows)
    if (row.before)
      for (const LineSummary& line : lines_in(row.before->readings.before))
        fewest = fewest == 0 ? line.runs : std::min(fewest, line.runs);
  if (fewest < 2) return "";
  const auto n = static_cast<double>(fewest);
  return fmt::format(
      "The map was made from such readings and contains their noise: with {} runs, noise alone gives {:.1f} in the "
      "column achieved ÷ predicted if no smoothing was applied.",
      fewest, std::sqrt((n + 1.0) / (n - 1.0)));
}

Markup map_prediction(const ReportContent& content) {
  TableMarkup table(
      columns("measurement|>band before|>predicted|>achieved|>rms predicted|>rms achieved|>achieved ÷ predicted|unit"));
  for (std::size_t i = 0; i < content.rows.size(); ++i) {
    const TableRow& row = content.rows[i];
    const PredictedRow& p = content.predicted[i];
    if (!p.band || !row.after) continue;
    const int decimals = decimals_of(row);
    const int fine = decimals_for(std::min(*p.rms, *p.rms_after));
    table.row({element("strong", row.planned.name), cell(row.before->readings.band, decimals), cell(p.band, decimals),
               cell(row.after->readings.band, decimals), cell(p.rms, fine), cell(p.rms_after, fine),
               cell(*p.rms > 0.0 ? std::optional(*p.rms_after / *p.rms) : std::nullopt, 2),
               text(unit_text(laser::unit_of(row.planned.sense)))});
  }
  if (table.empty()) return {};
  return paragraph_of(kByTheMap + noise_ratio_text(content.rows), "class=\"small intro\"") + table.markup() +
         paragraph_of(kAboutMean, "class=\"small\"");
}

Markup directions_table(const ReportedModel& model) {
  TableMarkup table(
      columns("sense|axis|direction|>rms before|>rms predicted|>rms achieved|>achieved ÷ predicted|unit"));
  for (const AfterDirection& one : model.directions) {
    const int decimals = decimals_for(one.predicted_um);
    table.row({element("strong", one.path.empty() ? std::string(name_of(one.sense)) : one.path),
               text(one.path.empty() ? std::string(1, letter_of(one.axis)) : one.axes),
               text(direction_text(one.approach)), cell(one.now_um, decimals), cell(one.predicted_um, decimals),
               cell(one.achieved_um, decimals),
               cell(one.achieved_um && one.predicted_um > 0.0 ? std::optional(*one.achieved_um / one.predicted_um)
                                                              : std::nullopt,
                    2),
               text(unit_text(laser::unit_of(one.sense)))});
  }
  return table.markup();
}

Markup model_prediction(const ReportedModel& model) {
  const bool any_straightness = std::ranges::any_of(model.directions, [](const AfterDirection& one) {
    return one.path.empty() && !is_rotation(one.sense) && direction_of(one.sense) != one.axis;
  });
  return element("h3", "By the error model") +
         paragraph_of(fmt::format("{} ({}). {}", counted(model.readings, "reading", "readings"), model.data,
                                  unit_text(without_commands(what_if_summary(model.what_if, model.model))))) +
         directions_table(model) +
         (any_straightness
              ? paragraph_of("The rms values of straightness here include the slope of the deviations over "
                             "the position (µm/m, positive where the deviation grows with the position): squareness "
                             "of the axes, or alignment of the straight edge or optics. The summary removes that "
                             "slope, so the two tables differ by it.",
                             "class=\"small\"")
              : Markup());
}

// --- effects

Markup evidence_table(const ReportedDiagnosis& d, bool named) {
  TableMarkup table(columns(fmt::format("{}|>rms after [µm]|>explained|>held out before → after [µm]",
                                        named ? "effect" : "rival or weaker explanation")));
  std::size_t left_out = 0;
  for (const ReportedEffect& effect : d.effects) {
    if (effect.named != named) continue;
    if (!named && table.rows() == kMostRivals) {
      ++left_out;
      continue;
    }
    const auto held = effect.held_out_before_um && effect.held_out_after_um
                          ? fmt::format("{} → {}", number_text(*effect.held_out_before_um, 2),
                                        number_text(*effect.held_out_after_um, 2))
                          : std::string("\u2013");
    table.row({element("strong", effect.place), cell(effect.rms_after_um, 2),
               text(effect.explained ? percent(std::max(0.0, *effect.explained)) : "\u2013"), text(held)});
  }
  if (table.empty()) return {};
  if (left_out == 0) return table.markup();
  return table.markup() +
         paragraph_of(fmt::format("{} not shown.", counted(left_out, "more is", "more are")), "class=\"small\"");
}

Markup details(const ReportedDiagnosis& d) {
  Markup out;
  for (const ReportedEffect& effect : d.effects) {
    if (!effect.named) continue;
    Markup body = element("h3", fmt::format("{}: {}", effect.title, effect.place));
    if (!effect.parameters.empty())
      body += paragraph_of(fmt::format("{} (±: standard uncertainty, k = 1)", fmt::join(effect.parameters, ", ")));
    if (!effect.because.empty()) body += paragraph_of(unit_text(without_commands(effect.because)));
    if (!effect.but.empty()) body += paragraph_of(fmt::format("Likely, but not proved: {}.", unit_text(effect.but)));
    std::vector<std::string> facts;
    for (const EffectFact& fact : effect.facts) facts.push_back(fmt::format("{}: {}", fact.label, fact.text));
    if (!facts.empty()) body += list_of(facts);
    body += paragraph_of(effect.rivals.empty()
                             ? "No other effect of the library explains these data equally well."
                             : fmt::format("Cannot be distinguished from: {}.", first_few(effect.rivals)));
    if (!effect.next_measurement.empty()) body += paragraph_of("Next: " + without_commands(effect.next_measurement));
    out += element("article", body);
  }
  return out;
}

Markup diagnosis_part(const ReportedDiagnosis& d) {
  Markup body = paragraph_of(unit_text(without_commands(d.headline)), "class=\"lead\"");
  std::string numbers = fmt::format("{}: the residual is {} rms; the noise of one reading is {}.",
                                    counted(d.readings, "reading", "readings"), um(d.rms_um), um(d.noise_um));
  if (d.rms_after_um && *d.rms_after_um < d.rms_um && d.verdict != "adequate")
    numbers += fmt::format(" With {}: rms {}.",
                           d.verdict == "missing_effect" ? "the named effects" : "the proved or likely effects",
                           um(*d.rms_after_um));
  body += paragraph_of(numbers);
  body += evidence_table(d, true) + details(d) + evidence_table(d, false);
  std::vector<std::string> where;
  for (const ReportedDependence& one : d.where)
    if (one.strength >= 0.01) where.push_back(fmt::format("{} {}", one.variable, percent(one.strength)));
  if (!where.empty())
    body += paragraph_of(fmt::format(
        "Variables that the residual depends on, with the share of its variance that each explains alone: {}.",
        fmt::join(where, ", ")));
  if (!d.left.empty()) {
    body += paragraph_of(
        "Properties of the residual, with the assumptions tried: the part of the residual that each alone reproduces "
        "(share of the variance above noise):");
    body += list_of(d.left);
  }
  if (!d.formula.empty()) body += paragraph_of(fmt::format("As a formula: {}.", d.formula));
  if (d.noise_replicates > 0 && !d.effects.empty())
    body += paragraph_of(fmt::format("Noise alone was simulated {} times on the same design. Held out: rms of readings "
                                     "that were not used to fit the effect.",
                                     d.noise_replicates),
                         "class=\"small\"");
  if (!d.notes.empty()) body += element("div", list_of(without_commands(d.notes)), "class=\"small\"");
  return body;
}

std::string parameters_in_words(const model::EffectFit& fit) {
  std::vector<std::string> words;
  for (const model::ParameterEstimate& one : fit.parameters) {
    if (one.value == 0.0 && !one.sigma) continue;
    if (one.undetermined) {
      words.push_back(parameters_text({one}));
      continue;
    }
    std::string value = parameter_text(shown_name(one), one.unit, one.value, one.sigma);
    if (one.held) value += " (fixed)";
    words.push_back(std::move(value));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

Markup effects_table(const ReportedModel& model) {
  TableMarkup table(columns(
      "effect in the model|cause|values (±: standard uncertainty, k = 1)|>rms [µm]|compensated by, or why not"));
  for (const model::EffectFit& fit : model.effects) {
    const auto share = std::find_if(model.what_if.shares.begin(), model.what_if.shares.end(),
                                    [&](const auto& s) { return s.effect == to_text(fit.effect); });
    const std::string how = share == model.what_if.shares.end() ? "" : (share->carried ? "" : "not: ") + share->how;
    table.row({element("strong", name_with_alternatives(fit.effect)),
               text(fit.effect.is_user() ? fit.effect.name : title_of(fit.effect)), text(parameters_in_words(fit)),
               cell(fit.rms_um, 2), text(how)});
  }
  return table.markup();
}

/// Cut to the space beside the bars; characters stay whole.
std::string cut(const std::string& name) {
  constexpr std::size_t kRoom = 34;
  if (name.size() <= kRoom) return name;
  std::size_t end = kRoom - 1;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0U) == 0x80U) --end;
  return name.substr(0, end) + "…";
}

Markup ladder(const std::vector<model::LadderStep>& history) {
  PlotPanel panel{"", "", "rms [µm]", {}};
  PlotSeries bars{"rms", Mark::bar, {}};
  PlotSeries noise{fmt::format("noise {}", um(history.back().noise_um)), Mark::level, {}};
  TableMarkup table(columns("step|effect added|>rms before [µm]|>rms [µm]|>peak [µm]|>noise [µm]|>held out [µm]"));
  for (std::size_t i = 0; i < history.size(); ++i) {
    const model::LadderStep& step = history[i];
    const std::string name = step.effect.empty() ? "start" : step.effect;
    panel.x_names.push_back(cut(name));
    bars.points.push_back({static_cast<double>(i), step.rms_um});
    bars.labels.push_back(um(step.rms_um));
    if (history.back().noise_um > 0.0) noise.points.push_back({static_cast<double>(i), history.back().noise_um});
    table.row({text(fmt::format("{}", i)), element("strong", name), cell(step.rms_before_um, 2), cell(step.rms_um, 2),
               cell(step.peak_um, 2), cell(step.noise_um, 2), cell(step.held_out_rms_um, 2)});
  }
  panel.series = {std::move(bars), std::move(noise)};
  const PlotFigure figure{"rms of the residual after each effect", {std::move(panel)}, 1, false};
  return element("article", element("h3", "The ladder: error after every effect added") +
                                element("figure", inline_svg(figure)) + table.markup());
}

}  // namespace

ReportSection prediction_section(const ReportContent& content) {
  const Markup by_map = content.predicted.empty() ? Markup() : map_prediction(content);
  const std::string why =
      fmt::format("no prediction by the map: {}",
                  content.predicted.empty() ? content.no_prediction : "no line was measured both before and after");
  if (by_map.empty() && !content.model) return {"prediction", "Predicted against achieved", {}, why};
  Markup body = by_map.empty() ? absence("There is " + why + ".") : by_map;
  if (content.model) body += model_prediction(*content.model);
  return {"prediction", "Predicted against achieved", std::move(body)};
}

ReportSection effects_section(const ReportContent& content) {
  if (!content.diagnosis && !content.model)
    return {"effects",
            "Effects found",
            {},
            "no error model and no diagnosis were given: the physical causes of these errors were not examined"};
  Markup body;
  if (content.diagnosis) body += diagnosis_part(*content.diagnosis);
  if (content.model) {
    body += element("h3", "The error model") +
            paragraph_of(fmt::format("Fitted to {} ({}).", counted(content.model->readings, "reading", "readings"),
                                     content.model->data)) +
            effects_table(*content.model);
    if (!content.model->model.history.empty()) body += ladder(content.model->model.history);
  }
  return {"effects", "Effects found", std::move(body)};
}

}  // namespace ecs::app
