#include "app/screens/utility/datum_chart.hpp"

#include <algorithm>

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

}  // namespace

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

}  // namespace ecs::app
