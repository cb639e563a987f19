// Watching one axis being referenced: the routine of core/datum.hpp and when to begin it again or give it up; and
// RECORD DATUM SEQUENCE, ten seconds of one axis into system RAM (thesis 5.3; bytes in core/datum.hpp).
#pragma once

#include "core/datum.hpp"
#include "ecs_emulator/unit/memory.hpp"
#include "ecs_emulator/unit/rack.hpp"

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

/// Motion this long in the approach direction, switch in its initial state, begins the routine again after a failure
/// that happened while the axis was brought back.
inline constexpr double kDatumRetry_mm = 5.0;
/// An axis that has failed, or has come to its switch, and then stands still so long is given up.
inline constexpr double kDatumGiveUp_s = 30.0;

class DatumWatch {
 public:
  /// One period. The machine may first be brought back across its switch, against the approach direction: what fails
  /// then is started again when the axis comes back the right way. A switch reached too fast may be the same motion
  /// seen with the wrong approach direction: the next time that it is reached, slowly and the other way, the failure is
  /// `wrong_direction`. Every other failure is final at once.
  void step(const DatumParameters& parameters, const AxisModule& module, double mm_per_count, double period_s);

  [[nodiscard]] const DatumState& state() const { return state_; }
  /// Its time runs: standing still ends it.
  [[nodiscard]] bool counting() const;
  [[nodiscard]] bool done() const { return state_.stage == DatumStage::done; }
  /// The failure that ended the routine; none while it goes on.
  [[nodiscard]] DatumFailure final_failure() const { return final_; }

 private:
  void look_for_retry(const DatumParameters& parameters, const DatumSignals& signals);
  void look_for_other_way(const DatumParameters& parameters, const DatumSignals& signals);
  void finish(DatumFailure failure);
  void give_up_if_still(const DatumSignals& signals, double period_s);

  DatumState state_;
  DatumFailure pending_ = DatumFailure::none;
  DatumFailure final_ = DatumFailure::none;
  double retry_from_mm_ = 0.0;
  bool was_on_switch_ = true;  ///< switch not in its initial state a period ago
  double still_s_ = 0.0;
};

}  // namespace ecs::emulator
