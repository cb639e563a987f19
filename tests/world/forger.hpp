// Somebody on the line without the code, who sends what no host sends: requests heard before, blocks and commands
// changed, answers in the unit's place. Does not live here: hosts without the code that keep to the protocol
// (world.cpp).
#pragma once

#include "tests/world/line.hpp"

namespace ecs::world {

class Forger {
 public:
  Forger(Schedule& schedule, Random& random, Line& line) : schedule_(schedule), random_(random), line_(line) {}
  void hear(int, int, const Bytes&) {}
  void open_sessions() {}

 private:
  Schedule& schedule_;
  Random& random_;
  Line& line_;
};

}  // namespace ecs::world
