#include "ecs_emulator/errors/true_errors.hpp"

#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

double component_of(const TrueErrors& errors, Component c, const MachineState& state) {
  return errors.at(state)[index_of(c)];
}

}  // namespace

TEST_CASE("a formula sees the moving axis, the approach and the whole position") {
  const TrueErrors errors = errors_of(R"(
[[contribution]]
component = "EYX"
formula = "0.01*p + 2*d + 0.001*y"
[[contribution]]
component = "EYX"
formula = "5"
)");
  MachineState state;
  state.position_mm = {-1000.0, 300.0, 0.0};
  CHECK(component_of(errors, Component::EYX, state) == Approx(-10.0 + 2.0 + 0.3 + 5.0));
  state.approach[0] = Approach::reverse;
  CHECK(component_of(errors, Component::EYX, state) == Approx(-10.0 - 2.0 + 0.3 + 5.0));
  CHECK(component_of(errors, Component::EYY, state) == 0.0);
}

TEST_CASE("points are linear between, held beyond the ends, and have a value for each approach") {
  const TrueErrors errors = errors_of(R"(
[[contribution]]
component = "EZZ"
points = [[-100, 0, 2], [0, 10, 4]]
)");
  MachineState state;
  state.position_mm[2] = -25.0;
  CHECK(component_of(errors, Component::EZZ, state) == Approx(7.5));
  state.approach[2] = Approach::reverse;
  CHECK(component_of(errors, Component::EZZ, state) == Approx(3.5));
  state.position_mm[2] = 50.0;
  CHECK(component_of(errors, Component::EZZ, state) == Approx(4.0));
}

TEST_CASE("squareness is constant and temperatures feed formulas") {
  const TrueErrors errors = errors_of(R"(
[squareness]
C0Y = 16.0
[temperature]
spindle = "20 + t/100"
[[contribution]]
component = "EZZ"
formula = "2*T_spindle - 40"
)");
  MachineState state;
  state.time_s = 500.0;
  CHECK(component_of(errors, Component::C0Y, state) == 16.0);
  CHECK(component_of(errors, Component::EZZ, state) == Approx(10.0));
  CHECK(only(errors.temperatures(100.0)).second == Approx(21.0));
}

TEST_CASE("every problem of an errors file is reported with its line") {
  const auto errors = must_fail(TrueErrors::parse(R"([squareness]
C0X = 1.0
[[contribution]]
component = "EYQ"
formula = "1"
[[contribution]]
component = "EYX"
formula = "sin(p"
[[contribution]]
component = "EYX"
points = [[0, 1], [0, 2]]
)",
                                                  "errors.toml", "."));
  CHECK(errors.also.size() == 3);
  const std::string text = to_text(errors);
  check_holds(text, {"errors.toml:3", "errors.toml:8:11", "errors.toml:11", "errors.toml:2:7"});
}

TEST_CASE("the scatter of a pass is smooth, the same within the pass, new in the next, of the stated size") {
  const TrueErrors errors = errors_of("[scatter]\nEXX = { pass = 2.0, reading = 0.5 }\n");
  const PerAxis<std::array<double, 2>> travel{{{0.0, 1000.0}, {0.0, 1000.0}, {0.0, 1000.0}}};
  MachineState state;
  double sum = 0.0;
  int count = 0;
  for (state.pass[0] = 0; state.pass[0] < 400; ++state.pass[0])
    for (double p = 0.0; p <= 1000.0; p += 50.0) {
      state.position_mm[0] = p;
      const double here = errors.pass_scatter(state, travel, 7)[0];
      CHECK(here == errors.pass_scatter(state, travel, 7)[0]);
      state.position_mm[0] = p + 1.0;
      CHECK(std::abs(errors.pass_scatter(state, travel, 7)[0] - here) < 0.2);
      sum += here * here;
      ++count;
    }
  CHECK(std::sqrt(sum / count) == Approx(2.0).epsilon(0.1));
  CHECK(errors.reading_scatter()[0] == 0.5);
}

TEST_CASE("what no machine can do is refused with its line before anything moves") {
  const auto refusal = [](const std::string& text) {
    auto parsed = TrueErrors::parse(text, "errors.toml", ".");
    if (!parsed) return to_text(parsed.error());
    const auto checked = parsed->checked_for(
        machine_of("configuration = \"TXY\"\n[axis.X]\ntravel_mm = [-500.0, 0.0]\n[axis.Y]\ntravel_mm = [-9.0, 0.0]\n")
            .machine);
    return checked ? std::string() : to_text(checked.error());
  };
  const std::string head = "\n[[contribution]]\ncomponent = \"EXX\"\n";
  CHECK(contains(refusal(head + "formula = \"1/0*p\"\n"), "errors.toml:2"));
  CHECK(contains(refusal(head + "formula = \"sqrt(p-1)\"\n"), "EXX"));
  CHECK(refusal(head + "formula = \"1e300*1e300\"\n") != "");
  CHECK(contains(refusal(head + "points = [[0, nan]]\n"), "points"));
  CHECK(contains(refusal("[air]\nmean_degC = -300\n"), "-40"));
  CHECK(contains(refusal("[air]\nmean_degC = 1e300\n"), "60"));
  CHECK(contains(refusal("[[contribution]]\ncomponent = \"EYZ\"\nformula = \"p\"\n"), "has no Z"));
  CHECK(contains(refusal(head + "formula = \"d = 5\"\n"), "assignment"));
  CHECK(contains(refusal(head + "formula = \"p += 1\"\n"), "assignment"));
  CHECK(contains(refusal(head + "formula = \"p + sin(d=5)\"\n"), "assignment"));
  CHECK(contains(refusal(head + "formula = \"0/0\"\n"), "EXX"));
  CHECK(contains(refusal("[temperature]\noil = \"20 + log(t)\"\n"), "temperature.oil: expected finite"));
  CHECK(contains(refusal("[temperature]\noil = \"t = 5\"\n"), "assignment"));
  CHECK(refusal(head + "formula = \"p >= 1 && p != 2 || d == 1 ? 1 : 0\"\n") == "");
  CHECK(refusal(head + "formula = \"0.01*p + d\"\n") == "");
}
