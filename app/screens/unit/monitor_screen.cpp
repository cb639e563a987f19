// ON LINE MONITOR: what the unit sees of its axes, as it happens.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "app/cli/module.hpp"
#include "app/plot/gnuplot.hpp"
#include "app/screens/unit/screens.hpp"
#include "app/screens/utility/parts.hpp"
#include "app/ui/chart.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "base/text.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/plot/figure.hpp"
#include "commissioning/plot/picture_export.hpp"
#include "commissioning/unit/monitor_record.hpp"
#include "commissioning/unit/status.hpp"
#include "core/fault.hpp"
#include "core/mode_word.hpp"
#include "params/position_unit.hpp"

namespace ecs::app {
namespace {

using protocol::AxisSample;
using protocol::MonitorSample;

constexpr double kOld_s = 1.0;  ///< what is older is called old
constexpr int kBarColumns = 7;
constexpr double kStrip_s = 40.0;                      ///< of the unit's time
constexpr double kStripGap_s = 2.5;                    ///< the strip is not joined over a longer time without samples
constexpr std::chrono::milliseconds kStrip{150};       ///< between two pictures of the strip
constexpr std::chrono::milliseconds kSlowStrip{4000};  ///< where every cell takes its time on the link

double time_s(const MonitorSample& sample) { return static_cast<double>(sample.unit_time_us) * 1e-6; }

/// A bar from its middle: `share` −1 … 1.
void draw_bar(Canvas& canvas, const Area& area, int row, int column, double share) {
  const int half = kBarColumns / 2;
  const int length = static_cast<int>(std::lround(std::clamp(share, -1.0, 1.0) * half));
  for (int c = -half; c <= half; ++c) {
    const bool inside = length >= 0 ? c > 0 && c <= length : c < 0 && c >= length;
    canvas.put(area.row + row, area.column + column + half + c, c == 0 ? U'│' : (inside ? U'█' : U'·'),
               inside ? Tone::forward : Tone::faint);
  }
}

double largest_compensation(const SampledUnit& unit) {
  double most = 1.0;
  for (const MonitorSample& sample : unit.samples)
    for (const AxisSample& axis : sample.axes) most = std::max(most, std::abs(axis.compensation_um));
  return most;
}

constexpr int kReferenceColumn = 26;
constexpr int kBarColumn = 64;

std::string heading(const params::PositionUnit& unit) {
  return fmt::format("{:>13} {:>9}  {:<5}{:<7}{:<7}{:<9}{:>8}  {:^7}  {}", fmt::format("position {}", unit.length),
                     unit.speed, "refd", "switch", "marker", "approach", "comp. um", "bar", "relay");
}

/// @param sound  the unit has no fault: a reference counts for something
void draw_axis(Canvas& canvas, const Area& area, int row, Axis axis, const AxisSample& a, double most_um, bool sound,
               const params::PositionUnit& unit) {
  canvas.text(
      area, row, 1,
      fmt::format("{} {:>11} {:>9}  {:<5}{:<7}{:<7}{:<9}{:>8.2f}", letter_of(axis), unit.position(a.position_mm),
                  unit.speed_of(a.speed_mm_min), a.referenced ? "yes" : "no", a.switch_active ? "on" : "off",
                  a.marker ? "seen" : "-", name_of(a.approach), a.compensation_um),
      Tone::strong);
  canvas.paint({area.row + row, area.column + kReferenceColumn, 1, 3},
               a.referenced && sound ? Tone::good : Tone::warning);
  draw_bar(canvas, area, row, kBarColumn, a.compensation_um / most_um);
  canvas.text(area, row, kBarColumn + kBarColumns + 2, a.relay_closed ? "closed" : "open",
              a.relay_closed ? Tone::good : Tone::faint);
}

/// "A  -30.000 deg forward C  120.000 deg reverse add X +1.2 Y -0.4 Z +0.1 um"; empty: no rotary axes.
std::string rotary_text(const protocol::RotarySample& rotary, UnitMode mode) {
  std::string text;
  for (const protocol::RotaryAxisSample& axis : rotary.axes) {
    if (axis.letter == '\0') continue;
    text += axis.sensed ? fmt::format("{} {:>8.3f} deg {:<8}", axis.letter, axis.angle_deg,
                                      axis.approach == Approach::unknown ? "" : name_of(axis.approach))
                        : fmt::format("{} without signal  ", axis.letter);
  }
  const Vector3& um = rotary.compensation_um;
  if (!text.empty() && mode == UnitMode::compensating)
    text += fmt::format("add X {:+.1f} Y {:+.1f} Z {:+.1f} um", um[0], um[1], um[2]);
  return text;
}

/// What the unit adds for heat and load, and its inputs; empty: none is wired, set or followed.
std::string inputs_text(const protocol::LiveInputs& live) {
  std::string text;
  for (std::size_t i = 0; i < live.inputs.size(); ++i) {
    const protocol::InputStatus& input = live.inputs[i];
    if (input.state == InputState::unused && !input.wired && input.value == 0.0) continue;
    const std::string name = i == kLoadInput ? "load" : std::to_string(i + 1);
    const std::string value = fmt::format("{:.2f} {}", input.value, i == kLoadInput ? "kg" : "degC");
    text += is_doubtful(input.state) ? fmt::format("   {}: {}, {} kept", name, name_of(input.state), value)
                                     : fmt::format("   {}: {}", name, value);
  }
  if (live.rows == 0) return text.empty() ? text : "inputs" + text;
  return fmt::format("thermal X {:+.2f}  Y {:+.2f}  Z {:+.2f} um{}", live.thermal_um[0], live.thermal_um[1],
                     live.thermal_um[2], text);
}

/// The tool, the control and the deviation, as far as there is something to say; begins with blanks.
std::string lines_text(const protocol::ControlLines& lines) {
  std::string text;
  if (lines.tool_state != protocol::ToolState::none)
    text += fmt::format(
        "   tool {}{}", lines.tool,
        lines.tool_state == protocol::ToolState::acting ? "" : fmt::format(" ({})", name_of(lines.tool_state)));
  if (lines.deviation.state != InputState::unused)
    text += fmt::format("   deviation: {:+.2f} um", lines.deviation.value);
  if (!lines.control_on) text += "   the control is off";
  if (lines.battery == protocol::BatteryState::low) text += "   battery low";
  return text;
}

bool any_doubtful(const protocol::LiveInputs& live) {
  return std::ranges::any_of(live.inputs, [](const auto& input) { return is_doubtful(input.state); });
}
bool any_doubtful(const protocol::ControlLines& lines) {
  return lines.tool_state == protocol::ToolState::unknown || is_doubtful(lines.deviation.state) || !lines.control_on ||
         lines.battery == protocol::BatteryState::low;
}

/// @param age_s  of the newest sample
void draw_monitor(Canvas& canvas, const Area& area, const SampledUnit& unit, double age_s) {
  if (unit.samples.empty()) {
    canvas.paragraph({area.row + 1, area.column + 1, area.rows, area.columns - 2}, 0,
                     unit.problem.empty() ? "opening the link ..." : unit.problem,
                     unit.problem.empty() ? Tone::warning : Tone::bad);
    return;
  }
  const MonitorSample& sample = unit.samples.back();
  const std::string fault = sample.fault == Fault::none ? "no fault" : std::string(ecs::text_of(sample.fault).meaning);
  int c = 1 + canvas.text(area, 0, 1, fmt::format("{}  ", word_of(sample.mode)), Tone::strong);
  canvas.text(area, 0, c, fault, sample.fault == Fault::none ? Tone::good : Tone::bad);
  const bool old = age_s > kOld_s;
  canvas.text_right(area, 0,
                    fmt::format("{:.1f} samples a second, {} requests failed, {} ", unit.per_second, unit.failed,
                                old ? fmt::format("OLD: {:.0f} s", age_s) : fmt::format("{:.0f} ms old", 1e3 * age_s)),
                    old ? Tone::bad : Tone::faint);
  const params::PositionUnit& shown_in = params::position_unit(unit.measurement_system);
  canvas.text(area, 2, 1, heading(shown_in), Tone::faint);
  const double most_um = largest_compensation(unit);
  int row = 3;
  for (const Axis axis : kAllAxes)
    if (sample.axes[index_of(axis)].present)
      draw_axis(canvas, area, row++, axis, sample.axes[index_of(axis)], most_um, sample.fault == Fault::none, shown_in);
  if (any_axis(unit.rotary)) canvas.text(area, row++, 1, rotary_text(unit.rotary, sample.mode), Tone::strong);
  const Area below{area.row + row, area.column + 1, std::min(2, area.rows - row), area.columns - 2};
  if (!unit.problem.empty())
    canvas.paragraph(below, 0, unit.problem, Tone::bad);
  else if (unit.inputs) {
    const std::string of_inputs = inputs_text(*unit.inputs), of_lines = unit.lines ? lines_text(*unit.lines) : "";
    const bool doubtful = any_doubtful(*unit.inputs) || (unit.lines && any_doubtful(*unit.lines));
    std::string text = of_inputs.empty() ? std::string(trimmed(of_lines)) : of_inputs + of_lines;
    const double read_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - unit.inputs_at).count();
    if (!text.empty() && read_s > kOld_s) text += fmt::format("   (read {:.0f} s ago)", read_s);
    canvas.paragraph(below, 0, text, doubtful ? Tone::warning : Tone::plain);
  }
}

class MonitorScreen final : public KeyedScreen {
 public:
  explicit MonitorScreen(std::shared_ptr<UnitConnection> connection)
      : connection_(connection), watching_(std::move(connection)) {
    const auto record = [this] { toggle_recording(); };
    const auto thermometer = [this] { toggle_thermometer(); };
    const auto freeze = [this] {
      frozen_ = !frozen_;
      strip_at_ = {};
    };
    keys_ = {
        {"j", "jog", [this] { driver_.ask(prompt_, seen_, message_); },
         [this] { return MachineDriver::can_drive(seen_); }, true},
        {"f", "freeze", freeze, [this] { return !frozen_; }},
        {"f", "go on", freeze, [this] { return frozen_; }},
        {"r", "record to CSV", record, [this] { return !recording_; }},
        {"r", "end recording", record, [this] { return recording_.has_value(); }},
        {"x y z", "axis of the chart"},
        {"v", "position, speed, compensation", [this] { show_next(); }},
        {"t", "thermometer", thermometer, [this] { return !environment_; }},
        {"t", "no thermometer", thermometer, [this] { return environment_ != nullptr; }},
        {"e", "picture",
         [this] {
           export_picture(drawing_, {"on-line monitor", {strip_panel()}, 1, false}, "monitor", write_plot, message_);
         }},
        {"Esc", "back"}};
  }

