// The key line at the bottom of every screen: what fits of its keys, and which of them was clicked.
#pragma once

#include <optional>
#include <vector>

#include "app/ui/screen.hpp"

namespace ecs::app {

struct KeyLine {
  std::vector<KeyHelp> keys;  ///< the most useful first
  std::vector<KeyHelp> ends;  ///< at the right edge, always: help, whole texts
};

void draw_key_line(Canvas& canvas, const Area& line, const KeyLine& keys);

/// The key that the line names at a column: of several, "up/down", "+ - 0", the one that was hit, the first if it was
/// what they do. Nothing where there is none, or none that a click can stand for ("1-5").
[[nodiscard]] std::optional<Key> clicked_key(const Area& line, const KeyLine& keys, int column);

/// "Enter", "PgUp", "F1", "Ctrl-U", "d"
[[nodiscard]] std::optional<Key> key_named(std::string_view name);

}  // namespace ecs::app
