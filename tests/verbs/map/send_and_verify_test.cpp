#include <cmath>

#include <doctest/doctest.h>
#include <fmt/format.h>

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

using doctest::Approx;

const std::string kLathe = short_lathe("MCM-0107");

struct MapWorkspace {
  StateFolder folder;
  std::string params = folder.with("p.toml", kLathe);
  std::string data = folder.with("exx.csv", lathe_readings());
  std::string map = folder / "map.csv";
  [[nodiscard]] Ran build(std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"map", "build", data, "--params", params, "-o", map};
    words.insert(words.end(), more.begin(), more.end());
    return ran(words);
  }
};

TEST_CASE("build takes compensation as minus the error, zero at the datum, and says what it did") {
  const MapWorkspace workspace;
  const Ran r = workspace.build({"--json", "--customer", "C", "--engineer", "E", "--date", "2026-01-02"});
  CHECK(r.code == 0);
  const auto j = r.json();
  CHECK(j["complete"] == true);
  CHECK(j["missing"].empty());
  REQUIRE(j["components"].size() == 1);
  CHECK(j["components"][0]["component"] == "EXX");
  CHECK(j["components"][0]["band"] == Approx(22.0));
  CHECK(j["components"][0]["points"] == 5);
  CHECK(j["header"]["customer"] == "C");
  CHECK(j["header"]["machine"] == "short lathe");
  const auto map = laser::read_map_csv(workspace.map);
  REQUIRE(map);
  const auto* forward = laser::table_of(*map, Component::EXX, Approach::forward);
  REQUIRE(forward != nullptr);
  CHECK(laser::compensation_at(*forward, -200.0) == Approx(19.0));
  CHECK(laser::compensation_at(*forward, 0.0) == Approx(-1.0));
}

TEST_CASE("files of which nothing can be built are refused with the reason of each, and nothing is written") {
  const MapWorkspace workspace;
  const std::string other =
      workspace.folder.with("eyx.csv", "axis,sense,y_mm,reading,approach\nY,EY,0,1,1\nY,EY,50,2,1\n");
  const Ran r = ran({"map", "build", other, "--params", workspace.params, "-o", workspace.map});
  CHECK(r.code == 1);
  CHECK(r.messages.find("not used: eyx.csv (EY along Y): there is no axis Y") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(workspace.map));
}

TEST_CASE("a map becomes bytes and comes back with the same content") {
  const MapWorkspace workspace;
  REQUIRE(workspace.build().code == 0);
  const auto map = laser::read_map_csv(workspace.map);
  const auto params = params::read_parameters(workspace.params);
  REQUIRE(map);
  REQUIRE(params);
  const auto image = laser::image_of(*map, params->parameters);
  REQUIRE(image);
  const auto content = laser::content_of(image->bytes);
  REQUIRE(content);
  CHECK(content->parameters == params->parameters);
  CHECK(differences_between(*map, content->map).empty());
}

TEST_CASE("an incomplete map is written, named incomplete, and refused by send") {
  const MapWorkspace workspace;
  const std::string params = workspace.folder.with("planar.toml", R"(
[configuration]
chain = "TXY"
axes = "XY"
[compensation]
scope = "planar"
[axis.X]
transducer = "encoder"
[axis.Y]
transducer = "encoder"
# end of parameters
)");
  const Ran r = ran({"map", "build", workspace.data, "--params", params, "-o", workspace.map, "--json"});
  CHECK(r.code == 0);
  CHECK(r.json()["complete"] == false);
  CHECK(r.json()["missing"].size() > 1);
  CHECK(std::filesystem::exists(workspace.map));
  const Ran sent = ran({"map", "send", workspace.map, "--params", params, "--link", "tcp:127.0.0.1:1"});
  CHECK(sent.code == 1);
  CHECK(sent.messages.find("EYY (Y axis linear positioning error) is missing") != std::string::npos);
}

