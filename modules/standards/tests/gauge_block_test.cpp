// Scale and constant from lengths against values that a hand can compute.
#include <cmath>
#include <random>

#include <fmt/format.h>

#include "laser/measurement_set.hpp"
#include "model/data/path.hpp"
#include "modules/standards/gauge_block_fit.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

/// A length that the machine measured with an error of its own: error = true − measured.
BlockReading measured(double nominal_mm, double error_um, Touch touch = Touch::outside, double U_um = 0.0) {
  return {.block = fmt::format("{}", nominal_mm),
          .touch = touch,
          .nominal_mm = nominal_mm,
          .measured_mm = nominal_mm - error_um / 1000.0,
          .U_um = U_um};
}

BlockFit fit_of(std::vector<BlockReading> readings) { return block_fit_of({.readings = std::move(readings)}); }

/// Two lengths, each read twice 0.2 um apart: −5 um/m and a probe that is 3 um larger give −3.5 and −4.5 um.
std::vector<BlockReading> two_lengths(double U_um) {
  return {measured(100, -3.4, Touch::outside, U_um), measured(100, -3.6, Touch::outside, U_um),
          measured(300, -4.4, Touch::outside, U_um), measured(300, -4.6, Touch::outside, U_um)};
}

std::string refusal_of(const std::string& text) { return to_text(must_fail(parse_gauge_blocks(text, "b.csv"))); }

}  // namespace

TEST_CASE("two lengths separate a scale of -5 um/m from a probe that is 3 um larger than assumed") {
  const BlockFit fit = fit_of(two_lengths(0.0));
  CHECK(must(fit.scale_um_per_m).value == Approx(-5.0));
  CHECK(must(fit.constant_um).value == Approx(3.0));
  CHECK_FALSE(fit.error_um);
}

TEST_CASE("repeats 0.2 um apart give 0.141 um, hence 0.707 um/m over 200 mm, and 0.158 um at length 0") {
  // means ±0.1: slope 0.1·√2/0.2, at 0: 0.1·√(0.1² + 0.3²)/0.2
  const BlockFit fit = fit_of(two_lengths(0.0));
  CHECK(must(fit.noise_um) == Approx(std::sqrt(0.02)));
  CHECK(fit.degrees_of_freedom == 2.0);
  CHECK(must(must(fit.scale_um_per_m).u_readings) == Approx(0.1 * std::sqrt(2.0) / 0.2).epsilon(1e-6));
  CHECK(must(must(fit.constant_um).u_readings) == Approx(0.1 * std::sqrt(0.1) / 0.2).epsilon(1e-6));
  // 95.45 % of Student's t with 2 degrees of freedom lie within ±4.527
  CHECK(fit.scale_um_per_m->U == Approx(4.527 * 0.7071).epsilon(1e-3));
}

TEST_CASE("certificates of U = 0.2 um (k = 2) add u = 0.707 um/m over 200 mm, however often the blocks are read") {
  const BlockFit fit = fit_of(two_lengths(0.2));
  CHECK(must(fit.scale_um_per_m).u_calibration == Approx(0.1 * std::sqrt(2.0) / 0.2).epsilon(1e-6));
  CHECK(must(fit.constant_um).u_calibration == Approx(0.1 * std::sqrt(0.1) / 0.2).epsilon(1e-6));
}

TEST_CASE("one length touched outside and inside: the mean is the scale, half the difference the constant") {
  const BlockFit fit = fit_of({measured(200, -4.0), measured(200, 2.0, Touch::inside)});
  CHECK(must(fit.scale_um_per_m).value == Approx(-5.0));
  CHECK(must(fit.constant_um).value == Approx(3.0));
}

TEST_CASE("one length touched in one way gives its error only, and the note says which measurement separates") {
  const BlockFit fit = fit_of({measured(100, -3.4), measured(100, -3.6)});
  CHECK_FALSE(fit.scale_um_per_m);
  CHECK_FALSE(fit.constant_um);
  CHECK(must(fit.error_um).value == Approx(-3.5));
  CHECK(must(fit.error_um->u_readings) == Approx(0.1));
  check_holds(fit.notes.front(), {"cannot be separated", "100 mm", "second length", "the same inside"});
}

TEST_CASE("steps show the scale alone: a probe touches both faces in the same direction") {
  const BlockFit fit = fit_of({measured(100, -0.5, Touch::step), measured(300, -1.5, Touch::step)});
  CHECK(must(fit.scale_um_per_m).value == Approx(-5.0));
  CHECK_FALSE(fit.constant_um);
}

TEST_CASE("two lengths read once have no known scatter, and the note says so") {
  const BlockFit fit = fit_of({measured(100, -3.5, Touch::outside, 0.2), measured(300, -4.5, Touch::outside, 0.2)});
  CHECK_FALSE(fit.noise_um);
  CHECK(must(fit.scale_um_per_m).U == Approx(2.0 * fit.scale_um_per_m->u_calibration));
  check_holds(fit.notes.front(), {"scatter of the readings is unknown"});
}

TEST_CASE("a steel block of 100 mm at 30 degC is 11.5 um longer, which is no error of the machine") {
  BlockTest test{.readings = {measured(100, -11.5, Touch::step), measured(200, -23.0, Touch::step)}};
  for (BlockReading& reading : test.readings) reading.block_degC = 30.0;
  const BlockFit fit = block_fit_of(test);
  CHECK(std::abs(must(fit.scale_um_per_m).value) < 1e-6);
  // ISO 3650: within ±1 um/m/degC, rectangular, over 10 degC
  CHECK(fit.scale_um_per_m->u_calibration == Approx(10.0 / std::sqrt(3.0)).epsilon(1e-6));
}

