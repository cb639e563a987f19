// Keys as the screens know them, whatever terminal sent them.
#pragma once

#include <cstdint>

namespace ecs::app {

struct Key {
  enum class Name : std::uint8_t {
    none,    ///< nothing came in time
    letter,  ///< `letter` says which
    enter,
    escape,
    tab,
    back_tab,
    backspace,
    erase,  ///< Delete
    up,
    down,
    left,
    right,
    page_up,
    page_down,
    home,
    end,
    function,  ///< `number` says which: F1 … F12
    control,   ///< with the letter of `letter`: Ctrl-C is 'c'
    mouse,     ///< pressed at `row`, `column`
    wheel_up,  ///< turned there
    wheel_down,
    resized,  ///< the terminal has another size now
  };
  Name name = Name::none;
  char32_t letter = 0;
  int number = 0;
  int row = 0;
  int column = 0;
  friend bool operator==(const Key&, const Key&) = default;
};

[[nodiscard]] constexpr bool is_letter(const Key& key, char32_t letter) {
  return key.name == Key::Name::letter && key.letter == letter;
}

}  // namespace ecs::app
