#include "app/plot/gnuplot.hpp"
#include "commissioning/plot/curves.hpp"
#include "laser/groups.hpp"

namespace ecs::app {
namespace {

PlotFigure before_and_after() {
  PlotFigure figure{"EXX", {}, 1, true};
  figure.panels.push_back({"before", "X", "um", {{"forward", Mark::forward, {{0.0, -40.0}, {100.0, 40.0}}}}});
  figure.panels.push_back({"after", "X", "um", {{"reverse", Mark::reverse, {{0.0, -4.0}, {100.0, 4.0}}}}});
  return figure;
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++count;
  return count;
}

TEST_CASE("before and after share their axes") {
  const std::string script = plot_script(before_and_after(), PlotFormat::svg);
  CHECK(count_of(script, "set yrange [-44.8:44.8]") == 2);
  CHECK(count_of(script, "set xrange [-2:102]") == 2);
}

TEST_CASE("panels of different components have axes of their own") {
  PlotFigure figure = before_and_after();
  figure.same_scale = false;
  const std::string script = plot_script(figure, PlotFormat::svg);
  CHECK(count_of(script, "set yrange [-44.8:44.8]") == 1);
  CHECK(count_of(script, "set yrange [-4.48:4.48]") == 1);
}

TEST_CASE("a title cannot become a command") {
  PlotFigure figure = before_and_after();
  figure.title = "it's\nsystem('rm')";
  CHECK(contains(plot_script(figure, PlotFormat::png), "title 'it''s system(''rm'')'"));
}

TEST_CASE("forward and reverse differ in mark and dash") {
  const std::string script = plot_script(before_and_after(), PlotFormat::svg);
  check_holds(script, {"dt 1 pt 9", "dt (12,6) pt 11"});
}

TEST_CASE("a plot is an SVG or a PNG by its extension, and nothing else") {
  const Folder folder;
  REQUIRE(write_plot(folder / "a.svg", before_and_after()));
  REQUIRE(write_plot(folder / "a.PNG", before_and_after()));
  CHECK(contains(content_of(folder / "a.svg"), "</svg>"));
  CHECK(content_of(folder / "a.PNG").substr(1, 3) == "PNG");
  CHECK(must_fail(write_plot(folder / "a.pdf", before_and_after())).kind == ProblemKind::usage);
}

TEST_CASE("a plot that cannot be written is an output problem") {
  CHECK(must_fail(write_plot("/proc/none/a.svg", before_and_after())).kind == ProblemKind::output);
}

TEST_CASE("a measurement shows its means as lines and every reading as a point") {
  const auto set = must(laser::read_measurement_set("samples/laser/x_axis.csv"));
  const auto curve = must(laser::averaged(set, laser::groups_of(set).front()));
  const PlotPanel panel = panel_of(set, curve, "t");
  REQUIRE(panel.series.size() == 4);
  CHECK(panel.series[0].points.size() + panel.series[1].points.size() == set.readings.size());
  CHECK(panel.series[2].mark == Mark::forward);
  CHECK(panel.series[3].mark == Mark::reverse);
  CHECK(panel.y_label == "error [µm]");
}

}  // namespace
}  // namespace ecs::app
