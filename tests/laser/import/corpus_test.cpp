// Every file of samples/real, and real files that may not be passed on: read, or refused with a reason a person
// understands.
#include <filesystem>

#include "laser/groups.hpp"
#include "laser/import/import.hpp"
#include "tests/laser/support/import_options.hpp"
#include "tests/support/real_data.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

/// What is to become of a file: read with this many readings (or records), or refused with these words.
struct Expected {
  const char* file;  ///< below the folder; a folder stands for all files in it not named on their own
  std::string_view format;
  std::size_t count = 0;  ///< 0: not counted
  const char* words = "";
};

const Expected* expected_of(const std::vector<Expected>& corpus, const std::string& name) {
  const Expected* folder = nullptr;
  for (const Expected& expected : corpus) {
    if (name == expected.file) return &expected;
    if (name.starts_with(std::string(expected.file) + "/")) folder = &expected;
  }
  return folder;
}

/// @return how many were read and how many refused
std::pair<int, int> check_corpus(const std::filesystem::path& root, const std::vector<Expected>& corpus) {
  int read = 0, refused = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    if (!entry.is_regular_file() || entry.path().filename() == "SOURCE.md" || entry.path().filename() == "README.md")
      continue;
    const std::string name = std::filesystem::relative(entry.path(), root).generic_string();
    if (name.starts_with("made-up/")) continue;  // no real files
    CAPTURE(name);
    const Expected* const expected = expected_of(corpus, name);
    REQUIRE(expected != nullptr);
    const auto imported = read_any(entry.path(), along_x());
    if (!expected->format.empty()) {
      REQUIRE_MESSAGE(imported.has_value(), to_text(imported.error()));
      CHECK(imported->format->id == expected->format);
      const std::size_t count =
          imported->environment.rows.empty() ? imported->set.readings.size() : imported->environment.rows.size();
      CHECK(count > 0);
      if (expected->count > 0) CHECK(count == expected->count);
      ++read;
    } else {
      REQUIRE_FALSE(imported.has_value());
      CHECK_MESSAGE(contains(imported.error().message, expected->words), to_text(imported.error()));
      CHECK(imported.error().file == entry.path().string());
      ++refused;
    }
  }
  return {read, refused};
}

}  // namespace

TEST_CASE("every file of samples/real and tests/data/real is read or refused with the right reason") {
  const std::vector<Expected> corpus{
      {"ecmc-iso230-2/fat_sat_ISO230.dat", "iso230_assignments", 50},
      {"ecmc-iso230-2", {}, 0, "a test report: the readings are in the .dat file"},
      {"interferometer-interpolation-error", {}, 0, "Lissajous figure of an interferometer"},
      {"linuxcnc-comp/probe_points.txt", {}, 0, "9 columns, separated by blanks"},
      {"linuxcnc-comp/screwcompX.dat", {}, 0, "11 rows and 3 columns, separated by blanks"},
      {"moody-plate/moody.csv", {}, 0, "a set of readings along the lines of a surface"},
      {"moody-plate/heights.csv", {}, 0, "heights of a surface"},
      {"nist-strd", {}, 0, "a reference problem of regression"},
      {"nmm-environment/T22-0263_L2_16_1.pos", "sios_environment", 251},
      {"nmm-environment/test01_XYZ.pos", "sios_environment", 11},
      {"nmm-environment/T22-0263_L2_15_THP.csv", "environment_table"},
      {"nmm-environment", {}, 0, "the description of a SIOS scan"},
      {"refractive-index-vectors", {}, 0, "refractive index of air"},
      {"zprobe-thermal-drift", {}, 0, "the meaning of the channels is not known (atherms.C.set"},
  };
  const auto [read_for_users, refused_for_users] = check_corpus("samples/real", corpus);
  const auto [read_for_tests, refused_for_tests] = check_corpus("tests/data/real", corpus);
  CHECK(read_for_users + read_for_tests == 4);
  CHECK(refused_for_users + refused_for_tests == 18);
}

TEST_CASE("a real compensation table comes in by its columns") {
  ImportOptions screw = by_columns("x_mm=1,forward=2,reverse=3", 0);
  screw.mapping->values = TableValues::actual_positions;
  const auto table = must(read_any("tests/data/real/linuxcnc-comp/screwcompX.dat", screw));
  REQUIRE(table.set.readings.size() == 22);
  CHECK(table.set.readings[6].error == Approx(-200.0));  // the slip in the line of -4
}

