// Live inputs of the emulated unit: wired sensors, values that a host sets, rows that follow them, and what is kept
// without power.
#include <cmath>
#include <filesystem>

#include "core/address_map.hpp"
#include "ecs_emulator/unit/unit.hpp"
#include "tests/ecs_emulator/support/emulated_unit.hpp"
#include "tests/support/folder.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

/// Three sensors wired to inputs 1, 2 and 5 of a machine that warms, bends and grows, and has no other error.
std::string wired_machine() {
  return ideal_machine() + "[inputs]\nt_front_degC = 1\nt_back_degC = 2\nt_spindle_degC = 5\n";
}
constexpr const char* kWarm = R"(
[air]
mean_degC = 21.0
swing_degC = 5.0
warmest_h = 14.0
start_h = 7.0
[column]
lag_s = 5400.0
[material]
lag_s = 900.0
start_degC = 27.0
[spindle]
axis = "Z"
lag_s = 1200.0
degC_per_1000_rpm = 3.0
steps = [[600, 4000], [9000, 0]]
[sensor.front]
of = "material"
lag_s = 20.0
[sensor.back]
of = "column"
lag_s = 60.0
[sensor.spindle]
of = "spindle"
lag_s = 30.0
[[effect]]
id = "thermal_scale"
axis = "X"
parameters = { um_per_m_degC = 11.5 }
[[effect]]
id = "thermal_bend"
axis = "X"
sense = "EZ"
sensor = "front"
sensor2 = "back"
parameters = { um_per_m2_degC = 40.0 }
[[effect]]
id = "thermal_drift"
axis = "Z"
sense = "EZ"
sensor = "spindle"
parameters = { um_per_degC = -2.4 }
)";

double cold_spindle_degC(const Bench& bench) {
  const auto& heat = bench.simulation.heat();
  return heat.first_degC_at(2);
}

std::vector<ThermalRow> rows_for(const Bench& bench) {
  const double datum_mm = bench.simulation.machine().datum_mm()[0];
  return {{Component::EXX, ThermalLaw::growth, 0, kNoInput, -11.5, 20.0, 0.0, datum_mm},
          {Component::EZX, ThermalLaw::bending, 0, 1, -40.0, 0.0, 0.0, datum_mm},
          {Component::EZZ, ThermalLaw::shift, 4, kNoInput, 2.4, cold_spindle_degC(bench), 0.0, 0.0}};
}

/// Over the day, at places all over the volume, of the tool against the place where it was sent.
double rms_over_a_day_um(Bench& bench) {
  const auto travel = bench.simulation.machine().travel_mm();
  double sum = 0.0;
  int n = 0;
  for (int hour = 0; hour < 10; ++hour) {
    for (const double part : {0.1, 0.5, 0.9}) {
      Vector3 target{};
      for (std::size_t a = 0; a < kAxes; ++a) target[a] = travel[a][0] + part * (travel[a][1] - travel[a][0]);
      REQUIRE(bench.simulation.move_to(target, 0.0));
      const ToolPose pose = bench.simulation.tool_now(false);
      for (std::size_t a = 0; a < kAxes; ++a) sum += pose.error_um[a] * pose.error_um[a], ++n;
    }
    REQUIRE(bench.simulation.dwell(1800.0));
  }
  return std::sqrt(sum / n);
}

}  // namespace

TEST_CASE("rows bring the error at the tool of a warm machine to a quarter and less of that with geometry alone") {
  Bench cold(kWarm, wired_machine());
  cold.compensate();
  const double geometry_um = rms_over_a_day_um(cold);
  Bench warm(kWarm, wired_machine());
  warm.thermal = rows_for(warm);
  warm.compensate();
  const double thermal_um = rms_over_a_day_um(warm);
  INFO("geometry alone ", geometry_um, " um, with thermal rows ", thermal_um, " um");
  CHECK(geometry_um > 4.0);
  CHECK(thermal_um <= 0.25 * geometry_um);
  CHECK(warm.unit.fault() == Fault::none);
}

TEST_CASE("what the sensors show is read at the inputs, with what the rows add") {
  Bench b(kWarm, wired_machine());
  b.thermal = rows_for(b);
  const auto before = b.unit.live_inputs();
  CHECK(before.rows == 0);
  CHECK(before.inputs[0].state == InputState::unused);
  CHECK(before.inputs[0].wired);
  CHECK_FALSE(before.inputs[2].wired);
  CHECK(before.inputs[0].value == Approx(27.0).epsilon(0.01));
  b.compensate();
  REQUIRE(b.simulation.move_to({-300.0, -100.0, -50.0}, 0.0));
  const auto live = b.unit.live_inputs();
  CHECK(live.rows == 3);
  CHECK(live.inputs[0].state == InputState::good);
  CHECK(live.inputs[4].state == InputState::good);
  CHECK(live.inputs[2].state == InputState::unused);
  const double p_m = (-300.0 - b.simulation.machine().datum_mm()[0]) / 1000.0;
  CHECK(live.thermal_um[0] == Approx(-11.5 * p_m * (live.inputs[0].value - 20.0)).epsilon(0.02));
  CHECK(live.stored_age_s == protocol::kUnused);
}

