// The columns of a table that no format describes: guessed, remembered by their headings, changed one by one.
#include "commissioning/measurements/mapped_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"

namespace ecs::commissioning {
namespace {

/// There and back in steps of 10 mm, errors in um.
std::string gauge_text(int rows = 5, const std::string& headings = "Pos [mm];Abweichung [um];T Luft [degC]\n") {
  std::string text = headings;
  for (int k = 0; k < rows; ++k) text += fmt::format("{};{}.5;20.{}\n", 10 * k, k % 7, k % 10);
  for (int k = rows; k-- > 0;) text += fmt::format("{};{}.0;20.{}\n", 10 * k, k % 7, k % 10);
  return text;
}

MappedTable table_of(const std::string& path, const ImportArguments& given = {}) {
  auto table = MappedTable::of_file(path, given);
  REQUIRE(table.has_value());
  return std::move(*table);
}

std::size_t next_until(MappedTable& table, std::size_t column, const std::string& role) {
  for (std::size_t k = 0; k < 50; ++k) {
    if (table.role(column) == role) return k;
    table.next_role(column, +1);
  }
  FAIL("no role " << role);
  return 0;
}

std::string value(const MappedTable& table, MappingSetting setting) {
  return table.settings()[static_cast<std::size_t>(setting)].value;
}

TEST_CASE("the columns of an unknown table have the roles and units of the guess, and what is read is stated") {
  const StateFolder folder;
  const MappedTable table = table_of(folder.with("gauge.txt", gauge_text()));
  REQUIRE(table.columns() == 3);
  CHECK(table.heading(1) == "Abweichung [um]");
  CHECK(table.role(0) == "X position");
  CHECK(table.unit(0) == "mm");
  CHECK(table.role(1) == "reading");
  CHECK(table.unit(1) == "um");
  CHECK(table.role(2) == "air temp.");
  CHECK(table.unit(2) == "degC");
  CHECK(value(table, MappingSetting::axis) == "X");
  CHECK(value(table, MappingSetting::approach) == "from the motion");
  CHECK(table.first_rows().front() == std::vector<std::string>{"0", "0.5", "20.0"});
  CHECK(table.preview().wrong.empty());
  CHECK(table.preview().lines.at(0) == "EXX: 10 readings, 1 run, forward and reverse; 0 to 40 mm");
  CHECK(contains(table.preview().lines.at(1), "first readings: 0.5 um at 0, 1.5 um at 10"));
  CHECK(table.answers().columns == "x_mm=1[mm],reading=2[um],approach=motion,t_air_degC=3[degC]");
  CHECK(table.answers().skip == 1);
}

TEST_CASE("a correction is read as compensation, and the preview states why the sign is reversed") {
  const StateFolder folder;
  const std::string file = folder.with("gauge.txt", gauge_text(5, "Pos [mm];Korrektur [um];T Luft [degC]\n"));
  const MappedTable table = table_of(file);
  CHECK(value(table, MappingSetting::values) == "compensation");
  CHECK(contains(table.preview().lines.back(), "assumed by the guess: The sign is reversed"));
  CHECK(must(read_measurements(file, table.answers())).set.readings.at(1).error == -1.5);
}

TEST_CASE("what is accepted reads the whole file as the preview said") {
  const StateFolder folder;
  const std::string file = folder.with("gauge.txt", gauge_text());
  const auto imported = read_measurements(file, table_of(file).answers());
  REQUIRE(imported.has_value());
  CHECK(imported->set.readings.size() == 10);
}

TEST_CASE("another axis renames the one column of positions, and a rotary axis takes units of angle") {
  const StateFolder folder;
  MappedTable table = table_of(folder.with("gauge.txt", "Pos;Err\n0;1\n10;2\n20;4\n30;3\n"));
  table.next_value(MappingSetting::axis, +1);
  CHECK(table.role(0) == "Y position");
  CHECK(contains(table.preview().lines.at(0), "EYY: 4 readings"));
  table.next_value(MappingSetting::axis, +2);
  CHECK(value(table, MappingSetting::axis) == "A");
  CHECK(table.role(0) == "A angle");
  CHECK(table.unit(0) == "deg");
  CHECK(table.unit(1) == "um/m");
}

TEST_CASE("a sense that is a rotation changes the unit of the readings") {
  const StateFolder folder;
  MappedTable table = table_of(folder.with("gauge.txt", "Pos;Err\n0;1\n10;2\n20;4\n30;3\n"));
  table.next_value(MappingSetting::sense, +5);
  CHECK(table.answers().sense == "EB");
  CHECK(table.unit(1) == "um/m");
  CHECK(contains(table.preview().lines.at(0), "EBX: 4 readings"));
}

TEST_CASE("wrong mappings say what is wrong with them") {
  const StateFolder folder;
  MappedTable table = table_of(folder.with("gauge.txt", gauge_text()));
  table.clear_role(1);
  CHECK(contains(table.preview().wrong, "No column gives readings"));
  next_until(table, 1, "X position");
  CHECK(table.preview().wrong == "Columns 1 and 2 both have the role \"X position\". Give one of them another role.");
  table.clear_role(0);
  table.clear_role(1);
  table.clear_role(2);
  CHECK(contains(table.preview().wrong, "No column has a role yet"));
}

TEST_CASE("a unit that contradicts the heading is refused until it is forced") {
  const StateFolder folder;
  MappedTable table = table_of(folder.with("gauge.txt", gauge_text()));
  while (table.unit(1) != "mm") table.next_unit(1, +1);
  CHECK(contains(table.preview().wrong, "states um, but the mapping uses mm"));
  while (table.unit(1) != "nm") table.next_unit(1, +1);
  table.toggle_forced_unit(1);
  CHECK(table.unit(1) == "nm*1");
  CHECK(table.preview().wrong == "");
  CHECK(contains(table.answers().columns, "reading=2[nm]*1"));
}

TEST_CASE("a letter goes to the next role that begins with it") {
  const StateFolder folder;
  MappedTable table = table_of(folder.with("gauge.txt", gauge_text()));
  table.next_role_with(2, 'p');
  CHECK(table.role(2) == "pressure");
  table.next_role_with(2, 'r');
  CHECK(table.role(2) == "reading");
  table.next_role_with(2, 'r');
  CHECK(table.role(2) == "reverse 1");
}

TEST_CASE("a column of passes gets the next free run, and a kept column the words of its heading") {
  const StateFolder folder;
  MappedTable table =
      table_of(folder.with("gauge.txt", "Pos;One;Two;My note\n0;1;2;7\n10;2;3;9\n20;4;5;4\n30;3;3;4\n"));
  next_until(table, 1, "forward 1");
  next_until(table, 2, "forward 2");
  next_until(table, 3, "kept");
  CHECK(contains(table.answers().columns, "forward1=2[um],forward2=3[um],my_note=4"));
  CHECK(contains(table.preview().lines.at(0), "EXX: 8 readings, 2 runs, forward"));
}

TEST_CASE("an accepted mapping is proposed for the next file with these headings, and can be exchanged for the guess") {
  const StateFolder folder;
  const std::string first = folder.with("monday.txt", gauge_text());
  MappedTable table = table_of(first);
  table.next_value(MappingSetting::axis, +2);
  remember_mapping(first, table.answers());
  MappedTable next = table_of(folder.with("tuesday.txt", "a comment of the day\n" + gauge_text(8)));
  CHECK(next.role(0) == "Z position");
  CHECK(contains(next.origin(), "as monday.txt was read"));
  CHECK(next.answers().skip == 2);
  CHECK(contains(next.preview().lines.at(0), "EZZ: 16 readings"));
  next.next_value(MappingSetting::columns, +1);
  CHECK(next.role(0) == "X position");
  CHECK(contains(next.origin(), "guessed"));
  next.next_value(MappingSetting::columns, +1);
  CHECK(next.role(0) == "-");
  const MappedTable other = table_of(folder.with("other.txt", gauge_text(5, "Pos;Abweichung;T Luft [degC]\n")));
  CHECK(contains(other.origin(), "guessed"));
}

TEST_CASE("a script is told how a file with the same headings was read, and reads nothing by itself") {
  const StateFolder folder;
  const std::string first = folder.with("monday.txt", gauge_text()), second = folder.with("tuesday.txt", gauge_text());
  ImportArguments given;
  given.columns = "y_mm=\"Pos [mm]\",reading=2,approach=motion";
  REQUIRE(read_measurements(first, given).has_value());
  remember_mapping(first, given);
  const auto refused = read_measurements(second, {});
  REQUIRE_FALSE(refused.has_value());
  CHECK(contains(refused.error().message,
                 "monday.txt, was read with --columns y_mm=1,reading=2,approach=motion --skip 1"));
  CHECK(contains(refused.error().message, (folder.path / "config").string()));
}

TEST_CASE("of a large file only the beginning is looked at, and the number of all readings is estimated") {
  const StateFolder folder;
  std::string text = "Pos [mm];Abweichung [um];T Luft [degC]\n";
  for (int k = 0; k < 100'000; ++k) text += fmt::format("{};{}.5;20.{}\n", 1000 + (k % 9000), k % 7, k % 10);
  const MappedTable table = table_of(folder.with("long.txt", text));
  CHECK(table.preview().wrong.empty());
  CHECK(contains(fmt::format("{}", fmt::join(table.preview().lines, "\n")), "about 100000 readings"));
  CHECK(table.answers().rows == 0);
}

TEST_CASE("binary files, single columns, empty files and known formats are no tables to assign columns of") {
  const StateFolder folder;
  for (const auto& file : {std::pair<const char*, std::string>{
                               "binary.dat", std::string("\x7f\x00\x01\x02\xff\x00", 6) + std::string(400, '\0')},
                           {"one.txt", "1\n2\n3\n4\n"},
                           {"empty.txt", ""},
                           {"words.txt", "the machine was cold\n"},
                           {"set.csv", "sense,axis,reading,x_mm\nEX,X,1.5,10\nEX,X,2.5,20\n"}}) {
    CAPTURE(file.first);
    CHECK_FALSE(MappedTable::of_file(folder.with(file.first, file.second), {}).has_value());
  }
  CHECK_FALSE(MappedTable::of_file((folder.path / "none.txt").string(), {}).has_value());
}

TEST_CASE(
    "positions reached are in mm where no heading states a unit, and passes have their approach from their columns") {
  const StateFolder folder;
  MappedTable table =
      table_of(folder.with("screw.txt", "0 0.001 0.002\n10 10.003 10.001\n20 20.002 20.000\n30 30.001 30.004\n"));
  table.clear_role(2);
  next_until(table, 1, "reading");
  while (value(table, MappingSetting::values) != "errors") table.next_value(MappingSetting::values, +1);
  CHECK(table.unit(1) == "um");
  table.next_value(MappingSetting::values, +1);
  CHECK(value(table, MappingSetting::values) == "positions reached");
  CHECK(table.unit(1) == "mm");
  next_until(table, 1, "forward 1");
  next_until(table, 2, "reverse 1");
  CHECK(table.answers().columns == "x_mm=1[mm],forward1=2[mm],reverse1=3[mm]");
  CHECK(value(table, MappingSetting::approach) == "from the columns");
  CHECK(table.preview().lines.at(0) == "EXX: 8 readings, 1 run, forward and reverse; 0 to 30 mm");
}

TEST_CASE("a date and a time in two columns are one role") {
  const StateFolder folder;
  const std::string text =
      "date;time;Pos;Err\n2024-05-06;09:10:11;0;1\n2024-05-06;09:10:21;10;2\n2024-05-06;09:10:31;20;4\n";
  MappedTable table = table_of(folder.with("log.txt", text));
  table.clear_role(0);
  CHECK(table.role(1) == "-");
  next_until(table, 0, "date and time");
  CHECK(table.role(1) == "date and time");
  CHECK(contains(table.answers().columns, "date_time=1..2"));
  table.clear_role(1);
  CHECK(table.role(0) == "date and time");
  CHECK(table.role(1) == "-");
}

}  // namespace
}  // namespace ecs::commissioning
