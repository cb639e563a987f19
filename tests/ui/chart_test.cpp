// Curves in cells: ticks, zoom, cursor, and what is visible without colour.
#include "app/ui/chart.hpp"

#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::app;

namespace {

PlotPanel panel() {
  PlotPanel p{"EXX", "X mm", "um", {{"forward", Mark::forward, {}}, {"reverse", Mark::reverse, {}}}};
  for (int k = 0; k <= 10; ++k) {
    p.series[0].points.push_back({k * 100.0, static_cast<double>(k)});
    p.series[1].points.push_back({k * 100.0, static_cast<double>(k) - 4.0});
  }
  return p;
}

std::string drawn(const ChartView& view, Glyphs glyphs, int rows = 16, int columns = 60) {
  Canvas canvas(rows, columns, glyphs);
  draw_chart(canvas, canvas.whole(), panel(), view);
  return canvas.plain_text();
}

}  // namespace

TEST_CASE("ticks are round numbers and cover the range") {
  CHECK(ticks_between(0.0, 10.0, 5) == std::vector<double>{0.0, 2.0, 4.0, 6.0, 8.0, 10.0});
  CHECK(ticks_between(-4100.0, 0.0, 5).front() == -4000.0);
  CHECK(ticks_between(1.0, 1.0, 5).empty());
  CHECK(tick_label(0.25, 0.05) == "0.25");
  CHECK(tick_label(-4000.0, 1000.0) == "-4000");
  CHECK(tick_label(-1e-17, 0.5) == "0.0");
}

TEST_CASE("a curve shows its unit, its ticks and its legend") {
  const std::string text = drawn({}, Glyphs::unicode);
  check_holds(text, {"EXX", "um", "X mm", "1000", "forward", "reverse", "▲", "▼"});
}

TEST_CASE("forward and reverse differ without colour, in ASCII too") {
  const std::string text = drawn({}, Glyphs::ascii);
  check_holds(text, {"^", "v"});
  CHECK(std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; }));
}

TEST_CASE("the cursor goes from point to point and reads them out") {
  ChartView view = stepped(panel(), {}, 1);
  CHECK(view.cursor_x == 0.0);
  view = stepped(panel(), view, 1);
  CHECK(read_out(panel(), *view.cursor_x) == "forward 1.000 um, reverse -3.000 um at 100.000 mm");
  CHECK(contains(drawn(view, Glyphs::unicode), "forward 1.000 um, reverse -3.000 um at 100.000 mm"));
  CHECK(stepped(panel(), stepped(panel(), {}, 1), -1).cursor_x == 0.0);  // it stays at the end
}

TEST_CASE("zoom keeps inside the data and comes back to all of it") {
  ChartView view;
  view.cursor_x = 900.0;
  view = zoomed(panel(), view, 0.5);
  CHECK(view.x_from == Approx(500.0));
  CHECK(view.x_to == Approx(1000.0));
  view = zoomed(panel(), view, 2.0);
  CHECK_FALSE(view.x_from.has_value());
}

TEST_CASE("no space, no points, one point: a chart says so") {
  CHECK(contains(drawn({}, Glyphs::unicode, 3, 10), "no room"));
  Canvas canvas(12, 60);
  draw_chart(canvas, canvas.whole(), {"t", "x", "y", {}}, {});
  CHECK(contains(canvas.plain_text(), "no measurement"));
  draw_chart(canvas, canvas.whole(), {"t", "x", "y", {{"one", Mark::both, {{3.0, 5.0}}}}}, {});
  CHECK(contains(canvas.plain_text(), "○"));
}

TEST_CASE("values of both directions have marks of their own where they are not joined") {
  const PlotPanel values{"values",
                         "x",
                         "y",
                         {{"model, forward", Mark::forward_value, {{0.0, 1.0}, {1.0, 1.0}}},
                          {"model, reverse", Mark::reverse_value, {{0.0, -1.0}, {1.0, -1.0}}}}};
  for (const auto& [glyphs, forward, reverse] :
       {std::tuple{Glyphs::unicode, "◆", "◇"}, std::tuple{Glyphs::ascii, "*", "+"}}) {
    Canvas canvas(16, 60, glyphs);
    draw_chart(canvas, canvas.whole(), values, {});
    CHECK(contains(canvas.plain_text(), forward));
    CHECK(contains(canvas.plain_text(), reverse));
  }
}

TEST_CASE("four curves of one chart, such as the body diagonals, have four marks") {
  for (const auto& [glyphs, level] : {std::pair{Glyphs::unicode, "■  limit"}, std::pair{Glyphs::ascii, "=  limit"}}) {
    Canvas canvas(16, 60, glyphs);
    draw_chart(canvas, canvas.whole(),
               {"t", "x", "y", {{"mean", Mark::both, {{0.0, 1.0}}}, {"limit", Mark::level, {{1.0, 2.0}}}}}, {});
    CHECK_MESSAGE(contains(canvas.plain_text(), level), canvas.plain_text());
  }
}

TEST_CASE("a line stops where its points are too far apart") {
  PlotPanel p{"", "s", "um", {{"", Mark::forward, {{0.0, 0.0}, {1.0, 0.0}, {9.0, 0.0}, {10.0, 0.0}}}}};
  const auto dots = [&p] {
    Canvas canvas(12, 60, Glyphs::ascii);
    draw_chart(canvas, canvas.whole(), p, {0.0, 10.0, {}, -1.0, 1.0});
    const std::string text = canvas.plain_text();
    return std::count(text.begin(), text.end(), '.');
  };
  const auto joined = dots();
  p.series[0].longest_gap = 2.0;
  CHECK(dots() < joined - 20);
}

TEST_CASE("a chart on a screen says um as its texts do") {
  PlotPanel p = panel();
  p.y_label = "error [µm]";
  Canvas canvas(16, 60, Glyphs::unicode);
  draw_chart(canvas, canvas.whole(), p, {});
  CHECK(contains(canvas.plain_text(), "error [um]"));
}
