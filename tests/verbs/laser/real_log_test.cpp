// Logs of real sensors, which may not be passed on.

#include "commissioning/measurements/files.hpp"
#include "laser/groups.hpp"
#include "tests/support/real_data.hpp"
#include "tests/support/test.hpp"
#include "tests/support/verb_run.hpp"

using namespace ecs;
using namespace ecs::app;

namespace {

laser::MeasurementSet read_log(const std::filesystem::path& file, const std::string& channel = {}) {
  commissioning::ImportArguments arguments{.axis = "X", .channel = channel};
  return must(commissioning::read_measurements(file.string(), arguments)).set;
}

}  // namespace

TEST_CASE("a real sensor calibration: headings are the targets") {
  const auto folder = real_data("epics-pv-logs");
  SKIP_UNLESS(!folder.empty(), kNoRealData);
  const auto log = read_log(folder / "sensor1_calib.log");
  const auto groups = laser::groups_of(log);
  const auto targets = laser::targets_of(log, only(groups), 1e-3);
  REQUIRE(targets.size() == 5);
  CHECK(targets[4].position_mm == 15.0);
  CHECK(log.readings[0].error == Approx((2.97127 - 3.0) * 1000.0));
}

TEST_CASE("one channel of a real log by its name") {
  const auto folder = real_data("epics-pv-logs");
  SKIP_UNLESS(!folder.empty(), kNoRealData);
  const auto log = read_log(folder / "radial_x_minus_10kN.log", "IOC_TEST:m0s005-AI02");
  CHECK(log.readings[0].error == Approx(12632.5));
  CHECK(*log.readings[0].time_s == 0.0);
  const Ran none = ran({"laser", "import", folder / "radial_x_minus_10kN.log", "--axis", "X", "--channel", "AI09"});
  CHECK(contains(none.messages, "no channel \"AI09\""));
}