TEST_CASE("a component is declared zero with a reason, or not at all") {
  const MapWorkspace workspace;
  CHECK(workspace.build({"--zero", "EYY"}).code == 2);
  CHECK(workspace.build({"--zero", "EYY="}).code == 2);
  CHECK(workspace.build({"--zero", "QQQ=why"}).code == 2);
  CHECK(workspace.build({"--zero", "EXX=it is measured too"}).code == 2);
}

TEST_CASE("readings taken with compensation active make no map") {
  const MapWorkspace workspace;
  const std::string file =
      workspace.folder.with("comp.csv", "axis,sense,x_mm,reading,approach,compensated\nX,EX,0,1,1,1\nX,EX,-50,2,1,1\n");
  const std::string recipe = workspace.folder.with("r.toml", "[[component]]\ncode = \"EXX\"\nfiles = [\"comp.csv\"]\n");
  const Ran r = ran({"map", "build", recipe, "--params", workspace.params, "-o", workspace.map});
  CHECK(r.code == 1);
  CHECK(r.messages.find(file) != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(workspace.map));
}

TEST_CASE("a recipe needs no options, and its faults are reported with their lines") {
  const MapWorkspace workspace;
  const std::string recipe = workspace.folder.with("r.toml", "[[component]]\ncode = \"EXQ\"\nfiles = [\"exx.csv\"]\n");
  const Ran r = ran({"map", "build", recipe, "--params", workspace.params});
  CHECK(r.code == 3);
  CHECK(r.messages.find("r.toml:1:") != std::string::npos);
  CHECK(ran({"map", "build", recipe, workspace.data, "--params", workspace.params}).code == 2);
}

TEST_CASE("what a file does not say is asked for, and given as to import") {
  const MapWorkspace workspace;
  const Ran r = ran({"map", "build", "samples/laser/pitch.rta", "--params", workspace.params});
  CHECK(r.code == 2);
  CHECK(r.messages.find("--sense EX") != std::string::npos);
  CHECK(ran({"map", "build", "samples/laser/pitch.rta", "--params", workspace.params, "--sense", "EB"}).code != 2);
}

TEST_CASE("a corrupted map is refused with line and column before any link is opened") {
  const MapWorkspace workspace;
  const std::string bad =
      workspace.folder.with("bad.csv", "axis,sense,approach,p_mm,value_um\nX,EX,1,0,nan\nX,EX,3,0,1\n");
  for (const std::vector<std::string>& words : {std::vector<std::string>{"map", "show", bad},
                                                {"map", "header", bad},
                                                {"map", "send", bad, "--params", workspace.params},
                                                {"map", "verify", bad}}) {
    const Ran r = ran(words);
    CHECK(r.code == 3);
    CHECK(r.messages.find("bad.csv:2:") != std::string::npos);
    CHECK(r.messages.find("bad.csv:3:") != std::string::npos);
  }
}

TEST_CASE("show lists each table with start, increment, points, smallest and largest") {
  const MapWorkspace workspace;
  REQUIRE(workspace.build().code == 0);
  const auto j =
      ran({"map", "show", workspace.map, "--component", "EXX", "--params", workspace.params, "--json"}).json();
  REQUIRE(j["tables"].size() == 2);
  const auto& forward = j["tables"][0];
  CHECK(forward["approach"] == "forward");
  CHECK(forward["start_mm"] == Approx(-200.0));
  CHECK(forward["increment_mm"] == Approx(50.0));
  CHECK(forward["points"] == 5);
  CHECK(forward["min"] == Approx(-1.0));
  CHECK(forward["max"] == Approx(19.0));
  CHECK(forward["compensation"].size() == 5);
  CHECK(j["findings"].empty());
  CHECK(ran({"map", "show", workspace.map, "--component", "EYY"}).code == 1);
  CHECK(ran({"map", "show", workspace.map, "--component", "C0Y"}).code == 2);
  CHECK(ran({"map", "show"}).code == 2);
  CHECK(ran({"map", "show", workspace.map, "--unit"}).code == 2);
}

