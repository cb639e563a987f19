// Every fault of the unit is provoked, isolates it, and is recovered from: the machine is compensated again afterwards.
#include <array>
#include <functional>

#include "ecs_emulator/unit/rack.hpp"
#include "tests/ecs_emulator/support/emulated_unit.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

double asked_um(Component component, double p_mm, Approach) { return component == Component::EXX ? -0.05 * p_mm : 0.0; }

bool isolated(const Bench& bench) {
  for (const AxisDrive& drive : bench.simulation.drives())
    if (drive.relay_closed || drive.dac_counts != 0) return false;
  return true;
}

/// What provokes a fault on a compensating bench, and what puts it right.
struct Case {
  Fault fault;
  std::function<void(Bench&)> provoke;
  std::function<void(Bench&)> mend;
};

void enter_again(Bench& bench) { (void)bench.tell(CommandCode::enter_compensation); }

void send_again(Bench& bench) {
  (void)bench.tell(CommandCode::enter_integration);
  REQUIRE(bench.stage_and_commit(bench.image(asked_um)).state == CommandState::done);
}

/// Another map is committed and the unit set to compensate with it.
void compensate_with(Bench& bench, const std::vector<std::uint8_t>& image) {
  REQUIRE(bench.tell(CommandCode::enter_integration).state == CommandState::done);
  REQUIRE(bench.stage_and_commit(image).state == CommandState::done);
  (void)bench.tell(CommandCode::enter_compensation);
}

std::vector<std::uint8_t> image_with(Bench& bench, const std::function<void(UnitParameters&)>& change) {
  auto image = bench.image(asked_um);
  UnitParameters parameters = bench.parameters;
  change(parameters);
  write_parameters(image, parameters);
  seal_image(image);
  return image;
}

void leave_and(Bench& bench, const std::function<void()>& spoil) {
  REQUIRE(bench.tell(CommandCode::enter_integration).state == CommandState::done);
  spoil();
  (void)bench.tell(CommandCode::enter_compensation);
}

/// Memory as another rack has committed it.
void put_committed(UnitMemory& memory, const std::vector<std::uint8_t>& image) {
  const Commit last = active_image(memory)->commit;
  memory.write(kBankA.first, image);
  std::array<std::uint8_t, kCommitSlotBytes> record{};
  encode_commit({last.sequence + 1, 0, static_cast<std::uint32_t>(image.size()), ImageView(image).check()}, record);
  const auto slot = next_commit_slot(memory.view(kCommitRecords.first, kCommitRecords.size));
  memory.write(static_cast<Address>(kCommitRecords.first + slot * kCommitSlotBytes), record);
}

const std::vector<Case> kCases{
    {Fault::ram_test, [](Bench& b) { leave_and(b, [&] { b.unit.memory().stick(kBankB.first + 77, 3, 1); }); },
     [](Bench& b) { b.unit.memory().repair(); }},
    {Fault::block_check,
     [](Bench& b) {
       leave_and(b, [&] { b.unit.memory().corrupt((active_image(b.unit.memory())->first) + 600, 0x10); });
     },
     send_again},
    {Fault::no_map,
     [](Bench& b) {
       leave_and(b, [&] {
         b.unit.memory().write(kCommitRecords.first, std::array<std::uint8_t, kCommitSlots * kCommitSlotBytes>{});
       });
     },
     send_again},
    {Fault::commit_record, [](Bench& b) { leave_and(b, [&] { b.unit.memory().corrupt(kCommitRecords.first, 0xFF); }); },
     send_again},
    {Fault::map_not_for_parameters,
     [](Bench& b) {
       UnitParameters linear = b.parameters;
       linear.scope = Scope::linear;
       auto image = image_of(linear, b.simulation.description().machine, asked_um, b.unit.settings().serial_number);
       write_parameters(image, b.parameters);
       seal_image(image);
       compensate_with(b, image);
     },
     send_again},
    {Fault::bad_parameters,
     [](Bench& b) {
       // the modules were committed in a rack of two, this one has one
       const auto image = image_with(b, [](UnitParameters& p) { p.memory_modules = 2; });
       leave_and(b, [&] { put_committed(b.unit.memory(), image); });
     },
     send_again},
    {Fault::compensation_output,
     [](Bench& b) {
       compensate_with(b, image_with(b, [](UnitParameters& p) { p.axes[0].output_limit_um = 5.0; }));
       b.reference_all();
       REQUIRE(b.simulation.move_to({-400.0, 0.0, 0.0}, 6000.0));
       REQUIRE(b.simulation.run_for(1.5));
     },
     send_again},
    {Fault::axis_module,
     [](Bench& b) {
       b.simulation.machine().axis(Axis::Y).lose_transducer(true);
       b.simulation.tick();
     },
     [](Bench& b) { b.simulation.machine().axis(Axis::Y).lose_transducer(false); }},
    {Fault::datum_sequence,
     [](Bench& b) {
       leave_and(b, [&] { b.simulation.machine().axis(Axis::X).lose_marker(true); });
       CHECK(!reference(b.simulation, {Axis::X}));  // an alarm of the control
       REQUIRE(b.simulation.dwell(60.0));
       CHECK(b.unit.status().axes[0].datum_failure == DatumFailure::no_marker);
     },
     [](Bench& b) { b.simulation.machine().axis(Axis::X).lose_marker(false); }},
    {Fault::loop_overrun,
     [](Bench& b) {
       b.unit.slow_down(5000.0);
       REQUIRE(b.simulation.run_for(0.01));
     },
     [](Bench& b) { b.unit.slow_down(0.0); }},
    {Fault::watchdog,
     [](Bench& b) {
       b.unit.hang();
       REQUIRE(b.simulation.run_for(0.2));
     },
     [](Bench& b) {
       b.unit.power(false);
       b.unit.power(true);
       b.simulation.tick();
     }},
    {Fault::position_jump,
     [](Bench& b) {
       b.simulation.machine().axis(Axis::X).miscount(10'000);
       b.simulation.tick();
     },
     [](Bench&) {}},
    {Fault::user_software,
     [](Bench& b) {
       REQUIRE(b.tell(CommandCode::enter_integration).state == CommandState::done);
       const std::vector<std::uint8_t> for_ever{0x60, 0xFE};  // bra.s *
       REQUIRE(b.unit.write_memory(kSystemRam.first + 0x8000, for_ever) == protocol::UnitError::none);
       auto result = b.unit.begin(
           protocol::Command{.code = CommandCode::run_user_software, .address = kSystemRam.first + 0x8000});
       for (int k = 0; k < 200'000 && result.state == CommandState::busy; ++k) {
         b.simulation.tick();
         result = b.unit.progress();
       }
       REQUIRE(result.state == CommandState::failed);
     },
     [](Bench&) {}},
};

}  // namespace

