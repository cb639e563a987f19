#include "params/diff.hpp"

#include <doctest/doctest.h>

#include "params/fields.hpp"
#include "tests/params/support/random_parameters.hpp"

using namespace ecs;
using namespace ecs::params;

TEST_CASE("equal sets have no differences and no text") {
  CHECK(diff(UnitParameters{}, UnitParameters{}).empty());
  CHECK(to_text({}, "a", "b").empty());
}

TEST_CASE("differences name key, unit and both values in full") {
  UnitParameters a;
  UnitParameters b;
  b.axes[1].deadband_um = 0.1 + 0.2;
  b.scope = Scope::linear;
  const std::vector<Difference> expected{{"compensation.scope", "", "volumetric", "linear"},
                                         {"axis.Y.deadband_um", "um", "5", "0.30000000000000004"}};
  CHECK(diff(a, b) == expected);
  CHECK(to_text(diff(a, b), "disc", "unit") ==
        "                    disc        unit\n"
        "compensation.scope  volumetric  linear\n"
        "axis.Y.deadband_um  5 um        0.30000000000000004 um\n");
}

TEST_CASE("a change of any one field is found, and only that") {
  for (const Field& field : fields()) {
    if (field.type == FieldType::text) continue;
    CAPTURE(field.key);
    UnitParameters changed;
    const double other = field.get(changed) == field.most ? field.least : field.most;
    REQUIRE(set_number(field, changed, other));
    const auto found = diff(UnitParameters{}, changed);
    REQUIRE(found.size() == 1);
    CHECK(found[0].key == field.key);
  }
}

TEST_CASE("applying the differences to the first set gives the second") {
  CHECK(rc::check([] {
    UnitParameters a = random_parameters();
    const UnitParameters b = random_parameters();
    for (const Difference& d : diff(a, b)) RC_ASSERT(set(a, d.key, d.b).has_value());
    RC_ASSERT(same_bits(a, b));
  }));
}
