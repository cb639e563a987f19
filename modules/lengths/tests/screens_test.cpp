// LENGTHS and PLAN LENGTHS, as one sees them.
#include <filesystem>

#include "app/ui/menu_screen.hpp"
#include "base/text.hpp"
#include "commissioning/session/commands.hpp"
#include "tests/support/answered_form.hpp"
#include "tests/support/folder.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

constexpr const char* kMachine = "samples/machining_centre/machine.toml";
constexpr const char* kParameters = "samples/machining_centre/parameters.toml";
constexpr const char* kMeasured = "samples/standards/lengths.csv";

/// Lengths without the readings of a set-up.
std::string lengths_without(const std::string& set_up) {
  std::string out;
  for (const std::string& line : owned_lines_of(content_of(kMeasured)))
    if (!line.starts_with(set_up + ",") && !line.starts_with("# set_up: " + set_up)) out += line + "\n";
  return out;
}

TEST_CASE("LENGTHS is found before the verbs of its name") {
  const auto found = finder(no_link());
  type(*found, "lengths");
  CHECK(contains(picture(*found), "> LENGTHS"));
}

TEST_CASE(
    "LENGTHS shows all components with their uncertainties; s saves what the verb writes, asking before it "
    "overwrites") {
  const Folder folder;
  commissioning::forget_commands();
  const auto screen = answered("LENGTHS", {{"LENGTHS", kMeasured}, {"--machine", kMachine}, {"--params", kParameters}});
  CHECK(contains(picture(*screen), "done"));
  (void)press(*screen, Key::Name::page_down);
  check_holds(picture(*screen), {"U (95 %)", "EXX", "ECY"});
  const std::string map = folder / "found.csv", params = folder / "found.toml";
  const auto save = [&] {
    CHECK(contains(after(*screen, "s"), "--output:"));
    replace_line(*screen, map);
    CHECK(contains(picture(*screen), "--params-out:"));
    replace_line(*screen, params);
  };
  save();
  REQUIRE(until(*screen, [&] { return std::filesystem::exists(params); }));
  REQUIRE(shows(*screen, "done"));
  CHECK(contains(content_of(map), "# uncertainty: EXX"));
  CHECK(contains(content_of(params), "[compensation.squareness]"));
  const auto noted = commissioning::noted_commands();
  REQUIRE(noted.size() == 2);
  CHECK(contains(commissioning::command_text(noted.back()), "ecs lengths fit "));
  CHECK(contains(commissioning::command_text(noted.back()), " --params-out "));
  (void)press(*screen, Key::Name::page_down);
  save();
  CHECK(contains(picture(*screen), "Overwrite"));
  (void)letter(*screen, 'n');
  CHECK(commissioning::noted_commands().size() == 2);
  save();
  type(*screen, "yy");
  REQUIRE(until(*screen, [] { return commissioning::noted_commands().size() == 3; }));
  CHECK(contains(commissioning::command_text(commissioning::noted_commands().back()), " --force"));
}

TEST_CASE("what lengths do not determine is said with the lengths that would; a plan says what it asks for") {
  const Folder folder;
  const auto two =
      answered("LENGTHS", {{"LENGTHS", folder.with("two.csv", lengths_without("S5"))}, {"--machine", kMachine}});
  (void)press(*two, Key::Name::page_down);
  CHECK(reads(picture(*two, 100, 160),
              "A0Z is not determined: no length is inclined in the plane YZ: add diagonals of that face"));
  const std::string plan = folder / "plan.csv";
  const auto made =
      answered("PLAN LENGTHS",
               {{"--machine", kMachine}, {"--volume-um", "40"}, {"--knots", "1200,600,600"}, {"--output", plan}});
  (void)press(*made, Key::Name::page_down);
  CHECK(reads(picture(*made, 60, 120), "for comparison: "));
  CHECK(contains(content_of(plan), "# minutes:"));
  const auto shown = answered("LENGTHS", {{"LENGTHS", plan}, {"--machine", kMachine}});
  check_reads(picture(*shown), {"not measured yet", "set-up"});
}

}  // namespace
}  // namespace ecs::app
