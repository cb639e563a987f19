// The steps of PROCESS LASER DATA on the screen: files, answers that they lack, lines and where they were measured,
// runs and readings left out, curves, values, what is remarked in header and map.
#include "tests/screens/support/laser_screen.hpp"
#include "tests/screens/support/laser_unit.hpp"

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
    if (work.lines[k].key == key) return work.results[k];
  FAIL("no line " << key);
  return work.results.front();
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
  LaserScreenDriver driver;
  REQUIRE(driver.shows_after("a" + folder.path.string() + "/da\t", "[all 2 measurement files here]"));
  check_holds(driver.seen(), {"EXX, 54 readings", "EYX, 54 readings"});
  driver.press(Key::Name::down, 2);
  check_holds(driver.seen(), {"notes.txt", "unknown kind"});
  driver.press(Key::Name::home);
  driver.press(Key::Name::down);
  REQUIRE(driver.settles_after("\n"));
  CHECK(driver.controller().work().lines.size() == 2);
  CHECK(driver.controller().mark(LaserStep::files) == LaserMark::done);
  CHECK(contains(driver.seen(), "straight.csv"));
}

TEST_CASE("what a file does not state is named in the form, with the cursor there") {
  CHECK(fields_needed("the file does not state which error it contains: give EY or EZ across the axis X, for example "
                      "--axis X --sense EY") == std::vector<std::string>{"sense"});
  CHECK(fields_needed("give one of A, B (--channel NAME)") == std::vector<std::string>{"channel"});
  CHECK(problem_on_screen("a.log: give one of A, B (--channel NAME)") ==
        "a.log: give one of A, B. Press Enter and set channel.");
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({"samples/laser/pitch.rta"});
  CHECK(reads(driver.seen(), "give EA, EB or EC. Press Enter and set sense."));
  driver.type("\n");
  check_holds(driver.seen(), {"import options of pitch.rta (needed: sense)", "> sense", "give EA, EB or EC"});
}

TEST_CASE("a parameter file of another kind keeps the form open") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.type("psamples/mill/machine.toml\n");
  CHECK(contains(driver.seen(), "machine.toml is a machine file, not a parameter file."));
  CHECK(driver.controller().choices().params_file.empty());
}

TEST_CASE("letters choose a value that begins with them, and a word that is none keeps the value before it") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.type("p");
  driver.press(Key::Name::down);
  const auto scope = [&](const std::string& keys) {
    driver.type(keys);
    const std::string seen = driver.seen();
    const std::size_t at = seen.find("> scope");
    return std::string(trimmed(seen.substr(at + 7, seen.find('_', at) - at - 7)));
  };
  CHECK(contains(driver.seen(), "next value. Or type how it begins"));
  CHECK(scope("linear") == "linear");
  CHECK(scope("planar") == "planar");
  CHECK(scope("vo") == "volumetric");
  CHECK(scope("x") == "planar");
  CHECK(contains(driver.seen(), "No value begins with \"vox\". Values: linear, planar, volumetric."));
  driver.type("\n");
  CHECK(contains(driver.seen(), "No value begins with \"vox\""));
  driver.press(Key::Name::backspace);
  CHECK(scope("l") == "linear");
}

TEST_CASE("a component declared zero that the scope does not need is not in the map, and comes back with its scope") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({folder.with("EXX.csv", measured_csv(kPositioning, [](double p) { return 0.01 * p; }))},
                    "samples/mill/parameters.toml");
  const auto zeros_with = [&](const std::string& scope) {
    driver.controller().change("scope", [&](LaserChoices& c) {
      c.scope = scope;
      for (const Component one : {Component::EYX, Component::EZX}) laser::declare_zero(c.recipe, one, "stiff");
    });
    REQUIRE(driver.settled());
    return driver.controller().work().map.made->map.map.header.declared_zero.size();
  };
  CHECK(zeros_with("volumetric") == 2);
  CHECK(zeros_with("planar") == 1);
  CHECK(reads(driver.after("8"), "1 component measured (forward and reverse table), 1 declared zero, not complete"));
  CHECK(zeros_with("volumetric") == 2);
}

