#include "commissioning/link/choice.hpp"
#include "commissioning/maps/map_in_unit.hpp"
#include "commissioning/unit/transfer.hpp"
#include "laser/map/csv.hpp"
#include "laser/map/image.hpp"
#include "params/parameters_toml.hpp"
#include "tests/support/short_lathe.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

const std::string kLathe = short_lathe("MCM-0107");

struct MapWorkspace {
  StateFolder folder;
  std::string params = folder.with("p.toml", kLathe);
  std::string map = folder / "map.csv";
};

TEST_CASE("a map of another machine or serial number is refused; what is not stated is not judged") {
  laser::MapHeader header{.machine = "mill", .configuration = "TXYZ"};
  CHECK(other_machine(header, {"mill", "7"}).empty());
  CHECK(other_machine(header, {"", ""}).empty());
  CHECK(other_machine(header, {"lathe", ""}).size() == 1);
  CHECK(other_unit(header, "8").empty());
  header.serial_number = "7";
  CHECK(other_machine(header, {"lathe", "8"}).size() == 2);
  CHECK(other_unit(header, "7").empty());
  CHECK(other_unit(header, "8").size() == 1);
}

TEST_CASE("a map whose header names neither machine nor serial number, or no configuration, is for nobody") {
  laser::MapHeader header;
  CHECK(other_unit(header, "8").size() == 2);
  header.serial_number = "8";
  CHECK(other_unit(header, "8").size() == 1);
  header.configuration = "TXYZ";
  CHECK(other_unit(header, "8").empty());
}

TEST_CASE("squareness that was measured must have reached the parameters") {
  laser::ErrorMap map;
  map.header.sources.push_back({"C0Y", "square.csv", "ab"});
  UnitParameters parameters;
  const auto complains = [&] {
    for (const std::string& objection : objections_to_map(map, parameters))
      if (contains(objection, "C0Y was measured")) return true;
    return false;
  };
  CHECK(complains());
  parameters.C0Y_um_per_m = 16.0;
  CHECK_FALSE(complains());
}

TEST_CASE("differences are reported by component, approach and position") {
  laser::ErrorMap a;
  a.tables.push_back({Component::EXX, Approach::forward, {0.0, 10.0}, {1.0, 2.0}});
  laser::ErrorMap b = a;
  CHECK(differences_between(a, b).empty());
  b.tables[0].compensation[1] = 2.5;
  b.header.engineer = "N. N.";
  const auto found = differences_between(a, b);
  REQUIRE(found.size() == 2);
  CHECK_FALSE(found[0].component.has_value());
  CHECK(found[1].component == Component::EXX);
  CHECK(found[1].position_mm == 10.0);
  CHECK(found[1].expected == 2.0);
  CHECK(found[1].found == 2.5);
  b.tables[0].approach = Approach::reverse;
  CHECK(differences_between(a, b).size() == 3);
  b.tables.clear();
  CHECK(differences_between(a, b).size() == 2);
}

TEST_CASE("a real axis goes from its file to the bytes of the unit") {
  const std::string file = "samples/real/ecmc-iso230-2/fat_sat_ISO230.dat";
  const MapWorkspace workspace;
  const std::string csv = workspace.folder / "measured.csv";
  REQUIRE(ran({"laser", "import", file, "--axis", "X", "-o", csv}).code == 0);
  REQUIRE(ran({"map", "build", csv, "--params", workspace.params, "-o", workspace.map}).code == 0);
  const auto map = must(laser::read_map_csv(workspace.map));
  const auto params = must(params::read_parameters(workspace.params));
  const auto image = must(laser::image_of(map, params.parameters));
  const auto content = must(laser::content_of(image.bytes));
  for (const laser::MapTable& table : content.map.tables)
    for (std::size_t i = 0; i < table.position_mm.size(); ++i)
      CHECK(std::abs(table.compensation[i] -
                     laser::compensation_at(*laser::table_of(map, table.component, table.approach),
                                            table.position_mm[i])) <= 0.005 + 1e-9);
}

}  // namespace
}  // namespace ecs::app
