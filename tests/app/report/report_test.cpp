#include <filesystem>

#include <doctest/doctest.h>
#include <sys/stat.h>

#include "base/json.hpp"
#include "commissioning/unit/status.hpp"
#include "protocol/registers/unit_registers.hpp"
#include "tests/app/support/report_folder.hpp"
#include "tests/support/model_workspace.hpp"

namespace ecs::app {
namespace {

using doctest::Approx;

TEST_CASE("a report of measurements alone says what it was not given, and holds the numbers by hand") {
  const Commissioning c;
  const Ran r = c.report({"--json"});
  CHECK(r.code == 0);
  const auto j = r.json();
  // 36 um/m over 1 m, reversal 4 um, runs 2 um apart: 36 + 4 + 2 before, 2 + 4 + 2 after.
  CHECK(j["rows"][0]["before"] == Approx(42.0));
  CHECK(j["rows"][0]["after"] == Approx(8.0));
  CHECK(j["rows"][0]["verdict"] == "within");
  CHECK(j["rows"][1]["verdict"] == "no limit");
  CHECK(j["absent"] ==
        nlohmann::json::parse(R"(["machine","map","parameters","model","diagnosis","status","circles"])"));
  const std::string html = c.html();
  CHECK(html.size() == j["bytes"]);
  CHECK(contains(html, "Machine: no machine file was given"));
  CHECK(contains(html, "Error map: no error map was given"));
  CHECK(contains(html, "no error model and no diagnosis were given"));
  CHECK(contains(html, "no state of the unit was given"));
  CHECK(contains(html, "before: band 42.0\u202fµm"));
  // s = sqrt(2) each way, so R = 2 s + 2 s + B = 9.66; E = 36 + 4.
  CHECK(contains(html, "<td class=\"n\">40.0</td>"));
  CHECK(contains(html, "<td class=\"n\">9.7</td>"));
}

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

TEST_CASE("a measurement that repeats worse than before is one thing: something changed, not scatter for good") {
  const Commissioning c;
  c.add_machine();
  c.add_map();
  std::string after = "# machine: bench\n# serial_number: B-1\naxis,sense,x_mm,reading,approach,run,compensated\n";
  for (const int run : {1, 2, 3})
    for (const int approach : {1, -1})
      for (const int x : {0, 500, 1000}) after += fmt::format("X,EX,{},{},{},{},1\n", x, 20 * run, approach, run);
  (void)c.folder.with("after/EXX.csv", after);
  const Ran r = c.report();
  CHECK(contains(r.out, "something changed between the two measurements"));
  CHECK(contains(r.out, "It is scatter for the most part: repeatability R = 80"));
  CHECK_FALSE(contains(r.out, "which no map removes"));
  CHECK_FALSE(contains(c.html(), "which no map removes"));
}

TEST_CASE("of thirty rivals the report shows five and counts the others") {
  const Commissioning c;
  std::string json = R"({"verdict": "adequate", "rms_um": 1.0, "observations": 10, "candidates": [)";
  for (int i = 0; i < 30; ++i)
    json += fmt::format(R"({}{{"name": "rival{}", "named": false, "rms_after_um": 0.9}})", i == 0 ? "" : ",", i);
  REQUIRE(c.report({"--diagnosis", c.folder.with("d.json", json + "]}")}).code == 0);
  const std::string html = c.html();
  CHECK(contains(html, "rival4"));
  CHECK_FALSE(contains(html, "rival5"));
  CHECK(contains(html, "25 more are not shown."));
}

TEST_CASE("a missing file after compensation leaves its row, and the report says what is lacking") {
  const Commissioning c;
  std::filesystem::remove(c.folder / "after/EYX.csv");
  const Ran r = c.report({"--json"});
  CHECK(r.code == 3);
  const auto j = r.json();
  CHECK(j["rows"][1]["verdict"] == "missing");
  CHECK(j["rows"][1]["before"].is_number());
  CHECK(j["missing"] == 1);
  CHECK(contains(j["error"]["message"], "file missing"));
  CHECK(contains(c.html(), "file missing: measure it"));
  CHECK(fault_of(c.html()) == "");
}

TEST_CASE("a pipe among the measurements is not waited for") {
  const Commissioning c;
  REQUIRE(::mkfifo((c.folder / "before/EZX.csv").c_str(), 0600) == 0);
  std::filesystem::remove(c.folder / "before/EYX.csv");
  REQUIRE(::mkfifo((c.folder / "before/EYX.csv").c_str(), 0600) == 0);
  CHECK(c.report({"--json"}).json()["error"]["message"].get<std::string>().find("no plain file") != std::string::npos);
  std::filesystem::remove(c.folder / "plan.toml");
  const Ran r = c.report({"--json"});
  CHECK(r.code == 0);
  CHECK(r.json()["rows"].size() == 2);
}

TEST_CASE("a folder is not a page") {
  const Commissioning c;
  const Ran r = ran({"report", c.folder / ".", "-o", c.folder / "."});
  CHECK(r.code == 2);
  CHECK(contains(r.messages, "is a folder"));
}

TEST_CASE("before compensation alone is a report too, without complaint") {
  const Commissioning c;
  std::filesystem::remove_all(c.folder / "after");
  const Ran r = c.report();
  CHECK(r.code == 0);
  CHECK(contains(r.out, "Measured before compensation only"));
  CHECK(contains(r.out, "- Measure the same again with the unit compensating."));
  CHECK(contains(c.html(), "before only"));
}

TEST_CASE("without a plan every file is a row, taken for what it holds") {
  const Commissioning c;
  std::filesystem::remove(c.folder / "plan.toml");
  const auto j = c.report({"--json"}).json();
  REQUIRE(j["rows"].size() == 2);
  CHECK(j["rows"][1]["name"] == "EYX");
  CHECK(j["rows"][1]["title"] == "X axis straightness error in Y");
  // The slope of straightness is removed: reversal and runs are left.
  CHECK(j["rows"][1]["before"] == Approx(4.0));
  CHECK(j["absent"][0] == "plan");
}

TEST_CASE("a band above its limit is named with what is left of it, and is no failure of the report") {
  const Commissioning c("", 20.0);
  const Ran r = c.report({"--json"});
  CHECK(r.code == 0);
  const auto j = r.json();
  CHECK(j["rows"][0]["verdict"] == "above");
  CHECK(j["worst"] == "EXX");
  CHECK(j["within"] == 0);
  CHECK(contains(j["next"][0], "26.0\u202fµm against a limit of 14.0\u202fµm"));
  CHECK(contains(c.html(), "class=\"badge open\">above"));
}

TEST_CASE("the map's own prediction is what the unit would leave of the readings before") {
  const Commissioning c;
  c.add_machine();
  c.add_map();
  const auto j = c.report({"--json"}).json();
  // The map takes 36 um/m away exactly: reversal 4 um and the runs, 2 um apart, are left.
  CHECK(j["rows"][0]["predicted"] == Approx(6.0).epsilon(0.01));
  CHECK(j["rows"][1]["predicted"] == Approx(4.0).epsilon(0.01));
  CHECK(contains(c.html(), j["map_sha256"].get<std::string>()));
}

TEST_CASE("files of different machines make no report") {
  const Commissioning c;
  c.add_machine();
  c.add_map("# machine: another mill\n# configuration: TXYZ\n");
  const Ran r = c.report();
  CHECK(r.code == 1);
  CHECK(contains(r.messages, "another mill"));
  CHECK_FALSE(std::filesystem::exists(c.page));
  (void)c.folder.with("after/EXX.csv", report_line("EX", 2.0, 4.0, 1, "# serial_number: B-2\n"));
  std::filesystem::remove(c.folder / "map.csv");
  CHECK(c.report().code == 1);
}

TEST_CASE("a page that cannot be written, inputs as output, wrong words and no measurements") {
  const Commissioning c;
  CHECK(ran({"report", c.folder / "", "-o", c.folder / "none/report.html"}).code == 5);
  CHECK(ran({"report", c.folder / "", "-o", c.folder / "plan.toml"}).code == 2);
  CHECK(content_of(c.folder / "plan.toml") == kReportPlan);
  CHECK(ran({"report", c.folder / "", "-o", c.folder / "before/EXX.csv"}).code == 2);
  CHECK(contains(content_of(c.folder / "before/EXX.csv"), "axis,sense"));
  CHECK(c.report({"--data", c.folder / "before/EXX.csv"}).code == 2);
  CHECK(c.report({"--header", "customer"}).code == 2);
  CHECK(ran({"report", c.folder / "nowhere", "-o", c.page}).code == 3);
  CHECK(ran({"report", "-o", c.page}).code == 3);
  const Folder empty;
  CHECK(ran({"report", empty / "", "-o", c.page}).code == 3);
  CHECK(ran({"report", c.folder / "", "-o", c.page, "--map", c.folder / "plan.toml"}).code == 3);
  CHECK_FALSE(std::filesystem::exists(c.page));
}

TEST_CASE("many sensors get tables of their own, a few across, and what no file recorded is said") {
  const Commissioning c;
  std::string text = "axis,sense,x_mm,reading,approach,compensated,pressure_hPa";
  for (int i = 0; i < 9; ++i) text += fmt::format(",t_s{}_degC", i);
  for (const int approach : {1, -1})
    for (const double x : {0.0, 500.0, 1000.0}) {
      text += fmt::format("\nX,EX,{},{},{},0,{}", x, x / 100.0, approach, 1000 + x / 100.0);
      for (int i = 0; i < 9; ++i) text += fmt::format(",{}", 20 + i);
    }
  (void)c.folder.with("before/EXX.csv", text + "\n");
  REQUIRE(c.report().code == 0);
  const std::string html = c.html();
  CHECK(contains(html, "<td class=\"n\">1000 … 1010</td>"));
  CHECK(contains(html, "<td class=\"n\">28.0</td>"));
  CHECK(contains(html, "Not recorded in the files: air temperature, material temperature, humidity, feed."));
  for (std::size_t at = 0; (at = html.find("<tr>", at)) != std::string::npos; ++at) {
    const std::string row = html.substr(at, html.find("</tr>", at) - at);
    std::size_t cells = 0;
    for (std::size_t i = 0; (i = row.find("<t", i + 1)) != std::string::npos;) ++cells;
    CHECK(cells <= 16);
  }
}

// --- models

/// X with a periodic error of 8 mm that its model does not know; the compensation took half of it away.
struct ModelCommissioning {
  Folder folder;
  std::string page = folder / "report.html";
  ModelCommissioning() {
    (void)folder.with("before/EXX.csv", measured_x(cyclic_x));
    MeasuredAxis after;
    after.compensated = true;
    after.seed = 2;
    (void)folder.with("after/EXX.csv",
                      measured_x([](double x, int a, int r) { return 0.5 * cyclic_x(x, a, r); }, after));
    (void)folder.with("machine.toml", kTestMachine);
    (void)folder.with("model.toml", kStraightModel);
  }
  [[nodiscard]] Ran report(std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"report", folder / "", "-o", page, "--force"};
    words.insert(words.end(), more.begin(), more.end());
    return ran(words);
  }
};

TEST_CASE("a model is diagnosed; the report gives evidence, prediction and the next measurement") {
  const ModelCommissioning c;
  const Ran r = c.report({"--json"});
  REQUIRE(r.code == 0);
  CHECK(r.json()["diagnosis"] == "missing_effect");
  const std::string html = content_of(c.page);
  CHECK(contains(html, "X positions with a periodic error of"));
  CHECK(contains(html, "(cyclic:X:EX"));
  CHECK((contains(html, "period 8.0") || contains(html, "period 7.99")));
  CHECK(contains(html, "\u202fmm, amplitude "));
  CHECK(contains(html, "By the error model"));
  CHECK(contains(html, "Scale error"));
  CHECK(fault_of(html) == "");
}

TEST_CASE("a saved diagnosis gives the same section as one made for the report") {
  const ModelCommissioning c;
  REQUIRE(c.report().code == 0);
  const std::string made = content_of(c.page);
  const Ran saved = ran({"model", "diagnose", c.folder / "model.toml", c.folder / "before/EXX.csv", "--machine",
                         c.folder / "machine.toml", "--json"});
  (void)c.folder.with("diagnosis.json", saved.out);
  REQUIRE(c.report().code == 0);
  const std::string read = content_of(c.page);
  const auto part = [](const std::string& html) {
    const std::size_t from = html.find("<section id=\"effects\">");
    return html.substr(from, html.find("<section", from + 1) - from);
  };
  CHECK(part(made) == part(read));
  (void)c.folder.with("diagnosis.json", "{\"verdict\": 7}");
  CHECK(c.report().code == 3);
  (void)c.folder.with("diagnosis.json", "[[[");
  CHECK(c.report().code == 3);
}

TEST_CASE("the ladder of a model is shown as bars and as numbers") {
  const ModelCommissioning c;
  const std::string data = c.folder / "before/EXX.csv", machine = c.folder / "machine.toml",
                    model = c.folder / "model.toml";
  REQUIRE(ran({"model", "fit", model, data, "--machine", machine, "-o", model}).code == 0);
  REQUIRE(ran({"model", "add", model, "cyclic:X:EX", "--data", data, "--machine", machine, "-o", model}).code == 0);
  const Ran r = c.report({"--json"});
  REQUIRE(r.code == 0);
  CHECK(r.json()["diagnosis"] == "adequate");
  const std::string html = content_of(c.page);
  CHECK(contains(html, "The ladder: error after every effect added"));
  CHECK(contains(html, "class=\"bar\""));
  CHECK(contains(html, "what it leaves is noise"));
}

// --- the unit

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
