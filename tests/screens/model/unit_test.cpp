// From a model to the unit on the MODEL screen: the map with what is missing, the question, sent; and the map opened
// on the laser screen.
#include <cmath>

#include <fmt/format.h>

#include "base/file.hpp"
#include "tests/screens/support/laser_unit.hpp"
#include "tests/screens/support/mill_model.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

/// Through all questions but the last, with the proposed answers.
void build_map(ModelScreen& screen, const std::string& map) {
  (void)letter(screen, 'm');
  if (contains(picture(screen), "Save the model first?")) (void)letter(screen, 'y');
  REQUIRE(contains(picture(screen), "write the map to:"));
  replace_line(screen, map);
  REQUIRE(reads(picture(screen), "parameters of the unit"));
  REQUIRE(contains(picture(screen), "samples/mill/parameters.toml"));
  REQUIRE(shows_after(screen, "\n", "declared zero because"));
}

TEST_CASE("a model goes to the unit by keys alone: what it lacks is shown, declared zero, and the map is sent") {
  const StateFolder folder;
  PacedUnit unit(folder, "115200");
  const MillModel mill(folder);
  const std::string map = folder / "x.csv";
  {
    ModelScreen screen = mill.screen(unit.link());
    build_map(screen, map);
    CHECK(contains(picture(screen), "EYX  "));
    CHECK_FALSE(std::filesystem::exists(map));
    REQUIRE(shows_after(screen, "\n", "map written to"));
    CHECK(contains(ecs::read_file(map).value(), "not measured, no effect in the model"));
    CHECK(std::filesystem::exists(folder / "x-parameters.toml"));
    REQUIRE(shows_after(screen, "t", "Send the map to"));
    REQUIRE(shows_after(screen, "y", "and verified"));
    CHECK(contains(after(screen, "c"), "Switch the unit to compensation?"));
    (void)letter(screen, 'n');
  }
  CHECK(ran_text({"map", "verify", map, "--params", folder / "x-parameters.toml", "--link", unit.link()})
            .starts_with("0 "));
}

TEST_CASE("a map that exists is overwritten only after a question") {
  const StateFolder folder;
  const MillModel mill(folder);
  const std::string map = folder.with("x.csv", "mine");
  ModelScreen screen = mill.screen(kNoUnit);
  build_map(screen, map);
  REQUIRE(contains(after(screen, "\n"), "Overwrite "));
  (void)letter(screen, 'n');
  CHECK(ecs::read_file(map).value() == "mine");
  build_map(screen, map);
  REQUIRE(shows_after(screen, "\ny", "map written to"));
}

TEST_CASE("the laser screen opens a map with the parameters beside it, ready to be sent") {
  const StateFolder folder;
  const MillModel mill(folder);
  const std::string map = folder / "x.csv";
  {
    ModelScreen screen = mill.screen(kNoUnit);
    build_map(screen, map);
    REQUIRE(shows_after(screen, "\n", "map written to"));
  }
  LaserScreenDriver driver;
  driver.controller().open_map(map);
  REQUIRE(driver.settled());
  CHECK(driver.controller().work().map.complete());
  CHECK_FALSE(driver.controller().would_overwrite());
  CHECK(driver.controller().unsaved().empty());  // it is a file already, also with parameters of another machine
  CHECK(contains(driver.after("6"), "complete"));
  driver.controller().change("machine", [](LaserChoices& c) { c.recipe.machine = "another"; });
  CHECK_FALSE(driver.controller().unsaved().empty());
  REQUIRE(driver.settles_after("uu"));
  CHECK_FALSE(driver.controller().work().map.made);
}

TEST_CASE("what no effect explains is added as a formula by one key, and taken back by another") {
  const StateFolder folder;
  std::string csv = "axis,x_mm,sense,reading,approach,run,load_kg\n";
  constexpr int kLoads_kg[]{200, 0, 400, 100, 300};
  for (int run = 1; run <= 5; ++run)
    for (const int approach : {1, -1})
      for (int i = 0; i < 21; ++i) {
        const double x_mm = 50.0 * i, noise_um = 0.3 * std::sin(7919.0 * (i + 21.3 * run + 3.7 * approach));
        const double loaded = (kLoads_kg[run - 1] - 200) / 100.0;
        csv += fmt::format("X,{},EX,{},{},{},{}\n", x_mm, 1.5 * approach * loaded * (x_mm - 500.0) / 500.0 + noise_um,
                           approach, run, kLoads_kg[run - 1]);
      }
  const ModelArguments files{folder.with("model.toml", kScaleOfX), {folder.with("data.csv", csv)}, "", {}};
  ModelScreen screen(must(ModelController::open(files)));
  REQUIRE(shows_after(screen, "d", "Press f to add it as a formula"));
  CHECK(reads(picture(screen), "direction odd, position odd, growth load_kg"));
  REQUIRE(shows_after(screen, "f", "added user:formula 1"));
  (void)letter(screen, 's');
  CHECK(contains(ecs::read_file(files.model).value(), "approach * ((load_kg - 200) / 200)"));
  REQUIRE(shows_after(screen, "u", "undone: user:formula 1"));
}

