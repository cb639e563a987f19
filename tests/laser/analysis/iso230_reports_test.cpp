// A published report of a real axis.
#include "tests/laser/support/iso230_report.hpp"

using namespace ecs;
using namespace ecs::laser;

TEST_CASE("a published report agrees to its printed digits") {
  check_against_report({"fat_sat", 0.0688, 0.0368, 6e-5, 1.5e-5});
}
