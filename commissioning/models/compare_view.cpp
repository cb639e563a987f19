#include "commissioning/models/compare_view.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/paragraph.hpp"
#include "commissioning/models/json.hpp"
#include "commissioning/models/view.hpp"

namespace ecs::commissioning {
namespace {

using model::Comparison;

Cell direction_cell(const model::DirectionSummary& d, bool rotary) {
  Cell lack_of_fit = lack_of_fit_cell(d.lack_of_fit);  // without its F, which has no room in the table
  if (const std::size_t comma = lack_of_fit.text.find(", "); comma != std::string::npos)
    lack_of_fit.text.erase(0, comma + 2);
  return record_cell(
      "{sense:<5} {axis:<4} {approach:<11} {readings:>8} {bias_um:>8} {rms_um:>8} {peak_um:>8}   {lack_of_fit}\n",
      {{"sense", word_cell(d.path.empty() ? std::string(name_of(d.sense)) : d.path)},
       {"axis", word_cell(d.path.empty() ? axis_json(d.axis, rotary) : d.axes)},
       {"approach", {d.approach, std::string(direction_text(d.approach))}},
       {"bias_um", number_cell(d.bias_um, 3)},
       {"rms_um", number_cell(d.rms_um, 3)},
       {"peak_um", number_cell(d.peak_um, 3)},
       {"lack_of_fit", std::move(lack_of_fit)},
       {"readings", count_cell(d.readings)}});
}

Cell directions_cell(const Comparison& c) {
  Cell list{Json::array(), "sense axis direction   readings     bias      rms     peak   lack of fit\n"};
  for (const model::DirectionSummary& one : c.directions) list.add(direction_cell(one, c.rotary));
  list.text += "bias, rms, peak of the residual (reading - model): um; um/m for EA EB EC\n";
  return list;
}

Cell worst_cell(const Comparison& c) {
  if (c.worst.empty()) return {Json::array(), ""};
  const std::string letters = c.rotary ? "a          b          c" : "x          y          z";
  Cell list{Json::array(),
            fmt::format("\nworst places\n   row sense axis          {} dir  run   reading  residual\n", letters)};
  for (const model::WorstPlace& w : c.worst) {
    AnswerFields fields{{"row", integer_cell(w.row)},
                        {"axis", word_cell(w.path.empty() ? axis_json(w.axis, c.rotary) : w.axes)},
                        {"sense", word_cell(w.path.empty() ? std::string(name_of(w.sense)) : w.path)}};
    add_position(fields, w.position_mm, c.rotary);
    fields.insert(fields.end(), {{"approach", {w.approach, w.approach == 0 ? "" : (w.approach > 0 ? "fwd" : "rev")}},
                                 {"run", integer_cell(w.run)},
                                 {"reading_um", number_cell(w.reading_um, 2)},
                                 {"predicted_um", number_cell(w.predicted_um, 2)},
                                 {"residual_um", number_cell(w.residual_um, 2)}});
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
    bins.push_back({{"from", number_or_null(bin.from)},
                    {"to", number_or_null(bin.to)},
                    {"mean_um", number_or_null(bin.mean_um)},
                    {"sigma_um", number_or_null(bin.sigma_um)},
                    {"rms_um", number_or_null(bin.rms_um)},
                    {"readings", bin.readings}});
  return record_cell("  {variable} {share:>6} %\n",
                     {{"variable", {view.variable, padded(view.variable, 26)}},
                      {"share", {number_or_null(view.share), fmt::format("{:.1f}", 100.0 * view.share)}},
                      {"bins", {std::move(bins), ""}}});
}

Cell variables_cell(const Comparison& c) {
  if (c.views.empty()) return {Json::array(), ""};
  Cell list{Json::array(), "\nshare of the residual variance that each variable explains, beyond noise\n"};
  const auto views = by_share(c);
  for (const model::ResidualView* view : views) list.add(variable_cell(*view));
  std::size_t shapes = 0;
  for (const model::ResidualView* view : views) {
    if (view->share < kWorthAShape) break;
    if (view->bins.empty()) continue;  // a product of two coordinates has no axis of its own
    if (++shapes > kMostShapes) break;
    std::vector<ShapePoint> points;
    for (const model::ResidualBin& bin : view->bins) points.push_back({0.5 * (bin.from + bin.to), bin.mean_um});
    list.text += "\n" + shape_text(view->variable, points, c.noise.unit);
  }
  return list;
}

std::string outliers_text(const Comparison& c) {
  if (c.outliers.empty()) return {};
  return "\n" +
         paragraph(fmt::format("outliers: rows {} ({} readings)", rows_text(c.outliers), c.outliers.size()), 0, 2);
}

}  // namespace

Cell comparison_cell(const Comparison& c, std::size_t readings) {
  const Cell lack_of_fit = lack_of_fit_cell(c.lack_of_fit);
  const std::string summary = paragraph(
      fmt::format("{} readings: rms {:.3f} {}, peak {:.3f} {}; noise of one reading {}; lack of fit: {}", readings,
                  c.rms_um, c.noise.unit, c.peak_um, c.noise.unit, noise_text(c.noise), lack_of_fit.text));
  return record_cell("{summary}\n{directions}{variables}{worst}{outliers}",
                     {{"observations", {readings, ""}},
                      {"summary", shown_cell(summary)},
                      {"rms_um", {number_or_null(c.rms_um), ""}},
                      {"peak_um", {number_or_null(c.peak_um), ""}},
                      {"noise_um", {number_or_null(c.noise.noise_um), ""}},
                      {"noise_from_repeats", {c.noise.from_repeats, ""}},
                      {"lack_of_fit", lack_of_fit},
                      {"directions", directions_cell(c)},
                      {"variables", variables_cell(c)},
                      {"worst", worst_cell(c)},
                      {"outliers", {c.outliers, outliers_text(c)}}});
}

}  // namespace ecs::commissioning
