#include "laser/import/motion.hpp"

#include <cmath>
#include <cstddef>

namespace ecs::laser {
namespace {

constexpr double kSame_mm = 1e-6;

/// Direction of the step to stop `i`: 1, -1, or 0 for none.
int step_to(const std::vector<double>& p, std::size_t i) {
  const double step = p[i] - p[i - 1];
  return std::abs(step) <= kSame_mm ? 0 : step > 0.0 ? 1 : -1;
}

/// For each stop the direction of the next step that is one; 0 where there is none.
std::vector<int> next_steps(const std::vector<double>& p) {
  std::vector<int> next(p.size(), 0);
  for (std::size_t i = p.size() - 1; i-- > 0;) {
    const int step = step_to(p, i + 1);
    next[i] = step != 0 ? step : next[i + 1];
  }
  return next;
}

}  // namespace

std::vector<MotionStop> motion_of(const std::vector<double>& positions_mm) {
  std::vector<MotionStop> stops(positions_mm.size());
  if (positions_mm.empty()) return stops;
  const std::vector<int> next = next_steps(positions_mm);
  int direction = next.front();
  int forward = 0;
  int reverse = 0;
  const auto begin_pass = [&] { return direction >= 0 ? ++forward : ++reverse; };
  int run = begin_pass();
  for (std::size_t i = 0; i < positions_mm.size(); ++i) {
    const int step = i == 0 ? direction : step_to(positions_mm, i);
    const bool turns = step == 0 ? next[i] == -direction && next[i] != 0 : step == -direction;
    const bool jumps = turns && step != 0 && next[i] == direction;  // back to the start of another pass the same way
    if (i > 0 && turns) {
      if (!jumps) direction = -direction;
      run = begin_pass();
    }
    stops[i] = {static_cast<Approach>(direction), run};
  }
  return stops;
}

}  // namespace ecs::laser
