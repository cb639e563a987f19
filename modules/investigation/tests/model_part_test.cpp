// An investigation on the page Next of the MODEL screen: where it works, what refuses it, stopped and gone on with.
#include "tests/screens/support/mill_model.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

TEST_CASE("an empty place investigates on the emulated machine of the link, over the link that is open") {
  const StateFolder folder;
  const MillModel mill(folder);
  ModelScreen screen = mill.screen("emulator");
  (void)letter(screen, '5');
  REQUIRE(until(screen, [&] {
    (void)letter(screen, 'i');
    const bool offered = reads(picture(screen), "empty: the emulated machine");
    if (!offered) (void)press(screen, Key::Name::escape);
    return offered;
  }));
  REQUIRE(contains(after(screen, "\n"), "minutes available for the runs"));
  REQUIRE(shows_after(screen, "\n", "first look: "));
  (void)press(screen, Key::Name::escape);
  REQUIRE(shows(screen, "stopped. The measurements are kept"));
  CHECK_FALSE(contains(after(screen, "i"), ".workshop"));
}

TEST_CASE("an empty place is refused where the link has no emulated machine, or that of another model") {
  const StateFolder folder;
  const MillModel mill(folder);
  SUBCASE("a real unit") {
    ModelScreen screen = mill.screen(kNoUnit);
    CHECK(contains(after(screen, "5i"), "workshop socket, or folder for readings:"));
    CHECK(reads(after(screen, "\n"), "this link has no emulated machine: give the socket of a workshop, or a folder"));
  }
  SUBCASE("another machine") {
    ModelScreen screen = mill.screen("emulator:samples/lathe/machine.toml");
    (void)letter(screen, '5');
    REQUIRE(until(screen, [&] {
      type(screen, "i\n");
      return reads(picture(screen), "set the link to emulator:samples/mill/machine.toml in LINK (F3) first");
    }));
    CHECK(reads(picture(screen), "the machine file of the model is of moving column mill"));
  }
}

TEST_CASE("without a machine file an investigation asks nothing before it is refused") {
  const StateFolder folder;
  MillModel mill(folder);
  mill.files.machine.clear();
  ModelScreen screen = mill.screen(kNoUnit);
  CHECK(reads(after(screen, "5i"), "open the model with its machine file: an investigation needs"));
  CHECK_FALSE(screen.typing());
}

}  // namespace
}  // namespace ecs::app
