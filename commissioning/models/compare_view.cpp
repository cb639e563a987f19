#include "commissioning/models/compare_view.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/json.hpp"
#include "base/paragraph.hpp"
#include "commissioning/models/json.hpp"
#include "commissioning/models/view.hpp"

namespace ecs::app {
namespace {

using model::Comparison;

std::string directions_text(const Comparison& c) {
  std::string text = "sense axis direction   readings     bias      rms     peak   lack of fit\n";
  for (const model::DirectionSummary& one : c.directions)
    text += fmt::format("{:<5} {:<4} {:<11} {:>8} {:>8.3f} {:>8.3f} {:>8.3f}   {}\n", name_of(one.sense),
                        letter_of(one.axis), direction_text(one.approach), one.readings, one.bias_um, one.rms_um,
                        one.peak_um, lack_of_fit_text(one.lack_of_fit));
  return text + "bias, rms, peak of the residual (reading - model): um; um/m for EA EB EC\n";
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

std::string worst_text(const Comparison& c) {
  if (c.worst.empty()) return {};
  std::string text =
      "\nworst places\n   row sense axis          x          y          z dir  run   reading  residual\n";
  for (const model::WorstPlace& w : c.worst)
    text += fmt::format("{:>6} {:<5} {:<4} {:>10} {:>10} {:>10} {:>3} {:>4} {:>9.2f} {:>9.2f}\n", w.row,
                        name_of(w.sense), letter_of(w.axis), position_text(w.position_mm[0]),
                        position_text(w.position_mm[1]), position_text(w.position_mm[2]),
                        w.approach == 0 ? "" : (w.approach > 0 ? "fwd" : "rev"), w.run, w.reading_um, w.residual_um);
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

Json direction_json(const model::DirectionSummary& one) {
  return {{"sense", name_of(one.sense)},
          {"axis", axis_json(one.axis)},
          {"approach", one.approach},
          {"bias_um", number_or_null(one.bias_um)},
          {"rms_um", number_or_null(one.rms_um)},
          {"peak_um", number_or_null(one.peak_um)},
          {"lack_of_fit", json_of(one.lack_of_fit)},
          {"readings", one.readings}};
}

Json worst_json(const model::WorstPlace& w) {
  Json object{{"row", w.row}, {"axis", axis_json(w.axis)}, {"sense", name_of(w.sense)}};
  object.update(position_json(w.position_mm));
  object["approach"] = w.approach;
  object["run"] = w.run;
  object["reading_um"] = number_or_null(w.reading_um);
  object["predicted_um"] = number_or_null(w.predicted_um);
  object["residual_um"] = number_or_null(w.residual_um);
  return object;
}

}  // namespace

std::string comparison_text(const Comparison& c, std::size_t readings) {
  std::string text =
      paragraph(fmt::format("{} readings: rms {:.3f} um, peak {:.3f} um; noise of one reading {}; lack "
                            "of fit: {}",
                            readings, c.rms_um, c.peak_um, noise_text(c.noise), lack_of_fit_text(c.lack_of_fit)));
  text += "\n" + directions_text(c) + variables_text(c) + worst_text(c);
  if (!c.outliers.empty())
    text += "\n" +
            paragraph(fmt::format("outliers: rows {} ({} readings)", rows_text(c.outliers), c.outliers.size()), 0, 2);
  return text;
}

Json json_of(const Comparison& c) {
  Json directions = Json::array(), variables = Json::array(), worst = Json::array();
  for (const model::DirectionSummary& one : c.directions) directions.push_back(direction_json(one));
  for (const model::ResidualView* view : by_share(c)) variables.push_back(view_json(*view));
  for (const model::WorstPlace& one : c.worst) worst.push_back(worst_json(one));
  return {{"rms_um", number_or_null(c.rms_um)},
          {"peak_um", number_or_null(c.peak_um)},
          {"noise_um", number_or_null(c.noise.noise_um)},
          {"noise_from_repeats", c.noise.from_repeats},
          {"lack_of_fit", json_of(c.lack_of_fit)},
          {"directions", std::move(directions)},
          {"variables", std::move(variables)},
          {"worst", std::move(worst)},
          {"outliers", c.outliers}};
}

}  // namespace ecs::app
