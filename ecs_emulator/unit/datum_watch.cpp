#include "ecs_emulator/unit/datum_watch.hpp"

#include <array>
#include <cmath>

namespace ecs::emulator {

DatumRecorder::DatumRecorder(Axis axis, double period_us, double um_per_count) {
  const double periods = std::ceil(kDatumRecord_s * 1e6 / period_us);
  periods_per_sample_ = static_cast<std::uint32_t>(std::ceil(periods / kMostDatumSamples));
  header_ = {axis, 0, period_us * periods_per_sample_, um_per_count};
  wanted_ = static_cast<std::uint32_t>(periods) / periods_per_sample_;
}

void DatumRecorder::take(const AxisModule& module, UnitMemory& memory) {
  if (finished()) return;
  if (period_ == 0) first_counts_ = module.counts();
  marker_ = marker_ || module.marker();
  if (period_++ % periods_per_sample_ != 0) return;
  const DatumSample sample{static_cast<std::int32_t>(module.counts() - first_counts_), module.switch_closed(), marker_};
  marker_ = false;
  std::array<std::uint8_t, kDatumSampleBytes> bytes{};
  encode_datum_sample(sample, bytes);
  memory.write(datum_sample_address(header_.samples++), bytes);
  std::array<std::uint8_t, kDatumRecordHeaderBytes> head{};
  encode_datum_header(header_, head);
  memory.write(kDatumRecordAddress, head);
}

std::uint16_t DatumRecorder::per_mille() const {
  return static_cast<std::uint16_t>(header_.samples * 1000ull / wanted_);
}

namespace {

double onward_of(const DatumParameters& parameters) {
  return static_cast<double>(static_cast<std::int8_t>(parameters.approach_direction));
}

/// The switch is in the other state than the one in which the routine begins.
bool on_switch(const DatumParameters& parameters, const DatumSignals& signals) {
  return (signals.switch_closed == (parameters.switch_polarity > 0)) != parameters.switch_initially_active;
}

/// Failures that being brought back across the switch can cause.
bool early(DatumFailure failure) {
  return failure == DatumFailure::wrong_initial_state || failure == DatumFailure::wrong_direction;
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
      const bool wait = state_.failure == DatumFailure::too_fast || (brought_back && early(state_.failure));
      (wait ? pending_ : final_) = state_.failure;
      retry_from_mm_ = signals.travelled_mm;
    }
  } else if (state_.failure == DatumFailure::too_fast) {
    look_for_other_way(parameters, signals);
  } else {
    look_for_retry(parameters, signals);
  }
  was_on_switch_ = on_switch(parameters, signals);
  give_up_if_still(signals, period_s);
}

void DatumWatch::look_for_retry(const DatumParameters& parameters, const DatumSignals& signals) {
  if (signals.speed_mm_min * onward_of(parameters) <= 0.0 || on_switch(parameters, signals))
    retry_from_mm_ = signals.travelled_mm;
  else if (std::abs(signals.travelled_mm - retry_from_mm_) >= kDatumRetry_mm)
    state_ = DatumState{};
}

void DatumWatch::look_for_other_way(const DatumParameters& parameters, const DatumSignals& signals) {
  if (was_on_switch_ || !on_switch(parameters, signals)) return;
  const bool other_way = signals.speed_mm_min * onward_of(parameters) < 0.0;
  const bool slow = std::abs(signals.speed_mm_min) <= kFastestApproach * parameters.approach_speed_mm_min;
  finish(other_way && slow ? DatumFailure::wrong_direction : DatumFailure::too_fast);
}

void DatumWatch::finish(DatumFailure failure) {
  final_ = failure;
  state_.stage = DatumStage::failed;
  state_.failure = failure;
}

void DatumWatch::give_up_if_still(const DatumSignals& signals, double period_s) {
  still_s_ = signals.speed_mm_min == 0.0 ? still_s_ + period_s : 0.0;
  if (!counting() || still_s_ < kDatumGiveUp_s) return;
  if (state_.stage == DatumStage::seeking_marker) return finish(DatumFailure::no_marker);
  finish(pending_ == DatumFailure::none ? DatumFailure::stopped_early : pending_);
}

bool DatumWatch::counting() const {
  if (done() || final_ != DatumFailure::none) return false;
  return pending_ != DatumFailure::none || state_.stage == DatumStage::on_switch ||
         state_.stage == DatumStage::seeking_marker;
}

}  // namespace ecs::emulator
