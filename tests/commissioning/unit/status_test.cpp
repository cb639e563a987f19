// Status files: what was saved is what is decoded, without a unit.
#include "commissioning/unit/status.hpp"

#include "base/answer_table.hpp"
#include "protocol/registers/unit_registers.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

StatusSnapshot faulty_unit() {
  StatusSnapshot s{.taken = "2026-05-04T09:30:00Z", .link = "tcp:mill:502:1"};
  s.identity.serial_number = "MCM-0107";
  s.identity.axis_present = {true, true, false};
  s.identity.memory_modules = 1;
  s.status.mode = UnitMode::integration;
  s.status.fault = Fault::ram_test;
  s.status.fault_address = 0x100ABC;
  s.status.ram_test = protocol::TestOutcome::failed;
  s.status.ram_test_address = 0x100ABC;
  s.status.active_bank = protocol::Bank::A;
  s.status.axes[0].position_mm = -150.0;
  s.status.axes[1].datum_failure = DatumFailure::too_fast;
  s.status.pointers[index_of(Component::ECX)] = {12, 0x1002E0};
  s.selected[index_of(Component::ECX)] = SelectedValue{-250, -2.5};
  s.identity_registers = protocol::registers_of(s.identity, 0);
  s.status_registers = protocol::registers_of(s.status, 0);
  s.pointer_registers = protocol::pointer_registers_of(s.status, 0);
  return s;
}

TEST_CASE("an event reads as its command with the number of the tool, or with its arguments in brackets") {
  protocol::HostEvent event{.code = protocol::CommandCode::select_tool, .state = protocol::CommandState::done};
  event.text = "7";
  CHECK(contains(commissioning::events_cell({event}).text, "select tool 7: done"));
  event.code = protocol::CommandCode::begin_staging;
  event.text = "over the inactive map";
  CHECK(contains(commissioning::events_cell({event}).text, "start a transfer (over the inactive map): done"));
}

TEST_CASE("a saved status decodes to the same fault, address, pointers and values") {
  const Folder folder;
  const std::string file = folder / "s.json";
  REQUIRE(write_snapshot(file, faulty_unit()));
  const Ran r = ran({"utility", "status", "--from", file, "--json"});
  CHECK(r.code == 0);
  const auto j = r.json();
  CHECK(j["fault"]["name"] == "ram_test");
  CHECK(j["fault"]["address"] == "0x100ABC");
  CHECK(j["ram_test"]["outcome"] == "failed");
  CHECK(j["axes"].size() == 2);
  CHECK(j["axes"]["Y"]["datum_failure"] == "too fast");
  CHECK(j["axes"]["X"]["position_mm"] == -150.0);
  REQUIRE(j["pointers"].size() == 1);
  CHECK(j["pointers"][0]["component"] == "ECX");
  CHECK(j["pointers"][0]["address"] == "0x1002E0");
  CHECK(j["pointers"][0]["value"] == -2.5);
  CHECK(j["pointers"][0]["unit"] == "um/m");
  CHECK(j["link"] == "tcp:mill:502:1");
}

TEST_CASE("a checksum that differs says what to do, and so does its JSON that it does") {
  StatusSnapshot s = faulty_unit();
  s.status.block_check_expected = 0x1234ABCD;
  s.status.block_check_found = 0x1234ABCE;
  const Cell differs = status_cell(s);
  CHECK(contains(differs.text,
                 "expected 1234ABCD, found 1234ABCE (CRC-32): they differ. What to do: send parameters and map again"));
  CHECK(differs.json["block_check"]["agrees"] == false);
  s.status.block_check_found = s.status.block_check_expected;
  CHECK(contains(status_cell(s).text, "checksum     1234ABCD (CRC-32), agrees with the stored one\n"));
}

TEST_CASE("battery and control are in the status, and unknown in a file of a unit that does not state them") {
  StatusSnapshot s = faulty_unit();
  const Cell silent = status_cell(s);
  CHECK(silent.json["battery"].is_null());
  CHECK(silent.json["control_on"].is_null());
  CHECK(!contains(silent.text, "battery"));
  protocol::ControlLines lines;
  lines.battery = protocol::BatteryState::low;
  lines.battery_age_s = 900 * 86'400;
  s.lines_registers = protocol::registers_of(lines, 0);
  for (const bool wired : {false, true}) {
    lines.control_on_wired = wired;
    lines.control_on = false;
    s.lines_registers = protocol::registers_of(lines, 0);
    const StatusSnapshot read = must(parse_snapshot(json_with_registers(s).dump(), "s"));
    CHECK(read.lines == lines);
    const Cell cell = status_cell(read);
    CHECK(contains(cell.text, "battery      low, 900.0 days old; replace it while the unit is switched on"));
    CHECK(cell.json["battery"] == "low");
    CHECK(cell.json["battery_age_s"] == lines.battery_age_s);
    CHECK(contains(cell.text,
                   wired ? "control      off: every axis has to be referenced again" : "not known whether it is on"));
    CHECK(cell.json["control_on"] == (wired ? Json(false) : Json(nullptr)));
  }
}

