#include <doctest/doctest.h>

#include "tests/support/verb_run.hpp"

using namespace ecs;
using namespace ecs::app;
using doctest::Approx;

namespace {
const std::string kDrive = "samples/rig/drive_as_printed.toml", kStep = "samples/rig/step_recorded.csv";
}  // namespace

TEST_CASE("compare takes a recorded step: Kw or K, the values, and the signal that tells them apart") {
  const Ran run = ran({"model", "compare", kDrive, kStep, "--json"});
  REQUIRE(run.code == 0);
  const auto json = run.json();
  CHECK(json["observations"] == 801);
  CHECK(json["verdict"] == "wrong_constant");
  CHECK(json["rms_V"] > 5.0);
  CHECK(json["noise_V"] < 0.02);
  CHECK(json["measured"]["steady_V"].get<double>() == Approx(2.98).epsilon(0.004));
  CHECK(json["measured"]["decay_start_s"].get<double>() == Approx(0.50).epsilon(0.005));
  const auto& first = json["candidates"][0];
  CHECK(first["parameters"] == nlohmann::json{"Kw", "K"});
  CHECK(first["factor"].get<double>() == Approx(0.1).epsilon(0.01));
  CHECK(first["value_if_others_trusted"]["Kw"].get<double>() == Approx(0.0632).epsilon(0.005));
  CHECK(first["separated_by"] == nlohmann::json{"tacho_V"});
  CHECK(first["rms_after_V"] < 0.02);
}

TEST_CASE("the same as text, with a plot") {
  const Folder folder;
  const Ran run = ran({"model", "compare", kDrive, kStep, "--plot", folder / "step.svg"});
  REQUIRE(run.code == 0);
  CHECK(run.out.find("steady level [V]") != std::string::npos);
  CHECK(run.out.find("record tacho_V") != std::string::npos);
  CHECK(content_of(folder / "step.svg").find("simulated as mended") != std::string::npos);
}

TEST_CASE("a model without a drive table is the drive as printed, one with the true gain agrees") {
  const Folder folder;
  const Ran printed = ran({"model", "compare", folder.with("m.toml", "name = \"rig\"\n"), kStep, "--json"});
  CHECK(printed.json()["candidates"][0]["parameters"][0] == "Kw");
  const Ran mended = ran({"model", "compare", folder.with("t.toml", "[drive]\nKw = 0.0632298\n"), kStep, "--json"});
  CHECK(mended.json()["verdict"] == "agrees");
  CHECK(mended.json()["candidates"].empty());
}

TEST_CASE("broken recordings and misplaced options are refused with line and reason") {
  const Folder folder;
  const Ran broken = ran({"model", "compare", kDrive, folder.with("s.csv", "time_s,dac_V\n0,zero\n"), "--json"});
  CHECK(broken.code == 3);
  CHECK(broken.json()["error"]["line"] == 2);
  CHECK(ran({"model", "compare", kDrive, kStep, "--at", "x=1,axis=X"}).code == 2);
  CHECK(ran({"model", "compare", kDrive, kStep, kStep}).code == 2);
}
