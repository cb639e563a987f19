#include "commissioning/models/compare_view.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/paragraph.hpp"
#include "commissioning/models/json.hpp"
#include "commissioning/models/view.hpp"

namespace ecs::commissioning {
namespace {

using model::Comparison;

Cell lack_of_fit_cell(const std::optional<model::LackOfFit>& test) { return {json_of(test), lack_of_fit_text(test)}; }

const AnswerTable<model::DirectionSummary>& directions_table() {
  using Row = model::DirectionSummary;
  static const AnswerTable<Row> table(
      "{sense:<5} {axis:<4} {approach:<11} {readings:>8} {bias_um:>8} {rms_um:>8} {peak_um:>8}   {lack_of_fit}",
      {{"sense", "sense", [](const Row& d) { return word_cell(name_of(d.sense)); }},
       {"axis", "axis", [](const Row& d) { return word_cell(axis_json(d.axis)); }},
       {"approach", "direction",
        [](const Row& d) {
          return Cell{d.approach, std::string(direction_text(d.approach))};
        }},
       {"bias_um", "bias", [](const Row& d) { return number_cell(d.bias_um, 3); }},
       {"rms_um", "rms", [](const Row& d) { return number_cell(d.rms_um, 3); }},
       {"peak_um", "peak", [](const Row& d) { return number_cell(d.peak_um, 3); }},
       {"lack_of_fit", "lack of fit", [](const Row& d) { return lack_of_fit_cell(d.lack_of_fit); }},
       {"readings", "readings", [](const Row& d) { return count_cell(d.readings); }}});
  return table;
}

std::string directions_text(const Comparison& c) {
  return directions_table().text(c.directions) +
         "bias, rms, peak of the residual (reading - model): um; um/m for EA EB EC\n";
}

template <std::size_t kCoordinate>
Cell coordinate_cell(const model::WorstPlace& w) {
  return {number_or_null(w.position_mm[kCoordinate]), position_text(w.position_mm[kCoordinate])};
}

const AnswerTable<model::WorstPlace>& worst_table() {
  using Row = model::WorstPlace;
  static const AnswerTable<Row> table(
      "{row:>6} {sense:<5} {axis:<4} {x_mm:>10} {y_mm:>10} {z_mm:>10} {approach:>3} {run:>4} {reading_um:>9} "
      "{residual_um:>9}",
      {{"row", "row",
        [](const Row& w) {
          return Cell{w.row, fmt::format("{}", w.row)};
        }},
       {"axis", "axis", [](const Row& w) { return word_cell(axis_json(w.axis)); }},
       {"sense", "sense", [](const Row& w) { return word_cell(name_of(w.sense)); }},
       {"x_mm", "x", coordinate_cell<0>},
       {"y_mm", "y", coordinate_cell<1>},
       {"z_mm", "z", coordinate_cell<2>},
       {"approach", "dir",
        [](const Row& w) {
          return Cell{w.approach, w.approach == 0 ? "" : (w.approach > 0 ? "fwd" : "rev")};
        }},
       {"run", "run",
        [](const Row& w) {
          return Cell{w.run, fmt::format("{}", w.run)};
        }},
       {"reading_um", "reading", [](const Row& w) { return number_cell(w.reading_um, 2); }},
       {"predicted_um", "", [](const Row& w) { return number_cell(w.predicted_um, 2); }},
       {"residual_um", "residual", [](const Row& w) { return number_cell(w.residual_um, 2); }}});
  return table;
}

std::vector<const model::ResidualView*> by_share(const Comparison& c) {
  std::vector<const model::ResidualView*> list;
  for (const model::ResidualView& view : c.views) list.push_back(&view);
  std::stable_sort(list.begin(), list.end(), [](const auto* a, const auto* b) { return a->share > b->share; });
  return list;
}

std::string variables_text(const Comparison& c) {
  if (c.views.empty()) return {};
  std::string text = "\nshare of the residual variance that each variable explains, beyond noise\n";
  std::size_t shapes = 0;
  for (const model::ResidualView* view : by_share(c))
    text += fmt::format("  {} {:>6.1f} %\n", padded(view->variable, 26), 100.0 * view->share);
  for (const model::ResidualView* view : by_share(c)) {
    if (view->share < kWorthAShape || ++shapes > kMostShapes) break;
    std::vector<ShapePoint> points;
    for (const model::ResidualBin& bin : view->bins) points.push_back({0.5 * (bin.from + bin.to), bin.mean_um});
    text += "\n" + shape_text(view->variable, points);
  }
  return text;
}

Json view_json(const model::ResidualView& view) {
  Json bins = Json::array();
  for (const model::ResidualBin& bin : view.bins)
    bins.push_back({{"from", number_or_null(bin.from)},
                    {"to", number_or_null(bin.to)},
                    {"mean_um", number_or_null(bin.mean_um)},
                    {"sigma_um", number_or_null(bin.sigma_um)},
                    {"rms_um", number_or_null(bin.rms_um)},
                    {"readings", bin.readings}});
  return {{"variable", view.variable}, {"share", number_or_null(view.share)}, {"bins", std::move(bins)}};
}

}  // namespace

std::string comparison_text(const Comparison& c, std::size_t readings) {
  std::string text =
      paragraph(fmt::format("{} readings: rms {:.3f} um, peak {:.3f} um; noise of one reading {}; lack "
                            "of fit: {}",
                            readings, c.rms_um, c.peak_um, noise_text(c.noise), lack_of_fit_text(c.lack_of_fit)));
  text += "\n" + directions_text(c) + variables_text(c);
  if (!c.worst.empty()) text += "\nworst places\n" + worst_table().text(c.worst);
  if (!c.outliers.empty())
    text += "\n" +
            paragraph(fmt::format("outliers: rows {} ({} readings)", rows_text(c.outliers), c.outliers.size()), 0, 2);
  return text;
}

Json json_of(const Comparison& c) {
  Json variables = Json::array();
  for (const model::ResidualView* view : by_share(c)) variables.push_back(view_json(*view));
  return {{"rms_um", number_or_null(c.rms_um)},
          {"peak_um", number_or_null(c.peak_um)},
          {"noise_um", number_or_null(c.noise.noise_um)},
          {"noise_from_repeats", c.noise.from_repeats},
          {"lack_of_fit", json_of(c.lack_of_fit)},
          {"directions", directions_table().array(c.directions)},
          {"variables", std::move(variables)},
          {"worst", worst_table().array(c.worst)},
          {"outliers", c.outliers}};
}

}  // namespace ecs::commissioning