TEST_CASE("Enter on a measured component names its files, and only z asks to declare it zero") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({folder.with("EXX.csv", measured_csv(kPositioning, [](double p) { return 0.01 * p; }))},
                    "samples/mill/parameters.toml");
  const std::string seen = driver.after("6\n");
  CHECK(reads(seen, "EXX, X axis linear positioning error: from "));
  CHECK(contains(seen, "Enter details"));
  CHECK_FALSE(contains(seen, "Declare it zero nevertheless?"));
  CHECK(reads(driver.after("z"), "EXX is measured. Declare it zero nevertheless?"));
}

TEST_CASE("before a map was saved step 9 does not offer to compare it, and step 8 says which keys write files") {
  const StateFolder folder;
  LaserScreenDriver driver;
  const std::string seen = driver.after("9");
  CHECK(reads(seen, "No map saved or sent yet: see step 8."));
  CHECK_FALSE(contains(seen, "Enter"));
  CHECK(reads(driver.after("\n"), "no map to compare with yet"));
  CHECK(reads(driver.after("8"), "The keys Enter and s also write map-parameters.toml (parameters) and "));
}

TEST_CASE("marks choose single files, and a typed path is completed") {
  const StateFolder folder;
  for (const char* name : {"one.csv", "two.csv", "three.csv"})
    folder.with(std::string("f/") + name, measured_csv(kPositioning, [](double) { return 1.0; }));
  LaserScreenDriver driver;
  REQUIRE(driver.shows_after("a" + folder.path.string() + "/f/\t", "[all 3"));
  driver.press(Key::Name::down, 2);
  REQUIRE(driver.settles_after("  \n"));
  REQUIRE(driver.controller().choices().files.size() == 2);
  CHECK(driver.controller().choices().files[0].path.ends_with("one.csv"));
  CHECK(driver.controller().choices().files[1].path.ends_with("three.csv"));
  REQUIRE(driver.settles_after("atw\t\n"));
  CHECK(driver.controller().choices().files.size() == 3);
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
    LaserScreenDriver driver;
    driver.controller().change("file", [&](LaserChoices& c) { c.files.push_back({file, {}}); });
    REQUIRE(driver.settled());
    CHECK(driver.controller().mark(LaserStep::files) == LaserMark::doubtful);
    CHECK(contains(driver.seen(), "incomplete: press Enter to add data"));
    CHECK(contains(driver.after("\n"), "import options of pitch.rta (needed: sense)"));
    driver.type("q");
    CHECK(contains(driver.seen(), "No value begins with \"q\". Values: EX"));
    driver.type("ec");
    check_holds(driver.seen(), {"> sense", "EC_"});
    REQUIRE(driver.settles_after("\n"));
    CHECK(driver.controller().work().lines.size() == 1);
    CHECK(driver.controller().mark(LaserStep::files) == LaserMark::done);
  }
  LaserScreenDriver later;
  CHECK(contains(later.seen(), "found"));
  REQUIRE(later.settles_after("\n"));
  REQUIRE(later.controller().work().lines.size() == 1);
  CHECK(later.controller().choices().files.front().answers.sense == "EC");
}

TEST_CASE("several files of one line are joined, their runs numbered on") {
  const StateFolder folder;
  const auto error = [](double p) { return 0.01 * p; };
  LaserScreenDriver driver;
  driver.take_files({folder.with("monday.csv", measured_csv(kPositioning, error)),
                     folder.with("tuesday.csv", measured_csv(kPositioning, error))});
  CHECK(only(driver.controller().work().lines).summary.runs == 6);
  CHECK(contains(driver.after("2"), "tuesday.csv"));
}

TEST_CASE("the measured lines show what, where, how often and under which conditions") {
  const StateFolder folder;
  Measured after = kPositioning;
  after.compensated = true;
  LaserScreenDriver driver;
  driver.take_files({folder.with("x.csv", measured_csv(kPositioning, [](double) { return 0.0; })),
                     folder.with("after.csv", measured_csv(after, [](double) { return 0.0; }))});
  const std::string seen = driver.after("2");
  check_holds(seen, {"EXX           Y -1400, Z 0     -400..0          50    9    3 both", "comp.",
                     "t_air_degC 20.1 .. 20.3", "date: 1990-03-12"});
  CHECK(driver.controller().mark(LaserStep::lines) == LaserMark::doubtful);
}

