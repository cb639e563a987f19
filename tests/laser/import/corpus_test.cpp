// Every real file beside the checkout is read, or refused with a reason a person understands.
#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "base/text.hpp"
#include "laser/analysis/groups.hpp"
#include "laser/analysis/iso230.hpp"
#include "laser/import/import.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;
using doctest::Approx;

namespace {

/// What is to become of a file: read with so many readings (or records), or refused with these words.
struct Expected {
  const char* file;  ///< below shared/data; a folder stands for all files in it not named by themselves
  std::string_view format;
  std::size_t count = 0;  ///< 0: not counted
  const char* words = "";
};

const std::vector<Expected>& corpus() {
  static const std::vector<Expected> kCorpus{
      {"aerotech-2d-cal/2dCal_2021-03-26.txt", {}, 0, "Aerotech two-axis correction table"},
      {"aerotech-2d-cal", {}, 0, "between commas"},
      {"bed-mesh/heightmap_v2_9x9.csv", "height_map", 81},
      {"bed-mesh/klipper_9x9.cfg", "height_map", 81},
      {"centroid-tab", {}, 0, "nothing in it names a format"},
      {"ecmc-iso230-2/b02_x_ISO230.dat", "iso230_assignments", 90},
      {"ecmc-iso230-2/b02_z_ISO230.dat", "iso230_assignments", 50},
      {"ecmc-iso230-2/fat_sat_ISO230.dat", "iso230_assignments", 50},
      {"ecmc-iso230-2/muts_back_x2_ISO230.dat", "iso230_assignments", 50},
      {"ecmc-iso230-2/muts_back_y_ISO230.dat", "iso230_assignments", 50},
      {"ecmc-iso230-2/muts_x_ISO230.dat", "iso230_assignments", 50},
      {"ecmc-iso230-2", {}, 0, "a test report: the readings stand in the .dat file"},
      {"epics-pv-logs/sensor1_calib.log", "channel_log"},
      {"epics-pv-logs/sensor2_calib.log", "channel_log"},
      {"epics-pv-logs/slit_11358_axis1_report.md", {}, 0, "a test report"},
      {"epics-pv-logs", {}, 0, "the log holds several channels: give one of"},
      {"interferometer-interpolation-error", {}, 0, "Lissajous figure of an interferometer"},
      {"linuxcnc-comp/probe_points.txt", "height_map", 25},
      {"linuxcnc-comp/pocketnc_a.comp", {}, 0, "4 rows and 3 columns between blanks"},
      {"linuxcnc-comp/screwcompX.dat", {}, 0, "11 rows and 3 columns between blanks"},
      {"msl-cmm-simulated/bar_metadata.csv", {}, 0, "simulated ball bar or step gauge"},
      {"msl-cmm-simulated", {}, 0, "simulated ball bar or step gauge"},
      {"nmm-environment/T22-0263_L2_16_1.pos", "sios_environment", 251},
      {"nmm-environment/T22-0263_L2_16b_1.pos", "sios_environment", 251},
      {"nmm-environment/test01_XYZ.pos", "sios_environment", 11},
      {"nmm-environment/T22-0263_L2_15_THP.csv", {}, 0, "an environment table"},
      {"nmm-environment", {}, 0, "the description of a SIOS scan"},
      {"refractive-index-vectors", {}, 0, "refractive index of air"},
      {"sdss-plugplate-cmm/fit_8131_1_2014-10-14.txt", {}, 0, "the result of a plate's fit"},
      {"sdss-plugplate-cmm", "plate"},
      {"servo-backlash", {}, 0, "telemetry of servo drives"},
      {"tpoint-apo35m", {}, 0, "TPOINT"},
      {"zprobe-thermal-drift", {}, 0, "JSON lines of a probe"},
  };
  return kCorpus;
}

const Expected* expected_of(const std::string& name) {
  const Expected* folder = nullptr;
  for (const Expected& expected : corpus()) {
    if (name == expected.file) return &expected;
    if (name.starts_with(std::string(expected.file) + "/")) folder = &expected;
  }
  return folder;
}

ImportOptions along_x() {
  ImportOptions options;
  options.axis = Axis::X;
  return options;
}

ImportOptions by(const std::string& columns, int skip) {
  ImportOptions options;
  options.mapping = column_mapping(columns).value();
  options.mapping->skip_lines = skip;
  return options;
}

}  // namespace

