#include "ecs_emulator/unit/datum_recorder.hpp"

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

}  // namespace ecs::emulator
