// Any table as measurements, by a mapping of its columns; units that headings of tables state.
#include "laser/import/columns.hpp"

#include <fmt/format.h>
#include <rapidcheck.h>

#include "base/text.hpp"
#include "laser/import/fields.hpp"
#include "laser/import/import.hpp"
#include "laser/import/rows.hpp"
#include "laser/import/time.hpp"
#include "laser/measurement_set.hpp"
#include "tests/laser/support/import_options.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

MeasurementSet read_table(const std::string& text, const ImportOptions& options) {
  auto imported = must(parse_any(text, "table.txt", options));
  CHECK(imported.format->id == "mapped_columns");
  return imported.set;
}

std::string refused_table(const std::string& text, const ImportOptions& options) {
  return to_text(must_fail(parse_any(text, "table.txt", options)));
}

ImportOptions channel_log() {
  ImportOptions options = by_columns("date_time=2..3,reading=4");
  options.mapping->row_begins = cell_kinds("word date time any").value();
  options.mapping->channel_column = 1;
  options.mapping->target_lines = unit_named("mm");
  options.mapping->delimiter = ' ';
  options.reading_unit = unit_named("mm");
  options.axis = Axis::X;
  return options;
}

}  // namespace

TEST_CASE("columns by number, with a factor, a run and an approach") {
  const auto set = read_table("0 1 0.001 1\n100 1 0.003 -1\n", by_columns("x_mm=1,reading=3*1000,run=2,approach=4"));
  REQUIRE(set.readings.size() == 2);
  CHECK(set.readings[1].axis == Axis::X);
  CHECK(set.readings[1].sense == Sense::EX);
  CHECK(target_mm(set.readings[1]) == 100.0);
  CHECK(set.readings[1].error == Approx(3.0));
  CHECK(set.readings[1].approach == Approach::reverse);
}

TEST_CASE("a table says where the axes without a column are assumed, and which option states it") {
  ImportOptions options = by_columns("x_mm=1,reading=2,y_mm=3");
  options.axis = Axis::X;
  const auto noted = [&] { return read_table("0 1 5\n100 2 5\n", options).notes; };
  CHECK(noted() ==
        std::vector<std::string>{"the file states no parked position of Z; 0 is assumed. State it with --parked z=MM"});
  options.parked_stated[index_of(Axis::Z)] = true;
  CHECK(noted().empty());
}

TEST_CASE("columns by heading, units in brackets, lines skipped, decimal commas") {
  const std::string text = "Protokoll 7\nBediener: N.N.\nPos [in];Abw;\"Temp; Bett\"\n0,0;0,0001;68\n10,0;-0,0002;77\n";
  const auto set =
      read_table(text, by_columns("y_mm=\"Pos [in]\"[in],reading=Abw[in],t_material_degC=\"Temp; Bett\"[degF]", 2));
  REQUIRE(set.readings.size() == 2);
  CHECK(set.readings[1].axis == Axis::Y);
  CHECK(target_mm(set.readings[1]) == Approx(254.0));
  CHECK(set.readings[0].error == Approx(2.54));
  CHECK(set.readings[1].sensors_degC.at("t_material_degC") == Approx(25.0));
}

TEST_CASE("a field that differs from a target only by an underscore is refused, not kept as a column") {
  const auto wrong = must_fail(parse_any("0 1\n10 2\n", "t.txt", by_columns("xmm=1,x_mm=1,reading=2")));
  CHECK(contains(to_text(wrong), "columns: there is no field xmm; x_mm is the target"));
}

TEST_CASE("a table with a column for each pass") {
  const auto set = read_table("target,f1,b1,f2,b2\n0,1,2,3,4\n50,5,6,,8\n",
                              by_columns("z_mm=1,forward1=2,reverse1=3,forward2=4,reverse2=5"));
  REQUIRE(set.readings.size() == 7);
  CHECK(set.readings[3].approach == Approach::reverse);
  CHECK(set.readings[3].run == 2);
  CHECK(set.readings[3].error == 4.0);
  CHECK(set.readings[6].error == 8.0);
}

