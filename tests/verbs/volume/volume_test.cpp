// `ecs volume`: the keys of the contract, numbers that a hand can check, the emulator as an independent witness.
#include <cmath>

#include <doctest/doctest.h>

#include "base/text.hpp"
#include "params/parameters_toml.hpp"
#include "tests/support/command_output.hpp"
#include "tests/support/emulator.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

using doctest::Approx;

/// A map of X alone, 20 um too long at 1000 mm, parameters beside it, no machine file.
struct OneAxisFiles : Folder {
  OneAxisFiles() {
    UnitParameters p;
    p.configuration = {'T', 'X', 0, 0, 0};
    p.axis_present = {true, false, false};
    p.scope = Scope::linear;
    REQUIRE(params::write_parameters(parameters, p));
  }
  std::string map = with("map.csv",
                         "# configuration: TX\naxis,sense,approach,p_mm,value_um\nX,EX,0,0,0\nX,EX,0,500,-10\n"
                         "X,EX,0,1000,-20\n");
  std::string parameters = *this / "parameters.toml";
};

constexpr const char* kErrors = "[[contribution]]\ncomponent = \"EXX\"\nformula = \"0.03*p + 2*d\"\n";

TEST_CASE("the answer has the keys of the contract, before and after by hand") {
  const OneAxisFiles files;
  const Ran r = ran({"volume", files.map, "--params", files.parameters, "--points", "101", "--json"});
  REQUIRE_MESSAGE(r.code == 0, r.all());
  const auto j = r.json();
  CHECK(j["points"] == 101);
  CHECK(j["before"]["largest_um"].get<double>() == Approx(20.0));
  CHECK(j["before"]["p95_um"].get<double>() == Approx(19.0));
  CHECK(j["before"]["rms_um"].get<double>() == Approx(20.0 * std::sqrt(201.0 / 600.0)));
  CHECK(j["before"]["at"] == nlohmann::json{1000.0, 0.0, 0.0});
  CHECK(j["after"]["largest_um"].get<double>() < 1e-9);
  CHECK(j["uncertainty_95_um"]["largest"].get<double>() > 0.0);
  CHECK(j["uncertainty_95_um"]["rms"].get<double>() <= j["uncertainty_95_um"]["largest"].get<double>());
}

TEST_CASE("with an errors file the true errors count, and what the map leaves of them") {
  const OneAxisFiles files;
  const std::string errors = files.with("errors.toml", kErrors);
  const Ran r =
      ran({"volume", files.map, "--params", files.parameters, "--errors", errors, "--points", "51", "--json"});
  REQUIRE_MESSAGE(r.code == 0, r.all());
  const auto j = r.json();
  CHECK(j["before"]["largest_um"].get<double>() == Approx(32.0));
  CHECK(j["after"]["largest_um"].get<double>() == Approx(12.0));
  CHECK(j["errors_from"] == "the errors file");
}

TEST_CASE("what the errors file holds beyond the true errors of a cold machine at rest is named") {
  const OneAxisFiles files;
  const std::string plain = files.with("errors.toml", kErrors);
  const std::string more =
      files.with("more.toml",
                 "[[contribution]]\ncomponent = \"EXX\"\nformula = \"0.02*p + 0.001*m*p + 3*(1-exp(-t/600))\"\n"
                 "[scatter]\nEYX = { reading = 0.4 }\n");
  const auto notes = [&](const std::string& errors) {
    const Ran r =
        ran({"volume", files.map, "--params", files.parameters, "--errors", errors, "--points", "51", "--json"});
    REQUIRE_MESSAGE(r.code == 0, r.all());
    const auto answer = r.json();
    std::string text;
    for (const auto& note : answer["notes"]) text += note.get<std::string>() + "\n";
    return text;
  };
  CHECK(notes(plain).find("left out") == std::string::npos);
  CHECK(notes(more).find("which is left out: scatter (EYX); time and heat (EXX); load (EXX)\n") != std::string::npos);
}