  [[nodiscard]] std::string title() const override { return "ON LINE MONITOR"; }
  void draw(Canvas& canvas, const Area& area) const override {
    const double age_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - seen_.newest_at).count();
    draw_monitor(canvas, area, seen_, age_s);
    const int above = any_axis(seen_.rotary) ? 9 : 8;
    const std::string counting =
        surroundings_.empty() && !seen_.samples.empty() ? unreferenced_text(seen_.samples.back()) : "";
    canvas.text({area.row, area.column, area.rows, area.columns - 1}, 1, 1, counting.empty() ? surroundings_ : counting,
                counting.empty() ? Tone::strong : Tone::warning);
    const auto now = std::chrono::steady_clock::now();
    if (now - strip_at_ > (canvas.slow() ? kSlowStrip : kStrip)) {
      strip_panel_ = strip_panel();
      strip_at_ = now;
    }
    if (area.rows > above + 6)
      draw_chart(canvas, {area.row + above, area.column, area.rows - above - 1, area.columns}, strip_panel_);
    const Area last{area.row + area.rows - 1, area.column + 1, 1, area.columns - 2};
    if (prompt_.active())
      prompt_.draw(canvas, area, area.rows - 1);
    else if (driver_.running())
      canvas.text(last, 0, 0, "The emulated machine is moving; press Esc to stop.", Tone::warning);
    else if (recording_)
      canvas.text(
          last, 0, 0,
          fmt::format("RECORDING, {} samples in {}.part; press r to stop", recording_->samples(), recording_->name()),
          Tone::warning);
    else
      draw_message(canvas, last, message_);
  }

