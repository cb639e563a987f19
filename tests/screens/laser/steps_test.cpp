// The steps on the screen from files to curves, each against numbers known beforehand.
#include "app/verbs/registry.hpp"
#include "tests/support/laser_screen.hpp"

namespace ecs::app {
namespace {

const LaserLine& line_named(const LaserWork& work, const std::string& key) {
  for (const LaserLine& line : work.lines)
    if (line.key == key) return line;
  FAIL("no line " << key);
  return work.lines.front();
}
const LaserLineResult& result_of(const LaserWork& work, const std::string& key) {
  for (std::size_t k = 0; k < work.lines.size(); ++k)
    if (work.lines[k].key == key) return *work.results[k];
  FAIL("no line " << key);
  return *work.results.front();
}
const LaserCurve& curve_of_component(const LaserWork& work, Component component) {
  for (const LaserCurve& curve : work.curves)
    if (curve.component == component) return curve;
  FAIL("no curve");
  return work.curves.front();
}

const Measured kStraightness{'X', "EY", 0, -400, 50, {0, -1400, 0}, "straightness"};

TEST_CASE("a folder's files are named for what they are, taken at once, and unknown ones explained") {
  const StateFolder folder;
  folder.with("day/x.csv", measured_csv(kPositioning, [](double p) { return 0.01 * p; }));
  folder.with("day/straight.csv", measured_csv(kStraightness, [](double p) { return 0.01 * p; }));
  folder.with("day/notes.txt", "the machine was cold\n");
  LaserSitting sitting;
  sitting.type("a" + folder.path.string() + "/da\t");
  REQUIRE(sitting.shows("[all 2 measurement files here]"));
  CHECK(sitting.seen().find("EXX, 54 readings") != std::string::npos);
  CHECK(sitting.seen().find("EYX, 54 readings") != std::string::npos);
  sitting.press(Key::Name::down, 2);
  CHECK(sitting.seen().find("notes.txt") != std::string::npos);
  CHECK(sitting.seen().find("not read") != std::string::npos);
  sitting.press(Key::Name::home);
  sitting.press(Key::Name::down);
  sitting.type("\n");
  REQUIRE(sitting.settled());
  CHECK(sitting.controller().work().lines.size() == 2);
  CHECK(sitting.controller().mark(LaserStep::files) == LaserMark::done);
  CHECK(sitting.seen().find("straight.csv") != std::string::npos);
}

TEST_CASE("marks choose single files, and a typed path is completed") {
  const StateFolder folder;
  for (const char* name : {"one.csv", "two.csv", "three.csv"})
    folder.with(std::string("f/") + name, measured_csv(kPositioning, [](double) { return 1.0; }));
  LaserSitting sitting;
  sitting.type("a" + folder.path.string() + "/f/\t");
  REQUIRE(sitting.shows("[all 3"));
  sitting.press(Key::Name::down, 2);
  sitting.type("  \n");
  REQUIRE(sitting.settled());
  REQUIRE(sitting.controller().choices().files.size() == 2);
  CHECK(sitting.controller().choices().files[0].path.ends_with("one.csv"));
  CHECK(sitting.controller().choices().files[1].path.ends_with("three.csv"));
  sitting.type("atw\t\n");
  REQUIRE(sitting.settled());
  CHECK(sitting.controller().choices().files.size() == 3);
}

TEST_CASE("a file that does not say what was measured is asked, and the answers stay with the draft") {
  const StateFolder folder;
  const std::string file = folder.with("pitch.rta", [] {
    std::ifstream in("samples/laser/pitch.rta", std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }());
  {
    LaserSitting sitting;
    sitting.controller().change("file", [&](LaserChoices& c) { c.files.push_back({file, {}}); });
    REQUIRE(sitting.settled());
    CHECK(sitting.controller().mark(LaserStep::files) == LaserMark::doubtful);
    CHECK(sitting.seen().find("it does not say enough: Enter answers") != std::string::npos);
    sitting.type("\n");
    CHECK(sitting.seen().find("what pitch.rta does not say") != std::string::npos);
    sitting.press(Key::Name::down);
    sitting.type("c");  // the next word with this letter
    CHECK(sitting.seen().find("EC") != std::string::npos);
    sitting.type("\n");
    REQUIRE(sitting.settled());
    CHECK(sitting.controller().work().lines.size() == 1);
    CHECK(sitting.controller().mark(LaserStep::files) == LaserMark::done);
  }
  LaserSitting later;
  CHECK(later.seen().find("found") != std::string::npos);
  later.type("\n");
  REQUIRE(later.settled());
  REQUIRE(later.controller().work().lines.size() == 1);
  CHECK(later.controller().choices().files.front().answers.sense == "EC");
}

TEST_CASE("several files of one line are joined, their runs numbered on") {
  const StateFolder folder;
  const auto error = [](double p) { return 0.01 * p; };
  LaserSitting sitting;
  sitting.take_files({folder.with("monday.csv", measured_csv(kPositioning, error)),
                      folder.with("tuesday.csv", measured_csv(kPositioning, error))});
  REQUIRE(sitting.controller().work().lines.size() == 1);
  CHECK(sitting.controller().work().lines.front().summary.runs == 6);
  sitting.type("2");
  CHECK(sitting.seen().find("tuesday.csv") != std::string::npos);
}

TEST_CASE("the measured lines show what, where, how often and under which conditions") {
  const StateFolder folder;
  Measured after = kPositioning;
  after.compensated = true;
  LaserSitting sitting;
  sitting.take_files({folder.with("x.csv", measured_csv(kPositioning, [](double) { return 0.0; })),
                      folder.with("after.csv", measured_csv(after, [](double) { return 0.0; }))});
  sitting.type("2");
  const std::string seen = sitting.seen();
  CHECK(seen.find("EXX           Y -1400, Z 0     -400..0          50    9    3 both") != std::string::npos);
  CHECK(seen.find("comp.") != std::string::npos);
  CHECK(seen.find("t_air_degC 20.1 .. 20.3") != std::string::npos);
  CHECK(seen.find("date: 1990-03-12") != std::string::npos);
  CHECK(sitting.controller().mark(LaserStep::lines) == LaserMark::doubtful);
}

TEST_CASE("a run left out changes every later step at once, and undo restores the same numbers") {
  const StateFolder folder;
  LaserSitting sitting;
  sitting.take_files({folder.with("x.csv", measured_csv(kPositioning, [](double p) { return 0.01 * p; }))});
  const double before = result_of(sitting.controller().work(), kExx).iso->R_forward.value();
  const auto mean = result_of(sitting.controller().work(), kExx).curve->points.front().forward;
  sitting.type("3\n");  // into the runs
  sitting.press(Key::Name::down, 2);
  sitting.type(" ");
  CHECK(sitting.seen().find("[ ] run 3 out") != std::string::npos);
  REQUIRE(sitting.settled());
  const LaserLineResult& without = result_of(sitting.controller().work(), kExx);
  CHECK(without.chosen.readings.size() == 36);
  CHECK(without.iso->R_forward.value() != doctest::Approx(before));
  CHECK(without.curve->points.front().forward.value() == doctest::Approx(mean.value() - 0.5).epsilon(0.2));
  CHECK(sitting.seen().find("18 of 54 readings left out") != std::string::npos);
  sitting.type("u");
  REQUIRE(sitting.settled());
  CHECK(result_of(sitting.controller().work(), kExx).iso->R_forward.value() == before);
  CHECK(result_of(sitting.controller().work(), kExx).curve->points.front().forward == mean);
  sitting.type("y");
  REQUIRE(sitting.settled());
  CHECK(result_of(sitting.controller().work(), kExx).chosen.readings.size() == 36);
}

TEST_CASE("a reading far from its repeats is suggested, never left out by itself") {
  const StateFolder folder;
  std::string csv = measured_csv(kPositioning, [](double p) { return 0.01 * p; });
  const std::size_t at = csv.find("X,-200,-1400,0,EX,", csv.find(",2,20.2,") - 40);
  const std::size_t begin = at + std::string("X,-200,-1400,0,EX,").size();
  csv.replace(begin, csv.find(',', begin) - begin, "47.5");
  LaserSitting sitting;
  sitting.take_files({folder.with("x.csv", csv)});
  const LaserLine& line = line_named(sitting.controller().work(), kExx);
  REQUIRE(line.suspects.size() == 1);
  CHECK(line.set->readings[line.suspects.front()].error == 47.5);
  CHECK(result_of(sitting.controller().work(), kExx).chosen.readings.size() == 54);
  CHECK(sitting.controller().mark(LaserStep::leave_out) == LaserMark::doubtful);
  sitting.type("3o");
  CHECK(sitting.seen().find("[x]?   -200") != std::string::npos);
  sitting.type(" wbeam broken\n");
  REQUIRE(sitting.settled());
  CHECK(result_of(sitting.controller().work(), kExx).chosen.readings.size() == 53);
  CHECK(sitting.controller().mark(LaserStep::leave_out) == LaserMark::done);
  CHECK(sitting.controller().choices().lines.at(kExx).readings.begin()->second == "beam broken");
}

TEST_CASE("straightness loses its slope by least squares, positioning keeps it, and the numbers are those put in") {
  const StateFolder folder;
  LaserSitting sitting;
  sitting.take_files({folder.with("x.csv", measured_csv(kPositioning, [](double p) { return 0.03 * p; })),
                      folder.with("y.csv", measured_csv(kStraightness, [](double p) { return 0.03 * p; }))});
  const LaserCurve& positioning = curve_of_component(sitting.controller().work(), Component::EXX);
  const LaserCurve& straightness = curve_of_component(sitting.controller().work(), Component::EYX);
  CHECK(positioning.slope == laser::SlopeMethod::none);
  CHECK(positioning.band_after == positioning.band_before);
  CHECK(straightness.slope == laser::SlopeMethod::least_squares);
  CHECK(straightness.removed_per_m == doctest::Approx(30.0).epsilon(0.02));
  CHECK(straightness.band_before == doctest::Approx(12.0 + 4.0).epsilon(0.05));  // slope, runs and reversal
  CHECK(straightness.band_after == doctest::Approx(4.5).epsilon(0.15));
  sitting.type("4");
  sitting.press(Key::Name::down);
  CHECK(sitting.seen().find(fmt::format("{:.2f} um/m", straightness.removed_per_m)) != std::string::npos);
  CHECK(sitting.seen().find("before    ") != std::string::npos);
  CHECK(sitting.seen().find("after    ") != std::string::npos);
  sitting.type("v");
  CHECK(sitting.seen().find("after    ") == std::string::npos);
  sitting.type("vv");
  sitting.type("    ");  // once round and one on: none
  REQUIRE(sitting.settled());
  CHECK(curve_of_component(sitting.controller().work(), Component::EYX).slope == laser::SlopeMethod::none);
  sitting.type("\n");
  CHECK(sitting.seen().find("smoothing [mm]") != std::string::npos);
  sitting.type("250\n");
  REQUIRE(sitting.settled());
  const LaserCurve& smooth = curve_of_component(sitting.controller().work(), Component::EYX);
  REQUIRE(smooth.smoothed);
  CHECK(smooth.smoothed->removed_rms < 0.3);  // a straight line passes the local parabola
}

TEST_CASE("the values of ISO 230-2 are those of the verb") {
  const StateFolder folder;
  const std::string file =
      folder.with("x.csv", measured_csv(kPositioning, [](double p) { return 8.0 * std::sin(p / 90.0); }));
  LaserSitting sitting;
  sitting.take_files({file});
  sitting.type("5");
  const Ran run = ran({"laser", "stats", file});
  REQUIRE(run.code == 0);
  const double A = result_of(sitting.controller().work(), kExx).iso->A.value();
  CHECK(run.all().find(fmt::format("{:.3f}", A)) != std::string::npos);
  CHECK(sitting.seen().find(fmt::format("A      {:>8.2f} um", A)) != std::string::npos);
}

TEST_CASE("the screen says what to do next, and a click on a tab goes there") {
  const StateFolder folder;
  LaserSitting sitting;
  sitting.take_files({folder.with("x.csv", measured_csv(kPositioning, [](double) { return 0.0; }))});
  CHECK(sitting.seen().find("Next: the parameters of the unit, p in step 1, 4 or 6.") != std::string::npos);
  sitting.controller().change("parameters", [](LaserChoices& c) { c.params_file = "samples/mill/parameters.toml"; });
  REQUIRE(sitting.settled());
  CHECK(sitting.seen().find("Step 6: 16 of 17 components are missing.") != std::string::npos);
  const std::string tabs = sitting.seen().substr(sitting.seen().find("[1"), 80);
  Key click{Key::Name::mouse};
  click.row = 1;
  click.column = static_cast<int>(tabs.find("6!"));
  (void)sitting.screen->on_key(click);
  CHECK(sitting.screen->step() == LaserStep::map);
}

TEST_CASE("Esc asks before unsaved work is left, and leaves at once where there is none") {
  const StateFolder folder;
  LaserSitting sitting;
  CHECK(sitting.type("\x1b") == Step::Kind::back);
  sitting.take_files({folder.with("x.csv", measured_csv(kPositioning, [](double) { return 0.0; }))});
  CHECK(sitting.type("\x1b") == Step::Kind::stay);
  CHECK(sitting.seen().find("Leave? The map is not saved.") != std::string::npos);
  CHECK(sitting.type("n") == Step::Kind::stay);
  sitting.type("\x1b");
  CHECK(sitting.type("y") == Step::Kind::back);
}

}  // namespace
}  // namespace ecs::app
