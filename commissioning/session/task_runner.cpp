#include "commissioning/session/task_runner.hpp"

namespace ecs::commissioning {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double kLeastPart = 0.02;  ///< done before a duration is estimated from it

}  // namespace

struct TaskRunner::Shared {
  JobControl control;
  std::mutex mutex;
  Landing landing;
};

void TaskRunner::begin(std::string label, std::function<Landing(JobControl&)> work) {
  label_ = std::move(label);
  begun_ = Clock::now();
  cancelled_ = false;
  shared_ = std::make_shared<Shared>();
  thread_ = std::jthread([shared = shared_, work = std::move(work)] {
    Landing landing = work(shared->control);
    const std::lock_guard lock(shared->mutex);
    shared->landing = std::move(landing);
  });
}

void TaskRunner::cancel() {
  if (!running()) return;
  cancelled_ = true;
  shared_->control.cancelled = true;
}

bool TaskRunner::advance() {
  if (!running()) return false;
  Landing landing;
  {
    const std::lock_guard lock(shared_->mutex);
    landing.swap(shared_->landing);
  }
  if (!landing) return false;
  thread_.join();
  shared_.reset();
  label_.clear();
  landing();
  return true;
}

void TaskRunner::finish() {
  while (running() && !advance()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

double TaskRunner::part() const { return running() ? shared_->control.part.load() : 0.0; }

double TaskRunner::seconds() const { return std::chrono::duration<double>(Clock::now() - begun_).count(); }

double TaskRunner::seconds_left() const {
  const double said = running() ? shared_->control.seconds_left.load() : -1.0;
  if (said >= 0.0) return said;
  return part() > kLeastPart ? seconds() * (1.0 - part()) / part() : -1.0;
}

}  // namespace ecs::commissioning