TEST_CASE("a run left out changes every later step at once, and undo restores the same numbers") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({folder.with("x.csv", measured_csv(kPositioning, [](double p) { return 0.01 * p; }))});
  const double before = result_of(driver.controller().work(), kExx).iso->R_forward.value();
  const auto mean = result_of(driver.controller().work(), kExx).curve->points.front().forward;
  CHECK(contains(driver.after("3 "), "Press Enter first to go to the runs of this line."));
  driver.type("\n");  // into the runs
  driver.press(Key::Name::down, 2);
  CHECK(contains(driver.after(" "), "OUT  run 3"));
  REQUIRE(driver.settled());
  const LaserLineResult& without = result_of(driver.controller().work(), kExx);
  CHECK(without.chosen.readings.size() == 36);
  CHECK(without.iso->R_forward.value() != Approx(before));
  CHECK(without.curve->points.front().forward.value() == Approx(mean.value() - 0.5).epsilon(0.2));
  CHECK(contains(driver.seen(), "18 of 54 readings excluded"));
  REQUIRE(driver.settles_after("u"));
  CHECK(result_of(driver.controller().work(), kExx).iso->R_forward.value() == before);
  CHECK(result_of(driver.controller().work(), kExx).curve->points.front().forward == mean);
  REQUIRE(driver.settles_after("y"));
  CHECK(result_of(driver.controller().work(), kExx).chosen.readings.size() == 36);
}

TEST_CASE("a reading far from its repeats is suggested, never left out on its own") {
  const StateFolder folder;
  std::string csv = measured_csv(kPositioning, [](double p) { return 0.01 * p; });
  const std::size_t at = csv.find("X,-200,-1400,0,EX,", csv.find(",2,20.2,") - 40);
  const std::size_t begin = at + std::string("X,-200,-1400,0,EX,").size();
  csv.replace(begin, csv.find(',', begin) - begin, "47.5");
  LaserScreenDriver driver;
  driver.take_files({folder.with("x.csv", csv)});
  const LaserLine& line = line_named(driver.controller().work(), kExx);
  REQUIRE(line.suspects.size() == 1);
  CHECK(line.set->readings[line.suspects.front()].error == 47.5);
  CHECK(result_of(driver.controller().work(), kExx).chosen.readings.size() == 54);
  CHECK(driver.controller().mark(LaserStep::leave_out) == LaserMark::doubtful);
  CHECK(contains(driver.after("3o"), "in ?   -200"));
  REQUIRE(driver.settles_after(" wbeam broken\n"));
  CHECK(result_of(driver.controller().work(), kExx).chosen.readings.size() == 53);
  CHECK(driver.controller().mark(LaserStep::leave_out) == LaserMark::done);
  CHECK(driver.controller().choices().lines.at(kExx).readings.begin()->second == "beam broken");
}

