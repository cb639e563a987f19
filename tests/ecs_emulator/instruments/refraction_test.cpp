// The refractive index of air against published numbers: outputs of the NIST Engineering Metrology Toolbox
// (emtoolbox.nist.gov/Wavelength, Ciddor, 450 ppm CO2) and tables 1 to 3 of Ciddor 1996. Facts, quoted.
#include "ecs_emulator/instruments/interferometer.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::emulator;

TEST_CASE("the refractive index is that of the NIST calculator to its last printed digit") {
  struct Row {
    double wavelength_nm, air_degC, pressure_Pa, humidity_pct, index;
  };
  const std::vector<Row> rows{
      {321.456, 20.0, 101'325.0, 50.0, 1.000283543},  {600.1234, 20.0, 101'325.0, 50.0, 1.000271818},
      {700.0, 20.0, 101'325.0, 50.0, 1.000270657},    {1500.8, 20.0, 101'325.0, 50.0, 1.000268190},
      {633.0, -20.0, 101'325.0, 50.0, 1.000314890},   {633.0, 26.7982, 101'325.0, 50.0, 1.000264994},
      {633.0, 60.45, 101'325.0, 50.0, 1.000235516},   {633.0, 20.0, 50'123.0, 50.0, 1.000133999},
      {633.0, 20.0, 140'000.0, 50.0, 1.000375169},    {633.0, 20.0, 101'325.0, 20.123, 1.000271627},
      {633.0, 20.0, 101'325.0, 50.9876, 1.000271364}, {633.0, 20.0, 101'325.0, 90.7432, 1.000271027},
      {633.0, 20.0, 101'325.0, 0.0, 1.000271800},     {633.0, 20.0, 60'000.0, 0.0, 1.000160924},
      {633.0, 20.0, 120'000.0, 0.0, 1.000321916},     {633.0, 50.0, 100'000.0, 0.0, 1.000243285},
      {633.0, 5.0, 100'000.0, 0.0, 1.000282756},      {633.0, -40.0, 100'000.0, 0.0, 1.000337580},
      {633.0, 50.0, 120'000.0, 100.0, 1.000287924},   {633.0, 40.0, 120'000.0, 75.0, 1.000299418},
      {633.0, 20.0, 100'000.0, 100.0, 1.000267394},   {1700.0, 40.0, 110'000.0, 100.0, 1.000270247},
      {1700.0, 20.0, 101'325.0, 0.0, 1.000268479},    {300.0, 40.0, 110'000.0, 100.0, 1.000289000},
      {300.0, 20.0, 101'325.0, 0.0, 1.000286581},     {300.0, -40.0, 120'000.0, 0.0, 1.000427233}};
  for (const Row& row : rows) {
    CAPTURE(row.wavelength_nm);
    CAPTURE(row.air_degC);
    CAPTURE(row.pressure_Pa);
    CAPTURE(row.humidity_pct);
    const Air air{row.air_degC, row.pressure_Pa / 100.0, row.humidity_pct};
    CHECK(refractive_index(air, row.wavelength_nm) == Approx(row.index).epsilon(0.5e-9));
  }
}

TEST_CASE("dry and moist air of Ciddor's own tables come out to the tenth of 1e-8 that they are printed with") {
  struct Dry {
    double air_degC, pressure_Pa, refractivity_1e8;
  };
  for (const Dry& row : std::vector<Dry>{{20.0, 80e3, 21458.0},
                                         {20.0, 100e3, 26824.4},
                                         {20.0, 120e3, 32191.6},
                                         {10.0, 100e3, 27774.7},
                                         {30.0, 100e3, 25937.2}})
    CHECK(std::abs(1e8 * (refractive_index(row.air_degC, row.pressure_Pa, 0.0, 633.0, 450.0) - 1.0) -
                   row.refractivity_1e8) < 0.06);
  struct Moist {
    double air_degC, pressure_Pa, vapour_Pa, co2_ppm, refractivity_1e8;
  };
  for (const Moist& row : std::vector<Moist>{{19.517, 102'096.8, 1065.0, 510.0, 27394.0},
                                             {19.173, 102'993.0, 641.0, 450.0, 27682.4},
                                             {19.173, 103'006.0, 642.0, 440.0, 27685.8},
                                             {19.188, 102'918.8, 706.0, 450.0, 27658.7}})
    CHECK(std::abs(1e8 * (refractive_index(row.air_degC, row.pressure_Pa, row.vapour_Pa / row.pressure_Pa, 633.0,
                                           row.co2_ppm) -
                          1.0) -
                   row.refractivity_1e8) < 0.6);
}

TEST_CASE("a degree, a hectopascal and ten percent change the index as every laser manual says") {
  const double base = refractive_index(kReferenceAir);
  CHECK(refractive_index({21.0, 1013.25, 50.0}) - base == Approx(-0.95e-6).epsilon(0.02));
  CHECK(refractive_index({20.0, 1014.25, 50.0}) - base == Approx(0.268e-6).epsilon(0.01));
  CHECK(refractive_index({20.0, 1013.25, 60.0}) - base == Approx(-0.085e-6).epsilon(0.02));
}

TEST_CASE("water vapour saturates at the pressures of the steam tables, over ice below zero") {
  CHECK(saturation_pressure_Pa(20.0) == Approx(2339.3).epsilon(1e-4));
  CHECK(saturation_pressure_Pa(0.01) == Approx(611.66).epsilon(1e-4));
  CHECK(saturation_pressure_Pa(100.0) == Approx(101'418.0).epsilon(1e-4));
  CHECK(saturation_pressure_Pa(-20.0) == Approx(103.26).epsilon(1e-3));
}
