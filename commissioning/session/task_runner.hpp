// The background work of a controller: one task at a time, with its name, how far it is and what is done with its
// result. Does not live here: the thread (job.hpp), what the tasks do (the controllers).
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <utility>

#include "commissioning/session/job.hpp"

namespace ecs::commissioning {

class TaskRunner {
 public:
  /// Runs `work(JobControl&)` in a thread of its own; advance() passes its result to `take`.
  /// @param label  "reading the file"  @pre !running()
  template <class Work, class Take>
  void start(std::string label, Work work, Take take) {
    label_ = std::move(label);
    begun_ = Clock::now();
    cancelled_ = false;
    job_.start([work = std::move(work), take = std::move(take)](JobControl& control) -> Landing {
      return [take, result = work(control)]() mutable { take(std::move(result)); };
    });
  }
  /// Asks the task to stop; its result still comes.
  void cancel() {
    cancelled_ = cancelled_ || running();
    job_.cancel();
  }
  /// Takes the result when it is there. @return whether the task ended
  bool advance() {
    auto landing = job_.take();
    if (!landing) return false;
    label_.clear();
    (*landing)();
    return true;
  }

  [[nodiscard]] bool running() const { return job_.running(); }
  /// Of the running task; empty: none.
  [[nodiscard]] const std::string& label() const { return label_; }
  [[nodiscard]] double part() const { return job_.part(); }  ///< done, 0 … 1
  [[nodiscard]] double seconds() const {                     ///< since its start
    return std::chrono::duration<double>(Clock::now() - begun_).count();
  }
  /// Estimated from the part done; negative: not known.
  [[nodiscard]] double seconds_left() const { return part() > 0.02 ? seconds() * (1.0 - part()) / part() : -1.0; }
  /// The task begun last was cancelled.
  [[nodiscard]] bool cancelled() const { return cancelled_; }

 private:
  using Clock = std::chrono::steady_clock;
  using Landing = std::function<void()>;
  std::string label_;
  Clock::time_point begun_{};
  bool cancelled_ = false;
  Job<Landing> job_;
};

}  // namespace ecs::commissioning
