// What the writer and the reader of leadscrew lists share: units, and the words in which a list of ours says its sign.
// Does not live here: writing (twincat.cpp), reading (twincat_reader.cpp).
#pragma once

#include <string_view>

namespace ecs::controllers {

inline constexpr double kTenthsPerUm = 10.0;
inline constexpr double kTenthsPerMm = 10'000.0;

/// End of the first comment of a list of ours. @param adds  written for a control that adds the values
[[nodiscard]] constexpr std::string_view list_sign(bool adds) {
  return adds ? "nominal minus actual, in 0.1 um; pos and neg: direction of motion"
              : "actual minus nominal, in 0.1 um; pos and neg: direction of motion";
}

}  // namespace ecs::controllers
