// `ecs volume` on machines with rotary axes: keys, numbers that a hand can check, what is refused.
#include <cmath>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "params/parameters_toml.hpp"
#include "tests/support/model_workspace.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

using doctest::Approx;

/// X 20 um too long at 1000 mm; a rotary table C on the saddle whose axis lies 10 um aside in X.
struct TurningTable : Folder {
  TurningTable() {
    UnitParameters p;
    p.configuration = {'X', 'Y', 'T', 'Z', 0};
    REQUIRE(params::write_parameters(parameters, p));
  }
  std::string machine = with("five.toml",
                             "configuration = \"XYCTZ\"\n[axis.X]\ntravel_mm = [0, 1000]\n[axis.Y]\ntravel_mm = [0, "
                             "500]\n[axis.Z]\ntravel_mm = [0, 400]\n[axis.C]\ntravel_deg = [0, 360]\npivot_mm = "
                             "[500, 250, 0]\n");
  std::string map = with("map.csv", "axis,sense,approach,p_mm,value_um\nX,EX,0,0,0\nX,EX,0,1000,-20\n");
  std::string rotary = with("rotary.csv", "component,approach,p_deg,error\nXOC,,,10\n");
  std::string parameters = *this / "parameters.toml";

  [[nodiscard]] Ran volume(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"volume", map, "--params", parameters, "--machine", machine};
    words.insert(words.end(), more.begin(), more.end());
    return ran(words);
  }
};

TEST_CASE("at a place and an angle the errors are those of the workpiece, and rotary errors remain") {
  const TurningTable files;
  const Ran r = files.volume({"--rotary", files.rotary, "--at", "1000,0,0,90", "--json"});
  REQUIRE_MESSAGE(r.code == 0, r.all());
  const auto at = r.json()["at"];
  CHECK(at["position_mm"] == nlohmann::json{1000.0, 0.0, 0.0});
  CHECK(at["position_deg"] == nlohmann::json{{"C", 90.0}});
  const auto forward = at["sides"][0];
  CHECK(forward["before_um"][0].get<double>() == Approx(-10.0));  // X of the machine is Y of the workpiece
  CHECK(forward["before_um"][1].get<double>() == Approx(30.0));
  CHECK(forward["after_um"][1].get<double>() == Approx(10.0));
  CHECK(forward["orientation_um_per_m"] == nlohmann::json{0.0, 0.0, 0.0});
  CHECK(at["expanded_uncertainty_um"][0].get<double>() > 1.0);
}

TEST_CASE("the answer says chain, settings, angles of the largest error, and that the unit compensates X, Y, Z") {
  const TurningTable files;
  const Ran r = files.volume({"--rotary", files.rotary, "--points", "1296", "--json"});
  REQUIRE_MESSAGE(r.code == 0, r.all());
  const auto j = r.json();
  CHECK(j["rotary"]["chain"] == "w C' Y' X' b Z t");
  CHECK(j["rotary"]["compensated"] == nlohmann::json{"X", "Y", "Z"});
  CHECK(j["rotary"]["settings"] == 6);
  CHECK(j["points"] == 1296);
  CHECK(j["before"]["at_deg"]["C"] == 180.0);  // 20 um of scale, 20 um across the table
  CHECK(j["before"]["largest_um"].get<double>() == Approx(40.0));
  CHECK(j["after"]["largest_um"].get<double>() == Approx(20.0));
  CHECK(j["uncertainty_95_um"]["largest"].get<double>() > 20.0);
  CHECK(j["uncertainty"]["linear_rms_um"].get<double>() ==
        Approx(j["uncertainty"]["monte_carlo_rms_um"].get<double>()).epsilon(0.1));
  const Ran text = files.volume({"--rotary", files.rotary});
  CHECK(contains(text.out, "the unit compensates X, Y and Z as with the rotary axes at 0"));
  CHECK(contains(text.out, "not given: EXC, EYC, EZC, EAC, EBC, ECC (--rotary)"));
  CHECK(contains(text.out, "With the uncertainty of the map and of the rotary axes"));
  CHECK(contains(text.out, "no standard uncertainty is given (column u)"));
  CHECK(widest_line(text.out) <= 80);
}

