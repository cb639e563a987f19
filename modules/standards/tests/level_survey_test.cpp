// A surface that the workshop cuts, surveyed with an electronic level, against the errors of the machine.
#include "modules/standards/workshop/level_survey.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "base/file.hpp"
#include "ecs_emulator/part_programs/run.hpp"
#include "modules/standards/plate.hpp"
#include "tests/ecs_emulator/support/emulated_unit.hpp"
#include "tests/support/folder.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

constexpr double kEdgeRadius_mm = 30.0;
const FaceCut kCut{{Axis::X, Axis::Y}, -250.0, 2.0 * kEdgeRadius_mm};
/// 24 by 10 steps of 15 mm, whose diagonal has 26.
const LevelSurvey kSurvey{{-430.0, -275.0}, {-70.0, -125.0}, 15.0, 0.0, 3};

/// Errors of the height.
double ezx_um(double x_mm) { return 12.0 * std::sin(2.0 * std::numbers::pi * x_mm / 400.0); }
double ezy_um(double y_mm) { return 2e-4 * (y_mm + 200.0) * (y_mm + 200.0); }
constexpr const char* kHeights =
    "[[contribution]]\ncomponent = \"EZX\"\nformula = \"12*sin(2*pi*p/400)\"\n"
    "[[contribution]]\ncomponent = \"EZY\"\nformula = \"2e-4*(p+200)*(p+200)\"\n";

constexpr double kPasses_mm[] = {-280.0, -240.0, -200.0, -160.0, -120.0};

std::string passes() {
  std::string text = "G90G00X-470Y-280\nG00Z-250\n";
  bool onward = true;
  for (const double y : kPasses_mm) {
    text += fmt::format("G01Y{}F3000\nX{}\n", y, onward ? -30 : -470);
    onward = !onward;
  }
  return text + "M30\n";
}

std::string trace_of(Simulation& simulation) {
  const Folder folder;
  ProgramOrder order;
  order.trace = folder / "trace.csv";
  order.trace_period_s = 0.02;
  (void)must(run_program(simulation, must(parse_program(passes(), "p.nc")), order));
  return must(read_file(order.trace));
}

/// What an edge of the cutter leaves at a place, from the errors themselves: the lowest of the two ways of every pass.
template <class Height>
double cut_height_um(double x_mm, double y_mm, const Height& height_um) {
  double lowest_um = 1e9;
  for (const double pass_mm : kPasses_mm) {
    const double across = y_mm - pass_mm;
    if (std::abs(across) >= kEdgeRadius_mm) continue;
    for (const double side : {-1.0, 1.0}) {
      const double centre_mm = x_mm + side * std::sqrt(kEdgeRadius_mm * kEdgeRadius_mm - across * across);
      if (centre_mm >= -470.0 && centre_mm <= -30.0) lowest_um = std::min(lowest_um, height_um(centre_mm, pass_mm));
    }
  }
  return lowest_um;
}

laser::PlateReadings surveyed(Simulation& simulation, const LevelSurvey& survey = kSurvey) {
  const CutSurface surface = must(CutSurface::parse(trace_of(simulation), "trace.csv", kCut));
  return must(laser::parse_plate_readings(must(survey_with_level(surface, kCut, survey)), "survey.csv"));
}

/// Of measured less expected heights, above their plane of least squares.
double largest_difference_um(const laser::Flatness& found, const std::function<double(double, double)>& height_um) {
  std::vector<double> difference;
  double n = 0, sx = 0, sy = 0, sd = 0, sxx = 0, syy = 0, sxd = 0,
         syd = 0;  // over a rectangle x and y are not correlated
  for (const laser::PlateStation& station : found.stations) {
    const double x = station.x_mm - 0.5 * found.width_mm, y = station.y_mm - 0.5 * found.depth_mm;
    const double d =
        station.height_um - height_um(kSurvey.south_west_mm[0] + station.x_mm, kSurvey.south_west_mm[1] + station.y_mm);
    difference.push_back(d);
    n += 1, sx += x, sy += y, sd += d, sxx += x * x, syy += y * y, sxd += x * d, syd += y * d;
  }
  REQUIRE(std::abs(sx) + std::abs(sy) < 1e-6);
  double largest_um = 0.0;
  for (std::size_t k = 0; k < difference.size(); ++k) {
    const double x = found.stations[k].x_mm - 0.5 * found.width_mm, y = found.stations[k].y_mm - 0.5 * found.depth_mm;
    largest_um = std::max(largest_um, std::abs(difference[k] - sd / n - x * sxd / sxx - y * syd / syy));
  }
  return largest_um;
}

