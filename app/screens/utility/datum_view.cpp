// DISPLAY DATUM SEQUENCE: the graph of thesis figure 5.5 with cursor and zoom, the events, a second record over it. A
// fresh record is kept on disc as a draft until it is saved.
#include "commissioning/utility/datum_view.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "app/plot/gnuplot.hpp"
#include "app/screens/utility/parts.hpp"
#include "app/screens/utility/screens.hpp"
#include "app/ui/cells.hpp"
#include "app/ui/chart.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/plot/picture_export.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/session/remembered.hpp"

namespace ecs::app {
namespace {

constexpr int kAxisColumns = 9;  ///< as app/ui/chart.cpp leaves them

/// One lane: a cell is marked where the signal was there at any time of its stretch.
void draw_lane(Canvas& canvas, const Area& lane, const std::string& label, const ShownRecord& record,
               bool DatumSample::*signal, const SeenTime& seen, char32_t on, char32_t off) {
  canvas.text({lane.row, lane.column, 1, kAxisColumns}, 0, 0, label, Tone::faint);
  const int columns = lane.columns - kAxisColumns;
  for (int c = 0; c < columns; ++c) {
    const double t = seen.from_s + (seen.to_s - seen.from_s) * c / columns;
    const double next = seen.from_s + (seen.to_s - seen.from_s) * (c + 1) / columns;
    const std::size_t begin = record.at_or_after(t);
    const std::size_t end = std::min(record.recording.samples.size(), std::max(begin + 1, record.at_or_after(next)));
    if (begin >= end || t < record.shift_s) continue;
    const bool there = std::any_of(record.recording.samples.begin() + static_cast<std::ptrdiff_t>(begin),
                                   record.recording.samples.begin() + static_cast<std::ptrdiff_t>(end),
                                   [signal](const DatumSample& sample) { return sample.*signal; });
    canvas.put(lane.row, lane.column + kAxisColumns + c, there ? on : off, there ? Tone::strong : Tone::faint);
  }
}

/// `panel` from speed_panel(); its range is the time that is seen.
void draw_datum_chart(Canvas& canvas, const Area& area, const PlotPanel& panel, const ShownRecord& first,
                      const ShownRecord* second, const SeenTime& seen) {
  const int lanes = second == nullptr ? 2 : 4;
  const bool ascii = canvas.glyphs() == Glyphs::ascii;
  const char32_t closed = ascii ? U'#' : U'█', open = ascii ? U'_' : U'▁';
  ChartView view;
  view.x_from = seen.from_s;
  view.x_to = seen.to_s;
  view.cursor_x = seen.cursor_s;
  const int read_outs = second == nullptr ? 0 : 1;  // beside the one that the chart has
  const int chart_rows = area.rows - lanes - read_outs;
  draw_chart(canvas, area.top(chart_rows), panel, view);
  if (seen.cursor_s && chart_rows > 0) {
    Area line{area.row + chart_rows - 1, area.column, 1, area.columns};
    canvas.fill(line);
    canvas.text(line, 0, 1, (second == nullptr ? "" : "1: ") + read_out_at(first, *seen.cursor_s), Tone::strong);
    ++line.row;
    if (second != nullptr) canvas.text(line, 0, 1, "2: " + read_out_at(*second, *seen.cursor_s), Tone::strong);
  }
  Area lane{area.row + chart_rows + read_outs, area.column, 1, area.columns};
  for (const ShownRecord* record : {&first, second}) {
    if (record == nullptr) continue;
    const std::string which = record == &first ? "" : " 2";
    draw_lane(canvas, lane, "switch" + which, *record, &DatumSample::switch_closed, seen, closed, open);
    ++lane.row;
    draw_lane(canvas, lane, "marker" + which, *record, &DatumSample::marker, seen, U'|', ascii ? U'.' : U'·');
    ++lane.row;
  }
}

char small_letter_of(const DatumRecording& recording) { return static_cast<char>(letter_of(recording.axis) + 32); }

class DatumViewScreen final : public KeyedScreen {
 public:
  explicit DatumViewScreen(std::optional<DatumRecording> recording, const std::string& file)
      : draft_(draft_of(kRecordDraft)) {
    keys_ = key_table();
    if (recording) take(std::move(*recording));
    if (!file.empty()) read(file, false);
  }

