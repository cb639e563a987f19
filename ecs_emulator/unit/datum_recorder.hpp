// RECORD DATUM SEQUENCE: ten seconds of one axis into system RAM (thesis 5.3; bytes in core/datum.hpp).
#pragma once

#include "core/datum.hpp"
#include "ecs_emulator/unit/axis_module.hpp"
#include "ecs_emulator/unit/memory.hpp"

namespace ecs::emulator {

class DatumRecorder {
 public:
  /// A sample every period, or every few periods if ten seconds of them would not fit.
  DatumRecorder(Axis axis, double period_us, double um_per_count);

  /// One period of the axis.
  void take(const AxisModule& module, UnitMemory& memory);

  [[nodiscard]] Axis axis() const { return header_.axis; }
  [[nodiscard]] bool finished() const { return header_.samples >= wanted_; }
  [[nodiscard]] std::uint16_t per_mille() const;

 private:
  DatumRecordHeader header_;
  std::uint32_t periods_per_sample_ = 1;
  std::uint32_t wanted_ = 0;
  std::uint32_t period_ = 0;
  bool marker_ = false;
  std::int64_t first_counts_ = 0;
};

}  // namespace ecs::emulator
