// A small model, a machine and measurements: an axis of 1000 mm, three runs both
// ways, normal noise, and whatever error the test adds.
#pragma once

#include <functional>
#include <numbers>
#include <random>

#include <fmt/format.h>

#include "base/random.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {

/// Error at a position for an approach and a run [um].
using TrueError = std::function<double(double x_mm, int approach, int run)>;

struct MeasuredAxis {
  double noise_um = 0.3;
  int runs = 3;
  int targets = 41;
  double step_mm = 25.0;
  unsigned seed = 1;
  bool compensated = false;
};

/// EX along X; targets a little uneven, as ISO 230-2 asks.
inline std::string measured_x(const TrueError& error, const MeasuredAxis& plan = {}) {
  std::mt19937_64 random(plan.seed);
  NormalDraws normal;
  std::string text = plan.compensated ? "axis,sense,x_mm,reading,approach,run,time_s,compensated\n"
                                      : "axis,sense,x_mm,reading,approach,run,time_s\n";
  double time_s = 0.0;
  for (int run = 1; run <= plan.runs; ++run)
    for (const int approach : {1, -1})
      for (int i = 0; i < plan.targets; ++i) {
        const int place = approach > 0 ? i : plan.targets - 1 - i;
        const double x = plan.step_mm * place + 0.17 * plan.step_mm * std::sin(3.0 * place);
        const double reading = error(x, approach, run) + plan.noise_um * normal(random);
        text += fmt::format("X,EX,{:.3f},{:.4f},{},{},{:.0f}{}\n", x, reading, approach, run, time_s += 10.0,
                            plan.compensated ? ",1" : "");
      }
  return text;
}

/// 2 um amplitude, 8 mm period, on top of 5 um/m.
inline double cyclic_x(double x_mm, int, int) {
  return 0.005 * x_mm + 2.0 * std::sin(2.0 * std::numbers::pi * x_mm / 8.0 + 0.4);
}
inline double straight_x(double x_mm, int, int) { return 1.0 + 0.005 * x_mm; }

inline const char* const kStraightModel = R"([[effect]]
id = "offset"
axis = "X"
sense = "EX"

[[effect]]
id = "scale"
axis = "X"
sense = "EX"
)";

inline const char* const kTestMachine = R"(name = "test mill"
configuration = "TXYZ"
[axis.X]
travel_mm = [-10.0, 1010.0]
screw_pitch_mm = 8.0
[axis.Y]
travel_mm = [0.0, 500.0]
[axis.Z]
travel_mm = [0.0, 400.0]
)";

}  // namespace ecs::app
