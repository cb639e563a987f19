// The bytes of a recorded datum sequence in the unit's system RAM (thesis 5.3, RECORD DATUM SEQUENCE): written by the
// unit, read by the host. Does not live here: what a sequence must look like (datum.hpp).
#pragma once

#include <cstdint>
#include <optional>

#include "core/address_map.hpp"
#include "core/bytes.hpp"

namespace ecs {

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
