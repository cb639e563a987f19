#include "tests/world/schedule.hpp"

#include <utility>

namespace ecs::world {
namespace {

constexpr std::size_t kStackBytes = 1 << 20;

/// Stacks are used again: a new one costs its pages.
std::vector<std::unique_ptr<std::byte[]>>& spare_stacks() {
  static std::vector<std::unique_ptr<std::byte[]>> stacks;
  return stacks;
}

std::unique_ptr<std::byte[]> a_stack() {
  auto& spare = spare_stacks();
  if (spare.empty()) return std::unique_ptr<std::byte[]>(new std::byte[kStackBytes]);
  auto stack = std::move(spare.back());
  spare.pop_back();
  return stack;
}

Program* entered = nullptr;  ///< the last one: whose stack it is that begins

}  // namespace

Program::Program(Schedule& schedule, std::function<void()> body)
    : schedule_(&schedule), body_(std::move(body)), stack_(a_stack()) {
  ::getcontext(&own_);
  own_.uc_stack.ss_sp = stack_.get();
  own_.uc_stack.ss_size = kStackBytes;
  own_.uc_link = nullptr;
  ::makecontext(&own_, &Program::run, 0);
  waiting_ = true;
  wake();
}

Program::~Program() {
  if (!ended_) kill();
  spare_stacks().push_back(std::move(stack_));
}

void Program::run() {
  Program* const self = entered;
  try {
    if (!self->killed_) self->body_();
  } catch (const Killed&) {
  }
  self->ended_ = true;
  ::swapcontext(&self->own_, &self->back_);
}

void Program::resume() {
  Program* const before = std::exchange(schedule_->running_, this);
  waiting_ = false;
  entered = this;
  ::swapcontext(&back_, &own_);
  schedule_->running_ = before;
}

void Program::wake() {
  if (!waiting_) return;
  schedule_->after({}, [this, number = waits_] {
    if (waiting_ && waits_ == number) resume();
  });
}

void Program::kill() {
  if (ended_) return;
  killed_ = true;
  resume();
}

void Schedule::wait_until(Time time) {
  Program* const self = running_;
  self->waiting_ = true;
  at(time, [self, number = ++self->waits_] {
    if (self->waiting_ && self->waits_ == number) self->resume();
  });
  ::swapcontext(&self->own_, &self->back_);
  if (self->killed_) throw Killed{};
}

bool Schedule::step(Time end) {
  if (events_.empty() || events_.top().time > end) {
    now_ = std::max(now_, end);
    return false;
  }
  const Event event = events_.top();
  events_.pop();
  now_ = event.time;
  event.happens();
  return true;
}

}  // namespace ecs::world
