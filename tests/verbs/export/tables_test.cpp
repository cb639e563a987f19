#include <cmath>
#include <filesystem>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "laser/map/csv.hpp"
#include "tests/support/model_workspace.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

using doctest::Approx;

const char* const kParameters = R"(
[identity]
machine = "small mill"
[configuration]
chain = "TXYZ"
[compensation.squareness]
C0Y_um_per_m = 40.0
# end of parameters
)";
const char* const kMachine = R"(
name = "small mill"
configuration = "TXYZ"
[axis.X]
travel_mm = [-400, 0]
[axis.Y]
travel_mm = [-400, 0]
[axis.Z]
travel_mm = [-400, 0]
)";

/// EXX, EYY, EXY and ECX of 400 mm; EXX with a reversal of 2 um.
std::string map_text() {
  std::string text = "# configuration: TXYZ\naxis,sense,approach,p_mm,value_um\n";
  for (int p = -400; p <= 0; p += 50) {
    for (const int approach : {1, -1}) text += fmt::format("X,EX,{},{},{}\n", approach, p, -0.02 * p + approach);
    text += fmt::format("Y,EY,0,{},{}\nY,EX,0,{},{}\n", p, 0.01 * p, p, 0.0001 * p * (p + 400));
    text += fmt::format("X,EC,0,{},{}\n", p, 0.1 * p);
  }
  return text;
}

struct ExportWorkspace {
  Folder folder;
  std::string map = folder.with("map.csv", map_text());
  std::string params = folder.with("p.toml", kParameters);
  std::string machine = folder.with("m.toml", kMachine);
  [[nodiscard]] Ran exported(std::vector<std::string> words, std::vector<std::string> more = {}) const {
    words.insert(words.begin(), "export");
    words.insert(words.end(), {map, "--params", params, "--machine", machine, "--json", "--force"});
    words.insert(words.end(), more.begin(), more.end());
    return ran(words);
  }
};

nlohmann::json row_of(const nlohmann::json& answer, const std::string& where) {
  for (const auto& row : answer["residual"]["rows"])
    if (row["where"] == where) return row;
  return {};
}

double largest(const nlohmann::json& answer, const std::string& where, const std::string& column,
               const std::string& direction) {
  return row_of(answer, where)[column][direction]["largest_um"].get<double>();
}

TEST_CASE("a LinuxCNC export writes a file for each axis, names the INI lines and what stays behind") {
  const ExportWorkspace workspace;
  const Ran r = workspace.exported({"linuxcnc"}, {"-o", workspace.folder / "lc"});
  CHECK(r.code == 0);
  const auto j = r.json();
  CHECK(content_of(workspace.folder / "lc/x.comp")
            .starts_with("-400.000000 0.009000 0.007000\n-350.000000 0.008000 0.006000\n"));
  CHECK(std::filesystem::exists(workspace.folder / "lc/y.comp"));
  CHECK_FALSE(std::filesystem::exists(workspace.folder / "lc/z.comp"));
  CHECK(j["settings"][3] == "[JOINT_1]");
  std::vector<std::string> left;
  for (const auto& one : j["not_carried"]) left.push_back(one["what"]);
  CHECK(left == std::vector<std::string>{"ECX", "EXY", "C0Y"});
}

TEST_CASE("the prediction says what a control leaves that only knows some of the map") {
  const ExportWorkspace workspace;
  const auto linuxcnc = workspace.exported({"linuxcnc"}).json();
  CHECK(linuxcnc["residual"]["from"] == "the map");
  CHECK(largest(linuxcnc, "line of X", "not_compensated", "X") == Approx(9.0));
  CHECK(largest(linuxcnc, "line of X", "this_export", "X") == Approx(0.0));
  // X along Y: straightness 4 um at most, squareness −40 um/m over −400 mm: error −C0Y·Y = +16 um at Y = −400
  CHECK(largest(linuxcnc, "line of Y", "this_export", "X") > 15.0);
  CHECK(largest(linuxcnc, "line of Y", "whole_map", "X") == Approx(0.0));
  const auto siemens = workspace.exported({"siemens"}).json();
  CHECK(largest(siemens, "line of Y", "this_export", "X") < 0.01);
  // ECX is −40 um/m at X −400 (compensation), over Y −400 mm: 16 um of X that no table of one axis has
  CHECK(largest(siemens, "volume", "this_export", "X") == Approx(16.0).epsilon(0.01));
  const auto etalon = workspace.exported({"etalon"}).json();
  CHECK(largest(etalon, "volume", "this_export", "X") == Approx(1.0).epsilon(0.01));  // half the reversal of EXX
}

