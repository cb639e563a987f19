// A measurement taken target by target: what is captured and where its readings come from; its devices, named on a
// command line (a description's file, or one that comes with the program, and which of several alike) or learnt while
// the user presses them; started or resumed, guided to its end, written. Under way it is triggers, displays and sensors
// around the record, one short step after the other; whoever shows it (a terminal, a screen) takes its news. Its part
// file is written by std::async and not by a TaskRunner, whose owner must call advance(): the file is waited for before
// the next is started, and at the end.
// Does not live here: the stops and the readings (capture_record.hpp).
#pragma once

#include <cstddef>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/cli/action.hpp"
#include "base/result.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/unit/monitor_record.hpp"
#include "laser/measurement_set.hpp"
#include "modules/capture/capture_record.hpp"
#include "modules/capture/description.hpp"
#include "modules/capture/port.hpp"

namespace ecs::commissioning {

inline constexpr int kMostRuns = 1000;

/// As typed; empty or absent: not given.
struct CaptureTargets {
  std::string axis;
  std::string sense;
  std::optional<double> from_mm;
  std::optional<double> to_mm;
  std::optional<double> step_mm;
  int runs = 0;
  bool moved = false;
  bool one_way = false;
  std::string parked;
  std::optional<double> feed_mm_min;
  std::string targets;
  std::string plan;
  std::string row;
  std::string machine;
  std::string compensated;
  std::vector<std::string> notes;
  static cli::Fields<CaptureTargets> fields();
};

/// Stops and metadata. What the plan's row says can be overridden one by one.
[[nodiscard]] Result<devices::CapturePlan> capture_plan(const CaptureTargets& arguments);

/// What a display showed when it was asked.
struct Shown {
  enum class Kind {
    value,
    not_yet,  ///< ask again in a moment
    late,     ///< it did not come in time; `why`
    none,     ///< there is nothing to be had; `why`
    ended,    ///< and there never will be; `why`
  };
  Kind kind = Kind::not_yet;
  double value = 0.0;
  std::string why;
};

class ReadingSource {
 public:
  virtual ~ReadingSource() = default;
  /// A trigger came: the next answers belong to it.
  virtual void ask(double now_s) = 0;
  [[nodiscard]] virtual Shown shown(double now_s) = 0;
  /// Keeps up with what comes on its own; returns at once.
  virtual void attend(double) {}
  /// Lines so far of a file that is read from its beginning; 0 for all other sources.
  [[nodiscard]] virtual std::size_t lines_read() const { return 0; }
  /// Reads over so many lines. False: the file has fewer.
  [[nodiscard]] virtual bool leave_out(std::size_t lines) { return lines == 0; }
  [[nodiscard]] virtual devices::PortChange look(double) { return devices::PortChange::none; }
  /// Why a lost device cannot be had back yet; empty: it is simply not there.
  [[nodiscard]] virtual std::string hindrance() const { return {}; }
  /// For the metadata: "indicator gauge (…)".
  [[nodiscard]] virtual std::string name() const = 0;
};

/// An indicator gauge: the value that it shows when it is asked; um.
[[nodiscard]] std::unique_ptr<ReadingSource> gauge_source(devices::DevicePort port);
/// Numbers of a file or FIFO, one a line ('#' begins a comment): each trigger takes the next.
[[nodiscard]] Result<std::unique_ptr<ReadingSource>> file_source(const std::string& path);
/// The same, but the last line that is there counts: a display that writes all the while.
[[nodiscard]] Result<std::unique_ptr<ReadingSource>> following_source(const std::string& path);
/// The last number that a shell command prints; it is run at each trigger.
[[nodiscard]] std::unique_ptr<ReadingSource> command_source(std::string command);

/// The last number in a line: "X -50.0012 mm" is -50.0012.
[[nodiscard]] std::optional<double> last_number_in(std::string_view line);

/// "foot_switch.toml", "foot_switch.toml@SERIAL", "temper@/dev/hidraw3". Several: the name stands for a family.
[[nodiscard]] Result<std::vector<devices::DeviceDescription>> described(const std::string& text);

/// Opens the device that `text` names. `usage` where it is of another kind.
[[nodiscard]] Result<devices::DevicePort> opened_device(const std::string& text, devices::DeviceKind kind);

/// "foot switch (16c0:27db Maker Pedal, serial 7)"
[[nodiscard]] std::string name_of(const devices::DevicePort& port);

struct LearnChoice {
  std::string device;  ///< path, serial or "16c0:27db"; empty: whichever is pressed
  std::string name;    ///< of the description; empty: as the device calls itself
  int presses = 3;
  double timeout_s = 60.0;
};

struct LearnedDevice {
  devices::DeviceDescription description;
  double bounce_ms = 0.0;
};

/// Ends a second after the last release, or at the time limit. `refused` with the reason where nothing or too much
/// changed; `link` where no device can be watched.
/// @param keyboard  a typed q gives up; null: there is nobody to type
[[nodiscard]] Result<LearnedDevice> learn_device(MessageSink& messages, Keyboard* keyboard, const LearnChoice& choice);

/// The sensor of --environment. @param every_s  between two readings
[[nodiscard]] std::unique_ptr<SurroundingsWatch> environment_watch(const std::string& device, double every_s);

/// "next: X forward to 50 mm (target 2 of 11, run 1 of 3, reading 13 of 66)"; at the beginning of a pass also from
/// where. Empty: all done.
[[nodiscard]] std::string due_text(const devices::CaptureRecord& record);

/// The last reading with its time and temperatures: "3.10 um at X 50 mm (12.4 s, air 20.31 degC)".
[[nodiscard]] std::string taken_text(const devices::CaptureRecord& record);

/// "air 20.31 degC, material 19.80 degC, 1013.2 hPa, 45 %RH"; empty: nothing is known.
[[nodiscard]] std::string around_text(const devices::Values& values);
[[nodiscard]] std::string around_text(const laser::Reading& reading);

/// What says that a reading is due.
enum class TriggerKind {
  typed,   ///< the operator types the value
  enter,   ///< an empty line
  device,  ///< a HID trigger; an empty line as well
  each,    ///< every reading that the source has, as it comes
};

struct CaptureSetup {
  TriggerKind trigger_kind = TriggerKind::typed;
  std::optional<devices::Trigger> trigger;
  std::optional<devices::Sensor> environment;
  double environment_every_s = 5.0;
  std::unique_ptr<ReadingSource> source;  ///< null: typed
  std::string part;                       ///< file that is written after every reading
  double begun_s = 0.0;                   ///< seconds that the measurement is old already
};

struct CaptureNews {
  enum class Kind { note, warning };
  Kind kind = Kind::note;
  std::string text;
};

class CaptureRun {
 public:
  /// @param now_s  steady time
  CaptureRun(devices::CaptureRecord record, CaptureSetup setup, double now_s);

