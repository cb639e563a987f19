// ISO 230-2 values against cases worked by hand, and against published reports of real axes.
#include "laser/analysis/iso230.hpp"

#include <map>

#include <rapidcheck.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/import/import.hpp"
#include "tests/support/readings.hpp"
#include "tests/support/real_data.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

Iso230 evaluated(const MeasurementSet& set) { return must(iso230_of(set, groups_of(set).front())); }

const double root2 = std::sqrt(2.0);

/// "B_avg = 0.02537 [mm]" with or without asterisks → B_avg: 25.37 um.
std::map<std::string, double> axis_values_um(const std::string& report) {
  std::map<std::string, double> values;
  for (const std::string_view line : lines_of(report)) {
    std::string plain;
    for (const char c : line)
      if (c != '*') plain += c;
    const std::size_t equals = plain.find(" = ");
    const std::size_t unit = plain.find(" [mm]");
    if (equals == std::string::npos || unit == std::string::npos || unit < equals) continue;
    if (const auto value = number_in(plain.substr(equals + 3, unit - equals - 3)))
      values.emplace(trimmed(plain.substr(0, equals)), *value * kUmPerMm);
  }
  return values;
}

struct Published {
  const char* name;
  double R_um, E_um;  ///< recomputed by the standard
  double R_and_E_within_um;
  double within_um;  ///< a unit and a half of the last printed digit
};

void check_against_report(const Published& published) {
  CAPTURE(published.name);
  ImportOptions options;
  options.axis = Axis::X;
  const auto imported =
      must(read_any(real_data("ecmc-iso230-2/" + std::string(published.name) + "_ISO230.dat"), options));
  CHECK(imported.format->id == "iso230_assignments");
  const auto groups = groups_of(imported.set);
  REQUIRE(groups.size() == 1);
  const Iso230 axis = must(iso230_of(imported.set, groups.front()));
  const auto report = must(read_file(real_data("ecmc-iso230-2/" + std::string(published.name) + "_report.md")));
  const auto printed = axis_values_um(report);
  // the set called FWD in the data is printed as backward in the report
  const std::map<std::string, double> ours{{"B", *axis.B},
                                           {"B_avg", -*axis.B_mean},
                                           {"R_fwd", *axis.R_reverse},
                                           {"R_bwd", *axis.R_forward},
                                           {"E_fwd", *axis.E_reverse},
                                           {"E_bwd", *axis.E_forward},
                                           {"M", *axis.M},
                                           {"A_fwd", *axis.A_reverse},
                                           {"A_bwd", *axis.A_forward},
                                           {"A", *axis.A}};
  for (const auto& [symbol, value] : ours) {
    CAPTURE(symbol);
    REQUIRE(printed.contains(symbol));
    CHECK(std::abs(value - printed.at(symbol)) <= published.within_um);
  }
  CHECK(std::abs(*axis.R - published.R_um) <= published.R_and_E_within_um);
  CHECK(std::abs(*axis.E - published.E_um) <= published.R_and_E_within_um);
}

}  // namespace

TEST_CASE("two runs at two targets give the values of ISO 230-2 worked by hand") {
  const Iso230 axis = evaluated(set_of({{0.0, {1.0, 3.0}, {-1.0, 1.0}}, {100.0, {5.0, 5.0}, {4.0, 6.0}}}));
  REQUIRE(axis.targets.size() == 2);
  const Iso230Target& first = axis.targets[0];
  CHECK(*first.mean_forward == Approx(2.0));
  CHECK(*first.mean_reverse == Approx(0.0));
  CHECK(*first.mean == Approx(1.0));
  CHECK(*first.B == Approx(2.0));
  CHECK(*first.s_forward == Approx(root2));
  CHECK(*first.R_forward == Approx(4.0 * root2));
  CHECK(*first.R == Approx(4.0 * root2 + 2.0));
  CHECK(*axis.targets[1].R == Approx(4.0 * root2));
  CHECK(*axis.B == Approx(2.0));
  CHECK(*axis.B_mean == Approx(1.0));
  CHECK(*axis.M == Approx(4.0));
  CHECK(*axis.R_forward == Approx(4.0 * root2));
  CHECK(*axis.R_reverse == Approx(4.0 * root2));
  CHECK(*axis.R == Approx(4.0 * root2 + 2.0));
  CHECK(*axis.E_forward == Approx(3.0));
  CHECK(*axis.E_reverse == Approx(5.0));
  CHECK(*axis.E == Approx(5.0));
  CHECK(*axis.A_forward == Approx(3.0 + 2.0 * root2));
  CHECK(*axis.A_reverse == Approx(5.0 + 4.0 * root2));
  CHECK(*axis.A == Approx(5.0 + 4.0 * root2));
  CHECK(*axis.three_sigma_band == Approx(5.0 + 6.0 * root2));
  CHECK(*axis.non_repeatability == Approx(6.0 * root2));
  CHECK(*axis.vdi_Ps == Approx(6.0 * root2));
  CHECK(*axis.vdi_P == Approx((5.0 + 1.5 * root2) - (1.0 - (2.0 + 6.0 * root2) / 2.0)));  // second and first target
  CHECK(axis.range == Approx(7.0));
}

