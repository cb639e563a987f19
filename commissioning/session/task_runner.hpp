// The background work of a controller: one task at a time in a thread of its own, with its name, how far it is and what
// is done with its result.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

namespace ecs::commissioning {

/// What a task sees of its owner.
struct JobControl {
  std::atomic<bool> cancelled{false};
  std::atomic<double> part{0.0};           ///< done, 0 … 1
  std::atomic<double> seconds_left{-1.0};  ///< where the task knows it; negative: not known
};

/// What a task tells its owner while it runs: both hold it.
template <class Told>
class Reported {
 public:
  template <class Change>
  void change(Change change) {
    const std::lock_guard lock(mutex_);
    change(told_);
    ++changes_;
  }
  [[nodiscard]] Told now() const {
    const std::lock_guard lock(mutex_);
    return told_;
  }
  [[nodiscard]] std::uint64_t changes() const { return changes_; }

 private:
  mutable std::mutex mutex_;
  Told told_;
  std::atomic<std::uint64_t> changes_{0};
};

/// Its end cancels the task and waits for it; the result is then dropped.
class TaskRunner {
 public:
  TaskRunner() = default;
  TaskRunner(const TaskRunner&) = delete;
  TaskRunner& operator=(const TaskRunner&) = delete;
  ~TaskRunner() { cancel(); }

  /// Runs `work(JobControl&)` in a thread of its own; advance() passes its result to `take`.
  /// @param label  "reading the file"  @pre !running()
  template <class Work, class Take>
  void start(std::string label, Work work, Take take) {
    begin(std::move(label), [work = std::move(work), take = std::move(take)](JobControl& control) -> Landing {
      using Answer = decltype(work(control));
      return [take, result = std::make_shared<Answer>(work(control))]() mutable { take(std::move(*result)); };
    });
  }
  /// Asks the task to stop; its result still comes.
  void cancel();
  /// Takes the result when it is there. @return whether the task ended
  bool advance();
  /// Waits for the task and takes its result.
  void finish();

  [[nodiscard]] bool running() const { return shared_ != nullptr; }
  /// Of the running task; empty: none.
  [[nodiscard]] const std::string& label() const { return label_; }
  [[nodiscard]] double part() const;          ///< done, 0 … 1
  [[nodiscard]] double seconds() const;       ///< since its start
  [[nodiscard]] double seconds_left() const;  ///< as the task says, else from the part done; negative: not known
  /// The task started last was cancelled.
  [[nodiscard]] bool cancelled() const { return cancelled_; }

 private:
  using Landing = std::function<void()>;
  struct Shared;
  void begin(std::string label, std::function<Landing(JobControl&)> work);

  std::string label_;
  std::chrono::steady_clock::time_point begun_{};
  bool cancelled_ = false;
  std::shared_ptr<Shared> shared_;
  std::jthread thread_;
};

}  // namespace ecs::commissioning
