// Rotary axes in the running loop, against the product of the exact matrices of the chain
// (tests/core/support/measured_machine.hpp).
#include "core/rotary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/tick.hpp"
#include "tests/core/support/measured_machine.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::test;

namespace {

constexpr double kDegEachCount = 0.001;
// Small and large errors as in tool_matrices_test.cpp, with arms of up to 1.3 m. Half the difference of the matrices
// with the errors and with the errors negated has no second order; cosines and sines within 2.4e-6, on errors of an
// outer axis of up to 50 um with small and 240 um with large errors, leave 0.0003 and 0.0015 um where every sign
// conspires.
constexpr double kSmall_um_per_m = 10.0, kLarge_um_per_m = 50.0;
constexpr double kFirstOrderOfSmall_um = 0.0003, kFirstOrderOfLarge_um = 0.0015;
// Bending of 20 um and of 60 um for each metre of a tool of up to 0.52 m, with the same share of cosine and sine.
constexpr double kBending_um = 20.0, kBending_um_per_m = 60.0, kFirstOrderOfBending_um = 0.0006;
constexpr double kSecondOrderOfSmall_um = 0.002, kSecondOrderOfLarge_um = 0.05;

double largest(const Eigen::Vector3d& v) { return v.cwiseAbs().maxCoeff(); }

/// What an image would hold of the rotary axes.
struct RotaryMap {
  RotarySetup machine;
  PerRotary<std::array<std::vector<std::uint8_t>, 2>> values;

  explicit RotaryMap(const MeasuredMachine& m, double deg_per_count = kDegEachCount) {
    machine.bending = m.bending;
    m.chain.copy(machine.configuration.data(), machine.configuration.size() - 1);
    std::size_t axis = 0;
    for (const char letter : m.chain)
      if (letter >= 'A' && letter <= 'C')
        add(axis++, letter, m.turning[static_cast<std::size_t>(letter - 'A')], deg_per_count);
  }

 private:
  void add(std::size_t i, char letter, const TurningAxis& from, double deg_per_count) {
    machine.axes[i] = {letter, deg_per_count, 0.01, from.direction, from.pivot_mm, from.location};
    RotaryCurves& table = machine.tables[i];
    table.start_deg = from.curves[0][0].start_mm;
    table.increment_deg = from.curves[0][0].increment_mm;
    const std::size_t count = from.curves[0][0].hundredths.size() - (from.curves[0][0].hundredths.size() == 37 ? 1 : 0);
    table.count = static_cast<std::uint32_t>(count);
    for (std::size_t side = 0; side < 2; ++side) {
      values[i][side].resize(12 * count);
      for (std::size_t s = 0; s < 6; ++s)
        for (std::size_t k = 0; k < count; ++k)
          store_big(values[i][side], 2 * (s * count + k),
                    static_cast<std::uint16_t>(-from.curves[s][side].hundredths[k]));
      table.values[side] = values[i][side];
    }
  }
};

/// The unit with the map that was measured on this machine.
struct FiveAxisUnit {
  const MeasuredMachine& machine;
  RotaryMap rotary_map;
  std::unique_ptr<CompiledMap> map = std::make_unique<CompiledMap>();
  TickState state;
  RotaryTickState rotary;
  ThermalState thermal;

