// TOML tables read with every problem and its place.
#include "base/toml_reader.hpp"

#include "tests/support/test.hpp"

using namespace ecs;

TEST_CASE("numbers, words and tables are read; an absent key is no problem") {
  TomlReader reader("a.toml");
  const auto table = must(reader.parsed("n = 2\nw = \"text\"\n[t]\nx = 1.5\n[[row]]\n[[row]]\n"));
  CHECK(reader.number(table, "n") == 2.0);
  CHECK(reader.word(table, "w") == "text");
  REQUIRE(reader.child(table, "t") != nullptr);
  CHECK(reader.number(*reader.child(table, "t"), "x") == 1.5);
  CHECK(reader.children(table, "row").size() == 2);
  CHECK_FALSE(reader.number(table, "absent"));
  CHECK_FALSE(reader.word(table, "absent"));
  CHECK(reader.child(table, "absent") == nullptr);
  CHECK(reader.children(table, "absent").empty());
  CHECK(reader.clean());
}

TEST_CASE("every value of another type is reported with its line and column") {
  TomlReader reader("a.toml");
  const auto table = must(reader.parsed("n = \"2\"\nw = 3\nt = 4\nrow = 5\ninfinite = inf\n"));
  CHECK_FALSE(reader.number(table, "n"));
  CHECK_FALSE(reader.word(table, "w"));
  CHECK(reader.child(table, "t") == nullptr);
  CHECK(reader.children(table, "row").empty());
  CHECK_FALSE(reader.number(table, "infinite"));
  REQUIRE_FALSE(reader.clean());
  CHECK(to_text(reader.all()) ==
        "a.toml:1:5: n: expected a finite number\na.toml:2:5: w: expected a text in quotes\n"
        "a.toml:3:5: t: expected a table\na.toml:4:7: row: expected [[row]] tables\n"
        "a.toml:5:12: infinite: expected a finite number");
}

TEST_CASE("an unknown key is reported with the nearest one, or with all of them") {
  TomlReader reader("a.toml");
  const auto table = must(reader.parsed("travel = 1\ntravle = 2\nz = 3\n"));
  reader.only(table, {"travel", "datum"}, "axis");
  const std::string text = to_text(reader.all());
  check_holds(text, {"axis: no such key \"travle\"; did you mean \"travel\"?",
                     "axis: expected one of travel, datum, got \"z\""});
}

TEST_CASE("text that is not TOML is refused at the place of the error") {
  const auto table = must_fail(TomlReader("a.toml").parsed("a = 1\nb = = 2\n"));
  CHECK(table.kind == ProblemKind::bad_input);
  CHECK(table.line == 2);
}

TEST_CASE("problems of other files and of whole lines are collected in order") {
  TomlReader reader("a.toml");
  reader.complain(7, "first");
  reader.add({ProblemKind::bad_input, "second", "b.csv", 3, 1, {}});
  CHECK(to_text(reader.all()) == "a.toml:7: first\nb.csv:3:1: second");
}

TEST_CASE("nesting that would exhaust the stack is refused with its line, ordinary files and texts with dots are not") {
  const auto line_of = [](const std::string& text) { return parse_toml(text, "a.toml").error().line; };
  std::string deep_key = "a";
  for (int k = 0; k < 100'000; ++k) deep_key += ".a";
  CHECK(line_of("x = 1\n" + deep_key + " = 1\n") == 2);
  CHECK(line_of("[" + deep_key + "]\n") == 1);
  CHECK(line_of("x = { " + deep_key + " = 1 }\n") == 1);
  CHECK(line_of("x = " + std::string(100'000, '[') + "\n") == 1);
  const std::string dots(100, '.');
  CHECK(parse_toml("a.b.c = 1\nx = \"" + dots + "\\\"" + dots + "\" # " + dots + "\n", "a.toml").has_value());
  CHECK(parse_toml("x = \"\"\"\n" + dots + "\n\"\"\"\ny = [[1.5, 2.5], [3.5]]\nz = '" + dots + "'\n", "a.toml")
            .has_value());
}

TEST_CASE("of very many unknown keys the first are named and the rest counted") {
  std::string text;
  for (int k = 0; k < 3000; ++k) text += "key" + std::to_string(k) + " = 1\n";
  TomlReader reader("a.toml");
  const auto table = must(reader.parsed(text));
  reader.only(table, {"known"}, "plan");
  const Problem all = reader.all();
  CHECK(all.also.size() == 20);
  CHECK(all.also.back().message == "plan: 2980 more unknown keys");
}
