// Every file of samples/real and tests/data/real is read, or refused with a reason a person understands.
#include "tests/laser/support/import_corpus.hpp"

using namespace ecs;
using namespace ecs::laser;
using doctest::Approx;

TEST_CASE("every file of samples/real and tests/data/real is read or refused with the right reason") {
  const std::vector<Expected> corpus{
      {"ecmc-iso230-2/fat_sat_ISO230.dat", "iso230_assignments", 50},
      {"ecmc-iso230-2", {}, 0, "a test report: the readings are in the .dat file"},
      {"interferometer-interpolation-error", {}, 0, "Lissajous figure of an interferometer"},
      {"linuxcnc-comp/probe_points.txt", {}, 0, "9 columns between blanks"},
      {"linuxcnc-comp/screwcompX.dat", {}, 0, "11 rows and 3 columns between blanks"},
      {"moody-plate/moody.csv", {}, 0, "ecs test flatness"},
      {"moody-plate/heights.csv", {}, 0, "heights of a surface"},
      {"nist-strd", {}, 0, "a reference problem of regression"},
      {"nmm-environment/T22-0263_L2_16_1.pos", "sios_environment", 251},
      {"nmm-environment/test01_XYZ.pos", "sios_environment", 11},
      {"nmm-environment/T22-0263_L2_15_THP.csv", "environment_table"},
      {"nmm-environment", {}, 0, "the description of a SIOS scan"},
      {"refractive-index-vectors", {}, 0, "refractive index of air"},
      {"zprobe-thermal-drift", {}, 0, "which channel is what? there are atherms.C.set"},
  };
  const auto [read_for_users, refused_for_users] = check_corpus("samples/real", corpus);
  const auto [read_for_tests, refused_for_tests] = check_corpus("tests/data/real", corpus);
  CHECK(read_for_users + read_for_tests == 4);
  CHECK(refused_for_users + refused_for_tests == 18);
}

TEST_CASE("a real compensation table comes in by its columns") {
  ImportOptions screw = by_columns("x_mm=1,forward=2,reverse=3", 0);
  screw.mapping->values = TableValues::actual_positions;
  const auto table = read_any("tests/data/real/linuxcnc-comp/screwcompX.dat", screw);
  REQUIRE_MESSAGE(table.has_value(), to_text(table.error()));
  REQUIRE(table->set.readings.size() == 22);
  CHECK(table->set.readings[6].error == Approx(-200.0));  // the slip in the line of -4
}

TEST_CASE("real probe points come in by their columns") {
  const auto points =
      read_any("tests/data/real/linuxcnc-comp/probe_points.txt", by_columns("x_mm=1,y_mm=2,EZ=3[mm]", 0));
  REQUIRE_MESSAGE(!points.has_value(), "two positions are mapped: the axis must be given");
  ImportOptions options = by_columns("x_mm=1,y_mm=2,EZ=3[mm]", 0);
  options.axis = Axis::X;
  const auto along_x = read_any("tests/data/real/linuxcnc-comp/probe_points.txt", options);
  REQUIRE_MESSAGE(along_x.has_value(), to_text(along_x.error()));
  CHECK(along_x->set.readings.size() == 25);
  CHECK(along_x->set.readings[0].position_mm == Vector3{-50.0, -50.0, 0.0});
  CHECK(along_x->set.readings[0].error == Approx(-32.2));
}