TEST_CASE("a model can say more than the map: what neither of them compensates stays") {
  const ExportWorkspace workspace;
  const std::string model = workspace.folder.with("model.toml", R"([[effect]]
id = "scale"
axis = "X"
sense = "EX"
parameters = { um_per_m = 20.0 }
[[effect]]
id = "cyclic"
axis = "X"
sense = "EX"
parameters = { period_mm = 7.3, amplitude_um = 3.0, phase_rad = 0.0 }
)");
  const Ran r = workspace.exported({"linuxcnc"}, {"--model", model});
  REQUIRE(r.code == 0);
  const auto j = r.json();
  CHECK(j["residual"]["from"] == model);
  CHECK(largest(j, "line of X", "not_compensated", "X") > 8.0);
  // the map takes the 20 um/m away exactly and adds its reversal of 1 um; the cycle stays
  CHECK(largest(j, "line of X", "this_export", "X") == Approx(4.0).epsilon(0.02));
}

TEST_CASE(
    "an Etalon file of ours is read by what its head says of its lever arms, and the answer says what was moved") {
  ExportWorkspace workspace;
  workspace.params = workspace.folder.with(
      "lines.toml", std::string(kParameters) + "[axis.X]\nmeasurement_line_mm = { y = -250.0, z = -100.0 }\n");
  const std::string back = workspace.folder / "back.csv", errors = workspace.folder / "errors.txt";
  const auto original = laser::read_map_csv(workspace.map);
  REQUIRE(original);
  for (const std::string levers : {"zero", "lines"}) {
    CAPTURE(levers);
    REQUIRE(workspace.exported({"etalon", "--levers", levers}, {"-o", errors}).code == 0);
    const Ran r = ran({"export", "read", errors, "--params", workspace.params, "-o", back, "--json", "--force"});
    REQUIRE(r.code == 0);
    const auto j = r.json();
    CHECK(j["curves_moved"] == (levers == "zero"));
    CHECK(j["levers_from"] == (levers == "zero" ? "machine zero" : "measurement lines"));
    CHECK(j["notes"].dump().find(levers == "zero" ? "X at Y -250, Z -100" : "were not moved") != std::string::npos);
    const auto map = laser::read_map_csv(back);
    REQUIRE(map);
    for (const Component component : {Component::EXX, Component::EYY, Component::EXY, Component::ECX})
      for (const double p : {-400.0, -375.0, -110.0, 0.0}) {
        const auto at = [&](const laser::ErrorMap& from, Approach approach) {
          return laser::compensation_at(*laser::table_of(from, component, approach), p);
        };
        const double mean = 0.5 * (at(*original, Approach::forward) + at(*original, Approach::reverse));
        CHECK(at(*map, Approach::forward) == Approx(mean).epsilon(0.001));
      }
    const std::string other = levers == "zero" ? "lines" : "zero";
    CHECK(ran({"export", "read", errors, "--params", workspace.params, "--levers", other}).code == 2);
  }
  const std::string foreign = workspace.folder.with("foreign.txt", "[EXX]\nGridpoints = {\n-400 0.001\n0 0.002\n}\n");
  const auto read = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"export", "read", foreign, "--params", workspace.params, "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return ran(words).json();
  };
  CHECK(read({})["curves_moved"] == true);
  CHECK(read({"--levers", "lines"})["curves_moved"] == false);
}

TEST_CASE("what a control cannot hold is reported for the map, not for a file that does not exist") {
  const ExportWorkspace workspace;
  const std::string close = workspace.folder.with(
      "close.csv", "axis,sense,approach,p_mm,value_um\nX,EX,0,0,1\nX,EX,0,1e-9,50\nX,EX,0,100,2\n");
  for (const char* control : {"linuxcnc", "siemens", "etalon", "twincat", "heidenhain"}) {
    CAPTURE(control);
    const Ran r = ran({"export", control, close, "--json"});
    REQUIRE(r.code == 0);
    CHECK(r.json()["tables"][0]["deviation_from_unit"].get<double>() > 40.0);
  }
  const std::string far =
      workspace.folder.with("far.csv", "axis,sense,approach,p_mm,value_um\nX,EX,0,-1e308,1\nX,EX,0,1e308,2\n");
  for (const char* control : {"linuxcnc", "siemens", "etalon", "twincat", "heidenhain"}) {
    CAPTURE(control);
    const Ran r = ran({"export", control, far, "--json"});
    CHECK(r.code == 1);
    const auto error = r.json()["error"];
    CHECK(error["file"] == far);
    CHECK(error["message"].get<std::string>().find("EXX, point 1 at -1e+308 mm") != std::string::npos);
  }
}

