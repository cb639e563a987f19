#include "ecs_emulator/unit/datum_watch.hpp"

#include <functional>

#include "tests/ecs_emulator/support/emulated_unit.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

/// A wrong parameter, and what the unit says when the controller references the machine as it always does.
struct WrongParameter {
  std::string what;
  std::string machine;  ///< a line of [emulator.axis.X]
  std::function<void(AxisParameters&)> change;
  DatumFailure expected = DatumFailure::none;
};

const std::vector<WrongParameter> kWrong{
    {"initial state of the switch", "", [](auto& axis) { axis.datum.switch_initially_active = true; },
     DatumFailure::wrong_initial_state},
    {"polarity of the switch", "", [](auto& axis) { axis.datum.switch_polarity = -1; },
     DatumFailure::wrong_initial_state},
    {"approach direction", "", [](auto& axis) { axis.datum.approach_direction = Approach::reverse; },
     DatumFailure::wrong_direction},
    {"sign of the position scale", "", [](auto& axis) { axis.position_scale_um_per_count = -1.0; },
     DatumFailure::wrong_direction},
    {"fanuc where the controller backs off", "reference_kind = \"allen_bradley\"", [](auto&) {},
     DatumFailure::wrong_direction},
    {"fanuc where the controller stays on its switch", "reference_kind = \"siemens\"", [](auto&) {},
     DatumFailure::stopped_early},
    {"approach speed", "", [](auto& axis) { axis.datum.approach_speed_mm_min = 100.0; }, DatumFailure::too_fast},
    {"final state of the switch", "", [](auto& axis) { axis.datum.switch_finally_active = true; },
     DatumFailure::wrong_final_state},
    {"siemens where the controller goes through", "", [](auto& axis) { axis.datum.kind = DatumKind::siemens; },
     DatumFailure::wrong_final_state},
    {"allen_bradley where the controller goes through", "",
     [](auto& axis) { axis.datum.kind = DatumKind::allen_bradley; }, DatumFailure::no_reversal},
    {"a position scale 12 times too large", "",
     [](auto& axis) {
       axis.position_scale_um_per_count = 12.0;
       axis.datum.approach_speed_mm_min = 12'000.0;
     },
     DatumFailure::no_marker},
};

/// @param brought_back  the axis stands at its datum first and crosses its switch at rapid speed on its way back
void check_failure(const WrongParameter& wrong, bool brought_back) {
  CAPTURE(wrong.what);
  CAPTURE(brought_back);
  Bench bench(
      "", "configuration = \"TX\"\n[axis.X]\ntravel_mm = [-500.0, 0.0]\n[emulator.axis.X]\n" + wrong.machine + "\n");
  if (brought_back) bench.reference_all();
  wrong.change(bench.parameters.axes[0]);
  REQUIRE(bench.stage_and_commit(bench.flat_image(0.0)).state == CommandState::done);
  REQUIRE(bench.tell(CommandCode::enter_compensation).state == CommandState::done);
  bench.reference_all();
  REQUIRE(bench.simulation.run_for(kDatumGiveUp_s + 1.0));
  CHECK(bench.unit.mode() == UnitMode::integration);
  CHECK(bench.unit.fault() == Fault::datum_sequence);
  CHECK(bench.unit.status().fault_axis == Axis::X);
  CHECK(bench.unit.status().axes[0].datum_stage == DatumStage::failed);
  CHECK(name_of(bench.unit.status().axes[0].datum_failure) == name_of(wrong.expected));
}

}  // namespace

TEST_CASE("every wrong datum parameter ends in the failure that names it") {
  for (const WrongParameter& wrong : kWrong) check_failure(wrong, false);
}

TEST_CASE("a wrong datum parameter is named the same when the axis is first brought back across its switch") {
  for (const WrongParameter& wrong : kWrong)
    if (wrong.expected < DatumFailure::no_marker) check_failure(wrong, true);
}

TEST_CASE("every failure of the datum routine can be met") {
  for (int f = 1; f < kDatumFailureCount; ++f) {
    const auto is_it = [&](const WrongParameter& wrong) { return wrong.expected == static_cast<DatumFailure>(f); };
    CHECK_MESSAGE(std::any_of(kWrong.begin(), kWrong.end(), is_it), name_of(static_cast<DatumFailure>(f)));
  }
}
