// The map of a model: what it carries, what it cannot, and that it cancels what the model predicts.
#include <cmath>

#include <doctest/doctest.h>

#include "base/text.hpp"
#include "core/terms.hpp"
#include "laser/map/csv.hpp"
#include "model/fit/compare.hpp"
#include "params/machine.hpp"
#include "tests/support/model_workspace.hpp"

namespace ecs::app {
namespace {

using doctest::Approx;

TEST_CASE("a fitted model becomes a map whose header says where each table comes from") {
  const ModelWorkspace workspace;
  const std::string full = workspace.folder / "full.toml", map = workspace.folder / "map.csv";
  REQUIRE(ran({"model", "fit", workspace.model, workspace.data, "--machine", workspace.machine, "-o", workspace.model})
              .code == 0);
  REQUIRE(ran({"model", "add", workspace.model, "cyclic:X:EX", "--data", workspace.data, "-o", full}).code == 0);
  const Ran r = ran(
      {"map", "build", "--from-model", full, "--machine", workspace.machine, "--increment", "1", "-o", map, "--json"});
  REQUIRE(r.code == 0);
  const nlohmann::json j = r.json();
  CHECK(j["components"][0]["component"] == "EXX");
  CHECK(j["components"][0]["points"] == 1021);
  CHECK(j["not_carried"].empty());
  CHECK(j["complete"] == false);  // a volumetric machine needs more than EXX
  const std::string text = content_of(map);
  CHECK(text.find("# source: EXX data.csv sha256=") != std::string::npos);
  CHECK(text.find("# source: EXX full.toml sha256=") != std::string::npos);
  CHECK(text.find("cyclic:X:EX fitted to") != std::string::npos);
  const auto row = text.find("X,EX,0,100,");
  REQUIRE(row != std::string::npos);
  CHECK(std::stod(text.substr(row + 11)) == Approx(-cyclic_x(100.0, 1, 1)).epsilon(0.1));
}

TEST_CASE("a model of readings taken with compensation active makes no map") {
  const ModelWorkspace workspace;
  std::string readings = content_of(workspace.data);
  const auto head = readings.find("axis,");
  REQUIRE(head != std::string::npos);
  std::string compensated = readings.substr(0, head);
  bool first = true;
  for (const std::string_view line : lines_of(std::string_view(readings).substr(head))) {
    if (!line.empty()) compensated += std::string(line) + (first ? ",compensated\n" : ",1\n");
    first = false;
  }
  const std::string after = workspace.folder.with("after.csv", compensated);
  const std::string fitted = workspace.folder / "fitted.toml", map = workspace.folder / "map.csv";
  REQUIRE(ran({"model", "fit", workspace.model, after, "--machine", workspace.machine, "-o", fitted}).code == 0);
  const Ran r = ran({"map", "build", "--from-model", fitted, "--machine", workspace.machine, "-o", map});
  CHECK(r.code == 1);
  CHECK(r.messages.find("were taken with compensation active") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(map));
  SUBCASE("until it is fitted to readings without") {
    REQUIRE(
        ran({"model", "fit", fitted, workspace.data, "--machine", workspace.machine, "-o", fitted, "--force"}).code ==
        0);
    CHECK(ran({"map", "build", "--from-model", fitted, "--machine", workspace.machine, "-o", map}).code == 0);
  }
}

TEST_CASE("effects that were fitted when another was added come from the data of that step") {
  const ModelWorkspace workspace;
  const std::string full = workspace.folder / "full.toml", map = workspace.folder / "map.csv";
  REQUIRE(ran({"model", "add", workspace.model, "cyclic:X:EX", "--data", workspace.data, "--machine", workspace.machine,
               "-o", full})
              .code == 0);
  const Ran r = ran({"map", "build", "--from-model", full, "--machine", workspace.machine, "-o", map});
  REQUIRE_MESSAGE(r.code == 0, r.all());
  CHECK(r.all().find("does not say which data") == std::string::npos);
  CHECK(content_of(map).find("scale:X:EX fitted to") != std::string::npos);
}

TEST_CASE("what no map can carry is said with its reason, and a model of nothing else is refused") {
  const ModelWorkspace workspace;
  const std::string warm = workspace.folder.with(
      "warm.toml", "[[effect]]\nid = \"time_drift\"\nsense = \"EX\"\nparameters = { um_per_h = 3.0 }\n");
  const Ran r =
      ran({"map", "build", "--from-model", warm, "--machine", workspace.machine, "-o", workspace.folder / "m.csv"});
  CHECK(r.code == 1);
  CHECK(r.messages.find("time_drift") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(workspace.folder / "m.csv"));
  CHECK(ran({"map", "build", "--from-model", workspace.model}).code == 2);
  CHECK(ran({"map", "build", "--from-model", workspace.model, "--machine", workspace.machine}).code == 3);
  CHECK(ran({"map", "build"}).code == 2);
}

/// Error at a place when the unit adds what the map says, its curves read as measured tool against workpiece.
Vector3 compensation_of(const laser::ErrorMap& map, const params::Machine& machine, const Vector3& position_mm) {
  ComponentValues values{};
  for (const laser::MapTable& table : map.tables)
    values[index_of(table.component)] =
        laser::compensation_at(table, position_mm[index_of(moving_axis(table.component))]);
  const auto terms = terms_of(*params::chain_of(machine), Convention::iso, CurveKind::measured);
  return tool_error_um(*terms, values, position_mm, params::measurement_lines_of(machine), {});
}

TEST_CASE("the map of a model cancels what the model predicts everywhere, on every chain") {
  const Folder folder;
  std::string model_text;
  for (const char* code : {"EAX", "EBX", "ECX", "EAY", "EBY", "ECY", "EAZ", "EBZ", "ECZ"})
    model_text += fmt::format(
        "[[effect]]\nid = \"angular\"\ncode = \"{}\"\ncurve = {{ p_mm = [0.0, 500.0], value = "
        "[{}.0, 20.0] }}\n",
        code, code[1] - 'A' + code[2] - 'X' + 3);
  const std::string model_file = folder.with("model.toml", model_text), map_file = folder / "map.csv";
  for (const char* chain : {"TXYZ", "XTYZ", "XYTZ", "XYZT"}) {
    CAPTURE(chain);
    std::string text = fmt::format("configuration = \"{}\"\n", chain);
    for (const char axis : {'X', 'Y', 'Z'}) text += fmt::format("[axis.{}]\ntravel_mm = [0.0, 500.0]\n", axis);
    const std::string machine_file = folder.with("machine.toml", text);
    REQUIRE(ran({"map", "build", "--from-model", model_file, "--machine", machine_file, "--increment", "50", "-o",
                 map_file, "--force"})
                .code == 0);
    const auto map = laser::read_map_csv(map_file);
    const auto machine = params::read_machine(machine_file);
    const auto model = model::read_model(model_file);
    REQUIRE(map);
    const auto volume = model::predicted_volume(*model, machine->machine, 3);
    REQUIRE(volume);
    double largest = 0.0, left = 0.0;
    for (const model::VolumePoint& point : *volume) {
      const Vector3 added = compensation_of(*map, machine->machine, point.position_mm);
      for (std::size_t i = 0; i < kAxes; ++i) {
        largest = std::max(largest, std::abs(point.error_um[i]));
        left = std::max(left, std::abs(point.error_um[i] + added[i]));
      }
    }
    CHECK(largest > 5.0);
    CHECK(left < 0.2);
  }
}

TEST_CASE("a period too short for the tables is said") {
  const ModelWorkspace workspace;
  const std::string grating = workspace.folder.with(
      "grating.toml",
      "[[effect]]\nid = \"cyclic\"\naxis = \"X\"\nsense = \"EX\"\nparameters = { period_mm = 0.02, "
      "amplitude_um = 1.0, phase_rad = 0.0 }\n");
  const Ran r = ran({"map", "build", "--from-model", grating, "--machine", workspace.machine, "--json"});
  REQUIRE(r.code == 0);
  CHECK(r.json()["components"][0]["points"].get<int>() < 10'000);
  CHECK(r.json()["notes"].dump().find("cannot follow its period") != std::string::npos);
}

TEST_CASE("what a fit could not determine is in its file, and no map is made of it beside what no map carries") {
  const ModelWorkspace workspace;
  const std::string square = "\n[[effect]]\nid = \"cosine\"\naxis = \"X\"\nsense = \"EX\"\n";
  const std::string model = workspace.folder.with("both.toml", kStraightModel + square);
  REQUIRE(ran({"model", "fit", model, workspace.data, "--machine", workspace.machine, "-o", model}).code == 0);
  CHECK(content_of(model).find("undetermined = [\"cosine:X:EX\"]") != std::string::npos);
  const std::string map = workspace.folder / "map.csv";
  const Ran refused = ran({"map", "build", "--from-model", model, "--machine", workspace.machine, "-o", map});
  CHECK(refused.code == 1);
  CHECK(
      refused.messages.find("scale:X:EX: the readings that the model was fitted to cannot tell it from cosine:X:EX") !=
      std::string::npos);
  CHECK_FALSE(std::filesystem::exists(map));
  const std::string told = workspace.folder / "told.toml";
  REQUIRE(ran({"model", "fit", workspace.model, workspace.data, "--machine", workspace.machine, "-o", told}).code == 0);
  CHECK(content_of(told).find("undetermined") == std::string::npos);
  CHECK(ran({"map", "build", "--from-model", told, "--machine", workspace.machine, "-o", map}).code == 0);
}

TEST_CASE("a map takes effects that only collide with one another, and leaves out what the readings do not show") {
  const ModelWorkspace workspace;
  const std::string model = workspace.folder.with(
      "together.toml",
      "[[effect]]\nid = \"scale\"\naxis = \"X\"\nsense = \"EX\"\nfitted = { um_per_m = 3.0 }\nundetermined = "
      "[\"sag:X:EX\"]\n[[effect]]\nid = \"sag\"\naxis = \"X\"\nsense = \"EX\"\nfitted = { k2 = 1.0, k3 = 0.0 }\n"
      "undetermined = [\"scale:X:EX\"]\n[[effect]]\nid = \"backlash\"\naxis = \"X\"\nsense = \"EX\"\nfitted = { um = "
      "900.0 }\nundetermined = []\n");
  const Ran r = ran({"map", "build", "--from-model", model, "--machine", workspace.machine, "--json"});
  REQUIRE(r.code == 0);
  CHECK(r.json()["not_carried"].dump().find("backlash:X:EX: the readings that it was fitted to do not show it") !=
        std::string::npos);
}

TEST_CASE("a rotation that the readings do not determine is remarked on where it moves what was not measured") {
  const Folder folder;
  const std::string of = "samples/hidden/6/", model = folder / "six.toml", map = folder / "six.csv";
  REQUIRE(ran({"model", "add", of + "model.toml", "angular:Y:ECY", "--data", of + "data.csv", "--machine",
               of + "machine.toml", "-o", model})
              .code == 0);
  const Ran built = ran({"map", "build", "--from-model", model, "--machine", of + "machine.toml", "-o", map,
                         "--params-out", folder / "six_parameters.toml", "--json"});
  CHECK(contains(built.out, "angular:Y:ECY moves X too, where nothing was measured"));
}

TEST_CASE("effects that cancel each other make no map") {
  const ModelWorkspace workspace;
  const std::string model = workspace.folder.with(
      "cancelling.toml",
      "[[effect]]\nid = \"scale\"\naxis = \"X\"\nsense = \"EX\"\nfitted = { um_per_m = 90000.0 }\n[[effect]]\nid = "
      "\"progressive\"\naxis = \"X\"\nsense = \"EX\"\ncurve = { p_mm = [-10.0, 1010.0], value = [900.0, -90890.0] }\n");
  const Ran r = ran({"map", "build", "--from-model", model, "--machine", workspace.machine});
  CHECK(r.code == 1);
  CHECK(r.messages.find("cancel each other") != std::string::npos);
}

TEST_CASE("squareness of a model goes into the parameters") {
  const ModelWorkspace workspace;
  const std::string square = workspace.folder.with(
      "square.toml", "[[effect]]\nid = \"squareness\"\ncode = \"C0Y\"\nparameters = { um_per_m = 16.0 }\n");
  const std::string params = workspace.folder / "params.toml";
  const Ran r =
      ran({"map", "build", "--from-model", square, "--machine", workspace.machine, "--params-out", params, "--json"});
  CHECK(r.code == 0);
  CHECK(r.json()["squareness"]["C0Y_um_per_m"] == 16.0);
  CHECK(content_of(params).find("C0Y_um_per_m = 16") != std::string::npos);
}

TEST_CASE("a map of what may be an error of the measurement tells what it would put into the machine") {
  const ModelWorkspace workspace;
  const std::string model = workspace.folder.with("tied.toml",
                                                  "[[effect]]\n# or air_refraction:X:EX\nid = \"scale\"\naxis = "
                                                  "\"X\"\nsense = \"EX\"\nparameters = { um_per_m = 8.0 }\n");
  const Ran r = ran({"map", "build", "--from-model", model, "--machine", workspace.machine, "--json"});
  const nlohmann::json j = r.json();
  std::string cost;
  for (const std::string note : j["notes"])
    if (note.starts_with("scale:X:EX may be air_refraction:X:EX, an error of the measurement.")) cost = note;
  CHECK_MESSAGE(cost.find("compensating it puts up to 8.08 um into the machine") != std::string::npos,  // at 1010 mm
                j["notes"].dump());
}

}  // namespace
}  // namespace ecs::app
