// Echoes and stored links, without a unit.
#include "commissioning/link/doctor.hpp"

#include "commissioning/link/choice.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

TEST_CASE("a link that returns what is sent is recognised as an echo") {
  const PortAnswer silence{{1, 2, 3}, {}};
  const PortAnswer echo{{1, 2, 3}, {1, 2, 3, 9}};
  const PortAnswer other{{1, 2, 3}, {1, 2, 4}};
  CHECK_FALSE(silence.is_echo());
  CHECK(echo.is_echo());
  CHECK_FALSE(other.is_echo());
}

TEST_CASE("a stored link is used where none is given, and --link goes before it") {
  const Folder folder;
  ::setenv("XDG_CONFIG_HOME", (folder / "config").c_str(), 1);
  CHECK(chosen_link("").value().origin == "default");
  REQUIRE(store_link("tcp:mill:502"));
  CHECK(to_text(must(chosen_link(""))) == "tcp:mill:502:1");
  CHECK(chosen_link("tcp:lathe:502")->origin == "--link");
  static_cast<void>(folder.with("config/ecs/config.toml", "link = 7\n"));
  CHECK(ran({"monitor", "--count", "1"}).code == 3);
  ::unsetenv("XDG_CONFIG_HOME");
}

}  // namespace
}  // namespace ecs::app
