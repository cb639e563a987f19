#include "ecs_emulator/datum_watch.hpp"

#include <cmath>

namespace ecs::emulator {
namespace {

double onward_of(const DatumParameters& parameters) {
  return static_cast<double>(static_cast<std::int8_t>(parameters.approach_direction));
}

}  // namespace

void DatumWatch::step(const DatumParameters& parameters, const AxisModule& module, double mm_per_count,
                      double period_s) {
  if (done() || final_ != DatumFailure::none) return;
  const DatumSignals signals{static_cast<double>(module.counts()) * mm_per_count,
                             module.speed() * mm_per_count / period_s * 60.0, module.switch_closed(), module.marker(),
                             static_cast<double>(module.marker_counts()) * mm_per_count};
  if (state_.stage != DatumStage::failed) {
    step_datum(parameters, signals, state_);
    if (state_.stage == DatumStage::failed) {
      const bool brought_back = signals.speed_mm_min * onward_of(parameters) < 0.0;
      const bool early =
          state_.failure == DatumFailure::wrong_initial_state || state_.failure == DatumFailure::wrong_direction;
      (brought_back && early ? pending_ : final_) = state_.failure;
      retry_from_mm_ = signals.travelled_mm;
    }
  } else {
    look_for_retry(parameters, signals);
  }
  give_up_if_still(signals, period_s);
}

void DatumWatch::look_for_retry(const DatumParameters& parameters, const DatumSignals& signals) {
  const bool active = signals.switch_closed == (parameters.switch_polarity > 0);
  if (signals.speed_mm_min * onward_of(parameters) <= 0.0 || active != parameters.switch_initially_active)
    retry_from_mm_ = signals.travelled_mm;
  else if (std::abs(signals.travelled_mm - retry_from_mm_) >= kDatumRetry_mm)
    state_ = DatumState{};
}

void DatumWatch::give_up_if_still(const DatumSignals& signals, double period_s) {
  still_s_ = signals.speed_mm_min == 0.0 ? still_s_ + period_s : 0.0;
  if (pending_ == DatumFailure::none || done() || still_s_ < kDatumGiveUp_s) return;
  final_ = pending_;
  state_.stage = DatumStage::failed;
  state_.failure = pending_;
}

}  // namespace ecs::emulator
