#include "model/fit/model_file.hpp"

#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;

namespace {

constexpr const char* kText = R"toml([[effect]]
id = "cyclic"
axis = "X"
sense = "EX"
approach = "reverse"
parameters = { period_mm = 8.0, amplitude_um = 3.2, phase_rad = 0.4 }

[[effect]]
id = "angular"
code = "ECX"

[[effect]]
id = "user"
name = "encoder tilt"
formula = { EX = "a * sin(p_mm / b)", EY = "a * load_kg" }
parameters = { a = { unit = "um" }, b = 40.0 }

[[known]]
code = "ECX"
p_mm = [0.0, 50.0]
value = [0.0, 3.1]
)toml";

}  // namespace

TEST_CASE("a model file is read as it is written") {
  const auto model = must(parse_model(kText, "m.toml", ""));
  REQUIRE(model.effects.size() == 3);
  CHECK(to_text(model.effects[0]) == "cyclic:X:EX");
  CHECK(model.effects[0].approach == ApproachMode::reverse);
  CHECK(model.effects[0].parameters.at("period_mm") == 8.0);
  CHECK(to_text(model.effects[1]) == "angular:X:ECX");
  CHECK(model.effects[2].user[1].value == 40.0);
  CHECK_FALSE(model.effects[2].user[0].value.has_value());
  CHECK(model.known[0].value[1] == 3.1);
}

TEST_CASE("writing a model and reading it again gives the same effects") {
  auto model = must(parse_model(kText, "m.toml", ""));
  model.effects[1].curve = {{0.0, 1.0}, {0.25, -3.0}};
  model.effects[0].fitted = {{"amplitude2_um", 0.125}};
  model.history.push_back({"cyclic:X:EX", "data.csv", 4.5, 0.5, 1.25, 0.5, 0.75});
  const auto again = must(parse_model(to_toml(model), "again.toml", ""));
  CHECK(again.effects == model.effects);
  CHECK(again.known == model.known);
  CHECK(again.history == model.history);
}

TEST_CASE("the name that a user gave to a model is kept") {
  const auto model =
      must(parse_model("name = \"mill, spindle warm\"\n[[effect]]\nid = \"scale\"\naxis = \"X\"\n", "m.toml", ""));
  CHECK(to_toml(model).starts_with("name = \"mill, spindle warm\"\n"));
  CHECK(parse_model(to_toml(model), "m.toml", "")->name == "mill, spindle warm");
}

TEST_CASE("every fault of a model file is reported at once, with its line") {
  const auto model = must_fail(parse_model(R"toml([[effect]]
id = "cylic"
axis = "X"
[[effect]]
id = "backlash"
axis = "W"
sense = "EX"
[[effect]]
id = "scale"
axis = "X"
parameters = { um_per_mm = 1.0 }
colour = "red"
)toml",
                                           "bad.toml", ""));
  const std::string text = to_text(model);
  check_holds(text, {"did you mean \"cyclic\"", "bad.toml:6", "um_per_m", "colour"});
}

TEST_CASE("names in a formula that are no columns are parameters to be fitted") {
  const auto model = must(parse_model(
      "[[effect]]\nid = \"user\"\nname = \"u\"\nsense = \"EX\"\nformula = \"k*x_mm + c*t_air_degC + sin(2e3*x_mm)\"\n",
      "u.toml", ""));
  REQUIRE(model.effects[0].user.size() == 2);
  CHECK(model.effects[0].user[0].name == "k");
  CHECK(model.effects[0].user[1].name == "c");
}

TEST_CASE("names with any characters are written so that they are read again") {
  auto model = must(parse_model(kText, "m.toml", ""));
  model.effects[2].name = "tilt \x01\t\r\n\"\\";
  model.history.push_back({"scale:X", "a\x1f.csv", 4.5, 0.5, 1.25, 0.5, 0.75});
  const auto again = must(parse_model(to_toml(model), "again.toml", ""));
  CHECK(again.effects == model.effects);
  CHECK(again.history == model.history);
}

TEST_CASE("a number of compensated readings that is none is refused") {
  CHECK(parse_model("compensated_readings = 12\n", "m.toml", "").value().compensated_readings == 12);
  for (const char* count : {"-1", "1e300", "0.5"}) {
    CAPTURE(count);
    const auto model =
        must_fail(parse_model("name = \"m\"\ncompensated_readings = " + std::string(count) + "\n", "m.toml", ""));
    CHECK(to_text(model).find("m.toml:2:24: compensated_readings: expected a whole number") == 0);
  }
}

TEST_CASE("a parameter of a user effect has a name that a formula can hold, and only one") {
  const std::string effect = "[[effect]]\nid = \"user\"\nname = \"u\"\nformula = { EX = \"a\" }\n";
  for (const char* parameters :
       {R"({ "a b" = 1.0 })", R"({ "" = 1.0 })", R"({ 2a = 1.0 })", R"(["a", "ä"])", R"(["a", "a"])"}) {
    CAPTURE(parameters);
    CHECK(must_fail(parse_model(effect + "parameters = " + parameters + "\n", "u.toml", "")).line == 5);
  }
  CHECK(parse_model(effect + "parameters = [\"a\", \"b_2\"]\n", "u.toml", "").value().effects[0].user.size() == 2);
}