TEST_CASE("real probe points come in by their columns") {
  const auto points =
      read_any("tests/data/real/linuxcnc-comp/probe_points.txt", by_columns("x_mm=1,y_mm=2,EZ=3[mm]", 0));
  REQUIRE_MESSAGE(!points.has_value(), "two positions are mapped: the axis must be given");
  ImportOptions options = by_columns("x_mm=1,y_mm=2,EZ=3[mm]", 0);
  options.axis = Axis::X;
  const auto along_x = must(read_any("tests/data/real/linuxcnc-comp/probe_points.txt", options));
  CHECK(along_x.set.readings.size() == 25);
  CHECK(along_x.set.readings[0].position_mm == Vector3{-50.0, -50.0, 0.0});
  CHECK(along_x.set.readings[0].error == Approx(-32.2));
}

TEST_CASE("every further real file is read or refused with the right reason") {
  const char* const root = std::getenv("ECS_REAL_DATA");
  SKIP_UNLESS(root != nullptr, kNoRealData);
  const std::vector<Expected> corpus{
      {"aerotech-2d-cal/2dCal_2021-03-26.txt", {}, 0, "Aerotech two-axis correction table"},
      {"aerotech-2d-cal", {}, 0, "separated by commas"},
      {"bed-mesh/heightmap_v2_9x9.csv", {}, 0, "9 columns"},
      {"bed-mesh/klipper_9x9.cfg", {}, 0, "not a known measurement file"},
      {"centroid-tab", {}, 0, "Centroid compensation table"},
      {"ecmc-iso230-2/b02_x_ISO230.dat", "iso230_assignments", 90},
      {"ecmc-iso230-2/b02_z_ISO230.dat", "iso230_assignments", 50},
      {"ecmc-iso230-2/fat_sat_ISO230.dat", "iso230_assignments", 50},
      {"ecmc-iso230-2/muts_back_x2_ISO230.dat", "iso230_assignments", 50},
      {"ecmc-iso230-2/muts_back_y_ISO230.dat", "iso230_assignments", 50},
      {"ecmc-iso230-2/muts_x_ISO230.dat", "iso230_assignments", 50},
      {"ecmc-iso230-2", {}, 0, "a test report: the readings are in the .dat file"},
      {"epics-pv-logs/slit_11358_axis1_report.md", {}, 0, "a test report"},
      {"epics-pv-logs", {}, 0, "not a known measurement file. It contains"},
      {"five-axis-sphere", {}, 0, "as tool centre points at a ball"},
      {"interferometer-interpolation-error", {}, 0, "Lissajous figure of an interferometer"},
      {"linuxcnc-comp/probe_points.txt", {}, 0, "9 columns, separated by blanks"},
      {"linuxcnc-comp/pocketnc_a.comp", {}, 0, "4 rows and 3 columns, separated by blanks"},
      {"linuxcnc-comp/screwcompX.dat", {}, 0, "11 rows and 3 columns, separated by blanks"},
      {"machine-thermal", {}, 0, "reading=9[um],run=1,t_ambient_degC=3[degC]"},
      {"msl-cmm-simulated/bar_metadata.csv", {}, 0, "simulated ball bar or step gauge"},
      {"msl-cmm-simulated", {}, 0, "simulated ball bar or step gauge"},
      {"nmm-environment/T22-0263_L2_16_1.pos", "sios_environment", 251},
      {"nmm-environment/T22-0263_L2_16b_1.pos", "sios_environment", 251},
      {"nmm-environment/test01_XYZ.pos", "sios_environment", 11},
      {"nmm-environment/T22-0263_L2_15_THP.csv", "environment_table"},
      {"nmm-environment", {}, 0, "the description of a SIOS scan"},
      {"refractive-index-vectors", {}, 0, "refractive index of air"},
      {"resolver-cyclic",
       {},
       0,
       "c_deg=2[deg],reading=4[deg],approach=motion,run=motion,rows=in_motion,time_s=1*1e-7-13290008148.325"},
      {"robot-tracker", {}, 0, "point=1,measured_x_mm=2[mm]"},
      {"sdss-plugplate-cmm/fit_8131_1_2014-10-14.txt", {}, 0, "the result of a plate's fit"},
      {"sdss-plugplate-cmm", "plate"},
      {"servo-backlash", {}, 0, "telemetry of servo drives"},
      {"tpoint-apo35m", {}, 0, "TPOINT"},
      {"zprobe-thermal-drift", {}, 0, "the meaning of the channels is not known (atherms.C.set"},
  };
  const auto [read, refused] = check_corpus(root, corpus);
  CHECK(read >= 14);
  CHECK(refused >= 29);
}

