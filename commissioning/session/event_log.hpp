// What the screens said, with the time, newest last; kept in memory for the LOG screen and appended to a file, so that
// an error can be read and copied after it left the screen.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "commissioning/session/message.hpp"

namespace ecs::commissioning {

struct LogEntry {
  std::string time;  ///< "14:05:09", local
  Tone tone = Tone::plain;
  std::string text;
};

/// From any thread. The same text again at once counts once.
void log_event(Tone tone, const std::string& text);
/// The last thousand.
[[nodiscard]] std::vector<LogEntry> logged();
/// What must still be read when the screens are gone: logged, and printed once the terminal is given back.
void leave_word(const std::string& text);
[[nodiscard]] std::vector<std::string> words_left();
/// state_folder()/screens.log; begun afresh when it has grown beyond a megabyte. Empty: there is nowhere to write.
[[nodiscard]] std::filesystem::path log_file();

}  // namespace ecs::commissioning
