// DISPLAY DATUM SEQUENCE: the graph of thesis figure 5.5 with cursor and zoom, the events, a second record over it.
#include "commissioning/utility/datum_view.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "app/plot/gnuplot.hpp"
#include "app/screens/utility/parts.hpp"
#include "app/screens/utility/screens.hpp"
#include "app/ui/cells.hpp"
#include "app/ui/chart.hpp"

namespace ecs::app {
namespace {

constexpr int kAxisColumns = 9;  ///< as app/ui/chart.cpp leaves them

/// One lane: a cell is marked where the signal was there at any time of its stretch.
void draw_lane(Canvas& canvas, const Area& lane, const std::string& label, const ShownRecord& record,
               bool DatumSample::*signal, double from_s, double to_s, char32_t on, char32_t off) {
  canvas.text({lane.row, lane.column, 1, kAxisColumns}, 0, 0, label, Tone::faint);
  const int columns = lane.columns - kAxisColumns;
  for (int c = 0; c < columns; ++c) {
    const double t = from_s + (to_s - from_s) * c / columns;
    const double next = from_s + (to_s - from_s) * (c + 1) / columns;
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
                      const ShownRecord* second, double from_s, double to_s, std::optional<double> cursor_s) {
  const int lanes = second == nullptr ? 2 : 4;
  const bool ascii = canvas.glyphs() == Glyphs::ascii;
  const char32_t closed = ascii ? U'#' : U'█', open = ascii ? U'_' : U'▁';
  ChartView view;
  view.x_from = from_s;
  view.x_to = to_s;
  view.cursor_x = cursor_s;
  const int read_outs = second == nullptr ? 0 : 1;  // beside the one that the chart has
  const int chart_rows = area.rows - lanes - read_outs;
  draw_chart(canvas, area.top(chart_rows), panel, view);
  if (cursor_s && chart_rows > 0) {
    Area line{area.row + chart_rows - 1, area.column, 1, area.columns};
    canvas.fill(line);
    canvas.text(line, 0, 1, (second == nullptr ? "" : "1: ") + read_out_at(first, *cursor_s), Tone::strong);
    ++line.row;
    if (second != nullptr) canvas.text(line, 0, 1, "2: " + read_out_at(*second, *cursor_s), Tone::strong);
  }
  Area lane{area.row + chart_rows + read_outs, area.column, 1, area.columns};
  for (const ShownRecord* record : {&first, second}) {
    if (record == nullptr) continue;
    const std::string which = record == &first ? "" : " 2";
    draw_lane(canvas, lane, "switch" + which, *record, &DatumSample::switch_closed, from_s, to_s, closed, open);
    ++lane.row;
    draw_lane(canvas, lane, "marker" + which, *record, &DatumSample::marker, from_s, to_s, U'|', ascii ? U'.' : U'·');
    ++lane.row;
  }
}

constexpr int kHeadingRows = 1;
constexpr int kMessageRows = 1;
constexpr int kStepColumns = 70;  ///< a cursor step is about one column

Area body_of(const Area& area) {
  return {area.row + kHeadingRows, area.column, area.rows - kHeadingRows - kMessageRows, area.columns};
}

class DatumViewScreen final : public UtilityScreen<DatumViewController> {
 public:
  explicit DatumViewScreen(std::optional<DatumRecording> recording) {
    if (recording) controller_.take(std::move(*recording));
  }
  explicit DatumViewScreen(const std::string& path) { controller_.open(path); }

  [[nodiscard]] std::string title() const override { return "DISPLAY DATUM SEQUENCE"; }
  void draw_inside(Canvas& canvas, const Area& inside) const override {
    const Area body = body_of(inside);
    if (controller_.first() == nullptr) {
      draw_empty(canvas, inside);
    } else {
      draw_heading(canvas, inside);
      if (page_ == Page::graph)
        draw_datum_chart(canvas, body, controller_.panel(), *controller_.first(), controller_.second(),
                         controller_.from_s(), controller_.to_s(), controller_.cursor_s());
      else
        draw_events(canvas, body);
    }
    const Area last{inside.row + inside.rows - kMessageRows, inside.column, kMessageRows, inside.columns};
    if (!controller_.message().text().empty())
      draw_message(canvas, last, controller_.message());
    else if (controller_.busy())
      canvas.text(last, 0, 0, "The file is being read or written ...");
  }

  [[nodiscard]] Step leave() override {
    if (controller_.saved() || sure_to_leave_) return back();
    sure_to_leave_ = true;
    controller_.message().say(
        "The record is not saved: s saves it; Esc again leaves, and it is offered when this screen opens again.",
        Tone::warning);
    return stay();
  }

  void on_command(const Key& key) override {
    sure_to_leave_ = false;
    if (!on_view_key(key)) (void)on_record_key(key);
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (asking_.active()) return {{"y", "yes"}, {"n", "no"}};
    if (prompt_.active()) return prompt_.keys();
    if (controller_.first() == nullptr) {
      if (controller_.draft())
        return {{"Enter", "take the record up"}, {"d", "drop it"}, {"o", "open a file"}, {"Esc", "back"}};
      return {{"o", "open a file"}, {"Esc", "back"}};
    }
    if (page_ == Page::events)
      return {
          {"Enter", "show it in the graph"}, {"up/down", "event"}, {"Tab", "graph"}, {"s", "save"}, {"Esc", "back"}};
    std::vector<KeyHelp> keys{{"left/right", "cursor"}, {"+ - 0", "zoom"}, {"Tab", "events"}, {"s", "save"},
                              {"v", "second"},          {"o", "open"},     {"e", "picture"}};
    if (controller_.second() != nullptr) {
      keys.insert(keys.begin() + 3, {"a", "align"});
      keys.insert(keys.begin() + 4, {"x", "only the first"});
    }
    keys.push_back({"PgUp/PgDn", "cursor, ten columns"});
    return keys;
  }

  [[nodiscard]] std::string help() const override {
    return "The velocity-time graph of an axis being referenced, with its reference switch (as wired: filled where the "
           "contact is closed) and its markers below. The second page lists what happened and what it says about the "
           "datuming parameters. v lays a second record over the first, drawn broken, so that two axes, or before and "
           "after, can be compared; a shifts it until the switches change at the same time. A record that is not saved "
           "survives a crash: this screen offers it again.";
  }

  [[nodiscard]] std::string unsaved() const override {
    return controller_.saved() ? ""
                               : fmt::format("The datum sequence of axis {} is not saved.",
                                             letter_of(controller_.first()->recording.axis));
  }

 private:
  enum class Page { graph, events };
  void draw_heading(Canvas& canvas, const Area& area) const {
    const ShownRecord& record = *controller_.first();
    const DatumRecording& r = record.recording;
    const std::string taken =
        r.taken.size() < 16 ? r.taken : r.taken.substr(0, 10) + " " + r.taken.substr(11, 5) + " UTC";
    const int column = canvas.text(
        area, 0, 0,
        fmt::format("Axis {}, {}{}{}", letter_of(r.axis), record.name,
                    r.serial_number.empty() ? "" : ", unit " + r.serial_number, taken.empty() ? "" : ", " + taken),
        Tone::strong);
    if (!controller_.saved()) canvas.text(area, 0, column, ", NOT SAVED", Tone::warning);
  }

  void draw_empty(Canvas& canvas, const Area& area) const {
    int row =
        canvas.paragraph(area, 1,
                         "A datum sequence is ten seconds of one axis being referenced: its speed over time, with the "
                         "reference switch and the marker below. From it the datuming parameters are read off.");
    row += 2 + canvas.paragraph(area, 2 + row,
                                "o opens a file that was saved before. RECORD DATUM SEQUENCE in the menu before this "
                                "one makes a new record.",
                                Tone::strong);
    if (controller_.draft())
      canvas.paragraph(
          area, row + 2,
          fmt::format("Unsaved record of {} found: Enter takes it up, d drops it.", controller_.draft()->kept),
          Tone::warning);
  }

  void draw_events(Canvas& canvas, const Area& area) const {
    const ShownRecord& record = *controller_.first();
    int row = 0;
    for (const std::string& hint : datuming_hints(record)) row += canvas.paragraph(area, row, hint);
    ++row;
    canvas.text(area, row++, 2, fmt::format("{:>8} {:>13} {:>15}  {}", "s", "mm", "mm/min", "what happened"),
                Tone::faint);
    std::vector<ListRow> rows;
    for (const DatumEvent& event : record.events)
      rows.push_back({fmt::format("{:>8.3f} {:>13.4f} {:>15.1f}  {}", event.time_s, event.position_mm,
                                  event.speed_mm_min, event.what),
                      event.what.starts_with("switch") ? Tone::strong : Tone::plain});
    if (rows.empty()) canvas.text(area, row, 2, "nothing happened in this record", Tone::warning);
    draw_list(canvas, {area.row + row, area.column, std::max(0, area.rows - row), area.columns}, rows, event_);
  }

  void ask_file(bool as_overlay) {
    if (as_overlay) {
      prompt_.choose("Second record of a datum sequence", {{FileKind::datum_record}},
                     [this](const std::string& path) { controller_.overlay(path); });
      return;
    }
    const auto ask = [this] {
      prompt_.choose("Open a record of a datum sequence", {{FileKind::datum_record}},
                     [this](const std::string& path) { controller_.open(path); });
    };
    if (controller_.saved())
      ask();
    else
      asking_.ask({"Open another record?", "The record shown is not saved: it is lost when another is opened.",
                   "open another", "keep this"},
                  ask);
  }

  [[nodiscard]] bool on_record_key(const Key& key) {
    if (is_letter(key, U'o')) {
      ask_file(false);
    } else if (controller_.first() == nullptr) {
      if (key.name == Key::Name::enter && controller_.draft()) controller_.take_draft();
      if (is_letter(key, U'd') && controller_.draft())
        asking_.ask({"Drop the unsaved record?", fmt::format("The record of {} is lost.", controller_.draft()->kept),
                     "drop", "keep it"},
                    [this] { controller_.drop_earlier_draft(); });
    } else if (is_letter(key, U's')) {
      ask_where_to_save(controller_.proposed_name());
    } else if (is_letter(key, U'v')) {
      ask_file(true);
    } else if (is_letter(key, U'x')) {
      controller_.drop_overlay();
    } else if (is_letter(key, U'a')) {
      controller_.align();
    } else if (is_letter(key, U'e')) {
      controller_.export_picture(write_plot);
    } else {
      return false;
    }
    return true;
  }

  [[nodiscard]] bool on_view_key(const Key& key) {
    if (controller_.first() == nullptr) return false;
    if (key.name == Key::Name::tab || key.name == Key::Name::back_tab) {
      page_ = page_ == Page::graph ? Page::events : Page::graph;
    } else if (is_letter(key, U'1') || is_letter(key, U'2')) {
      page_ = is_letter(key, U'1') ? Page::graph : Page::events;
    } else if (page_ == Page::events) {
      const auto& events = controller_.first()->events;
      if (event_.on_key(key, static_cast<int>(events.size()))) return true;
      if (key.name != Key::Name::enter || events.empty()) return false;
      const auto k = static_cast<std::size_t>(std::clamp(event_.selected, 0, static_cast<int>(events.size()) - 1));
      controller_.go_to(events[k].time_s + controller_.first()->shift_s);
      page_ = Page::graph;
    } else if (key.name == Key::Name::left || key.name == Key::Name::right) {
      controller_.move_cursor(key.name == Key::Name::right ? 1 : -1, kStepColumns);
    } else if (key.name == Key::Name::page_up || key.name == Key::Name::page_down) {
      controller_.move_cursor(key.name == Key::Name::page_down ? 10 : -10, kStepColumns);
    } else if (is_letter(key, U'+') || is_letter(key, U'-')) {
      controller_.zoom(is_letter(key, U'+') ? 0.5 : 2.0);
    } else if (is_letter(key, U'0')) {
      controller_.whole();
    } else {
      return false;
    }
    return true;
  }

  Page page_ = Page::graph;
  ListPlace event_;
  bool sure_to_leave_ = false;
};

}  // namespace

std::unique_ptr<Screen> datum_view_screen_of(const std::string& path) {
  return std::make_unique<DatumViewScreen>(path);
}

std::unique_ptr<Screen> datum_view_screen(std::optional<DatumRecording> recording) {
  return std::make_unique<DatumViewScreen>(std::move(recording));
}

}  // namespace ecs::app
