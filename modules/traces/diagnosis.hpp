// Which constant of a servo axis is wrong, from one recorded step: every constant tried as a factor, constants that the
// recording cannot tell apart as one group, and the signals that would tell them apart.
// Does not live here: how it is shown (modules/traces/compare_trace.cpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "modules/traces/trace.hpp"

namespace ecs::model {

enum class DriveVerdict : std::uint8_t {
  agrees,           ///< the simulation as given differs from the recording by noise alone
  wrong_constant,   ///< one constant, or one group that acts as one, explains the difference
  wrong_constants,  ///< two together do, no single one does
  unexplained,      ///< neither one nor two do
};
[[nodiscard]] std::string_view name_of(DriveVerdict verdict);

/// One constant of a candidate with the value it would need while all others are right.
struct DriveChange {
  DriveConstant constant = DriveConstant::Kd;
  double factor = 1.0;  ///< on the value given
  double value = 0.0;
  double sigma = 0.0;      ///< standard deviation of the value
  double rms_after = 0.0;  ///< of dac_V with this change alone, V; of a pair: with both
};

/// One member of a group against its first member: another signal, simulated with each of them mended.
struct MemberDifference {
  DriveConstant member = DriveConstant::Kd;
  double relative = 0.0;  ///< rms of the difference over the smaller rms of the two
  double peak = 0.0;      ///< largest size of the signal with this member mended
};
struct SignalDifference {
  DriveSignal signal = DriveSignal::tacho;
  double peak = 0.0;                      ///< with the first member mended
  std::vector<MemberDifference> members;  ///< all but the first
  /// Least over the members: kClearDifference and more distinguishes the first from all others.
  [[nodiscard]] double least() const;
};

struct DriveCandidate {
  std::vector<DriveChange> alternatives;  ///< the group: each alone does; best first. Of a pair: both together
  bool together = false;                  ///< a pair: both are changed
  bool explains = false;                  ///< what is left is noise
  double rms_after_V = 0.0;
  double cost = 0.0;
  std::vector<DriveConstant> like_first;   ///< of a pair: constants that may stand for the first
  std::vector<DriveConstant> like_second;  ///< and for the second
  std::vector<DriveSignal> separated_by;   ///< signals that tell the members of the group apart
  std::vector<SignalDifference> signals;   ///< all that were not recorded, largest least() first
};

struct DriveDiagnosis {
  std::size_t observations = 0;
  double rms_V = 0.0;  ///< dac_V, recorded less simulated as given
  double noise_V = 0.0;
  double floor_V = 0.0;  ///< an rms up to this counts as noise: recorder, whole pulses
  DriveVerdict verdict = DriveVerdict::agrees;
  StepShape measured, as_given, mended;
  double start_s = 0.0;                      ///< of the move on the recorder's clock, as found for the mended axis
  std::vector<DriveCandidate> candidates;    ///< best first; empty where the recording agrees
  std::vector<DriveConstant> silent;         ///< the recording says nothing about these
  std::vector<double> as_given_V, mended_V;  ///< simulated dac_V at the samples
  std::vector<std::string> notes;
};

/// Two mended axes whose signals differ by this share of their rms are distinguished at a glance: a choice.
inline constexpr double kClearDifference = 0.25;

[[nodiscard]] DriveDiagnosis diagnose_drive(const DriveParameters& drive, const DriveTrace& trace);

}  // namespace ecs::model
