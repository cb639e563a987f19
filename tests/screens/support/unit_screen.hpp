// Tests of screens with the emulated unit.
#pragma once

#include "tests/support/emulator.hpp"
#include "tests/support/screen_driver.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app::screen_test {

/// `ecs` with these words, over the link of the connection.
inline int ran_on(UnitConnection& unit, const std::vector<std::string>& words) {
  const auto lent = unit.lend();
  const Ran run = ran(words);
  if (run.code != 0) MESSAGE(run.messages);
  return run.code;
}

/// A map of linear scope for the sample mill.
inline constexpr const char* kLinearMap =
    "# machine: moving column mill\n# configuration: TXYZ\naxis,sense,approach,p_mm,value_um\n"
    "X,EX,0,-4100,1\nX,EX,0,0,5\nY,EY,0,-1400,1\nY,EY,0,0,2\nZ,EZ,0,-1000,1\nZ,EZ,0,0,3\n";

/// Parameters with a map for the sample mill.
inline void give_map(UnitConnection& unit, const StateFolder& one) {
  const std::string params =
      one.with("p.toml",
               "[compensation]\nscope = \"linear\"\n[axis.Y.datum]\napproach_direction = \"reverse\"\n"
               "[axis.X]\ntransducer = \"encoder\"\n[axis.Z]\ntransducer = \"encoder\"\n# end of parameters\n");
  const std::string map = one.with("map.csv", kLinearMap);
  REQUIRE(ran_on(unit, {"map", "send", map, "--params", params}) == 0);
}

}  // namespace ecs::app::screen_test
