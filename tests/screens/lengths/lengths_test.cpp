// The screen LENGTHS: files as fields, components, what is not determined, a plan, what is saved and noted.
#include <doctest/doctest.h>

#include "app/screens/lengths/screen.hpp"
#include "base/text.hpp"
#include "commissioning/session/commands.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/screen_driver.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

constexpr const char* kMachine = "samples/machining_centre/machine.toml";
constexpr const char* kParameters = "samples/machining_centre/parameters.toml";
constexpr const char* kMeasured = "samples/standards/lengths.csv";

/// Without the readings of a set-up.
std::string lengths_without(const std::string& set_up) {
  std::string out;
  for (const std::string& line : owned_lines_of(content_of(kMeasured)))
    if (!line.starts_with(set_up + ",") && !line.starts_with("# set_up: " + set_up)) out += line + "\n";
  return out;
}

void begin(Screen& screen, const std::string& lengths, const std::string& params) {
  enter(screen, lengths);
  enter(screen, kMachine);
  enter(screen, params);
  enter(screen, "");
  enter(screen, "");
}

TEST_CASE("the screen shows all components with their uncertainties and saves map and parameters as the verb does") {
  const Folder folder;
  commissioning::forget_commands();
  const auto screen = lengths_screen();
  CHECK(contains(picture(*screen), "Which lengths, of which machine?"));
  begin(*screen, kMeasured, kParameters);
  REQUIRE(shows(*screen, "U (95 %)"));
  CHECK(contains(picture(*screen), "EXX"));
  CHECK(contains(picture(*screen), "ECY"));
  (void)press(*screen, Key::Name::end);
  CHECK(contains(picture(*screen), "error vector over the volume"));
  CHECK(!contains(picture(*screen), "map not written"));
  (void)letter(*screen, '2');
  CHECK(contains(picture(*screen), "Everything that acts at the tools is determined"));
  (void)letter(*screen, '3');
  CHECK(contains(picture(*screen), "No plan yet"));
  (void)letter(*screen, '1');
  (void)letter(*screen, 's');
  const std::string map = folder / "found.csv", params = folder / "found.toml";
  replace_line(*screen, map);
  replace_line(*screen, params);
  CHECK(reads(picture(*screen), "Map written to"));
  CHECK(contains(content_of(map), "# uncertainty: EXX"));
  CHECK(contains(content_of(params), "[compensation.squareness]"));
  REQUIRE(commissioning::noted_commands().size() == 1);
  CHECK(contains(commissioning::command_text(commissioning::noted_commands().front()), "ecs lengths fit "));
  CHECK(contains(commissioning::command_text(commissioning::noted_commands().front()), " --params-out "));
  (void)letter(*screen, 's');
  replace_line(*screen, map);
  replace_line(*screen, params);
  CHECK(contains(picture(*screen), "Overwrite"));
  (void)letter(*screen, 'n');
  CHECK(commissioning::noted_commands().size() == 1);
  CHECK(press(*screen, Key::Name::escape).kind == Step::Kind::stay);
  CHECK(contains(picture(*screen), "Which lengths, of which machine?"));
  CHECK(press(*screen, Key::Name::escape).kind == Step::Kind::back);
}

TEST_CASE("a plan is made, shown and saved, and stands in COMMANDS") {
  const Folder folder;
  commissioning::forget_commands();
  const auto screen = lengths_screen();
  enter(*screen, "");
  enter(*screen, kMachine);
  enter(*screen, "");
  enter(*screen, "1200,600,600");
  enter(*screen, "40");
  CHECK(reads(picture(*screen), "searching the plan with the fewest minutes"));
  REQUIRE(shows(*screen, "single set-ups for"));
  CHECK(contains(picture(*screen), "minutes"));
  (void)letter(*screen, 's');
  const std::string plan = folder / "plan.csv";
  replace_line(*screen, plan);
  CHECK(reads(picture(*screen), "Plan written to"));
  REQUIRE(commissioning::noted_commands().size() == 1);
  CHECK(contains(commissioning::command_text(commissioning::noted_commands().front()),
                 " --volume-um 40 --knots 1200,600,600 -o "));
  CHECK(contains(content_of(plan), "# minutes:"));

  const auto second = lengths_screen(plan, kMachine);
  REQUIRE(shows(*second, "nothing measured yet"));
  (void)letter(*second, 's');
  CHECK(reads(picture(*second), "The file is a plan"));
  (void)letter(*second, 'p');
  replace_line(*second, "no number");
  CHECK(reads(picture(*second), "expected the wanted uncertainty"));
}

TEST_CASE("what lengths do not determine is listed with the lengths that would, and no map is saved") {
  const Folder folder;
  const auto screen = lengths_screen(folder.with("two.csv", lengths_without("S5")), kMachine, kParameters);
  REQUIRE(shows(*screen, "4 not determined, and what would determine them"));
  CHECK(reads(picture(*screen),
              "A0Z is not determined: no length is inclined in the plane YZ: add diagonals of that face"));
  (void)letter(*screen, 's');
  CHECK(reads(picture(*screen), "No map while something is not determined"));
  (void)letter(*screen, '1');
  CHECK(contains(picture(*screen), "EXX"));
}

TEST_CASE("what cannot be fitted is said on the screen of the files") {
  const auto screen = lengths_screen();
  begin(*screen, "none.csv", "");
  REQUIRE(shows(*screen, "none.csv:"));
  const auto empty = lengths_screen();
  for (int k = 0; k < 5; ++k) (void)press(*empty, Key::Name::enter);
  CHECK(contains(picture(*empty), "The machine file is needed."));
}

}  // namespace
}  // namespace ecs::app
