// `ecs laser table`: the table of a commissioning, and a plot before/after of each row.
#include "commissioning/measurements/table.hpp"

#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "commissioning/plot/curves.hpp"
#include "laser/map/recipe.hpp"

namespace ecs::app {
namespace {

constexpr int kBadFile = 3;

struct TableRequest {
  std::string plan, before, after, plots;
  bool png = false, force = false;
  static Fields<TableRequest> fields() {
    using R = TableRequest;
    return {{"PLAN", &R::plan, "plan file with a [[measure]] table for each measurement", Need::required},
            {"--before", &R::before, "folder with NAME.csv files measured without compensation", Need::required},
            {"--after", &R::after, "folder with NAME.csv files measured with compensation", Need::required},
            {"--plots", &R::plots, "folder for the plots, NAME.svg for each row"},
            {"--png", &R::png, "also write NAME.png (needs --plots)"},
            {"--force", &R::force, "overwrite existing plots"}};
  }
};

PlotFigure figure_of(const TableRow& row) {
  PlotFigure figure{fmt::format("{}  {}", row.planned.name, row.planned.title), {}, 1, true};
  const std::string slope = row.planned.slope == laser::SlopeMethod::none
                                ? ""
                                : fmt::format(", slope removed ({})", laser::name_of(row.planned.slope));
  const auto unit = laser::unit_of(row.planned.sense);
  const auto add = [&](const std::optional<MeasuredPhase>& phase, const char* which) {
    if (phase)
      figure.panels.push_back(panel_of(phase->readings.after, phase->readings.level.curve,
                                       fmt::format("{}: band {:.1f} {}{}", which, phase->readings.band, unit, slope)));
  };
  add(row.before, "before");
  add(row.after, "after");
  return figure;
}

Result<std::vector<std::string>> write_plots(const std::vector<TableRow>& rows, const TableRequest& request) {
  if (request.plots.empty()) return std::vector<std::string>();
  std::vector<std::pair<std::string, PlotFigure>> plots;
  std::vector<std::string> names;
  for (const TableRow& row : rows) {
    const PlotFigure figure = figure_of(row);
    if (figure.panels.empty()) continue;
    for (const char* extension : {".svg", ".png"}) {
      if (std::string_view(extension) == ".png" && !request.png) continue;
      names.push_back((std::filesystem::path(request.plots) / (row.planned.name + extension)).string());
      plots.emplace_back(names.back(), figure);
    }
  }
  ECS_DO(spared(names, request.force));
  std::error_code error;
  std::filesystem::create_directories(request.plots, error);
  if (error) return problem(ProblemKind::output, "{}: {}", request.plots, error.message());
  for (const auto& [path, figure] : plots) ECS_DO(write_plot(path, figure));
  return names;
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

Result<Outcome> table(VerbContext&, const TableRequest& request) {
  ECS_TRY(plan, read_plan(request.plan));
  const auto rows = table_of(plan, request.before, request.after);
  ECS_TRY(plots, write_plots(rows, request));
  Cell drawn = lines_cell(plots, "  ");
  if (!plots.empty()) drawn.text.insert(0, "\nplots:\n");
  const auto unfit = unfit_files(rows);
  return outcome_of(record_cell("{rows}{plots}", "plan"_is(request.plan), "band"_is(laser::kBandDefinition),
                                "rows"_is(table_cell(rows)), "plots"_is(drawn),
                                "error"_is(unfit ? Cell{problem_json(*unfit), {}} : shown_cell())),
                    exit_code_of(rows));
}

}  // namespace

extern const std::vector<Action> kLaserTables{action(
    "laser table", "list the error bands before and after commissioning, compared with the bands stated in the plan",
    "ecs laser table commissioning.toml --before before/ --after after/ --plots plots/", table)};

}  // namespace ecs::app