TEST_CASE("B is the largest size, mean B keeps its sign") {
  const Iso230 axis = evaluated(set_of({{0.0, {0.0}, {3.0}}, {10.0, {0.0}, {1.0}}}));
  CHECK(*axis.B == Approx(3.0));
  CHECK(*axis.B_mean == Approx(-2.0));
}

TEST_CASE("one run gives means but no deviations") {
  const Iso230 axis = evaluated(set_of({{0.0, {1.0}, {0.0}}, {10.0, {4.0}, {2.0}}}));
  CHECK(*axis.E == Approx(4.0));
  CHECK_FALSE(axis.R.has_value());
  CHECK_FALSE(axis.A.has_value());
  CHECK_FALSE(axis.three_sigma_band.has_value());
  CHECK(says(axis.notes, "1 forward reading at every target; ISO 230-2 requires 5"));
}

TEST_CASE("the note on the number of readings says \"some targets\" only where others have enough") {
  const auto notes = evaluated(set_of({{0.0, {1.0, 2.0, 3.0}, {0.0, 1.0}}, {10.0, {4.0, 4.0, 5.0}, {2.0}}})).notes;
  CHECK(says(notes, "3 forward readings at every target; ISO 230-2 requires 5"));
  CHECK(says(notes, "fewer than 5 reverse readings at every target (as few as 1)"));
  const auto enough_once = evaluated(set_of({{0.0, {1.0, 2.0, 3.0, 4.0, 5.0}, {}}, {10.0, {4.0, 4.0}, {}}})).notes;
  CHECK(says(enough_once, "fewer than 5 forward readings at some targets (as few as 2)"));
  const auto of_long_axis = evaluated(set_of({{0.0, {1.0, 2.0}, {}}, {2500.0, {4.0, 4.0}, {}}})).notes;
  CHECK(says(of_long_axis, "2 forward readings at every target; ISO 230-2 requires 5 on axes up to 2000 mm"));
}

TEST_CASE("one approach gives unidirectional values only") {
  const Iso230 axis = evaluated(set_of({{0.0, {1.0, 2.0}, {}}, {10.0, {4.0, 4.0}, {}}}));
  CHECK(*axis.E_forward == Approx(2.5));
  CHECK(axis.R_forward.has_value());
  for (const auto& value :
       {axis.B, axis.B_mean, axis.M, axis.R, axis.E, axis.A, axis.E_reverse, axis.A_reverse, axis.vdi_P, axis.vdi_Ps})
    CHECK_FALSE(value.has_value());
  CHECK(says(axis.notes, "forward approach only"));
}

TEST_CASE("readings of unknown approach give the mean range and the band, no effects of approach") {
  MeasurementSet set;
  for (const double error : {1.0, 3.0}) set.readings.push_back(reading(Axis::X, Sense::EX, 0.0, error));
  for (const double error : {5.0, 5.0}) set.readings.push_back(reading(Axis::X, Sense::EX, 10.0, error));
  const Iso230 axis = evaluated(set);
  CHECK(*axis.M == Approx(3.0));
  CHECK(*axis.three_sigma_band == Approx(2.0 + 3.0 * root2 - (2.0 - 3.0 * root2)));
  CHECK_FALSE(axis.B.has_value());
  CHECK(says(axis.notes, "the approach is unknown"));
}

TEST_CASE("unknown approaches beside known ones are left out and counted") {
  MeasurementSet set = set_of({{0.0, {1.0}, {0.0}}, {10.0, {1.0}, {0.0}}});
  set.readings.push_back(reading(Axis::X, Sense::EX, 0.0, 99.0));
  const Iso230 axis = evaluated(set);
  CHECK(*axis.E == Approx(1.0));
  CHECK(says(axis.notes, "1 reading of unknown approach is ignored"));
}

TEST_CASE("conditions of the standard that are not met are named") {
  const Iso230 axis = evaluated(set_of({{0.0, {1.0, 1.0}, {0.0}}, {1000.0, {1.0}, {0.0}}}));
  CHECK(says(axis.notes, "2 targets; ISO 230-2 requires at least 5"));
  CHECK(says(axis.notes, "per metre"));
  CHECK(says(axis.notes, "the number of forward readings differs between targets: 1 to 2"));
}

