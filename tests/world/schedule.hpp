// A clock of its own, and programs that run under it one at a time in one thread: each on a stack of its own until it
// waits. Whatever happens is an event at a time; two at one time happen in the order in which they were arranged. Does
// not live here: what the programs do (world.cpp).
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <queue>
#include <vector>

#include <ucontext.h>

namespace ecs::world {

using Time = std::chrono::steady_clock::time_point;
using Span = std::chrono::nanoseconds;

/// Thrown in a program that is killed, where it waits.
struct Killed {};

class Schedule;

/// What sanitizers know a stack by.
struct StackOf {
  const void* bottom = nullptr;
  std::size_t bytes = 0;
  void* fiber = nullptr;
};

class Program {
 public:
  Program(Schedule& schedule, std::function<void()> body);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program();
  [[nodiscard]] bool ended() const { return ended_; }
  /// It ends where it waits, at once. Not from itself.
  void kill();
  /// It goes on now, whatever it waits for.
  void wake();

 private:
  friend class Schedule;
  static void run();
  void resume();

  Schedule* schedule_;
  std::function<void()> body_;
  std::unique_ptr<std::byte[]> stack_;
  StackOf own_stack_, back_stack_;
  ucontext_t own_{};
  ucontext_t back_{};
  std::uint64_t waits_ = 0;  ///< number of the wait at hand; another one: what wakes it comes too late
  bool waiting_ = false;
  bool killed_ = false;
  bool ended_ = false;
};

class Schedule {
 public:
  [[nodiscard]] Time now() const { return now_; }
  void at(Time time, std::function<void()> event) { events_.push({std::max(time, now_), ++number_, std::move(event)}); }
  void after(Span span, std::function<void()> event) { at(now_ + span, std::move(event)); }
  /// Of the program that runs: until then, or until it is woken.
  void wait_until(Time time);
  /// The next event. False: there is none before `end`, which it is now.
  bool step(Time end);
  /// Null: none, the world itself runs.
  [[nodiscard]] Program* running() const { return running_; }

 private:
  friend class Program;
  struct Event {
    Time time;
    std::uint64_t number = 0;
    std::function<void()> happens;
    friend bool operator<(const Event& a, const Event& b) {
      return a.time != b.time ? a.time > b.time : a.number > b.number;
    }
  };
  Time now_{std::chrono::hours(1)};
  std::uint64_t number_ = 0;
  std::priority_queue<Event> events_;
  Program* running_ = nullptr;
};

}  // namespace ecs::world