TEST_CASE("a column of standard uncertainties is read in the unit of the readings, of lengths in any unit") {
  const auto set = read_table("0 1.5 0.0002\n10 1.6 0.0004\n", by_columns("x_mm=1,reading=2,u_um=3[mm]"));
  CHECK(set.readings[0].extras.at("u_um") == Approx(0.2));
  CHECK(set.readings[1].extras.at("u_um") == Approx(0.4));
  CHECK(contains(refused_table("0 1.5 0\n10 1.6 1\n", by_columns("x_mm=1,reading=2,u_um=3")),
                 "u_um: expected a standard uncertainty above 0, found \"0\""));
  CHECK(contains(refused_table("0 1.5 1\n10 1.6 1\n", by_columns("x_mm=1,reading=2,u_um=3[degC]")),
                 "u_um: degC is not one of its units"));
}

TEST_CASE("several senses in a row, angles in arc seconds") {
  const auto set = read_table("0|1.5|2\n10|0|-1\n", by_columns("x_mm=1,EX=2,EC=3[arcsec]"));
  REQUIRE(set.readings.size() == 4);
  CHECK(set.readings[1].sense == Sense::EC);
  CHECK(set.readings[1].error == Approx(9.6963).epsilon(1e-4));
}

TEST_CASE("actual positions and compensations become errors") {
  ImportOptions actual = by_columns("x_mm=1,forward=2,reverse=3");
  actual.mapping->values = TableValues::actual_positions;
  const auto set = read_table("-10 -10.001 -9.999\n-8 -8.001 -7.999\n", actual);
  CHECK(set.readings[0].error == Approx(-1.0));
  CHECK(set.readings[1].error == Approx(1.0));
  ImportOptions trim = by_columns("x_mm=1,forward=2[mm],reverse=3[mm]");
  trim.mapping->values = TableValues::compensations;
  CHECK(read_table("-10 0.001 -0.001\n", trim).readings[0].error == Approx(-1.0));
}

TEST_CASE("approach and run from the order of the targets") {
  const auto set = read_table("0 1\n100 2\n200 3\n200 4\n100 5\n0 6\n0 7\n100 8\n",
                              by_columns("x_mm=1,reading=2,approach=motion,run=motion"));
  const std::vector<int> approach{1, 1, 1, -1, -1, -1, 1, 1};
  const std::vector<int> run{1, 1, 1, 1, 1, 1, 2, 2};
  for (std::size_t i = 0; i < 8; ++i) {
    CHECK(static_cast<int>(set.readings[i].approach) == approach[i]);
    CHECK(set.readings[i].run == run[i]);
  }
  CHECK(says(set.notes, "order of the targets"));
}

TEST_CASE("the order of the targets counts rows, however many readings a row has") {
  const auto set =
      read_table("0 1 1\n100 2 2\n100 3 3\n0 4 4\n", by_columns("x_mm=1,EX=2,EB=3,approach=motion,run=motion"));
  REQUIRE(set.readings.size() == 8);
  CHECK(set.readings[3].approach == Approach::forward);
  CHECK(set.readings[4].approach == Approach::reverse);
  CHECK(set.readings[7].run == 1);
}

TEST_CASE("one-way passes: a single jump back is no reverse pass") {
  const auto motion = motion_of({0.0, 100.0, 200.0, 0.0, 100.0, 200.0});
  for (const MotionStop& stop : motion) CHECK(stop.approach == Approach::forward);
  CHECK(motion[2].run == 1);
  CHECK(motion[3].run == 2);
  CHECK(motion_of({5.0})[0].approach == Approach::unknown);
  CHECK(motion_of({}).empty());
}