  [[nodiscard]] std::string title() const override { return "DISPLAY DATUM SEQUENCE"; }
  [[nodiscard]] std::string help() const override {
    return "The velocity-time graph of an axis being referenced, with its reference switch (as wired: filled where the "
           "contact is closed) and its markers below. The second page lists the events and the datuming parameters "
           "that follow from them. Press v to overlay a second record, drawn dashed, so that two axes, or before and "
           "after, can be compared. Press a to align the records at the switch. An unsaved record survives a crash: "
           "this screen offers it again.";
  }
  [[nodiscard]] std::string unsaved() const override {
    return saved_ ? "" : fmt::format("The datum sequence of axis {} is not saved.", letter_of(first_->recording.axis));
  }

 private:
  enum class Page { graph, events };

  // --- keys
  [[nodiscard]] std::vector<KeyRow> key_table() {
    const auto empty = [this] { return !first_; };
    const auto drafted = [this] { return !first_ && draft_; };
    const auto shown = [this] { return first_.has_value(); };
    const auto graph = [this] { return first_ && page_ == Page::graph; };
    const auto events = [this] { return first_ && page_ == Page::events; };
    const auto both = [this, graph] { return graph() && second_; };
    const auto page = [this](Page to) { return [this, to] { page_ = to; }; };
    const auto move = [this](int steps) {
      return [this, steps] {
        seen_.move_cursor(steps, first_->recording.sample_period_us * 1e-6);
        redraw();
      };
    };
    const auto zoom = [this](double factor) {
      return [this, factor] {
        seen_.zoom(factor);
        redraw();
      };
    };
    return {{"Enter", "open the record", [this] { take_draft(); }, drafted},
            {"d", "delete", [this] { drop_earlier_draft(); }, drafted},
            {"o", "open a file", [this] { choose_file(); }, empty},
            {"Enter", "show it in the graph", [this] { show_event(); }, events},
            {"up/down", "event", {}, events},
            {"left/right", "cursor", {}, graph},
            {"left", "", move(-1), graph},
            {"right", "", move(1), graph},
            {"PgUp", "", move(-10), graph},
            {"PgDn", "", move(10), graph},
            {"+ - 0", "zoom", {}, graph},
            {"+", "", zoom(0.5), graph},
            {"-", "", zoom(2.0), graph},
            {"0", "", [this] { show_whole(); }, graph},
            {"Tab", "events", page(Page::events), graph},
            {"Tab", "graph", page(Page::graph), events},
            {"Shift-Tab", "", page(Page::events), graph},
            {"Shift-Tab", "", page(Page::graph), events},
            {"1", "", page(Page::graph), shown},
            {"2", "", page(Page::events), shown},
            {"a", "align", [this] { align(); }, both, true},
            {"x", "only the first", [this] { drop_overlay(); }, both, true},
            {"s", "save", [this] { ask_to_save(); }, shown},
            {"Esc", "back", {}, [graph] { return !graph(); }},
            {"v", "second", [this] { choose_second(); }, graph, true},
            {"o", "open", [this] { choose_file(); }, graph, true},
            {"e", "picture", [this] { export_picture_now(); }, graph, true},
            {"PgUp/PgDn", "cursor, ten columns", {}, graph}};
  }

  void on_other_key(const Key& key) override {
    if (first_ && page_ == Page::events) (void)event_.on_key(key, static_cast<int>(first_->events.size()));
  }

  [[nodiscard]] Step leave() override {
    if (saved_ || leaving_ > 1) return back();
    message_.say(
        "The record is not saved: press s to save it. Esc closes the screen; the record is offered again when it "
        "opens.",
        Tone::warning);
    return stay();
  }

  void show_event() {
    const auto& events = first_->events;
    if (events.empty()) return;
    const auto k = static_cast<std::size_t>(std::clamp(event_.selected, 0, static_cast<int>(events.size()) - 1));
    seen_.go_to(events[k].time_s + first_->shift_s);
    page_ = Page::graph;
    redraw();
  }

  void choose_file() {
    const auto ask = [this] {
      prompt_.choose("Open a record of a datum sequence", {{FileKind::datum_record}},
                     [this](const std::string& path) { read(path, false); });
    };
    if (saved_) return ask();
    asking_.ask({"Open another record?", "The record shown is not saved: it will be lost when another is opened.",
                 "open another", "keep this"},
                ask);
  }

  void choose_second() {
    if (!first_) return;
    prompt_.choose("Second record of a datum sequence", {{FileKind::datum_record}},
                   [this](const std::string& path) { read(path, true); });
  }