  explicit FiveAxisUnit(const MeasuredMachine& m, double deg_per_count = kDegEachCount)
      : machine(m), rotary_map(m, deg_per_count) {
    const auto image = image_of(m.parameters, map_of(m), "", m.rows, {.stuck_s = 0.0}, &rotary_map.machine);
    REQUIRE(check_image(image).fault == ImageFault::none);
    const CompileVerdict verdict = compile(ImageView(image), *map);
    REQUIRE(text_of(verdict.rotary) == text_of(RotaryFault::none));
    REQUIRE(verdict.fault == Fault::none);
  }
  [[nodiscard]] std::size_t axis_at(std::size_t place) const {
    return static_cast<std::size_t>(map->rotary.axes[place].letter - 'A');
  }
  template <class T>
  [[nodiscard]] PerRotary<T> by_place(const std::array<T, 3>& by_axis) const {
    PerRotary<T> out{};
    for (std::size_t p = 0; p < kRotaryInputs; ++p)
      if (map->rotary.axes[p].letter != '\0') out[p] = by_axis[axis_at(p)];
    return out;
  }
  [[nodiscard]] static PerAxis<std::int64_t> counts_at(const Vector3& place, double each) {
    return {std::llround(place[0] / each), std::llround(place[1] / each), std::llround(place[2] / each)};
  }
  /// The loop begins here.
  void begin(const Standing& at) {
    start(state, counts_at(at.position_mm, 1e-3), at.position_mm, at.approach);
    start_rotary(map->rotary, rotary, by_place(counts_at(at.angle_deg, kDegEachCount)), by_place(at.angle_deg),
                 by_place(at.turned));
    thermal = {};
    (void)begin_thermal(map->thermal, thermal, at.inputs, at.position_mm, nullptr, 0.0);
    follow_thermal(*map, thermal, rotary);
    period(at);
  }
  void period(const Standing& at) {
    tick(*map, state, counts_at(at.position_mm, 1e-3), thermal.acting, rotary,
         by_place(counts_at(at.angle_deg, kDegEachCount)));
  }
  /// Period by period, within 0.1 um of the one before.
  void change_to(const Vector3& tool_mm, const Standing& at) {
    bool reached = false;
    for (int passed = 0; passed < 10'000 && !reached; ++passed) {
      const Vector3 before_um = state.compensation_um;
      reached = change_tool(*map, state, thermal, rotary, tool_mm, 0.1);
      period(at);
      CHECK(largest(eigen_of(state.compensation_um) - eigen_of(before_um)) <= 0.1 + 1e-9);
    }
    REQUIRE(reached);
  }
};

class RotaryDraws : public Draws {
 public:
  using Draws::Draws;
  Vector3 direction() {
    Eigen::Vector3d v;
    do v = eigen_of(vector(1.0));
    while (v.norm() < 0.2);
    v.normalize();
    return {v.x(), v.y(), v.z()};
  }
  MeasuredMachine five_axis_machine(const std::string& chain, double angles, double lengths, bool oblique) {
    MeasuredMachine m = machine(chain, angles, lengths, true);
    for (std::size_t r = 0; r < kAxes; ++r) {
      m.turning[r].direction = {};
      m.turning[r].direction[r] = one_in(3) ? -1.0 : 1.0;
      if (oblique) m.turning[r].direction = direction();
    }
    return m;
  }
  /// A head that bends, in the machine, in proportion to the tool, or both.
  MeasuredMachine bending_machine(const std::string& chain, bool of_machine, bool of_tool, bool oblique) {
    MeasuredMachine m = five_axis_machine(chain, kSmall_um_per_m, 8.0, oblique);
    if (of_machine) m.bending.of_machine = sizes(kBending_um);
    if (of_tool) m.bending.of_tool = sizes(kBending_um_per_m);
    return m;
  }
  Standing five_axis_standing(const std::string& chain) {
    Standing at = standing(chain);
    for (std::size_t r = 0; r < kAxes; ++r) {
      at.angle_deg[r] = std::round(up_to(400.0) * 1000.0) / 1000.0;
      at.turned[r] = one_in(2) ? Approach::forward : Approach::reverse;
    }
    return at;
  }

 private:
  std::array<double, 6> sizes(double most) {
    std::array<double, 6> each{};
    for (double& size : each) size = up_to(most);
    return each;
  }
};

/// A thousand places with random angles.
FromMatrices thousand_angles(RotaryDraws& draws, const MeasuredMachine& m) {
  FiveAxisUnit unit(m);
  FromMatrices seen;
  for (int place = 0; place < 1000; ++place) {
    const Standing at = draws.five_axis_standing(m.chain);
    unit.begin(at);
    seen.note(unit.state.compensation_um, m, at, m.parameters.tool_offset_mm);
  }
  return seen;
}

const std::vector<std::string> kEveryHead{"XTYZCB", "XTYZCA", "TXYZBA", "TXYZAC",
                                          "TXYZB",  "XYCTZB", "XATYZB", "BTXYZC"};
const std::vector<std::string> kEveryArrangement{"XYACTZ", "XYBCTZ", "XYBATZ", "YXZCAT", "CTXYZ",  "XTYZCB", "XTYZCA",
                                                 "TXYZBA", "TXYZAC", "TXYZB",  "XYCTZB", "XATYZB", "BTXYZC"};

}  // namespace

