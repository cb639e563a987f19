// What holds for every screen of ECS UTILITY.
#include "app/screens/utility/screens.hpp"

#include "commissioning/unit/utility_work.hpp"
#include "tests/screens/support/unit_screen.hpp"
#include "tests/screens/support/utility_bench.hpp"

using namespace ecs;
using namespace ecs::app;
using namespace ecs::app::screen_test;

TEST_CASE("the menu has the entries of figure 5.4 in their order, then the tools") {
  const StateFolder folder;
  std::vector<std::string> names;
  for (const MenuChoice& choice : utility_choices(std::make_shared<UnitConnection>("rtu:/dev/no-such-port:9600")))
    names.push_back(choice.name);
  CHECK(names == std::vector<std::string>{"SET AXIS POSITION", "OUTPUT COMPENSATION VALUE", "RECORD DATUM SEQUENCE",
                                          "DISPLAY DATUM SEQUENCE", "TEST DATUM ROUTINE", "DISPLAY ECS STATUS",
                                          "RUN USER SOFTWARE", "TOOLS"});
}

TEST_CASE("without a line every screen draws in every size, ASCII stays ASCII, says what is missing and lets go") {
  const StateFolder folder;
  const auto controller = std::make_shared<UnitConnection>("rtu:/dev/no-such-port:9600");
  for (const MenuChoice& choice : utility_choices(controller)) {
    const auto screen = choice.opens();
    if (choice.name != "DISPLAY DATUM SEQUENCE" && choice.name != "RUN USER SOFTWARE")
      REQUIRE_MESSAGE(shows(*screen, "NO ANSWER"), choice.name);
    check_fits(*screen);
    CHECK(press(*screen, Key::Name::escape).kind == Step::Kind::back);
  }
}

TEST_CASE("a click chooses the axis on that row") {
  const StateFolder folder;
  const auto controller = std::make_shared<UnitConnection>("rtu:/dev/no-such-port:9600");
  for (const MenuChoice& choice : utility_choices(controller)) {
    if (choice.name.find("AXIS") != 4 && choice.name != "OUTPUT COMPENSATION VALUE" &&
        choice.name != "RECORD DATUM SEQUENCE")
      continue;
    const auto screen = choice.opens();
    const std::string before = picture(*screen);
    std::vector<std::string> rows;
    std::istringstream text(before);
    for (std::string row; std::getline(text, row);) rows.push_back(row);
    const auto z =
        std::find_if(rows.begin(), rows.end(), [](const std::string& row) { return row.starts_with("   Z"); });
    REQUIRE_MESSAGE(z != rows.end(), choice.name);
    (void)screen->on_key({Key::Name::mouse, 0, 0, static_cast<int>(z - rows.begin()), 3});
    CHECK_MESSAGE(contains(picture(*screen), "\n > Z "), choice.name);
  }
}

TEST_CASE("while the unit waits for its references nothing that needs integration mode is asked about") {
  const UnitBench bench;
  bench.wait_for_unit();
  give_map(*bench.controller, bench.folder);
  REQUIRE(bench.with_link([](UnitLink& link) { return begin_compensation(link.client()); }));
  const auto waits = [&] {
    const auto newest = bench.controller->newest();
    return newest && newest->mode == UnitMode::datuming;
  };
  for (int k = 0; k < 1000 && !waits(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  REQUIRE(waits());
  const std::string refusal = "This is possible in integration mode only; the unit is referencing.";
  for (const MenuChoice& choice : utility_choices(bench.controller)) {
    if (choice.name == "DISPLAY DATUM SEQUENCE" || choice.name == "TOOLS") continue;  // in every mode
    CAPTURE(choice.name);
    const auto screen = choice.opens();
    if (choice.name == "RUN USER SOFTWARE") {
      CHECK(shows_after(*screen, "\n", refusal));
      continue;
    }
    REQUIRE(shows(*screen, "referencing"));
    if (choice.name == "DISPLAY ECS STATUS")
      (void)letter(*screen, 'c');
    else
      CHECK(reads(after(*screen, "\n"), refusal));
    CHECK(screen->keys().front().keys != "y");  // of a question
    CHECK_FALSE(screen->typing());
    if (choice.name == "OUTPUT COMPENSATION VALUE") {
      CHECK(reads(after(*screen, "r"), refusal));
    }
  }
}