TEST_CASE("the uncertainty that the file of rotary errors states is that of the volume") {
  const TurningTable files;
  const auto bound = [&](const char* u) {
    const std::string stated =
        files.with(fmt::format("u{}.csv", u), fmt::format("component,approach,p_deg,error,u\nXOC,,,10,{}\n", u));
    const Ran r = files.volume({"--rotary", stated, "--zero-uncertainty", "0", "--points", "256", "--json"});
    REQUIRE_MESSAGE(r.code == 0, r.all());
    return r.json()["uncertainty"];
  };
  const auto small = bound("0.1"), large = bound("9");
  CHECK(large["linear_rms_um"].get<double>() > 5.0 * small["linear_rms_um"].get<double>());
  CHECK(large["linear_rms_um"].get<double>() == Approx(large["monte_carlo_rms_um"].get<double>()).epsilon(0.1));
  CHECK(large["components"].back()["component"] == "XOC");
  const std::string wrong = files.with("w.csv", "component,approach,p_deg,error,u\nXOC,,,10,-1\n");
  CHECK(contains(files.volume({"--rotary", wrong}).messages, "w.csv:2:10: u: expected a standard uncertainty"));
}

TEST_CASE("an error model stands for the map, and its rotations act at every angle") {
  const TurningTable files;
  const std::string model = files.with("model.toml",
                                       "[[effect]]\nid = \"scale\"\naxis = \"X\"\nparameters = { um_per_m = 20 }\n"
                                       "[[effect]]\nid = \"squareness\"\ncode = \"C0Y\"\n"
                                       "parameters = { um_per_m = 40 }\n");
  const Ran at = files.volume({"--model", model, "--rotary", files.rotary, "--at", "1000,500,0,90", "--json"});
  REQUIRE_MESSAGE(at.code == 0, at.all());
  const auto before = at.json()["at"]["sides"][0]["before_um"];
  CHECK(before[0].get<double>() == Approx(-10.0));              // XOC as before
  CHECK(before[1].get<double>() == Approx(30.0 - 0.5 * 40.0));  // the lean of Y adds along X of the machine
  CHECK(at.json()["errors_from"] == "the error model");
  CHECK(at.json()["uncertainty_95_um"]["rms"].get<double>() > 0.0);
}

TEST_CASE("the true errors of an emulated machine include those of its rotary axes") {
  const TurningTable files;
  const std::string errors = files.with("errors.toml",
                                        "[location]\nXOC = 10.0\n[[effect]]\nid = \"scale\"\naxis = \"X\"\n"
                                        "parameters = { um_per_m = 20.0 }\n[[contribution]]\ncomponent = \"EZC\"\n"
                                        "formula = \"0.1*p\"\n");
  const Ran at = files.volume({"--errors", errors, "--at", "1000,0,0,90", "--json"});
  REQUIRE_MESSAGE(at.code == 0, at.all());
  const auto side = at.json()["at"]["sides"][0];
  CHECK(side["before_um"][0].get<double>() == Approx(-10.0));
  CHECK(side["before_um"][1].get<double>() == Approx(30.0));
  CHECK(side["before_um"][2].get<double>() == Approx(9.0));
  CHECK(side["after_um"][1].get<double>() == Approx(10.0));
}

TEST_CASE("without rotary axes nothing changes: their keys are null") {
  const Folder folder;
  const std::string map = folder.with("map.csv", "axis,sense,approach,p_mm,value_um\nX,EX,0,0,0\nX,EX,0,1200,-20\n");
  const Ran r = ran({"volume", map, "--params", "samples/machining_centre/parameters.toml", "--json"});
  REQUIRE_MESSAGE(r.code == 0, r.all());
  CHECK(r.json()["rotary"].is_null());
  CHECK(r.json()["before"]["at_deg"].is_null());
  CHECK(r.json()["uncertainty_95_um"]["largest"].is_number());
}