TEST_CASE("the output at any angles is the error of the exact matrices negated, with tables, heads and one of each") {
  RotaryDraws draws(20261126);
  for (const std::string& chain : kEveryArrangement)
    for (const bool oblique : {false, true}) {
      CAPTURE(chain);
      CAPTURE(oblique);
      const FromMatrices small = thousand_angles(draws, draws.five_axis_machine(chain, kSmall_um_per_m, 8.0, oblique));
      CHECK(small.whole_um <= kAllowed_um);
      CHECK(small.first_order_um <= kFirstOrderOfSmall_um);
      CHECK(small.second_order_um <= kSecondOrderOfSmall_um);
      CHECK(small.error_um > 20.0);
      const FromMatrices large = thousand_angles(draws, draws.five_axis_machine(chain, kLarge_um_per_m, 40.0, oblique));
      CHECK(large.first_order_um <= kFirstOrderOfLarge_um);
      CHECK(large.second_order_um <= kSecondOrderOfLarge_um);
    }
}

TEST_CASE("a head that bends is compensated at any angles and tool lengths as the exact matrices have it") {
  RotaryDraws draws(20261127);
  for (const std::string& chain : kEveryHead)
    for (const int bends : {1, 2, 3})
      for (const bool oblique : {false, true}) {
        CAPTURE(chain);
        CAPTURE(bends);
        CAPTURE(oblique);
        MeasuredMachine m = draws.bending_machine(chain, bends % 2 == 1, bends >= 2, oblique);
        for (int tool = 0; tool < 4; ++tool) {
          m.parameters.tool_offset_mm = tool == 0 ? Vector3{} : draws.vector(kLongestTool_mm);
          FiveAxisUnit unit(m);
          FromMatrices seen;
          for (int place = 0; place < 250; ++place) {
            const Standing at = draws.five_axis_standing(m.chain);
            unit.begin(at);
            seen.note(unit.state.compensation_um, m, at, m.parameters.tool_offset_mm);
          }
          CHECK(seen.whole_um <= kAllowed_um);
          CHECK(seen.first_order_um <= kFirstOrderOfBending_um);
        }
      }
}

TEST_CASE("the part of the rotary axes is the output of a machine without any other error") {
  RotaryDraws draws(20261201);
  for (const std::string& chain : kEveryArrangement) {
    CAPTURE(chain);
    const bool is_head = chain.find_last_of("ABC") > chain.find('T');
    const MeasuredMachine whole = draws.bending_machine(chain, is_head, is_head, true);
    MeasuredMachine rotary_alone = whole;
    for (auto& sides : rotary_alone.curves)
      for (ShownCurve& curve : sides) std::ranges::fill(curve.hundredths, std::int16_t{0});
    rotary_alone.rows.clear();
    for (const Component square : {Component::C0Y, Component::B0Z, Component::A0Z})
      squareness_um_per_m(rotary_alone.parameters, square) = 0.0;
    FiveAxisUnit unit(whole), alone(rotary_alone);
    for (int place = 0; place < 100; ++place) {
      const Standing at = draws.five_axis_standing(whole.chain);
      unit.begin(at);
      alone.begin(at);
      const Vector3 part_um = rotary_compensation_um(*unit.map, unit.state, unit.rotary);
      CHECK(largest(eigen_of(part_um) - eigen_of(alone.state.compensation_um)) < 1e-9);
      for (std::size_t p = 0; p < kRotaryInputs; ++p)
        if (const char letter = unit.map->rotary.axes[p].letter; letter != '\0')
          CHECK(rotary_approach(unit.map->rotary, unit.rotary, letter) == at.turned[unit.axis_at(p)]);
    }
  }
}

TEST_CASE("another tool at a turned head is reached within the limit of every period, and is that of the matrices") {
  RotaryDraws draws(20261127);
  for (const std::string& chain : kEveryArrangement) {
    CAPTURE(chain);
    const bool is_head = chain.find_last_of("ABC") > chain.find('T');
    const MeasuredMachine m = draws.bending_machine(chain, is_head, is_head, false);
    FiveAxisUnit unit(m);
    FromMatrices seen;
    for (int change = 0; change < 100; ++change) {
      const Standing at = draws.five_axis_standing(m.chain);
      unit.begin(at);
      const Vector3 tool_mm = draws.vector(kLongestTool_mm);
      unit.change_to(tool_mm, at);
      seen.note(unit.state.compensation_um, m, at, tool_mm);
    }
    CHECK(seen.whole_um <= kAllowed_um);
    CHECK(seen.first_order_um <= (is_head ? kFirstOrderOfBending_um : kFirstOrderOfSmall_um));
  }
}