TEST_CASE("every format comes back as the map it was made from") {
  const ExportWorkspace workspace;
  const std::string out = workspace.folder / "out", back = workspace.folder / "back.csv",
                    errors = workspace.folder / "errors.txt";
  const auto original = laser::read_map_csv(workspace.map);
  const auto same = [&](Component component, double shift, bool mean) {
    const auto map = laser::read_map_csv(back);
    REQUIRE(map);
    for (const Approach approach : {Approach::forward, Approach::reverse})
      for (const double p : {-400.0, -375.0, -110.0, 0.0}) {
        double wanted = laser::compensation_at(*laser::table_of(*original, component, approach), p);
        if (mean && component == Component::EXX) wanted -= static_cast<double>(approach);
        CHECK(laser::compensation_at(*laser::table_of(*map, component, approach), p) + shift ==
              Approx(wanted).epsilon(0.001));
      }
  };
  REQUIRE(workspace.exported({"linuxcnc", "--type", "0"}, {"-o", out}).code == 0);
  REQUIRE(ran({"export", "read", out + "/x.comp", out + "/y.comp", "-o", back, "--force"}).code == 0);
  same(Component::EXX, 0.0, false);
  same(Component::EYY, 0.0, false);

  REQUIRE(workspace.exported({"siemens", "--axes", "X=MX1,Y=MY1,Z=MZ1"}, {"-o", out}).code == 0);
  const Ran siemens = ran({"export", "read", out + "/AX_EEC.INI", out + "/NC_CEC.INI", "--axes", "X=MX1,Y=MY1,Z=MZ1",
                           "-o", back, "--json", "--force"});
  REQUIRE(siemens.code == 0);
  CHECK(siemens.json()["squareness"]["C0Y_um_per_m"].get<double>() == Approx(40.0).epsilon(1e-4));
  same(Component::EXX, 0.0, false);
  same(Component::EXY, 0.0, false);

  REQUIRE(workspace.exported({"etalon"}, {"-o", errors}).code == 0);
  const Ran etalon = ran({"export", "read", errors, "--params", workspace.params, "--params-out",
                          workspace.folder / "q.toml", "-o", back, "--force"});
  REQUIRE(etalon.code == 0);
  CHECK(content_of(workspace.folder / "q.toml").find("C0Y_um_per_m = 40") != std::string::npos);
  for (const Component component : {Component::EXX, Component::EYY, Component::EXY, Component::ECX})
    same(component, 0.0, true);
}

TEST_CASE("the map of another chain is refused, one of an unknown machine is not") {
  const ExportWorkspace workspace;
  const std::string other = workspace.folder.with("other.toml", "[configuration]\nchain = \"XYTZ\"\n");
  const Ran r = ran({"export", "etalon", workspace.map, "--params", other});
  CHECK(r.code == 1);
  CHECK(r.messages.find("made for TXYZ, the parameters say XYTZ") != std::string::npos);
  const Ran alone = ran({"export", "linuxcnc", workspace.map});
  CHECK(alone.code == 0);
  CHECK(alone.out.find("without --params: squareness counts as 0") != std::string::npos);
  CHECK(alone.out.find("nothing written: give -o FOLDER") != std::string::npos);
}

