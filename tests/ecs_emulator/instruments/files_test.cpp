// Every raw format that the virtual workshop writes, read back by the host's readers: nothing of a measurement is lost
// but what the format cannot hold. Plans as requests.
#include "ecs_emulator/instruments/files.hpp"

#include <map>

#include <nlohmann/json.hpp>

#include "base/file.hpp"
#include "laser/import/import.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::emulator;
using laser::MeasurementSet;
using laser::Reading;
using Key = std::tuple<double, Approach, int>;
using Json = nlohmann::json;

namespace {

double error_of(int target, Approach approach, int run) {
  return 0.37 * target - 1.25 * static_cast<double>(static_cast<std::int8_t>(approach)) + 0.011 * run;
}

/// Two runs each way over 0, −100 … −300 mm along X with Y parked at −700, air getting warmer.
MeasurementSet there_and_back(Sense sense = Sense::EX) {
  MeasurementSet set;
  set.metadata = {{"machine", "test mill"}, {"serial_number", "T-1"}, {"date", "2024-05-06"}, {"engineer", "N.N."}};
  for (int run = 1; run <= 2; ++run)
    for (int stop = 0; stop < 8; ++stop) {
      Reading reading;
      const int target = stop < 4 ? stop : 7 - stop;
      reading.axis = Axis::X;
      reading.sense = sense;
      reading.position_mm = {-100.0 * target, -700.0, 0.0};
      reading.approach = stop < 4 ? Approach::reverse : Approach::forward;
      reading.run = run;
      reading.error = error_of(target, reading.approach, run);
      reading.pressure_hPa = 1011.5;
      reading.humidity_pct = 43.5;
      reading.sensors_degC = {{"t_air_degC", 20.5 + 0.01 * stop}, {"t_material_degC", 21.25}};
      set.readings.push_back(reading);
    }
  return set;
}

struct MeasurementFolder : Folder {
  laser::Imported written_and_read(const MeasurementSet& set, const std::string& name, const laser::ImportOptions& o) {
    (void)must(write_measurement(path / name, set));
    return must(laser::read_any(path / name, o));
  }
  Result<void> write(const MeasurementSet& set, const std::string& name) { return write_measurement(path / name, set); }
};

laser::ImportOptions along_x(std::optional<Sense> sense = {}) {
  laser::ImportOptions options{.axis = Axis::X, .sense = sense, .parked_mm = {0.0, -700.0, 0.0}};
  return options;
}

std::map<Key, double> errors_by_reading(const MeasurementSet& set) {
  std::map<Key, double> errors;
  for (const Reading& r : set.readings) errors[{laser::target_mm(r), r.approach, r.run}] = r.error;
  return errors;
}

void same_errors(const MeasurementSet& a, const MeasurementSet& b, double tolerance) {
  const auto left = errors_by_reading(a);
  const auto right = errors_by_reading(b);
  REQUIRE(left.size() == right.size());
  for (const auto& [key, error] : left) {
    REQUIRE(right.contains(key));
    CHECK(std::abs(right.at(key) - error) < tolerance);
  }
}

Result<std::vector<std::string>> requests_in(const std::string& text, const std::string& phase = "before") {
  const Folder folder;
  REQUIRE(write_file(folder.path / "plan.toml", text).has_value());
  return requests_of(folder.path / "plan.toml", {phase, "/out", "1990-03-12", "B. Nada"});
}

std::string complaint_on(const std::string& text) {
  const auto requests = must_fail(requests_in(text));
  CHECK(requests.kind == ProblemKind::bad_input);
  return to_text(requests);
}

}  // namespace

TEST_CASE("runs in .rtl, .rta and .rts come back with errors, targets, runs, approach and conditions") {
  MeasurementFolder folder;
  for (const auto& [name, sense] : {std::pair{"a.rtl", Sense::EX}, {"a.rta", Sense::EC}, {"a.rts", Sense::EY}}) {
    const auto set = there_and_back(sense);
    const auto back = folder.written_and_read(set, name, along_x(sense));
    CHECK(back.format->id == "renishaw_run");
    same_errors(set, back.set, 1e-3);  // six decimals, of um or of mrad
    const Reading& last = back.set.readings.back();
    CHECK(last.sense == sense);
    CHECK(last.position_mm[1] == -700.0);
    CHECK(*last.pressure_hPa == Approx(1011.5));
    CHECK(*last.humidity_pct == Approx(43.5));
    CHECK(last.sensors_degC.at("t_air_degC") == Approx(20.57));
    CHECK(last.sensors_degC.at("t_material_degC") == Approx(21.25));
    CHECK(*laser::metadata_value(back.set, "Serial No") == "T-1");
  }
}