TEST_CASE("straightness loses its slope by least squares, positioning keeps it, and the numbers are those put in") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({folder.with("x.csv", measured_csv(kPositioning, [](double p) { return 0.03 * p; })),
                     folder.with("y.csv", measured_csv(kStraightness, [](double p) { return 0.03 * p; }))});
  const LaserCurve& positioning = curve_of_component(driver.controller().work(), Component::EXX);
  const LaserCurve& straightness = curve_of_component(driver.controller().work(), Component::EYX);
  CHECK(positioning.slope == laser::SlopeMethod::none);
  CHECK(positioning.band_after == positioning.band_before);
  CHECK(straightness.slope == laser::SlopeMethod::least_squares);
  CHECK(straightness.removed_per_m == Approx(30.0).epsilon(0.02));
  CHECK(straightness.band_before == Approx(12.0 + 4.0).epsilon(0.05));  // slope, runs and reversal
  CHECK(straightness.band_after == Approx(4.5).epsilon(0.15));
  driver.type("4");
  driver.press(Key::Name::down);
  CHECK(contains(driver.seen(), fmt::format("{:.2f} um/m", straightness.removed_per_m)));
  check_holds(driver.seen(), {"before    ", "after    "});
  CHECK(!contains(driver.after("v"), "after    "));
  driver.type("vv");
  driver.type("    ");  // once round and one on: none
  REQUIRE(driver.settled());
  CHECK(curve_of_component(driver.controller().work(), Component::EYX).slope == laser::SlopeMethod::none);
  CHECK(contains(driver.after("\n"), "smoothing [mm]"));
  REQUIRE(driver.settles_after("250\n"));
  const LaserCurve& smooth = curve_of_component(driver.controller().work(), Component::EYX);
  REQUIRE(smooth.smoothed);
  CHECK(smooth.smoothed->removed_rms < 0.3);  // a straight line passes the local parabola
}

TEST_CASE("the values of ISO 230-2 are those of the verb") {
  const StateFolder folder;
  const std::string file =
      folder.with("x.csv", measured_csv(kPositioning, [](double p) { return 8.0 * std::sin(p / 90.0); }));
  LaserScreenDriver driver;
  driver.take_files({file});
  driver.type("5");
  const Ran run = ran({"laser", "stats", file});
  REQUIRE(run.code == 0);
  const double A = result_of(driver.controller().work(), kExx).iso->A.value();
  CHECK(contains(run.all(), fmt::format("{:.3f}", A)));
  CHECK(contains(driver.seen(), fmt::format("A      {:>8.2f} um", A)));
}

TEST_CASE("the screen says what to do next, and a click on a tab goes there") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({folder.with("x.csv", measured_csv(kPositioning, [](double) { return 0.0; }))});
  CHECK(contains(driver.seen(), "Next: choose the parameters of the unit: p in step 1, 4 or 6."));
  driver.controller().change("parameters", [](LaserChoices& c) { c.params_file = "samples/mill/parameters.toml"; });
  REQUIRE(driver.settled());
  CHECK(contains(driver.seen(), "Step 6: 16 of 17 components are missing."));
  const std::string tabs = driver.seen().substr(driver.seen().find("[1"), 80);
  Key click{Key::Name::mouse};
  click.row = 1;
  click.column = static_cast<int>(tabs.find("6!"));
  (void)driver.screen->on_key(click);
  CHECK(driver.screen->step() == LaserStep::map);
}

TEST_CASE("Esc asks before unsaved work is left, and leaves at once where there is none") {
  const StateFolder folder;
  LaserScreenDriver driver;
  CHECK(driver.type("\x1b") == Step::Kind::back);
  driver.take_files({folder.with("x.csv", measured_csv(kPositioning, [](double) { return 0.0; }))});
  CHECK(driver.type("\x1b") == Step::Kind::stay);
  CHECK(contains(driver.seen(), "Leave? The map is not saved."));
  CHECK(driver.type("n") == Step::Kind::stay);
  driver.type("\x1b");
  CHECK(driver.type("y") == Step::Kind::back);
}

cli::Arguments import_fields(ImportArguments& into) { return cli::fields_of<ImportArguments>().arguments_for(into); }

TEST_CASE("every answer is kept as it was given") {
  ImportArguments answers;
  for (const cli::Argument& field : import_fields(answers)) {
    const bool number =
        std::holds_alternative<int*>(field.into) || std::holds_alternative<std::optional<double>*>(field.into);
    const std::string value = !field.choices.empty() ? field.choices.back()
                              : field.is_flag()      ? "yes"
                                                     : (number ? "3" : "some");
    CHECK(set_answer(answers, field.name.substr(2), value).empty());
    CHECK_MESSAGE(given_answers(answers).at(field.name.substr(2)) == value, field.name);
  }
  CHECK(answers.channels == "some");
  CHECK(answers.environment == "some");
  CHECK(answers.at_rest_mm == 3.0);
  CHECK(answers.average);
}

