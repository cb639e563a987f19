#include "ecs_emulator/verbs/interrupt.hpp"

#include <csignal>

#include <sys/prctl.h>
#include <unistd.h>

namespace ecs::emulator {
namespace {

std::atomic<int> stop = 0;
static_assert(std::atomic<int>::is_always_lock_free);  // a signal handler writes it
extern "C" void on_stop(int /*signal*/) { stop = 1; }
volatile pid_t parent_process = 0;
extern "C" void on_parent_thread_gone(int /*signal*/) {
  if (getppid() != parent_process) stop = 1;
}

void on_signal(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  sigaction(signal, &action, nullptr);
}

}  // namespace

const std::atomic<int>& stop_requested() { return stop; }

void stop_on_signals() {
  on_signal(SIGTERM, on_stop);
  on_signal(SIGINT, on_stop);
  std::signal(SIGPIPE, SIG_IGN);
}

bool stop_with_parent(pid_t parent) {
  parent_process = parent;
  on_signal(SIGUSR1, on_parent_thread_gone);
  prctl(PR_SET_PDEATHSIG, SIGUSR1);
  return getppid() == parent;
}

}  // namespace ecs::emulator
