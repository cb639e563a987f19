#include "tests/world/schedule.hpp"

#include <utility>

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/common_interface_defs.h>
#elif defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

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

/// Another stack goes on. A sanitizer has to know which, and what it keeps of each; without one this only switches.
/// @param from  filled with the stack that was left when this one goes on, for the way back
/// @param ends  the one that is left does not go on
void switch_stack(ucontext_t& left, ucontext_t& entered_one, [[maybe_unused]] const StackOf& to,
                  [[maybe_unused]] StackOf* from, [[maybe_unused]] bool ends) {
#if defined(__SANITIZE_ADDRESS__)
  void* kept = nullptr;
  __sanitizer_start_switch_fiber(ends ? nullptr : &kept, to.bottom, to.bytes);
  ::swapcontext(&left, &entered_one);
  __sanitizer_finish_switch_fiber(kept, from ? &from->bottom : nullptr, from ? &from->bytes : nullptr);
#else
#if defined(__SANITIZE_THREAD__)
  __tsan_switch_to_fiber(to.fiber, 0);
#endif
  ::swapcontext(&left, &entered_one);
#endif
}

void* a_fiber() {
#if defined(__SANITIZE_THREAD__)
  return __tsan_create_fiber(0);
#else
  return nullptr;
#endif
}

}  // namespace

Program::Program(Schedule& schedule, std::function<void()> body)
    : schedule_(&schedule),
      body_(std::move(body)),
      stack_(a_stack()),
      own_stack_{stack_.get(), kStackBytes, a_fiber()} {
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
#if defined(__SANITIZE_THREAD__)
  __tsan_destroy_fiber(own_stack_.fiber);
#endif
  spare_stacks().push_back(std::move(stack_));
}

void Program::run() {
  Program* const self = entered;
#if defined(__SANITIZE_ADDRESS__)
  __sanitizer_finish_switch_fiber(nullptr, &self->back_stack_.bottom, &self->back_stack_.bytes);
#endif
  try {
    if (!self->killed_) self->body_();
  } catch (const Killed&) {
  }
  self->ended_ = true;
  switch_stack(self->own_, self->back_, self->back_stack_, nullptr, true);
}

void Program::resume() {
  Program* const before = std::exchange(schedule_->running_, this);
  waiting_ = false;
  entered = this;
#if defined(__SANITIZE_THREAD__)
  back_stack_.fiber = __tsan_get_current_fiber();
#endif
  switch_stack(back_, own_, own_stack_, nullptr, false);
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
  switch_stack(self->own_, self->back_, self->back_stack_, &self->back_stack_, false);
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
