// The unit at its machine.
#include "ecs_emulator/unit/unit.hpp"

#include <map>

#include "ecs_emulator/instruments/measurement.hpp"
#include "ecs_emulator/workshop/procedures.hpp"
#include "tests/ecs_emulator/support/emulated_unit.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

/// Every component errs, none at its axis's datum; angles of some 50 um/m, so that levers count.
std::string every_error() {
  std::string text = "[squareness]\nC0Y = 40.0\nB0Z = -50.0\nA0Z = 60.0\n";
  for (std::size_t c = 0; c < kCurves; ++c) {
    const auto curve = static_cast<Component>(c);
    const std::string size = std::to_string((is_angular(curve) ? 50.0 : 15.0) * (c % 2 == 0 ? 1.0 : -0.7));
    text += "[[contribution]]\ncomponent = \"" + std::string(name_of(curve)) + "\"\nformula = \"" + size + "*sin(p/" +
            std::to_string(120 + 7 * c) + ") + 0.002*p*(d+1)\"\n";
  }
  return text;
}

double squareness_slope(Component curve) {  // um/m of E along the moving axis
  if (curve == Component::EXY) return -40.0;
  if (curve == Component::EXZ) return -50.0;
  return curve == Component::EYZ ? -60.0 : 0.0;
}

}  // namespace

TEST_CASE("a host that asks for it at power-up brings the unit into integration mode, one that reads does not") {
  Bench bench("", small_machine(), LinkSense::automatic);
  CHECK(bench.unit.mode() == UnitMode::starting);
  CHECK(bench.unit.status().mode == UnitMode::starting);
  CHECK(bench.unit.mode() == UnitMode::starting);
  CHECK(bench.tell(CommandCode::enter_integration).state == CommandState::done);
  CHECK(bench.unit.mode() == UnitMode::integration);
  CHECK(bench.unit.fault() == Fault::none);
}

TEST_CASE("without a host it waits half a second, then tests itself, and says that there is no map") {
  Bench bench("", small_machine(), LinkSense::automatic);
  REQUIRE(bench.simulation.run_for(0.49));
  CHECK(bench.unit.mode() == UnitMode::starting);
  REQUIRE(bench.simulation.run_for(0.02));
  CHECK(bench.unit.mode() == UnitMode::integration);
  CHECK(bench.unit.fault() == Fault::no_map);
  CHECK(bench.unit.status().ram_test == protocol::TestOutcome::passed);
}

TEST_CASE("a committed map brings the unit through datuming into compensation") {
  Bench bench("", small_machine(), LinkSense::compensate);
  REQUIRE(bench.stage_and_commit(bench.flat_image(0.0)).state == CommandState::done);
  bench.unit.power(false);
  bench.simulation.tick();
  bench.unit.power(true);
  REQUIRE(bench.simulation.run_for(0.01));
  CHECK(bench.unit.mode() == UnitMode::datuming);
  CHECK(all_relays(bench, false));
  bench.reference_all();
  CHECK(bench.unit.mode() == UnitMode::compensating);
  CHECK(all_relays(bench, true));
  for (const Axis a : kAllAxes) CHECK(bench.unit.status().axes[index_of(a)].position_mm == Approx(0.0).epsilon(1e-3));
}

TEST_CASE("the unit finds the reference position of every kind of controller") {
  const std::vector<std::pair<std::string, DatumKind>> kinds{
      {"fanuc", DatumKind::fanuc}, {"allen_bradley", DatumKind::allen_bradley}, {"siemens", DatumKind::siemens}};
  for (const auto& [name, kind] : kinds)
    for (const int direction : {1, -1})
      for (const int polarity : {1, -1}) {
        CAPTURE(name);
        CAPTURE(direction);
        CAPTURE(polarity);
        Bench bench(
            "", "configuration = \"TX\"\n[axis.X]\ntravel_mm = [-500.0, 0.0]\n[emulator.axis.X]\nreference_kind = \"" +
                    name + "\"\nreference_direction = " + std::to_string(direction) +
                    "\nnull_offset_mm = 3.0\nswitch_polarity = " + std::to_string(polarity) + "\n");
        DatumParameters& datum = bench.parameters.axes[0].datum;
        datum.kind = kind;
        datum.approach_direction = static_cast<Approach>(direction);
        datum.switch_polarity = static_cast<std::int8_t>(polarity);
        datum.null_offset_mm = 3.0;
        datum.switch_finally_active = kind == DatumKind::siemens;
        bench.compensate();
        CHECK(std::abs(bench.unit.status().axes[0].position_mm) < 0.0011);
      }
}