TEST_CASE("the form asks for the channels of a log and its environment, and refuses what is no number") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({folder.with("log.txt", "nothing that is known\n")});
  driver.type("\n");
  ImportArguments none;
  const auto fields = import_fields(none);
  const auto at_rest = std::ranges::find(fields, "--at-rest", &cli::Argument::name);
  driver.press(Key::Name::down, static_cast<int>(at_rest - fields.begin()));
  check_holds(driver.after("still\n"), {"at-rest: expected a number, found \"still\"", "channels"});
  driver.press(Key::Name::backspace, 5);
  REQUIRE(driver.settles_after("0.01\n"));
  CHECK(driver.controller().choices().files.front().answers.at_rest_mm == 0.01);
}

TEST_CASE("the extent of a line is shown in whole millimetres at least") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({folder.with("x.csv",
                                 "axis,sense,x_mm,y_mm,z_mm,reading\nX,EX,-3712.53,0,0,0\nX,EX,-2000.5,0,0,1\n"
                                 "X,EX,-157.25,0,0,1\n")});
  CHECK(contains(driver.after("2"), "-3713..-157"));
}

/// The sample of 200 mm of X, with the parameters and the machine of the mill's X axis alone.
void take_short_axis(LaserScreenDriver& driver, const StateFolder& folder) {
  folder.with("machine.toml",
              "configuration = \"TX\"\nname = \"moving column mill\"\n[axis.X]\ntravel_mm = [-4100.0, 0.0]\n");
  const std::string params = folder.with("p.toml",
                                         "[identity]\nmachine = \"moving column mill\"\n[configuration]\nchain = "
                                         "\"TX\"\naxes = \"X\"\n[compensation]\nscope = \"linear\"\n[axis.X]\n"
                                         "transducer = \"encoder\"\n# end of parameters\n");
  driver.take_files({"samples/laser/x_axis.csv"}, params);
}

TEST_CASE("a map of a piece of its axis is complete with its remarks, in step 6 and in step 8") {
  const StateFolder folder;
  LaserScreenDriver driver;
  take_short_axis(driver, folder);
  REQUIRE(driver.controller().work().map.complete());
  CHECK(driver.controller().mark(LaserStep::map) == LaserMark::doubtful);
  driver.type("6");
  CHECK(contains(driver.seen(24, 120), "complete, 3 remarks"));
  driver.type("\t");
  CHECK(contains(driver.seen(40, 120), "remark: EXX covers only 200 of 4100 mm"));
  driver.type("8");
  const std::string seen = driver.seen(24, 100);
  check_holds(seen, {"complete, 3 remarks", "EXX covers only 200 of 4100 mm of the travel of X (-4100 to 0)"});
}

TEST_CASE("the date of the header is a date; another text is not taken, and what is expected is said") {
  const StateFolder folder;
  LaserScreenDriver driver;
  take_short_axis(driver, folder);
  driver.type("7");
  driver.press(Key::Name::down, 4);
  driver.type("\nN. Comer\n");
  CHECK(contains(driver.seen(24, 120), "expected year-month-day, as in 2026-03-12, found \"N. Comer\""));
  CHECK(driver.controller().choices().recipe.date.empty());
  driver.press(Key::Name::backspace, 8);
  REQUIRE(driver.settles_after("2024-05-06\n"));
  CHECK(driver.controller().work().map.made->map.map.header.date == "2024-05-06");
}

TEST_CASE("an invalid date of the files is not preset") {
  const StateFolder folder;
  const std::string file = folder.with("x.csv", "# date: Mon Mar 12\naxis,sense,x_mm,reading\nX,EX,0,0\nX,EX,-50,1\n");
  LaserScreenDriver driver;
  driver.take_files({file});
  CHECK(header_with_files({}, driver.controller().work().lines).date.empty());
}

TEST_CASE("a header whose files state no date has the date of today, and says so") {
  const StateFolder folder;
  const std::string file = folder.with("x.csv", "axis,sense,x_mm,reading\nX,EX,0,0\nX,EX,-50,1\n");
  LaserScreenDriver driver;
  driver.take_files({file});
  CHECK_FALSE(states_date(driver.controller().work().lines));
  driver.type("7");
  CHECK(contains(driver.seen(24, 120), "(today; no file states a date)"));
}

