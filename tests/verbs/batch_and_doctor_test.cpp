// Plans of many units, and the doctor, as far as they go without a unit.
#include <doctest/doctest.h>

#include "base/text.hpp"
#include "commissioning/batch/batch.hpp"
#include "commissioning/link/choice.hpp"
#include "commissioning/link/port_survey.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

TEST_CASE("a plan without a link has none by default, and every fault of it is reported") {
  const auto plan = parse_batch_plan(
      "[[unit]]\nname = \"a\"\nparams = \"p.toml\"\n\n[[unit]]\nlink = \"rtu:nonsense\"\n"
      "parms = \"p.toml\"\n",
      "plan.toml", "");
  REQUIRE_FALSE(plan);
  std::string all = to_text(plan.error());
  CHECK(all.find("no default link") != std::string::npos);
  CHECK(all.find("rtu:nonsense") != std::string::npos);
  CHECK(all.find("did you mean \"params\"") != std::string::npos);
  CHECK_FALSE(parse_batch_plan("", "plan.toml", ""));
  CHECK(ran({"batch", Folder().with("p.toml", "[[unit]]\n")}).code == 3);
}

TEST_CASE("files of a plan count from its folder") {
  const auto plan = parse_batch_plan(
      "[[unit]]\nlink = \"tcp:mill:502\"\nparams = \"p.toml\"\nmap = \"maps/m.csv\"\nserial_number = \"S\"\n",
      "plan.toml", "/jobs");
  REQUIRE(plan);
  CHECK(plan->front().params == "/jobs/p.toml");
  CHECK(plan->front().map == "/jobs/maps/m.csv");
  CHECK(plan->front().name == "unit 1");
}

TEST_CASE("faults of a plan are reported in the order of its lines") {
  const auto plan =
      parse_batch_plan("[[unit]]\nlink = \"tcp:h\"\nnonsense = 1\n[[unit]]\nparams = 3\nodd = 1\n", "p", "/");
  REQUIRE_FALSE(plan);
  int line = plan.error().line;
  REQUIRE(plan.error().also.size() >= 3);
  for (const Problem& other : plan.error().also) {
    CHECK(other.line >= line);
    line = other.line;
  }
}

TEST_CASE("failures of a batch and of the doctor carry an error in JSON, and no replies no round trip") {
  const Folder folder;
  static_cast<void>(folder.with("p.toml", content_of("tests/data/params/mill_unit.toml")));
  const std::string plan =
      folder.with("plan.toml", "[[unit]]\nlink = \"rtu:/dev/no-such-port:9600\"\nparams = \"p.toml\"\n");
  const auto batch = ran({"batch", plan, "--json"}).json();
  CHECK(batch["error"]["message"].get<std::string>().find("no such port") != std::string::npos);
  CHECK(batch["error"]["line"].is_null());
  const auto doctor = ran({"doctor", "--link", "rtu:/dev/no-such-port:9600", "--json"}).json();
  CHECK(doctor["error"]["message"].is_string());
  CHECK(doctor["statistics"]["mean_round_trip_ms"].is_null());
  CHECK(doctor["statistics"]["worst_round_trip_ms"].is_null());
}

TEST_CASE("one unit that fails does not stop the others, and a lost link makes exit code 4") {
  const Folder folder;
  static_cast<void>(folder.with("p.toml", content_of("tests/data/params/mill_unit.toml")));
  const std::string plan =
      folder.with("plan.toml",
                  "[[unit]]\nname = \"a\"\nlink = \"rtu:/dev/no-such-port:9600\"\nparams = \"gone.toml\"\n"
                  "[[unit]]\nname = \"b\"\nlink = \"rtu:/dev/no-other-port:9600\"\nparams = \"p.toml\"\n");
  const Ran r = ran({"batch", plan, "--dry-run", "--json"});
  CHECK(r.code == 4);
  const auto units = r.json()["units"];
  REQUIRE(units.size() == 2);
  CHECK(units[0]["state"] == "failed");
  CHECK(units[0]["error"]["file"].get<std::string>().find("gone.toml") != std::string::npos);
  CHECK(units[1]["error"]["message"].get<std::string>().find("no such port") != std::string::npos);
}

