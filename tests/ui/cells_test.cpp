// Cells, widgets and curves: what stands where, without a terminal.
#include "app/ui/cells.hpp"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include "app/ui/widgets.hpp"

using namespace ecs;
using namespace ecs::app;

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