  [[nodiscard]] CellPosition cursor(const Area& area) const override { return prompt_.cursor(area, area.rows - 1); }
  [[nodiscard]] std::string help() const override {
    return "Live data of the axes: position, speed, reference state, switch and marker, sensed approach, present "
           "compensation and relay. At the right are the sample rate and the age of the data. A lost link reopens "
           "automatically. Below the axes are the rotary axes of the map with the compensation that they add. Then "
           "come the "
           "compensation for temperature and load and the inputs that the unit follows. "
           "Press r to record every sample to a CSV file, and again to stop; until then the file is "
           "named .part. Press f to freeze the picture; the recording continues. Press t to show air and material "
           "temperature of a USB thermometer (TEMPer); a recording has them in its last columns, empty without a "
           "thermometer. With the bundled emulator, press j to drive its machine to coordinates, with a typed block "
           "or with a part program.";
  }

 private:
  enum class Strip { position, speed, compensation };

  [[nodiscard]] Step leave() override {
    if (driver_.stop()) return stay();
    if (!recording_) return back();
    toggle_recording();
    return stay();
  }
  void on_other_key(const Key& key) override {
    axis_ = axis_of_key(key).value_or(axis_);
    strip_at_ = {};
  }
  void show_next() {
    strip_ = static_cast<Strip>((static_cast<int>(strip_) + 1) % 3);
    strip_at_ = {};
  }
  [[nodiscard]] bool look() override {
    const bool moves = driver_.advance();
    const std::string surroundings = environment_ ? environment_->now().text : "";
    const bool weather = surroundings != surroundings_;
    surroundings_ = surroundings;
    const std::uint64_t changes = connection_->changes();
    const bool old = std::chrono::steady_clock::now() - seen_.newest_at > std::chrono::seconds(1);
    if (changes == changes_ && (!old || frozen_)) return weather || moves;
    changes_ = changes;
    SampledUnit now = connection_->now();
    record(now);
    if (frozen_) return recording_.has_value() || weather || moves;
    seen_ = std::move(now);
    (void)drawing_.advance();
    return true;
  }