TEST_CASE("a batch refuses a unit that is named twice, unless serial numbers tell the two apart") {
  const Folder folder;
  static_cast<void>(folder.with("p.toml", content_of("tests/data/params/mill_unit.toml")));
  const std::string twice =
      "id,link,params\na,rtu:/dev/no-such-port:9600,p.toml\nb,rtu:/dev/no-such-port:9600,p.toml\n";
  const Ran refused = ran({"batch", folder.with("units.csv", twice), "--dry-run"});
  CHECK(refused.code == 3);
  CHECK(contains(refused.messages, "a and b have the same link"));
  const std::string apart =
      "id,link,params,serial_number\na,rtu:/dev/no-such-port:9600,p.toml,1\nb,rtu:/dev/no-such-port:9600,p.toml,2\n";
  CHECK(ran({"batch", folder.with("apart.csv", apart), "--dry-run"}).code == 4);  // the port is not there
}

TEST_CASE("a batch takes its units from a table, and writes a line of JSON for each") {
  const Folder folder;
  static_cast<void>(folder.with("p.toml", content_of("tests/data/params/mill_unit.toml")));
  const std::string plan = folder.with(
      "units.csv",
      "id,link,params,map\na,rtu:/dev/no-such-port:9600,p.toml,\nb,rtu:/dev/no-other-port:9600,gone.toml,\n");
  const Ran r = ran({"batch", plan, "--dry-run", "-o", folder / "report.jsonl", "--json"});
  CHECK(r.code == 4);
  CHECK(r.json()["units"][1]["name"] == "b");
  const auto lines = owned_lines_of(content_of(folder / "report.jsonl"));
  REQUIRE(lines.size() == 2);
  CHECK(contains(nlohmann::json::parse(lines[0])["error"].get<std::string>(), "no such port"));
  CHECK(contains(nlohmann::json::parse(lines[1])["error"].get<std::string>(), "gone.toml"));
  CHECK(ran({"batch", plan, "--dry-run", "-o", folder / "report.jsonl"}).code == 2);
  const Ran wrong =
      ran({"batch", folder.with("bad.csv", "id,link,params\na,nonsense,p.toml\na,tcp:h:1,p.toml\n,x,y\n")});
  CHECK(wrong.code == 3);
  CHECK(contains(wrong.messages, "bad.csv:2"));
  CHECK(contains(wrong.messages, "that of line 2"));
  CHECK(contains(wrong.messages, "bad.csv:4"));
}

TEST_CASE("the doctor says that a port does not exist, or is not a port") {
  const Ran missing = ran({"doctor", "--link", "rtu:/dev/no-such-port:9600", "--json"});
  CHECK(missing.code == 4);
  CHECK(missing.json()["works"] == false);
  CHECK(missing.json()["findings"][0]["check"] == "port");
  CHECK(missing.json()["findings"][0]["action"].is_string());
  const Ran file = ran({"doctor", "--link", "rtu:/dev/null:9600"});
  CHECK(file.code == 4);
  CHECK(file.out.find("not a serial port") != std::string::npos);
  CHECK(ran({"doctor", "--link", "tcp:127.0.0.1:1"}).code == 4);
}

TEST_CASE("a link that returns what is sent is recognised as an echo") {
  const PortAnswer silence{{1, 2, 3}, {}};
  const PortAnswer echo{{1, 2, 3}, {1, 2, 3, 9}};
  const PortAnswer other{{1, 2, 3}, {1, 2, 4}};
  CHECK_FALSE(silence.is_echo());
  CHECK(echo.is_echo());
  CHECK_FALSE(other.is_echo());
}

TEST_CASE("a stored link is used where none is given, and --link goes before it") {
  const Folder folder;
  ::setenv("XDG_CONFIG_HOME", (folder / "config").c_str(), 1);
  CHECK(chosen_link("").value().origin == "default");
  REQUIRE(store_link("tcp:mill:502"));
  const auto stored = chosen_link("");
  REQUIRE(stored);
  CHECK(to_text(*stored) == "tcp:mill:502:1");
  CHECK(chosen_link("tcp:lathe:502")->origin == "--link");
  static_cast<void>(folder.with("config/ecs/config.toml", "link = 7\n"));
  CHECK(ran({"monitor", "--count", "1"}).code == 3);
  ::unsetenv("XDG_CONFIG_HOME");
}

TEST_CASE("an emulator link names a machine file that exists") {
  CHECK(parsed_link("emulator:samples/mill/machine.toml", "--link")->is_emulator());
  CHECK_FALSE(parsed_link("emulator:no/machine.toml", "--link"));
  CHECK_FALSE(parsed_link("emulatr", "--link"));
}

}  // namespace
}  // namespace ecs::app