TEST_CASE("any effect is removed, put back and done again, and one is added by its name") {
  const StateFolder folder;
  const MillModel mill(folder);
  ModelScreen screen = mill.screen(kNoUnit);
  const auto wait = [&] {
    while (screen.advance()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  };
  type(screen, "nbacklash:X\n");
  wait();
  CHECK(reads(picture(screen), "added backlash:X"));
  type(screen, "4x");
  wait();
  check_reads(picture(screen), {"removed scale:X:EX", "without scale:X:EX"});
  (void)letter(screen, 'u');
  wait();
  CHECK(reads(picture(screen), "undone: removed scale:X:EX"));
  (void)letter(screen, 'y');
  wait();
  CHECK(reads(picture(screen), "redone: removed scale:X:EX"));
  (void)letter(screen, 's');
  const std::string kept = ecs::read_file(mill.files.model).value();
  CHECK(contains(kept, "backlash"));
  CHECK_FALSE(contains(kept, "id = \"scale\""));
}

TEST_CASE("a model that needs nothing keeps its fitted values") {
  const StateFolder folder;
  const MillModel mill(folder);
  ModelScreen screen = mill.screen(kNoUnit);
  (void)letter(screen, 's');
  CHECK(contains(ecs::read_file(mill.files.model).value(), "fitted"));
}

TEST_CASE("the residual is shown over runs on a key, and its scale stays when the error falls") {
  const StateFolder folder;
  const MillModel mill(folder);
  ModelScreen screen = mill.screen(kNoUnit);
  CHECK(contains(picture(screen), "means: measured (symbols)"));
  CHECK(contains(after(screen, "r"), "run 1: measured (symbols)"));
  CHECK(contains(after(screen, "v"), "residual against run"));
}

TEST_CASE("what these data cannot tell apart stays open in the model file until it is decided") {
  const StateFolder folder;
  MillModel mill(folder);
  mill.files.model =
      folder.with("tied.toml", "[[effect]]\n# or servo_lag:X:EX\nid = \"backlash\"\naxis = \"X\"\nsense = \"EX\"\n" +
                                   std::string(kScaleOfX));
  ModelScreen screen = mill.screen(kNoUnit);
  CHECK(contains(after(screen, "4"), "backlash:X:EX (or servo_lag:X:EX)"));
  (void)letter(screen, 's');
  CHECK(contains(ecs::read_file(mill.files.model).value(), "# or servo_lag:X:EX"));
  CHECK(contains(after(screen, "\n"), "Decide for backlash:X:EX?"));
  type(screen, "ys");
  CHECK_FALSE(contains(ecs::read_file(mill.files.model).value(), "servo_lag"));
}

TEST_CASE("without a machine file a map asks nothing before it is refused") {
  const StateFolder folder;
  MillModel mill(folder);
  mill.files.machine.clear();
  ModelScreen screen = mill.screen(kNoUnit);
  CHECK(reads(after(screen, "m"), "open the model with its machine file: the map needs the travels"));
  CHECK_FALSE(screen.typing());
  CHECK_FALSE(contains(picture(screen), "Save the model first?"));
}

TEST_CASE("compensation is not asked about before a map was sent") {
  const StateFolder folder;
  const MillModel mill(folder);
  ModelScreen screen = mill.screen(kNoUnit);
  CHECK_FALSE(contains(after(screen, "c"), "Switch the unit to compensation?"));
  CHECK(reads(picture(screen), "no map to send yet: press m to build it"));
}

TEST_CASE("what was measured again is told by its shapes on the page of what compensation leaves") {
  const StateFolder folder;
  const MillModel mill(folder);
  auto controller = must(ModelController::open(mill.files, nullptr));
  std::string readings = measured_csv(kPositioning, [](double) { return -0.5; });
  for (std::size_t at = 0; (at = readings.find(",0\n", at)) != std::string::npos;) readings.replace(at, 2, ",1");
  const std::string again = folder.with("again.csv", readings);
  controller->start_after({again});
  while (controller->busy()) (void)controller->advance();
  std::string page;
  for (const auto& line : controller->after()) page += line + " ";
  // -0.5, and of measured_csv the mean of runs 1 to 3, half of 2 um in reverse and about 0.25 of its pattern
  CHECK_MESSAGE(
      reads(page,
            "contributes 2.8 um to this rms: the zero of the laser or the datum has changed. A difference of -2 um "
            "between forward and reverse of X positions contributes 1 um to this rms: lost motion; it was there "
            "before, and the unit does not "
            "compensate it."),
      page);
}

}  // namespace
}  // namespace ecs::app