std::string small_trace(const std::string& rows) {
  return "time_s,line,position_x_mm,position_y_mm,command_z_mm,ez_um,rotation_x_um_per_m,rotation_y_um_per_m\n" + rows;
}

std::string refusal_of_survey(const LevelSurvey& survey) {
  auto simulation = simulation_of("", ideal_machine());
  return to_text(
      must_fail(survey_with_level(must(CutSurface::parse(trace_of(simulation), "t.csv", kCut)), kCut, survey)));
}

}  // namespace

TEST_CASE("an edge of the cutter passes twice, and the lower way remains") {
  // Along X at Y 0 with a height of x/10: over the point 50 the front edge passes when the centre is at 20, the rear
  // edge at 80.
  const auto surface =
      must(CutSurface::parse(small_trace("0,1,0,0,-250,0,0,0\n1,1,100,0,-250,10,0,0\n"), "t.csv", kCut));
  CHECK(surface.height_um({50.0, 0.0}).value() == Approx(2.0));
  CHECK(surface.height_um({50.0, 18.0}).value() == Approx(2.6));  // the circle is 24 mm ahead there
  CHECK(surface.height_um({-10.0, 0.0}).value() == Approx(2.0));  // only the rear edge, from the centre at 20
  CHECK_FALSE(surface.height_um({50.0, 31.0}).has_value());
}

TEST_CASE("an inclined cutter cuts with its lower edge") {
  // 100 um/m about Y lower the side of greater X: 3 um at 30 mm.
  const auto pitched =
      must(CutSurface::parse(small_trace("0,1,0,0,-250,0,0,100\n1,1,100,0,-250,0,0,100\n"), "t.csv", kCut));
  CHECK(pitched.height_um({50.0, 0.0}).value() == Approx(-3.0));
  // 100 um/m about X raise the side of greater Y.
  const auto rolled =
      must(CutSurface::parse(small_trace("0,1,0,0,-250,0,100,0\n1,1,100,0,-250,0,100,0\n"), "t.csv", kCut));
  CHECK(rolled.height_um({50.0, 10.0}).value() == Approx(1.0));
  CHECK(rolled.height_um({50.0, -10.0}).value() == Approx(-1.0));
}

TEST_CASE("what is commanded away from the surface does not cut") {
  const auto above = must(CutSurface::parse(
      small_trace("0,1,0,0,-200,-5,0,0\n1,1,100,0,-200,-5,0,0\n2,1,100,0,-250,0,0,0\n3,1,0,0,-250,0,0,0\n"), "t.csv",
      kCut));
  CHECK(above.height_um({50.0, 0.0}).value() == Approx(0.0));
}

TEST_CASE("the level finds the form that the errors of the machine cut into a surface") {
  auto simulation = simulation_of(kHeights, ideal_machine());
  const laser::Flatness found = laser::flatness_of(surveyed(simulation));
  CHECK(found.width_mm == 360.0);
  CHECK(found.depth_mm == 150.0);
  CHECK(std::abs(found.closure_um[0]) < 0.01);
  const auto expected = [](double x_mm, double y_mm) {
    return cut_height_um(x_mm, y_mm, [](double x, double y) { return ezx_um(x) + ezy_um(y); });
  };
  CHECK(found.least_squares_um > 15.0);
  CHECK(largest_difference_um(found, expected) < 0.1);
}

