// The table found in an unknown file is whole, what is suggested imports it, and nothing is dropped without a word.
#include <fmt/format.h>

#include "laser/import/columns.hpp"
#include "laser/import/import.hpp"
#include "tests/laser/support/import_options.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

std::string rows(int from, int to) {
  std::string text;
  for (int i = from; i < to; ++i) text += fmt::format("{} {} {}.5\n", i, 10 * i, i);
  return text;
}

/// 96 rows in three parts between comments, empty lines and a heading.
std::string parted() {
  return "# log of a gauge\n# nr pos err\n" + rows(0, 30) + "# run 2\n\n" + rows(30, 54) + "operator changed\n" +
         rows(54, 96);
}

MeasurementSet read_table(const std::string& text, const std::string& columns, int skip = 0, int most = 0) {
  ImportOptions options = by_columns(columns, skip);
  options.mapping->most_rows = most;
  return must(parse_any(text, "table.txt", options)).set;
}

Problem refused(const std::string& text, const ImportOptions& options = {}) {
  return must_fail(parse_any(text, "table.txt", options));
}

}  // namespace

TEST_CASE("a table goes on after comments, empty lines and other lines") {
  const auto shape = must(table_shape(parted()));
  CHECK(shape.rows == 96);
  CHECK(shape.first_row_line == 3);
  CHECK(shape.last_row_line == 101);
  CHECK(shape.lines_between == 1);
  CHECK(shape.headings == std::vector<std::string>{"nr", "pos", "err"});
}

TEST_CASE("lines of the head that hold a number are no rows of the table below") {
  const auto shape = must(table_shape("probe,7\nserial,12\n0.0,1.5\n10.0,2.5\n20.0,3.5\n"));
  CHECK(shape.rows == 3);
  CHECK(shape.first_row_line == 3);
}

TEST_CASE("what is suggested for a table imports every row of it") {
  const Problem why = refused(parted());
  CHECK(why.line == 3);
  CHECK(why.column == 1);
  check_holds(why.message, {"a table of 96 rows and 3 columns, separated by blanks, in lines 3 to 101",
                            "--columns \"x_mm=2[mm],reading=3[um],approach=motion\" --skip 2"});
  const auto set = read_table(parted(), "x_mm=2[mm],reading=3[um],approach=motion", 2);
  CHECK(set.readings.size() == 96);
  CHECK(says(set.notes, "1 comments between the rows are ignored"));
  CHECK(says(set.notes, "line 59 has no number in the requested columns and is ignored"));
}

TEST_CASE("where tables of several kinds follow each other the longest stretch is suggested") {
  const std::string text = "a;1;2\nb;3;4\n0;1;2\n5;1;3\n10;1;4\n15;1;5\nsum;12\n";
  const Problem why = refused(text);
  CHECK(contains(why.message, "--skip 2 --rows 4"));
  CHECK(read_table(text, "x_mm=1,reading=3", 2, 4).readings.size() == 4);
}

TEST_CASE("a list of single numbers is answered with what it lacks") {
  const Problem why = refused("9 -1448819\n0\n-32\n-38\n-47\n");
  CHECK(why.line == 1);
  CHECK(contains(why.message, "4 lines from line 2 contain one number each"));
}

TEST_CASE("a time column is suggested as the time") {
  const Problem why = refused("2024-05-06 09:10:11,0,1\n2024-05-06 09:10:12,10,2\n2024-05-06 09:10:13,20,4\n");
  CHECK(contains(why.message, "--columns \"x_mm=2[mm],reading=3[um],date_time=1\""));
}

TEST_CASE("rows that are skipped or not taken are counted in a note") {
  const auto set = read_table(parted(), "x_mm=2,reading=3", 60);
  CHECK(set.readings.size() == 41);
  CHECK(says(set.notes, "55 rows of numbers above line 61 are skipped, as requested"));
  const auto begin = read_table(parted(), "x_mm=2,reading=3", 2, 10);
  CHECK(begin.readings.size() == 10);
  CHECK(says(begin.notes, "86 rows below line 12 are not read, as requested"));
}

TEST_CASE("a bad cell among the rows is refused with its line and column, quoted and empty cells too") {
  const Problem word = refused("0,1\n10,bad\n20,3\n", by_columns("x_mm=1,reading=2"));
  CHECK(word.line == 2);
  CHECK(word.column == 4);
  const Problem empty = refused("x,y\n,1\n2,\n3,4\n", by_columns("x_mm=1,reading=2"));
  CHECK(empty.line == 2);
  CHECK(empty.column == 1);
  CHECK(only(empty.also).line == 3);
  CHECK(empty.also[0].column == 3);
  const Problem quoted = refused("0;\"1\"\n10;\"  x\"\n20;3\n", by_columns("x_mm=1,reading=2"));
  CHECK(quoted.line == 2);
  CHECK(quoted.column == 5);
  const Problem few = refused("0 1\n10\n", by_columns("x_mm=1,reading=2"));
  CHECK(few.line == 2);
}

TEST_CASE("a known file is refused where it says what it is") {
  const Problem why = refused("; made\n; by hand\n  :START2D 1 2 1 2 5 5 2\n0 0 0 0\n:END\n");
  CHECK(why.line == 3);
  CHECK(why.column == 3);
  CHECK(contains(why.message, "an Aerotech two-axis correction table"));
}

TEST_CASE(
    "a list that begins with its length and another number is a table of a Centroid control, any other list is not") {
  CHECK(contains(refused("3 -1448\n0\n-32\n-38\n").message, "it seems to be a Centroid compensation table"));
  for (const char* const other : {"4 -1448\n0\n-32\n-38\n", "3 a\n0\n-32\n-38\n", "3 5\n0.5\n1.5\n2.5\n"})
    CHECK_FALSE(contains(refused(other).message, "Centroid"));
}
