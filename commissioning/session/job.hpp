// Work too long for the moment between two keys: it runs beside the screen, tells how far it is, can be cancelled, and
// its result is taken when it is there. Does not live here: the work.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

namespace ecs::commissioning {

/// What the work sees of its owner.
struct JobControl {
  std::atomic<bool> cancelled{false};
  std::atomic<double> part{0.0};  ///< 0 … 1
};

/// At most one piece of work at a time; its owner's end waits for it.
template <class T>
class Job {
 public:
  using Work = std::function<T(JobControl&)>;
  Job() = default;
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;
  ~Job() { cancel(); }

  [[nodiscard]] bool running() const { return shared_ != nullptr; }
  [[nodiscard]] double part() const { return shared_ ? shared_->control.part.load() : 0.0; }

  /// @pre !running()
  void start(Work work) {
    shared_ = std::make_shared<Shared>();
    thread_ = std::jthread([shared = shared_, work = std::move(work)] {
      T result = work(shared->control);
      const std::lock_guard lock(shared->mutex);
      shared->result.emplace(std::move(result));
    });
  }
  /// Asks the work to stop; its result still comes.
  void cancel() {
    if (shared_) shared_->control.cancelled = true;
  }
  /// The result, once; nothing as long as it is not there.
  [[nodiscard]] std::optional<T> take() {
    if (!shared_) return std::nullopt;
    std::optional<T> result;
    {
      const std::lock_guard lock(shared_->mutex);
      result.swap(shared_->result);
    }
    if (result) {
      thread_.join();
      shared_.reset();
    }
    return result;
  }

 private:
  struct Shared {
    JobControl control;
    std::mutex mutex;
    std::optional<T> result;
  };
  std::shared_ptr<Shared> shared_;
  std::jthread thread_;
};

}  // namespace ecs::commissioning
