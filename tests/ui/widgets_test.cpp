// Messages, questions, texts and menus as they are drawn; what is copied.
#include "app/ui/widgets.hpp"

#include "app/ui/menu_screen.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/screen_program.hpp"
#include "commissioning/session/message.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"

namespace ecs::app {
namespace {

const std::string kLong =
    "rtu unit 3, registers 0x0100-0x0107: expected an answer within 500 ms, got none in three tries; look at the plug, "
    "then at the number of the unit, then at the speed";

std::string drawn_message(const Message& message, int rows, int columns, Glyphs glyphs = Glyphs::unicode) {
  Canvas canvas(rows, columns, glyphs);
  draw_message(canvas, canvas.whole(), message);
  return canvas.plain_text();
}

/// Says one thing on one row.
class Teller : public Screen {
 public:
  explicit Teller(const std::string& text) { message_.say(text, Tone::bad); }
  [[nodiscard]] std::string title() const override { return "teller"; }
  void draw(Canvas& canvas, const Area& area) const override { draw_message(canvas, area.top(1), message_); }
  [[nodiscard]] Step on_key(const Key& /*key*/) override { return stay(); }
  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    return {{"Enter", "open"}, {"up/down", "choose"}, {"+ - 0", "zoom"}, {"Tab 1-5", "page"}};
  }
  [[nodiscard]] std::string help() const override { return "It tells one thing."; }

