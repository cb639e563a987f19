// The unit watched beside the screen: a thread of its own asks for monitor samples and keeps the newest, counts what
// came and what failed, and opens the line again when it was lost. Does not live here: drawing (monitor_screen.hpp).
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "base/result.hpp"
#include "protocol/unit_data.hpp"

namespace ecs::app {

/// What is known at one moment.
struct WatchedUnit {
  std::string link;  ///< as --link takes it; empty: not open yet
  bool emulator = false;
  std::deque<protocol::MonitorSample> samples;  ///< oldest first, at most kKept
  std::chrono::steady_clock::time_point newest_at{};
  std::uint64_t received = 0;
  std::uint64_t failed = 0;
  double per_second = 0.0;  ///< samples, over the last two seconds
  std::string problem;      ///< why there is no line now; empty: there is one
};

class UnitWatch {
 public:
  static constexpr std::size_t kKept = 1200;
  /// @param link  --link as given; empty: the stored one, else the emulator
  explicit UnitWatch(std::string link);
  ~UnitWatch();
  UnitWatch(const UnitWatch&) = delete;
  UnitWatch& operator=(const UnitWatch&) = delete;

  [[nodiscard]] WatchedUnit now() const;
  /// Counts up with every change: the screen draws only then.
  [[nodiscard]] std::uint64_t changes() const { return changes_.load(); }

 private:
  void run(const std::stop_token& stop);
  void watch_one_line(const std::stop_token& stop);
  void take(const protocol::MonitorSample& sample);
  void lost(const Problem& why);
  void pause(const std::stop_token& stop, std::chrono::milliseconds how_long) const;

  std::string link_;
  mutable std::mutex mutex_;
  WatchedUnit state_;
  std::deque<std::chrono::steady_clock::time_point> arrivals_;
  std::atomic<std::uint64_t> changes_{0};
  std::jthread thread_;
};

}  // namespace ecs::app
