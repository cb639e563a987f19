// The menu E.C.S. PARAMETERS on files.
#include <doctest/doctest.h>

#include "commissioning/memory/fields.hpp"
#include "core/memory_image.hpp"
#include "params/fields.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

const char* const kUnit = "tests/data/params/mill_unit.toml";

TEST_CASE("setting the present value is reported as unchanged, and no line ends in blanks") {
  const Folder folder;
  const std::string file = folder.with("p.toml", content_of(kUnit));
  CHECK(ran({"params", "set", file, "axis.X.deadband_um=7.5", "axis.X.datum.kind=fanuc"}).code == 0);
  CHECK(ran({"params", "set", file, "axis.X.deadband_um=7.5"}).out.starts_with("unchanged"));
  for (const Ran& r :
       {ran({"params", "show", file}), ran({"params", "set", file, "axis.X.datum.kind=allen_bradley"})}) {
    CHECK(r.out.find(" \n") == std::string::npos);
    CHECK(r.code == 0);
  }
}

TEST_CASE("set changes whose parameters they are, too") {
  const Folder folder;
  const std::string file = folder.with("p.toml", content_of(kUnit));
  const Ran r = ran({"params", "set", file, "identity.machine=new mill", "identity.serial_number", "M-2", "--json"});
  REQUIRE(r.code == 0);
  CHECK(r.json()["changed"][0]["to"] == "new mill");
  const auto identity = ran({"params", "show", file, "--json"}).json()["identity"];
  CHECK(identity["machine"] == "new mill");
  CHECK(identity["serial_number"] == "M-2");
  CHECK(ran({"params", "set", file, "identity.machine=" + std::string(100, 'x')}).code == 2);
}

TEST_CASE("show gives every parameter as a typed value") {
  const auto j = ran({"params", "show", kUnit, "--json"}).json();
  CHECK(j["parameters"]["configuration.chain"] == "TXYZ");
  CHECK(j["parameters"]["compensation.squareness.B0Z_um_per_m"] == -38.8);
  CHECK(j["parameters"]["compensation.memory_modules"] == 1);
  CHECK(j["parameters"]["axis.X.datum.switch_finally_active"].is_boolean());
  CHECK(j["identity"]["machine"] == "moving column mill");
}

TEST_CASE("a broken parameter file gives every problem with its line in one JSON error") {
  const Ran r = ran({"params", "show", "tests/data/params/broken_values.toml", "--json"});
  CHECK(r.code == 3);
  const auto error = r.json()["error"];
  CHECK(error["line"] == 2);
  CHECK(error["column"].is_number());
  CHECK(error["also"].size() >= 10);
  for (const auto& other : error["also"]) CHECK(other["line"].is_number());
}

TEST_CASE("set writes the values and nothing where one of them is wrong") {
  const Folder folder;
  const std::string out = folder / "p.toml";
  const Ran good =
      ran({"params", "set", kUnit, "axis.X.deadband_um=2.5", "compensation.scope", "linear", "-o", out, "--json"});
  CHECK(good.code == 0);
  CHECK(good.json()["changed"].size() == 2);
  const std::string before = content_of(out);
  const Ran bad = ran({"params", "set", out, "axis.X.deadband_um=3", "compensation.scop=linear"});
  CHECK(bad.code == 2);
  CHECK(bad.messages.find("compensation.scope") != std::string::npos);
  CHECK(content_of(out) == before);
}

TEST_CASE("diff is 0 for the same values and 1 for others, each by its key") {
  const Folder folder;
  const std::string other = folder / "p.toml";
  CHECK(ran({"params", "diff", kUnit, kUnit, "--json"}).json()["same"] == true);
  CHECK(ran({"params", "diff", kUnit, kUnit}).code == 0);
  REQUIRE(ran({"params", "set", kUnit, "axis.Y.deadband_um=9", "-o", other}).code == 0);
  const Ran r = ran({"params", "diff", kUnit, other, "--json"});
  CHECK(r.code == 1);
  REQUIRE(r.json()["differences"].size() == 1);
  CHECK(r.json()["differences"][0]["key"] == "axis.Y.deadband_um");
  CHECK(r.json()["differences"][0]["b"] == "9");
}

TEST_CASE("check is 1 with findings, and parameters made for a machine are without any") {
  const Folder folder;
  const std::string file = folder / "new.toml";
  REQUIRE(ran({"params", "new", "--machine", "samples/mill/machine.toml", "-o", file}).code == 0);
  CHECK(ran({"params", "check", file, "--machine", "samples/mill/machine.toml"}).code == 0);
  REQUIRE(ran({"params", "set", file, "axis.X.position_scale_um_per_count=2"}).code == 0);
  const Ran r = ran({"params", "check", file, "--machine", "samples/mill/machine.toml", "--json"});
  CHECK(r.code == 1);
  CHECK_FALSE(r.json()["findings"].empty());
}

TEST_CASE("each parameter has a place of its own in the image") {
  const auto& places = parameter_places();
  REQUIRE(places.size() == params::fields().size());
  std::vector<int> owner(kParameterBytes, -1);
  for (std::size_t i = 0; i < places.size(); ++i) {
    CAPTURE(params::fields()[i].key);
    REQUIRE(places[i].bytes > 0);
    if (params::fields()[i].type == params::FieldType::number) CHECK(places[i].bytes == 8);
    for (std::uint32_t at = places[i].first; at < places[i].first + places[i].bytes; ++at) {
      CHECK(owner[at] == -1);
      owner[at] = static_cast<int>(i);
    }
  }
}

TEST_CASE("a parameter file that lost its end is not sent, and `params set` does not make it whole") {
  const Folder folder;
  const std::string whole = content_of("samples/mill/parameters.toml");
  const std::string axis_lost = folder.with("axis.toml", whole.substr(0, whole.find("[axis.Z]")));
  const std::string line_lost = folder.with("line.toml", whole.substr(0, whole.find("# end of parameters")));
  const std::string none = "rtu:/dev/no-such-port:9600";
  const Ran lost = ran({"params", "send", axis_lost, "--link", none});
  CHECK(lost.code == 1);
  CHECK(lost.messages.find("may have lost its end") != std::string::npos);
  CHECK(ran({"params", "send", axis_lost, "--accept-incomplete", "--link", none}).code == 1);
  CHECK(ran({"params", "send", line_lost, "--link", none}).code == 1);
  CHECK(ran({"params", "send", line_lost, "--accept-incomplete", "--link", none}).code == 4);  // as far as the link
  CHECK(ran({"params", "set", line_lost, "axis.X.deadband_um=3"}).code == 1);
  CHECK(content_of(line_lost).find("# end of parameters") == std::string::npos);
  CHECK(ran({"params", "check", line_lost}).code == 1);
  CHECK(ran({"params", "set", line_lost, "axis.X.deadband_um=3", "--accept-incomplete"}).code == 0);
  CHECK(ran({"params", "check", line_lost}).out.find("lost its end") == std::string::npos);
  CHECK(ran({"params", "check", folder.with("empty.toml", ""), "--json"}).json()["sound"] == false);
}

}  // namespace
}  // namespace ecs::app
