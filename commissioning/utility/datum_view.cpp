#include "commissioning/utility/datum_view.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "base/file.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/utility/unit_view.hpp"
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

namespace {

constexpr const char* kDraft = "datum-sequence";
constexpr double kLeastSeen_s = 0.05;

}  // namespace

std::vector<std::string> datuming_hints(const ShownRecord& record) {
  using Lack = params::ObservedDatum::Lack;
  const bool moved = std::any_of(record.events.begin(), record.events.end(),
                                 [](const DatumEvent& event) { return event.what == "motion begins"; });
  const params::ObservedDatum seen =
      params::observed_datum({record.recording.samples, record.speeds_mm_min, record.recording.um_per_count, moved});
  if (seen.lack == Lack::motion) return {"The axis did not move in this record: reference it while the record runs."};
  if (seen.lack == Lack::switch_change)
    return {"The switch did not change: the axis did not reach it, or it is not connected. Begin nearer to it."};
  if (seen.lack == Lack::clear_start)
    return {
        fmt::format("The switch changed {} times: the record began near it or on it, and the axis was moved off first. "
                    "Nothing is read from that. Move the axis well away from the switch and record again.",
                    seen.switch_changes)};
  std::vector<std::string> hints{fmt::format("Reference switch approach direction: {}. Approach speed: {:.0f} mm/min; "
                                             "the routine allows half as much again.",
                                             seen.forward ? "forward" : "reverse", seen.approach_mm_min),
                                 fmt::format("Reference switch initial state: the contact was {} before.",
                                             seen.initially_closed ? "closed" : "open")};
  if (seen.lack == Lack::marker) {
    hints.emplace_back("No marker came after the switch: check the marker signal, or the ten seconds were over.");
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
  const auto draft = draft_of(kDraft);
  return draft ? draft->kept : "";
}

DatumViewController::DatumViewController() : draft_(draft_of(kDraft)) {}

void DatumViewController::take(DatumRecording recording) {
  first_ = shown(std::move(recording), "just recorded");
  saved_ = false;
  fresh_ = true;
  in_file_.clear();
  draft_.reset();
  show_all();
  keep_fresh_draft();
}

void DatumViewController::keep_fresh_draft() {
  const auto keep = [recording = first_->recording](JobControl&) { return keep_draft(kDraft, to_csv(recording)); };
  drafting_.start("keeping a draft", keep, [this](const Result<void>& kept) {
    if (!kept) message_.say(kept.error());
    if (saved_) drop_draft(kDraft);
  });
}

void DatumViewController::take_draft() {
  if (!draft_) return;
  auto recording = parse_recording(draft_->text, "draft");
  if (recording) {
    first_ = shown(std::move(*recording), "recorded " + draft_->kept);
    saved_ = fresh_ = false;
    in_file_.clear();
    show_all();
  } else {
    message_.say(recording.error());
  }
  draft_.reset();
}

void DatumViewController::drop_earlier_draft() {
  drop_draft(kDraft);
  draft_.reset();
}

void DatumViewController::read(const std::string& path, bool as_overlay) {
  if (busy()) return;
  const auto work = [path](JobControl&) -> Result<ShownRecord> {
    ECS_TRY(recording, read_recording_file(path));
    return shown(std::move(recording), std::filesystem::path(path).filename().string());
  };
  file_task_.start("reading", work, [this, as_overlay, path](Result<ShownRecord> record) {
    if (!record) return message_.say(record.error());
    if (!as_overlay) {
      fresh_ = false;
      in_file_ = path;
    }
    take_read(std::move(*record), as_overlay);
  });
}

void DatumViewController::take_read(ShownRecord record, bool as_overlay) {
  (as_overlay ? second_ : first_) = std::move(record);
  if (as_overlay) {
    message_.say(fmt::format("{} is the second, drawn broken.", second_->name));
  } else {
    saved_ = true;
    cursor_s_.reset();
    message_.say(fmt::format("{}: axis {}, {} samples", first_->name, letter_of(first_->recording.axis),
                             first_->recording.samples.size()));
  }
  show_all();
}

void DatumViewController::open(const std::string& path) { read(path, false); }
void DatumViewController::overlay(const std::string& path) { read(path, true); }

void DatumViewController::drop_overlay() {
  second_.reset();
  show_all();
}

void DatumViewController::align() {
  if (!first_ || !second_) return;
  const auto a = first_switch_s(*first_), b = first_switch_s(*second_);
  if (!a || !b) {
    message_.say("The switch does not change in both records: nothing to lay over each other.", Tone::warning);
    return;
  }
  second_->shift_s = second_->shift_s != 0.0 ? 0.0 : *a - *b;
  message_.say(
      second_->shift_s == 0.0
          ? "Both begin at 0 s."
          : fmt::format(
                "The second is shifted by {:+.3f} s: the switches change first at the same time. a shifts it back.",
                second_->shift_s));
  show_all();
}

void DatumViewController::save(const std::string& path) {
  if (!first_ || busy()) return;
  const auto write = [recording = first_->recording, path](JobControl&) { return write_file(path, to_csv(recording)); };
  file_task_.start("writing", write, [this, path](const Result<void>& written) {
    if (!written) return message_.say(written.error());
    saved_ = true;
    note_saved(path);
    first_->name = std::filesystem::path(path).filename().string();
    drop_draft(kDraft);
    message_.say("written: " + path);
  });
}

/// The command that recorded it gets the file; a second file is a copy of the first.
void DatumViewController::note_saved(const std::string& path) {
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

void DatumViewController::export_picture(FigureWriter write) {
  if (!first_) return;
  message_.say("Drawing the picture ...");
  commissioning::export_picture(drawing_, datum_figure(*first_, second()),
                                fmt::format("datum-{}", static_cast<char>(letter_of(first_->recording.axis) + 32)),
                                std::move(write), message_);
}

std::string DatumViewController::proposed_name() const {
  return first_
             ? file_name_now(fmt::format("datum-{}", static_cast<char>(letter_of(first_->recording.axis) + 32)), ".csv")
             : "";
}

void DatumViewController::show_all() {
  if (!first_) return;
  from_s_ = std::min(first_->shift_s, second_ ? second_->shift_s : first_->shift_s);
  to_s_ = std::max(first_->end_s(), second_ ? second_->end_s() : first_->end_s());
  to_s_ = std::max(to_s_, from_s_ + kLeastSeen_s);
  redraw();
}

void DatumViewController::redraw() {
  if (first_) panel_ = speed_panel(*first_, second(), from_s_, to_s_);
}

void DatumViewController::whole() {
  cursor_s_.reset();
  show_all();
}

void DatumViewController::go_to(double time_s) {
  cursor_s_ = time_s;
  if (time_s < from_s_ || time_s > to_s_) {
    const double half = 0.5 * (to_s_ - from_s_);
    from_s_ = time_s - half;
    to_s_ = time_s + half;
    redraw();
  }
}

void DatumViewController::move_cursor(int direction, int columns) {
  if (!first_) return;
  const double step_s = (to_s_ - from_s_) / std::max(1, columns);
  const double least_s = std::min(first_->shift_s, second_ ? second_->shift_s : first_->shift_s);
  const double most_s = std::max(first_->end_s(), second_ ? second_->end_s() : first_->end_s());
  const double sample_s = first_->recording.sample_period_us * 1e-6;
  const double moved = cursor_s_ ? *cursor_s_ + direction * std::max(step_s, sample_s) : (from_s_ + to_s_) / 2.0;
  go_to(std::clamp(std::round(moved / sample_s) * sample_s, least_s, most_s));
}

void DatumViewController::zoom(double factor) {
  if (!first_) return;
  const double centre = cursor_s_.value_or(0.5 * (from_s_ + to_s_));
  const double width = std::max(kLeastSeen_s, (to_s_ - from_s_) * factor);
  show_all();
  const double least = from_s_, most = to_s_;
  if (width >= most - least) return;
  from_s_ = std::clamp(centre - 0.5 * width, least, most - width);
  to_s_ = from_s_ + width;
  redraw();
}

bool DatumViewController::advance() {
  bool changed = false;
  for (TaskRunner* task : {&drawing_, &file_task_, &drafting_}) changed = task->advance() || changed;
  return changed;
}

}  // namespace ecs::commissioning