TEST_CASE("a made-up bidirectional test keeps its approaches however many targets and runs it has") {
  const bool kept = rc::check("motion_of names every stop of there-and-back runs", [] {
    const int targets = *rc::gen::inRange(2, 12);
    const int runs = *rc::gen::inRange(1, 6);
    std::vector<double> positions;
    std::vector<std::pair<int, int>> truth;
    for (int run = 1; run <= runs; ++run) {
      for (int i = 0; i < targets; ++i) positions.push_back(37.0 * i), truth.emplace_back(1, run);
      for (int i = targets; i-- > 0;) positions.push_back(37.0 * i), truth.emplace_back(-1, run);
    }
    const auto motion = motion_of(positions);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      RC_ASSERT(static_cast<int>(motion[i].approach) == truth[i].first);
      RC_ASSERT(motion[i].run == truth[i].second);
    }
  });
  CHECK(kept);
}

TEST_CASE("repeats without a run column are numbered, dates become seconds") {
  const auto set =
      read_table("2024-05-06 09:10:11,0,1\n2024-05-06 09:10:12.5,0,2\n", by_columns("date_time=1,x_mm=2,reading=3"));
  CHECK(*set.readings[1].time_s == Approx(1.5));
  CHECK(read_table("0 1\n5 3\n0 2\n", by_columns("x_mm=1,reading=2")).readings[2].run == 2);
  CHECK(*seconds_in("08.11.2022 14:07:19") - *seconds_in("2022-11-07T14:07:19Z") == Approx(86400.0));
  CHECK_FALSE(seconds_in("2022-13-07 14:07:19").has_value());
}

TEST_CASE("readings at the one place of a table are no runs") {
  ImportOptions options = by_columns("reading=1");
  options.axis = Axis::Z;
  options.parked_stated[index_of(Axis::Z)] = true;
  const auto set = read_table("1\n2\n3\n", options);
  REQUIRE(set.readings.size() == 3);
  for (const Reading& reading : set.readings) CHECK(reading.run == 1);
  CHECK_FALSE(says(set.notes, "repeats at a target are numbered"));
}

TEST_CASE("a mapping with another unit than the heading is refused with what to give, and taken with a factor") {
  const std::string text =
      "Position [mm];Abweichung [mm];T (\xC2\xB0"
      "C)\n0;0,0249;20\n100;-0,0102;20\n200;0,0040;20\n";
  const std::string refused = refused_table(text, by_columns("x_mm=1[mm],reading=2[um],t_air_degC=3", 1));
  CHECK(
      contains(refused,
               "table.txt:1:1: reading: the heading of column 2, \"Abweichung [mm]\", states mm, but the mapping uses "
               "um: give reading=2[mm], or reading=2[um]*1 if the heading is wrong"));
  CHECK(contains(refused_table(text, by_columns("x_mm=1,reading=\"Abweichung [mm]\"")),
                 "give reading=\"Abweichung [mm]\"[mm], or"));
  CHECK(contains(refused_table(text, by_columns("x_mm=3,reading=2[mm]", 1)), "give another column, or x_mm=3[mm]*1"));
  CHECK(read_table(text, by_columns("x_mm=1,reading=2[mm]", 1)).readings[0].error == Approx(24.9));
  CHECK(read_table(text, by_columns("x_mm=1,reading=2*1000", 1)).readings[0].error == Approx(24.9));
  CHECK(read_table(text, by_columns("x_mm=1,reading=2[um]*1", 1)).readings[0].error == Approx(0.0249));
}

TEST_CASE("a line of units below the headings counts as theirs") {
  const std::string text = "Position;Abweichung\nmm;mm\n0;0,1\n100;0,2\n200;0,3\n";
  CHECK(contains(refused_table(text, by_columns("x_mm=1,reading=2[um]", 2)), "\"Abweichung [mm]\", states mm"));
}

