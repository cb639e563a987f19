// A sensor of the surroundings or an indicator gauge: polled or listened to, without ever waiting long, its last values
// kept with their age. Does not live here: what its reports mean (description.hpp).
#pragma once

#include "devices/port.hpp"

namespace ecs::devices {

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

}  // namespace ecs::devices
