// Two monotonic queues give largest and smallest of every window in one pass (D. Lemire, Nordic J. Computing 13 (2006)
// 328).
#include "laser/standards/windows.hpp"

#include <algorithm>
#include <cstddef>
#include <deque>

namespace ecs::laser {

WindowRanges window_ranges(std::span<const double> time_h, std::span<const double> value, double window_h) {
  const auto [least, most] = std::minmax_element(value.begin(), value.end());
  WindowRanges ranges{.whole = *most - *least};
  std::deque<std::size_t> rising, falling;  // candidates for the smallest and the largest
  std::size_t begin = 0;
  for (std::size_t i = 0; i < value.size(); ++i) {
    while (!rising.empty() && value[rising.back()] >= value[i]) rising.pop_back();
    while (!falling.empty() && value[falling.back()] <= value[i]) falling.pop_back();
    rising.push_back(i);
    falling.push_back(i);
    while (time_h[i] - time_h[begin] > window_h) ++begin;
    while (rising.front() < begin) rising.pop_front();
    while (falling.front() < begin) falling.pop_front();
    ranges.last = value[falling.front()] - value[rising.front()];
    if (time_h[i] - time_h.front() <= window_h) ranges.first = ranges.last;
    if (ranges.last <= ranges.largest) continue;
    ranges.largest = ranges.last;
    ranges.largest_from_h = time_h[begin];
  }
  return ranges;
}

}  // namespace ecs::laser
