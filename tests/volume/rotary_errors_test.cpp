// The errors of rotary axes and their file. How certain the volume of a machine with rotary axes is: propagation and
// draws against each other, and by hand.
#include "volume/rotary_errors.hpp"

#include "tests/support/test.hpp"
#include "tests/support/volume_machine.hpp"
#include "volume/joint_volume.hpp"
#include "volume/rotary_uncertainty.hpp"

namespace ecs::volume {
namespace {

using kinematics::Joint;

kinematics::JointChain chain() { return *kinematics::joint_chain_of("XYACTZ"); }

std::string refused(std::string_view text) {
  return to_text(must_fail(parse_rotary_errors(text, "rotary.csv", chain())));
}

TEST_CASE("error motions go by angle and approach, location errors are constants added to them") {
  const auto errors =
      must(parse_rotary_errors("component,approach,p_deg,error\n"
                               "EAA,1,-90,4\nEAA,1,90,8\nEAA,-1,-90,0\nEAA,-1,90,-4\n"
                               "XOC,,,12\nEXC,0,0,1\nEXC,0,90,2\nEXC,0,180,3\nEXC,0,270,2\n",
                               "rotary.csv", chain()));
  const auto forward = rotary_values(errors, {0.0, 0.0, 45.0}, Approach::forward);
  CHECK(forward.curve[index_of(Joint::A)][3] == Approx(6.0));
  CHECK(forward.curve[index_of(Joint::C)][0] == Approx(13.5));
  CHECK(rotary_values(errors, {0.0, 0.0, 45.0}, Approach::reverse).curve[index_of(Joint::A)][3] == Approx(-2.0));
}

TEST_CASE("a table round a whole turn closes, one of part of a turn keeps its end values") {
  const RotaryTable turn{Joint::C, Sense::EX, Approach::unknown, {0.0, 90.0, 180.0, 270.0}, {1.0, 2.0, 3.0, 2.0}, {}};
  CHECK(value_at(turn, 315.0) == Approx(1.5));
  CHECK(value_at(turn, -45.0) == Approx(1.5));
  CHECK(value_at(turn, 720.0) == Approx(1.0));
  const RotaryTable part{Joint::A, Sense::EX, Approach::unknown, {-30.0, 0.0, 30.0}, {1.0, 2.0, 5.0}, {}};
  CHECK(value_at(part, 80.0) == Approx(5.0));
  CHECK(value_at(part, -330.0) == Approx(1.0));
}

TEST_CASE("every wrong row of a file of rotary errors is reported with line, column and what was expected") {
  const std::string all = refused(
      "component,approach,p_deg,error\n"
      "EXD,1,0,1\nEXB,1,0,1\nEXC,2,0,1\nEXC,1,4000,1\nEXC,1,0,abc\nXOC,,10,1\nEXC,1,5,1\nEXC,1,5,2\n");
  check_holds(all, {"rotary.csv:2:1: component: expected an error of a rotary axis, such as EXC, EAB or XOC",
                    "rotary.csv:3:1: component: expected an axis of the machine (w C' A' Y' X' b Z t), which has no B",
                    "rotary.csv:4:5: approach: expected 1, -1 or 0",
                    "rotary.csv:5:7: p_deg: expected an angle within 3600 deg of 0, found \"4000\"",
                    "rotary.csv:6:9: error: expected a number", "rotary.csv:7:6: p_deg: expected nothing",
                    "rotary.csv:9:7: p_deg: expected each angle once"});
  CHECK(contains(refused("component,approach,error\nEXC,1,1\n"), "p_deg"));
}

TEST_CASE("location errors known by their sum are written and read with what each adds to the other") {
  const std::string text =
      "component,approach,p_deg,error,u,with\nYOA,,,0.0000,12.0000,YOC:-1 XOC:0.25\nXOC,,,1.0000,3.2000,\n"
      "YOC,,,7.0000,12.1000,\nEXC,0,0,1.0000,0.5000,\n";
  const RotaryErrors errors = must(parse_rotary_errors(text, "rotary.csv", chain()));
  REQUIRE(errors.ties.size() == 2);
  CHECK(errors.ties[0].of == std::array<std::size_t, 2>{0, 1});
  CHECK(errors.ties[0].other == std::array<std::size_t, 2>{2, 1});
  CHECK(errors.ties[0].by == -1.0);
  CHECK(rotary_csv(errors, "") == text);
  const std::string all = refused(
      "component,approach,p_deg,error,u,with\nYOA,,,0,1,YOC\nYOC,,,0,1,YOC:1\nXOC,,,0,1,XOB:1\nEXC,0,0,1,1,YOC:1\n");
  check_holds(all,
              {"rotary.csv:2:11: with: expected another location error of the machine and a factor, such as YOC:-1",
               "rotary.csv:3:11", "rotary.csv:4:11", "rotary.csv:5:13: with: expected nothing"});
}

TEST_CASE("where only a sum is known, a place at which both act alike is as certain as the sum") {
  CompensatedMachine machine = stated_rotary_machine("XYACTZ");
  machine.rotary->errors.location_u[0][1] = 30.0;  // YOA
  machine.rotary->errors.location_u[2][1] = std::hypot(30.0, 0.5);
  machine.rotary->errors.ties = {{{0, 1}, {2, 1}, -1.0}};
  UncertaintySettings settings;
  settings.declared_zero = 0.0;
  RotaryBudget only = rotary_budget_of(*machine.rotary, settings);
  only.motions.clear();
  CHECK(only.location[2][1] == Approx(0.5));
  const auto at = [&](const kinematics::Angles& angles_deg) {
    const Covariance c = covariance_at(machine, {}, only, {100.0, 50.0, 20.0}, angles_deg, 1);
    return std::sqrt(c[0][0] + c[1][1] + c[2][2]);
  };
  CHECK(at({0.0, 0.0, 180.0}) == Approx(1.0));  // turned by C alone: the sum, seen from both sides of the axis
  CHECK(at({90.0, 0.0, 0.0}) > 30.0);           // turned by A: by one of the two
}

TEST_CASE("linear propagation and draws agree at every place and angle, on chains of all kinds") {
  for (const char* chain : {"XYACTZ", "XTYZCB", "XYCTZB", "TXYZA"}) {
    CAPTURE(chain);
    CompensatedMachine machine = stated_rotary_machine(chain);
    machine.tool_offset_mm = {20.0, -30.0, -150.0};
    machine.errors = errors_of_map(machine.map, machine.parameters, machine.tool_offset_mm);
    RotaryAxes& rotary = *machine.rotary;
    std::erase_if(rotary.errors.tables, [](const RotaryTable& table) { return table.sense == Sense::EB; });
    for (RotaryTable& table : rotary.errors.tables)
      if (table.sense == Sense::EX)
        for (std::size_t i = 0; i < table.p_deg.size(); ++i) table.u.push_back(1.0 + 0.1 * static_cast<double>(i));
    rotary.errors.location_u[2][3] = 4.0;
    const auto r = rotary.travel_deg[1] ? 1U : 0U;  // and two that are known by their sum
    rotary.errors.location_u[r][2] = 6.0;
    rotary.errors.location_u[2][0] = 6.1;
    rotary.errors.ties.push_back({{r, 2}, {2, 0}, -1.0});
    const UncertaintyBudget budget = budget_of(machine, {});
    const RotaryBudget turns = rotary_budget_of(rotary, {});
    const Grid grid = grid_over(machine.travel_mm, 8, reference_of(machine.parameters));
    const auto settings = settings_over(rotary, 2);
    constexpr int kDraws = 3000;  // a standard deviation to 1.3 %
    MapDraws maps(machine, budget, 11);
    RotaryDraws drawn(turns, 12);
    std::vector<Vector3> squares(settings.size() * 2 * grid.places());
    const auto for_each = [&](const auto& each) {
      std::size_t n = 0;
      for (const kinematics::Angles& angles : settings)
        for (std::size_t side = 0; side < 2; ++side)
          for (std::size_t x = 0; x < grid.mm[0].size(); ++x)
            for (std::size_t y = 0; y < grid.mm[1].size(); ++y)
              for (std::size_t z = 0; z < grid.mm[2].size(); ++z) each(n++, angles, side, GridIndex{x, y, z});
    };
    for (int k = 0; k < kDraws; ++k) {
      maps.next();
      const JointVolume over = JointVolume::of(machine, grid, maps.components_over(grid), drawn.next());
      std::vector<Field> fields;
      for (const kinematics::Angles& angles : settings) fields.push_back(over.errors(angles));
      for_each([&](std::size_t n, const kinematics::Angles&, std::size_t side, const GridIndex& index) {
        const Vector3 error = fields[n / (2 * grid.places())].at(side, index);
        for (std::size_t d = 0; d < kAxes; ++d) squares[n][d] += error[d] * error[d] / kDraws;
      });
    }
    for_each([&](std::size_t n, const kinematics::Angles& angles, std::size_t side, const GridIndex& index) {
      const Covariance linear = covariance_at(machine, budget, turns, grid.at(index), angles, side);
      for (std::size_t d = 0; d < kAxes; ++d)
        if (linear[d][d] > 0.01) CHECK(std::sqrt(squares[n][d]) == Approx(std::sqrt(linear[d][d])).epsilon(0.07));
    });
  }
}

TEST_CASE("an uncertain place of the axis line moves the workpiece as it turns") {
  CompensatedMachine machine = stated_rotary_machine("XYCTZ");
  RotaryBudget only;
  only.location[2][0] = 3.0;  // XOC
  const auto at = [&](double angle_deg) {
    return covariance_at(machine, {}, only, {100.0, 50.0, 20.0}, {0.0, 0.0, angle_deg}, 1);
  };
  CHECK(at(0.0)[0][0] == Approx(0.0));   // counted from the reference at 0
  CHECK(at(90.0)[0][0] == Approx(9.0));  // X of the machine has become Y of the workpiece: (0, 1) less (1, 0)
  CHECK(at(90.0)[1][1] == Approx(9.0));
  CHECK(at(180.0)[0][0] == Approx(36.0));
}

TEST_CASE("the bound of a volume with rotary axes says both ways how certain it is, and they agree") {
  const CompensatedMachine machine = stated_rotary_machine("XYACTZ");
  const auto u = must(uncertainty_of(machine, budget_of(machine, {}), rotary_budget_of(*machine.rotary, {}), {}, 2000));
  CHECK(u.linear_rms_um == Approx(u.drawn_rms_um).epsilon(0.05));
  CHECK(u.largest_95_um > u.largest_50_um);
  CHECK(u.rms_95_um > u.linear_rms_um);
}

}  // namespace
}  // namespace ecs::volume