  void ask_to_save() {
    ask_where_to_save("Save as:", file_name_now(fmt::format("datum-{}", small_letter_of(first_->recording)), ".csv"),
                      [this](const std::string& path) { save(path); });
  }

  // --- records
  [[nodiscard]] const ShownRecord* second() const { return second_ ? &*second_ : nullptr; }

  void redraw() { panel_ = speed_panel(*first_, second(), seen_.from_s, seen_.to_s); }
  void show_all() {
    seen_.show_all(*first_, second());
    redraw();
  }
  void show_whole() {
    seen_.cursor_s.reset();
    show_all();
  }

  /// A fresh record: unsaved, kept as a draft.
  void take(DatumRecording recording) {
    first_ = shown(std::move(recording), "just recorded");
    saved_ = false;
    fresh_ = true;
    draft_.reset();
    show_all();
    const auto keep = [kept = first_->recording](JobControl&) { return keep_draft(kRecordDraft, to_csv(kept)); };
    drafting_.start("keeping a draft", keep, [this](const Result<void>& kept) {
      if (!kept) message_.say(kept.error());
      if (saved_) drop_draft(kRecordDraft);
    });
  }

  void take_draft() {
    auto recording = parse_recording(draft_->text, "draft");
    if (recording) {
      first_ = shown(std::move(*recording), "recorded " + draft_->kept);
      saved_ = fresh_ = false;
      show_all();
    } else {
      message_.say(recording.error());
    }
    draft_.reset();
  }

  void drop_earlier_draft() {
    asking_.ask(
        {"Delete the unsaved record?", fmt::format("The record of {} will be lost.", draft_->kept), "drop", "keep it"},
        [this] {
          drop_draft(kRecordDraft);
          draft_.reset();
        });
  }

  void read(const std::string& path, bool as_overlay) {
    if (file_task_.running()) return;
    const auto work = [path](JobControl&) -> Result<ShownRecord> {
      ECS_TRY(recording, read_recording_file(path));
      return shown(std::move(recording), std::filesystem::path(path).filename().string());
    };
    file_task_.start("reading", work, [this, as_overlay, path](Result<ShownRecord> record) {
      if (!record) return message_.say(record.error());
      if (as_overlay) {
        second_ = std::move(*record);
        message_.say(fmt::format("{} is the second record, drawn dashed.", second_->name));
      } else {
        first_ = std::move(*record);
        fresh_ = false;
        saved_ = true;
        in_file_ = path;
        seen_.cursor_s.reset();
        message_.say(fmt::format("{}: axis {}, {} samples", first_->name, letter_of(first_->recording.axis),
                                 first_->recording.samples.size()));
      }
      show_all();
    });
  }

  void drop_overlay() {
    if (!first_) return;
    second_.reset();
    show_all();
  }

  void align() {
    if (!first_ || !second_) return;
    const auto a = first_switch_s(*first_), b = first_switch_s(*second_);
    if (!a || !b)
      return message_.say("The switch does not change in both records: they cannot be aligned.", Tone::warning);
    second_->shift_s = second_->shift_s != 0.0 ? 0.0 : *a - *b;
    message_.say(
        second_->shift_s == 0.0
            ? "Both begin at 0 s."
            : fmt::format(
                  "The second is shifted by {:+.3f} s: the first switch changes coincide. Press a to shift it back.",
                  second_->shift_s));
    show_all();
  }

  void save(const std::string& path) {
    if (file_task_.running()) return;
    const auto write = [recording = first_->recording, path](JobControl&) {
      return write_file(path, to_csv(recording));
    };
    file_task_.start("writing", write, [this, path](const Result<void>& written) {
      if (!written) return message_.say(written.error());
      saved_ = true;
      note_saved(path);
      first_->name = std::filesystem::path(path).filename().string();
      drop_draft(kRecordDraft);
      message_.say("written: " + path);
    });
  }

  /// The command that recorded it gets the file; a second file is a copy of the first.
  void note_saved(const std::string& path) {
    const std::string file = path_word(path);
    std::vector<NotedCommand> noted = noted_commands();
    const std::vector<std::string> record{"ecs", "utility", "datum", "record",
                                          std::string(1, letter_of(first_->recording.axis))};
    const auto found = std::find_if(noted.rbegin(), noted.rend(), [&](const NotedCommand& command) {
      return command.words.size() >= record.size() && std::equal(record.begin(), record.end(), command.words.begin());
    });
    if (fresh_ && found != noted.rend() && in_file_.empty()) {
      found->words.insert(found->words.begin() + static_cast<std::ptrdiff_t>(record.size()), {"-o", file});
      amend(static_cast<std::size_t>(noted.rend() - found) - 1, *found);
    } else if (in_file_.empty()) {
      note_file(path, to_csv(first_->recording));
    } else if (path_word(in_file_) != file) {
      NotedCommand copy;
      copy.words = {"cp", path_word(in_file_), file};
      note(std::move(copy));
    }
    in_file_ = path;
  }

