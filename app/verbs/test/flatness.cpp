// `ecs test flatness`: the heights of a surface from the eight lines of a union jack.
#include <cmath>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "laser/standards/plate.hpp"

namespace ecs::app {
namespace {

struct FlatnessArguments : VerbArguments {
  const std::string& file = text("FILE", "readings of the eight lines: line,station_mm,reading", Need::required);
  const double& closure_um = number("--closure-um", "largest closure error at the centre [um]",
                                    laser::kLargestClosure_um, Need::optional, 0.0, 1e6);
  const std::string& output = output_file("-o,--output", "CSV of the heights");
  const std::string& plot = output_file("--plot", "the lines seen obliquely: OUT.svg or OUT.png");
};

/// One line after the other.
Cell heights_cell(const laser::Flatness& flatness) {
  Cell lines{Json::array(), {}};
  for (std::size_t i = 0; i < laser::kPlateLines; ++i) {
    Json stations = Json::array();
    std::string text = fmt::format("  {:<6}", laser::kPlateLineNames[i]);
    for (const laser::PlateStation& station : flatness.stations) {
      if (station.line != i) continue;
      stations.push_back({{"x_mm", number_or_null(station.x_mm)},
                          {"y_mm", number_or_null(station.y_mm)},
                          {"height_um", number_or_null(station.height_um)}});
      text += fmt::format("{:>5.1f}", station.height_um);
    }
    lines.add({{{"line", laser::kPlateLineNames[i]}, {"stations", std::move(stations)}}, text + "\n"});
  }
  return lines;
}

std::string heights_csv(const laser::Flatness& flatness) {
  std::string text = "line,station,x_mm,y_mm,height_um\n";
  for (const laser::PlateStation& station : flatness.stations)
    text += fmt::format("{},{},{:.4f},{:.4f},{:.4f}\n", laser::kPlateLineNames[station.line], station.step,
                        station.x_mm, station.y_mm, station.height_um);
  return text;
}

/// Figure 7.23 of the thesis: the plate from the south, its far side higher in the picture.
PlotFigure oblique_view(const laser::Flatness& flatness) {
  constexpr double kDepth_x = 0.35;  ///< of the picture's width for the whole depth
  constexpr double kDepth_y = 1.2;   ///< of the greatest height
  const double highest_um = std::max(flatness.moody_um, 1e-6);
  const auto at = [&](double x_mm, double y_mm, double height_um) {
    return PlotPoint{x_mm + kDepth_x * flatness.width_mm * y_mm / flatness.depth_mm,
                     height_um + kDepth_y * highest_um * y_mm / flatness.depth_mm};
  };
  const double w = flatness.width_mm, d = flatness.depth_mm;
  PlotPanel panel{fmt::format("flatness {:.2f} um (minimum zone)", flatness.minimum_zone_um),
                  "along the plate [mm], shifted to the right with its depth",
                  "height [um], raised with the depth",
                  {}};
  panel.series.push_back(
      {"plane of the lowest station", Mark::level, {at(0, 0, 0), at(w, 0, 0), at(w, d, 0), at(0, d, 0), at(0, 0, 0)}});
  for (std::size_t i = 0; i < laser::kPlateLines; ++i) {
    PlotSeries series{i == 0 ? "measured lines" : "", Mark::both, {}};
    for (const laser::PlateStation& station : flatness.stations)
      if (station.line == i) series.points.push_back(at(station.x_mm, station.y_mm, station.height_um));
    panel.series.push_back(std::move(series));
  }
  return {"Flatness (ISO 230-1)", {std::move(panel)}, 1, true};
}

Cell closure_cell(const laser::Flatness& flatness, double largest_um) {
  const bool holds = std::abs(flatness.closure_um[0]) <= largest_um && std::abs(flatness.closure_um[1]) <= largest_um;
  return record_cell("closure error at the centre: E-W {E_W} um, N-S {N_S} um; at most {largest}: {holds}\n",
                     {{"E_W", number_cell(flatness.closure_um[0], 3)},
                      {"N_S", number_cell(flatness.closure_um[1], 3)},
                      {"largest", plain_cell(largest_um)},
                      {"holds", yes_cell(holds, "holds", "exceeded, measure the lines again")}});
}

Result<Outcome> flatness(VerbContext&, const FlatnessArguments& arguments) {
  ECS_TRY(text, read_file_of(FileKind::surface, arguments.file));
  ECS_TRY(readings, laser::parse_plate_readings(text, arguments.file));
  const laser::Flatness flatness = laser::flatness_of(readings);
  if (!arguments.plot.empty()) ECS_DO(write_plot(arguments.plot, oblique_view(flatness)));
  if (!arguments.output.empty()) ECS_DO(write_file(arguments.output, heights_csv(flatness)));
  const Cell closure = closure_cell(flatness, arguments.closure_um);
  const Cell answer = record_cell(
      "{file}: {width_mm} x {depth_mm} mm between the corner stations, {heights} heights\n"
      "  {flatness_um:>9} um  flatness: minimum zone, the closest two planes\n"
      "  {least_squares_um:>9} um  planes parallel to that of least squares\n"
      "  {moody_um:>9} um  planes parallel to both diagonals (Moody 1955)\n"
      "{closure}heights above the lowest station [um], each line from its first station:\n{lines}{output}{plot}",
      {{"file", word_cell(arguments.file)},
       {"width_mm", plain_cell(flatness.width_mm)},
       {"depth_mm", plain_cell(flatness.depth_mm)},
       {"heights", count_cell(flatness.stations.size())},
       {"flatness_um", number_cell(flatness.minimum_zone_um, 3)},
       {"least_squares_um", number_cell(flatness.least_squares_um, 3)},
       {"moody_um", number_cell(flatness.moody_um, 3)},
       {"closure", closure},
       {"lines", heights_cell(flatness)},
       {"output", written_cell("heights", arguments.output)},
       {"plot", written_cell("plot", arguments.plot)}});
  return outcome_of(answer, closure.json["holds"] == true ? kDone : kDoesNotHold);
}

}  // namespace

extern const VerbDefinition kTestFlatness = verb<FlatnessArguments>(
    "test flatness", "ISO 230-1: flatness from level or mirror readings along the eight lines of a union jack",
    "ecs test flatness plate.csv --plot plate.svg", flatness);

}  // namespace ecs::app