TEST_CASE("ISO 230-2 assignments come back with every cycle and direction") {
  MeasurementFolder folder;
  const auto set = there_and_back();
  const auto back = folder.written_and_read(set, "a.dat", along_x());
  CHECK(back.format->id == "iso230_assignments");
  same_errors(set, back.set, 1e-6);
}

TEST_CASE("an API report comes back with the mean of each direction") {
  MeasurementFolder folder;
  const auto back = folder.written_and_read(there_and_back(), "a.pos", along_x());
  CHECK(back.format->id == "api_pos");
  CHECK(back.set.readings.size() == 8);
  for (const Reading& r : back.set.readings) {
    const int target = static_cast<int>(std::lround(-laser::target_mm(r) / 100.0));
    CHECK(r.error == Approx(0.5 * (error_of(target, r.approach, 1) + error_of(target, r.approach, 2))).epsilon(1e-5));
  }
}

TEST_CASE("a compensation table comes back as the mean of everything, its sign turned twice") {
  MeasurementFolder folder;
  const auto back = folder.written_and_read(there_and_back(), "a.ren", along_x());
  CHECK(back.format->id == "renishaw_table");
  REQUIRE(back.set.readings.size() == 4);
  for (const Reading& r : back.set.readings)
    CHECK(r.error == Approx(-0.37 * laser::target_mm(r) / 100.0 + 0.0165).epsilon(1e-5));
  CHECK(*laser::metadata_value(back.set, "Compensation spacing") == "100");
}

TEST_CASE("weather written to an environment log is read back") {
  MeasurementFolder folder;
  const auto back = folder.written_and_read(there_and_back(), "a.env.pos", along_x());
  CHECK(back.format->id == "sios_environment");
  REQUIRE(back.environment.rows.size() == 16);
  CHECK(back.environment.value(3, "x_mm").value() == Approx(-300.0));
  CHECK(back.environment.value(3, "y_mm").value() == Approx(-700.0));
  CHECK(back.environment.value(3, "t_air_z_degC").value() == Approx(20.53));
  CHECK(back.environment.value(3, "pressure_hPa").value() == Approx(1011.5));
  CHECK(back.environment.value(3, "humidity_pct").value() == Approx(43.5));
  CHECK(back.environment.value(3, "t_material_degC").value() == Approx(21.25));
}

