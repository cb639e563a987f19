// The screens that ask and answer: what holds for every row of their table, then what is special to some.
#include "app/screens/forms/rows.hpp"

#include "app/verbs/registry.hpp"
#include "base/text.hpp"
#include "tests/support/answered_form.hpp"
#include "tests/support/emulator.hpp"
#include "tests/support/folder.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

constexpr const char* kParameters = "samples/machining_centre/parameters.toml";

VerbEntry verb_of(const std::string& name) {
  for (const MenuEntry& menu : verb_catalogue(all_verbs()))
    for (const VerbEntry& verb : menu.verbs)
      if (verb.name() == name) return verb;
  FAIL("no verb ", name);
  return {};
}

TEST_CASE("every row names a verb and fields that there are, draws in every size, asks for what it needs and lets go") {
  const StateFolder state;
  for (const FormEntry& entry : form_entries()) {
    CAPTURE(entry.row.verb);
    const VerbEntry verb = verb_of(entry.row.verb);
    const auto has = [&verb](const std::string& name) {
      return std::any_of(verb.options.begin(), verb.options.end(), [&](const auto& one) { return one.name == name; });
    };
    for (const std::string& field : entry.row.fields) CHECK_MESSAGE(has(field), field);
    for (const auto& [field, value] : entry.row.preset) CHECK_MESSAGE(has(field), field);
    for (const auto& [field, values] : entry.row.offers) CHECK_MESSAGE(has(field), field);
    CHECK((entry.row.confirmed.empty() || has(entry.row.confirmed)));
    const auto screen = form_screen(entry.row, verb, no_link());
    CHECK(screen->title() == (entry.row.title.empty() ? entry.row.verb : entry.row.title));
    const std::string seen = picture(*screen, 24, 200);
    if (!entry.row.asks.empty()) CHECK(reads(seen, entry.row.asks));
    if (!entry.row.fields.empty()) CHECK(contains(seen, "> " + entry.row.fields.front()));
    if (!entry.row.confirmed.empty()) CHECK_FALSE(contains(seen, entry.row.confirmed + " "));
    for (const auto& [rows, columns] : {std::pair{1, 1}, {3, 10}, {12, 40}, {60, 200}}) {
      const std::string text = picture(*screen, rows, columns, Glyphs::ascii);
      CHECK(std::count(text.begin(), text.end(), '\n') == rows);
    }
    CHECK_FALSE(screen->help().empty());
    const bool needs = std::any_of(verb.options.begin(), verb.options.end(), [&](const VerbOption& one) {
      return one.required && one.value.empty() && !entry.row.preset.contains(one.name);
    });
    if (needs) {
      CHECK(contains(after(*screen, "\n"), "is required"));
    }
    CHECK(press(*screen, Key::Name::escape).kind == Step::Kind::back);
  }
}

TEST_CASE("the row of a field that others come after is the first one, whatever order the verb declares") {
  FormRow row{.verb = "volume"};
  row.fields = {"--rotary", "MAP"};
  const auto screen = form_screen(row, verb_of("volume"), no_link());
  const std::string seen = picture(*screen);
  CHECK(seen.find("--rotary") < seen.find("MAP *"));
  CHECK(seen.find("MAP *") < seen.find("--params *"));
}

TEST_CASE("VOLUME shows the sizes, then the body diagonals, also of a machine with rotary axes") {
  const Folder folder;
  const std::string map = folder.with(
      "map.csv",
      "# configuration: XYTZ\naxis,sense,approach,p_mm,value_um\nX,EX,0,0,0\nX,EX,0,600,-12\nX,EX,0,1200,-24\n");
  const auto diagonals = [](Screen& screen) {
    (void)press(screen, Key::Name::page_down);
    CHECK(shows_after(screen, "2", "before, body diagonals"));
    CHECK(contains(after(screen, "3"), "after, body diagonals"));
    CHECK(contains(after(screen, "1"), "95 %"));
    CHECK(press(screen, Key::Name::escape).kind == Step::Kind::stay);
    CHECK(contains(picture(screen), "How large is the error"));
  };
  const auto screen = answered("VOLUME", {{"MAP", map}, {"--params", kParameters}});
  CHECK(contains(picture(*screen, 60, 100), "24.0"));
  diagonals(*screen);
  const auto rotary = answered("VOLUME", {{"MAP", "samples/five_axes/map.csv"},
                                          {"--params", kParameters},
                                          {"--machine", "samples/five_axes/machine.toml"},
                                          {"--rotary", "samples/five_axes/rotary.csv"}});
  check_holds(picture(*rotary, 60, 100), {"rotary axes A", "settings"});
  diagonals(*rotary);
  const auto absent = answered("VOLUME", {{"MAP", "none.csv"}, {"--params", kParameters}});
  CHECK(contains(picture(*absent), "none.csv"));
}

}  // namespace
}  // namespace ecs::app