TEST_CASE("a map of another machine or serial number is refused; what is not stated is not judged") {
  laser::MapHeader header;
  header.machine = "mill";
  header.configuration = "TXYZ";
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

TEST_CASE("build warns of readings from another machine than the parameters, in words of a verb that sends nothing") {
  const MapWorkspace workspace;
  const std::string other = workspace.folder.with("other.csv", lathe_readings("# machine: long lathe\n"));
  const Ran r = ran({"map", "build", other, "--params", workspace.params, "-o", workspace.map});
  CHECK(r.code == 0);
  CHECK(r.messages.find("the map was made for machine \"long lathe\", [identity] of the parameters says \"short "
                        "lathe\": as they stand, `ecs map send` refuses the map with these parameters") !=
        std::string::npos);
  CHECK(r.messages.find("--other-machine") == std::string::npos);
}

TEST_CASE("squareness that was measured must have reached the parameters") {
  laser::ErrorMap map;
  map.header.sources.push_back({"C0Y", "square.csv", "ab"});
  UnitParameters parameters;
  const auto complains = [&] {
    for (const std::string& objection : objections_to_map(map, parameters))
      if (objection.find("C0Y was measured") != std::string::npos) return true;
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
  const auto map = laser::read_map_csv(workspace.map);
  const auto params = params::read_parameters(workspace.params);
  REQUIRE(map);
  REQUIRE(params);
  const auto image = laser::image_of(*map, params->parameters);
  REQUIRE(image);
  const auto content = laser::content_of(image->bytes);
  REQUIRE(content);
  for (const laser::MapTable& table : content->map.tables)
    for (std::size_t i = 0; i < table.position_mm.size(); ++i)
      CHECK(std::abs(table.compensation[i] -
                     laser::compensation_at(*laser::table_of(*map, table.component, table.approach),
                                            table.position_mm[i])) <= 0.005 + 1e-9);
}

TEST_CASE("a map goes to the emulator, is verified, changed, found different, and comes back") {
  const auto machine = sample_machine();
  const MapWorkspace workspace;
  const std::string link = "emulator:" + machine->string();
  REQUIRE(workspace.build().code == 0);
  const Ran empty = ran({"map", "header", "--unit", "--link", link});
  CHECK(empty.code == 1);
  const Ran sent =
      ran({"map", "send", workspace.map, "--params", workspace.params, "--link", link, "--json", "--other-machine"});
  CAPTURE(sent.out);
  REQUIRE(sent.code == 0);
  CHECK(sent.json()["verified"] == true);
  CHECK(sent.json()["bytes"].get<int>() > 600);
  CHECK(sent.json()["seconds"].get<double>() > 0.0);
  CHECK(sent.json()["check"].get<std::string>().size() == 8);
  CHECK(sent.json()["link"] == link);
  CHECK(ran({"map", "verify", workspace.map, "--params", workspace.params, "--link", link}).code == 0);
  const std::string back = workspace.folder / "back.csv";
  REQUIRE(ran({"map", "receive", "-o", back, "--link", link}).code == 0);
  CHECK(ran({"map", "verify", back, "--link", link}).code == 0);
  auto changed = laser::read_map_csv(back);
  REQUIRE(changed);
  changed->tables[0].compensation[2] += 0.5;
  const std::string other = workspace.folder.with("other.csv", laser::to_map_csv(*changed));
  const Ran differs = ran({"map", "verify", other, "--link", link, "--json"});
  CHECK(differs.code == 1);
  REQUIRE(differs.json()["differences"].size() == 1);
  CHECK(differs.json()["differences"][0]["component"] == "EXX");
  CHECK(differs.json()["differences"][0]["position_mm"] == Approx(-100.0));
}

}  // namespace
}  // namespace ecs::app
