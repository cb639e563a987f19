// DISPLAY DATUM SEQUENCE: one or two records, the time that is seen, the cursor, files. A fresh record is kept on disc
// as a draft until it is saved.
#pragma once

#include <optional>
#include <string>

#include "commissioning/plot/picture_export.hpp"
#include "commissioning/session/drafts.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"
#include "commissioning/utility/shown_record.hpp"

namespace ecs::commissioning {

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