 private:
  Message message_;
};

Canvas picture(const Screen& screen, int rows = 24, int columns = 80) {
  return picture_of(screen, screen.title(), {}, Canvas(rows, columns), false);
}

TEST_CASE("a message asks for the rows it needs, and no more than it may have") {
  Message message;
  CHECK(rows_of_message(message, 78, 4) == 1);
  message.say(kLong);
  CHECK(rows_of_message(message, 78, 4) == 3);
  CHECK(rows_of_message(message, 78, 2) == 2);
  CHECK(contains(drawn_message(message, 3, 78), "speed\n"));
}

TEST_CASE("a message without enough rows ends at a complete word with a mark and the key that shows all of it") {
  Message message;
  message.say(kLong);
  CHECK(drawn_message(message, 1, 60) == "rtu unit 3, registers 0x0100-0x0107: expected an answer … F2\n");
  CHECK(drawn_message(message, 1, 60, Glyphs::ascii) ==
        "rtu unit 3, registers 0x0100-0x0107: expected an      ... F2\n");
}

TEST_CASE("F2 shows the whole text in a box that scrolls, and any other key closes it") {
  const Teller teller(kLong);
  const Canvas cut = picture(teller, 24, 40);
  REQUIRE(cut.whole_texts() == std::vector<std::string>{kLong});
  CHECK(contains(cut.plain_text(), "F2 more"));
  Overlay over;
  over.show_whole(cut.whole_texts());
  Canvas small(8, 40);
  over.draw(small);
  CHECK(contains(small.plain_text(), "rtu unit 3"));
  CHECK_FALSE(contains(small.plain_text(), "speed"));
  over.on_key({Key::Name::end});
  over.draw(small);
  CHECK(contains(small.plain_text(), "speed"));
  CHECK(over.shown());
  over.on_key({Key::Name::escape});
  CHECK_FALSE(over.shown());
}

TEST_CASE("what F2 showed is in the log, once") {
  const std::string finding = kLong + " (a finding that no message line showed)";
  Overlay over;
  over.show_whole({finding});
  over.show_whole({finding});
  const auto entries = logged();
  CHECK(std::count_if(entries.begin(), entries.end(), [&](const LogEntry& e) { return e.text == finding; }) == 1);
}

TEST_CASE("F2 is named only where something is cut") {
  const Teller teller("done");
  CHECK(picture(teller).whole_texts().empty());
  CHECK_FALSE(contains(picture(teller).plain_text(), "F2"));
}

TEST_CASE("a paragraph without a row is still shown by F2") {
  Canvas canvas(2, 40);
  canvas.paragraph(canvas.whole(), 2, "nowhere to stand");
  CHECK(canvas.whole_texts() == std::vector<std::string>{"nowhere to stand"});
}

TEST_CASE("the answers of a question are never cut, and a question too long for its box goes to F2") {
  Canvas canvas(8, 36);
  draw_question(canvas, canvas.whole(),
                {"Take up the work?", kLong, "take up what was found", "leave it for the next time"});
  check_holds(canvas.plain_text(), {"y take up what was found", "n leave it for the next time"});
  CHECK(canvas.whole_texts() == std::vector<std::string>{kLong});
}

TEST_CASE("help that is longer than the screen is scrolled, its keys are never cut") {
  const Teller teller("done");
  Overlay help;
  help.show_help(teller);
  Canvas canvas(24, 80);
  help.draw(canvas);
  check_holds(canvas.plain_text(), {"any key continues", "up/down        choose"});
  Canvas small(8, 30);
  help.draw(small);
  CHECK(contains(small.plain_text(), "It tells one thing."));
  for (int k = 0; k < 40; ++k) help.on_key({Key::Name::down});
  help.draw(small);
  CHECK(contains(small.plain_text(), "leave"));
  CHECK(help.shown());
}

TEST_CASE("help groups many keys by their purpose") {
  class Busy : public Teller {
   public:
    Busy() : Teller("done") {}
    [[nodiscard]] std::vector<KeyHelp> keys() const override {
      return {{"a", "add"},        {"d", "diagnose"}, {"s", "save"}, {"Tab", "page"},
              {"up/down", "line"}, {"+ - 0", "zoom"}, {"u", "undo"}, {"t", "send"}};
    }
  };
  Overlay help;
  help.show_help(Busy());
  Canvas canvas(24, 80);
  help.draw(canvas);
  check_holds(canvas.plain_text(), {"actions        d: diagnose; + - 0: zoom", "editing        a: add; u: undo",
                                    "files, unit    s: save; t: send", "moving         Tab: page; up/down: line"});
}

TEST_CASE("a fault is shown completely in the header, however long the name of the link") {
  const Teller teller("done");
  const StatusLine standing{"rtu:/dev/serial/by-id/usb-FTDI_FT232R_USB_UART_A50285BI-if00-port0:115200",
                            "compensation, FAULT position jump", true};
  const std::string text = picture_of(teller, "MENU > teller", standing, Canvas(24, 80), false).plain_text();
  check_holds(text, {"compensation, FAULT position jump\n", "teller"});
}

TEST_CASE("a click on the key line is the key shown there, of several the one that was hit") {
  const Area line{23, 0, 1, 80};
  const KeyLine keys{Teller("done").keys(), {{"?", "help"}}};
  // Enter open  up/down choose  + - 0 zoom  Tab 1-5 page
  CHECK(clicked_key(line, keys, 0) == Key{Key::Name::enter});
  CHECK(clicked_key(line, keys, 7) == Key{Key::Name::enter});
  CHECK(clicked_key(line, keys, 12) == Key{Key::Name::up});
  CHECK(clicked_key(line, keys, 15) == Key{Key::Name::down});
  CHECK(clicked_key(line, keys, 30) == Key{Key::Name::letter, U'-'});
  CHECK(clicked_key(line, keys, 34) == Key{Key::Name::letter, U'+'});
  CHECK(clicked_key(line, keys, 45) == std::nullopt);  // 1-5 is no key
  CHECK(clicked_key(line, keys, 60) == std::nullopt);
  CHECK(clicked_key(line, keys, 73) == Key{Key::Name::letter, U'?'});
}

TEST_CASE("a key that finds by / can be clicked as well") {
  const KeyLine keys{{{"/ m", "find, next"}}, {}};
  CHECK(clicked_key({0, 0, 1, 40}, keys, 0) == Key{Key::Name::letter, U'/'});
  CHECK(clicked_key({0, 0, 1, 40}, keys, 2) == Key{Key::Name::letter, U'm'});
}

TEST_CASE("help explains the words of the trade that the screen shows, and only those") {
  Overlay help;
  help.show_help(Teller("done"), "unit MILL-1, integration, Y parked at -1400");
  Canvas canvas(40, 80);
  help.draw(canvas);
  const std::string text = canvas.plain_text();
  check_holds(text, {"integration mode", "parked"});
  CHECK_FALSE(contains(text, "squareness"));
}

std::vector<MenuChoice> choices() {
  const auto nothing = [] { return std::unique_ptr<Screen>(); };
  std::vector<MenuChoice> all{{"LOG", "messages about the link, the unit and its relay", nothing},
                              {"OUTPUT COMPENSATION VALUE", "output value of one axis", nothing},
                              {"RELAY TEST", "closes it", nothing}};
  all[1].synonyms = "relay voltage";
  return all;
}

std::string seen(const Screen& menu) {
  Canvas canvas(20, 80);
  menu.draw(canvas, canvas.whole());
  return canvas.plain_text();
}

TEST_CASE("the page of the glossary has the words that help explains, with the same meanings") {
  std::string page = content_of("docs/glossary.md");
  for (std::size_t at; (at = page.find("µ")) != std::string::npos;) page.replace(at, std::string("µ").size(), "u");
  std::string table = "| word | meaning |\n|---|---|\n";
  for (const auto& [word, meaning] : explained_words()) table += "| " + word + " | " + meaning + " |\n";
  check_holds(page, {table});
}

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

TEST_CASE("a description too long for its row ends after a whole clause, with a mark") {
  const std::string help = "data of the machine that the unit needs, with every range and default, and much more of it";
  const MenuScreen menu("ECS", "", {{"PARAMETERS", help, [] { return std::unique_ptr<Screen>(); }}});
  const std::string text = seen(menu);
  CHECK(contains(text, "PARAMETERS  data of the machine that the unit needs …\n"));
}

TEST_CASE("a screen with the word in its name comes before the verb of that name") {
  const auto nothing = [] { return std::unique_ptr<Screen>(); };
  std::vector<MenuChoice> all{{"monitor", "positions, sample by sample", nothing},
                              {"ON LINE MONITOR", "live positions and signals", nothing},
                              {"monitoring", "of something else", nothing}};
  all[0].is_verb = all[2].is_verb = true;
  CHECK(rank_of(all[1], "monitor") == rank_of(all[0], "monitor"));
  CHECK(rank_of(all[1], "monitor") < rank_of(all[2], "monitor"));
  CHECK(rank_of(all[1], "monit") > rank_of(all[0], "monit"));
}

class TwoKeys : public Screen {
 public:
  [[nodiscard]] std::string title() const override { return "TWO KEYS"; }
  void draw(Canvas&, const Area&) const override {}
  [[nodiscard]] Step on_key(const Key&) override { return stay(); }
  [[nodiscard]] std::vector<KeyHelp> keys() const override { return {{"d", "diagnose"}, {"+ -", "zoom"}}; }
  [[nodiscard]] std::string help() const override { return {}; }
};

Canvas three_rows() {
  Canvas canvas(5, 20);
  for (int row = 0; row < 3; ++row) canvas.text({1, 0, 3, 20}, row, 2, "row " + std::to_string(row));
  return canvas;
}

TEST_CASE("the selected row is copied without its margins, else the whole picture between header and key line") {
  Canvas canvas = three_rows();
  CHECK(text_to_copy(canvas, {1, 0, 3, 20}) == "row 0\nrow 1\nrow 2");
  canvas.paint({2, 0, 1, 20}, Tone::selected);
  CHECK(text_to_copy(canvas, {1, 0, 3, 20}) == "row 1");
  CHECK(copied_words("row 1") == "copied: row 1");
  CHECK(copied_words("a\nb") == "copied: 2 rows of this screen");
}

TEST_CASE("a key that does nothing says whether it ever does") {
  const TwoKeys screen;
  CHECK(idle_key_words(screen, U'd') ==
        "d (diagnose): no change. It is already shown, at its limit, or still being computed");
  CHECK(idle_key_words(screen, U'-') ==
        "- (zoom): no change. It is already shown, at its limit, or still being computed");
  CHECK(idle_key_words(screen, U'k') == "k has no function here; ? lists the keys");
  CHECK(idle_key_words(screen, U' ') == "Space has no function here; ? lists the keys");
}

}  // namespace
}  // namespace ecs::app
