// The datum routine: the right sequence of each kind of controller, every failure, and no endless search.
#include "core/datum.hpp"

#include "tests/support/test.hpp"

using namespace ecs;

namespace {

/// An axis with a reference switch between two positions and a marker every 10 mm, driven in steps of 10 um.
struct ReferenceRun {
  DatumParameters parameters;
  double switch_from_mm = 50.0;
  double switch_to_mm = 58.0;
  std::optional<double> marker_pitch_mm = 10.0;  ///< markers at 3 mm + n · pitch
  bool switch_inverted = false;

  DatumState state;
  double at_mm = 0.0;

  void drive_to(double target_mm, double speed_mm_min) {
    const double direction = target_mm > at_mm ? 1.0 : -1.0;
    const auto steps = static_cast<int>(std::lround(std::abs(target_mm - at_mm) / 0.01));
    for (int i = 0; i < steps; ++i) {
      const double before_mm = at_mm;
      at_mm += direction * 0.01;
      step_datum(parameters, signals(before_mm, direction * speed_mm_min), state);
    }
  }
  void stand(int periods) {
    for (int i = 0; i < periods; ++i) step_datum(parameters, signals(at_mm, 0.0), state);
  }

 private:
  DatumSignals signals(double before_mm, double speed_mm_min) const {
    DatumSignals s{.travelled_mm = at_mm, .speed_mm_min = speed_mm_min};
    const bool on_it = at_mm >= switch_from_mm && at_mm <= switch_to_mm;
    s.switch_closed = on_it != switch_inverted;
    if (marker_pitch_mm) {
      const double first = std::floor((before_mm - 3.001) / *marker_pitch_mm);
      const double then = std::floor((at_mm - 3.001) / *marker_pitch_mm);
      s.marker = first != then;
      s.marker_at_mm = 3.0 + *marker_pitch_mm * std::max(first, then);
    }
    return s;
  }
};

ReferenceRun fanuc() { return {}; }
ReferenceRun allen_bradley() {
  ReferenceRun run;
  run.parameters.kind = DatumKind::allen_bradley;
  return run;
}
ReferenceRun siemens() {
  ReferenceRun run;
  run.parameters.kind = DatumKind::siemens;
  run.parameters.switch_finally_active = true;
  return run;
}

void check_done(const ReferenceRun& run, double marker_mm, Approach direction) {
  CHECK(run.state.stage == DatumStage::done);
  CHECK(run.state.failure == DatumFailure::none);
  CHECK(run.state.datum_travelled_mm == Approx(marker_mm));
  CHECK(run.state.direction == direction);
}
void check_failed(const ReferenceRun& run, DatumFailure failure) {
  CHECK(run.state.stage == DatumStage::failed);
  CHECK(run.state.failure == failure);
}

}  // namespace

TEST_CASE("Fanuc: through the switch, the first marker after leaving it") {
  ReferenceRun run = fanuc();
  run.drive_to(90.0, 800.0);
  check_done(run, 63.0, Approach::forward);
}

TEST_CASE("Fanuc: the same in the reverse direction") {
  ReferenceRun run = fanuc();
  run.parameters.approach_direction = Approach::reverse;
  run.at_mm = 100.0;
  run.drive_to(0.0, 800.0);
  check_done(run, 43.0, Approach::reverse);
}

TEST_CASE("Allen-Bradley: onto the switch, back off it, the first marker on the way back") {
  ReferenceRun run = allen_bradley();
  run.drive_to(55.0, 800.0);
  CHECK(run.state.stage == DatumStage::on_switch);
  run.stand(100);
  run.drive_to(20.0, 100.0);
  check_done(run, 43.0, Approach::reverse);
}

TEST_CASE("Siemens: the first marker while still on the switch") {
  ReferenceRun run = siemens();
  run.drive_to(90.0, 800.0);
  check_done(run, 53.0, Approach::forward);
}

TEST_CASE("an open switch may mean active") {
  ReferenceRun run = fanuc();
  run.switch_inverted = true;
  run.parameters.switch_polarity = -1;
  run.drive_to(90.0, 800.0);
  check_done(run, 63.0, Approach::forward);
}

TEST_CASE("a switch that is active until it is reached works as well") {
  ReferenceRun run = fanuc();
  run.switch_inverted = true;
  run.parameters.switch_initially_active = true;
  run.parameters.switch_finally_active = true;
  run.drive_to(90.0, 800.0);
  check_done(run, 63.0, Approach::forward);
}