  /// Looks after devices and triggers; waits up to `wait` for a trigger device.
  void step(std::chrono::milliseconds wait, double now_s);
  /// Looks after the devices only: before the first reading, until the surroundings are known.
  void warm_up(double now_s) { look_after_devices(now_s); }
  /// It cannot go on, for that reason.
  void strand(std::string why) { stuck_ = std::move(why); }
  /// A line from the operator: a value, nothing (trigger), u, s, q, ?
  void typed(const std::string& line, double now_s);
  [[nodiscard]] std::vector<CaptureNews> take_news();

  [[nodiscard]] bool done() const { return record_.due() == nullptr; }
  [[nodiscard]] bool left() const { return left_; }
  /// Why it cannot go on; empty: it can.
  [[nodiscard]] const std::string& stuck() const { return stuck_; }
  [[nodiscard]] const devices::CaptureRecord& record() const { return record_; }
  [[nodiscard]] int unplugged() const { return unplugged_; }
  /// Waits for the last reading to be on disc. False: it could not be written.
  [[nodiscard]] bool part_is_safe();
  [[nodiscard]] const std::string& part() const { return setup_.part; }
  /// What is measured around the reading at this moment.
  [[nodiscard]] devices::Values around(double now_s) const;
  /// What the operator can do, in one line.
  [[nodiscard]] std::string help() const;

 private:
  void tell(CaptureNews::Kind kind, std::string text);
  void tell_due();
  void look_after_devices(double now_s);
  void tell_change(devices::PortChange change, const std::string& device, const std::string& hindrance,
                   const char* meanwhile);
  void fire(double now_s);
  void take(double shown, double now_s);
  void ask_source(double now_s);
  void keep();
  void settle();

  devices::CaptureRecord record_;
  CaptureSetup setup_;
  double zero_s_;  ///< steady time at which the measurement began
  std::vector<CaptureNews> news_;
  bool asked_ = false;
  bool left_ = false;
  bool part_is_safe_ = true;
  std::future<Result<void>> writing_;  ///< the part file: a slow disc must not keep presses waiting
  bool silence_told_ = false;
  int unplugged_ = 0;
  std::string hindrance_told_;
  std::string stuck_;
};

/// As typed; empty or absent: not given. Devices are DEVICE.toml[@SERIAL].
struct CaptureChoice {
  CaptureTargets target;
  std::string output;
  std::string resume;
  std::string trigger;
  std::string gauge;
  std::string readings;
  std::string follow;
  std::string display;
  std::string shows = "error";
  std::optional<double> scale;
  std::string environment;
  double environment_every_s = 5.0;
  std::optional<double> min_interval_s;
  bool force = false;
  static cli::Fields<CaptureChoice> fields();
};

struct CaptureEnd {
  bool complete = false;         ///< false: the operator left before the end
  laser::MeasurementSet result;  ///< what was read
  std::size_t targets = 0;
  std::size_t skipped = 0;
  int runs = 0;
  int unplugged = 0;  ///< times that a device was
  std::string part;   ///< file that holds the readings of an unfinished capture
  std::string file;   ///< where the complete capture was written; empty: it is not complete
  std::string kept;   ///< what is safe of an unfinished one, and how to go on with it
};

/// Guides through the targets until the last, a typed q or an interrupt. After a problem the readings taken stay in
/// OUT.csv.part.
/// @param keyboard  null: there is nobody to type
[[nodiscard]] Result<CaptureEnd> capture(MessageSink& messages, Keyboard* keyboard, const CaptureChoice& choice);

}  // namespace ecs::commissioning
