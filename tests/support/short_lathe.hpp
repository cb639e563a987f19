// Parameters of a lathe with one axis, and one run of its positioning.
#pragma once

#include <string>

#include <fmt/format.h>

namespace ecs {

inline std::string short_lathe(const std::string& serial_number) {
  return fmt::format(R"(
[identity]
machine = "short lathe"
serial_number = "{}"
[configuration]
chain = "TX"
axes = "X"
[compensation]
scope = "linear"
[axis.X]
transducer = "encoder"
# end of parameters
)",
                     serial_number);
}

/// Positioning of X, −200 … 0 mm, 0.1 um per mm and 2 um of reversal; one run.
inline std::string lathe_readings(const std::string& metadata = "") {
  std::string text = metadata + "axis,sense,x_mm,reading,approach\n";
  for (const int approach : {1, -1})
    for (int x = -200; x <= 0; x += 50) text += fmt::format("X,EX,{},{},{}\n", x, 0.1 * x + approach, approach);
  return text;
}

}  // namespace ecs
