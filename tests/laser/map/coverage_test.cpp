// How far tables reach, what is said of it, and what is normal.
#include "laser/map/error_map.hpp"
#include "laser/map/recipe.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

/// A table of EXX with points from `first_mm` on; compensation is zero everywhere.
MapTable exx(Approach approach, double first_mm, double last_mm, double step_mm) {
  MapTable table{Component::EXX, approach, {}, {}};
  for (double p = first_mm; p <= last_mm + 1e-9; p += step_mm) {
    table.position_mm.push_back(p);
    table.compensation.push_back(0.0);
  }
  return table;
}

ErrorMap map_of(std::vector<MapTable> tables) {
  ErrorMap map;
  map.tables = std::move(tables);
  return map;
}

std::vector<std::string> remarks(const ErrorMap& map, const Travels& travels = {}) {
  std::vector<std::string> out;
  for (const MapFinding& finding : findings_for(map, one_axis(), travels)) {
    CHECK_FALSE(finding.objection);
    out.push_back(finding.message);
  }
  return out;
}

const Travels kTravel{std::array<double, 2>{-4100.0, 0.0}, std::nullopt, std::nullopt};

}  // namespace

TEST_CASE("approaches that end a target apart are reported with both ranges and with the value beyond") {
  const auto found = remarks(map_of({exx(Approach::forward, -200, 0, 100), exx(Approach::reverse, -300, 0, 100)}));
  CHECK(only(found) ==
        "EXX: forward is measured from -200 to 0 mm only, reverse from -300 to 0 mm: the unit keeps the end value of "
        "a table beyond its end");
}

TEST_CASE("approaches whose targets lie beside each other by less than a spacing are one range") {
  CHECK(remarks(map_of({exx(Approach::forward, -200, 0, 50), exx(Approach::reverse, -202, 0, 50)})).empty());
}

TEST_CASE("an approach of two points is reported, three points are enough") {
  const auto found = remarks(map_of({exx(Approach::forward, -100, 0, 100), exx(Approach::reverse, -100, 0, 50)}));
  CHECK(
      only(found) ==
      "EXX has 2 points forward, 3 in reverse: fewer than 3 do not show the shape of the error; measure more targets");
  CHECK(remarks(map_of({exx(Approach::unknown, -100, 0, 50)})).empty());
}

TEST_CASE("a table that reaches beyond the travel is reported, for file and machine may be of two machines") {
  const Travels bench{std::array<double, 2>{-20.0, 20.0}, std::nullopt, std::nullopt};
  const auto found = remarks(map_of({exx(Approach::unknown, 0.0, 200.0, 100.0)}), bench);
  CHECK(contains(only(found), "was measured from 0 to 200 mm, but X travels from -20 to 20 mm"));
  CHECK(remarks(map_of({exx(Approach::unknown, -21.0, 21.0, 3.0)}), bench).empty());  // optics run a little over
}

TEST_CASE("a table that covers part of its axis's travel is reported with the part covered") {
  const auto found = remarks(map_of({exx(Approach::unknown, -200, 0, 50)}), kTravel);
  CHECK(only(found) ==
        "EXX covers only 200 of 4100 mm of the travel of X (-4100 to 0): the unit keeps the end value of a table "
        "beyond its end");
}

TEST_CASE("a target's spacing, or a twentieth of the travel, left out at the ends is normal") {
  CHECK(remarks(map_of({exx(Approach::unknown, -3895, 0, 41)}), kTravel).empty());      // 205 mm, 5 %
  CHECK(remarks(map_of({exx(Approach::unknown, -3600, -300, 600)}), kTravel).empty());  // within a spacing
  CHECK(remarks(map_of({exx(Approach::unknown, -3894, 0, 50)}), kTravel).size() == 1);  // 206 mm
}

TEST_CASE("without a travel the tables of an axis are held against what they cover together") {
  UnitParameters planar{.configuration = {'T', 'X', 'Y', 0, 0}, .axis_present = {true, true, false}};
  planar.scope = Scope::planar;
  ErrorMap map = map_of({exx(Approach::unknown, -200, 0, 50), exx(Approach::unknown, -4100, 0, 100)});
  map.tables[1].component = Component::EYX;
  const auto warnings = coverage_warnings(map, planar, {});
  CHECK(only(warnings).message.find(
            "EXX covers only 200 of 4100 mm of the common range of the tables of X (-4100 to 0)") == 0);
}

TEST_CASE("a header is missing what it does not state") {
  MapHeader header{.customer = "C", .machine = "M", .date = "2026-03-12"};
  CHECK(missing_in(header) == std::vector<std::string>{"serial number", "engineer"});
}

TEST_CASE("a run number that no whole number holds is refused") {
  const auto runs = must_fail(parse_map_recipe(
      "[[component]]\ncode = \"EXX\"\nfiles = [\"a.csv\"]\nexclude_runs = [1, 1e300]\n", "r.toml", "."));
  CHECK(contains(to_text(runs), "r.toml:4:20: exclude_runs: expected a run number"));
}

TEST_CASE("a recipe's date is a date, or refused with what was expected") {
  CHECK(parse_map_recipe("date = \"2024-05-06\"\n", "r.toml", "."));
  const auto refused =
      must_fail(parse_map_recipe("engineer = \"N. N.\"\ndate = \"2024-05-06N. Comer\"\n", "r.toml", "."));
  CHECK(refused.line == 2);
  CHECK(refused.message == "date: expected year-month-day, as in 2026-03-12, found \"2024-05-06N. Comer\"");
}
