// The verbs of MODEL as a person or a script gives them.
#include <cmath>
#include <set>

#include <doctest/doctest.h>

#include "tests/support/model_workspace.hpp"

namespace ecs::app {
namespace {

using doctest::Approx;

std::set<std::string> keys_of(const nlohmann::json& object) {
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.insert(key);
  return keys;
}

void check_has(const nlohmann::json& object, const std::vector<std::string>& keys) {
  const std::set<std::string> there = keys_of(object);
  for (const std::string& key : keys) {
    CAPTURE(key);
    CHECK(there.contains(key));
  }
}

bool is_png(const std::string& file) { return content_of(file).substr(1, 3) == "PNG"; }
bool is_svg(const std::string& file) { return content_of(file).find("</svg>") != std::string::npos; }

// --- diagnose

TEST_CASE("diagnose names a missing periodic error, with the keys of the contract") {
  const ModelWorkspace workspace;
  const Ran r = workspace.verb("diagnose", {"--json", "--blanks", "100"});
  REQUIRE(r.code == 0);
  const nlohmann::json j = r.json();
  check_has(j, {"observations", "rms_um", "noise_um", "lack_of_fit", "verdict", "candidates", "where", "outliers"});
  check_has(j["lack_of_fit"], {"F", "p"});
  CHECK(j["observations"] == 246);
  CHECK(j["verdict"] == "missing_effect");
  CHECK(j["noise_um"].get<double>() == Approx(0.3).epsilon(0.2));
  const nlohmann::json& first = j["candidates"][0];
  check_has(first, {"effect", "axis", "sense", "approach", "code", "sensor", "parameters", "rms_after_um", "explained",
                    "p_value", "false_naming", "indistinguishable_from", "because", "next_measurement"});
  CHECK(first["effect"] == "cyclic");
  CHECK(first["axis"] == "X");
  CHECK(first["sense"] == "EX");
  CHECK(first["approach"] == "both");
  CHECK(first["code"].is_null());
  CHECK(first["sensor"].is_null());
  CHECK(first["parameters"]["period_mm"].get<double>() == Approx(8.0).epsilon(0.001));
  CHECK(first["parameters"]["amplitude_um"].get<double>() == Approx(2.0).epsilon(0.1));
  CHECK(first["rms_after_um"].get<double>() < 0.4);
  const double rms = j["rms_um"].get<double>(), after = first["rms_after_um"].get<double>();
  CHECK(first["explained"].get<double>() == Approx(1.0 - after * after / (rms * rms)));
  REQUIRE_FALSE(j["where"].empty());
  check_has(j["where"][0], {"variable", "strength"});
}

TEST_CASE("diagnose says first, in one sentence, what is missing, and keeps within 80 columns") {
  const ModelWorkspace workspace;
  const Ran r = workspace.verb("diagnose", {"--blanks", "100"});
  REQUIRE(r.code == 0);
  CHECK(r.out.starts_with("The model lacks cyclic:X:EX"));
  CHECK(r.out.find("period_mm") != std::string::npos);
  CHECK(widest_line(r.out) <= 80);
}

TEST_CASE("noise alone is adequate, and exits 0 too") {
  const ModelWorkspace workspace;
  const std::string data = workspace.folder.with("noise.csv", measured_x(straight_x));
  const Ran r =
      ran({"model", "diagnose", workspace.model, data, "--machine", workspace.machine, "--json", "--blanks", "100"});
  CHECK(r.code == 0);
  CHECK(r.json()["verdict"] == "adequate");
  for (const auto& candidate : r.json()["candidates"]) CHECK_FALSE(candidate["named"]);
}

TEST_CASE("one bad run is reported as structure that depends on the run, and exits 0") {
  const ModelWorkspace workspace;
  const std::string data = workspace.folder.with(
      "bad_run.csv",
      measured_x([](double x, int, int run) { return straight_x(x, 1, run) + (run == 2 ? 4.0 : 0.0); }, {.runs = 4}));
  const Ran r =
      ran({"model", "diagnose", workspace.model, data, "--machine", workspace.machine, "--json", "--blanks", "100"});
  CHECK(r.code == 0);
  CHECK(r.json()["verdict"] == "unexplained_structure");
  bool by_run = false;
  const nlohmann::json where = r.json()["where"];
  for (const nlohmann::json& one : where) by_run = by_run || one["variable"] == "run";
  CHECK(by_run);
}

TEST_CASE("gross outliers are listed by row") {
  const ModelWorkspace workspace;
  std::string text = measured_x(straight_x);
  const std::size_t row = text.find("X,EX,", text.find("X,EX,", 200) + 1);  // some row in the middle
  const auto number = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(row), '\n');
  const std::size_t reading = text.find(',', row + 5) + 1;
  text.replace(reading, text.find(',', reading) - reading, "250.0");
  const Ran r =
      ran({"model", "diagnose", workspace.model, workspace.folder.with("o.csv", text), "--json", "--blanks", "100"});
  CHECK(r.json()["outliers"] == nlohmann::json::array({number}));
}

TEST_CASE("every verb that plots writes a valid SVG or PNG") {
  const ModelWorkspace workspace;
  const std::string svg = workspace.folder / "d.svg", png = workspace.folder / "d.png";
  CHECK(workspace.verb("diagnose", {"--plot", svg, "--blanks", "50"}).code == 0);
  CHECK(is_svg(svg));
  CHECK(workspace.verb("diagnose", {"--plot", png, "--blanks", "50"}).code == 0);
  CHECK(is_png(png));
  for (const char* verb : {"fit", "compare"}) {
    const std::string file = workspace.folder / (std::string(verb) + ".svg");
    CHECK(workspace.verb(verb, {"--plot", file}).code == 0);
    CHECK(is_svg(file));
  }
  CHECK(workspace.verb("fit", {"--plot", workspace.folder / "x.pdf"}).code == 2);
}

// --- fit, predict

TEST_CASE("fit finds the parameters with sigmas, and keeps them in the model it writes") {
  const ModelWorkspace workspace;
  const std::string data = workspace.folder.with("line.csv", measured_x(straight_x));
  const std::string fitted = workspace.folder / "fitted.toml";
  const Ran r = ran({"model", "fit", workspace.model, data, "--machine", workspace.machine, "-o", fitted, "--json"});
  REQUIRE(r.code == 0);
  const nlohmann::json j = r.json();
  REQUIRE(j["effects"].size() == 2);
  const nlohmann::json& scale = j["effects"][1]["parameters"][0];
  CHECK(scale["name"] == "um_per_m");
  CHECK(scale["value"].get<double>() == Approx(5.0).epsilon(0.03));
  CHECK(std::abs(scale["value"].get<double>() - 5.0) < 4.0 * scale["sigma"].get<double>());
  CHECK(scale["held"] == false);
  CHECK(j["condition"].is_number());
  CHECK(content_of(fitted).find("fitted = { um_per_m = ") != std::string::npos);

  const std::string points = workspace.folder.with("points.csv", "axis,sense,x_mm,approach\nX,EX,0,1\nX,EX,1000,-1\n");
  const std::string out = workspace.folder / "predicted.csv";
  const Ran p = ran({"model", "predict", fitted, points, "--machine", workspace.machine, "-o", out, "--json"});
  REQUIRE(p.code == 0);
  const nlohmann::json rows = p.json()["predictions"];
  REQUIRE(rows.size() == 2);
  CHECK(rows[0]["predicted"].get<double>() == Approx(1.0).epsilon(0.1));
  CHECK(rows[1]["predicted"].get<double>() == Approx(6.0).epsilon(0.03));
  CHECK(rows[1]["approach"] == -1);
  CHECK(rows[0]["measured"].is_null());
  CHECK(ran({"laser", "import", out, "--json"}).json()["readings"] == 2);
}

TEST_CASE("a model without values predicts nothing") {
  const ModelWorkspace workspace;
  const Ran r = workspace.verb("predict", {"--json"});
  CHECK(r.code == 3);
  CHECK(r.json()["error"]["file"] == workspace.model);
  CHECK(r.json()["error"]["message"].get<std::string>().find("fit the model") != std::string::npos);
}

TEST_CASE("fixed parameters are reported as fixed, terms with the same effect as undetermined") {
  const ModelWorkspace workspace;
  const std::string held =
      workspace.folder.with("held.toml", "[[effect]]\nid = \"scale\"\naxis = \"X\"\nparameters = { um_per_m = 5.0 }\n");
  const nlohmann::json j = ran({"model", "fit", held, workspace.data, "--json"}).json();
  CHECK(j["effects"][0]["parameters"][0]["held"] == true);
  CHECK(j["effects"][0]["parameters"][0]["sigma"].is_null());
  const std::string twice = workspace.folder.with(
      "twice.toml", std::string(kStraightModel) + "\n[[effect]]\nid = \"cosine\"\naxis = \"X\"\nsense = \"EX\"\n");
  const nlohmann::json t = ran({"model", "fit", twice, workspace.data, "--json"}).json();
  CHECK_FALSE(t["undetermined"].empty());
}

TEST_CASE("fit prints the strongest correlations and counts the rest; JSON has all") {
  const ModelWorkspace workspace;
  std::string model;
  for (int power = 1; power <= 5; ++power)
    model += "[[effect]]\nid = \"user\"\nname = \"p" + std::to_string(power) + "\"\nformula = { EX = \"k*(x_mm/1000)^" +
             std::to_string(power) + "\" }\n";
  const std::string powers = workspace.folder.with("powers.toml", model);
  const auto sum = [](double x_mm, int, int) {
    const double x = x_mm / 1000.0;
    return 20.0 * x * (1.0 + x * (1.0 + x * (1.0 + x * (1.0 + x))));
  };
  const std::string data = workspace.folder.with("powers.csv", measured_x(sum, {.noise_um = 0.001}));
  const Ran text = ran({"model", "fit", powers, data});
  const auto pairs = ran({"model", "fit", powers, data, "--json"}).json()["correlations"].size();
  REQUIRE(pairs > 5);
  std::size_t lines = 0;
  for (std::size_t at = text.out.find("correlated "); at != std::string::npos;
       at = text.out.find("correlated ", at + 1))
    ++lines;
  CHECK(lines == 5);
  CHECK(text.out.find("correlated: " + std::to_string(pairs - 5) + " more pairs above 0.9") != std::string::npos);
}

TEST_CASE("fit keeps to plain least squares when asked, and lists no outliers then") {
  const ModelWorkspace workspace;
  CHECK(workspace.verb("fit", {"--plain", "--json"}).json()["outliers"].empty());
}

TEST_CASE("a model is not written over another file, but over itself") {
  const ModelWorkspace workspace;
  const std::string other = workspace.folder.with("other.toml", "# something else\n");
  CHECK(workspace.verb("fit", {"-o", other}).code == 2);
  CHECK(content_of(other) == "# something else\n");
  CHECK(workspace.verb("fit", {"-o", workspace.data}).code == 2);
  CHECK(workspace.verb("fit", {"-o", workspace.model}).code == 0);
  CHECK(content_of(workspace.model).find("fitted") != std::string::npos);
}

// --- compare

TEST_CASE("compare gives bias, rms, peak, lack of fit and count for every sense, axis and direction") {
  const ModelWorkspace workspace;
  const nlohmann::json j = workspace.verb("compare", {"--json"}).json();
  REQUIRE(j["directions"].size() == 2);
  for (const nlohmann::json& one : j["directions"]) {
    CHECK(keys_of(one) == std::set<std::string>{"sense", "axis", "approach", "bias_um", "rms_um", "peak_um",
                                                "lack_of_fit", "readings"});
    CHECK(one["sense"] == "EX");
    CHECK(one["axis"] == "X");
    CHECK(one["readings"] == 123);
    CHECK(one["rms_um"].get<double>() == Approx(std::sqrt(2.0 + 0.09)).epsilon(0.1));
    CHECK(one["lack_of_fit"]["F"].get<double>() > 10.0);
  }
  CHECK(j["directions"][0]["approach"] == 1);
  CHECK(j["worst"].size() == 10);
  CHECK(std::abs(j["worst"][0]["residual_um"].get<double>()) >= std::abs(j["worst"][9]["residual_um"].get<double>()));
  std::set<std::string> variables;
  for (const nlohmann::json& view : j["variables"]) variables.insert(view["variable"].get<std::string>());
  for (const char* name : {"x_mm", "approach", "run", "time_s"}) CHECK(variables.contains(name));
  CHECK(widest_line(workspace.verb("compare").out) <= 80);
}

TEST_CASE("compare keeps the values of the model unless it is to refit, and says what it fits") {
  const ModelWorkspace workspace;
  const std::string data = workspace.folder.with("line.csv", measured_x(straight_x));
  const auto shifted = [](double x_mm, int d, int run) { return straight_x(x_mm, d, run) + 197.0; };
  const std::string other = workspace.folder.with("shifted.csv", measured_x(shifted));
  const std::string fitted = workspace.folder / "fitted.toml";
  REQUIRE(ran({"model", "fit", workspace.model, data, "--machine", workspace.machine, "-o", fitted}).code == 0);
  const auto compared = [&](const std::string& model, std::vector<std::string> more) {
    std::vector<std::string> words{"model", "compare", model, other, "--machine", workspace.machine, "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return ran(words).json();
  };
  const nlohmann::json kept = compared(fitted, {});
  for (const nlohmann::json& one : kept["directions"])
    CHECK(one["bias_um"].get<double>() == Approx(197.0).epsilon(0.01));
  CHECK(kept["rms_um"].get<double>() == Approx(197.0).epsilon(0.01));
  CHECK(kept["notes"].dump().find("no values") == std::string::npos);
  for (const nlohmann::json& refitted : {compared(fitted, {"--refit"}), compared(workspace.model, {})})
    for (const nlohmann::json& one : refitted["directions"]) CHECK(std::abs(one["bias_um"].get<double>()) < 0.5);
  CHECK(compared(workspace.model, {})["notes"].dump().find(
            "fitted to these data, since the model has no values for it: offset:X:EX, scale:X:EX") !=
        std::string::npos);
}

TEST_CASE("compare breaks the model down by effect at one place") {
  const ModelWorkspace workspace;
  const std::string data = workspace.folder.with("line.csv", measured_x(straight_x, {.noise_um = 0.01}));
  const Ran r = ran({"model", "compare", workspace.model, data, "--machine", workspace.machine, "--at",
                     "x=1000,y=0,z=0,axis=X", "--json"});
  REQUIRE(r.code == 0);
  const nlohmann::json at = r.json()["at"];
  CHECK(at["x_mm"] == 1000.0);
  const nlohmann::json& ex = at["senses"][0];
  CHECK(ex["total_um"].get<double>() == Approx(6.0).epsilon(0.01));
  CHECK(ex["effects"][0]["effect"] == "offset:X:EX");
  CHECK(ex["effects"][1]["um"].get<double>() == Approx(5.0).epsilon(0.01));
  for (const char* wrong : {"x", "x=1,axis=Q", "u=3", "x=one", "approach=2"})
    CHECK(workspace.verb("compare", {"--at", wrong}).code == 2);
}

TEST_CASE("compare predicts the volume, and needs a machine for it") {
  const ModelWorkspace workspace;
  const std::string csv = workspace.folder / "volume.csv";
  const Ran r = workspace.verb("compare", {"--volume", "3", "-o", csv, "--json"});
  REQUIRE(r.code == 0);
  CHECK(r.json()["volume"]["forward"]["points"] == 27);
  const std::string text = content_of(csv);
  CHECK(text.starts_with("x_mm,y_mm,z_mm,approach,EX_um,EY_um,EZ_um\n"));
  CHECK(std::count(text.begin(), text.end(), '\n') == 55);
  CHECK(ran({"model", "compare", workspace.model, workspace.data, "--volume", "3"}).code == 2);
  CHECK(workspace.verb("compare", {"-o", csv}).code == 2);
}

// --- add, undo, history, what-if

TEST_CASE("add refits with the effect, prints the ladder and keeps it; undo takes it back") {
  const ModelWorkspace workspace;
  const std::string out = workspace.folder / "added.toml";
  const Ran r = ran({"model", "add", workspace.model, "cyclic:X:EX", "--data", workspace.data, "--machine",
                     workspace.machine, "-o", out, "--json"});
  REQUIRE(r.code == 0);
  const nlohmann::json j = r.json();
  check_has(j, {"rms_before_um", "rms_after_um", "noise_um", "history"});
  CHECK(j["rms_before_um"].get<double>() == Approx(std::sqrt(2.0 + 0.09)).epsilon(0.1));
  CHECK(j["rms_after_um"].get<double>() == Approx(0.3).epsilon(0.15));
  CHECK(j["noise_um"].get<double>() == Approx(0.3).epsilon(0.2));
  CHECK(content_of(workspace.model) == kStraightModel);

  const nlohmann::json history = ran({"model", "history", out, "--json"}).json()["history"];
  REQUIRE(history.size() == 1);
  CHECK(history[0]["effect"] == "cyclic:X:EX");
  CHECK(history[0]["held_out_rms_um"].get<double>() < 0.5);
  const std::string plot = workspace.folder / "ladder.svg";
  CHECK(ran({"model", "history", out, "--plot", plot}).code == 0);
  CHECK(is_svg(plot));
  CHECK(content_of(plot).find("+ cyclic:X:EX") != std::string::npos);

  CHECK(ran({"model", "undo", out}).code == 0);
  CHECK(content_of(out).find("cyclic") == std::string::npos);
  CHECK(ran({"model", "undo", out}).code == 1);
}

TEST_CASE("add takes approach, sense and code from its options; an unknown effect gets a suggestion") {
  const ModelWorkspace workspace;
  const Ran r = ran(
      {"model", "add", workspace.model, "cyclic:X:EX", "--data", workspace.data, "--approach", "reverse", "--json"});
  CHECK(r.json()["effect"]["approach"] == "reverse");
  CHECK(r.json()["model"].is_null());
  const Ran wrong = ran({"model", "add", workspace.model, "cyclc:X:EX", "--data", workspace.data});
  CHECK(wrong.code == 2);
  CHECK(wrong.messages.find("cyclic") != std::string::npos);
  CHECK(ran({"model", "add", workspace.model, "cyclic:Q:EX", "--data", workspace.data}).code == 2);
  CHECK(ran({"model", "add", workspace.model, "angular", "--code", "EQX", "--data", workspace.data}).code == 2);
}

TEST_CASE("add writes over no other file, and again what it wrote before") {
  const ModelWorkspace workspace;
  const std::string other = workspace.folder.with("other.toml", "# mine\n");
  CHECK(ran({"model", "add", workspace.model, "cyclic", "--data", workspace.data, "-o", other}).code == 2);
  CHECK(content_of(other) == "# mine\n");
  const std::string out = workspace.folder / "out.toml";
  CHECK(ran({"model", "add", workspace.model, "cyclic", "--data", workspace.data, "-o", out}).code == 0);
  CHECK(ran({"model", "add", workspace.model, "cyclic", "--data", workspace.data, "-o", out}).code == 0);
  CHECK(ran({"model", "add", workspace.model, "cyclic", "--data", workspace.data, "-o", workspace.model}).code == 0);
}

TEST_CASE("what-if predicts the rms after compensation and gives what was achieved") {
  const ModelWorkspace workspace;
  const std::string full = workspace.folder / "full.toml";
  REQUIRE(ran({"model", "add", workspace.model, "cyclic:X:EX", "--data", workspace.data, "-o", full}).code == 0);
  const std::string after = workspace.folder.with(
      "after.csv", measured_x([](double, int, int) { return 0.0; }, {.noise_um = 0.3, .seed = 5, .compensated = true}));
  const Ran r =
      ran({"model", "what-if", full, workspace.data, "--after", after, "--machine", workspace.machine, "--json"});
  REQUIRE(r.code == 0);
  const nlohmann::json j = r.json();
  CHECK(j["rms_after_um"].get<double>() == Approx(0.3).epsilon(0.15));
  CHECK(j["rms_now_um"].get<double>() > 3.0);
  CHECK(j["achieved"]["rms_um"].get<double>() == Approx(0.3).epsilon(0.15));
  CHECK(j["achieved"]["of_predicted"].get<double>() == Approx(1.0).epsilon(0.2));
  REQUIRE(j["directions"].size() == 2);
  CHECK(j["directions"][0]["achieved_rms_um"].get<double>() == Approx(0.3).epsilon(0.2));
  CHECK(ran({"model", "what-if", full, workspace.data, "--json"}).json()["achieved"].is_null());
}

// --- next

TEST_CASE("next proposes a run, and says of a plan whether it can determine the model") {
  const ModelWorkspace workspace;
  const Ran r = workspace.verb("next", {"--json"});
  REQUIRE(r.code == 0);
  check_has(r.json(), {"rivals", "proposals", "notes"});
  const std::string good =
      workspace.folder.with("plan.csv", "axis,sense,x_mm,approach\nX,EX,0,1\nX,EX,500,1\nX,EX,1000,1\n");
  const Ran yes = ran({"model", "next", workspace.model, "--check", good, "--machine", workspace.machine, "--json"});
  CHECK(yes.code == 0);
  CHECK(yes.json()["determines"] == true);
  const std::string poor = workspace.folder.with("poor.csv", "axis,sense,x_mm,approach\nX,EX,500,1\nX,EX,500,1\n");
  const Ran no = ran({"model", "next", workspace.model, "--check", poor, "--machine", workspace.machine, "--json"});
  CHECK(no.code == 1);
  CHECK(no.json()["determines"] == false);
  CHECK_FALSE(no.json()["undetermined"].empty());
  CHECK(ran({"model", "next", workspace.model}).code == 2);
}

// --- effects

TEST_CASE("a proposal is written as a part program and as a target list, which is a plan") {
  const ModelWorkspace workspace;
  const std::string program = workspace.folder / "next.txt", targets = workspace.folder / "targets.csv";
  const Ran r = workspace.verb("next", {"--program", program, "--targets", targets, "--json"});
  REQUIRE(r.code == 0);
  CHECK(r.json()["program"] == program);
  CHECK(content_of(program).find("M08") != std::string::npos);
  CHECK(ran({"model", "next", workspace.model, "--check", targets, "--machine", workspace.machine}).code == 0);
  CHECK(workspace.verb("next", {"--targets", targets, "--proposal", "99"}).code == 1);
  CHECK(ran({"model", "next", workspace.model, workspace.data, "--program", program}).code == 2);
}

TEST_CASE("the library explains every effect and suggests one for a typing error") {
  const nlohmann::json all = ran({"model", "effects", "--json"}).json()["effects"];
  CHECK(all.front()["effect"] == "offset");
  CHECK(all.back()["effect"] == "user");
  const nlohmann::json one = ran({"model", "effects", "cyclic", "--json"}).json();
  check_has(one, {"effect", "title", "cause", "tells_apart", "formula", "parameters", "compensated", "how"});
  CHECK(one["parameters"][0]["name"] == "period_mm");
  CHECK(one["parameters"][0]["unit"] == "mm");
  const Ran wrong = ran({"model", "effects", "backlsh"});
  CHECK(wrong.code == 2);
  CHECK(wrong.messages.find("backlash") != std::string::npos);
  CHECK(widest_line(ran({"model", "effects"}).out) <= 80);
  for (const nlohmann::json& effect : all)
    CHECK(widest_line(ran({"model", "effects", effect["effect"].get<std::string>()}).out) <= 80);
}

// --- what is wrong

TEST_CASE("bad measurements get a clear answer, never a confident name") {
  const ModelWorkspace workspace;
  const auto verdict = [&](const std::string& name, const std::string& text) {
    const Ran r =
        ran({"model", "diagnose", workspace.model, workspace.folder.with(name, text), "--json", "--blanks", "50"});
    return r.code == 0 ? r.json()["verdict"].get<std::string>() : fmt::format("exit {}", r.code);
  };
  const std::string head = "axis,sense,x_mm,reading,approach,run\n";
  CHECK(verdict("three.csv", head + "X,EX,0,1,1,1\nX,EX,100,5,1,1\nX,EX,200,-3,1,1\n") == "adequate");
  CHECK(verdict("one.csv", head + "X,EX,0,1,1,1\n") == "adequate");
  std::string constant = head;
  for (int i = 0; i < 30; ++i) constant += "X,EX,100,1.0,1,1\n";
  CHECK(verdict("constant.csv", constant) == "adequate");
  CHECK(verdict("empty.csv", head) == "exit 3");
  CHECK(verdict("axis.csv", head + "W,EX,0,1,1,1\n") == "exit 3");
  CHECK(verdict("none.csv", "") == "exit 3");
  CHECK(verdict("one_run.csv", measured_x(straight_x, {.runs = 1})) == "adequate");
}

TEST_CASE("a wrong model is refused with file and line, an unknown column in a formula with the columns there are") {
  const ModelWorkspace workspace;
  const std::string axis = workspace.folder.with("axis.toml", "[[effect]]\nid = \"scale\"\naxis = \"W\"\n");
  const nlohmann::json error = ran({"model", "fit", axis, workspace.data, "--json"}).json()["error"];
  CHECK(error["file"] == axis);
  CHECK(error["line"] == 3);
  const std::string formula = workspace.folder.with(
      "formula.toml", "[[effect]]\nid = \"user\"\nname = \"mine\"\nformula = { EX = \"k * t_oil_degC\" }\n");
  const Ran r = ran({"model", "diagnose", formula, workspace.data, "--json"});
  CHECK(r.code == 3);
  CHECK(r.json()["error"]["file"] == formula);
  CHECK(r.json()["error"]["message"].get<std::string>().find("time_s") != std::string::npos);
  CHECK(ran({"model", "fit", workspace.folder / "none.toml", workspace.data}).code == 3);
  CHECK(workspace.verb("fit", {"--machine", workspace.folder / "none.toml"}).code != 0);
}

TEST_CASE("files of one machine are joined, their rows and runs numbered on") {
  const ModelWorkspace workspace;
  const std::string second = workspace.folder.with("second.csv", measured_x(cyclic_x, {.seed = 9}));
  const Ran r = ran({"model", "compare", workspace.model, workspace.data, second, "--json", "--worst", "400"});
  REQUIRE(r.code == 0);
  CHECK(r.json()["observations"] == 492);
  int last = 0;
  const nlohmann::json worst = r.json()["worst"];
  for (const nlohmann::json& one : worst) last = std::max(last, one["row"].get<int>());
  CHECK(last > 246);
}

TEST_CASE("instruments' own files are data as well") {
  const ModelWorkspace workspace;
  const Ran r = ran({"model", "compare", workspace.model, "samples/laser/vmc_x.rtl", "--json"});
  CHECK(r.code == 0);
  CHECK(r.json()["observations"] == 6);
  CHECK(ran({"model", "compare", workspace.model, "samples/laser/straight.rts"}).code == 2);
  CHECK(ran({"model", "compare", workspace.model, "samples/laser/straight.rts", "--sense", "EY"}).code == 0);
}

TEST_CASE("every verb of the menu takes a machine") {
  for (const char* verb : {"effects", "predict", "fit", "compare", "diagnose", "check", "next", "add", "undo",
                           "history", "what-if", "reveal"}) {
    CAPTURE(verb);
    CHECK(ran({"model", verb, "--help"}).out.find("--machine") != std::string::npos);
  }
}

}  // namespace
}  // namespace ecs::app
