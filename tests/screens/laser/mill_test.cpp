// Whole machines on the screen: what a map lacks, the very map of the verb for every sample, prepared files, work taken
// up again, every size.

#include "tests/screens/support/laser_screen.hpp"

namespace ecs::app {
namespace {

TEST_CASE("the map says which components are missing; declaring one zero takes a reason, and undo takes it back") {
  const StateFolder folder;
  measure_mill(folder);
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path / "before"))
    if (entry.path().filename() != "EZZ.csv") files.push_back(entry.path().string());
  LaserScreenDriver driver;
  driver.take_files(files, "samples/mill/parameters.toml");
  check_holds(driver.after("6"), {"2 still missing", "EBY  MISSING"});
  CHECK(driver.controller().mark(LaserStep::map) == LaserMark::doubtful);
  check_holds(driver.after("8\n"), {"the map is incomplete", "EBY, EZZ (step 6)"});
  driver.controller().change("more files", [&](LaserChoices& c) {
    c.files.push_back({(folder.path / "before/EZZ.csv").string(), {}});
  });
  REQUIRE(driver.settled());
  driver.type("6");
  while (!contains(driver.seen(), "> EBY")) driver.press(Key::Name::down);
  CHECK(reads(driver.after("\n"), "EBY, Y axis roll error: Not measured: add its file (step 1), or press z"));
  REQUIRE(driver.settles_after("zground guideways\n"));
  check_holds(driver.seen(), {"declared zero: ground guideways", "complete"});
  CHECK(driver.controller().mark(LaserStep::map) == LaserMark::done);
  REQUIRE(driver.settles_after("u"));
  CHECK(contains(driver.seen(), "1 still missing"));
}

/// What an engineer types for the mill: folder, parameters, smoothing, zero, header.
void commission_on_keys(LaserScreenDriver& driver, const StateFolder& folder) {
  REQUIRE(driver.shows_after("a" + folder.path.string() + "/before\n", "[all 16 measurement files here]"));
  driver.press(Key::Name::down);
  REQUIRE(driver.settles_after("\npsamples/mill/parameters.toml\n"));
  const auto smooth = [&](Component component, const std::string& width) {
    driver.type("4");
    driver.press(Key::Name::home);
    for (const LaserCurve& curve : driver.controller().work().curves) {
      if (curve.component == component) break;
      driver.press(Key::Name::down);
    }
    REQUIRE(driver.settles_after("\n" + width + "\n"));
    REQUIRE(laser::settings_of(driver.controller().choices().recipe, component).smoothing_mm > 0.0);
  };
  for (const Component c : {Component::EYX, Component::EZX, Component::EAX}) smooth(c, "100");
  smooth(Component::EBX, "300");
  smooth(Component::ECX, "200");
  driver.type("6");
  while (!contains(driver.seen(), "> EBY")) driver.press(Key::Name::down);
  driver.type(
      "zroll of the head slide cannot be measured by laser or level; negligible on ground guideways (thesis "
      "6.3.2.3)\n");
  driver.type("7\nHuddersfield Polytechnic\n");
  driver.press(Key::Name::down, 3);
  REQUIRE(driver.settles_after("\nS. R. Postlethwaite\n"));
}

TEST_CASE("the mill commissioned on the screen gives the same map that the verb builds by the recipe") {
  const StateFolder folder;
  measure_mill(folder);
  std::filesystem::copy_file("samples/mill/recipe.toml", folder.path / "recipe.toml");
  const std::string by_verb = (folder.path / "verb.csv").string();
  REQUIRE(ran({"map", "build", (folder.path / "recipe.toml").string(), "--params", "samples/mill/parameters.toml", "-o",
               by_verb, "--params-out", (folder.path / "verb.toml").string()})
              .code == 0);
  LaserScreenDriver driver;
  commission_on_keys(driver, folder);
  CHECK(driver.controller().mark(LaserStep::header) == LaserMark::done);
  driver.type("8f");
  for (int k = 0; k < 10; ++k) driver.press(Key::Name::backspace);
  REQUIRE(driver.settles_after((folder.path / "out/screen.csv").string() + "\n"));
  CHECK_FALSE(driver.controller().unsaved().empty());
  REQUIRE(driver.shows_after("s", "saved: "));
  CHECK(driver.controller().unsaved().empty());
  CHECK(content_of(folder / "out/screen.csv") == content_of(folder / "verb.csv"));
  CHECK(content_of(folder / "out/screen-parameters.toml") == content_of(folder / "verb.toml"));
}

