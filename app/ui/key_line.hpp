// The keys of a screen as a table, and the key line at the bottom: what fits of them, and which of them was clicked.
#pragma once

#include <functional>
#include <optional>
#include <string>
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

/// A key of a screen, said once: key line, help and handling follow from it.
struct KeyRow {
  std::string keys;              ///< "v", "up/down", "+ -": each does the same
  std::string does;              ///< empty: the key line does not name it
  std::function<void()> act{};   ///< empty: the screen takes the key by itself
  std::function<bool()> when{};  ///< empty: always
};
/// Those that are there now.
[[nodiscard]] std::vector<KeyHelp> helps_of(const std::vector<KeyRow>& rows);
/// Does what the first row with this key says. @return whether there was one
bool act_on(const std::vector<KeyRow>& rows, const Key& key);

}  // namespace ecs::app