TEST_CASE("the question before sending names the first remark and what the header does not state") {
  ReadyMill ready;
  LaserScreenDriver& driver = ready.driver;
  // X measured over a tenth of its travel: samples/mill/machine.toml says -4100 to 0
  const std::string piece =
      ready.folder.with("piece.csv", measured_csv({'X', "EX", 0, -400, 50, {0, -1400, 0}}, ready.mill.error));
  driver.controller().change("a piece of X", [&](LaserChoices& c) { c.files.front().path = piece; });
  REQUIRE(driver.settled());
  REQUIRE(driver.shows_after("\n", "Send the map to"));
  const std::string asked = driver.seen(24, 100);
  check_holds(asked, {"1 remark: EXX covers only 400 of 4100 mm", "states no customer, no engineer.", "y send"});
}

const std::string kMillParameters = "samples/mill/parameters.toml";

Measured off_its_line() {
  Measured wrong = kPositioning;
  wrong.parked_mm = {0, -1000, 0};
  return wrong;
}

TEST_CASE("step 6 says why a measured component is not used, step 2 corrects its place") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({folder.with("EXX.csv", measured_csv(off_its_line(), [](double p) { return 0.01 * p; }))},
                    kMillParameters);
  CHECK(contains(driver.seen(24, 160), "EXX is measured, but not used: see step 6."));
  driver.type("6");
  const std::string missing = driver.seen(24, 160);
  INFO(missing);
  check_holds(missing, {"it was measured at Y -1000 (or the file does not state Y)", "parameters is at Y -1400",
                        "Press c in step 2"});
  CHECK(contains(driver.after("2c"), "y=-1000,z=0"));
  driver.press(Key::Name::backspace, 11);
  REQUIRE(driver.settles_after("y=-1400,z=0\n"));
  const LaserLine& line = driver.controller().work().lines.front();
  CHECK(line.key == kExx);
  CHECK(only(line.notes) == "position corrected to y=-1400,z=0; EXX.csv states Y -1000, Z 0");
  CHECK(driver.controller().work().map.components.front().state == ComponentState::present);
  REQUIRE(driver.settles_after("u"));
  CHECK(driver.controller().work().map.components.front().state == ComponentState::missing);
}

TEST_CASE("what was left out stays with a line whose place is corrected, and both are kept in the draft") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({folder.with("EXX.csv", measured_csv(off_its_line(), [](double) { return 1.0; }))});
  const LaserLine line = driver.controller().work().lines.front();
  LaserChoices choices = driver.controller().choices();
  choices.lines[line.key].runs[2] = "cold";
  REQUIRE(correct_place(choices, line, "y=-1400,z=0").has_value());
  CHECK(choices.lines[kExx].runs.contains(2));
  CHECK(choices_in(choices_text(choices)) == choices);
  CHECK(contains(to_text(must_fail(correct_place(choices, line, "y=far"))), "expected AXIS=MM"));
}

TEST_CASE("parameters of another machine are reported when they are chosen") {
  const StateFolder folder;
  const Measured along_y{'Y', "EY", -1400, 0, 50, {0, 0, 0}};
  LaserScreenDriver driver;
  const std::string lathe = folder.with("lathe.toml",
                                        "[configuration]\nchain = \"XT\"\naxes = \"X\"\n[compensation]\n"
                                        "scope = \"linear\"\n[axis.X]\ntransducer = \"encoder\"\n"
                                        "# end of parameters\n");
  driver.take_files({folder.with("EYY.csv", measured_csv(along_y, [](double) { return 1.0; }))}, lathe);
  CHECK(contains(driver.seen(24, 120), "EYY was measured, but the parameters (XT) have no axis Y."));
  driver.controller().change("parameters", [](LaserChoices& c) { c.params_file = kMillParameters; });
  REQUIRE(driver.settled());
  CHECK(driver.controller().mismatch().empty());
}

}  // namespace
}  // namespace ecs::app