TEST_CASE("the sample of a machining centre with a tilting rotary table is evaluated and drawn") {
  const Folder folder;
  const std::string picture = folder / "five.svg";
  const std::string params = "samples/machining_centre/parameters.toml";
  const Ran r = ran({"volume", "samples/five_axes/map.csv", "--params", params, "--machine",
                     "samples/five_axes/machine.toml", "--rotary", "samples/five_axes/rotary.csv", "--tool-length",
                     "150", "--at", "600,300,-300,-90,45", "--slice", "XZ", "-o", picture, "--json"});
  REQUIRE_MESSAGE(r.code == 0, r.all());
  const auto j = r.json();
  CHECK(j["rotary"]["settings"] == 36);
  CHECK(j["before"]["largest_um"].get<double>() > j["after"]["largest_um"].get<double>());
  CHECK(j["slice"]["across"] == "X");
  CHECK(j["picture"] == picture);
}

TEST_CASE("readings of a rotary axis become its error motions, which the volume takes and a unit does not") {
  const TurningTable files;
  const std::string readings = files.with("ecc.csv",
                                          "axis,sense,c_deg,reading,approach,run\nC,EC,0,1,1,1\nC,EC,120,4,1,1\n"
                                          "C,EC,240,-2,1,1\nC,EC,0,3,1,2\nC,EC,120,6,1,2\nC,EC,240,0,1,2\n");
  const std::string table = files / "measured.csv";
  const Ran built = ran({"map", "build", readings, "-o", table, "--json"});
  REQUIRE_MESSAGE(built.code == 0, built.all());
  CHECK(built.json()["tables"][0]["component"] == "ECC");
  CHECK(built.json()["tables"][0]["mean"].get<double>() == Approx(2.0));
  CHECK(widest_line(ran({"map", "build", readings}).out) <= 80);
  const Ran at = files.volume({"--rotary", table, "--at", "500,250,0,120", "--json"});
  REQUIRE_MESSAGE(at.code == 0, at.all());
  CHECK(at.json()["at"]["sides"][0]["orientation_um_per_m"][2].get<double>() == Approx(5.0));
  const Ran sent = ran({"map", "send", table, "--params", files.parameters});
  CHECK(sent.code == 3);
  CHECK(contains(sent.messages, "a table of rotary axes; the unit compensates X, Y, Z"));
  const std::string like_a_map = files.with("like.csv", "axis,sense,approach,p_deg,value_um\nC,EC,0,0,1\n");
  for (const std::string& rotary_table : {table, like_a_map})
    for (const char* control : {"linuxcnc", "siemens", "twincat", "heidenhain", "etalon"}) {
      CAPTURE(control);
      const Ran exported = ran({"export", control, rotary_table, "--params", files.parameters, "-o", files / "out"});
      CHECK(exported.code == 3);
      CHECK(contains(exported.messages, "a table of rotary axes; the unit compensates X, Y, Z"));
    }
  const std::string mixed = files.with("x.csv", "axis,sense,x_mm,reading\nX,EX,0,1\nX,EX,1,2\n");
  CHECK(contains(ran({"map", "build", readings, mixed}).messages, "expected readings of rotary axes"));
}

TEST_CASE("what does not fit a machine with rotary axes is refused with what does") {
  const TurningTable files;
  CHECK(contains(files.volume({"--at", "1000,0,0,400"}).messages, "--at: expected C within 0 … 360 deg, got 400"));
  CHECK(files.volume({"--at", "1000,0,0,400"}).code == 2);
  CHECK(contains(files.volume({"--at", "1000,0,0,90,5"}).messages, "--at: expected 4 numbers X,Y,Z,C in mm and deg"));
  const std::string wrong = files.with("wrong.csv", "component,approach,p_deg,error\nEXA,1,0,1\n");
  const Ran refused = files.volume({"--rotary", wrong});
  CHECK(refused.code == 3);
  CHECK(contains(refused.messages, "wrong.csv:2:1: component: expected an axis of the machine"));
  const std::string linear = files.with("linear.toml",
                                        "configuration = \"XYTZ\"\n[axis.X]\ntravel_mm = [0, 1000]\n"
                                        "[axis.Y]\ntravel_mm = [0, 500]\n[axis.Z]\ntravel_mm = [0, 400]\n");
  const Ran none =
      ran({"volume", files.map, "--params", files.parameters, "--machine", linear, "--rotary", files.rotary});
  CHECK(none.code == 2);
  CHECK(contains(none.messages, "--rotary: expected a machine file with rotary axes"));
}

}  // namespace
}  // namespace ecs::app