TEST_CASE("a map without a reading or with answers names a prepared file, and its recipe makes it again") {
  const StateFolder folder;
  measure_mill(folder);
  LaserScreenDriver driver;
  commission_on_keys(driver, folder);
  driver.controller().change("left out", [&](LaserChoices& c) {
    c.lines[kExx].runs[2] = "cold";
    c.lines[kExx].readings[5] = "beam broken";
    c.lines["EZ along Z at X 0, Y -1400"].runs[1] = "";
    c.map_file = (folder.path / "out/map.csv").string();
  });
  REQUIRE(driver.settled());
  REQUIRE(driver.controller().work().map.complete());
  REQUIRE(driver.shows_after("s", "saved: "));
  const std::string map = content_of(folder / "out/map.csv");
  CHECK(contains(map, "source: EXX EXX_line1.csv"));
  CHECK(contains(content_of(folder / "out/map-files/EXX_line1.csv"), "left_out: run 2 (cold)"));
  CHECK(contains(content_of(folder / "out/map-recipe.toml"), "exclude_runs = [1]"));
  REQUIRE(ran({"map", "build", (folder.path / "out/map-recipe.toml").string(), "--params",
               "samples/mill/parameters.toml", "-o", (folder.path / "again.csv").string()})
              .code == 0);
  CHECK(content_of(folder / "again.csv") == map);
}

TEST_CASE("after a crash the work is offered again and restored completely; d drops it") {
  const StateFolder folder;
  measure_mill(folder);
  std::string choices;
  {
    LaserScreenDriver driver;
    commission_on_keys(driver, folder);
    LaserChoices made = driver.controller().choices();
    for (std::string* path : {&made.params_file, &made.map_file})  // a draft may be taken up from another folder
      *path = std::filesystem::absolute(*path).lexically_normal().string();
    choices = choices_text(made);
  }
  {
    LaserScreenDriver again;
    check_holds(again.seen(), {"Unsaved work of 20", "found: moving column"});
    REQUIRE(again.settles_after("\n"));
    CHECK(choices_text(again.controller().choices()) == choices);
    CHECK(again.controller().work().map.complete());
    CHECK_FALSE(again.controller().saved());
    again.controller().change("folder", [&](LaserChoices& c) { c.map_file = (folder.path / "kept.csv").string(); });
    REQUIRE(again.settled());
    REQUIRE(again.shows_after("s", "saved: "));
  }
  {
    LaserScreenDriver again;
    CHECK(reads(again.seen(), "(saved in kept.csv)"));
    CHECK_FALSE(contains(again.seen(), "Unsaved work"));
    REQUIRE(again.settles_after("\n"));
    CHECK(again.controller().saved());
    CHECK(again.controller().unsaved().empty());
    CHECK_FALSE(again.controller().would_overwrite());
  }
  {
    LaserScreenDriver again;
    again.type("b");  // new work is started beside it
    CHECK_FALSE(again.controller().offered());
  }
  {
    LaserScreenDriver again;
    again.type("dn");
    CHECK(again.controller().offered());
    again.type("dy");
    CHECK(again.controller().work().lines.empty());
  }
  CHECK(!contains(LaserScreenDriver().seen(), "Unsaved work of 20"));
}

TEST_CASE("every step is drawn completely at every size, in Unicode and in ASCII") {
  const StateFolder folder;
  measure_mill(folder);
  LaserScreenDriver empty, full;
  commission_on_keys(full, folder);
  for (LaserScreenDriver* driver : {&empty, &full})
    for (char step = '1'; step <= '9'; ++step)
      for (const auto& [rows, columns] : {std::pair{24, 80}, {40, 120}, {12, 40}, {5, 12}, {1, 1}})
        for (const Glyphs glyphs : {Glyphs::unicode, Glyphs::ascii}) {
          driver->type(std::string(1, step));
          const std::string seen = driver->seen(rows, columns, glyphs);
          if (glyphs == Glyphs::ascii)
            for (const char c : seen) REQUIRE(static_cast<unsigned char>(c) < 0x80);
          if (rows == 24) CHECK(contains(seen, "[" + std::string(1, step)));
        }
}

