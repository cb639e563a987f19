#include <doctest/doctest.h>

#include "base/json.hpp"
#include "commissioning/unit/status.hpp"
#include "modules/report/tests/support/report_folder.hpp"
#include "protocol/registers/unit_registers.hpp"

namespace ecs::app {
namespace {

TEST_CASE("the page is complete, needs no other file and runs no script") {
  const Commissioning c;
  c.add_machine();
  c.add_map();
  REQUIRE(c.report().code == 0);
  const std::string html = c.html();
  CHECK(fault_of(html) == "");
  for (const char* outside : {"http", "<script", "<link", "src=", "url(", "@import", "<iframe", "onload"})
    CHECK_FALSE(contains(html, outside));
  CHECK(contains(html, "href=\"#c-EXX\""));
  CHECK(contains(html, "<article id=\"c-EXX\">"));
  CHECK(contains(html, "size: A4"));
  CHECK(contains(html, "charset=\"utf-8\""));
}

TEST_CASE("the checker of pages finds what it is for") {
  CHECK(fault_of("<p><b>x</p></b>") != "");
  CHECK(fault_of("<p id=\"a\"></p><p id=\"a\"></p>") != "");
  CHECK(fault_of("<p class=n></p>") != "");
  CHECK(fault_of("<p>") != "");
  CHECK(fault_of("<p id=\"a\">x</p><path d=\"M0 0\"/>") == "");
}

TEST_CASE("text from a file is shown, never interpreted") {
  const std::string evil = "</style><script>alert(1)</script>\"'><img src=x onerror=alert(1)>";
  const Commissioning c("# machine: " + evil + "\n# instrument: " + evil + "\n");
  REQUIRE(c.report({"--header", "customer=" + evil, "--date", evil}).code == 0);
  const std::string html = c.html();
  CHECK_FALSE(contains(html, "<script"));
  CHECK_FALSE(contains(html, "<img"));
  CHECK(contains(html, "&lt;script&gt;alert(1)"));
  CHECK(html.find("</style>") == html.rfind("</style>"));
  CHECK(fault_of(html) == "");
}

TEST_CASE("the same input makes the same page, byte for byte") {
  const Commissioning c;
  c.add_machine();
  c.add_map();
  const auto first = c.report({"--json"}).json()["sha256"];
  CHECK(first == c.report({"--json"}).json()["sha256"]);
  CHECK(c.report({"--json"}).json()["date"] == "2026-03-02");
  CHECK(c.report({"--json", "--date", "2027-01-31"}).json()["date"] == "2027-01-31");
  CHECK(contains(c.html(), "<dd>2027-01-31</dd>"));
}

StatusSnapshot unit_with(std::uint32_t check) {
  StatusSnapshot s;
  s.taken = "2026-05-04T09:30:00Z";
  s.identity.serial_number = "B-1";
  s.identity.axis_present = {true, false, false};
  s.status.mode = UnitMode::integration;
  s.status.fault = Fault::ram_test;
  s.status.fault_address = 0x100ABC;
  s.status.block_check_expected = check;
  s.status.block_check_found = check;
  s.identity_registers = protocol::registers_of(s.identity, 0);
  s.status_registers = protocol::registers_of(s.status, 0);
  s.pointer_registers = protocol::pointer_registers_of(s.status, 0);
  return s;
}

TEST_CASE("the report gives the fault of the unit and whether its map is this one") {
  const Commissioning c;
  c.add_machine();
  c.add_map();
  CHECK(c.report({"--json"}).json()["block_check"].is_null());  // the image that a unit holds states its serial number
  REQUIRE(write_snapshot(c.folder / "status.json", unit_with(0)));
  const std::string check = c.report({"--json"}).json()["block_check"];
  const auto number = static_cast<std::uint32_t>(std::stoul(check, nullptr, 16));
  REQUIRE(write_snapshot(c.folder / "status.json", unit_with(number)));
  const Ran r = c.report();
  CHECK(r.code == 0);
  CHECK(contains(r.out, "replace that axis memory module"));
  CHECK(contains(c.html(), "The unit holds this map with these parameters"));
  REQUIRE(write_snapshot(c.folder / "status.json", unit_with(number ^ 1U)));
  REQUIRE(c.report().code == 0);
  CHECK(contains(c.html(), "The unit held another map or other parameters"));
}

}  // namespace
}  // namespace ecs::app
