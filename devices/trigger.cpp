#include "devices/trigger.hpp"

namespace ecs::devices {

bool PressFilter::pressed(bool held, double now_s) {
  const bool before = level_.value_or(false);
  level_ = held;
  if (before && !held) let_go_s_ = now_s;
  return held && !before && now_s - let_go_s_ >= debounce_s_;
}

bool Trigger::pressed(std::chrono::milliseconds timeout, double now_s) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  auto left = timeout;
  do {
    const auto report = port_.read(left);
    if (!report) return false;
    const double at_s = now_s + std::chrono::duration<double>(Clock::now() - begin).count();
    const auto held = held_in(port_.device(), *report);
    if (held && filter_.pressed(*held, at_s)) return true;
    left = timeout - std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - begin);
  } while (left.count() > 0);
  return false;
}

PortChange Trigger::look(double now_s) {
  const PortChange change = port_.look(now_s);
  if (change == PortChange::back) filter_.forget();
  return change;
}

}  // namespace ecs::devices
