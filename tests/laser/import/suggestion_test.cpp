// The options suggested for a table that no format describes: signs, axes, senses, passes, and columns that are not
// read.
#include <filesystem>

#include <fmt/format.h>

#include "base/file.hpp"
#include "laser/csv_columns.hpp"
#include "laser/import/columns.hpp"
#include "laser/import/import.hpp"
#include "tests/laser/support/import_options.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

TableSuggestion suggestion_of(const std::string& text) { return must(must(found_table(text)).suggestion); }

/// As it is suggested.
MeasurementSet imported_as(const std::string& text, const TableSuggestion& suggestion) {
  ImportOptions options = by_columns(suggestion.columns, suggestion.rows.skip);
  options.mapping->most_rows = static_cast<int>(suggestion.rows.count);
  options.mapping->values = suggestion.values;
  options.sense = sense_named(suggestion.sense);
  return must(parse_any(text, "table.txt", options)).set;
}

std::string all_said(const TableSuggestion& suggestion) {
  std::string text = suggestion.reads;
  for (const std::string& sentence : suggestion.assumed) text += ". " + sentence;
  return text + ". " + suggestion.unread;
}

std::string with_heading(const std::string& heading) {
  return fmt::format("Position [mm];{}\n0;1.5\n100;-0.5\n200;3\n", heading);
}

/// Whether a rule reads the column, or the sentence names it.
bool is_read_or_named(const TableSuggestion& suggestion, std::size_t number) {
  for (const ColumnRule& rule : must(column_rules(suggestion.columns)))
    if (number >= static_cast<std::size_t>(rule.column) &&
        number < static_cast<std::size_t>(rule.column + rule.columns))
      return true;
  std::string_view rest = suggestion.unread;
  for (const std::string name = std::to_string(number); !rest.empty(); rest.remove_prefix(1))
    if (rest.starts_with(' ') && rest.substr(1).starts_with(name) &&
        std::string_view(" ,.").find(rest.substr(1 + name.size()).empty() ? ' ' : rest[1 + name.size()]) != rest.npos)
      return true;
  return false;
}

const std::vector<std::string> kTables{
    with_heading("Korrektur [um]"),
    "Nr;Weg Y [mm];Geradheit horizontal [um];Geradheit vertikal [um]\n1;0;1;2\n2;100;2;1\n3;200;4;3\n",
    "Pos;V1;R1;V2;R2;Mittel;Umkehrspanne\n0;1;2;3;4;2.5;-1\n100;2;3;4;5;3.5;-1\n200;4;5;6;7;5.5;-1\n",
    "Achse;Soll;Abw_um;Lauf;Raum\nX;0;1;1;7\nX;100;2;1;7\nY;0;3;1;8\nY;100;4;1;8\n",
    "n;Pos;X dev;Y dev;Z dev;note\n1;0;1;2;3;9\n2;10;2;3;4;word\n3;20;4;5;6;9\n",
    "a;b;c;d;e;f;g;h;i;j;k;l;m;n;o\n0;1;70;70;71;70;70;71;70;70;71;70;70;71;90\n10;2;70;71;70;71;70;71;70;71;70;71;70;"
    "71;90"
    "\n20;4;70;71;70;71;70;71;70;71;70;71;70;71;91\n",
};

}  // namespace

TEST_CASE("a correction, or target - actual, is read with the sign reversed, and the answer states why") {
  for (const char* const heading :
       {"Korrektur [um]", "Correction", "Kompensation", "Soll-Ist [um]", "Nominal - Actual (um)", "Nominal-Measured",
        "target - actual", "Sollwert \u2212 Istwert", "target position - actual position [um]",
        "Abweichung (Soll - Ist)"}) {
    CAPTURE(heading);
    const auto suggestion = suggestion_of(with_heading(heading));
    CHECK(suggestion.values == TableValues::compensations);
    CHECK(only(suggestion.assumed).starts_with("The sign is reversed (--values compensation), because the heading"));
    CHECK(imported_as(with_heading(heading), suggestion).readings.at(2).error == -3.0);
    CHECK(contains(must_fail(parse_any(with_heading(heading), "table.txt", {})).message, only(suggestion.assumed)));
  }
}