TEST_CASE("a tool of the same length on the other side of the spindle is reached without a step, with a bent head") {
  RotaryDraws draws(20261128);
  const MeasuredMachine m = draws.bending_machine("XTYZCB", true, true, false);
  FiveAxisUnit unit(m);
  Standing at = draws.five_axis_standing(m.chain);
  at.angle_deg = {0.0, 90.0, 30.0};
  unit.begin(at);
  for (const Vector3& tool_mm :
       {Vector3{0.0, 0.0, -200.0}, Vector3{0.0, 0.0, 200.0}, Vector3{}, Vector3{150.0, 0.0, 0.0}}) {
    unit.change_to(tool_mm, at);
    CHECK(largest(matrix_error_um(m, at, tool_mm) + eigen_of(unit.state.compensation_um)) <= kAllowed_um);
  }
}

TEST_CASE("the approach of a rotary axis turns beyond its deadband, whichever way its transducer counts") {
  RotaryDraws draws(20261128);
  const MeasuredMachine m = draws.five_axis_machine("XYCTZ", kSmall_um_per_m, 8.0, false);
  Standing at = draws.five_axis_standing(m.chain);
  at.angle_deg = {0.0, 0.0, 45.0};
  at.turned[2] = Approach::forward;
  for (const double deg_per_count : {0.001, -0.001}) {
    FiveAxisUnit unit(m, deg_per_count);
    const auto stand_at = [&](double deg) {
      tick(*unit.map, unit.state, FiveAxisUnit::counts_at(at.position_mm, 1e-3), unit.thermal.acting, unit.rotary,
           {std::llround((deg - 45.0) / deg_per_count), 0});
      Standing there = at;
      there.angle_deg[2] = deg;
      return there;
    };
    const auto error_um = [&](const Standing& there) {
      return largest(matrix_error_um(m, there, m.parameters.tool_offset_mm) + eigen_of(unit.state.compensation_um));
    };
    unit.begin(at);
    start_rotary(unit.map->rotary, unit.rotary, {0, 0}, {45.0, 0.0}, {Approach::forward, Approach::forward});
    Standing there = stand_at(50.0);
    CHECK(error_um(there) <= kAllowed_um);
    there = stand_at(49.99);  // the deadband is 0.01 deg
    CHECK(error_um(there) <= kAllowed_um);
    there = stand_at(49.989);
    there.turned[2] = Approach::reverse;
    CHECK(error_um(there) <= kAllowed_um);
    there = stand_at(49.999);
    there.turned[2] = Approach::reverse;
    CHECK(error_um(there) <= kAllowed_um);
    there = stand_at(50.0);
    CHECK(error_um(there) <= kAllowed_um);
    CHECK(rotary_position_deg(unit.map->rotary, unit.rotary, 0) == doctest::Approx(50.0));
  }
}