TEST_CASE("readings of a table that are all below 0.1 um are asked about where nothing says their unit") {
  const std::string text = "0 0.025\n100 -0.01\n200 0.004\n";
  CHECK(contains(refused_table(text, by_columns("x_mm=1,reading=2")),
                 "are they in mm? Give reading=2[mm], or reading=2[um]*1 if they are um"));
  CHECK(read_table(text, by_columns("x_mm=1,reading=2[mm]")).readings[0].error == Approx(25.0));
  CHECK(read_table(text, by_columns("x_mm=1,reading=2[um]*1")).readings[0].error == Approx(0.025));
  CHECK(read_table("Weg [mm];Abw [um]\n0;0.025\n9;0\n99;0\n", by_columns("x_mm=1,reading=2", 1)).readings.size() == 3);
}

TEST_CASE("a table of no approach says so with none") {
  const auto set = read_table("0 1\n100 2\n0 3\n", by_columns("x_mm=1,reading=2,approach=none"));
  for (const Reading& reading : set.readings) CHECK(reading.approach == Approach::unknown);
}

TEST_CASE("rows of one channel: lines between them state the targets, other lines and words are counted") {
  const std::string text =
      "A 2024-05-06 09:10:10 2.5\nSensor 1\n3mm\nA 2024-05-06 09:10:11 2.97\nA 2024-05-06 09:10:12 3.01 HIGH\n"
      "B 2024-05-06 09:10:09 7\nA 2024-05-06 09:10:13 OPEN\nA *** not connected\n6 MM\nA 2024-05-06 09:10:14.5 5.9\n";
  ImportOptions options = channel_log();
  CHECK(contains(refused_table(text, options),
                 "the log contains several channels: give one of A (5 values), B (1 value)"));
  options.channel = "C";
  CHECK(contains(refused_table(text, options), "no channel \"C\" in the log: give one of A (5 values), B (1 value)"));
  options.channel = "A";
  const auto set = read_table(text, options);
  REQUIRE(set.readings.size() == 4);
  CHECK(set.readings[0].error == Approx(2500.0));  // no target is stated above it
  CHECK(set.readings[1].error == Approx(-30.0));
  CHECK(target_mm(set.readings[1]) == 3.0);
  CHECK(set.readings[2].run == 2);
  CHECK(set.readings[3].error == Approx(-100.0));
  CHECK(target_mm(set.readings[3]) == 6.0);
  CHECK(set.readings[3].run == 1);
  CHECK(*set.readings[3].time_s == Approx(4.5));
  CHECK(metadata_value(set, "channel") == "A");
  CHECK(says(set.notes, "error = value - target"));
  CHECK(says(set.notes, "lines that are not rows are ignored: 2"));
  CHECK(says(set.notes, "1 values that are not numbers"));
  options.parked_mm = {1.0, 2.0, 3.0};
  options.channel = "B";
  options.reading_unit = unit_named("um");
  const auto other = read_table(text, options);
  CHECK(other.readings[0].position_mm == Vector3{3.0, 2.0, 3.0});
  CHECK(other.readings[0].error == Approx(7.0 - 3.0));
  CHECK(read_table("B 2024-05-06 09:10:09 7\n", options).readings[0].position_mm == Vector3{1.0, 2.0, 3.0});
  CHECK(contains(refused_table("B 2024-05-06 09:10:09 OPEN\n", options), "expected numbers, found none"));
  options.sense = Sense::EA;
  CHECK(contains(refused_table(text, options), "um is not a unit of EA"));
}

TEST_CASE("how a row begins tells tables from other texts") {
  const ColumnMapping mapping = *channel_log().mapping;
  CHECK(rows_begun("A 2024-05-06 09:10:11 1\nB\t2024-05-06\t09:10 OPEN HIGH\n", mapping) == 2);
  CHECK(rows_begun("1 2024-05-06 09:10:11 1\nA 06.05.2024 09:10:11 1\nA 2024-05-06 1 1\nA 2024-05-06 09:10\n",
                   mapping) == 0);
  CHECK(begins_as(cell_kinds("number any").value(), {"1,5", "x", "y"}));
  CHECK_FALSE(begins_as(cell_kinds("number").value(), {"x"}));
  CHECK(contains(to_text(cell_kinds("word day").error()), "row_begins: expected any, word, number, date or time"));
}

