// Which transaction meets which fault.
#include "protocol/line/faults.hpp"

#include <doctest/doctest.h>

using namespace ecs::protocol;

TEST_CASE("every fault has a name and is found by it") {
  for (std::size_t k = 0; k < kLinkFaults; ++k) {
    const auto fault = static_cast<LinkFault>(k);
    CHECK(link_fault_named(name_of(fault)) == fault);
  }
  CHECK_FALSE(link_fault_named("no_replies"));
}

TEST_CASE("counted faults come first, in the order of their names, and end with their count") {
  LinkFaults faults;
  faults.next(LinkFault::bad_crc, 1);
  faults.next(LinkFault::no_reply, 2);
  CHECK(faults.draw() == LinkFault::no_reply);
  CHECK(faults.draw() == LinkFault::no_reply);
  CHECK(faults.draw() == LinkFault::bad_crc);
  CHECK_FALSE(faults.draw());
}

TEST_CASE("a fault of probability one in four meets about a quarter, the same for the same seed") {
  LinkFaults faults(5), again(5);
  faults.with_probability(LinkFault::drop_byte, 0.25);
  again.with_probability(LinkFault::drop_byte, 0.25);
  int met = 0;
  for (int k = 0; k < 4000; ++k) {
    const auto drawn = faults.draw();
    CHECK(drawn == again.draw());
    if (drawn) ++met;
  }
  CHECK(met > 850);
  CHECK(met < 1150);
  faults.clear();
  for (int k = 0; k < 100; ++k) CHECK_FALSE(faults.draw());
}

TEST_CASE("the place of a fault is inside the frame") {
  LinkFaults faults;
  for (int k = 0; k < 100; ++k) CHECK(faults.place(7) < 7);
  CHECK(faults.place(1) == 0);
}
