#include "app/screens/unit_watch.hpp"

#include "app/unit_link.hpp"

namespace ecs::app {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kBetweenSamples = 25ms;  ///< forty a second where the line is fast enough
constexpr auto kBeforeNextTry = 1s;

}  // namespace

UnitWatch::UnitWatch(std::string link) : link_(std::move(link)) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

UnitWatch::~UnitWatch() {
  thread_.request_stop();
  thread_.join();
}

WatchedUnit UnitWatch::now() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

void UnitWatch::pause(const std::stop_token& stop, std::chrono::milliseconds how_long) const {
  for (const auto end = Clock::now() + how_long; !stop.stop_requested() && Clock::now() < end;)
    std::this_thread::sleep_for(std::min<Clock::duration>(5ms, end - Clock::now()));
}

void UnitWatch::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    watch_one_line(stop);
    pause(stop, kBeforeNextTry);
  }
}

void UnitWatch::take(const protocol::MonitorSample& sample) {
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  arrivals_.push_back(now);
  while (now - arrivals_.front() > 2s) arrivals_.pop_front();
  state_.per_second = static_cast<double>(arrivals_.size()) / 2.0;
  state_.samples.push_back(sample);
  if (state_.samples.size() > kKept) state_.samples.pop_front();
  state_.newest_at = now;
  state_.problem.clear();
  ++state_.received;
  ++changes_;
}

void UnitWatch::lost(const Problem& why) {
  const std::lock_guard lock(mutex_);
  state_.problem = to_text(why);
  ++state_.failed;
  ++changes_;
}

void UnitWatch::watch_one_line(const std::stop_token& stop) {
  const auto choice = chosen_link(link_);
  if (!choice) return lost(choice.error());
  auto unit = open_link(*choice);
  if (!unit) return lost(unit.error());
  {
    const std::lock_guard lock(mutex_);
    state_.link = unit->name();
    state_.emulator = unit->is_emulator();
  }
  int failures = 0;
  while (!stop.stop_requested() && failures < 3) {
    const auto sample = unit->client().monitor();
    if (sample) {
      take(*sample);
      failures = 0;
    } else {
      lost(sample.error());
      ++failures;
    }
    pause(stop, kBetweenSamples);
  }
}

}  // namespace ecs::app
