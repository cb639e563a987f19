// A plan carried out over many lines at once: dead, slow and wrong units among fifty.
#include "modules/fleet/batch.hpp"

#include <list>

#include "tests/support/short_lathe.hpp"
#include "tests/support/unit_model.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::commissioning {
namespace {

using app::ran;

/// Parameters and a map for the units of tests/support/unit_model.hpp.
struct Files {
  StateFolder folder;
  std::string params = folder.with("p.toml", short_lathe("ECS-0042"));
  std::string map = folder / "map.csv";
  Files() {
    REQUIRE(ran({"map", "build", folder.with("exx.csv", lathe_readings()), "--params", params, "-o", map}).code == 0);
  }
  [[nodiscard]] PlannedUnit unit(const protocol::LinkAddress& address, const std::string& serial_number) const {
    PlannedUnit planned{"", {address, "plan"}, serial_number, params, map};
    planned.link.arm_code = protocol::Workshop::kKnownCode;
    return planned;
  }
};

std::size_t count_of(const std::vector<BatchReport>& reports, BatchState state) {
  return static_cast<std::size_t>(
      std::count_if(reports.begin(), reports.end(), [&](const auto& report) { return report.state == state; }));
}

TEST_CASE("files of a plan count from its folder") {
  const auto plan = must(parse_batch_plan(
      "[[unit]]\nlink = \"tcp:mill:502\"\nparams = \"p.toml\"\nmap = \"maps/m.csv\"\nserial_number = \"S\"\n",
      "plan.toml", "/jobs"));
  CHECK(plan.front().params == "/jobs/p.toml");
  CHECK(plan.front().map == "/jobs/maps/m.csv");
  CHECK(plan.front().name == "unit 1");
}

TEST_CASE("of fifty units, dead, slow and wrong ones stop no other, and a second run sends nothing again") {
  const Files files;
  std::list<protocol::Workshop> units;
  std::vector<PlannedUnit> plan;
  for (int i = 0; i < 40; ++i)
    plan.push_back(files.unit(units.emplace_back(protocol::ModbusServer::on_tcp({}).value()).address(), "ECS-0042"));
  for (int i = 0; i < 3; ++i)
    plan.push_back(files.unit(
        units.emplace_back(protocol::ModbusServer::on_pty({{}, 9'600, true, 1}).value()).address(), "ECS-0042"));
  for (int i = 0; i < 3; ++i)
    plan.push_back(files.unit(units.emplace_back(protocol::ModbusServer::on_tcp({}).value()).address(), "ECS-0043"));
  for (int i = 0; i < 4; ++i) plan.push_back(files.unit({protocol::TcpPeer{"127.0.0.1", 1}, 1}, ""));
  std::vector<BatchProgress> told;
  BatchWatch watch;
  watch.progress = [&told](const BatchProgress& now) { told.push_back(now); };

  const auto reports = run_batch(plan, BatchMode::send, kUsualLines, watch);
  REQUIRE(reports.size() == 50);
  for (std::size_t i = 0; i < 43; ++i) {
    CHECK_MESSAGE(reports[i].state == BatchState::sent, (reports[i].problem ? to_text(*reports[i].problem) : ""));
    CHECK(reports[i].link == to_text(plan[i].link));
  }
  CHECK(count_of(reports, BatchState::wrong_unit) == 3);
  CHECK(count_of(reports, BatchState::failed) == 4);
  CHECK(exit_code_of(reports) == 4);
  REQUIRE(!told.empty());
  CHECK(told.back().units_done == 50);
  CHECK(told.back().share == Approx(1.0));
  CHECK(told.back().seconds_left == Approx(0.0));

  const auto again = run_batch(plan, BatchMode::send, kUsualLines);
  CHECK(count_of(again, BatchState::held) == 43);
  for (auto& unit : units) {
    const auto commits =
        unit.in_server([](protocol::ModbusServer&, protocol::UnitModel& model) { return model.commits; });
    CHECK(commits <= 1);
  }
}

TEST_CASE("a batch that was stopped goes on with the units that it had not reached") {
  const Files files;
  std::list<protocol::Workshop> units;
  std::vector<PlannedUnit> plan;
  for (int i = 0; i < 10; ++i)
    plan.push_back(files.unit(units.emplace_back(protocol::ModbusServer::on_tcp({}).value()).address(), ""));
  BatchWatch watch;
  watch.progress = [](const BatchProgress& now) {
    if (now.units_done == 4) ask_to_stop();
  };
  const auto stopped = run_batch(plan, BatchMode::send, 1, watch);
  stop_asking();
  CHECK(count_of(stopped, BatchState::sent) == 4);
  CHECK(count_of(stopped, BatchState::not_attempted) == 6);
  const auto rest = run_batch(plan, BatchMode::send, 1);
  CHECK(count_of(rest, BatchState::held) == 4);
  CHECK(count_of(rest, BatchState::sent) == 6);
}

TEST_CASE("a dry run names the mode of a unit that accepts no data, unless nothing would be sent") {
  const Files files;
  auto unit = protocol::Workshop::on_tcp();
  const std::vector<PlannedUnit> plan{files.unit(unit.address(), "ECS-0042")};
  const auto enter = [&](UnitMode mode) { unit.in_model([mode](auto& model) { model.mode = mode; }); };
  enter(UnitMode::datuming);
  const auto refused = run_batch(plan, BatchMode::dry_run, 1);
  CHECK(refused.front().state == BatchState::failed);
  CHECK(contains(refused.front().problem->message, "the unit is referencing"));
  enter(UnitMode::integration);
  REQUIRE(run_batch(plan, BatchMode::send, 1).front().state == BatchState::sent);
  enter(UnitMode::compensating);
  CHECK(run_batch(plan, BatchMode::dry_run, 1).front().state == BatchState::ready);
}

TEST_CASE("units on one line take turns in the order of the plan") {
  const Files files;
  auto unit = protocol::Workshop::on_tcp();
  const std::vector<PlannedUnit> plan(5, files.unit(unit.address(), "ECS-0042"));
  const auto reports = run_batch(plan, BatchMode::send, kUsualLines);
  CHECK(reports[0].state == BatchState::sent);
  CHECK(count_of(reports, BatchState::held) == 4);
}

TEST_CASE("lines that are carried out at once start in the order of the plan") {
  std::vector<PlannedUnit> plan;
  for (std::uint16_t port = 1; port <= 8; ++port) {
    const protocol::LinkAddress nobody{protocol::TcpPeer{"127.0.0.1", port}, 1};
    plan.push_back({std::to_string(port), {nobody, "plan"}, "", "", ""});
  }
  std::vector<std::string> started;
  BatchWatch watch;
  watch.started = [&started](const PlannedUnit& unit) { started.push_back(unit.name); };
  for (int again = 0; again < 50; ++again) {
    started.clear();
    REQUIRE(run_batch(plan, BatchMode::dry_run, kUsualLines, watch).size() == plan.size());
    REQUIRE(started.size() == plan.size());
    for (std::size_t i = 0; i < plan.size(); ++i) REQUIRE(started[i] == plan[i].name);
  }
}

}  // namespace
}  // namespace ecs::commissioning
