// A unit for screens to work on: the bundled emulator with an empty battery, behind the one connection that screens
// share.
#pragma once

#include "tests/support/emulator.hpp"
#include "tests/support/screen_driver.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app::screen_test {

struct UnitBench {
  StateFolder folder;
  std::shared_ptr<UnitConnection> controller = std::make_shared<UnitConnection>("emulator");

  /// Until the unit answered for the first time.
  void wait_for_unit() const {
    for (int k = 0; k < 3000 && !controller->newest(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    REQUIRE(controller->newest());
  }
  /// Until the unit's own clock shows that time: a restart is seen by it.
  void wait_until_it_ran(std::chrono::microseconds time) const {
    const auto ran = [&] {
      const auto newest = controller->newest();
      return newest && newest->unit_time_us >= static_cast<std::uint64_t>(time.count());
    };
    for (int k = 0; k < 3000 && !ran(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    REQUIRE(ran());
  }
  /// Does work on the line as a screen would, without a screen.
  template <class Work>
  auto with_link(Work work) const {
    JobControl control;
    return controller->with_link(control, work);
  }
};

/// A screen of a unit that has answered.
struct BenchOf : UnitBench {
  explicit BenchOf(std::unique_ptr<Screen> (*opened)(std::shared_ptr<UnitConnection>)) {
    wait_for_unit();
    screen = opened(controller);
  }
  std::unique_ptr<Screen> screen;
};

}  // namespace ecs::app::screen_test