TEST_CASE("TwinCAT lists come back as the positioning of the map, and say what they leave") {
  const ExportWorkspace workspace;
  const std::string out = workspace.folder / "tc", back = workspace.folder / "back.csv";
  const Ran r = workspace.exported({"twincat", "--axes", "X=5,Y=6"}, {"-o", out});
  REQUIRE(r.code == 0);
  // At X −400 the map adds 9 um forward and 7 um in reverse: the errors are −9 and −7 um.
  CHECK(content_of(out + "/achskw5.lis").find("kw.ssfk.table[0].pos -90\nkw.ssfk.table[0].neg -70\n") !=
        std::string::npos);
  CHECK(largest(r.json(), "line of X", "this_export", "X") == Approx(0.0));
  CHECK(largest(r.json(), "line of Y", "this_export", "X") > 15.0);
  const Ran read = ran({"export", "read", out + "/achskw5.lis", out + "/achskw6.lis", "--axes", "X=5,Y=6", "-o", back,
                        "--json", "--force"});
  REQUIRE(read.code == 0);
  CHECK(read.json()["format"] == "twincat");
  const auto map = laser::read_map_csv(back);
  REQUIRE(map);
  CHECK(laser::compensation_at(*laser::table_of(*map, Component::EXX, Approach::reverse), -400.0) == Approx(7.0));
  CHECK(laser::compensation_at(*laser::table_of(*map, Component::EYY, Approach::forward), -400.0) == Approx(-4.0));
  REQUIRE(workspace.exported({"twincat", "--ssfk-sign", "adds"}, {"-o", out}).code == 0);
  CHECK(content_of(out + "/achskw1.lis").find("kw.ssfk.table[0].pos 90\n") != std::string::npos);
  // The list says its sign: no option is needed, and a wrong one is refused.
  REQUIRE(ran({"export", "read", out + "/achskw1.lis", "-o", back, "--force"}).code == 0);
  const auto added = laser::read_map_csv(back);
  CHECK(laser::compensation_at(*laser::table_of(*added, Component::EXX, Approach::forward), -400.0) == Approx(9.0));
  const Ran wrong = ran({"export", "read", out + "/achskw1.lis", "--ssfk-sign", "subtracts"});
  CHECK(wrong.code == 3);
  CHECK(wrong.messages.find("achskw1.lis:1:1: the list was written with --ssfk-sign adds") != std::string::npos);
  CHECK(workspace.exported({"twincat", "--axes", "X=0"}).code == 2);
  CHECK(workspace.exported({"twincat", "--axes", "X=2"}).code == 2);
}

TEST_CASE("a folder in the place of one file: exit code 5, and the former tables are unchanged") {
  const ExportWorkspace workspace;
  const std::string out = workspace.folder / "lc";
  REQUIRE(workspace.exported({"linuxcnc"}, {"-o", out}).code == 0);
  const std::string before = content_of(out + "/x.comp");
  std::filesystem::remove(out + "/y.comp");
  std::filesystem::create_directory(out + "/y.comp");
  const Ran r = workspace.exported({"linuxcnc", "--type", "0"}, {"-o", out});
  CHECK(r.code == 5);
  CHECK(r.json()["error"]["message"] == "cannot write: a folder of that name is there; no file was changed");
  CHECK(content_of(out + "/x.comp") == before);
}

TEST_CASE("files that were there are replaced, and the answer says which") {
  const ExportWorkspace workspace;
  const std::string out = workspace.folder / "lc";
  CHECK(workspace.exported({"linuxcnc"}, {"-o", out}).json()["replaced"].empty());
  std::filesystem::remove(out + "/y.comp");
  const auto again = workspace.exported({"linuxcnc"}, {"-o", out}).json();
  CHECK(again["written"].size() == 2);
  CHECK(again["replaced"] == nlohmann::json::array({out + "/x.comp"}));
  const Ran text =
      ran({"export", "read", out + "/x.comp", "-o", workspace.folder.with("old.csv", "what was there"), "--force"});
  CHECK(text.out.find("replaced: " + (workspace.folder / "old.csv")) != std::string::npos);
}

TEST_CASE("files of an earlier export that this one does not write are named, whichever control it is for") {
  const ExportWorkspace workspace;
  const std::string out = workspace.folder / "out";
  const auto left = [](const Ran& r) {
    const auto answer = r.json();
    for (const auto& note : answer["notes"])
      if (note.get<std::string>().starts_with("left from before, ")) return note.get<std::string>();
    return std::string();
  };
  for (const char* name : {"out/z.comp", "out/achskw9.lis", "out/achskw10.lis", "out/notes.txt", "out/x.compare"})
    (void)workspace.folder.with(name, "of another map");
  CHECK(left(workspace.exported({"linuxcnc"}, {"-o", out})) == "left from before, not of this export: z.comp");
  CHECK(left(workspace.exported({"twincat"}, {"-o", out})) ==
        "left from before, not of this export: achskw10.lis, achskw9.lis");
  CHECK(left(workspace.exported({"siemens"}, {"-o", out})).empty());
  CHECK(left(workspace.exported({"siemens", "--tables", "0"}, {"-o", out})) ==
        "left from before, not of this export: NC_CEC.INI");
  CHECK(left(workspace.exported({"linuxcnc"})).empty());
  CHECK(content_of(out + "/z.comp") == "of another map");
}

