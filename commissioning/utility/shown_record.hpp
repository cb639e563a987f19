// A datum record as figures: speed over time as in thesis figure 5.5, the switch and the marker, one or two records
// over each other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commissioning/plot/figure.hpp"
#include "commissioning/unit/datum_recording.hpp"

namespace ecs::commissioning {

/// A record with what is computed from it once.
struct ShownRecord {
  DatumRecording recording;
  std::vector<double> speeds_mm_min;
  std::vector<DatumEvent> events;
  std::string name;      ///< file, or "just recorded"
  double shift_s = 0.0;  ///< added to its times, to lay it over another
  [[nodiscard]] double end_s() const;
  /// Of the first sample at or after a time of the graph; their number where there is none.
  [[nodiscard]] std::size_t at_or_after(double time_s) const;
  /// The sample at this time of the graph; nothing outside the record.
  [[nodiscard]] std::optional<std::size_t> at(double time_s) const;
};
[[nodiscard]] ShownRecord shown(DatumRecording recording, std::string name);

/// The time at which the switch changes first; nothing if it never does.
[[nodiscard]] std::optional<double> first_switch_s(const ShownRecord& record);

/// Speed over time as a panel with no more points than can be told apart: the least and the largest of every stretch.
[[nodiscard]] PlotPanel speed_panel(const ShownRecord& first, const ShownRecord* second, double from_s, double to_s);

/// The whole figure for a file: speed, switch and marker.
[[nodiscard]] PlotFigure datum_figure(const ShownRecord& first, const ShownRecord* second);

/// What stands under the cursor: "1.234 s  X 1000.0 mm/min  12.3456 mm  switch closed  marker".
[[nodiscard]] std::string read_out_at(const ShownRecord& record, double time_s);

}  // namespace ecs::commissioning