TEST_CASE("actual - target stays an error, also where a heading says that a correction is over or active") {
  for (const char* const heading :
       {"Ist-Soll", "Abweichung", "Deviation", "Actual - Nominal", "Error after compensation",
        "Abweichung ohne Korrektur", "measured minus target", "X-Abweichung"}) {
    CAPTURE(heading);
    const auto suggestion = suggestion_of(with_heading(heading));
    CHECK(suggestion.values == TableValues::errors);
    CHECK(suggestion.assumed.empty());
    CHECK(contains(suggestion.reads, "errors (actual - target)"));
  }
}

TEST_CASE("where a heading leaves the sign open the answer states the assumed one") {
  for (const char* const heading : {"Differenz", "delta", "diff", "Kompensation Fehler"}) {
    CAPTURE(heading);
    const auto suggestion = suggestion_of(with_heading(heading));
    CHECK(suggestion.values == TableValues::errors);
    check_holds(only(suggestion.assumed),
                {"leaves the sign open. Assumed is actual - target", "--values compensation"});
  }
  for (const char* const heading : {"Soll-Ist-Abweichung", "Fehlerkorrektur", "Error correction"}) {
    CAPTURE(heading);
    const auto suggestion = suggestion_of(with_heading(heading));
    CHECK(suggestion.values == TableValues::compensations);
    check_holds(only(suggestion.assumed), {"leaves the sign open", "target - actual", "The sign is reversed"});
  }
}

TEST_CASE("errors are suggested rather than the corrections beside them, and factors and flags are no corrections") {
  const auto both = suggestion_of("Pos;Korrektur;Abweichung\n0;-1;1\n100;-2;2\n200;-4;4\n");
  CHECK(both.columns == "x_mm=1[mm],reading=3[um],approach=motion");
  CHECK(both.values == TableValues::errors);
  for (const char* const other : {"Korrekturfaktor", "Kompensation"})
    CHECK(suggestion_of(fmt::format("Pos;{};Abweichung\n0;0;1\n100;1;2\n200;1;4\n", other)).columns == both.columns);
}

TEST_CASE("a column of axes gives each row its axis and target") {
  const std::string text = "Achse;Soll;Abw_um;Lauf\nX;0;1;1\nX;100;2;1\nY;0;3;1\nY;150;4;1\n";
  const auto suggestion = suggestion_of(text);
  CHECK(contains(suggestion.columns, "target=2[mm],reading=3[um],axis=1"));
  const auto set = imported_as(text, suggestion);
  CHECK(set.readings.at(1).axis == Axis::X);
  CHECK(set.readings.at(3).axis == Axis::Y);
  CHECK(set.readings.at(3).sense == Sense::EY);
  CHECK(target_mm(set.readings.at(3)) == 150.0);
  CHECK(set.readings.at(3).position_mm[index_of(Axis::X)] == 0.0);
}

TEST_CASE("one axis in a column of axes is that of all rows") {
  const std::string text = "Pos;Err;Axis\n0;1;Z\n10;2;Z\n20;4;Z\n";
  CHECK(contains(suggestion_of(text).columns, "z_mm=1[mm],reading=2[um]"));
}

TEST_CASE("axes that the import cannot read are refused with the remedy") {
  const std::string text = "Achse;Soll;Abw_um\nAchse X;0;1\nAchse X;100;2\nAchse Y;0;3\nAchse Y;100;4\n";
  check_holds(must_fail(parse_any(text, "table.txt", {})).message,
              {"Column 1 \"Achse\" names the axis of each row", "Write these letters in its cells"});
}