TEST_CASE_FIXTURE(Bench, "an axis beyond its switch is brought back and referenced") {
  reference_all();  // the axes now stand at the datum, past the switch
  compensate();
}

TEST_CASE_FIXTURE(Bench, "a stuck bit of axis memory is found with its address, and the content survives the test") {
  const auto image = this->image([](Component, double p, Approach) { return 0.01 * p; });
  REQUIRE(stage_and_commit(image).state == CommandState::done);
  const auto before = crc32_of(unit.memory().view(kBankA.first, bank_bytes(1)));
  CHECK(tell(CommandCode::run_ram_test).value == protocol::kUnused);
  CHECK(crc32_of(unit.memory().view(kBankA.first, bank_bytes(1))) == before);
  unit.memory().stick(kBankB.first + 0x1234, 3, 1);
  CHECK(tell(CommandCode::enter_compensation).state == CommandState::failed);
  CHECK(unit.mode() == UnitMode::integration);
  CHECK(unit.fault() == Fault::ram_test);
  CHECK(unit.status().fault_address == kBankB.first + 0x1234);
  CHECK(unit.status().ram_test == protocol::TestOutcome::failed);
}

TEST_CASE_FIXTURE(Bench, "one flipped bit anywhere in the map fails the checksum") {
  const auto image = this->image([](Component, double p, Approach) { return 0.01 * p; });
  REQUIRE(stage_and_commit(image).state == CommandState::done);
  for (std::uint32_t at = 0; at < image.size(); at += 97) {
    unit.memory().corrupt(kBankA.first + at, 0x10);
    CHECK(tell(CommandCode::enter_compensation).state == CommandState::failed);
    CHECK(unit.fault() == Fault::block_check);
    unit.memory().corrupt(kBankA.first + at, 0x10);
  }
  CHECK(tell(CommandCode::enter_compensation).state == CommandState::done);
}

TEST_CASE_FIXTURE(Bench, "a map that lacks a component of its scope is a fault of its own") {
  UnitParameters linear = parameters;
  linear.scope = Scope::linear;
  auto image = image_of(
      linear, simulation.description().machine, [](Component, double, Approach) { return 0.0; },
      unit.settings().serial_number);
  write_parameters(image, parameters);  // volumetric
  seal_image(image);
  REQUIRE(stage_and_commit(image).state == CommandState::done);
  CHECK(tell(CommandCode::enter_compensation).state == CommandState::failed);
  CHECK(unit.fault() == Fault::map_not_for_parameters);
}

TEST_CASE("an axis without a module in the rack is an axis module fault") {
  Bench bench("",
              "configuration = \"TXYZ\"\n[axis.X]\ntravel_mm = [-500.0, 0.0]\n[axis.Y]\ntravel_mm = [-400.0, 0.0]\n");
  Bench whole;
  REQUIRE(bench.stage_and_commit(whole.image([](Component, double, Approach) { return 0.0; })).state ==
          CommandState::done);
  CHECK(bench.tell(CommandCode::enter_compensation).state == CommandState::failed);
  CHECK(bench.unit.fault() == Fault::axis_module);
  CHECK(bench.unit.status().fault_axis == Axis::Z);
}

TEST_CASE_FIXTURE(Bench, "faults in the loop isolate the unit in the same period") {
  Fault expected = Fault::none;
  compensate([](Component c, double, Approach) { return is_positioning(c) ? 20.0 : 0.0; });
  REQUIRE(simulation.run_for(0.2));
  REQUIRE(simulation.drives()[1].dac_counts != 0);
  SUBCASE("transducer lost") {
    simulation.machine().axis(Axis::Y).lose_transducer(true);
    expected = Fault::axis_module;
  }
  SUBCASE("work that takes longer than a period, three times in a row") {
    unit.slow_down(1500.0);
    simulation.tick();
    simulation.tick();
    CHECK(unit.mode() == UnitMode::compensating);
    expected = Fault::loop_overrun;
  }
  simulation.tick();
  CHECK(unit.fault() == expected);
  CHECK(unit.mode() == UnitMode::integration);
  CHECK(all_relays(*this, false));
  if (expected == Fault::axis_module) CHECK(unit.status().fault_axis == Axis::Y);
}

