// Refractive index of air against published values; errors referred to 20 °C and back.
#include "laser/analysis/normalise.hpp"

#include <rapidcheck.h>

#include "base/text.hpp"
#include "laser/import/import.hpp"
#include "laser/writers/writers.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

TEST_CASE("Ciddor and modified Edlen give the published values to 1e-9") {
  const auto text = must(read_file("tests/data/real/refractive-index-vectors/nist_air_index.csv"));
  int rows = 0;
  for (const std::string_view line : lines_of(text)) {
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
  CHECK((*refractive_index({21.0, 1013.25, 50.0, 450.0}) - n) * 1e6 == Approx(-0.95).epsilon(0.03));
  CHECK((*refractive_index({20.0, 1014.25, 50.0, 450.0}) - n) * 1e6 == Approx(0.27).epsilon(0.02));
  CHECK((*refractive_index({20.0, 1013.25, 60.0, 450.0}) - n) * 1e6 == Approx(-0.085).epsilon(0.05));
}

TEST_CASE("half the wavelength in air is what a Renishaw file calls Env factor") {
  const double n = *refractive_index({20.34, 990.39, 46.95, 450.0});
  CHECK(kRedHeNe_nm / 2000.0 / n == Approx(0.3164109).epsilon(3e-6));
}

TEST_CASE("saturation pressure of water vapour at known points") {  // IAPWS
  CHECK(water_vapour_saturation_Pa(100.0) == Approx(101418.0).epsilon(1e-4));
  CHECK(water_vapour_saturation_Pa(26.85) == Approx(3536.59).epsilon(1e-5));  // IF97 table 35, 300 K
  CHECK(water_vapour_saturation_Pa(0.0) == Approx(611.21).epsilon(1e-4));
}

TEST_CASE("air outside the equations is refused with the quantity that is wrong") {
  const auto says = [](const BeamAir& air, const char* what, double wavelength_nm = 633.0) {
    CHECK(must_fail(refractive_index(air, wavelength_nm)).message.starts_with(what));
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
  CHECK(refractive_index_deviation_ppm({25.0, 990.0, 30.0, 450.0}) == Approx(expected));
  CHECK(refractive_index_deviation_ppm({900.0, 1013.25, 50.0, 450.0}) ==
        refractive_index_deviation_ppm({100.0, 1013.25, 50.0, 450.0}));
}

namespace {

MeasurementSet warm(double material_degC) {
  MeasurementSet set = set_of({{0.0, {1.0}, {0.0}}, {500.0, {60.0}, {59.0}}, {1000.0, {120.0}, {119.0}}});
  for (Reading& reading : set.readings) reading.sensors_degC["t_material_degC"] = material_degC;
  return set;
}

Normalisation steel() {
  Normalisation how;
  how.coefficient_um_per_m_degC = 11.7;
  return how;
}

}  // namespace

TEST_CASE("a metre of steel ten degrees warm is 117 um too long, and that is taken off") {
  const auto done = must(normalised(warm(30.0), steel()));
  CHECK(done.set.readings[0].error == 1.0);
  CHECK(done.set.readings[2].error == Approx(60.0 - 58.5));
  CHECK(done.set.readings[4].error == Approx(3.0));
  CHECK(done.changed == 6);
  CHECK(done.largest_um == Approx(117.0));
  CHECK(done.per_coefficient_um == Approx(10.0));
  CHECK(says(done.notes, "coefficient 11.7"));
  CHECK(says(done.notes, "differ in material or temperature"));
  CHECK(says(done.notes, "causes up to 10.000 um"));
}

TEST_CASE("the way back is exact, through a CSV file too") {
  const bool undone = rc::check("denormalised undoes normalised to the last bit", [](double error) {
    RC_PRE(std::isfinite(error));
    const double degC = *rc::gen::inRange(-4900, 14900) / 100.0;
    const double coefficient = *rc::gen::inRange(-90000, 90000) / 93.0;
    MeasurementSet set = warm(degC);
    set.readings[3].error = error;
    Normalisation how;
    how.coefficient_um_per_m_degC = coefficient;
    const auto done = normalised(set, how);
    RC_ASSERT(done.has_value());
    RC_ASSERT(denormalised(done->set) == set);
  });
  CHECK(undone);
  const MeasurementSet set = warm(23.4);
  const auto read = must(parse_measurement_set(to_csv(normalised(set, steel())->set), "n.csv"));
  const auto back = must(denormalised(read));
  for (std::size_t i = 0; i < set.readings.size(); ++i) CHECK(back.readings[i].error == set.readings[i].error);
  CHECK_FALSE(metadata_value(back, "normalised").has_value());
}

TEST_CASE("only the difference to what the instrument applied is applied") {
  MeasurementSet set = warm(30.0);
  set.metadata.push_back({"Exp coeff", "11.700000 11.700000 0"});
  CHECK(must(normalised(set, steel())).set.readings[4].error == 120.0);
  Normalisation none;
  CHECK(must(normalised(set, none)).set.readings[4].error == Approx(237.0));
  none.instrument_um_per_m_degC = 0.0;
  CHECK(normalised(set, none)->set.readings[4].error == 120.0);
}

TEST_CASE("another fixed point, one temperature for all, and straightness left alone") {
  MeasurementSet set = warm(30.0);
  set.readings[4].sense = Sense::EY;
  Normalisation how = steel();
  how.fixed_mm = 500.0;
  how.material_degC = 19.0;
  const auto done = must(normalised(set, how));
  CHECK(done.set.readings[0].error == Approx(1.0 - 5.85));  // cold and below the fixed point
  CHECK(done.set.readings[4].error == 120.0);
  CHECK(done.changed == 5);
}

TEST_CASE("what cannot be referred to 20 degC is refused") {
  MeasurementSet set = warm(30.0);
  CHECK(contains(normalised(normalised(set, steel())->set, steel()).error().message, "already"));
  CHECK(denormalised(set).error().kind == ProblemKind::refused);
  Normalisation how = steel();
  how.sensor = "t_column_degC";
  CHECK(contains(normalised(set, how).error().message, "t_column_degC"));
  how = steel();
  how.material_degC = 500.0;
  CHECK_FALSE(normalised(set, how).has_value());
  for (Reading& reading : set.readings) reading.sense = Sense::EB;
  CHECK(contains(normalised(set, steel()).error().message, "along the moving axis"));
}

TEST_CASE("sensors that differ say that the machine is not at one temperature") {
  MeasurementSet set = warm(24.0);
  for (Reading& reading : set.readings) reading.sensors_degC["t_material2_degC"] = 22.9;
  CHECK(says(normalised(set, steel())->notes, "differ by up to 1.10 degC"));
}