TEST_CASE("units of the options are those of columns without one") {
  ImportOptions options = by_columns("x_mm=1,EX=2,EY=3[um]");
  options.target_unit = unit_named("in");
  options.reading_unit = unit_named("mm");
  const auto set = read_table("1 0.5 0.5\n", options);
  CHECK(target_mm(set.readings[0]) == Approx(25.4));
  CHECK(set.readings[0].error == Approx(500.0));
  CHECK(set.readings[1].error == Approx(0.5));
  options.target_unit = unit_named("degC");
  CHECK(contains(refused_table("1 0.5 0.5\n", options), "degC is not a unit of length"));
}

TEST_CASE("every bad row is named with line and column, and what to map is said") {
  const auto bad = must_fail(parse_any("x,e\n0,1\nten,1\n20,two\n", "t.csv", by_columns("x_mm=x,reading=e")));
  CHECK(bad.line == 3);
  CHECK(bad.column == 1);
  CHECK(only(bad.also).line == 4);
  CHECK(bad.also[0].column == 4);
  CHECK(contains(refused_table("x,e\n0,1\n", by_columns("x_mm=x,reading=err")),
                 "expected a heading \"err\", found none"));
  CHECK(contains(refused_table("0 1\n", by_columns("x_mm=1,reading=5")), "expected a column 5, found 2"));
  CHECK(contains(refused_table("0 1\n", by_columns("reading=2")), "which axis moved"));
  CHECK(contains(refused_table("0 1\n", by_columns("x_mm=1,run=2")), "expected one of reading"));
  CHECK(contains(refused_table("0 1\n", by_columns("x_mm=1[degC],reading=2")), "is not one of its units"));
  CHECK(contains(refused_table("0 1\n", by_columns("x_mm=1,reading=2[mrad]")), "is not one of its units"));
  CHECK(contains(refused_table("x e\n", by_columns("x_mm=1,reading=2")), "no row has the columns"));
}

TEST_CASE("an empty cell is named with its line and column") {
  const std::string what = refused_table("x,y\n,1\n2,\n3, \n", by_columns("x_mm=1[mm],reading=2[um]", 1));
  check_holds(what, {"table.txt:2:1: x_mm: expected a finite number, found nothing",
                     "table.txt:3:3: reading: expected a finite number, found nothing",
                     "table.txt:4:3: reading: expected a finite number, found nothing"});
}

TEST_CASE("a wrong mapping is refused rule by rule") {
  const auto wrong = must_fail(column_mapping("x_mm=0,reading=2[furlong],reading=3,run=,approach=4*x,time_s"));
  CHECK(wrong.kind == ProblemKind::usage);
  CHECK(wrong.also.size() == 5);
  check_holds(to_text(wrong), {"expected a unit in brackets", "each field once"});
  CHECK_FALSE(column_mapping("").has_value());
  CHECK(contains(to_text(column_mapping("x_mm=1..2,reading=3").error()), "only date_time accepts several"));
  CHECK(contains(to_text(column_mapping("date_time=3..2,reading=4").error()), "expected one column"));
  const auto scaled = must(column_rules("reading=\"Err, X\"[mm]*-1e-3+0.5"));
  CHECK(scaled.front().heading == "Err, X");
  CHECK(scaled.front().factor == -1e-3);
  CHECK(scaled.front().offset == 0.5);
}

TEST_CASE("a table that nothing else reads is described, with the option that imports it") {
  const auto why = must_fail(parse_any("My gauge\npos;dev\n0;1,5\n10;2,5\n", "gauge.txt", {}));
  check_holds(why.message, {"2 rows and 2 columns, separated by semicolons, in lines 3 to 4", "1 \"pos\", 2 \"dev\"",
                            "--columns", "--skip 2"});
}

