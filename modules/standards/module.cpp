// What the module brings: the verbs of the ISO 230 tests.
#include "app/cli/module.hpp"

#include "base/file_kind.hpp"

namespace ecs::app {

extern const std::vector<Action> kTestsOfHeat, kTestsOfLengths, kTestsOfPaths, kTestsOfPoses, kTestsOfSpindle,
    kTestsOverTime, kWarmUpProgram;

const Module& standards_module() {
  static const Module module{
      .menus = {{"test", "PROCESS LASER DATA: tests of the ISO 230 standards"}},
      .verbs = {{"laser", &kTestsOfHeat},
                {"laser", &kTestsOfLengths},
                {"laser", &kTestsOfPaths},
                {"laser", &kTestsOfPoses},
                {"laser", &kTestsOfSpindle},
                {"laser", &kTestsOverTime},
                {"laser", &kWarmUpProgram}},
      .advice = {{name_of(FileKind::circle_test), "use `ecs test circle {}`"},
                 {name_of(FileKind::ball_bar), "use `ecs test circle TRACE --other {}`"},
                 {kReversalOnCircle, "run `ecs test circle` to see the remaining form at the reversals"},
                 {name_of(FileKind::diagonal_test), "use `ecs test diagonals {}`"},
                 {name_of(FileKind::gauge_blocks), "use `ecs test blocks {}`"},
                 {name_of(FileKind::spindle_test), "use `ecs test spindle {}`"},
                 {name_of(FileKind::surface), "use `ecs test flatness {}`"}}};
  return module;
}

}  // namespace ecs::app