TEST_CASE("a target of a rotary row is an angle, and a unit of length is refused for it") {
  const std::string text = "X;100;1\nC;90;2\n";
  ImportOptions options = by_columns("axis=1,target=2,reading=3");
  options.takes_rotary = true;
  const auto set = must(parse_any(text, "table.txt", options)).set;
  CHECK(target_of(set.readings.at(1)) == 90.0);
  CHECK(contains(must_fail(parse_any(text, "table.txt", by_columns("axis=1,target=2[mm],reading=3"))).message,
                 "target: mm is not one of its units"));
}

TEST_CASE("straightness is a sense across the axis, and each further sense is read") {
  const auto suggestion = suggestion_of(kTables[1]);
  CHECK(contains(suggestion.columns, "y_mm=2[mm],EX=3[um],EZ=4[um]"));
  check_holds(all_said(suggestion), {"is read as EX on a machine whose Z is vertical"});
  const auto set = imported_as(kTables[1], suggestion);
  CHECK(set.readings.size() == 6);
  CHECK(set.readings[1].sense == Sense::EZ);
}

TEST_CASE("the direction of a straightness that no heading states is an assumption that the answer names") {
  const auto suggestion = suggestion_of("X [mm];Straightness [um]\n0;1\n100;2\n200;4\n");
  CHECK(contains(suggestion.columns, "x_mm=1[mm],EY=2[um]"));
  CHECK(contains(only(suggestion.assumed), "does not state the direction of the straightness. Assumed is EY"));
}

TEST_CASE("passes of a straightness have its sense") {
  const std::string text = "X [mm];Geradheit Z vor [um];Geradheit Z zur\u00FCck [um]\n0;1;2\n100;2;3\n200;4;5\n";
  const auto suggestion = suggestion_of(text);
  CHECK(suggestion.sense == "EZ");
  CHECK(imported_as(text, suggestion).readings.at(1).sense == Sense::EZ);
  CHECK(contains(must_fail(parse_any(text, "table.txt", {})).message, "--sense EZ reads column"));
}

TEST_CASE("component names of ISO 230-1 are senses") {
  CHECK(contains(suggestion_of("X;EXX [um];EYX [um];ECX [um/m]\n0;1;2;3\n100;2;3;4\n200;4;5;6\n").columns,
                 "x_mm=1[mm],EX=2[um],EY=3[um],EC=4[um/m]"));
}

TEST_CASE("passes are found by their words, whatever statistics are beside them") {
  const auto suggestion = suggestion_of(kTables[2]);
  CHECK(suggestion.columns == "x_mm=1[mm],forward1=2[um],reverse1=3[um],forward2=4[um],reverse2=5[um]");
  CHECK(suggestion.unread == "These columns are not read: 6 \"Mittel\", 7 \"Umkehrspanne\"");
}

TEST_CASE("approaches are read by their words in three languages") {
  for (const char* word : {"+", "fwd", "Vor", "vorw\u00E4rts", "hin", "aller"})
    CHECK(approach_named(word) == Approach::forward);
  for (const char* word : {"-1", "Back", "zur\u00FCck", "r\u00FCck", "retour"})
    CHECK(approach_named(word) == Approach::reverse);
  CHECK(approach_named("0") == Approach::unknown);
  CHECK_FALSE(approach_named("sideways"));
}

TEST_CASE("passes with the same headings are runs in their order") {
  const auto suggestion = suggestion_of("Pos;vor;zur\u00FCck;vor;zur\u00FCck\n0;1;2;3;4\n100;2;3;4;5\n200;4;5;6;7\n");
  CHECK(contains(suggestion.columns, "forward1=2[um],reverse1=3[um],forward2=4[um],reverse2=5[um]"));
  CHECK(only(suggestion.assumed) == "Columns with the same heading are assumed to be runs, in their order");
}