TEST_CASE("a capture comes back sample by sample") {
  MeasurementFolder folder;
  MeasurementSet set;
  set.metadata = {{"machine", "test mill"}, {"feed_mm_min", "1500"}};
  for (int i = 0; i < 500; ++i) {
    Reading reading{.position_mm = {-20.0, -700.0, 0.0}, .error = 12'345.678 * std::sin(0.1 * i), .time_s = i / 250.0};
    set.readings.push_back(reading);
  }
  auto options = along_x();
  options.parked_mm[0] = -20.0;
  const auto back = folder.written_and_read(set, "a.rtx", options);
  CHECK(back.format->id == "renishaw_dynamic");
  REQUIRE(back.set.readings.size() == 500);
  for (std::size_t i = 0; i < 500; ++i) {
    CHECK(back.set.readings[i].error == Approx(set.readings[i].error).epsilon(1e-14));
    CHECK(*back.set.readings[i].time_s == Approx(*set.readings[i].time_s));
    CHECK(back.set.readings[i].position_mm == set.readings[i].position_mm);
  }
  CHECK(*laser::metadata_value(back.set, "Machine") == "test mill");
}

TEST_CASE("what a format cannot hold is refused with the reason") {
  MeasurementFolder folder;
  const auto because = [&](const MeasurementSet& set, const char* name) {
    const auto written = folder.write(set, name);
    return written ? std::string() : to_text(written.error());
  };
  CHECK(contains(because(there_and_back(Sense::EY), "a.ren"), "positioning only"));
  CHECK(contains(because(there_and_back(Sense::EC), "a.dat"), "positioning only"));
  CHECK(contains(because(there_and_back(), "a.rta"), "ends in .csv, .rtl"));
  CHECK(contains(because(there_and_back(), "a.rtx"), "expected the time of each reading"));
  auto uneven = there_and_back();
  for (Reading& r : uneven.readings)
    if (r.position_mm[0] == -100.0) r.position_mm[0] = -110.0;
  CHECK(contains(because(uneven, "a.ren"), "constant step"));
  auto unfinished = there_and_back();
  unfinished.readings.pop_back();
  CHECK(contains(because(unfinished, "a.dat"), "expected 4 readings in run 2"));
  auto indoors = there_and_back();
  for (Reading& r : indoors.readings) r.pressure_hPa.reset();
  CHECK(contains(because(indoors, "a.env.pos"), "pressure"));
}

TEST_CASE("the mill's plan asks for 19 measurements before compensation and for 14 after") {
  const auto before = requests_of("samples/mill/plan.toml", {"before", "/out", "", ""});
  const auto after = requests_of("samples/mill/plan.toml", {"after", "/out", "", ""});
  REQUIRE_MESSAGE(before.has_value(), (before ? "" : to_text(before.error())));
  REQUIRE(after.has_value());
  CHECK(before->size() == 19);
  CHECK(after->size() == 14);
  CHECK(Json::parse(before->front()) == Json{{"action", "measure"},
                                             {"axis", "X"},
                                             {"sense", "EX"},
                                             {"instrument", "linear"},
                                             {"from", 0.0},
                                             {"to", -4100.0},
                                             {"step", 50.0},
                                             {"runs", 3},
                                             {"feed", 2000.0},
                                             {"parked", {{"Y", -1400.0}, {"Z", 0.0}}},
                                             {"plan_name", "moving column mill, thesis chapters 6 and 7"},
                                             {"output", Json::array({"/out/EXX.csv"})}});
  CHECK(Json::parse(before->back())["output"][0] == "/out/A0Z.csv");
}

TEST_CASE("date and engineer go into every request, and rows without a phase belong to both") {
  for (const std::string phase : {"before", "after"}) {
    const auto requests = must(requests_in(R"(
[[measure]]
name = "EXX"
axis = "X"
[[measure]]
name = "EYY"
on_the_fly = true
)",
                                           phase));
    REQUIRE(requests.size() == 2);
    const Json second = Json::parse(requests.back());
    CHECK(second["date"] == "1990-03-12");
    CHECK(second["engineer"] == "B. Nada");
    CHECK(second["on_the_fly"] == true);
    CHECK(!second.contains("axis"));
    CHECK(!second.contains("plan_name"));
  }
}

TEST_CASE("every wrong key or value of a plan is reported with its line") {
  const std::string text = complaint_on(R"(runs = "three"
feed = 2000.0
[[measure]]
name = "a/b"
from_mm = "here"
[[measure]]
name = "EXX"
axes = "X"
phase = "between"
parked_mm = { y = "top" }
on_the_fly = "yes"
)");
  CAPTURE(text);
  for (const int line : {1, 2, 4, 5, 8, 9, 10, 11}) CHECK(contains(text, "plan.toml:" + std::to_string(line) + ":"));
  check_holds(text, {"without a slash", "phase: expected before, after or both, got \"between\""});
}

TEST_CASE("a plan that is not TOML, has nothing to measure, or asks for part of a run is refused") {
  CHECK(contains(complaint_on("runs = \n"), "plan.toml:1:"));
  CHECK(contains(complaint_on("measure = 3\n"), "expected [[measure]] tables"));
  CHECK(contains(complaint_on("name = \"empty\"\n"), "[[measure]]"));
  CHECK(contains(complaint_on("runs = 2.5\n[[measure]]\nname = \"EXX\"\n"), "runs: expected a whole number"));
  CHECK(!requests_of("samples/mill/no_such_plan.toml", {"before", "/out", "", ""}).has_value());
}
