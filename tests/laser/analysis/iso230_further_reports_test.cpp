// Published reports of real axes that may not be passed on.
#include "tests/laser/support/iso230_report.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::laser;

TEST_CASE("five published reports agree to their printed digits") {
  SKIP_UNLESS(!real_data("ecmc-iso230-2/b02_x_ISO230.dat").empty(), kNoRealData);
  for (const Published& published :
       {Published{"b02_x", 55.2, 122.8, 0.06, 0.015}, Published{"b02_z", 6.4, 35.3, 0.06, 0.015},
        Published{"muts_x", 201.1, 57.0, 0.06, 0.015}, Published{"muts_back_x2", 291.5, 47.7, 0.06, 0.015},
        Published{"muts_back_y", 156.0, 118.4, 0.06, 0.015}})
    check_against_report(published);
}
