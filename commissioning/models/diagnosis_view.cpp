#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "commissioning/models/view.hpp"
#include "model/diagnosis/words.hpp"
#include "model/effects/definition.hpp"

namespace ecs::commissioning {
namespace {

using model::Comparison;

/// A residual of this many times the noise of one reading is no noise, whatever a test against repeats says.
constexpr double kFarAboveNoise = 2.0, kAboveNoise = 1.3;

double largest_in(const std::vector<ShapePoint>& points) {
  double largest = 0.0;
  for (const ShapePoint& point : points) largest = std::max(largest, std::abs(point.um));
  return largest;
}

/// That a model fits the scatter of repeats says little where the runs differ far more than readings of one run.
bool runs_differ(const std::optional<model::LackOfFit>& test, double rms_um, double noise_um) {
  return test && !test->fails() && !test->is_in_doubt() && rms_um > kFarAboveNoise * noise_um;
}

Cell direction_cell(const model::DirectionSummary& d, bool rotary, double noise_um) {
  Cell lack_of_fit = lack_of_fit_cell(d.lack_of_fit);
  if (!is_rotation(d.sense) && runs_differ(d.lack_of_fit, d.rms_um, noise_um))
    lack_of_fit.text = "no answer: runs differ";
  return record_cell(
      "{sense:<5} {axis:<4} {approach:<11} {readings:>8} {bias_um:>8} {rms_um:>8} {peak_um:>8}   {lack_of_fit}\n",
      "sense"_is(d.path.empty() ? std::string(name_of(d.sense)) : d.path),
      "axis"_is(d.path.empty() ? axis_json(d.axis, rotary) : d.axes),
      "approach"_is(d.approach, std::string(direction_text(d.approach))),
      "bias_um"_is(d.bias_um, fmt::format("{:.3f}", std::round(1e3 * d.bias_um) / 1e3 + 0.0)), "rms_um"_is(d.rms_um, 3),
      "peak_um"_is(d.peak_um, 3), "lack_of_fit"_is(std::move(lack_of_fit)), "readings"_is(d.readings));
}

Cell directions_cell(const Comparison& c) {
  Cell list = list_cell(
      c.directions, [&](const auto& one) { return direction_cell(one, c.rotary, c.noise.noise_um); },
      "sense axis direction   readings     bias      rms     peak   lack of fit\n");
  list.text += "bias, rms, peak of the residual (reading - model): um; um/m for EA EB EC\n";
  return list;
}

Cell worst_cell(const Comparison& c) {
  if (c.worst.empty()) return {Json::array(), ""};
  const std::string letters = c.rotary ? "a          b          c" : "x          y          z";
  Cell list{Json::array(),
            fmt::format("\nlargest residuals\n   row sense axis          {} dir  run   reading  residual\n", letters)};
  for (const model::WorstPlace& w : c.worst) {
    AnswerFields fields = described("row"_is(w.row), "axis"_is(w.path.empty() ? axis_json(w.axis, c.rotary) : w.axes),
                                    "sense"_is(w.path.empty() ? std::string(name_of(w.sense)) : w.path));
    add_position(fields, w.position_mm, c.rotary);
    append(fields, "approach"_is(w.approach, w.approach == 0 ? "" : (w.approach > 0 ? "fwd" : "rev")), "run"_is(w.run),
           "reading_um"_is(w.reading_um, 2), "predicted_um"_is(w.predicted_um, 2), "residual_um"_is(w.residual_um, 2));
    list.add(record_cell(fmt::format("{{row:>6}} {{sense:<5}} {{axis:<4}} {} {{approach:>3}} {{run:>4}} "
                                     "{{reading_um:>9}} {{residual_um:>9}}\n",
                                     position_layout(c.rotary)),
                         fields));
  }
  return list;
}

std::vector<const model::ResidualView*> by_share(const Comparison& c) {
  std::vector<const model::ResidualView*> list;
  for (const model::ResidualView& view : c.views) list.push_back(&view);
  std::stable_sort(list.begin(), list.end(), [](const auto* a, const auto* b) { return a->share > b->share; });
  return list;
}

Cell variable_cell(const model::ResidualView& view) {
  Json bins = Json::array();
  for (const model::ResidualBin& bin : view.bins)
    bins.push_back(object_of("from"_is(bin.from), "to"_is(bin.to), "mean_um"_is(bin.mean_um),
                             "sigma_um"_is(bin.sigma_um), "rms_um"_is(bin.rms_um), "readings"_is(bin.readings)));
  return record_cell("  {variable} {share:>6} %\n", "variable"_is(view.variable, padded(view.variable, 26)),
                     "share"_is(view.share, fmt::format("{:.1f}", 100.0 * view.share)), "bins"_is(std::move(bins)));
}

/// "EX", "circle XY": of which the comparison has readings.
std::vector<std::string> senses_of(const Comparison& c) {
  std::vector<std::string> senses;
  for (const model::DirectionSummary& one : c.directions)
    if (std::string sense = one.path.empty() ? std::string(name_of(one.sense)) : one.path;
        std::ranges::find(senses, sense) == senses.end())
      senses.push_back(std::move(sense));
  return senses;
}

/// The variable and the sense of a view of one sense among several: "x_mm", "EX" of "x_mm of EX"; else "".
std::pair<std::string, std::string> parts_of(const model::ResidualView& view, const std::vector<std::string>& senses) {
  for (const std::string& sense : senses)
    if (const std::string of = " of " + sense; view.variable.ends_with(of))
      return {view.variable.substr(0, view.variable.size() - of.size()), sense};
  return {view.variable, ""};
}

/// Of several senses a curve for each: together they may cancel.
Cell variables_cell(const Comparison& c) {
  if (c.views.empty()) return {Json::array(), ""};
  const std::vector<std::string> senses = senses_of(c);
  Cell list{Json::array(), "\nshare of the residual variance that each variable explains, beyond noise\n"};
  std::string shown;
  std::size_t shapes = 0;
  for (const model::ResidualView* view : by_share(c)) {
    const auto [variable, sense] = parts_of(*view, senses);
    const bool is_worth = view->share >= kWorthAShape;
    Cell one = variable_cell(*view);
    if (!sense.empty() && !is_worth) one.text.clear();
    list.add(one);
    if (!is_worth || view->bins.empty() || (senses.size() > 1 && sense.empty())) continue;  // a product has no axis
    std::vector<ShapePoint> points;
    for (const model::ResidualBin& bin : view->bins) points.push_back({0.5 * (bin.from + bin.to), bin.mean_um});
    if (largest_in(points) < kWorthABar * c.noise.noise_um || ++shapes > kMostShapes) continue;
    shown += "\n" + shape_text(variable, points, c.noise.unit,
                               sense.empty() ? std::vector<std::string>() : std::vector{sense});
  }
  list.text += shown;
  return list;
}

std::string outliers_text(const Comparison& c) {
  if (c.outliers.empty()) return {};
  return "\n" + paragraph(fmt::format("outliers: row{} {} ({} of the readings)", c.outliers.size() == 1 ? "" : "s",
                                      rows_text(c.outliers), c.outliers.size()),
                          0, 2);
}

}  // namespace

std::string lack_of_fit_text(const std::optional<model::LackOfFit>& test, double rms_um, double noise_um) {
  if (runs_differ(test, rms_um, noise_um))
    return "no answer, because the differences between runs are as large as the residual";
  std::string text = lack_of_fit_cell(test).text;
  if (test && !test->fails() && !test->is_in_doubt() && rms_um > kAboveNoise * noise_um)
    text +=
        fmt::format(", although the residual is {:.1f} times the noise: the test allows for differences between runs",
                    rms_um / noise_um);
  return text;
}

Cell comparison_cell(const Comparison& c, std::size_t readings) {
  const Cell lack_of_fit = lack_of_fit_cell(c.lack_of_fit);
  const std::string judged = lack_of_fit_text(c.lack_of_fit, c.outliers.empty() ? c.rms_um : 0.0, c.noise.noise_um);
  constexpr std::size_t kFewForNoise = 16;  // as neighbours judge it from (model/fit/noise.cpp)
  const std::string few = readings < kFewForNoise && !c.noise.from_repeats
                              ? fmt::format(", uncertain with only {} readings", readings)
                              : std::string();
  const std::string drift = runs_differ(c.lack_of_fit, c.outliers.empty() ? c.rms_um : 0.0, c.noise.noise_um)
                                ? " (slow changes removed)"
                                : "";
  const std::string summary = paragraph(fmt::format(
      "{} readings: rms {}, peak {}; noise of one reading with this model: {}; lack-of-fit test of the model: {}",
      readings, in_each_unit(c.rms_um, c.rms_by_unit, c.noise.unit),
      in_each_unit(c.peak_um, c.peak_by_unit, c.noise.unit), noise_text(c.noise) + few + drift, judged));
  Cell answer = record_cell(
      "{summary}\n{directions}{variables}{worst}{outliers}", "observations"_is(readings), "summary"_shown(summary),
      "rms_um"_is(c.rms_um), "peak_um"_is(c.peak_um), "noise_um"_is(c.noise.noise_um),
      "noise_from_repeats"_is(c.noise.from_repeats), "lack_of_fit"_is(lack_of_fit), "directions"_is(directions_cell(c)),
      "variables"_is(variables_cell(c)), "worst"_is(worst_cell(c)), "outliers"_is(c.outliers, outliers_text(c)));
  add_by_unit(answer.json, c.noise.unit,
              {{"rms", c.rms_by_unit}, {"peak", c.peak_by_unit}, {"noise", c.noise.by_unit}});
  return answer;
}

namespace {

using model::Candidate;
using model::Diagnosis;
using model::Verdict;

/// "63.813 um rms (6.420 um without the outliers)"
std::string rms_text(const Diagnosis& d, const std::string& rms, const std::string& kept_rms) {
  return d.outliers.empty() ? rms + " rms" : fmt::format("{} rms ({} without the outliers)", rms, kept_rms);
}

std::string summary(const Diagnosis& d) {
  std::string text = fmt::format("{} readings. The residual is {}", d.observations,
                                 rms_text(d, in_each_unit(d.rms_um, d.rms_by_unit, d.noise.unit),
                                          in_each_unit(d.kept_rms_um, d.kept_by_unit, d.noise.unit)));
  if (d.verdict != Verdict::adequate && d.rms_after_um < d.rms_um)
    text += fmt::format(". With {} it is {}{}, and the noise of one reading is then {}. ",
                        d.add ? "the proved or likely effects" : "the named effects",
                        rms_text(d, in_each_unit(d.rms_after_um, d.rms_after_by_unit, d.noise.unit),
                                 in_each_unit(d.kept_rms_after_um, d.kept_after_by_unit, d.noise.unit)),
                        d.outliers.empty() && d.rms_after_um <= d.noise.noise_um ? ", no more than the noise" : "",
                        noise_text(d.noise));
  else
    text += fmt::format("; the noise of one reading is {}. ", noise_text(d.noise));
  const bool is_judged = d.outliers.empty() || d.verdict != Verdict::adequate;
  text += "Lack-of-fit test: " + lack_of_fit_text(d.lack_of_fit, is_judged ? d.rms_um : 0.0, d.noise.noise_um);
  if (d.lack_of_fit_after && d.verdict == Verdict::missing_effect)
    text +=
        fmt::format(". After the named effects are added and fitted, {}", lack_of_fit_cell(d.lack_of_fit_after).text);
  return paragraph(text + ".");
}

std::string percent(double share) { return fmt::format("{:.1f} %", 100.0 * share); }

std::string head(const Diagnosis& d) {
  return fmt::format("{:40}{:>13}{:>17}\n{:>40}    explained   before    after\n",
                     "                               rms after", "variance", fmt::format("held out [{}]", d.noise.unit),
                     fmt::format("[{}]", d.noise.unit));
}

/// "cyclic:X:EX, reverse 93 %; progressive:X:EX 6.5 %", each place once
/// "57.3 %", but "over 99 %" where its digits would say 100 and "under 0.1 %" for the least.
std::string probability_text(double probability, int digits) {
  const double percent = 100.0 * probability;
  if (digits < 3 && percent > 99.0) return "over 99 %";
  if (digits < 3 && percent < 0.1) return "under 0.1 %";
  return fmt::format("{:.{}g} %", percent, digits);
}

std::string set_text(const std::vector<model::SetMember>& set, int digits = 3) {
  std::vector<model::SetMember> members;
  for (const model::SetMember& member : set) {
    const auto same = std::find_if(members.begin(), members.end(),
                                   [&](const model::SetMember& one) { return one.place == member.place; });
    if (same == members.end())
      members.push_back(member);
    else
      same->probability += member.probability;
  }
  std::vector<std::string> words;
  for (const model::SetMember& member : members)
    words.push_back(member.place + " " + probability_text(member.probability, digits));
  return fmt::format("{}", fmt::join(words, "; "));
}

Json set_json(const std::vector<model::SetMember>& set) {
  Json list = Json::array();
  for (const model::SetMember& member : set)
    list.push_back(object_of("name"_is(member.name), "probability"_is(member.probability), "place"_is(member.place)));
  return list;
}

Json own_terms_json(const std::vector<model::OwnTerm>& terms) {
  Json list = Json::array();
  for (const model::OwnTerm& term : terms) list.push_back(object_of("effect"_is(term.effect), "value"_is(term.value)));
  return list;
}

/// Far above the residual without the effect a number would say no more than that it predicts nothing.
std::string held_out_cell(const Candidate& c) {
  constexpr double kFarAbove = 10.0;
  if (!c.held_out_rms_um) return "-";
  const bool is_far = c.held_out_rms_before_um && *c.held_out_rms_um > kFarAbove * *c.held_out_rms_before_um;
  return is_far ? "> 10 x" : fmt::format("{:.3f}", *c.held_out_rms_um);
}

/// "period_mm 8, 16 or 25.01": all values that fit as well.
std::string values_text(const Candidate& c) {
  constexpr std::size_t kMostShown = 8;
  const std::string searched(c.effect.definition().searched_parameter());
  const auto found = c.parameters_set.find(searched);
  if (found == c.parameters_set.end()) return {};
  std::vector<std::string> values;
  for (const double value : found->second)
    if (values.size() < kMostShown) values.push_back(fmt::format("{:.5g}", value));
  const std::string all = fmt::format("{}", fmt::join(values, c.effect.definition().search.has_slope ? ", " : " to "));
  return fmt::format("{} {}{}: all fit equally well", model::shown_name(searched, c.effect), all,
                     found->second.size() > kMostShown ? " and more" : "");
}

/// In front of the numbers of its row, which is the next where the name is longer.
std::string place_in_table(const model::EffectInstance& effect) {
  constexpr int kRoom = 30;
  const std::string name = place_text(effect);
  return name.size() <= kRoom ? padded(name, kRoom) : name + "\n" + std::string(kRoom, ' ');
}

Json parameters_set_json(const Candidate& candidate) {
  Json sets = Json::object();
  for (const auto& [name, values] : candidate.parameters_set) sets[model::shown_name(name, candidate.effect)] = values;
  return sets;
}

/// In JSON only, except for the row of evidence and, of what is named, the paragraphs below it. The row leaves out the
/// outliers.
Cell candidate_cell(const Candidate& c, const Diagnosis& d) {
  const bool is_one_of_several = c.in_answer() && std::ranges::count_if(d.candidates, &Candidate::in_answer) > 1;
  const double shown_rms_um = d.outliers.empty() ? c.rms_after_um : c.kept_rms_after_um;
  Json values = Json::object(), sigmas = Json::object();
  for (const model::ParameterEstimate& one : c.parameters) {
    values[model::shown_name(one)] = number_or_null(one.value);
    sigmas[model::shown_name(one)] = number_or_null(one.sigma);
  }
  const auto details = [](bool any, const std::string& text) { return any ? paragraph(text, 2, 4) : std::string(); };
  std::vector<std::string> rivals, improbable;
  for (const model::EffectInstance& rival : c.rivals)
    (c.is_open(rival) ? rivals : improbable)
        .push_back(is_of_measurement(rival)
                       ? fmt::format("{} (error of the measurement: {})", place_text(rival), rival.definition().cause)
                       : place_text(rival));
  std::vector<std::string> rivals_of_parts;
  for (const model::RivalOfPart& rival : c.in_part) rivals_of_parts.push_back(to_text(rival.other));
  AnswerFields fields = described(
      inlined({effect_json(c.effect), ""}), "place"_shown(place_in_table(c.effect)),
      "parameters"_is(values,
                      details(!c.parameters.empty(),
                              parameters_text(c.parameters) +
                                  (is_one_of_several ? " (values fitted together with the other effects)" : ""))),
      "sigma"_is(sigmas), "undetermined"_is(model::is_undetermined(c.effect, c.parameters), ""), "named"_is(c.named),
      "standing"_is(name_of(c.standing)), "but"_is(text_or_null(c.but), details(!c.but.empty(), "but: " + c.but)),
      "decide"_is(text_or_null(c.decide), details(!c.decide.empty(), "to decide: " + c.decide)),
      "rms_after_um"_is(c.rms_after_um, fmt::format("{:.3f}", shown_rms_um)),
      "explained"_is(c.explained, percent(c.shown_explained())), "explainable_share"_is(c.explainable_share),
      "p_value"_is(c.p_value, ""), "false_naming"_is(c.false_naming), "probability"_is(c.probability),
      "set"_is(set_json(c.set),
               details(c.set.size() > 1, "one of these (more than 99 % together): " + set_text(c.set))),
      "parameters_set"_is(parameters_set_json(c), details(!c.parameters_set.empty(), values_text(c))),
      "e_value"_is(c.e_value), "found"_is(c.found),
      "tried_at"_is(object_of("value"_is(c.tried_at.value), "coefficients"_is(c.tried_at.coefficients))),
      "held_out_rms_um"_is(c.held_out_rms_um, held_out_cell(c)),
      "held_out_rms_before_um"_is(c.held_out_rms_before_um, 3),
      "skipped"_is(c.skipped, details(c.skipped > 0, fmt::format("{} readings lack a cell that it needs", c.skipped))),
      "indistinguishable_from"_is(
          c.indistinguishable_from,
          details(!rivals.empty(), fmt::format("cannot be distinguished from: {}", fmt::join(rivals, ", "))) +
              details(
                  !improbable.empty(),
                  fmt::format("as good a fit, but improbable (below 1 %): it needs more fitted values, or is rarer: {}",
                              fmt::join(improbable, ", ")))),
      "indistinguishable_in_part"_is(rivals_of_parts),
      "because"_is(c.because, details(!c.because.empty(), "because: " + c.because)),
      "next_measurement"_is(
          c.next_measurement,
          details(!c.next_measurement.empty() && (c.decide.empty() || !rivals.empty()),
                  (c.decide.empty() ? "next: " : "then, to separate the rivals: ") + c.next_measurement)));
  if (!c.effect.curve.empty()) fields.push_back("curve"_is(curve_json(c.effect.curve)));
  if (!c.apart.empty()) fields.push_back("apart"_is(c.apart));
  return {
      object_of(fields),
      laid_out("{place} {rms_after_um:>9} {explained:>12} {held_out_rms_before_um:>8} {held_out_rms_um:>8}\n", fields) +
          (c.in_answer() ? laid_out("{parameters}{parameters_set}{because}{but}{decide}{set}{indistinguishable_from}{"
                                    "skipped}{next_measurement}",
                                    fields)
                         : std::string())};
}

/// Nothing is named: how likely the closest candidates are beside noise.
std::string closest_text(const Diagnosis& d) {
  std::vector<model::SetMember> closest;
  constexpr std::size_t kMostShown = 5;
  constexpr double kLeastShown = 0.001;
  for (const Candidate& candidate : d.candidates)
    if (closest.size() < kMostShown && (closest.empty() || candidate.probability >= kLeastShown))
      closest.push_back({to_text(candidate.effect), candidate.probability, place_text(candidate.effect)});
  if (closest.empty()) return {};
  return "\n" +
         paragraph(
             "Effects that may be hidden in the noise, each with the probability that it is present if the noise is as "
             "stated: " +
                 set_text(closest, 2),
             0, 2);
}

/// What adding the likely effects would do, and how.
std::string add_text(const Diagnosis& d) {
  if (!d.add) return {};
  const bool proved =
      std::any_of(d.candidates.begin(), d.candidates.end(), [](const Candidate& candidate) { return candidate.named; });
  return "\n" + paragraph(fmt::format("To try it: add {}{} with `ecs model add MODEL EFFECT DATA`. On held-out "
                                      "readings the residual is "
                                      "then expected to {} from {} to {} {} rms.",
                                      proved ? "the proved effects, then " : "", fmt::join(d.add->effects, ", then "),
                                      d.add->held_out_rms_um < d.add->held_out_rms_before_um ? "fall" : "change",
                                      model::in_digits(d.add->held_out_rms_before_um),
                                      model::in_digits(d.add->held_out_rms_um), d.noise.unit),
                          0, 2);
}

Json add_json(const Diagnosis& d) {
  if (!d.add) return nullptr;
  return object_of("effects"_is(d.add->effects), "held_out_rms_before_um"_is(d.add->held_out_rms_before_um),
                   "held_out_rms_um"_is(d.add->held_out_rms_um));
}

Cell candidates_cell(const Diagnosis& d) {
  Json list = Json::array();
  std::string named, likely, rivals;
  for (const Candidate& candidate : d.candidates) {
    const Cell one = candidate_cell(candidate, d);
    list.push_back(one.json);
    (candidate.named ? named : candidate.in_answer() ? likely : rivals) += one.text;
  }
  const auto titled_table = [&](std::string_view title, const std::string& rows) {
    return rows.empty()
               ? std::string()
               : fmt::format("\n{}{}\n{}{}", title, d.outliers.empty() ? "" : " (without the outliers)", head(d), rows);
  };
  if (d.verdict == Verdict::adequate || d.verdict == Verdict::cannot_tell) return {std::move(list), closest_text(d)};
  const bool of_groups =
      std::ranges::any_of(d.candidates, [](const Candidate& one) { return one.in_answer() && one.set.size() > 1; });
  return {std::move(list),
          titled_table(fmt::format("proved effects (columns: each effect alone{})",
                                   of_groups ? ". Where causes cannot be\ndistinguished, one of them is proved to be "
                                               "present, but not which; the fitted one is listed"
                                             : ""),
                       named) +
              titled_table("likely effects, not proved", likely) + add_text(d) +
              titled_table(
                  fmt::format("{}candidates (columns: each alone{})", named.empty() && likely.empty() ? "" : "other ",
                              rivals.find(" -\n") == std::string::npos ? "" : "; -: not computed"),
                  rivals)};
}

std::vector<ShapePoint> shape_of(const model::Dependence& one) {
  std::vector<ShapePoint> points;
  for (std::size_t i = 0; i < std::min(one.at.size(), one.mean_um.size()); ++i)
    points.push_back({one.at[i], one.mean_um[i]});
  return points;
}

constexpr double kLeastProbability = 1e-300;  ///< smaller ones are stated as this

Cell where_cell(const Diagnosis& d) {
  const bool with_answer = std::ranges::any_of(d.candidates, &Candidate::in_answer);
  Cell where{Json::array(), d.where.empty() ? ""
                            : with_answer ? "\nvariables on which the present residual depends (share of its variance "
                                            "that each explains alone)\n"
                                          : "\nvariables on which the residual depends (share of its variance that "
                                            "each explains alone)\n"};
  for (const model::Dependence& one : d.where)
    where.add(record_cell(
        "  {variable} {strength:>8}  probability that noise alone varies with it as much: {p_value}\n",
        "variable"_is(one.variable, padded(one.variable, 26)), "strength"_is(one.strength, percent(one.strength)),
        "p_value"_is(one.p_value, one.p_value <= kLeastProbability ? "< 1e-300" : fmt::format("{:.1g}", one.p_value)),
        "at"_is(numbers_json(one.at)), "mean_um"_is(numbers_json(one.mean_um)),
        "looks_like"_is(one.looks_like.empty() ? Json() : Json(one.looks_like))));
  bool any = false;
  for (const model::Dependence& one : d.where) {
    if (one.looks_like.empty()) continue;
    if (with_answer && !any) where.text += "  with the named effects, the residual over\n";
    any = true;
    where.text += paragraph(fmt::format("{}: {}", one.variable, one.looks_like), with_answer ? 4 : 2, 6);
  }
  std::size_t shapes = 0;
  for (const model::Dependence& one : d.where) {
    const std::vector<ShapePoint> points = shape_of(one);
    if (one.strength < kWorthAShape || largest_in(points) < kWorthABar * d.noise.noise_um || ++shapes > kMostShapes)
      continue;
    if (shapes == 1 && with_answer && any) where.text += "  before any effect is added\n";
    where.text += "\n" + shape_text(one.variable, points, d.noise.unit);
  }
  return where;
}

}  // namespace

std::string words_for_property(const std::string& property) {
  constexpr std::pair<std::string_view, std::string_view> kWords[] = {
      {"direction", "direction of approach"},
      {"position", "dependence on position"},
      {"turn", "variation within a turn"},
      {"frame", "belongs to (machine, set-up, another axis)"},
      {"growth", "another variable (time, load, feed, temperature, other axes)"},
      {"session", "runs and set-ups"},
      {"clock", "delay"},
      {"excitation", "excitation by these readings"},
      {"instrument", "instrument"}};
  for (const auto& [name, words] : kWords)
    if (name == property) return std::string(words);
  return property;
}

std::string words_for_answer(const std::string& property, const std::string& is) {
  constexpr std::pair<std::string_view, std::string_view> kDirections[] = {{"even", "the same in both directions"},
                                                                           {"odd", "opposite in the two directions"},
                                                                           {"forward", "forward only"},
                                                                           {"reverse", "reverse only"}};
  if (property == "direction")
    for (const auto& [name, words] : kDirections)
      if (name == is) return std::string(words);
  if (property == "position" && is == "odd") return "of opposite sign on the two sides";
  if (property == "position" && is == "even") return "symmetric";
  if (property == "frame") return is == "workpiece" ? "the set-up, with which it moves" : is;
  if (property == "growth")
    return is == "none" ? "the residual changes with none of those that were varied" : "changes with " + is;
  if (property == "session")
    return is == "none" ? "the residual does not differ between them" : "different in each " + is;
  return is;
}

namespace {

/// "none" beside another change means that this one is not needed once the other is included.
std::string answer_text(const model::LeftProperty& one, const Diagnosis& d) {
  std::string text = words_for_answer(one.property, one.is);
  if (one.is != "none") return text;
  for (const model::LeftProperty& other : d.left)
    if (other.property == "growth" && !other.is.empty() && other.is != "none")
      text += fmt::format(", once the change with {} is allowed for", other.is);
    else if (other.property == "session" && !other.is.empty() && other.is != "none")
      text = fmt::format(
          "within each {0}, {1}. If the table above shows a dependence on one of them, it comes from the "
          "differences between the {0}s",
          other.is == "run" ? "run" : "set-up", text);
  return text;
}

/// Of a property that is not told: what remains open.
std::string question_of(const std::string& property) {
  constexpr std::pair<std::string_view, std::string_view> kQuestions[] = {
      {"direction", "whether the error depends on the direction of approach"},
      {"position",
       "how the error depends on position (the same everywhere, symmetric, or of opposite sign on the two sides)"},
      {"turn", "how it repeats over a turn"},
      {"frame", "whether it belongs to the machine or to the set-up"},
      {"growth", "whether it changes with another variable (time, load, feed, temperature, other axes)"},
      {"session", "whether it differs between runs or set-ups"}};
  for (const auto& [name, question] : kQuestions)
    if (name == property) return std::string(question);
  return words_for_property(property);
}

/// What is told, evidence that several share once; then what is not, and what would tell.
Cell left_cell(const Diagnosis& d) {
  Cell left{Json::array(), ""};
  if (!d.left.empty())
    left.text = "\n" + paragraph(
                           "properties of the residual, with each assumption tried: the rms that it reproduces "
                           "alone, and the share of the variance above noise (100 %: all of it; more is better)",
                           0, 2);
  std::vector<std::string> withheld;
  std::set<std::string> said, measure;
  for (const model::LeftProperty& one : d.left) {
    left.json.push_back(object_of("property"_is(one.property), "is"_is(text_or_null(one.is)), "because"_is(one.because),
                                  "measure"_is(text_or_null(one.measure))));
    const bool is_new = !one.is.empty() && said.insert(one.because).second;
    const bool is_list = one.because.find("; noise of ") != std::string::npos;
    if (one.is.empty())
      withheld.push_back(question_of(one.property));
    else
      left.text += paragraph(fmt::format("{}: {}{}{}", words_for_property(one.property), answer_text(one, d),
                                         !is_new   ? ""
                                         : is_list ? ". Tried: "
                                                   : ": ",
                                         is_new ? one.because : ""),
                             2, 4);
    if (!one.measure.empty()) measure.insert(one.measure);
  }
  if (!withheld.empty())
    left.text += paragraph(
        fmt::format("These readings do not show {}. {}", fmt::join(withheld, "; "), fmt::join(measure, " ")), 2, 4);
  return left;
}

/// "EX = k1 * approach"
std::string formulas_text(const model::EffectInstance& effect) {
  std::vector<std::string> texts;
  for (const model::UserFormula& one : effect.formulas)
    texts.push_back(fmt::format("{} = {}", name_of(one.sense), one.text));
  return fmt::format("{}", fmt::join(texts, ", "));
}

Cell formula_cell(const Diagnosis& d) {
  if (!d.formula) return {nullptr, ""};
  const model::EffectInstance& effect = d.formula->effect;
  Json formulas = Json::object(), parameters = Json::object();
  for (const model::UserFormula& one : effect.formulas) formulas[std::string(name_of(one.sense))] = one.text;
  for (const model::UserParameter& one : effect.user) parameters[one.name] = number_or_null(*one.start);
  return {object_of("name"_is(effect.name), "formula"_is(formulas), "parameters"_is(parameters),
                    "why"_is(d.formula->why), "rms_after_um"_is(d.formula->rms_after_um),
                    "held_out_rms_before_um"_is(d.formula->held_out_rms_before_um),
                    "held_out_rms_um"_is(d.formula->held_out_rms_um)),
          "\n" + paragraph(formula_text(d), 0, 2)};
}

Json different_run_json(const Diagnosis& d) {
  if (!d.different_run) return nullptr;
  const auto& [run, from_there_on, is_shifted, text] = *d.different_run;
  return object_of("run"_is(run), "from_there_on"_is(from_there_on), "is_shifted"_is(is_shifted), "text"_is(text));
}

std::string outliers_text(const Diagnosis& d) {
  if (d.outliers.empty()) return {};
  return "\n" +
         paragraph(
             fmt::format(
                 "outliers: row{} {} ({} of {} readings), of little weight in every fit; the tables of effects leave "
                 "them out",
                 d.outliers.size() == 1 ? "" : "s", rows_text(d.outliers), d.outliers.size(), d.observations),
             0, 2);
}

}  // namespace

std::string formula_text(const Diagnosis& diagnosis) {
  if (!diagnosis.formula) return {};
  const model::ProposedFormula& formula = *diagnosis.formula;
  return fmt::format(
      "As a formula of {} term{}: {}. `ecs model add MODEL formula DATA` adds it. On held-out readings the "
      "residual is then expected to fall from {} to {} {} rms.",
      formula.effect.user.size(), formula.effect.user.size() == 1 ? "" : "s", formulas_text(formula.effect),
      model::in_digits(formula.held_out_rms_before_um), model::in_digits(formula.held_out_rms_um),
      diagnosis.noise.unit);
}

std::string chance_text(const Candidate& candidate, const Diagnosis& diagnosis) {
  if (!model::explains_alone(candidate, diagnosis)) return "-";
  const double least = 1.0 / (static_cast<double>(diagnosis.noise_replicates) + 1.0);
  return candidate.false_naming <= least ? fmt::format("< {:.2g} %", 100.0 * least)
                                         : fmt::format("{:.3g} %", 100.0 * candidate.false_naming);
}

std::string tried_text(const Diagnosis& d) {
  const bool ended_early = d.noise_replicates < d.replicates_wanted;
  return paragraph(
      fmt::format("{} candidate{} tried on these readings, and on {}{} simulated data sets that contain "
                  "noise only, at the same positions and under the same conditions{}",
                  d.candidates_tried, d.candidates_tried == 1 ? " was" : "s were", d.noise_replicates,
                  ended_early ? fmt::format(" of {}", d.replicates_wanted) : "",
                  ended_early ? ". These are enough to show that noise explains the readings" : ""));
}

Cell diagnosis_cell(const Diagnosis& d) {
  const std::string tried = tried_text(d);
  std::vector<std::string> notes = d.notes;
  std::erase_if(notes, [&](const std::string& note) { return d.headline.starts_with(note); });  // said there
  Cell answer = record_cell(
      "{headline}\n{summary}{candidates}{where}{left}{formula}{outliers}\n{blanks}{notes}",
      "observations"_is(d.observations), "rms_um"_is(d.rms_um), "noise_um"_is(d.noise.noise_um),
      "noise_from_repeats"_is(d.noise.from_repeats), "lack_of_fit"_is(lack_of_fit_cell(d.lack_of_fit)),
      "verdict"_is(name_of(d.verdict)), "headline"_is(d.headline, paragraph(d.headline)),
      "different_run"_is(different_run_json(d)), "summary"_shown(summary(d)), "candidates"_is(candidates_cell(d)),
      "add"_is(add_json(d)), "where"_is(where_cell(d)), "left"_is(left_cell(d)), "formula"_is(formula_cell(d)),
      "rms_after_um"_is(d.rms_after_um), "lack_of_fit_after"_is(lack_of_fit_cell(d.lack_of_fit_after)),
      "outliers"_is(d.outliers, outliers_text(d)), "notes"_is(d.notes, notes_text(notes)),
      "candidates_tried"_is(d.candidates_tried), "own_terms"_is(own_terms_json(d.own_terms)),
      "blanks"_is(d.noise_replicates, d.noise_replicates > 0 ? tried : ""));
  if (!d.apart.empty()) answer.json["apart"] = d.apart;
  add_by_unit(answer.json, d.noise.unit,
              {{"rms", d.rms_by_unit}, {"rms_after", d.rms_after_by_unit}, {"noise", d.noise.by_unit}});
  return answer;
}

std::string diagnosis_text(const Diagnosis& diagnosis) { return diagnosis_cell(diagnosis).text; }

}  // namespace ecs::commissioning