  void export_picture_now() {
    if (!first_) return;
    message_.say("Drawing the picture ...");
    export_picture(drawing_, datum_figure(*first_, second()),
                   fmt::format("datum-{}", small_letter_of(first_->recording)), write_plot, message_);
  }

  [[nodiscard]] bool look() override {
    bool changed = false;
    for (TaskRunner* task : {&drawing_, &file_task_, &drafting_}) changed = task->advance() || changed;
    return changed;
  }

  // --- the picture
  void draw_inside(Canvas& canvas, const Area& inside) const override {
    const Area body = inside.below(1).top(inside.rows - 2);
    if (!first_) {
      draw_empty(canvas, inside);
    } else {
      draw_heading(canvas, inside);
      if (page_ == Page::graph)
        draw_datum_chart(canvas, body, panel_, *first_, second(), seen_);
      else
        draw_events(canvas, body);
    }
    const Area last = last_rows(inside, 1);
    if (!message_.text().empty())
      draw_message(canvas, last, message_);
    else if (file_task_.running())
      canvas.text(last, 0, 0, "The file is being read or written ...");
  }

  void draw_heading(Canvas& canvas, const Area& area) const {
    const ShownRecord& record = *first_;
    const DatumRecording& r = record.recording;
    const std::string taken =
        r.taken.size() < 16 ? r.taken : r.taken.substr(0, 10) + " " + r.taken.substr(11, 5) + " UTC";
    const int column = canvas.text(
        area, 0, 0,
        fmt::format("Axis {}, {}{}{}", letter_of(r.axis), record.name,
                    r.serial_number.empty() ? "" : ", unit " + r.serial_number, taken.empty() ? "" : ", " + taken),
        Tone::strong);
    if (!saved_) canvas.text(area, 0, column, ", NOT SAVED", Tone::warning);
  }

  void draw_empty(Canvas& canvas, const Area& area) const {
    int row =
        canvas.paragraph(area, 1,
                         "A datum sequence is a record of ten seconds of one axis being referenced: its speed over "
                         "time, with the reference switch and the marker below. It shows the datuming parameters.");
    row += 2 + canvas.paragraph(
                   area, 2 + row,
                   "Press o to open a saved file. RECORD DATUM SEQUENCE in the previous menu makes a new record.",
                   Tone::strong);
    if (draft_)
      canvas.paragraph(area, row + 2,
                       fmt::format("Unsaved record of {} found: press Enter to open it, d to delete it.", draft_->kept),
                       Tone::warning);
  }

  void draw_events(Canvas& canvas, const Area& area) const {
    const ShownRecord& record = *first_;
    int row = 0;
    for (const std::string& hint : datuming_hints(record)) row += canvas.paragraph(area, row, hint);
    ++row;
    canvas.text(area, row++, 2, kEventHeading, Tone::faint);
    std::vector<ListRow> rows;
    for (const DatumEvent& event : record.events)
      rows.push_back({owned_lines_of(datum_event_cell(event).text).front(),
                      event.what.starts_with("switch") ? Tone::strong : Tone::plain});
    if (rows.empty()) canvas.text(area, row, 2, "no events in this record", Tone::warning);
    draw_list(canvas, area.below(row), rows, event_);
  }

  std::optional<ShownRecord> first_;
  std::optional<ShownRecord> second_;
  std::optional<Draft> draft_;  ///< of an earlier session, not taken up
  bool saved_ = true;
  bool fresh_ = false;   ///< recorded by a command that was noted without a file
  std::string in_file_;  ///< where the first record lies; empty: in no file
  SeenTime seen_;
  PlotPanel panel_;
  Page page_ = Page::graph;
  ListPlace event_;
  TaskRunner drawing_;
  TaskRunner file_task_;
  TaskRunner drafting_;
};

}  // namespace

std::unique_ptr<Screen> datum_view_screen(std::optional<DatumRecording> recording, const std::string& file) {
  return std::make_unique<DatumViewScreen>(std::move(recording), file);
}

}  // namespace ecs::app
