// Refractive index of air against published values.
#include "laser/analysis/refraction.hpp"

#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include "base/text.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

TEST_CASE("Ciddor and modified Edlen give the published values to 1e-9") {
  const auto text = read_file("tests/data/real/refractive-index-vectors/nist_air_index.csv");
  REQUIRE(text.has_value());
  int rows = 0;
  for (const std::string_view line : lines_of(*text)) {
    const auto cells = split(line, ',');
    if (cells.size() != 7 || !number_in(cells[1])) continue;
    const BeamAir air{*number_in(cells[2]), *number_in(cells[3]) / 100.0, *number_in(cells[4]), *number_in(cells[5])};
    const auto n = refractive_index(air, *number_in(cells[1]),
                                    cells[0] == "ciddor" ? AirEquation::ciddor : AirEquation::modified_edlen);
    CAPTURE(std::string(line));
    REQUIRE(n.has_value());
    CHECK(std::abs(*n - *number_in(cells[6])) < 1e-9);
    ++rows;
  }
  CHECK(rows == 13);
}

TEST_CASE("laboratory air at 633 nm") {  // NIST wavelength calculator
  CHECK(std::abs(*refractive_index({}, 633.0) - 1.000271373) < 1e-9);
  CHECK(std::abs(*refractive_index({}, 633.0, AirEquation::modified_edlen) - 1.000271374) < 1e-9);
}

TEST_CASE("the rules of thumb: a degree is -0.95 ppm, a hectopascal 0.27 ppm, ten percent humidity -0.085 ppm") {
  const double n = *refractive_index({});
  CHECK((*refractive_index({21.0, 1013.25, 50.0, 450.0}) - n) * 1e6 == doctest::Approx(-0.95).epsilon(0.03));
  CHECK((*refractive_index({20.0, 1014.25, 50.0, 450.0}) - n) * 1e6 == doctest::Approx(0.27).epsilon(0.02));
  CHECK((*refractive_index({20.0, 1013.25, 60.0, 450.0}) - n) * 1e6 == doctest::Approx(-0.085).epsilon(0.05));
}

TEST_CASE("half the wavelength in air is what a Renishaw file calls Env factor") {
  const double n = *refractive_index({20.34, 990.39, 46.95, 450.0});
  CHECK(kRedHeNe_nm / 2000.0 / n == doctest::Approx(0.3164109).epsilon(3e-6));
}

TEST_CASE("saturation pressure of water vapour at known points") {  // IAPWS
  CHECK(water_vapour_saturation_Pa(100.0) == doctest::Approx(101418.0).epsilon(1e-4));
  CHECK(water_vapour_saturation_Pa(26.85) == doctest::Approx(3536.59).epsilon(1e-5));  // IF97 table 35, 300 K
  CHECK(water_vapour_saturation_Pa(0.0) == doctest::Approx(611.21).epsilon(1e-4));
}

TEST_CASE("air outside the equations is refused with the quantity that is wrong") {
  const auto says = [](const BeamAir& air, const char* what, double wavelength_nm = 633.0) {
    const auto n = refractive_index(air, wavelength_nm);
    REQUIRE_FALSE(n.has_value());
    CHECK(n.error().message.starts_with(what));
  };
  says({200.0, 1013.25, 50.0, 450.0}, "air temperature");
  says({20.0, 101325.0, 50.0, 450.0}, "air pressure");
  says({20.0, 1013.25, 101.0, 450.0}, "relative humidity");
  says({20.0, 1013.25, std::nan(""), 450.0}, "relative humidity");
  says({}, "vacuum wavelength", 6330.0);
}

TEST_CASE("the deviation counts from the reference air, and stays finite outside the range of the equations") {
  CHECK(refractive_index_deviation_ppm({}) == 0.0);
  const double expected = (*refractive_index({25.0, 990.0, 30.0, 450.0}) - *refractive_index({})) * 1e6;
  CHECK(refractive_index_deviation_ppm({25.0, 990.0, 30.0, 450.0}) == doctest::Approx(expected));
  CHECK(refractive_index_deviation_ppm({900.0, 1013.25, 50.0, 450.0}) ==
        refractive_index_deviation_ppm({100.0, 1013.25, 50.0, 450.0}));
}
