// Menus: what is found first, and how an entry too long for its row is shown.
#include <doctest/doctest.h>

#include "app/ui/menu_screen.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::app;

namespace {

std::vector<MenuChoice> choices() {
  const auto nothing = [] { return std::unique_ptr<Screen>(); };
  std::vector<MenuChoice> all{{"LOG", "messages about the link, the unit and its relay", nothing},
                              {"OUTPUT COMPENSATION VALUE", "a value on one axis's D/A converter", nothing},
                              {"RELAY TEST", "closes it", nothing}};
  all[1].synonyms = "relay voltage";
  return all;
}

std::string seen(const Screen& menu) {
  Canvas canvas(20, 80);
  menu.draw(canvas, canvas.whole());
  return canvas.plain_text();
}

}  // namespace

TEST_CASE("what is sought is found in names first, then in words of the trade, then in descriptions") {
  const auto all = choices();
  CHECK(rank_of(all[2], "relay") < rank_of(all[1], "relay"));
  CHECK(rank_of(all[1], "relay") < rank_of(all[0], "relay"));
  CHECK(rank_of(all[1], "output voltage").has_value());
  CHECK_FALSE(rank_of(all[2], "voltage").has_value());
  CHECK(rank_of(all[0], "log") < rank_of({"LOGBOOK", "what was done", all[0].opens}, "log"));
  MenuScreen menu("ECS", "", choices());
  for (const char32_t letter : std::u32string(U"/relay")) (void)menu.on_key({Key::Name::letter, letter});
  const std::string text = seen(menu);
  CHECK(contains(text, "> RELAY TEST"));
  CHECK(text.find("RELAY TEST") < text.find("OUTPUT"));
  CHECK(text.find("OUTPUT") < text.find("LOG"));
}

TEST_CASE("a finder seeks from its first key, gives way to what is chosen, and goes back at once") {
  MenuScreen finder("find", "", choices(), MenuScreen::Kind::finder);
  CHECK(finder.typing());
  CHECK(finder.on_key({Key::Name::enter}).kind == Step::Kind::instead);
  CHECK(finder.on_key({Key::Name::escape}).kind == Step::Kind::back);
}

TEST_CASE("a description too long for its row ends after a whole clause, and is whole below for the entry chosen") {
  const std::string help = "what the unit must know of its machine, with every range and default, and much more of it";
  const MenuScreen menu("ECS", "", {{"PARAMETERS", help, [] { return std::unique_ptr<Screen>(); }}});
  const std::string text = seen(menu);
  CHECK_FALSE(contains(text, "…"));
  CHECK(contains(text, "PARAMETERS  what the unit must know of its machine\n"));
}

TEST_CASE("a screen with the word in its name comes before the verb of that name") {
  const auto nothing = [] { return std::unique_ptr<Screen>(); };
  std::vector<MenuChoice> all{{"monitor", "positions, sample by sample", nothing},
                              {"ON LINE MONITOR", "what the unit sees", nothing},
                              {"monitoring", "of something else", nothing}};
  all[0].is_verb = all[2].is_verb = true;
  CHECK(rank_of(all[1], "monitor") == rank_of(all[0], "monitor"));
  CHECK(rank_of(all[1], "monitor") < rank_of(all[2], "monitor"));
  CHECK(rank_of(all[1], "monit") > rank_of(all[0], "monit"));
}