TEST_CASE("what falls between the places is found on lines through the largest, where that is asked for") {
  const OneAxisFiles files;
  const std::string errors = files.with(
      "jump.toml", "[[contribution]]\ncomponent = \"EXX\"\nformula = \"0.02*p + (p > 512 && p < 518 ? 30 : 0)\"\n");
  const std::vector<std::string> words{"volume", files.map,  "--params", files.parameters, "--errors",
                                       errors,   "--points", "51",       "--json"};
  CHECK(ran(words).json()["between"].is_null());
  std::vector<std::string> asked = words;
  asked.emplace_back("--between");
  const Ran r = ran(asked);
  REQUIRE_MESSAGE(r.code == 0, r.all());
  const auto j = r.json();
  CHECK(j["before"]["largest_um"].get<double>() == Approx(20.0));
  CHECK(j["between"]["before"]["largest_um"].get<double>() == Approx(40.35).epsilon(0.001));
  CHECK(j["after"]["largest_um"].get<double>() < 1e-6);
  CHECK(j["between"]["after"]["largest_um"].get<double>() == Approx(30.0));
  CHECK(j["between"]["after"]["at"][0].get<double>() == Approx(515.0).epsilon(0.006));
}

TEST_CASE("with a fitted model its prediction counts, where it knows all that is compensated") {
  const Folder folder;
  const std::string model = folder.with(
      "m.toml", "[[effect]]\nid = \"scale\"\naxis = \"X\"\nsense = \"EX\"\nparameters = { um_per_m = 20.0 }\n");
  const std::string rows = "axis,sense,approach,p_mm,value_um\nX,EX,0,0,0\nX,EX,0,1200,-20\n";
  const std::string map = folder.with("map.csv", rows);
  const std::string parameters = "samples/machining_centre/parameters.toml";
  const Ran r = ran({"volume", map, "--params", parameters, "--model", model, "--points", "64", "--json"});
  REQUIRE_MESSAGE(r.code == 0, r.all());
  CHECK(r.json()["before"]["largest_um"].get<double>() == Approx(24.0));
  CHECK(r.json()["after"]["largest_um"].get<double>() == Approx(4.0));
  CHECK(ran({"volume", map, "--params", parameters, "--model", model, "--points", "300000"}).code == 2);
  const std::string more = folder.with("more.csv", rows + "Y,EY,0,0,0\nY,EY,0,600,-5\n");
  const Ran lacking = ran({"volume", more, "--params", parameters, "--model", model});
  CHECK(lacking.code == 1);
  CHECK(lacking.messages.find("no effect for EYY") != std::string::npos);
}

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

TEST_CASE("the text fits a terminal") {
  const Ran r = ran({"volume", "none.csv", "--params", "samples/mill/parameters.toml"});
  CHECK(r.code == 3);
  const OneAxisFiles files;
  const Ran shown = ran({"volume", files.map, "--params", files.parameters, "--at", "500,0,0", "--points", "101"});
  REQUIRE(shown.code == 0);
  const auto lines = lines_of(shown.out);
  CHECK(lines.size() <= 24);
  for (const auto line : lines) CHECK(line.size() <= 84);  // an ellipsis takes three bytes
}

TEST_CASE("a slice is shown as numbers") {
  const OneAxisFiles files;
  const Ran refused = ran({"volume", files.map, "--params", files.parameters, "--slice", "XY", "--points", "101"});
  CHECK(refused.code == 2);  // there is no Y
  const Folder folder;
  const std::string map = folder.with("map.csv", "axis,sense,approach,p_mm,value_um\nX,EX,0,0,0\nX,EX,0,1200,-24\n");
  const Ran r =
      ran({"volume", map, "--params", "samples/machining_centre/parameters.toml", "--slice", "XZ", "--points", "125"});
  REQUIRE_MESSAGE(r.code == 0, r.all());
  CHECK(r.out.find("   -600    0(0)    3(0)    6(0)") != std::string::npos);
  CHECK(lines_of(r.out).size() <= 25);  // the last is empty
}

