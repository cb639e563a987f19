// A described device that may be unplugged and come back: found, opened, read; lost and found again. A sensor of the
// surroundings or an indicator gauge: polled or listened to, without ever waiting long, its last values kept with their
// age. A button, foot switch or pendant that takes a reading when it is pressed, and which bit of its reports that is.
// Does not live here: which device it is (capture.hpp), talking to the user (capture_verbs.cpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "modules/capture/description.hpp"

namespace ecs::devices {

/// The one device among `present` that is meant. A `link` problem says what is plugged in instead, or names the devices
/// that are alike and how to tell them apart.
[[nodiscard]] Result<HidIdentity> matching(const DeviceDescription& device, const std::vector<HidIdentity>& present);

/// What has become of a device since it was last asked.
enum class PortChange { none, lost, back };

class DevicePort {
 public:
  /// Opens the device. Fails where it is not there, is not to be told from others, or may not be opened.
  [[nodiscard]] static Result<DevicePort> open(DeviceDescription device);

  /// Looks for a lost device, at most twice a second. @param now_s  steady time
  [[nodiscard]] PortChange look(double now_s);

  /// An input report of this device's layout within the time; nothing if none came, or the device is away.
  [[nodiscard]] std::optional<Bytes> read(std::chrono::milliseconds timeout);
  /// Sends the poll. False: the device is away.
  [[nodiscard]] bool poll();
  /// The feature report of the layout; nothing if the device is away.
  [[nodiscard]] std::optional<Bytes> feature();

  [[nodiscard]] bool present() const { return open_.has_value(); }
  [[nodiscard]] const DeviceDescription& device() const { return device_; }
  [[nodiscard]] const HidIdentity& identity() const { return identity_; }
  /// Why a lost device cannot be had back yet; empty: it is simply not there.
  [[nodiscard]] const std::string& hindrance() const { return hindrance_; }

 private:
  explicit DevicePort(DeviceDescription device) : device_(std::move(device)) {}
  [[nodiscard]] Result<void> connect();
  void lose();

  DeviceDescription device_;
  HidIdentity identity_;
  std::optional<HidDevice> open_;
  std::size_t report_bytes_ = 64;
  bool loss_told_ = true;
  double looked_s_ = -1e9;
  std::string hindrance_;
};

class Sensor {
 public:
  /// @param every_s  time between polls
  Sensor(DevicePort port, double every_s) : port_(std::move(port)), every_s_(every_s) {}

  /// Does what is due: polls, takes replies that are there. Returns within some milliseconds. @param now_s  steady time
  void attend(double now_s);
  [[nodiscard]] PortChange look(double now_s);
  /// Asks at once, at the next attend(), where the device is polled.
  void ask_now() { due_s_ = -1e9; }

  /// The last values that are at most so old; empty if there are none. Nothing survives the device's absence.
  [[nodiscard]] Values values(double now_s, double most_age_s) const;
  /// Grows with every answer that held a value.
  [[nodiscard]] int answers() const { return answers_; }
  /// Polls in a row that were not answered, or answered without any value.
  [[nodiscard]] int silent() const { return silent_; }
  [[nodiscard]] bool polled() const { return port_.device().report.feature || !port_.device().report.poll.empty(); }
  [[nodiscard]] const DevicePort& port() const { return port_; }

 private:
  void listen(double now_s);
  void ask(double now_s);
  void collect(double now_s);
  void finish(double now_s);
  void take(const std::vector<Bytes>& replies, double now_s);

  DevicePort port_;
  double every_s_;
  double due_s_ = -1e9;
  bool waiting_ = false;
  double give_up_s_ = 0.0;
  std::vector<Bytes> replies_;
  Values values_;
  double taken_s_ = -1e9;
  int answers_ = 0;
  int silent_ = 0;
};

/// Presses out of levels: the first report that says "held" is the press; what the contact does until it was let go for
/// the debounce time is not another one.
class PressFilter {
 public:
  explicit PressFilter(int debounce_ms) : debounce_s_(debounce_ms * 1e-3) {}
  /// @param now_s  when the level was reported; @return true: the button was pressed
  [[nodiscard]] bool pressed(bool held, double now_s);
  /// The device was away: the next report starts again.
  void forget() { level_.reset(); }

 private:
  double debounce_s_;
  std::optional<bool> level_;
  double let_go_s_ = -1e9;
};

class Trigger {
 public:
  explicit Trigger(DevicePort port) : port_(std::move(port)), filter_(port_.device().trigger.debounce_ms) {}

  /// Waits for a press, at most for the time. @param now_s  steady time at the call
  [[nodiscard]] bool pressed(std::chrono::milliseconds timeout, double now_s);
  [[nodiscard]] PortChange look(double now_s);
  [[nodiscard]] const DevicePort& port() const { return port_; }

 private:
  DevicePort port_;
  PressFilter filter_;
};

struct TimedReport {
  double time_s = 0.0;
  Bytes bytes;
};

/// What stands in the reports of one device after `presses` presses, each followed by a release.
struct Learned {
  std::uint8_t report_number = 0;  ///< 0: not numbered
  std::size_t report_bytes = 0;
  TriggerLayout trigger;   ///< debounce twice the longest bounce that was seen, at least 20 ms
  double bounce_ms = 0.0;  ///< longest bounce seen
};

/// How many presses can be told so far, at most `presses`: for showing, and for knowing when to stop.
[[nodiscard]] int presses_seen(const std::vector<TimedReport>& reports, bool numbered);

/// The bits of one byte that changed twice with every press and nothing else did. `refused` with the reason where no
/// bit did (what changed how often is said), where several could be meant (a counter, a stick, another button), or
/// where nothing came. Changes within 60 ms of each other count as bounce.
/// @param numbered  the reports begin with their number
[[nodiscard]] Result<Learned> learned(const std::vector<TimedReport>& reports, int presses, bool numbered);

}  // namespace ecs::devices
