// TOML tables read with every problem and its place.
#include "base/toml_reader.hpp"

#include <doctest/doctest.h>

using namespace ecs;

TEST_CASE("numbers, words and tables are read; an absent key is no problem") {
  TomlReader reader("a.toml");
  const auto table = reader.parsed("n = 2\nw = \"text\"\n[t]\nx = 1.5\n[[row]]\n[[row]]\n");
  REQUIRE(table);
  CHECK(reader.number(*table, "n") == 2.0);
  CHECK(reader.word(*table, "w") == "text");
  REQUIRE(reader.child(*table, "t") != nullptr);
  CHECK(reader.number(*reader.child(*table, "t"), "x") == 1.5);
  CHECK(reader.children(*table, "row").size() == 2);
  CHECK_FALSE(reader.number(*table, "absent"));
  CHECK_FALSE(reader.word(*table, "absent"));
  CHECK(reader.child(*table, "absent") == nullptr);
  CHECK(reader.children(*table, "absent").empty());
  CHECK(reader.clean());
}

TEST_CASE("every value of another type is reported with its line and column") {
  TomlReader reader("a.toml");
  const auto table = reader.parsed("n = \"2\"\nw = 3\nt = 4\nrow = 5\ninfinite = inf\n");
  REQUIRE(table);
  CHECK_FALSE(reader.number(*table, "n"));
  CHECK_FALSE(reader.word(*table, "w"));
  CHECK(reader.child(*table, "t") == nullptr);
  CHECK(reader.children(*table, "row").empty());
  CHECK_FALSE(reader.number(*table, "infinite"));
  REQUIRE_FALSE(reader.clean());
  CHECK(to_text(reader.all()) ==
        "a.toml:1:5: n: expected a finite number\na.toml:2:5: w: expected a text in quotes\n"
        "a.toml:3:5: t: expected a table\na.toml:4:7: row: expected [[row]] tables\n"
        "a.toml:5:12: infinite: expected a finite number");
}

TEST_CASE("an unknown key is reported with the nearest one, or with all of them") {
  TomlReader reader("a.toml");
  const auto table = reader.parsed("travel = 1\ntravle = 2\nz = 3\n");
  REQUIRE(table);
  reader.only(*table, {"travel", "datum"}, "axis");
  const std::string text = to_text(reader.all());
  CHECK(text.find("axis: no such key \"travle\"; did you mean \"travel\"?") != std::string::npos);
  CHECK(text.find("axis: expected one of travel, datum, got \"z\"") != std::string::npos);
}

TEST_CASE("text that is not TOML is refused at the place of the error") {
  const auto table = TomlReader("a.toml").parsed("a = 1\nb = = 2\n");
  REQUIRE_FALSE(table);
  CHECK(table.error().kind == ProblemKind::bad_input);
  CHECK(table.error().line == 2);
}

TEST_CASE("problems of other files and of whole lines are collected in order") {
  TomlReader reader("a.toml");
  reader.complain(7, "first");
  reader.add({ProblemKind::bad_input, "second", "b.csv", 3, 1, {}});
  CHECK(to_text(reader.all()) == "a.toml:7: first\nb.csv:3:1: second");
}
