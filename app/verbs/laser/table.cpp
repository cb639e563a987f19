// `ecs laser table`: the table of a commissioning, and a plot before/after of each row.
#include "commissioning/measurements/table.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "base/json.hpp"
#include "commissioning/plot/curves.hpp"
#include "laser/map/recipe.hpp"

namespace ecs::app {
namespace {

constexpr int kBadFile = 3;

struct TableArguments : VerbArguments {
  const std::string& plan = text("PLAN", "plan with a [[measure]] for each measurement", Need::required);
  const std::string& before = text("--before", "folder of NAME.csv, measured without compensation", Need::required);
  const std::string& after = text("--after", "folder of NAME.csv, measured with compensation", Need::required);
  const std::string& plots = text("--plots", "folder for a plot NAME.svg of each row");
  const bool& png = flag("--png", "with --plots: NAME.png as well");
};

Json phase_json(const std::optional<MeasuredPhase>& phase) {
  if (!phase) return nullptr;
  return {{"file", phase->file.string()},
          {"readings", phase->readings.before.readings.size()},
          {"band", number_or_null(phase->readings.band)},
          {"band_as_measured", number_or_null(phase->readings.band_before)},
          {"slope_removed_per_m", number_or_null(phase->readings.level.removed.slope_per_m)},
          {"A", number_or_null(phase->iso.A)},
          {"E", number_or_null(phase->iso.E)},
          {"R", number_or_null(phase->iso.R)},
          {"B", number_or_null(phase->iso.B)}};
}

Json row_json(const TableRow& row) {
  const PlannedMeasurement& p = row.planned;
  Json problems = Json::array();
  for (const Problem& one : row.problems) problems.push_back(problem_json(one));
  return {{"name", p.name},
          {"title", p.title},
          {"axis", std::string(1, letter_of(p.axis))},
          {"sense", name_of(p.sense)},
          {"unit", laser::unit_of(p.sense)},
          {"slope", laser::name_of(p.slope)},
          {"published_before", number_or_null(p.published_before)},
          {"published_after", number_or_null(p.published_after)},
          {"before", phase_json(row.before)},
          {"after", phase_json(row.after)},
          {"ratio", number_or_null(row.ratio())},
          {"exceeds_published", row.exceeds_published()},
          {"problems", std::move(problems)}};
}

PlotFigure figure_of(const TableRow& row) {
  PlotFigure figure{fmt::format("{}  {}", row.planned.name, row.planned.title), {}, 1, true};
  const std::string slope = row.planned.slope == laser::SlopeMethod::none
                                ? ""
                                : fmt::format(", slope removed ({})", laser::name_of(row.planned.slope));
  const auto unit = laser::unit_of(row.planned.sense);
  if (row.before)
    figure.panels.push_back(panel_of(row.before->readings.after, row.before->readings.level.curve,
                                     fmt::format("before: band {:.1f} {}{}", row.before->readings.band, unit, slope)));
  if (row.after)
    figure.panels.push_back(panel_of(row.after->readings.after, row.after->readings.level.curve,
                                     fmt::format("after: band {:.1f} {}{}", row.after->readings.band, unit, slope)));
  return figure;
}

Result<std::vector<std::string>> write_plots(const std::vector<TableRow>& rows, const TableArguments& arguments) {
  std::vector<std::string> written;
  if (arguments.plots.empty()) return written;
  std::error_code error;
  std::filesystem::create_directories(arguments.plots, error);
  if (error) return problem(ProblemKind::output, fmt::format("{}: {}", arguments.plots, error.message()));
  for (const TableRow& row : rows) {
    const PlotFigure figure = figure_of(row);
    if (figure.panels.empty()) continue;
    for (const char* extension : {".svg", ".png"}) {
      if (std::string_view(extension) == ".png" && !arguments.png) continue;
      const std::filesystem::path path = std::filesystem::path(arguments.plots) / (row.planned.name + extension);
      if (const auto drawn = write_plot(path, figure); !drawn) return tl::unexpected(drawn.error());
      written.push_back(path.string());
    }
  }
  return written;
}

int exit_code_of(const std::vector<TableRow>& rows) {
  int code = kDone;
  for (const TableRow& row : rows) {
    if (!row.problems.empty()) return kBadFile;
    if (row.exceeds_published()) code = kDoesNotHold;
  }
  return code;
}

std::optional<Problem> unfit_files(const std::vector<TableRow>& rows) {
  std::vector<Problem> all;
  for (const TableRow& row : rows) all.insert(all.end(), row.problems.begin(), row.problems.end());
  if (all.empty()) return std::nullopt;
  return folded(std::move(all));
}

Result<Outcome> table(VerbContext&, const TableArguments& arguments) {
  const auto plan = read_plan(arguments.plan);
  if (!plan) return tl::unexpected(plan.error());
  const auto rows = table_of(*plan, arguments.before, arguments.after);
  const auto plots = write_plots(rows, arguments);
  if (!plots) return tl::unexpected(plots.error());
  std::string text = table_text(rows);
  if (!plots->empty()) text += "\nplots:\n";
  for (const std::string& path : *plots) text += "  " + path + "\n";
  Json object{{"plan", arguments.plan}, {"band", laser::kBandDefinition}, {"rows", Json::array()}};
  for (const TableRow& row : rows) object["rows"].push_back(row_json(row));
  object["plots"] = *plots;
  if (const auto unfit = unfit_files(rows)) object["error"] = problem_json(*unfit);
  return Outcome{text, one_line(object), exit_code_of(rows)};
}

}  // namespace

extern const VerbDefinition kLaserTable =
    verb<TableArguments>("laser table", "a commissioning: error bands before and after beside the published ones",
                         "ecs laser table commissioning.toml --before before/ --after after/ --plots plots/", table);

}  // namespace ecs::app
