// `ecs volume` with the emulator as an independent witness.
#include "core/axis.hpp"
#include "tests/support/command_output.hpp"
#include "tests/support/emulator.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

TEST_CASE("the true errors are those that the emulator finds when it drives there") {
  const Folder folder;
  const std::string map = folder.with("map.csv", "axis,sense,approach,p_mm,value_um\nX,EX,0,0,0\nX,EX,0,1200,0\n");
  const auto surveyed = nlohmann::json::parse(
      output_of(kEmulator + " survey --machine samples/machining_centre/machine.toml --step 300 --approach 1").text);
  const Ran r = ran({"volume", map, "--params", "samples/machining_centre/parameters.toml", "--errors",
                     "samples/machining_centre/errors.toml", "--at", "1200,600,-600", "--points", "125", "--json"});
  REQUIRE_MESSAGE(r.code == 0, r.all());
  for (const auto& corner : surveyed["corners"]["all"]) {
    const auto& place = corner["position_mm"];
    if (place["X"] != 1200.0 || place["Y"] != 600.0 || place["Z"] != -600.0) continue;
    const auto forward = r.json()["at"]["sides"][0];
    CHECK(forward["approach"] == 1);
    // The survey counts from the datum approached forward, the volume from the mean of both sides there.
    const double half_reversal[] = {8.6 + 0.5, 4.8 + 0.4, 29.0 + 0.3};  // terms in d of the errors file
    for (std::size_t d = 0; d < kAxes; ++d)
      CHECK(std::abs(forward["before_um"][d].get<double>() - half_reversal[d] -
                     corner["error_um"][std::string(1, static_cast<char>('X' + d))].get<double>()) < 0.05);
    return;
  }
  FAIL("no such corner");
}

}  // namespace
}  // namespace ecs::app
