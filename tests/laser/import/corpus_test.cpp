// Every file of samples/real is read, or refused with a reason a person understands.
#include "tests/support/import_corpus.hpp"

using namespace ecs;
using namespace ecs::laser;
using doctest::Approx;

TEST_CASE("every file of samples/real is read or refused with the right reason") {
  const auto [read, refused] = check_corpus(
      "samples/real", {
                          {"ecmc-iso230-2/fat_sat_ISO230.dat", "iso230_assignments", 50},
                          {"ecmc-iso230-2", {}, 0, "a test report: the readings stand in the .dat file"},
                          {"interferometer-interpolation-error", {}, 0, "Lissajous figure of an interferometer"},
                          {"linuxcnc-comp/probe_points.txt", "height_map", 25},
                          {"linuxcnc-comp/screwcompX.dat", {}, 0, "11 rows and 3 columns between blanks"},
                          {"nmm-environment/T22-0263_L2_16_1.pos", "sios_environment", 251},
                          {"nmm-environment/test01_XYZ.pos", "sios_environment", 11},
                          {"nmm-environment/T22-0263_L2_15_THP.csv", {}, 0, "an environment table"},
                          {"nmm-environment", {}, 0, "the description of a SIOS scan"},
                          {"refractive-index-vectors", {}, 0, "refractive index of air"},
                          {"zprobe-thermal-drift", {}, 0, "JSON lines of a probe"},
                      });
  CHECK(read == 4);
  CHECK(refused == 10);
}

TEST_CASE("a real compensation table comes in by its columns") {
  ImportOptions screw = by_columns("x_mm=1,forward=2,reverse=3", 0);
  screw.mapping->values = TableValues::actual_positions;
  const auto table = read_any("samples/real/linuxcnc-comp/screwcompX.dat", screw);
  REQUIRE_MESSAGE(table.has_value(), to_text(table.error()));
  REQUIRE(table->set.readings.size() == 22);
  CHECK(table->set.readings[6].error == Approx(-200.0));  // the slip in the line of -4
}