TEST_CASE("a sensor that fails is a fault in words, opens no relay and moves no axis at once") {
  for (const SensorFailure failure : {SensorFailure::open, SensorFailure::shifted, SensorFailure::stuck}) {
    Bench b(kWarm, wired_machine());
    b.thermal = rows_for(b);
    b.thermal_settings.rate_um_per_s = 2.0;
    b.thermal_settings.hold_s = 5.0;
    b.thermal_settings.stuck_s = 20.0;
    b.compensate();
    REQUIRE(b.simulation.move_to({-300.0, -100.0, -50.0}, 0.0));
    b.unit.fail_sensor(0, failure, failure == SensorFailure::shifted ? 30.0 : 0.0);
    double largest_um = 0.0;
    double before_um = b.unit.monitor().axes[0].compensation_um;
    for (int k = 0; k < 120'000; ++k) {
      b.simulation.tick();
      const double now_um = b.unit.monitor().axes[0].compensation_um;
      largest_um = std::max(largest_um, std::abs(now_um - before_um));
      before_um = now_um;
    }
    CHECK(largest_um <= 0.2);
    CHECK(b.unit.fault() == Fault::live_input);
    CHECK(b.unit.status().fault_address == 1);
    CHECK(b.unit.mode() == UnitMode::compensating);
    CHECK(all_relays(b, true));
    CHECK(is_doubtful(b.unit.live_inputs().inputs[0].state));
    CHECK(std::abs(before_um) < 0.05);  // faded out
  }
}

TEST_CASE("a host sets an input without a wire in every mode, within its range") {
  Bench b(kWarm, wired_machine());
  const auto set = [&](std::uint16_t input, double value) {
    return b.tell(Command{.code = CommandCode::set_input, .input = input, .input_value = value});
  };
  CHECK(set(2, 24.5).state == CommandState::done);
  CHECK(contains(set(0, 24.5).text, "input 1 is wired to a sensor"));
  CHECK(contains(set(2, 200.0).text, "expected -30 to 120 degC"));
  CHECK(contains(set(kLoadInput, -1.0).text, "expected a load of 0 to 1000000 kg"));
  b.thermal = {{Component::EXX, ThermalLaw::shift, 2, kNoInput, -4.0, 20.0, 0.0, 0.0},
               {Component::EYY, ThermalLaw::shift, kLoadInput, kNoInput, 0.01, 0.0, 0.0, 0.0}};
  b.thermal_settings.longest_age_s = 600.0;
  b.compensate();
  CHECK(b.unit.fault() == Fault::live_input);  // nobody has stated the load
  CHECK(b.unit.status().fault_address == kLoadInput + 1);
  CHECK(b.unit.live_inputs().thermal_um[0] == Approx(-18.0));
  CHECK(set(2, 25.0).state == CommandState::done);
  CHECK(set(kLoadInput, 500.0).state == CommandState::done);
  REQUIRE(b.simulation.dwell(60.0));
  CHECK(b.unit.mode() == UnitMode::compensating);
  CHECK(b.unit.live_inputs().thermal_um[0] == Approx(-20.0));
  CHECK(b.unit.live_inputs().thermal_um[1] == Approx(5.0));
  REQUIRE(b.simulation.dwell(700.0));
  CHECK(b.unit.live_inputs().inputs[2].state == InputState::missing);
  CHECK(b.unit.live_inputs().inputs[kLoadInput].state == InputState::good);
}

TEST_CASE("the state of the lags survives without power, as old as it is") {
  Bench b(kWarm, wired_machine());
  b.thermal = {{Component::EXX, ThermalLaw::growth, 0, kNoInput, -11.5, 20.0, 7200.0, 0.0}};
  b.compensate();
  REQUIRE(b.simulation.move_to({-300.0, -100.0, -50.0}, 0.0));
  REQUIRE(b.simulation.dwell(1800.0));
  const double lagged_um = b.unit.live_inputs().thermal_um[0];
  const double held_degC = b.unit.live_inputs().inputs[0].value;
  const double in_balance_um = -11.5 * -0.3 * (held_degC - 20.0);
  REQUIRE(std::abs(lagged_um - in_balance_um) > 5.0);
  b.unit.power(false);
  REQUIRE(b.simulation.dwell(600.0));
  b.unit.power(true);
  REQUIRE(b.simulation.run_for(0.2));
  REQUIRE(b.tell(CommandCode::enter_compensation).state == CommandState::done);
  b.reference_all();
  REQUIRE(b.unit.mode() == UnitMode::compensating);
  REQUIRE(b.simulation.move_to({-300.0, -100.0, -50.0}, 0.0));
  const auto live = b.unit.live_inputs();
  CHECK(live.stored_age_s >= 600);
  CHECK(live.stored_age_s <= 720);
  const double expected_um = -11.5 * -0.3 * (live.inputs[0].value - 20.0);
  const double part = std::exp(-static_cast<double>(live.stored_age_s) / 7200.0);
  CHECK(live.thermal_um[0] == Approx(expected_um + (lagged_um - expected_um) * part).epsilon(0.05));
}

TEST_CASE("the battery's file keeps the thermal record, and a file of before is read") {
  const Folder folder;
  const std::filesystem::path file = folder.path / "battery.bin";
  UnitMemory memory(1);
  memory.write(kBankA.first, 7);
  REQUIRE(keep(memory, file).has_value());
  const auto without = std::filesystem::file_size(file);
  std::array<std::uint8_t, kStoredThermalBytes> slot{};
  encode_thermal({1, 2, 3.0, {}}, slot);
  const auto version = memory.version();
  memory.write(kThermalRecord.first, slot);
  CHECK(memory.changed());
  CHECK(memory.version() == version);  // no map has changed
  REQUIRE(keep(memory, file).has_value());
  CHECK(std::filesystem::file_size(file) == without + kThermalRecord.size);
  UnitMemory other(1);
  REQUIRE(restore(other, file).has_value());
  CHECK(stored_thermal(other.view(kThermalRecord.first, kThermalRecord.size))->clock_s == 3.0);
}
