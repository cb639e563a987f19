// A button, foot switch or pendant that takes a reading when it is pressed. Does not live here: what a press does.
#pragma once

#include <optional>

#include "devices/port.hpp"

namespace ecs::devices {

/// Presses out of levels: the first report that says "held" is the press; what the contact does until it was let go for
/// the debounce time is not another one.
class PressFilter {
 public:
  explicit PressFilter(int debounce_ms) : debounce_s_(debounce_ms * 1e-3) {}
  /// @param now_s  when the level was reported; @return true: the button was pressed
  [[nodiscard]] bool pressed(bool held, double now_s);
  /// The device was away: the next report begins anew.
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

}  // namespace ecs::devices
