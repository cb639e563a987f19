// Ranges of a curve within windows of time. Does not live here: which windows a standard asks for (drift.hpp,
// warm_up.hpp).
#pragma once

#include <span>

namespace ecs::laser {

struct WindowRanges {
  double whole = 0.0;           ///< largest less smallest value
  double first = 0.0;           ///< within the window that begins with the first value
  double largest = 0.0;         ///< the largest within any window
  double largest_from_h = 0.0;  ///< where that window begins
  double last = 0.0;            ///< within the window that ends with the last value
};

/// @param time_h  ascending, as many as values, one at least
[[nodiscard]] WindowRanges window_ranges(std::span<const double> time_h, std::span<const double> value,
                                         double window_h);

}  // namespace ecs::laser
