// COMMANDS: what was done, copied, written as a script.
#include "commissioning/session/commands.hpp"

#include "app/screens/unit/screens.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/screen_driver.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

struct TwoActions {
  TwoActions() {
    forget_commands();
    note_command({"params", "send", "mill.toml", "--link", "tcp:host:502"});
    note_command({"laser", "prepare", "EXX.csv", "--line", "EX along X at Y -1400, Z 0", "--leave-out-run",
                  "3=somebody walked through the beam", "-o", "out/map-files/EXX_line1.csv"});
  }
  ~TwoActions() { forget_commands(); }
  TwoActions(const TwoActions&) = delete;
  TwoActions& operator=(const TwoActions&) = delete;
};

TEST_CASE("the newest action is marked and stands whole below, which is what F4 copies") {
  const TwoActions two;
  const auto screen = commands_screen();
  const std::string seen = picture(*screen);
  CHECK(contains(seen, "2 actions, newest last"));
  CHECK(contains(seen, "ecs params send mill.toml --link tcp:host:502"));
  CHECK(reads(seen, "--leave-out-run '3=somebody walked through the beam' -o out/map-files/EXX_line1.csv"));
  CHECK(screen->copied() ==
        "ecs laser prepare EXX.csv --line 'EX along X at Y -1400, Z 0' --leave-out-run '3=somebody walked through the "
        "beam' -o out/map-files/EXX_line1.csv");
  (void)press(*screen, Key::Name::up);
  CHECK(screen->copied() == "ecs params send mill.toml --link tcp:host:502");
}

TEST_CASE("a script is written and may be run; a file that is there is asked for") {
  const TwoActions two;
  const Folder folder;
  const std::string path = folder / "done.sh";
  const auto screen = commands_screen();
  (void)letter(*screen, 'w');
  CHECK(screen->typing());
  replace_line(*screen, path);
  CHECK(contains(picture(*screen), "2 actions written to"));
  CHECK(contains(content_of(path), "#!/bin/sh"));
  CHECK((std::filesystem::status(path).permissions() & std::filesystem::perms::owner_exec) !=
        std::filesystem::perms::none);
  folder.with("done.sh", "mine");
  (void)letter(*screen, 'w');
  replace_line(*screen, path);
  CHECK(contains(picture(*screen), "Replace "));
  (void)letter(*screen, 'n');
  CHECK(content_of(path) == "mine");
  (void)letter(*screen, 'w');
  replace_line(*screen, path);
  (void)letter(*screen, 'y');
  CHECK(contains(content_of(path), "#!/bin/sh"));
}

TEST_CASE("a new script begins after a question; what is done meanwhile is shown") {
  const TwoActions two;
  const auto screen = commands_screen();
  (void)letter(*screen, 'x');
  CHECK(contains(picture(*screen), "Begin anew?"));
  (void)letter(*screen, 'y');
  CHECK(contains(picture(*screen), "Nothing was done yet"));
  CHECK(screen->copied().empty());
  note_command({"utility", "ramtest"});
  CHECK(screen->advance());
  CHECK(screen->copied() == "ecs utility ramtest");
}

}  // namespace
}  // namespace ecs::app