TEST_CASE("every fault of the unit isolates it, says why, and is recovered from") {
  for (const Case& one : kCases) {
    CAPTURE(name_of(UnitMode::integration));
    CAPTURE(text_of(one.fault).name);
    Bench bench;
    bench.compensate(asked_um);
    one.provoke(bench);
    CHECK(text_of(bench.unit.fault()).name == text_of(one.fault).name);
    CHECK(isolated(bench));
    CHECK(bench.unit.mode() == (one.fault == Fault::watchdog ? UnitMode::halted : UnitMode::integration));
    one.mend(bench);
    enter_again(bench);
    bench.reference_all();
    CHECK(bench.unit.mode() == UnitMode::compensating);
    CHECK(bench.unit.fault() == Fault::none);
    REQUIRE(bench.simulation.move_to({-400.0, 0.0, 0.0}, 6000.0));
    CHECK(std::abs(bench.unit.monitor().axes[0].compensation_um - 20.0) < 0.1);
  }
}

TEST_CASE("no fault is left out") {
  for (std::uint16_t f = 1; f < kFaultCount; ++f) {
    if (static_cast<Fault>(f) == Fault::live_input) continue;     // ends nothing (live_inputs_test.cpp)
    if (static_cast<Fault>(f) == Fault::unknown_input) continue;  // needs inputs or tools (tools_test.cpp)
    bool met = false;
    for (const Case& one : kCases) met = met || one.fault == static_cast<Fault>(f);
    CHECK_MESSAGE(met, text_of(static_cast<Fault>(f)).name);
  }
}

TEST_CASE("a resolver module takes two slots, and no rack has two modules in one") {
  const auto rack = rack_of(5, {Transducer::resolver, Transducer::encoder, Transducer::resolver});
  std::vector<int> taken(kRackSlots + 1, 0);
  int resolvers = 0;
  for (const RackModule& module : rack) {
    for (int slot = module.first_slot; slot < module.first_slot + module.slots; ++slot)
      ++taken.at(static_cast<std::size_t>(slot));
    if (module.name.starts_with("resolver")) {
      ++resolvers;
      CHECK(module.slots == 2);
    }
  }
  CHECK(resolvers == 2);
  for (const int modules : taken) CHECK(modules <= 1);
}

TEST_CASE_FIXTURE(Bench, "a module for the other kind of transducer is an axis module fault of that axis") {
  parameters.axes[1].transducer = Transducer::resolver;
  REQUIRE(stage_and_commit(this->image(asked_um)).state == CommandState::done);
  CHECK(tell(CommandCode::enter_compensation).state == CommandState::failed);
  CHECK(unit.fault() == Fault::axis_module);
  CHECK(unit.status().fault_axis == Axis::Y);
}

TEST_CASE_FIXTURE(
    Bench, "time that is left out never outruns the unit: an output at its limit faults while the workshop waits") {
  parameters.axes[0].output_limit_um = 19.5;
  compensate(asked_um);
  simulation.machine().move_to({-400.0, 0.0, 0.0}, 20'000.0);
  REQUIRE(simulation.run_while([&] { return !simulation.machine().arrived(); }));
  REQUIRE(unit.mode() == UnitMode::compensating);
  REQUIRE(simulation.dwell(3600.0));
  CHECK(unit.fault() == Fault::compensation_output);
}
