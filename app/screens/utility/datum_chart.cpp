#include "app/screens/utility/datum_chart.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace ecs::app {
namespace {

constexpr std::size_t kStretches = 400;  ///< of the time that is seen
constexpr int kAxisColumns = 9;          ///< as app/ui/chart.cpp leaves them
constexpr const char* kRecordNames[] = {"first", "second"};

std::size_t sample_at_or_after(const ShownRecord& record, double time_s) {
  const double k = (time_s - record.shift_s) * 1e6 / record.recording.sample_period_us;
  return static_cast<std::size_t>(std::clamp(std::ceil(k), 0.0, static_cast<double>(record.speeds_mm_min.size())));
}

/// The least and the largest speed of every stretch, in the order in which they came.
std::vector<PlotPoint> thinned(const ShownRecord& record, double from_s, double to_s) {
  const std::size_t begin = sample_at_or_after(record, from_s);
  const std::size_t end = std::min(record.speeds_mm_min.size(), sample_at_or_after(record, to_s) + 1);
  const std::size_t each = std::max<std::size_t>(1, (end > begin ? end - begin : 0) / kStretches);
  std::vector<PlotPoint> points;
  const auto add = [&](std::size_t i) {
    points.push_back({record.recording.time_s(i) + record.shift_s, record.speeds_mm_min[i]});
  };
  for (std::size_t k = begin; k < end; k += each) {
    const auto from = record.speeds_mm_min.begin() + static_cast<std::ptrdiff_t>(k);
    const auto to = record.speeds_mm_min.begin() + static_cast<std::ptrdiff_t>(std::min(end, k + each));
    const auto [least, most] = std::minmax_element(from, to);
    add(static_cast<std::size_t>(std::min(least, most) - record.speeds_mm_min.begin()));
    if (least != most) add(static_cast<std::size_t>(std::max(least, most) - record.speeds_mm_min.begin()));
  }
  return points;
}

PlotSeries series_of(const ShownRecord& record, int which, bool alone, double from_s, double to_s) {
  const std::string name =
      alone ? fmt::format("axis {}", letter_of(record.recording.axis))
            : fmt::format("{}: {} {}", kRecordNames[which], letter_of(record.recording.axis), record.name);
  return {name, which == 0 ? Mark::forward : Mark::reverse, thinned(record, from_s, to_s)};
}

/// Corners of a signal of 0 and 1, for a file.
std::vector<PlotPoint> corners(const ShownRecord& record, bool DatumSample::*signal, double height) {
  std::vector<PlotPoint> points;
  const auto& samples = record.recording.samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const bool changes = i > 0 && samples[i].*signal != samples[i - 1].*signal;
    const double t = record.recording.time_s(i) + record.shift_s;
    if (changes) points.push_back({t, samples[i - 1].*signal ? height : 0.0});
    if (changes || i == 0 || i + 1 == samples.size()) points.push_back({t, samples[i].*signal ? height : 0.0});
  }
  return points;
}

/// One lane: a cell is marked where the signal was there at any time of its stretch.
void draw_lane(Canvas& canvas, const Area& lane, const std::string& label, const ShownRecord& record,
               bool DatumSample::*signal, double from_s, double to_s, char32_t on, char32_t off) {
  canvas.text({lane.row, lane.column, 1, kAxisColumns}, 0, 0, label, Tone::faint);
  const int columns = lane.columns - kAxisColumns;
  for (int c = 0; c < columns; ++c) {
    const double t = from_s + (to_s - from_s) * c / columns;
    const double next = from_s + (to_s - from_s) * (c + 1) / columns;
    const std::size_t begin = sample_at_or_after(record, t);
    const std::size_t end =
        std::min(record.recording.samples.size(), std::max(begin + 1, sample_at_or_after(record, next)));
    if (begin >= end || t < record.shift_s) continue;
    const bool there = std::any_of(record.recording.samples.begin() + static_cast<std::ptrdiff_t>(begin),
                                   record.recording.samples.begin() + static_cast<std::ptrdiff_t>(end),
                                   [signal](const DatumSample& sample) { return sample.*signal; });
    canvas.put(lane.row, lane.column + kAxisColumns + c, there ? on : off, there ? Tone::strong : Tone::faint);
  }
}

}  // namespace

double ShownRecord::end_s() const {
  return recording.samples.empty() ? shift_s : recording.time_s(recording.samples.size() - 1) + shift_s;
}

std::optional<std::size_t> ShownRecord::at(double time_s) const {
  const double k = std::round((time_s - shift_s) * 1e6 / recording.sample_period_us);
  if (k < 0.0 || k >= static_cast<double>(recording.samples.size())) return std::nullopt;
  return static_cast<std::size_t>(k);
}

ShownRecord shown(DatumRecording recording, std::string name) {
  ShownRecord record;
  record.speeds_mm_min = speeds_mm_min(recording);
  record.events = events_of(recording);
  record.recording = std::move(recording);
  record.name = std::move(name);
  return record;
}

std::optional<double> first_switch_s(const ShownRecord& record) {
  for (const DatumEvent& event : record.events)
    if (event.what.starts_with("switch")) return event.time_s;
  return std::nullopt;
}

PlotPanel speed_panel(const ShownRecord& first, const ShownRecord* second, double from_s, double to_s) {
  PlotPanel panel;
  panel.title = second == nullptr ? fmt::format("speed of axis {} over time", letter_of(first.recording.axis))
                                  : "speed over time, two records";
  panel.x_label = "s";
  panel.y_label = "mm/min ";
  panel.series.push_back(series_of(first, 0, second == nullptr, from_s, to_s));
  if (second != nullptr) panel.series.push_back(series_of(*second, 1, false, from_s, to_s));
  return panel;
}

PlotFigure datum_figure(const ShownRecord& first, const ShownRecord* second) {
  const double from_s = std::min(first.shift_s, second == nullptr ? first.shift_s : second->shift_s);
  const double to_s = std::max(first.end_s(), second == nullptr ? first.end_s() : second->end_s());
  PlotFigure figure;
  figure.title = fmt::format("Datum sequence of axis {}, {}", letter_of(first.recording.axis), first.name);
  figure.same_scale = false;
  figure.panels.push_back(speed_panel(first, second, from_s, to_s));
  PlotPanel signals;
  signals.title = "reference switch (closed: 1) and marker (0.5)";
  signals.x_label = "s";
  signals.series.push_back({"switch", Mark::forward, corners(first, &DatumSample::switch_closed, 1.0)});
  signals.series.push_back({"marker", Mark::both, corners(first, &DatumSample::marker, 0.5)});
  if (second != nullptr)
    signals.series.push_back(
        {"switch of the second", Mark::reverse, corners(*second, &DatumSample::switch_closed, 1.0)});
  figure.panels.push_back(std::move(signals));
  return figure;
}

std::string read_out_at(const ShownRecord& record, double time_s) {
  const auto i = record.at(time_s);
  if (!i) return fmt::format("{:.3f} s  nothing recorded", time_s);
  const DatumSample& sample = record.recording.samples[*i];
  return fmt::format("{:.3f} s  {} {:.1f} mm/min  {:.4f} mm  switch {}{}", time_s, letter_of(record.recording.axis),
                     record.speeds_mm_min[*i], record.recording.position_mm(*i),
                     sample.switch_closed ? "closed" : "open", sample.marker ? "  MARKER" : "");
}

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
