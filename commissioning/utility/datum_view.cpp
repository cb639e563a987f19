#include "commissioning/utility/datum_view.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "commissioning/session/remembered.hpp"
#include "params/observed_datum.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::size_t kStretches = 400;  ///< of the time that is seen
constexpr const char* kRecordNames[] = {"first", "second"};

/// The least and the largest speed of every stretch, in the order in which they came.
std::vector<PlotPoint> thinned(const ShownRecord& record, double from_s, double to_s) {
  const std::size_t begin = record.at_or_after(from_s);
  const std::size_t end = std::min(record.speeds_mm_min.size(), record.at_or_after(to_s) + 1);
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

}  // namespace

std::size_t ShownRecord::at_or_after(double time_s) const {
  const double k = (time_s - shift_s) * 1e6 / recording.sample_period_us;
  return static_cast<std::size_t>(std::clamp(std::ceil(k), 0.0, static_cast<double>(speeds_mm_min.size())));
}

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
  SeenTime seen;
  seen.show_all(first, second);
  PlotFigure figure;
  figure.title = fmt::format("Datum sequence of axis {}, {}", letter_of(first.recording.axis), first.name);
  figure.same_scale = false;
  figure.panels.push_back(speed_panel(first, second, seen.least_s, seen.most_s));
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

namespace {

constexpr double kLeastSeen_s = 0.05;
constexpr double kCursorSteps = 70.0;  ///< of the cursor over what is seen: about a column each

}  // namespace

std::vector<std::string> datuming_hints(const ShownRecord& record) {
  using Lack = params::ObservedDatum::Lack;
  const bool moved = std::any_of(record.events.begin(), record.events.end(),
                                 [](const DatumEvent& event) { return event.what == "motion begins"; });
  const params::ObservedDatum seen =
      params::observed_datum({record.recording.samples, record.speeds_mm_min, record.recording.um_per_count, moved});
  if (seen.lack == Lack::motion) return {"The axis did not move in this record: reference it during the recording."};
  if (seen.lack == Lack::switch_change)
    return {"The switch did not change: the axis did not reach it, or it is not connected. Start nearer to it."};
  if (seen.lack == Lack::clear_start)
    return {
        fmt::format("The switch changed {} times: the record began near it or on it, and the axis was first moved off. "
                    "Such a record cannot be evaluated. Start clear of the switch, at most about five seconds of "
                    "travel away from it.",
                    seen.switch_changes)};
  std::vector<std::string> hints{fmt::format("Reference switch approach direction: {}. Approach speed: {:.0f} mm/min; "
                                             "the routine allows half as much again.",
                                             seen.forward ? "forward" : "reverse", seen.approach_mm_min),
                                 fmt::format("Reference switch initial state: the contact was {} before.",
                                             seen.initially_closed ? "closed" : "open")};
  if (seen.lack == Lack::marker) {
    hints.emplace_back("No marker after the switch: check the marker signal; possibly the ten seconds were over.");
    return hints;
  }
  hints.push_back(fmt::format("Reference switch final state: the contact was {} at the last marker, {:.3f} s.",
                              seen.finally_closed ? "closed" : "open", record.recording.time_s(seen.marker)));
  hints.push_back(fmt::format("Datum type {}: the axis {} after it had reached the switch, and the marker came {} it.",
                              params::word_of(seen.kind), seen.turned_back ? "turned back" : "went on",
                              seen.finally_closed ? "on" : "off"));
  return hints;
}

std::string unsaved_record_of() {
  const auto draft = draft_of(kRecordDraft);
  return draft ? draft->kept : "";
}

void SeenTime::show_all(const ShownRecord& first, const ShownRecord* second) {
  least_s = std::min(first.shift_s, second == nullptr ? first.shift_s : second->shift_s);
  most_s = std::max(first.end_s(), second == nullptr ? first.end_s() : second->end_s());
  see_all();
}

void SeenTime::see_all() {
  from_s = least_s;
  to_s = std::max(most_s, from_s + kLeastSeen_s);
}

void SeenTime::go_to(double time_s) {
  cursor_s = time_s;
  if (time_s >= from_s && time_s <= to_s) return;
  const double half = 0.5 * (to_s - from_s);
  from_s = time_s - half;
  to_s = time_s + half;
}

void SeenTime::move_cursor(int steps, double sample_s) {
  const double step_s = std::max((to_s - from_s) / kCursorSteps, sample_s);
  const double moved = cursor_s ? *cursor_s + steps * step_s : (from_s + to_s) / 2.0;
  go_to(std::clamp(std::round(moved / sample_s) * sample_s, least_s, most_s));
}

void SeenTime::zoom(double factor) {
  const double centre = cursor_s.value_or(0.5 * (from_s + to_s));
  const double width = std::max(kLeastSeen_s, (to_s - from_s) * factor);
  see_all();
  if (width >= to_s - from_s) return;
  from_s = std::clamp(centre - 0.5 * width, from_s, to_s - width);
  to_s = from_s + width;
}

}  // namespace ecs::commissioning