TEST_CASE("jogging about before the reference motion does no harm, nor does a fast traverse off the switch") {
  ReferenceRun run = fanuc();
  run.drive_to(30.0, 8000.0);
  run.drive_to(-40.0, 8000.0);
  run.drive_to(90.0, 1400.0);
  check_done(run, 63.0, Approach::forward);
}

TEST_CASE("the datum routine waits for an axis at rest") {
  ReferenceRun run = fanuc();
  run.stand(100'000);
  CHECK(run.state.stage == DatumStage::waiting);
  run.drive_to(0.04, 10.0);  // less than a start
  CHECK(run.state.stage == DatumStage::waiting);
}

TEST_CASE("the reference motion begins 0.05 mm from where the axis stood") {
  ReferenceRun run = fanuc();
  run.stand(1);
  run.drive_to(0.04, 300);
  CHECK(run.state.stage == DatumStage::waiting);
  run.drive_to(0.06, 300);
  CHECK(run.state.stage == DatumStage::seeking_switch);
}

TEST_CASE("a routine that begins on the switch fails: wrong initial state") {
  ReferenceRun run = fanuc();
  run.at_mm = 55.0;
  run.drive_to(90.0, 800.0);
  check_failed(run, DatumFailure::wrong_initial_state);
}

TEST_CASE("a switch reached from the other side fails: wrong direction") {
  ReferenceRun run = fanuc();
  run.at_mm = 90.0;
  run.drive_to(0.0, 800.0);
  check_failed(run, DatumFailure::wrong_direction);
}

TEST_CASE("Fanuc: turning back on the switch fails: wrong direction") {
  ReferenceRun run = fanuc();
  run.drive_to(55.0, 800.0);
  run.drive_to(0.0, 800.0);
  check_failed(run, DatumFailure::wrong_direction);
}

TEST_CASE("a switch reached faster than 1.5 times the approach speed fails: too fast") {
  ReferenceRun run = fanuc();
  run.parameters.approach_speed_mm_min = 500.0;
  run.drive_to(90.0, 751.0);
  check_failed(run, DatumFailure::too_fast);
  ReferenceRun slower = fanuc();
  slower.parameters.approach_speed_mm_min = 500.0;
  slower.drive_to(90.0, 749.0);
  check_done(slower, 63.0, Approach::forward);
}

TEST_CASE("a marker off the switch fails where it should come on it: wrong final state") {
  ReferenceRun run = siemens();
  run.switch_to_mm = 51.0;
  run.drive_to(90.0, 800.0);
  check_failed(run, DatumFailure::wrong_final_state);
}

TEST_CASE("Allen-Bradley: running on through the switch fails: no reversal") {
  ReferenceRun run = allen_bradley();
  run.drive_to(90.0, 800.0);
  check_failed(run, DatumFailure::no_reversal);
}

TEST_CASE("no marker within 100 mm fails: no marker") {
  ReferenceRun run = fanuc();
  run.marker_pitch_mm.reset();
  run.drive_to(157.9, 800.0);
  CHECK(run.state.stage == DatumStage::seeking_marker);
  run.drive_to(158.5, 800.0);
  check_failed(run, DatumFailure::no_marker);
}

TEST_CASE("a switch that never lets go ends the routine after 100 mm") {
  for (const bool back : {false, true}) {
    ReferenceRun run = back ? allen_bradley() : fanuc();
    run.switch_to_mm = 1e9;
    run.drive_to(149.0, 800.0);
    CHECK(run.state.stage == DatumStage::on_switch);
    run.drive_to(151.0, 800.0);
    check_failed(run, back ? DatumFailure::no_reversal : DatumFailure::no_marker);
  }
}

TEST_CASE("once done or failed, nothing changes the result") {
  ReferenceRun done = fanuc();
  done.drive_to(300.0, 800.0);
  done.drive_to(0.0, 8000.0);
  check_done(done, 63.0, Approach::forward);
  ReferenceRun failed = fanuc();
  failed.drive_to(90.0, 5000.0);
  failed.drive_to(0.0, 800.0);
  failed.drive_to(90.0, 800.0);
  check_failed(failed, DatumFailure::too_fast);
}

TEST_CASE("the marker lies the null offset before the reference position") {
  DatumParameters p{.null_offset_mm = 2.5, .reference_position_mm = -10.0};
  CHECK(marker_position_mm(p) == -12.5);
}
