// Lines that a person, or a script in that place, types while a verb runs.
// Does not live here: what they mean (the verb).
#pragma once

#include <memory>
#include <optional>
#include <string>

namespace ecs::app {

class Keyboard {
 public:
  virtual ~Keyboard() = default;
  /// The next whole line, without its end, if it is there already.
  [[nodiscard]] virtual std::optional<std::string> line() = 0;
  /// No line will come any more.
  [[nodiscard]] virtual bool ended() const = 0;
};

/// Lines of any descriptor, read without waiting. The descriptor stays the caller's.
[[nodiscard]] std::shared_ptr<Keyboard> keyboard_of(int descriptor);
[[nodiscard]] std::shared_ptr<Keyboard> keyboard_of_stdin();

}  // namespace ecs::app