TEST_CASE("a scale at 30 degC that expands by 11 um/m/degC is 110 um/m too long there and right at 20 degC") {
  BlockTest test{.machine_expansion_um_per_m_degC = 11.0, .readings = {measured(100, 11.0), measured(300, 33.0)}};
  for (BlockReading& reading : test.readings) reading.machine_degC = 30.0;
  CHECK(std::abs(must(block_fit_of(test).scale_um_per_m).value) < 1e-6);
}

TEST_CASE("a cutter that is 3 um larger makes outside lengths smaller and slots wider, at any scale") {
  const auto cut = [](double nominal_mm, double measured_mm, Touch touch) {
    return BlockReading{.touch = touch, .nominal_mm = nominal_mm, .measured_mm = measured_mm};
  };
  // +10 um/m: 1 um over 100 mm, 2 um over 200 mm
  const BlockFit fit = block_fit_of({.cut = true,
                                     .readings = {cut(100, 99.998, Touch::outside), cut(200, 199.999, Touch::outside),
                                                  cut(100, 100.004, Touch::inside)}});
  CHECK(must(fit.scale_um_per_m).value == Approx(10.0));
  CHECK(must(fit.constant_um).value == Approx(3.0));
}

TEST_CASE("lengths on a bow lack fit, and U grows to their scatter about the straight line") {
  std::vector<BlockReading> readings;
  for (const double length_mm : {100.0, 200.0, 300.0, 400.0})
    for (const double noise_um : {-0.1, 0.1})
      readings.push_back(measured(length_mm, noise_um + (length_mm == 200.0 || length_mm == 300.0 ? 2.0 : -2.0)));
  const BlockFit fit = fit_of(readings);
  CHECK(must(fit.lack_of_fit_p) < 1e-3);
  // residuals ±2 um of 4 means with 2 degrees of freedom: √8 um a mean, over √Σ(L − 0.25 m)² = √0.05 m
  CHECK(must(must(fit.scale_um_per_m).u_readings) == Approx(std::sqrt(8.0 / 0.05)).epsilon(1e-3));
}

TEST_CASE("identical readings on a display of 1 um scatter by its rounding, 0.29 um") {
  BlockTest test{.resolution_um = 1.0, .readings = {measured(100, -3.0), measured(100, -3.0), measured(300, -4.0)}};
  CHECK(must(block_fit_of(test).noise_um) == Approx(1.0 / std::sqrt(12.0)));
}

TEST_CASE("U contains the true scale and constant in 95 of 100 sets of blocks, with and without repeats") {
  std::mt19937 draw(20261127);
  std::normal_distribution<double> normal;
  for (const int repeats : {1, 3}) {
    int scales = 0, constants = 0;
    constexpr int kSets = 1000;
    for (int set = 0; set < kSets; ++set) {
      std::vector<BlockReading> readings;
      for (const double length_mm : {20.0, 50.0, 100.0, 200.0, 400.0, 500.0}) {
        const double certificate_um = 0.15 * normal(draw);
        for (int i = 0; i < repeats; ++i)
          readings.push_back(measured(length_mm, -8.0 * length_mm / 1000.0 - 5.0 + certificate_um + 0.3 * normal(draw),
                                      Touch::outside, 0.3));
      }
      const BlockFit fit = fit_of(readings);
      scales += std::abs(must(fit.scale_um_per_m).value + 8.0) < fit.scale_um_per_m->U ? 1 : 0;
      constants += std::abs(must(fit.constant_um).value - 5.0) < fit.constant_um->U ? 1 : 0;
    }
    // 95.45 % of 1000, four standard deviations of a count
    CHECK(scales > 928);
    CHECK(scales < 985);
    CHECK(constants > 928);
    CHECK(constants < 985);
  }
}

TEST_CASE("a length is two readings of a model: 0 where it begins, its error where it ends, touched from both sides") {
  BlockTest test{.axis = Axis::Y, .readings = {measured(100, -3.5), measured(50, 2.0, Touch::inside)}};
  test.readings[0].from_mm = -20.0;
  const MeasurementSet set = model::set_of_blocks(test);
  REQUIRE(set.readings.size() == 4);
  CHECK(set.readings[0].position_mm[1] == -20.0);
  CHECK(set.readings[0].approach == Approach::forward);
  CHECK(set.readings[1].position_mm[1] == 80.0);
  CHECK(set.readings[1].error == Approx(-3.5));
  CHECK(set.readings[1].approach == Approach::reverse);
  CHECK(set.readings[1].extras.at("touch") == -1.0);
  CHECK(set.readings[1].text_extras.at("path") == "diagonal 100 from 0 -20 0 to 0 80 0");
  CHECK(set.readings[2].approach == Approach::reverse);
  CHECK(set.readings[3].approach == Approach::forward);
}

TEST_CASE("a file of lengths states every fault with its place") {
  check_holds(refusal_of("# axis: U\nnominal_mm,measured_mm,touch\n100,102,outside\n-1,x,around\n"),
              {"axis", "b.csv:3:5: measured_mm", "b.csv:4:1: nominal_mm", "b.csv:4:6: touch"});
  check_holds(refusal_of("# axis: X\nnominal_mm,measured_mm\n"), {"expected measured lengths"});
}