  std::shared_ptr<UnitConnection> connection_;
  UnitConnection::Watching watching_;
  SampledUnit seen_;
  std::uint64_t changes_ = 0;
  bool frozen_ = false;
  Axis axis_ = Axis::X;
  Strip strip_ = Strip::compensation;
  MachineDriver driver_;
  std::unique_ptr<SurroundingsWatch> environment_;  ///< null: not asked for
  std::string surroundings_;
  TaskRunner drawing_;
  std::optional<MonitorRecording> recording_;
  std::chrono::steady_clock::time_point begun_at_{};  ///< the recording
  bool recorded_with_thermometer_ = false;
  std::uint64_t received_ = 0;     ///< samples that the connection had when it was looked at last
  mutable PlotPanel strip_panel_;  ///< as drawn last
  mutable std::chrono::steady_clock::time_point strip_at_{};

  void toggle_thermometer() {
    const bool wanted = environment_ == nullptr;
    environment_ = wanted ? watched_surroundings("temper", 1.0) : nullptr;
    if (wanted && !environment_) message_.say("this program was built without thermometer support", Tone::warning);
  }

  void toggle_recording() {
    if (recording_) {
      if (const auto ended = recording_->end(); !ended)
        message_.say(ended.error());
      else if (recording_->samples() == 0)
        message_.say("no sample received: no file was written", Tone::warning);
      else
        note_recording();
      recording_.reset();
      return;
    }
    auto begun = MonitorRecording::begun(file_name_now("monitor", ".csv"));
    begun_at_ = std::chrono::steady_clock::now();
    recorded_with_thermometer_ = environment_ != nullptr;
    if (begun)
      recording_.emplace(std::move(*begun));
    else
      message_.say(begun.error());
  }

  /// As many samples in as much time.
  void note_recording() {
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begun_at_;
    const std::string interval =
        fmt::format("{:.0f}", std::max(1.0, took.count() / static_cast<double>(recording_->samples())));
    std::vector<std::string> words{"monitor",
                                   "--count",
                                   fmt::format("{}", recording_->samples()),
                                   "--interval",
                                   interval,
                                   "--record",
                                   path_word(recording_->name())};
    if (recorded_with_thermometer_) words.insert(words.end(), {"--environment", "temper"});
    note_on_unit(*connection_, std::move(words));
    message_.say(recording_->summary());
  }

  /// The samples that came since the last look.
  void record(const SampledUnit& unit) {
    const std::uint64_t missed = unit.received - std::min(unit.received, received_);
    received_ = unit.received;
    if (!recording_) return;
    const Surroundings surroundings = environment_ ? environment_->now() : Surroundings();
    const auto kept = unit.samples.size();
    for (std::size_t k = kept - std::min<std::uint64_t>(missed, kept); k < kept; ++k)
      if (const auto added = recording_->add(unit.samples[k], surroundings); !added) {
        message_.say(added.error());
        recording_.reset();
        return;
      }
  }

  [[nodiscard]] PlotPanel strip_panel() const {
    const params::PositionUnit& unit = params::position_unit(seen_.measurement_system);
    const std::string_view units[] = {unit.length, unit.speed, "um"};
    const char* names[] = {"position", "speed", "compensation"};
    PlotPanel panel;
    panel.x_label = "s";
    panel.title =
        fmt::format("{} of {}{}", names[static_cast<int>(strip_)], letter_of(axis_), frozen_ ? "   FROZEN" : "");
    panel.y_label = units[static_cast<int>(strip_)];
    PlotSeries series{names[static_cast<int>(strip_)], Mark::forward, {}};
    series.longest_gap = kStripGap_s;
    for (const MonitorSample& sample : seen_.samples) {
      if (time_s(sample) < time_s(seen_.samples.back()) - kStrip_s) continue;
      const AxisSample& a = sample.axes[index_of(axis_)];
      const double value = strip_ == Strip::position ? a.position_mm / unit.mm
                           : strip_ == Strip::speed  ? a.speed_mm_min / unit.mm
                                                     : a.compensation_um;
      series.points.push_back({time_s(sample), value});
    }
    if (!seen_.samples.empty()) panel.series.push_back(std::move(series));
    return panel;
  }
};

}  // namespace

std::unique_ptr<Screen> monitor_screen(std::shared_ptr<UnitConnection> connection) {
  return std::make_unique<MonitorScreen>(std::move(connection));
}

}  // namespace ecs::app