TEST_CASE("a map of another machine than the parameters is refused without --other-machine") {
  const ExportWorkspace workspace;
  const std::string other = workspace.folder.with("other.csv", "# machine: lathe\n" + map_text());
  for (const auto& with : {std::pair{"--params", workspace.params}, {"--machine", workspace.machine}}) {
    const std::vector<std::string> words{
        "export", "linuxcnc", other, with.first, with.second, "-o", workspace.folder / "lc"};
    const Ran r = ran(words);
    CHECK(r.code == 1);
    CHECK(r.messages.find("\"lathe\"") != std::string::npos);
    CHECK(r.messages.find("--other-machine") != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(workspace.folder / "lc"));
    std::vector<std::string> meant = words;
    meant.push_back("--other-machine");
    CHECK(ran(meant).code == 0);
    std::filesystem::remove_all(workspace.folder / "lc");
  }
}

TEST_CASE("maps and parameters saved as UTF-16: the map is read, the parameters say what to do") {
  const ExportWorkspace workspace;
  const auto utf16 = [](const std::string& text) {
    std::string out = "\xFF\xFE";
    for (const char c : text) out += {c, '\0'};
    return out;
  };
  const std::string map = workspace.folder.with("map16.csv", utf16(map_text()));
  CHECK(ran({"export", "linuxcnc", map, "--params", workspace.params}).code == 0);
  const std::string params = workspace.folder.with("p16.toml", utf16(kParameters));
  const Ran r = ran({"export", "linuxcnc", workspace.map, "--params", params});
  CHECK(r.code == 3);
  CHECK(r.messages.find("p16.toml: this is UTF-16: save it as UTF-8") != std::string::npos);
}

TEST_CASE("exit codes: usage 2, broken file 3, cannot write 5, and inputs are spared") {
  const ExportWorkspace workspace;
  CHECK(ran({"export", "linuxcnc"}).code == 2);
  CHECK(ran({"export", "linuxcnc", workspace.map, "--model", "x.toml"}).code == 2);
  CHECK(ran({"export", "siemens", workspace.map, "--axes", "X=AX2"}).code == 2);
  CHECK(ran({"export", "linuxcnc", workspace.folder / "none.csv"}).code == 3);
  CHECK(
      ran({"export", "linuxcnc", workspace.folder.with("nan.csv", "axis,sense,approach,p_mm,value_um\nX,EX,0,0,nan\n")})
          .code == 3);
  CHECK(ran({"export", "linuxcnc", workspace.map, "-o", workspace.map}).code == 5);
  CHECK(ran({"export", "etalon", workspace.map, "-o", workspace.folder / "no/such/folder.txt"}).code == 5);
  CHECK(ran({"export", "etalon", workspace.map, "-o", workspace.map}).code == 2);
  CHECK(content_of(workspace.map) == map_text());
}

TEST_CASE("a LinuxCNC file with a silent stop is read with a warning, and a typing error is refused with its place") {
  const ExportWorkspace workspace;
  const std::string silent = workspace.folder.with("x.comp", "0 0 0\n\n100 0.01 0.02\n");
  const Ran r = ran({"export", "read", silent, "--type", "1", "--json"});
  CHECK(r.code == 0);
  CHECK(r.json()["warnings"][0]["line"] == 2);
  CHECK(r.messages.find("x.comp:2:1: LinuxCNC stops reading at an empty line") != std::string::npos);
  const Ran wrong = ran({"export", "read", workspace.folder.with("y.comp", "0 0 0\n10 O.1 0\n"), "--json"});
  CHECK(wrong.code == 3);
  CHECK(wrong.json()["error"]["line"] == 2);
  CHECK(wrong.json()["error"]["column"] == 4);
}

TEST_CASE("a file that is not a table of a control is refused, and axes are taken from names") {
  const ExportWorkspace workspace;
  CHECK(ran({"export", "read", workspace.map}).messages.find("no compensation table that is known here") !=
        std::string::npos);
  const std::string rows = "0 0 0\n50 0.004 0.007\n";
  CHECK(ran({"export", "read", workspace.folder.with("screwcompZ.dat", rows)}).out.find("EZZ") != std::string::npos);
  CHECK(ran({"export", "read", workspace.folder.with("mill_y.comp", rows)}).out.find("EYY") != std::string::npos);
  CHECK(ran({"export", "read", workspace.folder.with("proxy.comp", rows)}).code == 2);  // ends in y, yet is no axis
  CHECK(ran({"export", "read", workspace.folder / "proxy.comp", "--axis", "x"}).out.find("EXX") != std::string::npos);
  CHECK(ran({"export", "read", workspace.folder / "mill_y.comp", workspace.folder / "mill_y.comp"}).code == 3);
}

}  // namespace
}  // namespace ecs::app
