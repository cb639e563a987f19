#include "base/interrupt.hpp"

#include <csignal>

namespace ecs {
namespace {

std::atomic<bool> flag{false};
std::atomic<int> number{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

extern "C" void remember(int signal) {
  int none = 0;
  number.compare_exchange_strong(none, signal);
  flag.store(true);
}

}  // namespace

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = remember;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaction(signal, &action, nullptr);
  action.sa_handler = SIG_IGN;
  for (const int signal : {SIGPIPE, SIGXFSZ}) ::sigaction(signal, &action, nullptr);
}

const std::atomic<bool>& interrupted() { return flag; }
void ask_to_stop() { flag.store(true); }
void stop_asking() { flag.store(number.load() != 0); }
int interrupting_signal() { return number.load(); }

}  // namespace ecs