TEST_CASE("the printed extremes of the real height map come back") {
  const auto folder = real_data("bed-mesh");
  SKIP_UNLESS(!folder.empty(), kNoRealData);
  ImportOptions options{
      .sense = Sense::EZ,
      .reading_unit = unit_named("mm"),
      .matrix = MatrixLayout{matrix_axes("x=xmin+xspacing*xnum,y=ymin+yspacing*ynum").value(), "", "", "0", ','}};
  const auto map = must(read_any(folder / "heightmap_v2_9x9.csv", options));
  double least = 1e9, most = -1e9, sum = 0.0;
  for (const Reading& reading : map.set.readings) {
    least = std::min(least, reading.error);
    most = std::max(most, reading.error);
    sum += reading.error;
  }
  CHECK(least == Approx(-50.0));
  CHECK(most == Approx(123.0));
  CHECK(std::abs(sum / 81.0 - 42.0) < 1.0);  // the title rounds to 1 um
  CHECK(map.set.readings.back().position_mm == Vector3{225.0, 10.0 + 8 * 23.12, 0.0});
  options.matrix = MatrixLayout{matrix_axes("x=min_x..max_x,y=min_y..max_y").value(), "[bed_mesh ", "#*#", "0", ','};
  const auto mesh = must(read_any(folder / "klipper_9x9.cfg", options));
  CHECK(mesh.set.readings.front().error == Approx(92.5));
  CHECK(mesh.set.readings.back().position_mm == Vector3{214.0, 190.0, 0.0});
}

TEST_CASE("a real drilled plate: scale and rotation of its own published fit") {
  const auto folder = real_data("sdss-plugplate-cmm");
  SKIP_UNLESS(!folder.empty(), kNoRealData);
  const auto plate = must(read_any(folder / "D8131_1", {}));
  // least squares of error = offset + (scale, rotation) about the centre; FitOffset -0.044 0.079, FitRotAngle 0.029 deg
  double n = 0, sx = 0, sy = 0, ex = 0, ey = 0;
  const auto& r = plate.set.readings;
  for (std::size_t i = 0; i + 1 < r.size(); i += 2) {
    n += 1.0, sx += r[i].position_mm[0], sy += r[i].position_mm[1], ex += r[i].error, ey += r[i + 1].error;
  }
  double turn = 0, stretch = 0, size = 0;
  for (std::size_t i = 0; i + 1 < r.size(); i += 2) {
    const double x = r[i].position_mm[0] - sx / n, y = r[i].position_mm[1] - sy / n;
    turn += x * r[i + 1].error - y * r[i].error;
    stretch += x * r[i].error + y * r[i + 1].error;
    size += x * x + y * y;
  }
  const double rotation_deg = turn / size / 1000.0 * 180.0 / 3.14159265358979;
  CHECK(std::abs(std::abs(rotation_deg) - 0.029) < 0.0006);
  CHECK(std::abs(std::abs(stretch / size / 1000.0) - 7e-6) < 3e-6);
}

TEST_CASE("a real step gauge comes in by its columns") {
  SKIP_UNLESS(!real_data("msl-cmm-simulated").empty(), kNoRealData);
  const auto gauge = must_fail(read_any(real_data("msl-cmm-simulated/bar_fulldata.csv"),
                                        by_columns("x_mm=cmm_nom_x,y_mm=3,z_mm=4,axis_text=1,EX=cmm_dev_x[mm]", 8)));
  CHECK(contains(gauge.message, "which axis moved"));
  ImportOptions along = by_columns("x_mm=cmm_nom_x,y_mm=3,z_mm=4,EX=cmm_dev_x[mm],EY=cmm_dev_y[mm]", 8);
  along.axis = Axis::X;
  const auto gauge_x = must(read_any(real_data("msl-cmm-simulated/bar_fulldata.csv"), along));
  REQUIRE(gauge_x.set.readings.size() == 62);
  CHECK(gauge_x.set.readings[8].error == Approx(0.10));
}
