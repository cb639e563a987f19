// What F4 copies to the clipboard of the user's own computer, and what is said of a key that does nothing.
// Does not live here: sending it (terminal.hpp).
#pragma once

#include <string>

#include "app/ui/screen.hpp"

namespace ecs::app {

/// The rows that are selected, else the whole picture without header and key line. @param area  of the screen itself
[[nodiscard]] std::string text_to_copy(const Canvas& canvas, const Area& area);

/// "copied: EXX  X axis …"; of several rows how many.
[[nodiscard]] std::string copied_words(const std::string& text);

/// Why a letter that changed nothing did nothing, in one line.
[[nodiscard]] std::string idle_key_words(const Screen& screen, char32_t letter);

}  // namespace ecs::app