TEST_CASE("rotary axes are in the status of a unit that has them, and in its file") {
  StatusSnapshot s = faulty_unit();
  CHECK_FALSE(status_cell(s).json.contains("rotary_axes"));
  CHECK_FALSE(json_with_registers(s)["raw"].contains("rotary"));
  protocol::RotarySample rotary;
  rotary.compensation_um = {1.5, -0.25, 0.0};
  rotary.axes = {{{'A', true, -30.0005, Approach::reverse}, {'C', false, 0.0, Approach::unknown}}};
  s.rotary_registers = protocol::registers_of(rotary, 0);
  s.status.mode = UnitMode::compensating;
  s.status_registers = protocol::registers_of(s.status, 0);
  const StatusSnapshot read = must(parse_snapshot(json_with_registers(s).dump(), "s"));
  CHECK(read.rotary == rotary);
  const Cell cell = status_cell(read);
  check_holds(cell.text, {"axis   angle/deg  approach\nA       -30.0005  reverse\nC        unknown  unknown\n",
                          "share of the rotary axes in the compensation: X +1.50 um, Y -0.25 um, Z +0.00 um\n"});
  CHECK(cell.json["rotary_axes"]["A"]["angle_deg"] == -30.0005);
  CHECK(cell.json["rotary_axes"]["C"]["angle_deg"].is_null());
  CHECK(cell.json["rotary_compensation_um"]["Y"] == -0.25);
  s.status.mode = UnitMode::integration;
  s.status_registers = protocol::registers_of(s.status, 0);
  CHECK(status_cell(must(parse_snapshot(json_with_registers(s).dump(), "s"))).json["rotary_compensation_um"].is_null());
}

TEST_CASE("a fault of the tool names the tool") {
  StatusSnapshot s = faulty_unit();
  s.status.fault = Fault::live_input;
  s.status.fault_address = kToolInput + 1;
  CHECK(contains(fault_sentence(s.status), "the tool: it is not in the table, or a copy of the table is damaged"));
}

TEST_CASE("an axis without reference has a counted position, and an approach that nobody knows") {
  const Cell cell = status_cell(faulty_unit());
  CHECK(contains(cell.text, "X     no          waiting           -150.0000  unknown   open"));
  CHECK(cell.json["axes"]["X"]["last_approach"].is_null());
  protocol::MonitorSample sample;
  sample.axes[index_of(Axis::Y)] = {.present = true};
  CHECK(unreferenced_text(sample) == "Y not referenced: counted from switch-on, or from the position entered");
  sample.axes[index_of(Axis::Y)].referenced = true;
  CHECK(unreferenced_text(sample).empty());
}

TEST_CASE("the words say what to do next") {
  const std::string text = status_cell(faulty_unit()).text;
  check_holds(text, {"replace the axis memory module that contains", "0x100ABC", "raise the approach speed"});
}

TEST_CASE("the registers count, not the words beside them") {
  const Folder folder;
  const std::string file = folder / "s.json";
  REQUIRE(write_snapshot(file, faulty_unit()));
  Json object = Json::parse(content_of(file));
  object["fault"]["name"] = "none";
  CHECK(must(parse_snapshot(object.dump(), "s")).status.fault == Fault::ram_test);
}

TEST_CASE("files that hold no status are refused, saying what was expected") {
  const Folder folder;
  for (const char* text : {"", "{}", "[1,2]", "not json", R"({"ecs_status": 1})", R"({"ecs_status": 2, "raw": {}})",
                           R"({"ecs_status": 1, "raw": {"identity": [1, 2]}})"}) {
    CAPTURE(text);
    const Ran r = ran({"utility", "status", "--from", folder.with("x.json", text), "--json"});
    CHECK(r.code == 3);
    CHECK(contains(r.json()["error"]["message"].get<std::string>(), "expected"));
  }
}

}  // namespace
}  // namespace ecs::app
