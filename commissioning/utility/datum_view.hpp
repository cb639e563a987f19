// DISPLAY DATUM SEQUENCE: one or two records as figures (speed over time as in thesis figure 5.5, the switch and the
// marker), the time that is seen, the cursor, files. A fresh record is kept on disc as a draft until it is saved.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commissioning/plot/figure.hpp"
#include "commissioning/plot/picture_export.hpp"
#include "commissioning/session/drafts.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"
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

/// When the record was made that nobody has saved yet, local time; empty: there is none.
[[nodiscard]] std::string unsaved_record_of();

class DatumViewController {
 public:
  DatumViewController();

  // --- records
  /// A fresh record: unsaved, kept as a draft.
  void take(DatumRecording recording);
  void open(const std::string& path);
  /// Laid over the first; a third takes the place of the second.
  void overlay(const std::string& path);
  void drop_overlay();
  /// The second shifted so that the switches change first at the same time; again: back.
  void align();
  void save(const std::string& path);
  void export_picture(FigureWriter write);
  [[nodiscard]] const std::optional<Draft>& draft() const { return draft_; }  ///< of an earlier context, not taken up
  void take_draft();
  void drop_earlier_draft();

  // --- the time that is seen
  void move_cursor(int direction, int columns);
  void zoom(double factor);
  void whole();
  [[nodiscard]] double from_s() const { return from_s_; }
  [[nodiscard]] double to_s() const { return to_s_; }
  [[nodiscard]] std::optional<double> cursor_s() const { return cursor_s_; }
  void go_to(double time_s);

  [[nodiscard]] bool advance();
  [[nodiscard]] bool busy() const { return file_task_.running(); }
  [[nodiscard]] const ShownRecord* first() const { return first_ ? &*first_ : nullptr; }
  [[nodiscard]] const ShownRecord* second() const { return second_ ? &*second_ : nullptr; }
  [[nodiscard]] const PlotPanel& panel() const { return panel_; }
  [[nodiscard]] bool saved() const { return saved_; }
  [[nodiscard]] std::string proposed_name() const;  ///< for a file
  [[nodiscard]] Message& message() { return message_; }
  [[nodiscard]] const Message& message() const { return message_; }

 private:
  void read(const std::string& path, bool as_overlay);
  void take_read(ShownRecord record, bool as_overlay);
  void show_all();
  void redraw();
  void keep_fresh_draft();
  void note_saved(const std::string& path);

  std::optional<ShownRecord> first_;
  std::optional<ShownRecord> second_;
  std::optional<Draft> draft_;
  bool saved_ = true;
  bool fresh_ = false;   ///< recorded by a command that was noted without a file
  std::string in_file_;  ///< where the first record lies; empty: in no file
  double from_s_ = 0.0;
  double to_s_ = 10.0;
  std::optional<double> cursor_s_;
  PlotPanel panel_;
  Message message_;
  TaskRunner drawing_;
  TaskRunner file_task_;
  TaskRunner drafting_;
};

}  // namespace ecs::commissioning