TEST_CASE_FIXTURE(Bench, "a period that is late now and then is counted, and the output holds until the next") {
  compensate([](Component c, double p, Approach) { return is_positioning(c) ? 0.1 * p : 0.0; });
  simulation.machine().move_to({-200.0, 0.0, 0.0}, 6000.0);
  REQUIRE(simulation.run_for(0.5));
  for (const std::uint32_t so_far : {2u, 4u, 6u}) {
    unit.slow_down(1500.0, 2);
    const std::int32_t held = simulation.drives()[0].dac_counts;
    simulation.tick();
    CHECK(simulation.drives()[0].dac_counts == held);
    REQUIRE(simulation.run_for(0.1));
    CHECK(simulation.drives()[0].dac_counts != held);
    CHECK(unit.status().loop_overruns == so_far);
    CHECK(unit.mode() == UnitMode::compensating);
  }
}

TEST_CASE_FIXTURE(Bench, "a position that jumps isolates the unit") {
  compensate();
  Signals signals = simulation.machine().signals();
  signals[0].counts += 3000;  // 3 mm in a millisecond
  CHECK(!unit.tick(signals)[0].relay_closed);
  CHECK(unit.fault() == Fault::position_jump);
  CHECK(unit.status().fault_axis == Axis::X);
}

TEST_CASE_FIXTURE(Bench, "an output that stays at its limit is a fault after a second, not before") {
  parameters.axes[2].output_limit_um = 10.0;
  compensate([](Component c, double p, Approach) { return c == Component::EZZ && p < -100.0 ? 20.0 : 0.0; });
  simulation.machine().move_to({0.0, 0.0, -200.0}, 0.0);
  int periods_at_limit = 0;
  for (int i = 0; i < 5000 && unit.fault() == Fault::none; ++i) {
    simulation.tick();
    periods_at_limit += simulation.drives()[2].dac_counts == 100 ? 1 : 0;
  }
  CHECK(unit.fault() == Fault::compensation_output);
  CHECK(unit.status().fault_axis == Axis::Z);
  CHECK(periods_at_limit == Approx(1000).epsilon(0.02));
}

TEST_CASE_FIXTURE(Bench, "the watchdog halts a hung processor, and only a power cycle helps") {
  compensate();
  unit.hang();
  REQUIRE(simulation.run_for(kWatchdog_s + 0.002));
  CHECK(unit.mode() == UnitMode::halted);
  CHECK(unit.fault() == Fault::watchdog);
  CHECK(unit.status().watchdog_trips == 1);
  CHECK(all_relays(*this, false));
  CHECK(tell(CommandCode::enter_integration).state == CommandState::refused);
  unit.power(false);
  unit.power(true);
  simulation.tick();
  CHECK(unit.mode() == UnitMode::integration);
}

TEST_CASE("end to end: measured, mapped and compensated, the error of an axis falls to a fraction") {
  Bench bench("[[contribution]]\ncomponent = \"EXX\"\nformula = \"0.05*p + 4*sin(2*pi*p/300) + 3*d\"\n",
              "configuration = \"TX\"\n[axis.X]\ntravel_mm = [-500.0, 0.0]\n");
  MeasurementPlan plan{.targets_mm = targets_between(0.0, -500.0, 10.0), .runs = 1, .feed_mm_min = 6000.0};
  const auto range = [&] {
    const auto set = must(measure(bench.simulation, plan));
    double low = 0.0;
    double high = 0.0;
    for (const auto& reading : set.readings) {
      low = std::min(low, reading.error);
      high = std::max(high, reading.error);
    }
    return std::pair(set, high - low);
  };
  const auto [set, before_um] = range();
  CHECK(before_um > 25.0);
  bench.compensate([&](Component, double p, Approach approach) {
    for (const auto& reading : set.readings)
      if (std::abs(laser::target_mm(reading) - p) < 1e-6 && reading.approach == approach) return -reading.error;
    return 0.0;
  });
  const auto [after, after_um] = range();
  CHECK(after.readings.front().compensated == true);
  CHECK(after_um < 1.5);  // from whole pulses of 1 um
}

