// A capture under way: triggers, displays and sensors around the record, one short step after the other. Whoever shows
// it (a terminal, a screen) takes its news. Its part file is written by std::async and not by a TaskRunner, whose owner
// must call advance(): the file is waited for before the next is begun, and at the end.
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/measurements/capture_source.hpp"
#include "devices/capture_record.hpp"
#include "devices/port.hpp"

namespace ecs::commissioning {

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

}  // namespace ecs::commissioning
