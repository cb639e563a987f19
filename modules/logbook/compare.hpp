// What has changed at a machine between two days: its curves, the causes that were found, the error in its volume.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "modules/logbook/replay.hpp"
#include "modules/logbook/store.hpp"

namespace ecs::commissioning {

/// One curve or squareness on both days; the error, not the compensation.
struct ComparedCurve {
  std::string component;
  std::string unit;
  std::array<std::optional<double>, 2> largest;  ///< size of the largest error; nothing: not measured then
  std::optional<double> largest_change;          ///< anywhere along the travel of both
  std::optional<double> change_rms;
};

struct ComparedCause {
  std::string name;  ///< "cyclic:X:EX"
  /// As the diagnosis of each day says it, "period_mm 8 amplitude_um 3.2"; nothing: not named then.
  std::array<std::optional<std::string>, 2> parameters;
};

/// Error vector over the working volume.
struct ComparedVolume {
  std::optional<double> before_largest_um, before_rms_um, after_largest_um, after_rms_um;
};

/// What is known of the machine on one day.
struct LoggedState {
  std::string date;
  std::optional<LogbookEntry> map;        ///< the last that was built by then
  std::optional<LogbookEntry> diagnosis;  ///< the last diagnosis or investigation
  std::optional<ComparedVolume> volume;
};

struct LogComparison {
  std::array<LoggedState, 2> states;
  std::vector<ComparedCurve> curves;  ///< largest change first
  std::vector<ComparedCause> causes;
  std::vector<std::string> notes;  ///< what could not be compared, and why
};

/// @param from, to  ISO dates: what was known at the end of that day, or at that time
[[nodiscard]] Result<LogComparison> compared(const Logbook& book, const std::string& from, const std::string& to,
                                             const RunVerb& run);

}  // namespace ecs::commissioning
