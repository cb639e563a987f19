// Recorded steps of a servo axis: signals against time with the move that was demanded, and the figures that a person
// reads off them. Does not live here: simulating the axis (simulation.hpp).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "modules/traces/simulation.hpp"

namespace ecs::model {

struct RecordedSignal {
  DriveSignal id = DriveSignal::dac;
  std::vector<double> value;            ///< in the signal's unit, one per sample
  double quantum = 0.0;                 ///< step of the recorder; 0: finer than the noise
  double noise = 0.0;                   ///< standard deviation of one sample, > 0
  std::optional<double> clipped_above;  ///< the recorder shows no more than this
  std::optional<double> clipped_below;
};

struct DriveTrace {
  std::string source;
  DriveMove move;
  std::vector<double> time_s;           ///< ascending; where the recorder was triggered is not known
  std::vector<RecordedSignal> signals;  ///< dac_V first
  std::vector<std::string> notes;       ///< what was assumed, in words
  [[nodiscard]] const RecordedSignal& dac() const { return signals.front(); }
};

/// True for a file whose header row has time_s and dac_V.
[[nodiscard]] bool is_drive_trace(std::string_view text);

/// Reads `# feed_mm_min:`, `# distance_mm:`, optionally `# full_scale_V:` (the recorder clips there), a header row with
/// time_s, dac_V and any other of drive_signals(), then samples. Other columns are left out, and said. Refuses, every
/// bad row at once: cells that are no finite numbers, rows of another length, times that do not ascend, a missing feed
/// or distance, fewer than 20 samples, a signal that never changes.
[[nodiscard]] Result<DriveTrace> parse_trace(std::string_view text, const std::string& file_name);
[[nodiscard]] Result<DriveTrace> read_trace(const std::filesystem::path& path);

/// What a person reads off the curve of a step; absent where it cannot be seen.
struct StepShape {
  std::optional<double> start_s;        ///< the response begins, on the recorder's clock
  std::optional<double> steady;         ///< level of the plateau
  std::optional<double> rise_s;         ///< from 10 % to 90 % of the level
  std::optional<double> decay_start_s;  ///< from the start of the response to the end of the plateau
  std::optional<double> fall_s;         ///< from 90 % to 10 %
};
/// @param noise  standard deviation of one sample
[[nodiscard]] StepShape shape_of(const std::vector<double>& time_s, const std::vector<double>& value, double noise);

}  // namespace ecs::model
