// One or two records of datum sequences as figures (speed over time as in thesis figure 5.5, the switch and the
// marker), the time of them that is seen, and what a record tells.
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

/// What a record tells about the datuming parameters, in sentences that name them.
[[nodiscard]] std::vector<std::string> datuming_hints(const ShownRecord& record);

/// Of the draft of a record that nobody has saved yet.
inline constexpr const char* kRecordDraft = "datum-sequence";
/// When that was made, local time; empty: there is none.
[[nodiscard]] std::string unsaved_record_of();

/// The time of a graph that is seen, and the cursor in it.
struct SeenTime {
  double least_s = 0.0, most_s = 10.0;  ///< of the records
  double from_s = 0.0, to_s = 10.0;     ///< that are seen
  std::optional<double> cursor_s;

  /// All of the records. @param second  null: there is none
  void show_all(const ShownRecord& first, const ShownRecord* second);
  /// The cursor there, in the middle of what is seen if it was outside.
  void go_to(double time_s);
  /// By this many of the steps of which 70 are seen, but by whole samples; into the middle where there was no cursor.
  void move_cursor(int steps, double sample_s);
  /// Around the cursor, else around the middle. @param factor  of the time that is seen
  void zoom(double factor);

 private:
  void see_all();
};

}  // namespace ecs::commissioning
