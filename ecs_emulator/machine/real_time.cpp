#include "ecs_emulator/machine/real_time.hpp"

#include <algorithm>
#include <cmath>

#include <sched.h>

namespace ecs::emulator {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr double kStartAnew_s = 0.25;

std::int64_t nanoseconds(const timespec& t) { return t.tv_sec * kSecond_ns + t.tv_nsec; }
timespec timespec_of(std::int64_t ns) { return {ns / kSecond_ns, ns % kSecond_ns}; }

timespec now() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time;
}

}  // namespace

RealTime::RealTime() : due_(now()) {
  const sched_param lowest{.sched_priority = sched_get_priority_min(SCHED_FIFO)};
  record_.fifo = sched_setscheduler(0, SCHED_FIFO, &lowest) == 0;
}

void RealTime::wait(double period_s) {
  const auto period_ns = static_cast<std::int64_t>(std::llround(period_s * 1e9));
  const std::int64_t due_ns = nanoseconds(due_) + period_ns;
  due_ = timespec_of(due_ns);
  if (nanoseconds(now()) < due_ns)
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due_, nullptr) != 0) {
    }
  const std::int64_t late_ns = nanoseconds(now()) - due_ns;
  ++record_.periods;
  record_.worst_late_us = std::max(record_.worst_late_us, static_cast<double>(late_ns) * 1e-3);
  if (late_ns >= period_ns) ++record_.missed;
  if (static_cast<double>(late_ns) * 1e-9 <= kStartAnew_s) return;
  record_.missed += static_cast<std::uint64_t>(late_ns / period_ns) - 1;
  due_ = now();
}

}  // namespace ecs::emulator