TEST_CASE("numbered columns without an approach are runs, and their approach follows from the motion") {
  const std::string text = "Target;Run1 (um);Run2 (um)\n200;1;2\n100;2;3\n0;4;5\n";
  const auto suggestion = suggestion_of(text);
  CHECK(contains(suggestion.columns, "forward1=2[um],forward2=3[um],approach=motion"));
  const auto set = imported_as(text, suggestion);
  CHECK(set.readings.at(1).run == 2);
  CHECK(set.readings.at(1).approach == Approach::reverse);
}

TEST_CASE("plus and minus are passes, and a pass that drifted is one") {
  const auto suggestion = suggestion_of("Target;Run 1 +;Run 1 -\n0;0.001;0.031\n100;0.002;0.032\n200;0.004;0.031\n");
  CHECK(suggestion.columns == "x_mm=1[mm],forward1=2[mm],reverse1=3[mm]");
}

TEST_CASE("passes without a number are repeats where the table repeats the targets, or of the run of their row") {
  const std::string text =
      "Pos;Abw +X;Abw -X\n0;1;2\n100;2;3\n200;4;5\n300;5;6\n400;4;5\n0;1;2\n100;2;3\n200;4;5\n300;5;6\n400;4;5\n";
  const auto set = imported_as(text, suggestion_of(text));
  CHECK(set.readings.at(15).run == 2);
  CHECK(set.readings.at(15).approach == Approach::reverse);
  const std::string with_run = "Lauf;Pos;vor;zur\u00FCck\n3;0;1;2\n3;100;2;3\n3;200;4;5\n";
  CHECK(imported_as(with_run, suggestion_of(with_run)).readings.at(1).run == 3);
}

TEST_CASE("a pass with an empty cell is read") {
  CHECK(contains(suggestion_of("Pos;F1;B1\n0;1;2\n100;2;\n200;4;5\n").columns, "forward1=2[um],reverse1=3[um]"));
}

TEST_CASE("points or blanks between thousands are no decimal signs") {
  const std::string text = "Soll;Abw\n800,5;1,5\n1.200,250;2,5\n";
  CHECK(number_or_comma("1.200,250") == 1200.25);
  CHECK(number_or_comma("-1,200.5") == -1200.5);
  CHECK(number_or_comma("1'234 567.5") == std::nullopt);
  CHECK(number_or_comma("12 345 678,0") == 12345678.0);
  CHECK(number_or_comma("1.20,5") == std::nullopt);
  CHECK(target_mm(must(parse_any(text, "table.txt", by_columns("x_mm=1,reading=2", 1))).set.readings.at(1)) == 1200.25);
}

TEST_CASE("targets with words among them are refused, not taken as one position") {
  check_holds(must_fail(parse_any("Soll;Abw\n0;1\n100 ca;2\n200 ca;4\n300 ca;3\n", "table.txt", {})).message,
              {"Column 1 \"Soll\" has cells that are not numbers, the first is \"100 ca\". Correct them"});
}

TEST_CASE("a row for each run is answered with the remedy") {
  CHECK(contains(must_fail(parse_any("Soll;0;100;200;300\nLauf 1;1;2;4;3\nLauf 2;1;2;3;4\n", "table.txt", {})).message,
                 "Exchange rows and columns"));
}

TEST_CASE("every column with numbers is read or named in the answer") {
  std::vector<std::string> texts = kTables;
  for (const char* const folder : {"samples", "tests/data"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
      if (entry.is_regular_file()) texts.push_back(must(read_file(entry.path())));
  int suggestions = 0;
  for (const std::string& text : texts) {
    const auto found = found_table(text);
    if (!found || !found->suggestion) continue;
    ++suggestions;
    CAPTURE(text.substr(0, 200));
    CAPTURE(found->suggestion->columns);
    CAPTURE(found->suggestion->unread);
    for (std::size_t i = 0; i < found->shape.columns; ++i) {
      CAPTURE(i);
      if (found->shape.is_number[i]) CHECK(is_read_or_named(*found->suggestion, i + 1));
    }
  }
  CHECK(suggestions > 20);
}
