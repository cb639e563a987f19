// What is left out stays visible in the curves; where lines were measured is told wherever the file knows it.
#include "tests/screens/support/laser_screen.hpp"

namespace ecs::app {
namespace {

const Measured kLower{'X', "EX", 0, -400, 50, {0, -1400, -1000}};

PlotPanel three_points() {
  return {"t", "X [mm]", "error [um]", {{"runs", Mark::forward_reading, {{0, 0}, {100, 10}, {200, 4}}}}};
}

CellPosition place_of(const Canvas& canvas, char32_t sign) {
  for (int r = 1; r < canvas.rows() - 3; ++r)
    for (int c = 9; c < canvas.columns(); ++c)
      if (canvas.at(r, c).glyph == sign) return {r, c};
  return {-1, -1};
}

std::string file_with(const StateFolder& folder, const std::string& reading_at_200) {
  std::string csv = measured_csv(kPositioning, [](double p) { return 0.01 * p; });
  const std::size_t at = csv.find("X,-200,-1400,0,EX,") + std::string("X,-200,-1400,0,EX,").size();
  csv.replace(at, csv.find(',', at) - at, reading_at_200);
  return folder.with("x.csv", csv);
}

TEST_CASE("a reading left out is an x in the cell where a chart puts it") {
  for (const Glyphs glyphs : {Glyphs::ascii, Glyphs::unicode})
    for (const PlotPoint& p : {PlotPoint{50, 5}, {0, -3}, {200, 14}, {130, 0.5}}) {
      Canvas left_out(14, 60, glyphs), counted(14, 60, glyphs);
      draw_laser_chart(left_out, left_out.whole(), three_points(), {p}, {});
      PlotPanel with = three_points();
      with.series.push_back({"", Mark::reading, {p}});
      draw_chart(counted, counted.whole(), with, left_out_seen(three_points(), {p}, {}).view);
      const CellPosition x = place_of(left_out, U'x');
      const CellPosition o = place_of(counted, glyphs == Glyphs::ascii ? U'o' : U'○');
      CAPTURE(p.x);
      CHECK(x.row == o.row);
      CHECK(x.column == o.column);
    }
}

TEST_CASE("readings left out do not change the scale: far ones are at the edge with their value") {
  const std::vector<PlotPoint> out{{50, 5000}, {150, -300}, {120, 14}};
  const LeftOutSeen seen = left_out_seen(three_points(), out, {});
  CHECK(seen.inside.size() == 1);
  CHECK(seen.above.size() == 1);
  CHECK(seen.below.size() == 1);
  CHECK(*seen.view.y_to - *seen.view.y_from < 3.5 * 10.0);  // the others spread 10
  Canvas canvas(14, 60, Glyphs::ascii);
  draw_laser_chart(canvas, canvas.whole(), three_points(), out, {});
  const std::string drawn = canvas.plain_text();
  INFO(drawn);
  check_holds(drawn, {"x 5000", "x -300"});
  CHECK(left_out_legend(three_points(), out, "um") == "x excluded: 3; beyond the edge: 5000 um at 50, -300 um at 150");
  const PlotPanel picture = with_left_out(three_points(), out, "um");
  CHECK(picture.title == "t (3 excluded, beyond the edge: 5000 um at 50, -300 um at 150)");
  CHECK(picture.series.front().points.size() == 1);
  const std::vector<PlotPoint> many(6, {50, 5000});
  CHECK(beyond_text(three_points(), many, "um") == "6 beyond the edge: 5000 to 5000 um");
}

TEST_CASE("a run left out stays in both curves, marked x and said so, in unicode and in ASCII") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({folder.with("x.csv", measured_csv(kPositioning, [](double p) { return 0.01 * p; }))});
  driver.type("3\n");
  driver.press(Key::Name::down, 2);
  const std::size_t before = count_of(driver.seen(), 'x');
  REQUIRE(driver.settles_after(" "));
  for (const Glyphs glyphs : {Glyphs::unicode, Glyphs::ascii}) {
    const std::string seen = driver.seen(24, 80, glyphs);
    INFO(seen);
    CHECK(contains(seen, "18 of 54 readings excluded (x)"));
    CHECK(count_of(seen, 'x') > before + 5);
  }
  driver.type(
      "\x1b"
      "4");
  const std::string seen = driver.seen(24, 80, Glyphs::ascii);
  INFO(seen);
  CHECK(contains(seen, "x excluded: 18"));
  CHECK(!contains(seen, "beyond"));
  CHECK(count_of(seen, 'x') > 5);
}

TEST_CASE("an outlier left out is shown at the edge of the curve with its value, and the axis stays as it was") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({file_with(folder, "947.5")});
  REQUIRE(driver.settles_after("3o "));
  const std::string seen = driver.seen(24, 80, Glyphs::ascii);
  INFO(seen);
  CHECK(contains(seen, "1 of 54 readings excluded (x); beyond the edge: 947.5"));
  CHECK(contains(seen, "at -200: forward "));  // under the cursor
  CHECK(contains(seen, ", x 947.50"));
  CHECK(!contains(seen, "1000 "));
  driver.type(
      "\x1b"
      "4");
  const std::string curve = driver.seen(24, 80, Glyphs::ascii);
  INFO(curve);
  check_holds(curve, {"x excluded: 1; beyond the edge: 947.5 um at -200", "x 947.5"});
}

