// TOOLS on the emulated unit.
#include "commissioning/unit/tools.hpp"

#include "app/screens/unit/screens.hpp"
#include "app/screens/utility/screens.hpp"
#include "commissioning/unit/transfer.hpp"
#include "tests/screens/support/unit_screen.hpp"
#include "tests/screens/support/utility_bench.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

/// A unit whose parameters allow tools of up to 300 mm along Z.
struct ToolBench : UnitBench {
  ToolBench() {
    wait_for_unit();
    auto file = must(params::read_parameters("samples/mill/parameters.toml"));
    file.parameters.tool_range_mm = {50.0, 50.0, 300.0};
    REQUIRE(with_link([&](UnitLink& link) { return send_parameters(link.client(), file.parameters, {}); }));
    screen = tools_screen(controller);
  }
  [[nodiscard]] ToolsInUnit held() const {
    return must(with_link([](UnitLink& link) { return tools_in_unit(link.client()); }));
  }
  std::unique_ptr<Screen> screen;
};

TEST_CASE("tools are set, selected, given another offset and removed, and what was typed wrong stays open") {
  const ToolBench bench;
  Screen& screen = *bench.screen;
  REQUIRE(shows(screen, "The table is empty. Press n for a tool"));
  CHECK(contains(after(screen, "n7,1,2\n"), "expected NUMBER,X,Y,Z"));
  replace_line(screen, "0,1,2,3");
  CHECK(contains(picture(screen), "expected a whole number from 1 to 9999, found 0"));
  clear_line(screen);
  REQUIRE(shows_after(screen, "7,0,0,-80.5\n", "Tool 7 has the offset 0,0,-80.5 mm."));
  REQUIRE(shows(screen, "1 of 64 tools."));
  REQUIRE(shows_after(screen, "n3 0 0 -120\n", "2 of 64 tools."));
  CHECK(contains(picture(screen), ">      3       0.0000       0.0000    -120.0000"));
  REQUIRE(shows_after(screen, "n9,0,0,-500\n", "beyond compensation.tool_range_mm"));

  REQUIRE(shows_after(screen, "\n", "Tool 3 is selected (compensation is off)."));
  CHECK(shows(screen, "-120.0000  selected"));
  REQUIRE(shows_after(screen, "ry", "this tool is selected"));
  CHECK(contains(after(screen, "e"), "Offset of tool 3, X,Y,Z in mm: 0,0,-120"));
  replace_line(screen, "0,0,-121");
  REQUIRE(shows(screen, "-121.0000  selected"));
  REQUIRE(shows_after(screen, "0", "No tool is selected from the tool table (compensation"));
  CHECK(contains(after(screen, "r"), "Remove tool 3 from the table?"));
  REQUIRE(shows_after(screen, "y", "1 of 64 tools."));
  const ToolsInUnit held = bench.held();
  CHECK(only(held.tools).number == 7);
  check_fits(screen);
}

TEST_CASE(
    "a file replaces the whole table, a long one is scrolled, and one that the unit would refuse changes nothing") {
  const ToolBench bench;
  Screen& screen = *bench.screen;
  std::string text = "number,x_mm,y_mm,z_mm\n";
  for (int number = 101; number <= 164; ++number)
    text += std::to_string(number) + ",0,0,-" + std::to_string(number) + "\n";
  const std::string whole = bench.folder.with("tools.csv", text);
  const std::string far_off = bench.folder.with("far.csv", "number,x_mm,y_mm,z_mm\n5,0,0,-301\n");
  REQUIRE(shows(screen, "The table is empty."));
  (void)letter(screen, 'f');
  type(screen, whole + "\n");
  REQUIRE(shows(screen, "Replace the table with 64 tools?"));
  REQUIRE(shows_after(screen, "y", "64 of 64 tools."));
  CHECK_FALSE(contains(picture(screen), "   164 "));
  (void)press(screen, Key::Name::end);
  CHECK(contains(picture(screen), ">    164       0.0000       0.0000    -164.0000"));
  REQUIRE(shows_after(screen, "n5,0,0,-10\n", "the table is full: 64 tools"));
  (void)letter(screen, 'f');
  type(screen, far_off + "\n");
  REQUIRE(shows(screen, "Replace the table with 1 tool?"));
  REQUIRE(shows_after(screen, "y", "is beyond the tool range of the unit"));
  CHECK(bench.held().tools.size() == 64);
}

TEST_CASE("a command for a tool is on the monitor at once, and what is older than a second says so") {
  const ToolBench bench;
  REQUIRE(bench.with_link([](UnitLink& link) { return link.client().set_tool({4, {0.0, 0.0, -40.0}}); }));
  const auto monitor = monitor_screen(bench.controller);
  REQUIRE(shows(*monitor, "relay"));
  REQUIRE(bench.with_link([](UnitLink& link) { return link.client().select_tool(4); }));
  const auto begun = std::chrono::steady_clock::now();
  REQUIRE(shows(*monitor, "tool 4"));
  CHECK(std::chrono::steady_clock::now() - begun < std::chrono::seconds(2));
}

}  // namespace
}  // namespace ecs::app