namespace fs = std::filesystem;

/// `key = value` of a block of the plan, without quotation marks; empty: it has none.
std::string value_in(const std::string& block, const std::string& key) {
  const std::size_t at = block.find("\n" + key + " = ");
  if (at == std::string::npos) return {};
  const std::size_t begin = at + key.size() + 4;
  std::string value = block.substr(begin, block.find('\n', begin) - begin);
  std::erase(value, '"');
  return value;
}

double parked_in(const std::string& block, char axis) {
  const std::string place = value_in(block, "parked_mm");
  const std::size_t at = place.find(std::string(1, axis) + " = ");
  return at == std::string::npos ? 0.0 : std::stod(place.substr(at + 4));
}

/// Every line that the plan of a sample asks for, its error a formula of its own. @return the files
std::vector<std::string> measured_by_plan(const Folder& folder, const std::string& sample) {
  const std::string plan = content_of("samples/" + sample + "/plan.toml");
  std::vector<std::string> files;
  double k = 1.0;
  for (std::size_t at = plan.find("[[measure]]"); at != std::string::npos;) {
    const std::size_t next = plan.find("[[measure]]", at + 1);
    const std::string block = plan.substr(at, next - at);
    at = next;
    const char axis = value_in(block, "axis")[0];
    Measured line{axis,
                  value_in(block, "sense"),
                  std::stod(value_in(block, "from_mm")),
                  std::stod(value_in(block, "to_mm")),
                  std::stod(value_in(block, "step_mm")),
                  {parked_in(block, 'x'), parked_in(block, 'y'), parked_in(block, 'z')},
                  value_in(block, "instrument")};
    k += 0.3;
    std::string csv =
        measured_csv(line, [&](double p) { return 10.0 * std::sin(p / (300.0 + 40.0 * k)) + 0.002 * k * p; });
    csv.erase(0, csv.find("# instrument"));  // the mill's name and serial number
    files.push_back(folder.with(value_in(block, "name") + ".csv", csv));
  }
  return files;
}

TEST_CASE("the wizard and the verb make the same maps of all samples, bit for bit, also with readings left out") {
  for (const char* sample : {"lathe", "machining_centre", "mill"}) {
    CAPTURE(sample);
    const StateFolder folder;
    const std::string params = fmt::format("samples/{}/parameters.toml", sample);
    LaserScreenDriver driver;
    driver.take_files(measured_by_plan(folder, sample), params);
    driver.controller().change("the rest", [&](LaserChoices& c) {
      for (const LaserComponent& one : driver.controller().work().map.components)
        if (one.state == ComponentState::missing) laser::declare_zero(c.recipe, one.component, "not measured");
      const auto& lines = driver.controller().work().lines;
      c.lines[lines.front().key].readings[1] = "beam broken";
      c.lines[lines.back().key].runs[3] = "cold";
      c.recipe.customer = "Works";
      c.map_file = (folder.path / "screen.csv").string();
    });
    REQUIRE(driver.settled());
    REQUIRE(driver.controller().work().map.made);
    driver.controller().save();
    REQUIRE(driver.shows("saved: "));
    const std::string verb = (folder.path / "verb.csv").string(), unit = (folder.path / "verb.toml").string();
    REQUIRE(ran({"map", "build", folder / "screen-recipe.toml", "--params", params, "-o", verb, "--params-out", unit})
                .code == 0);
    CHECK(content_of(verb) == content_of(folder / "screen.csv"));
    CHECK(content_of(unit) == content_of(folder / "screen-parameters.toml"));
    CHECK(driver.controller().work().map.csv == content_of(verb));
  }
}

}  // namespace
}  // namespace ecs::app
