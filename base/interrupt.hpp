// SIGINT, SIGTERM and SIGHUP as a flag that long work looks at, so that nothing is left half done.
#pragma once

#include <atomic>

namespace ecs {

/// From now on these signals set the flag in place of ending the program. SIGPIPE and SIGXFSZ are ignored, so that a
/// closed pipe or a file that may not grow is a write error like any other.
void catch_signals();

/// Set once a signal came, or while a stop is asked for; hand it to links as LinkOptions::cancelled.
[[nodiscard]] const std::atomic<bool>& interrupted();

/// Whoever runs a verb beside a screen asks it to stop in good order, as Ctrl-C does in a shell.
void ask_to_stop();
/// The verb has stopped: the next one may run. A signal that came meanwhile stays.
void stop_asking();

/// The number of the first signal; 0: none.
[[nodiscard]] int interrupting_signal();

}  // namespace ecs