TEST_CASE("every value of the map is written with its standard uncertainty") {
  const OneAxisFiles files;
  const std::string values = files / "values.csv";
  REQUIRE(ran({"volume", files.map, "--params", files.parameters, "--repeatability", "1.5", "--instrument", "0",
               "--temperature", "0", "--values", values, "--points", "101"})
              .code == 0);
  CHECK(content_of(values) ==
        "axis,sense,approach,p_mm,value_um,u_um\nX,EX,0,0,0,1.5000\nX,EX,0,500,-10,1.5000\n"
        "X,EX,0,1000,-20,1.5000\n");
}

TEST_CASE("what cannot be computed is refused in words, and nothing is written") {
  const OneAxisFiles files;
  const std::string picture = files / "v.svg";
  const auto refused = [&](std::vector<std::string> words, int code, const char* saying) {
    words.insert(words.begin(), {"volume", files.map, "--params", files.parameters, "-o", picture, "--draws", "20"});
    const Ran r = ran(words);
    CAPTURE(r.all());
    CHECK(r.code == code);
    CHECK(r.messages.find(saying) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(picture));
  };
  refused({"--at", "1500,0,0"}, 2, "expected X within 0");
  refused({"--at", "here"}, 2, "three numbers");
  refused({"--tool-length", "100", "--tool-offset", "0,0,1"}, 2, "got both");
  refused({"--errors", "e.toml", "--model", "m.toml"}, 2, "got both");
  refused({"--points", "3"}, 2, "points");
  refused({"--errors", files.with("bad.toml", "[[contribution]]\ncomponent = \"EXQ\"\nformula = \"p\"\n")}, 3, "EXQ");
  refused({"--errors", files / "none.toml"}, 3, "none.toml");
  const std::string other =
      files.with("other.csv", "# configuration: XT\naxis,sense,approach,p_mm,value_um\nX,EX,0,0,0\nX,EX,0,1,0\n");
  const Ran r = ran({"volume", other, "--params", files.parameters, "--points", "101"});
  CHECK(r.code == 1);
  CHECK(r.messages.find("made for XT") != std::string::npos);
}

TEST_CASE("an error that depends on two axes is refused by its name") {
  const Folder folder;
  const std::string errors =
      folder.with("errors.toml", "[[contribution]]\ncomponent = \"EYX\"\nformula = \"0.001*p*y\"\n");
  const std::string map = folder.with("map.csv", "axis,sense,approach,p_mm,value_um\nX,EX,0,0,0\nX,EX,0,1200,0\n");
  const Ran r = ran({"volume", map, "--params", "samples/machining_centre/parameters.toml", "--errors", errors});
  CHECK(r.code == 3);
  CHECK(r.messages.find("EYX depends on where another axis") != std::string::npos);
}

TEST_CASE("where nothing is left of what is known, text and picture show the bound") {
  const OneAxisFiles files;
  const std::string picture = files / "v.svg";
  const Ran r = ran({"volume", files.map, "--params", files.parameters, "-o", picture, "--points", "101"});
  REQUIRE_MESSAGE(r.code == 0, r.all());
  CHECK(r.out.find("\nleft of that          0.0") != std::string::npos);
  CHECK(r.out.find("\nafter, at most ") != std::string::npos);
  CHECK(content_of(picture).find("95 % bound") != std::string::npos);
  CHECK(content_of(picture).find("largest 0 um") == std::string::npos);
}

TEST_CASE("a picture is drawn") {
  const OneAxisFiles files;
  const std::string picture = files / "v.svg";
  REQUIRE(ran({"volume", files.map, "--params", files.parameters, "-o", picture, "--points", "101"}).code == 0);
  CHECK(content_of(picture).find("<svg") != std::string::npos);
}

}  // namespace
}  // namespace ecs::app