TEST_CASE("an axis at rest whose approaches differ by more than the deadband does not go to and fro") {
  Bench bench("",
              "configuration = \"TX\"\n[axis.X]\ntravel_mm = [0.0, 500.0]\ndatum_mm = 0.0\nresolution_um = 0.1\n"
              "[emulator.axis.X]\nreference_direction = -1\n");
  bench.parameters.axes[0].deadband_um = 0.5;
  const auto changes_at_rest = [&bench] {
    int changes = 0;
    for (int period = 0; period < 3000; ++period) {
      const auto before = bench.simulation.drives()[0].dac_counts;
      bench.simulation.tick();
      if (period >= 1000 && bench.simulation.drives()[0].dac_counts != before) ++changes;
    }
    return changes;
  };
  for (const double gain_per_s : {15.0, 30.0, 60.0})  // that the parameters state; the machine has 30
    for (const double reverse_um : {2.4, 6.0, -6.0}) {
      CAPTURE(gain_per_s);
      CAPTURE(reverse_um);
      bench.parameters.axes[0].position_loop_gain_per_s = gain_per_s;
      REQUIRE(bench.tell(CommandCode::enter_integration).state == CommandState::done);
      bench.compensate([reverse_um](Component, double, Approach approach) {
        return approach == Approach::forward ? -0.5 : reverse_um;
      });
      for (const double target_mm : {0.0, 0.001, 0.01, 0.0, -0.001, 5.0, 4.999, 5.0}) {
        CAPTURE(target_mm);
        REQUIRE(bench.simulation.move_to({target_mm, 0.0, 0.0}, 1000.0));
        CHECK(changes_at_rest() == 0);
      }
    }
}

TEST_CASE("a wrong output scaling factor shows in what is left") {
  Bench bench("[[contribution]]\ncomponent = \"EXX\"\nformula = \"0.1*p\"\n",
              "configuration = \"TX\"\n[axis.X]\ntravel_mm = [-500.0, 0.0]\n[emulator.axis.X]\ndrive = \"ideal\"\n"
              "dac_um_per_count = 0.12\n");
  bench.compensate([](Component, double p, Approach) { return -0.1 * p; });
  REQUIRE(bench.simulation.move_to({-500.0, 0.0, 0.0}, 6000.0));
  CHECK(bench.simulation.tool_now(false).error_um[0] == Approx(10.0).epsilon(0.01));  // 20 % too much
}

TEST_CASE("compensated with curves measured along the axes, any machine is accurate in its whole volume") {
  for (const std::string configuration : {"TXYZ", "XTYZ", "XYTZ", "XYZT", "YXTZ", "ZXTY"}) {
    CAPTURE(configuration);
    Bench bench(every_error(), ideal_machine(configuration));
    bench.parameters.C0Y_um_per_m = 40.0;
    bench.parameters.B0Z_um_per_m = -50.0;
    bench.parameters.A0Z_um_per_m = 60.0;
    const ComponentSet needed = components_needed(bench.parameters);
    std::map<std::pair<Component, Approach>, std::map<long, double>> measured;
    for (std::size_t c = 0; c < kCurves; ++c) {
      const auto curve = static_cast<Component>(c);
      if (!needed.contains(curve)) continue;
      MeasurementPlan plan{.axis = moving_axis(curve), .sense = sense_of(curve)};
      const auto [low, high] = bench.simulation.machine().axis(plan.axis).facts().travel_mm;
      plan.targets_mm = targets_between(high, low, 10.0);
      plan.runs = 1;
      plan.feed_mm_min = 6000.0;
      const auto set = must(measure(bench.simulation, plan));
      for (const auto& reading : set.readings)
        measured[{curve, reading.approach}][std::lround(laser::target_mm(reading))] = reading.error;
    }
    const SurveyPlan plan{.step_mm = 100.0, .approach = Approach::reverse};
    const double before_um = worst(survey(bench.simulation, plan)->grid).length_um();
    bench.compensate([&](Component curve, double p, Approach approach) {
      return squareness_slope(curve) * p * 1e-3 - measured[{curve, approach}][std::lround(p)];
    });
    const auto after = must(survey(bench.simulation, plan));
    CHECK(before_um > 30.0);
    CHECK(worst(after.grid).length_um() < 0.2);
  }
}
