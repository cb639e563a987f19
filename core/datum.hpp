// The datum routine of one axis: the unit watches the CNC reference the machine and finds the same marker (thesis 5.3).
// And the bytes of a recorded datum sequence in the unit's system RAM (RECORD DATUM SEQUENCE): written by the unit,
// read by the host.
#pragma once

#include <cstdint>
#include <optional>

#include "core/address_map.hpp"
#include "core/bytes.hpp"
#include "core/fault.hpp"
#include "core/parameters.hpp"

namespace ecs {

/// What one axis module shows in one period.
struct DatumSignals {
  double travelled_mm = 0.0;   ///< transducer position, any origin, sign as the machine coordinate
  double speed_mm_min = 0.0;   ///< signed
  bool switch_closed = false;  ///< as wired; the switch polarity says what it means
  bool marker = false;         ///< the marker passed since the last period
  double marker_at_mm = 0.0;   ///< travelled_mm at that marker
};

struct DatumState {
  DatumStage stage = DatumStage::waiting;
  DatumFailure failure = DatumFailure::none;
  double began_at_mm = 0.0;  ///< where the axis stood when the routine began
  bool began = false;
  double stage_began_at_mm = 0.0;
  double datum_travelled_mm = 0.0;         ///< travelled_mm at the datum marker, once done
  Approach direction = Approach::unknown;  ///< direction of motion at the marker, once done
};

/// Motion below this distance is no start of the reference motion.
inline constexpr double kDatumStart_mm = 0.05;
/// Times the approach speed: an axis faster than this on its switch is too fast.
inline constexpr double kFastestApproach = 1.5;
/// No marker, or no end of the switch, within this travel fails the routine (several turns of any ordinary screw).
inline constexpr double kMarkerSearch_mm = 100.0;

/// One period of the routine. Total: it waits as long as the axis has not reached its switch, or is at rest; from the
/// switch on it ends in done or failed within 2 × kMarkerSearch_mm.
void step_datum(const DatumParameters& parameters, const DatumSignals& signals, DatumState& state) noexcept;

/// Machine coordinate at the datum marker: the reference position lies `null_offset_mm` beyond the marker.
[[nodiscard]] constexpr double marker_position_mm(const DatumParameters& parameters) noexcept {
  return parameters.reference_position_mm - parameters.null_offset_mm;
}

inline constexpr Address kDatumRecordAddress = kSystemRam.first + 0x1000;
inline constexpr std::uint32_t kDatumRecordMagic = 0x45445251;  // "EDRQ"
inline constexpr std::uint32_t kDatumRecordHeaderBytes = 32;
inline constexpr std::uint32_t kDatumSampleBytes = 5;
inline constexpr std::uint32_t kMostDatumSamples = 11'000;
inline constexpr double kDatumRecord_s = 10.0;
static_assert(0x1000 + kDatumRecordHeaderBytes + kMostDatumSamples * kDatumSampleBytes <= kSystemRam.size);

/// magic (4) | axis (1) | zero (3) | samples (4) | zero (4) | sample period [us], double | um per count, double
struct DatumRecordHeader {
  Axis axis = Axis::X;
  std::uint32_t samples = 0;
  double sample_period_us = 0.0;
  double um_per_count = 1.0;  ///< position feedback scaling factor at the time
  friend bool operator==(const DatumRecordHeader&, const DatumRecordHeader&) = default;
};

/// counts since the first sample (4, signed) | flags (1): bit 0 switch closed, bit 1 marker since the sample before
struct DatumSample {
  std::int32_t counts = 0;
  bool switch_closed = false;
  bool marker = false;
  friend bool operator==(const DatumSample&, const DatumSample&) = default;
};

/// @pre bytes.size() >= kDatumRecordHeaderBytes
inline void encode_datum_header(const DatumRecordHeader& header, Bytes bytes) noexcept {
  store_big(bytes, 0, kDatumRecordMagic);
  store_big(bytes, 4, static_cast<std::uint32_t>(header.axis) << 24);
  store_big(bytes, 8, header.samples);
  store_big(bytes, 12, std::uint32_t{0});
  store_double(bytes, 16, header.sample_period_us);
  store_double(bytes, 24, header.um_per_count);
}

/// Nothing if there is no record. @pre bytes.size() >= kDatumRecordHeaderBytes
[[nodiscard]] inline std::optional<DatumRecordHeader> decode_datum_header(ByteView bytes) noexcept {
  if (load_big<std::uint32_t>(bytes, 0) != kDatumRecordMagic || bytes[4] >= kAxes) return std::nullopt;
  const DatumRecordHeader header{static_cast<Axis>(bytes[4]), load_big<std::uint32_t>(bytes, 8), load_double(bytes, 16),
                                 load_double(bytes, 24)};
  if (header.samples > kMostDatumSamples || !(header.sample_period_us > 0.0)) return std::nullopt;
  return header;
}

/// @pre bytes.size() >= kDatumSampleBytes
inline void encode_datum_sample(const DatumSample& sample, Bytes bytes) noexcept {
  store_big(bytes, 0, static_cast<std::uint32_t>(sample.counts));
  bytes[4] = static_cast<std::uint8_t>((sample.switch_closed ? 1u : 0u) | (sample.marker ? 2u : 0u));
}
[[nodiscard]] inline DatumSample decode_datum_sample(ByteView bytes) noexcept {
  return {static_cast<std::int32_t>(load_big<std::uint32_t>(bytes, 0)), (bytes[4] & 1u) != 0, (bytes[4] & 2u) != 0};
}

/// Address of sample `index`.
[[nodiscard]] constexpr Address datum_sample_address(std::uint32_t index) noexcept {
  return kDatumRecordAddress + kDatumRecordHeaderBytes + index * kDatumSampleBytes;
}

}  // namespace ecs
