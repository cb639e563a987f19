#include "model/fit/model_file.hpp"

#include <fmt/format.h>

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

TEST_CASE("whatever a file gives an effect of the library, it is written so that it is read again as the same") {
  int read_count = 0;
  const auto check_again = [&](const std::string& text) {
    const auto model = parse_model(text, "m.toml", "");
    if (!model) return;
    ++read_count;
    CAPTURE(text);
    CHECK(must(parse_model(to_toml(*model), "again.toml", "")).effects == model->effects);
  };
  const auto key = [](const char* name, const char* value) {
    return *value == 0 ? std::string() : fmt::format("{} = \"{}\"\n", name, value);
  };
  for (const EffectDefinition& effect : effect_library())
    for (const char* axis : {"", "X", "C"})
      for (const char* sense : {"", "EX", "EC"})
        for (const char* code : {"", "C0Y", "ECX", "XOC", "EC"}) {
          const std::string head = fmt::format("[[effect]]\nid = \"{}\"\n", effect.id) + key("axis", axis) +
                                   key("sense", sense) + key("code", code) +
                                   "sensor = \"t_a_degC\"\nsensor2 = \"t_b_degC\"\n";
          check_again(head);
          check_again(head + "name = \"u\"\nformula = { EY = \"a * p_mm\" }\n");
          for (const char* table : {"parameters", "fitted"})
            for (const ParameterDefinition& one : effect.parameters)
              check_again(head + fmt::format("{} = {{ {} = {} }}\n", table, one.name, one.neutral));
        }
  CHECK(read_count > 1000);
}

TEST_CASE("the temperatures of an origin keep the names of their sensors, whatever characters these have") {
  auto model = must(parse_model(kText, "m.toml", ""));
  model.origin.emplace().sensors_degC = {{"t_bed.front_degC", 20.5}, {"t_oil in_degC", 31.0}};
  const auto again = must(parse_model(to_toml(model), "again.toml", ""));
  CHECK(again.origin->sensors_degC == model.origin->sensors_degC);
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