TEST_CASE("a moving column that its heading calls a position is proposed as the targets, however few rows there are") {
  const auto proposed = [](const std::string& rows) {
    const auto table = found_table("My gauge\npos;dev\n" + rows);
    return table && table->suggestion ? table->suggestion->columns + " " + table->suggestion->parked : "";
  };
  CHECK(proposed("0;1,5\n10;2,5\n") == "x_mm=1[mm],reading=2[um],approach=motion ");
  CHECK(proposed("0;1,5\n10;2,5\n10;2,9\n0;1,0\n").starts_with("x_mm=1[mm],reading=2[um],approach=motion"));
  CHECK(proposed("5;1,5\n5;2,5\n5;2,9\n") == "reading=2[um] x=0");  // it rests
}

TEST_CASE("a written table is read back whatever delimiter, unit and decimal sign it has") {
  const bool same = rc::check("columns round trip", [](const std::vector<short>& errors) {
    RC_PRE(errors.size() >= 2);
    const char delimiter = *rc::gen::elementOf(std::string(";\t| "));
    const bool comma = *rc::gen::arbitrary<bool>();
    std::string text = "head\n";
    for (std::size_t i = 0; i < errors.size(); ++i) {
      std::string line =
          fmt::format("{:.3f}{}{:.4f}\n", static_cast<double>(i) * 12.5, delimiter, errors[i] / 10.0 / 25.4);
      if (comma) std::replace(line.begin(), line.end(), '.', ',');
      text += line;
    }
    ImportOptions options = by_columns("x_mm=1,reading=2*25.4", 1);
    options.mapping->delimiter = delimiter;
    const auto set = parse_any(text, "t.txt", options);
    RC_ASSERT(set.has_value());
    RC_ASSERT(set->set.readings.size() == errors.size());
    for (std::size_t i = 0; i < errors.size(); ++i)
      RC_ASSERT(std::abs(set->set.readings[i].error - errors[i] / 10.0) < 0.002);
  });
  CHECK(same);
}

namespace {

std::string unit_of_heading(const std::string& heading) {
  const auto unit = unit_in_heading(heading);
  return unit ? std::string(unit->name) : "";
}

}  // namespace

TEST_CASE("a unit is found between brackets, behind an underscore and at the end") {
  CHECK(unit_of_heading("Abweichung [mm]") == "mm");
  CHECK(unit_of_heading("Position (m)") == "m");
  CHECK(unit_of_heading("error_in") == "in");
  CHECK(unit_of_heading("Weg Zoll") == "in");
  CHECK(unit_of_heading("Zoll (Zoll)") == "in");
  CHECK(unit_of_heading("\xC3\x89"
                        "cart / \xC2\xB5m") == "um");
  CHECK(unit_of_heading("Fehler in mm") == "mm");
  CHECK(unit_of_heading("Abw. [in \xCE\xBCm]") == "um");
  CHECK(unit_of_heading("T Luft [\xC2\xB0"
                        "C]") == "degC");
  CHECK(unit_of_heading("ambient_C") == "degC");
  CHECK(unit_of_heading("Winkel (Grad)") == "deg");
  CHECK(unit_of_heading("Nick [arcsec]") == "arcsec");
  CHECK(unit_of_heading("Zeit [s]") == "s");
  CHECK(unit_of_heading("error_um_per_m") == "um/m");
  CHECK(unit_of_heading("slope_um_per_degC").empty());
  CHECK(unit_of_heading("Temp (C)") == "degC");
}

TEST_CASE("letters and words that mean something else are no units") {
  for (const char* heading : {"", "mm", "Lauf", "Error (F)", "Fehler (B)", "C", "err_min", "lead in", "Position [X]",
                              "run (2)", "deviation", "pos_x", "Soll"})
    CHECK_MESSAGE(unit_of_heading(heading).empty(), heading);
}
