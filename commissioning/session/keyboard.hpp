// Lines that a person, or a script in that place, types while something runs.
#pragma once

#include <optional>
#include <string>

namespace ecs::commissioning {

class Keyboard {
 public:
  virtual ~Keyboard() = default;
  /// The next whole line, without its end, if it is there already.
  [[nodiscard]] virtual std::optional<std::string> line() = 0;
  /// No line will come any more.
  [[nodiscard]] virtual bool ended() const = 0;
};

}  // namespace ecs::commissioning
