#include "core/datum.hpp"

#include <cmath>

namespace ecs {
namespace {

void enter(DatumState& state, DatumStage stage, const DatumSignals& signals) noexcept {
  state.stage = stage;
  state.stage_began_at_mm = signals.travelled_mm;
}

void fail(DatumState& state, DatumFailure failure) noexcept {
  state.stage = DatumStage::failed;
  state.failure = failure;
}

Approach direction_of_motion(const DatumSignals& signals) noexcept {
  if (signals.speed_mm_min == 0.0) return Approach::unknown;
  return signals.speed_mm_min > 0.0 ? Approach::forward : Approach::reverse;
}

void wait(const DatumParameters& p, const DatumSignals& s, bool active, DatumState& state) noexcept {
  if (!state.began) {
    state.began = true;
    state.began_at_mm = s.travelled_mm;
  }
  if (std::abs(s.travelled_mm - state.began_at_mm) < kDatumStart_mm) return;
  if (active != p.switch_initially_active)
    fail(state, DatumFailure::wrong_initial_state);
  else
    enter(state, DatumStage::seeking_switch, s);
}

void seek_switch(const DatumParameters& p, const DatumSignals& s, bool active, DatumState& state) noexcept {
  if (active == p.switch_initially_active) return;
  if (direction_of_motion(s) != p.approach_direction)
    fail(state, DatumFailure::wrong_direction);
  else if (std::abs(s.speed_mm_min) > kFastestApproach * p.approach_speed_mm_min)
    fail(state, DatumFailure::too_fast);
  else
    enter(state, p.kind == DatumKind::siemens ? DatumStage::seeking_marker : DatumStage::on_switch, s);
}

void leave_switch(const DatumParameters& p, const DatumSignals& s, bool active, DatumState& state) noexcept {
  if (active != p.switch_initially_active) {  // still on it
    if (std::abs(s.travelled_mm - state.stage_began_at_mm) > kMarkerSearch_mm)
      fail(state, p.kind == DatumKind::allen_bradley ? DatumFailure::no_reversal : DatumFailure::no_marker);
    return;
  }
  const bool turned = direction_of_motion(s) != p.approach_direction;
  if (p.kind == DatumKind::allen_bradley && !turned)
    fail(state, DatumFailure::no_reversal);
  else if (p.kind == DatumKind::fanuc && turned)
    fail(state, DatumFailure::wrong_direction);
  else
    enter(state, DatumStage::seeking_marker, s);
}

void seek_marker(const DatumParameters& p, const DatumSignals& s, bool active, DatumState& state) noexcept {
  if (s.marker) {
    if (active != p.switch_finally_active) return fail(state, DatumFailure::wrong_final_state);
    state.datum_travelled_mm = s.marker_at_mm;
    state.direction = direction_of_motion(s);
    state.stage = DatumStage::done;
  } else if (std::abs(s.travelled_mm - state.stage_began_at_mm) > kMarkerSearch_mm) {
    fail(state, DatumFailure::no_marker);
  }
}

}  // namespace

void step_datum(const DatumParameters& parameters, const DatumSignals& signals, DatumState& state) noexcept {
  const bool active = signals.switch_closed == (parameters.switch_polarity > 0);
  switch (state.stage) {
    case DatumStage::waiting:
      return wait(parameters, signals, active, state);
    case DatumStage::seeking_switch:
      return seek_switch(parameters, signals, active, state);
    case DatumStage::on_switch:
      return leave_switch(parameters, signals, active, state);
    case DatumStage::seeking_marker:
      return seek_marker(parameters, signals, active, state);
    case DatumStage::done:
    case DatumStage::failed:
      return;
  }
}

}  // namespace ecs
