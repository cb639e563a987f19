// The map of a model cancels what the model predicts.
#include <fmt/format.h>

#include "core/terms.hpp"
#include "laser/map/csv.hpp"
#include "model/fit/compare.hpp"
#include "params/machine.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

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
    const auto map = must(laser::read_map_csv(map_file));
    const auto machine = params::read_machine(machine_file);
    const auto model = model::read_model(model_file);
    const auto volume = must(model::predicted_volume(*model, machine->machine, 3));
    double largest = 0.0, left = 0.0;
    for (const model::VolumePoint& point : volume) {
      const Vector3 added = compensation_of(map, machine->machine, point.position_mm);
      for (std::size_t i = 0; i < kAxes; ++i) {
        largest = std::max(largest, std::abs(point.error_um[i]));
        left = std::max(left, std::abs(point.error_um[i] + added[i]));
      }
    }
    CHECK(largest > 5.0);
    CHECK(left < 0.2);
  }
}

TEST_CASE("the answer states the temperatures at which the effects that a map leaves out are zero") {
  const Folder folder;
  const std::string model_file = folder.with(
      "model.toml",
      "[origin]\ntemperatures = { t_spindle_degC = 25.13 }\n"
      "[[effect]]\nid = \"scale\"\naxis = \"X\"\nsense = \"EX\"\nfitted = { um_per_m = 11.4 }\n"
      "[[effect]]\nid = \"thermal_drift\"\naxis = \"X\"\nsense = \"EX\"\nsensor = \"t_spindle_degC\"\n"
      "fitted = { um_per_degC = 1.22 }\n"
      "[[effect]]\nid = \"thermal_scale\"\naxis = \"X\"\nsense = \"EX\"\nfitted = { um_per_m_degC = 4.13 }\n");
  const std::string machine_file =
      folder.with("machine.toml", "configuration = \"TX\"\n[axis.X]\ntravel_mm = [0.0, 500.0]\n");
  const auto built = ran({"map", "build", "--from-model", model_file, "--machine", machine_file, "--json"});
  CHECK(built.code == 0);
  check_holds(built.out, {"the map holds at t_spindle_degC = 25.13 degC and t_material_degC = 20 degC",
                          "thermal_drift:X:EX (shift 1.22 um/degC)", "thermal_scale:X:EX (expansion 4.13 um/m/degC)"});
}

}  // namespace
}  // namespace ecs::app
