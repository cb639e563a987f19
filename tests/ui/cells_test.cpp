// Cells, widgets and curves: what stands where, without a terminal; letters of other scripts keep their columns.
#include "app/ui/cells.hpp"

#include <rapidcheck.h>

#include "app/ui/widgets.hpp"
#include "tests/support/test.hpp"

namespace ecs::app {
namespace {

TEST_CASE("a Chinese letter takes two columns, an accent over a letter none") {
  CHECK(width_of("测量.csv") == 8);
  CHECK(width_of("a\u0301") == 1);
  CHECK(width_of("\u200Bx") == 1);
  CHECK(width_of("\U0001F600") == 2);
}

TEST_CASE("an accent is joined with its letter where there is one sign for both, else left away") {
  CHECK(letters_of("e\u0301") == std::vector<Letter>{{U'é', 1}});
  CHECK(letters_of("x\u0301y") == std::vector<Letter>{{U'x', 1}, {U'y', 1}});
}

TEST_CASE("control characters in a file's name never reach the terminal") {
  for (const Letter& letter : letters_of("a\x1b[2J\x7f\u009bz")) CHECK(letter.glyph >= 0x20);
  CHECK(letters_of("\u009b") == std::vector<Letter>{{U'?', 1}});
}

TEST_CASE("a row with a Chinese file name ends in the column where it ends with a Latin one") {
  Canvas canvas(2, 20);
  const Area row = canvas.whole().left(18);
  for (const auto& [r, name] : {std::pair{0, "测量.csv"}, {1, "messung.csv"}}) {
    canvas.text(row, r, 0, in_columns(name, 12) + "|");
    CHECK(canvas.at(r, 12).glyph == U'|');
  }
  CHECK(canvas.at(0, 0).glyph == U'测');
  CHECK(canvas.at(0, 1).glyph == kSecondHalf);
  CHECK(canvas.plain_text() == "测量.csv    |\nmessung.csv |\n");
}

TEST_CASE("a name with combining accents takes the columns that are seen of it") {
  Canvas canvas(1, 20);
  CHECK(canvas.text(canvas.whole(), 0, 0, "re\u0301glage.csv") == 11);
  CHECK(canvas.plain_text() == "réglage.csv\n");
}

TEST_CASE("no half of a letter stays: not at the edge, not where something else is drawn over it") {
  Canvas canvas(3, 5);
  canvas.text(canvas.whole(), 0, 0, "测量测量");
  CHECK(canvas.plain_text() == "测量…\n\n\n");
  canvas.text(canvas.whole(), 1, 0, "测量");
  canvas.put(1, 1, U'x');
  canvas.put(1, 2, U'y');
  CHECK(canvas.at(1, 0).glyph == U' ');
  CHECK(canvas.at(1, 3).glyph == U' ');
  canvas.put(2, 4, U'测');
  CHECK(canvas.at(2, 4).glyph == U' ');
}

TEST_CASE("a terminal of ASCII shows a question mark in every column of a letter it lacks") {
  Canvas canvas(1, 8, Glyphs::ascii);
  canvas.text(canvas.whole(), 0, 0, "测.csv");
  CHECK(canvas.plain_text() == "??.csv\n");
}

TEST_CASE("a terminal of ASCII shows the letter below an accent") {
  Canvas canvas(1, 20, Glyphs::ascii);
  canvas.text(canvas.whole(), 0, 0, "ré\u0301glage größe");
  CHECK(canvas.plain_text() == "reglage gro?e\n");
}

TEST_CASE("words of wide letters are wrapped by columns and broken between letters") {
  CHECK(wrapped("测量 测量", 4) == std::vector<std::string>{"测量", "测量"});
  CHECK(wrapped("测量测", 4) == std::vector<std::string>{"测量", "测"});
  CHECK(wrapped("测量", 1) == std::vector<std::string>{"测", "量"});
}

TEST_CASE("no line of wrapped text is wider than asked, whatever the letters") {
  CHECK(rc::check([](const std::string& text) {
    const int columns = *rc::gen::inRange(2, 30);
    for (const std::string& line : wrapped(text, columns)) RC_ASSERT(width_of(line) <= columns);
  }));
}

TEST_CASE("text filled up takes exactly its columns, whatever the letters") {
  CHECK(rc::check([](const std::string& text) {
    const int columns = *rc::gen::inRange(0, 30);
    RC_ASSERT(width_of(in_columns(text + "测e\u0301", columns)) == columns);
  }));
}

TEST_CASE("the cursor is after the wide letters that were typed, also in a narrow field") {
  TextLine line("测量");
  CHECK(line.cursor_column(20) == 4);
  CHECK(line.on_key({Key::Name::left}));
  CHECK(line.cursor_column(20) == 2);
  CHECK(line.on_key({Key::Name::end}));
  Canvas canvas(1, 4);
  line.draw(canvas, canvas.whole(), 0, 0, 4, true);
  CHECK(canvas.plain_text() == "… __\n");
  CHECK(line.cursor_column(4) == 2);
}

TEST_CASE("text is cut at the right edge and says so") {
  Canvas canvas(2, 8);
  canvas.text(canvas.whole(), 0, 0, "straightness");
  canvas.text(canvas.whole(), 1, 0, "12345678");
  CHECK(canvas.plain_text() == "straigh…\n12345678\n");
}

TEST_CASE("a terminal without UTF-8 gets the nearest sign of ASCII") {
  Canvas canvas(3, 10, Glyphs::ascii);
  canvas.frame(canvas.whole());
  canvas.text(canvas.whole().inside(), 0, 0, "3.1 µm →");
  CHECK(canvas.plain_text() == "+--------+\n|3.1 um >|\n+--------+\n");
}

TEST_CASE("nothing is ever written outside, whatever is drawn where") {
  CHECK(rc::check([](const std::string& text) {
    const Canvas blank(4, 9);
    Canvas canvas(4, 9);
    const Area area{*rc::gen::inRange(-3, 6), *rc::gen::inRange(-3, 12), *rc::gen::inRange(0, 8),
                    *rc::gen::inRange(0, 14)};
    canvas.frame(area, text);
    canvas.text(area, *rc::gen::inRange(-2, 9), *rc::gen::inRange(0, 9), text);
    (void)canvas.paragraph(area, 0, text);
    RC_ASSERT(canvas.rows() == 4);
    RC_ASSERT(canvas.at(-1, 0) == Cell{});
    RC_ASSERT(canvas.at(4, 0) == Cell{});
  }));
}

TEST_CASE("words are wrapped, long ones broken, line ends kept") {
  CHECK(wrapped("one two three", 7) == std::vector<std::string>{"one two", "three"});
  CHECK(wrapped("abcdefghij", 4) == std::vector<std::string>{"abcd", "efgh", "ij"});
  CHECK(wrapped("a\nb", 10) == std::vector<std::string>{"a", "b"});
  CHECK(wrapped("", 10) == std::vector<std::string>{""});
}

TEST_CASE("UTF-8 goes in and out unchanged, and broken bytes become question marks") {
  CHECK(utf8_of(U'µ') == "µ");
  CHECK(utf8_of(U'⣿') == "⣿");
  CHECK(code_points("\xC3(") == U"?(");
  CHECK(width_of("µm ±σ") == 5);
}

TEST_CASE("a list follows the cursor and shows that there is more") {
  std::vector<ListRow> rows;
  for (int k = 0; k < 20; ++k) rows.push_back({"row " + std::to_string(k)});
  ListPlace place;
  Canvas canvas(4, 12);
  REQUIRE(place.on_key({Key::Name::end}, 20));
  draw_list(canvas, canvas.whole(), rows, place);
  CHECK(canvas.plain_text() == "  row 16   ↑\n  row 17\n  row 18\n> row 19\n");
  REQUIRE(place.on_key({Key::Name::up}, 20));
  CHECK(place.selected == 18);
  CHECK_FALSE(place.on_key({Key::Name::letter, U'x'}, 20));
}

TEST_CASE("a line of text is typed, corrected and seen at its cursor") {
  TextLine line("12");
  for (const char32_t c : U".5") {
    if (c != 0) CHECK(line.on_key({Key::Name::letter, c}));
  }
  CHECK(line.text() == "12.5");
  CHECK(line.on_key({Key::Name::home}));
  CHECK(line.on_key({Key::Name::letter, U'-'}));
  CHECK(line.text() == "-12.5");
  CHECK(line.on_key({Key::Name::end}));
  CHECK(line.on_key({Key::Name::backspace}));
  CHECK(line.text() == "-12.");
  CHECK(line.cursor_column(4) == 3);  // the end is seen in a narrow field
  CHECK(line.on_key({Key::Name::control, U'u'}));
  CHECK(line.text().empty());
}

TEST_CASE("a path is completed as far as its folder decides it") {
  CHECK(completed_path("samples/mi").completed == "samples/mill/");
  const PathCompletion several = completed_path("samples/mill/p");
  CHECK(several.choices == std::vector<std::string>{"parameters.toml", "plan.toml"});
  CHECK(several.completed == "samples/mill/p");
  CHECK(completed_path("no/such/folder/x").completed == "no/such/folder/x");
}

}  // namespace
}  // namespace ecs::app