TEST_CASE("a surface that is cut with compensation is flat") {
  Bench bench(kHeights, ideal_machine());
  bench.compensate([](Component c, double p_mm, Approach) {
    return c == Component::EZX ? -ezx_um(p_mm) : c == Component::EZY ? -ezy_um(p_mm) : 0.0;
  });
  // The tables of the unit have a value every 10 mm: straight lines between them leave up to 12 um · (2π·10/400)²/8 =
  // 0.04 um; the unit compensates the axes where they were a period before.
  CHECK(laser::flatness_of(surveyed(bench.simulation)).minimum_zone_um < 1.0);
}

TEST_CASE("inclination of part and level does not count, noise does") {
  auto simulation = simulation_of("", ideal_machine());
  CHECK(laser::flatness_of(surveyed(simulation)).minimum_zone_um < 1e-3);
  LevelSurvey noisy = kSurvey;
  noisy.noise_um_per_m = 10.0;  // 0.15 um a step
  const double with_noise_um = laser::flatness_of(surveyed(simulation, noisy)).minimum_zone_um;
  CHECK(with_noise_um > 0.3);
  CHECK(with_noise_um < 3.0);
}

TEST_CASE("the map predicts the form that the level finds") {
  auto simulation = simulation_of(kHeights, ideal_machine());
  const laser::PlateReadings readings = surveyed(simulation);
  laser::ErrorMap map;
  std::vector<double> place_mm, ezx, ezy;
  for (double p = -500.0; p <= 0.0; p += 5.0) {
    place_mm.push_back(p);
    ezx.push_back(-ezx_um(p));
    ezy.push_back(-ezy_um(p));
  }
  for (const Approach approach : {Approach::forward, Approach::reverse}) {
    map.tables.push_back({Component::EZX, approach, place_mm, ezx});
    map.tables.push_back({Component::EZY, approach, place_mm, ezy});
  }
  const UnitParameters parameters = params::default_parameters_for(simulation.description().machine);
  const auto form = must(laser::predicted_form(readings, laser::flatness_of(readings), map, parameters));
  CHECK(form.least_squares_um > 15.0);
  // The edge runs 30 mm beside the centre, where the errors are others: up to 12 um · 2π/400 mm · 30 mm = 5.7 um.
  CHECK(form.difference_rms_um < 2.0);
  CHECK(form.difference_rms_um > 0.1);
  laser::PlateReadings elsewhere = readings;
  elsewhere.metadata.clear();
  CHECK(contains(to_text(must_fail(laser::predicted_form(elsewhere, laser::flatness_of(readings), map, parameters))),
                 "expected where the surface lay on the machine"));
}

TEST_CASE("surveys that the surface does not allow are refused with what would do") {
  LevelSurvey survey = kSurvey;
  survey.foot_mm = 14.0;
  CHECK(contains(refusal_of_survey(survey), "expected an even number of steps of 14 mm"));
  survey = kSurvey;
  survey.south_west_mm[1] = -245.0;  // 24 by 8 steps: a diagonal of 25.3
  CHECK(contains(refusal_of_survey(survey), "the diagonal has 379.473 mm"));
  survey = kSurvey;
  survey.north_east_mm[1] = 25.0, survey.south_west_mm[1] = -125.0;
  CHECK(contains(refusal_of_survey(survey), "no edge of the cutter has passed"));
  survey = kSurvey;
  std::swap(survey.south_west_mm, survey.north_east_mm);
  CHECK(contains(refusal_of_survey(survey), "expected --to beyond --from"));
  CHECK(contains(to_text(must_fail(CutSurface::parse("time_s,line\n0,1\n", "t.csv", kCut))), "position_x_mm"));
  CHECK(contains(to_text(must_fail(CutSurface::parse(small_trace("0,1,0,0,-250,0,0,0\n"), "t.csv", kCut))),
                 "expected two samples"));
}