TEST_CASE("five uneven targets five times each way leave nothing to note") {
  std::vector<Stop> stops;
  for (const double target : {0.0, 101.0, 205.0, 298.0, 400.0})
    stops.push_back({target, {0.1, 0.2, 0.3, 0.2, 0.1}, {0.0, 0.1, 0.2, 0.1, 0.0}});
  CHECK(evaluated(set_of(stops)).notes.empty());
}

TEST_CASE("groups part by axis, sense, parked position and compensation") {
  MeasurementSet set;
  set.readings = {reading(Axis::X, Sense::EX, 0.0, 1.0), reading(Axis::X, Sense::EX, 5.0, 1.0),
                  reading(Axis::X, Sense::EY, 0.0, 1.0), reading(Axis::Y, Sense::EX, 0.0, 1.0),
                  reading(Axis::X, Sense::EX, 0.0, 1.0), reading(Axis::X, Sense::EX, 0.0, 1.0)};
  set.readings[4].position_mm[1] = -1400.0;
  set.readings[5].compensated = true;
  const auto groups = groups_of(set);
  REQUIRE(groups.size() == 5);
  CHECK(groups[0].readings == std::vector<std::size_t>{0, 1});
  CHECK(groups[3].parked_mm == Vector3{0.0, -1400.0, 0.0});
}

TEST_CASE("targets within a hundredth of the smallest step are one") {
  const Iso230 axis = evaluated(set_of({{0.0, {1.0}, {}}, {10.0, {1.0}, {}}, {10.05, {}, {0.0}}, {0.0, {}, {0.0}}}));
  REQUIRE(axis.targets.size() == 2);
  CHECK(axis.targets[1].position_mm == Approx(10.025));
  CHECK(axis.merge_tolerance_mm == Approx(0.1005).epsilon(0.01));
}

TEST_CASE("values do not depend on the order of readings, and a shift moves the means alone") {
  CHECK(rc::check([] {
    MeasurementSet set;
    for (int run = 1; run <= 3; ++run)
      for (int target = 0; target < 4; ++target)
        for (const Approach approach : {Approach::forward, Approach::reverse})
          set.readings.push_back(
              reading(Axis::X, Sense::EX, 50.0 * target, *rc::gen::inRange(-9000, 9000) / 100.0, approach, run));
    const auto before = iso230_of(set, groups_of(set).front());
    MeasurementSet other = set;
    const int shift = *rc::gen::inRange(-500, 500);
    for (Reading& r : other.readings) {
      r.error += shift;
      r.run = 4 - r.run;
    }
    std::rotate(other.readings.begin(), other.readings.begin() + *rc::gen::inRange(0, 24), other.readings.end());
    std::reverse(other.readings.begin(), other.readings.end());
    const auto after = iso230_of(other, groups_of(other).front());
    RC_ASSERT(before.has_value() && after.has_value());
    const auto same = [](const std::optional<double>& a, const std::optional<double>& b) {
      return a.has_value() && b.has_value() && std::abs(*a - *b) < 1e-9;
    };
    for (const auto member :
         {&Iso230::B, &Iso230::B_mean, &Iso230::M, &Iso230::R_forward, &Iso230::R_reverse, &Iso230::R,
          &Iso230::E_forward, &Iso230::E_reverse, &Iso230::E, &Iso230::A_forward, &Iso230::A_reverse, &Iso230::A,
          &Iso230::three_sigma_band, &Iso230::non_repeatability, &Iso230::vdi_Ps, &Iso230::vdi_P})
      RC_ASSERT(same((*before).*member, (*after).*member));
    RC_ASSERT(same(*before->targets[2].mean + shift, after->targets[2].mean));
    RC_ASSERT(*before->A >= *before->E);
    RC_ASSERT(*before->E + 1e-12 >= std::max(*before->E_forward, *before->E_reverse));
  }));
}

TEST_CASE("a published report agrees to its printed digits") {
  check_against_report({"fat_sat", 0.0688, 0.0368, 6e-5, 1.5e-5});
}

TEST_CASE("five published reports agree to their printed digits") {
  SKIP_UNLESS(!real_data("ecmc-iso230-2/b02_x_ISO230.dat").empty(), kNoRealData);
  for (const Published& published :
       {Published{"b02_x", 55.2, 122.8, 0.06, 0.015}, Published{"b02_z", 6.4, 35.3, 0.06, 0.015},
        Published{"muts_x", 201.1, 57.0, 0.06, 0.015}, Published{"muts_back_x2", 291.5, 47.7, 0.06, 0.015},
        Published{"muts_back_y", 156.0, 118.4, 0.06, 0.015}})
    check_against_report(published);
}