TEST_CASE("a line of which every reading is left out still shows them") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({file_with(folder, "1.0")});
  driver.controller().change("all", [](LaserChoices& c) { c.lines[kExx].runs = {{1, ""}, {2, ""}, {3, ""}}; });
  REQUIRE(driver.settled());
  driver.type("3");
  const std::string seen = driver.seen(24, 80, Glyphs::ascii);
  INFO(seen);
  CHECK(contains(seen, "every reading is excluded"));
  CHECK(count_of(seen, 'x') > 15);
}

TEST_CASE("before any parameters are chosen the curves are named by where they were measured") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({folder.with("x.csv", measured_csv(kPositioning, [](double) { return 1.0; })),
                     folder.with("x_low.csv", measured_csv(kLower, [](double) { return 2.0; }))});
  const std::string seen = driver.after("4");
  INFO(seen);
  check_holds(seen, {"EXX  Y -1400, Z 0 ", "EXX  Y -1400, Z -1000"});
  CHECK(contains(driver.seen(12, 40), "EXX  Y -1400, Z -1000"));
}

TEST_CASE("a file that does not say where the other axes stood is asked for it from the list of lines") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({folder.with("plain.csv", "sense,axis,reading,x_mm\nEX,X,1.5,10\nEX,X,2.5,20\nEX,X,2.0,30\n"),
                     folder.with("half.csv", "sense,axis,reading,x_mm,y_mm\nEY,X,1,10,-70\nEY,X,2,20,-70\n")});
  const std::string seen = driver.after("2");
  INFO(seen);
  check_holds(seen, {"Y ?, Z ?: Enter", "Y -70, Z ?: Enter 10..20           10    2    1 ?",
                     "Y ?, Z ?: Enter   10..30           10    3    1 ?",
                     "parked position of Y and Z not in the file: 0 until set (press Enter)"});
  CHECK(driver.controller().mark(LaserStep::lines) == LaserMark::doubtful);
  CHECK(contains(driver.after("\n"), "import options of plain.csv"));
  REQUIRE(driver.settles_after("y=-1400,z=0\n"));
  CHECK(contains(driver.seen(), "Y -1400, Z 0 "));
  CHECK(!contains(driver.seen(), "Y ?"));
}

TEST_CASE("a long message is readable at 80 columns, and the step keeps the rest") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({folder.with("x.csv", measured_csv(kPositioning, [](double) { return 1.0; }))});
  std::string words;
  for (int k = 0; k < 60; ++k) words += fmt::format("word{} ", k);
  driver.controller().message().say(words, Tone::bad);
  const std::string seen = driver.seen();
  INFO(seen);
  check_holds(seen, {"word59", "x.csv"});
}

}  // namespace
}  // namespace ecs::app
