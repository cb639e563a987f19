#include "app/ui/screen.hpp"

#include <algorithm>
#include <array>

namespace ecs::app {
namespace {

/// A key as it stands on the line.
struct Hint {
  KeyHelp help;
  int column = 0;
};

int help_columns(const KeyHelp& help) { return width_of(help.keys) + 1 + width_of(help.does); }

std::vector<Hint> hints_on(const Area& line, const KeyLine& keys) {
  std::vector<Hint> hints;
  int end = line.columns - 1;  // the last cell of a terminal stays empty
  for (auto last = keys.ends.rbegin(); last != keys.ends.rend(); ++last) {
    end -= help_columns(*last);
    hints.push_back({*last, end});
    end -= 2;
  }
  int column = 0;
  for (const KeyHelp& help : keys.keys) {
    if (column + help_columns(help) > end) continue;
    hints.push_back({help, column});
    column += help_columns(help) + 2;
  }
  return hints;
}

struct Word {
  std::string text;
  int column = 0;
};

void add_parts(std::vector<Word>& parts, std::string_view text, char between, int column) {
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(between, begin), text.size());
    const std::string_view part = text.substr(begin, end - begin);
    const int at = column + static_cast<int>(begin);
    if (between == ' ' && part.size() > 1 && part.find('/') != std::string_view::npos)
      add_parts(parts, part, '/', at);
    else if (!part.empty())
      parts.push_back({std::string(part), at});
    begin = end + 1;
  }
}

}  // namespace

std::optional<Key> key_named(std::string_view name) {
  using Named = std::pair<std::string_view, Key::Name>;
  static constexpr std::array<Named, 14> kNames{{{"Enter", Key::Name::enter},
                                                 {"Esc", Key::Name::escape},
                                                 {"Tab", Key::Name::tab},
                                                 {"Backspace", Key::Name::backspace},
                                                 {"Del", Key::Name::erase},
                                                 {"up", Key::Name::up},
                                                 {"down", Key::Name::down},
                                                 {"left", Key::Name::left},
                                                 {"right", Key::Name::right},
                                                 {"PgUp", Key::Name::page_up},
                                                 {"PgDn", Key::Name::page_down},
                                                 {"Home", Key::Name::home},
                                                 {"End", Key::Name::end},
                                                 {"Shift-Tab", Key::Name::back_tab}}};
  if (name == "Space") return Key{Key::Name::letter, U' '};
  for (const auto& [text, key] : kNames)
    if (name == text) return Key{key};
  if (name.size() == 2 && name[0] == 'F' && name[1] >= '1' && name[1] <= '9')
    return Key{Key::Name::function, 0, name[1] - '0'};
  if (name.size() == 6 && name.starts_with("Ctrl-"))
    return Key{Key::Name::control, static_cast<char32_t>(name[5] | 0x20)};
  const std::u32string letters = code_points(name);
  if (letters.size() == 1) return Key{Key::Name::letter, letters[0]};
  return std::nullopt;
}

void draw_key_line(Canvas& canvas, const Area& line, const KeyLine& keys) {
  canvas.fill(line, U' ', Tone::faint);
  for (const Hint& hint : hints_on(line, keys)) {
    const int begin = hint.column + canvas.text(line, 0, hint.column, hint.help.keys, Tone::strong);
    canvas.text(line, 0, begin, " " + hint.help.does, Tone::faint);
  }
}

std::optional<Key> clicked_key(const Area& line, const KeyLine& keys, int column) {
  for (const Hint& hint : hints_on(line, keys)) {
    if (column < hint.column || column >= hint.column + help_columns(hint.help)) continue;
    std::vector<Word> words;
    add_parts(words, hint.help.keys, ' ', hint.column);
    std::optional<Key> first;
    for (const Word& word : words) {
      const auto key = key_named(word.text);
      if (key && column >= word.column && column < word.column + width_of(word.text)) return key;
      if (!first) first = key;
    }
    return column > hint.column + width_of(hint.help.keys) ? first : std::nullopt;
  }
  return std::nullopt;
}

std::vector<KeyHelp> helps_of(const std::vector<KeyRow>& rows) {
  std::vector<KeyHelp> helps;
  for (const KeyRow& row : rows)
    if (!row.does.empty() && (!row.when || row.when())) helps.push_back({row.keys, row.does});
  return helps;
}

bool act_on(const std::vector<KeyRow>& rows, const Key& key) {
  for (const KeyRow& row : rows) {
    if (!row.act || (!row.always && row.when && !row.when())) continue;
    std::vector<Word> words;
    add_parts(words, row.keys, ' ', 0);
    const bool named =
        std::any_of(words.begin(), words.end(), [&key](const Word& word) { return key_named(word.text) == key; });
    if (!named) continue;
    row.act();
    return true;
  }
  return false;
}

}  // namespace ecs::app