TEST_CASE("a rotary axis may turn without end") {
  RotaryDraws draws(20261129);
  const MeasuredMachine m = draws.five_axis_machine("XYACTZ", kSmall_um_per_m, 8.0, false);
  Standing at = draws.five_axis_standing(m.chain);
  at.angle_deg[2] = 123.456;
  FiveAxisUnit unit(m);
  unit.begin(at);
  for (const double turns : {1.0, -1.0, 1000.0, -100'000.0}) {
    Standing further = at;
    further.angle_deg[2] += 360.0 * turns;
    at.turned[2] = turns > 0.0 ? Approach::forward : Approach::reverse;
    unit.period(further);
    CHECK(largest(matrix_error_um(m, at, m.parameters.tool_offset_mm) + eigen_of(unit.state.compensation_um)) <=
          kAllowed_um);
    CHECK(rotary_position_deg(unit.map->rotary, unit.rotary, 1) == doctest::Approx(123.456).epsilon(1e-8));
  }
}

TEST_CASE("a table of part of a turn holds its nearer end beyond it") {
  RotaryDraws draws(20261130);
  MeasuredMachine m = draws.five_axis_machine("XYATZ", kSmall_um_per_m, 8.0, false);
  for (auto& sides : m.turning[0].curves)
    for (ShownCurve& curve : sides) {
      curve.start_mm = -110.0;
      curve.hundredths.resize(15);  // to 30 deg
    }
  FiveAxisUnit unit(m);
  Standing at = draws.five_axis_standing(m.chain);
  const auto compensation_um = [&](double deg) {
    at.angle_deg = {deg, 0.0, 0.0};
    unit.begin(at);
    return eigen_of(unit.state.compensation_um);
  };
  for (const double deg : {-110.0, -64.3, 0.0, 29.9, 30.0, 100.0, 139.8}) {
    const Eigen::Vector3d now_um = compensation_um(deg);
    CHECK(largest(matrix_error_um(m, at, m.parameters.tool_offset_mm) + now_um) <= kAllowed_um);
  }
  CHECK(largest(compensation_um(-110.0) - compensation_um(140.3)) < 1e-9);
  CHECK(largest(compensation_um(-110.0) - compensation_um(-110.1)) < 1e-9);
}

TEST_CASE("rotary axes that cannot be compensated are refused with the reason") {
  RotaryDraws draws(20261201);
  const MeasuredMachine m = draws.five_axis_machine("XYACTZ", kSmall_um_per_m, 8.0, false);
  FiveAxisUnit unit(m);
  const auto fault_with = [&](auto change) {
    RotarySetup machine = unit.rotary_map.machine;
    UnitParameters parameters = m.parameters;
    change(machine, parameters);
    const RotaryFault fault = compile_rotary(machine, parameters, *unit.map);
    CHECK(unit.map->rotary.arrangement == RotaryWorking::Arrangement::none);
    return fault;
  };
  const auto chain = [&](const char* configuration) {
    return fault_with([&](RotarySetup& machine, UnitParameters&) {
      machine.configuration = {};
      std::string(configuration).copy(machine.configuration.data(), 7);
    });
  };
  CHECK(chain("XYTZ") == RotaryFault::other_chain);
  CHECK(chain("XYACT") == RotaryFault::other_chain);
  CHECK(chain("XYBCTZ") == RotaryFault::other_chain);
  CHECK(chain("XYATZ") == RotaryFault::other_chain);
  CHECK(chain("XYAATZ") == RotaryFault::other_chain);
  CHECK(chain("YXACTZ") == RotaryFault::other_chain);
  CHECK(chain("ACXYTZ") == RotaryFault::turned_linear);
  CHECK(chain("XYATCZ") == RotaryFault::turned_linear);
  CHECK(fault_with([](RotarySetup&, UnitParameters& p) { p.scope = Scope::planar; }) == RotaryFault::part_of_model);
  CHECK(fault_with([](RotarySetup&, UnitParameters& p) { p.interpolation = Interpolation::nearest; }) ==
        RotaryFault::part_of_model);
  CHECK(fault_with([](RotarySetup& machine, UnitParameters& p) {
          machine.configuration = {'X', 'Y', 'C', 'T', 'Z', 'A'};
          p.tool_range_mm[1] = 0.0;
        }) == RotaryFault::no_tool_range);
  const double not_a_number = std::numeric_limits<double>::quiet_NaN();
  const auto axis = [&](auto change) {
    return fault_with([&](RotarySetup& one, UnitParameters&) { change(one.axes[1]); });
  };
  CHECK(fault_with([](RotarySetup& machine, UnitParameters&) { machine.bending.of_tool[2] = 1.0; }) ==
        RotaryFault::no_head);
  CHECK(fault_with([&](RotarySetup& machine, UnitParameters&) { machine.bending.of_machine[5] = not_a_number; }) ==
        RotaryFault::bad_axis);
  CHECK(axis([](RotaryAxis& a) { a.direction = {0.0, 0.7, 0.7}; }) == RotaryFault::bad_axis);
  CHECK(axis([](RotaryAxis& a) { a.deg_per_count = 0.0; }) == RotaryFault::bad_axis);
  CHECK(axis([](RotaryAxis& a) { a.deg_per_count = 180.0; }) == RotaryFault::bad_axis);
  CHECK(axis([&](RotaryAxis& a) { a.deadband_deg = not_a_number; }) == RotaryFault::bad_axis);
  CHECK(axis([&](RotaryAxis& a) { a.pivot_mm[2] = not_a_number; }) == RotaryFault::bad_axis);
  CHECK(axis([&](RotaryAxis& a) { a.location[5] = not_a_number; }) == RotaryFault::bad_axis);
  const auto table = [&](auto change) {
    return fault_with([&](RotarySetup& one, UnitParameters&) { change(one.tables[0]); });
  };
  CHECK(table([](RotaryCurves& t) { t.increment_deg = 10.4; }) == RotaryFault::bad_table);
  CHECK(table([](RotaryCurves& t) { t.increment_deg = 7.77; }) == RotaryFault::uneven_table);
  CHECK(table([](RotaryCurves& t) { t.increment_deg = 0.05; }) == RotaryFault::uneven_table);
  CHECK(table([](RotaryCurves& t) { t.count = 35; }) == RotaryFault::bad_table);
  CHECK(table([](RotaryCurves& t) { t.resolution[3] = 0.0; }) == RotaryFault::bad_table);
  CHECK(table([&](RotaryCurves& t) { t.start_deg = not_a_number; }) == RotaryFault::bad_table);
}