TEST_CASE("every file of the shared data is read or refused with the right reason") {
  const auto root = shared_data("");
  if (root.empty()) return;
  int read = 0, refused = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    if (!entry.is_regular_file() || entry.path().filename() == "SOURCE.md") continue;
    const std::string name = std::filesystem::relative(entry.path(), root).generic_string();
    CAPTURE(name);
    const Expected* const expected = expected_of(name);
    REQUIRE(expected != nullptr);
    const auto imported = read_any(entry.path(), along_x());
    if (!expected->format.empty()) {
      REQUIRE_MESSAGE(imported.has_value(), to_text(imported.error()));
      CHECK(imported->format->id == expected->format);
      const std::size_t count =
          imported->environment.empty() ? imported->set.readings.size() : imported->environment.size();
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
  CHECK(read >= 18);
  CHECK(refused >= 30);
}

TEST_CASE("the printed extremes of the real height map come back") {
  const auto folder = shared_data("bed-mesh");
  if (folder.empty()) return;
  const auto map = read_any(folder / "heightmap_v2_9x9.csv", {});
  REQUIRE(map.has_value());
  double least = 1e9, most = -1e9, sum = 0.0;
  for (const Reading& reading : map->set.readings) {
    least = std::min(least, reading.error);
    most = std::max(most, reading.error);
    sum += reading.error;
  }
  CHECK(least == Approx(-50.0));
  CHECK(most == Approx(123.0));
  CHECK(std::abs(sum / 81.0 - 42.0) < 1.0);  // the title rounds to 1 um
  CHECK(map->set.readings.back().position_mm == Vector3{225.0, 10.0 + 8 * 23.12, 0.0});
  const auto mesh = read_any(folder / "klipper_9x9.cfg", {});
  REQUIRE(mesh.has_value());
  CHECK(mesh->set.readings.front().error == Approx(92.5));
  CHECK(mesh->set.readings.back().position_mm == Vector3{214.0, 190.0, 0.0});
}

TEST_CASE("a real drilled plate: scale and rotation of its own published fit") {
  const auto folder = shared_data("sdss-plugplate-cmm");
  if (folder.empty()) return;
  const auto plate = read_any(folder / "D8131_1", {});
  REQUIRE(plate.has_value());
  // least squares of error = offset + (scale, rotation) about the centre; FitOffset -0.044 0.079, FitRotAngle 0.029 deg
  double n = 0, sx = 0, sy = 0, ex = 0, ey = 0;
  const auto& r = plate->set.readings;
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

TEST_CASE("a real compensation table and a real step gauge come in by their columns") {
  const auto root = shared_data("");
  if (root.empty()) return;
  ImportOptions screw = by("x_mm=1,forward=2,reverse=3", 0);
  screw.mapping->values = TableValues::actual_positions;
  const auto table = read_any(root / "linuxcnc-comp/screwcompX.dat", screw);
  REQUIRE_MESSAGE(table.has_value(), to_text(table.error()));
  REQUIRE(table->set.readings.size() == 22);
  CHECK(table->set.readings[6].error == Approx(-200.0));  // the slip in the line of -4
  const auto gauge = read_any(root / "msl-cmm-simulated/bar_fulldata.csv",
                              by("x_mm=cmm_nom_x,y_mm=3,z_mm=4,axis_text=1,EX=cmm_dev_x[mm]", 8));
  REQUIRE_FALSE(gauge.has_value());
  CHECK(contains(gauge.error().message, "which axis moved"));
  ImportOptions along = by("x_mm=cmm_nom_x,y_mm=3,z_mm=4,EX=cmm_dev_x[mm],EY=cmm_dev_y[mm]", 8);
  along.axis = Axis::X;
  const auto gauge_x = read_any(root / "msl-cmm-simulated/bar_fulldata.csv", along);
  REQUIRE_MESSAGE(gauge_x.has_value(), to_text(gauge_x.error()));
  REQUIRE(gauge_x->set.readings.size() == 62);
  CHECK(gauge_x->set.readings[8].error == Approx(0.10));
}

TEST_CASE("a real sensor calibration: headings are the targets") {
  const auto folder = shared_data("epics-pv-logs");
  if (folder.empty()) return;
  const auto log = read_any(folder / "sensor1_calib.log", along_x());
  REQUIRE(log.has_value());
  const auto groups = groups_of(log->set);
  REQUIRE(groups.size() == 1);
  const auto targets = targets_of(log->set, groups[0], 1e-3);
  REQUIRE(targets.size() == 5);
  CHECK(targets[4].position_mm == 15.0);
  CHECK(log->set.readings[0].error == Approx((2.97127 - 3.0) * 1000.0));
}

TEST_CASE("one channel of a real log by its name") {
  const auto folder = shared_data("epics-pv-logs");
  if (folder.empty()) return;
  ImportOptions options = along_x();
  options.channel = "IOC_TEST:m0s005-AI02";
  const auto log = read_any(folder / "radial_x_minus_10kN.log", options);
  REQUIRE(log.has_value());
  CHECK(log->set.readings[0].error == Approx(12632.5));
  CHECK(*log->set.readings[0].time_s == 0.0);
  options.channel = "AI09";
  CHECK(contains(to_text(read_any(folder / "radial_x_minus_10kN.log", options).error()), "no channel \"AI09\""));
}
