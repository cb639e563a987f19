// Signals that end a verb of `ecs-emulator` in good order: it saves what it holds and returns.
#pragma once

#include <atomic>

#include <sys/types.h>

namespace ecs::emulator {

/// Set by SIGTERM and SIGINT once stop_on_signals() was called.
[[nodiscard]] const std::atomic<int>& stop_requested();

void stop_on_signals();

/// Ends with the process that started this one, not with the thread of it that did: the signal comes for either.
/// @return false: the parent has ended already
[[nodiscard]] bool stop_with_parent(pid_t parent);

}  // namespace ecs::emulator
