// Another tool in the running loop, against the product of the exact matrices of the chain with the tool at its end.
// The machine here is known by what is measured on it: its matrices are chosen so that a laser on the measurement line
// of an axis, and without a tool offset, shows the curves of the map. So no lever is written down here: which arms act
// follows from the order of the matrices. Nothing of core/terms.cpp or of tests/support/exact_machine.cpp takes part.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "base/random.hpp"
#include "core/tick.hpp"
#include "tests/core/support/image_of.hpp"
#include "tests/support/random_values.hpp"

using namespace ecs;
using namespace ecs::test;

namespace {

constexpr double kTravelEachWay_mm = 150.0;  // levers from a measurement line: up to 300 mm
constexpr double kLongestTool_mm = 300.0;    // along each axis
constexpr double kAtOnce_um = std::numeric_limits<double>::infinity();
constexpr double kCountsEachUm = 40.0;

// How far a first-order model may be from the matrices. With nine angles of up to a, s = 9 a, the product of the
// rotations differs from 1 + Σ ε by at most s²/2, at an arm of √3 (150 + 300) mm = 0.78 m; what lies inside rotations
// of other axes (curves and own levers up to 25 um, squareness up to 4 um an axis) is turned by at most 2 s in all:
// with 10 um/m 0.0032 + 0.0052 um where every sign conspires. The matrices know their second order themselves: it is
// what the errors and the same errors negated have in common, at most 0.0004 um here, and 0.007 um with 50 um/m.
constexpr double kSmallAngles_um_per_m = 10.0;
constexpr double kLargeAngles_um_per_m = 50.0;
constexpr double kAllowed_um = 0.01;
constexpr double kSecondOrderOfSmallAngles_um = 0.003;
// Half the difference between the two has no second order. What is left is s³/6 at the same arm and s²/2 of what lies
// inside: 1.5e-7 um with small and 2.2e-5 um with large angles.
constexpr double kThirdOrderOfSmallAngles_um = 2e-7;
constexpr double kThirdOrderOfLargeAngles_um = 3e-5;

/// Errors in hundredths of um or um/m; straight between the targets, and the end values beyond them.
struct ShownCurve {
  double start_mm = 0.0;
  double increment_mm = 10.0;
  std::vector<std::int16_t> hundredths;

  [[nodiscard]] double at(double p_mm) const {
    const double last = static_cast<double>(hundredths.size() - 1);
    const double place = std::clamp((p_mm - start_mm) / increment_mm, 0.0, last);
    const auto below = static_cast<std::size_t>(place);
    const auto above = std::min(below + 1, hundredths.size() - 1);
    return std::lerp(hundredths[below], hundredths[above], place - std::floor(place)) / 100.0;
  }
};

/// Where a machine stands, how it came there, and what its inputs show.
struct Standing {
  Vector3 position_mm{};
  PerAxis<Approach> approach{};
  InputValues inputs{};
};

struct MeasuredMachine {
  std::string chain;
  UnitParameters parameters;
  std::array<std::array<ShownCurve, 2>, kCurves> curves;  ///< reverse, forward
  std::vector<ThermalRow> rows;                           ///< rotations, law shift
};

/// Of one carriage, tool against workpiece.
struct CarriageError {
  Eigen::Vector3d shift_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();
};

Eigen::Vector3d eigen_of(const Vector3& v) { return {v[0], v[1], v[2]}; }

Eigen::Matrix3d full_rotation(const Eigen::Vector3d& turn_rad) {
  return (Eigen::AngleAxisd(turn_rad.z(), Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(turn_rad.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(turn_rad.x(), Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

/// Direction of a guideway: C0Y turns that of Y about Z, A0Z and B0Z turn that of Z about X and Y.
Eigen::Vector3d guideway(Axis a, const Vector3& squareness_rad) {
  Eigen::Vector3d straight = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(index_of(a)));
  if (a == Axis::Y) return full_rotation({0.0, 0.0, squareness_rad[0]}) * straight;
  if (a == Axis::Z) return full_rotation({squareness_rad[2], squareness_rad[1], 0.0}) * straight;
  return straight;
}

/// The tool point in the coordinates of the workpiece. A carriage that carries the tool goes to its coordinate and
/// turns about its own frame; one that carries the workpiece goes the other way, with the errors the other way.
Eigen::Vector3d tool_point_mm(const std::string& chain, const Vector3& position_mm,
                              const PerAxis<CarriageError>& errors, const Vector3& squareness_rad,
                              const Vector3& tool_mm) {
  Eigen::Isometry3d workpiece = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d spindle = Eigen::Isometry3d::Identity();
  bool carries_tool = false;
  for (const char letter : chain) {
    const auto a = axis_of(letter);
    if (!a) {
      carries_tool = true;
      continue;
    }
    const CarriageError& error = errors[index_of(*a)];
    const Eigen::Vector3d way_mm = guideway(*a, squareness_rad) * position_mm[index_of(*a)] + error.shift_mm;
    const Eigen::Matrix3d turn = full_rotation(error.turn_rad);
    if (carries_tool) {
      spindle.translate(way_mm).rotate(turn);
    } else {
      workpiece.translate(-way_mm).rotate(turn.transpose());
    }
  }
  return workpiece.inverse() * (spindle * eigen_of(tool_mm));
}

/// The shift with which a carriage that turns by `turn_rad` shows `seen_mm` at this place, without a tool offset and
/// with every other axis perfect.
Eigen::Vector3d shift_that_shows_mm(const std::string& chain, Axis a, const Vector3& place_mm,
                                    const Eigen::Vector3d& turn_rad, const Eigen::Vector3d& seen_mm) {
  PerAxis<CarriageError> turned{};
  turned[index_of(a)].turn_rad = turn_rad;
  const Eigen::Vector3d not_yet_mm =
      seen_mm - (tool_point_mm(chain, place_mm, turned, {}, {}) - tool_point_mm(chain, place_mm, {}, {}, {}));
  const bool carries_workpiece = chain.find(letter_of(a)) < chain.find('T');
  return carries_workpiece ? full_rotation(turn_rad).transpose() * not_yet_mm : not_yet_mm;
}

/// The error that a thermal row takes away, um/m.
double thermal_turn(const ThermalRow& row, const InputValues& inputs) {
  const double less = row.minus == kNoInput ? row.reference : inputs[row.minus].value;
  return -row.coefficient * (inputs[row.source].value - less);
}

/// Curves of a moving axis were measured on its line, along its own travel. A thermal rotation turns the carriage as it
/// stood on that line, its own coordinate included. @param sign  −1: every error negated
CarriageError carriage_error(const MeasuredMachine& m, const Standing& at, Axis a, double sign) {
  const std::size_t side = at.approach[index_of(a)] == Approach::forward ? 1 : 0;
  const double p_mm = at.position_mm[index_of(a)];
  const auto shown = [&](Sense s) { return sign * m.curves[index_of(curve_of(s, a))][side].at(p_mm); };
  const Eigen::Vector3d seen_mm = Eigen::Vector3d{shown(Sense::EX), shown(Sense::EY), shown(Sense::EZ)} / 1e3;
  const Eigen::Vector3d turn_rad = Eigen::Vector3d{shown(Sense::EA), shown(Sense::EB), shown(Sense::EC)} / 1e6;
  Eigen::Vector3d thermal_rad = Eigen::Vector3d::Zero();
  for (const ThermalRow& row : m.rows)
    if (moving_axis(row.component) == a)
      thermal_rad[static_cast<Eigen::Index>(index_of(direction_of(sense_of(row.component))))] +=
          sign * thermal_turn(row, at.inputs) / 1e6;
  const Vector3 line_mm = m.parameters.measurement_lines_mm[index_of(a)];
  Vector3 measured_mm = line_mm;
  measured_mm[index_of(a)] = p_mm;
  return {shift_that_shows_mm(m.chain, a, measured_mm, turn_rad, seen_mm) +
              shift_that_shows_mm(m.chain, a, line_mm, thermal_rad, Eigen::Vector3d::Zero()),
          turn_rad + thermal_rad};
}

/// Actual less target at the tool point, um.
Eigen::Vector3d matrix_error_um(const MeasuredMachine& m, const Standing& at, const Vector3& tool_mm,
                                double sign = 1.0) {
  PerAxis<CarriageError> errors;
  for (const Axis a : kAllAxes) errors[index_of(a)] = carriage_error(m, at, a, sign);
  const UnitParameters& p = m.parameters;
  const double rad = sign / 1e6;
  const Eigen::Vector3d point_mm = tool_point_mm(
      m.chain, at.position_mm, errors, {p.C0Y_um_per_m * rad, p.B0Z_um_per_m * rad, p.A0Z_um_per_m * rad}, tool_mm);
  return (point_mm - eigen_of(at.position_mm) - eigen_of(tool_mm)) * 1000.0;
}

/// Largest differences from the matrices, um.
struct FromMatrices {
  double whole_um = 0.0;
  double first_order_um = 0.0;   ///< from half the difference between the errors and the same negated
  double second_order_um = 0.0;  ///< of the matrices themselves
  void note(const Vector3& compensation_um, const MeasuredMachine& m, const Standing& at, const Vector3& tool_mm) {
    REQUIRE(eigen_of(compensation_um).allFinite());
    const Eigen::Vector3d error_um = matrix_error_um(m, at, tool_mm);
    const Eigen::Vector3d negated_um = matrix_error_um(m, at, tool_mm, -1.0);
    const auto largest = [&](double& so_far, const Eigen::Vector3d& v) {
      for (const Axis a : kAllAxes)
        if (contains(m.chain, letter_of(a)))  // no axis, no direction to correct in
          so_far = std::max(so_far, std::abs(v[static_cast<Eigen::Index>(index_of(a))]));
    };
    largest(whole_um, error_um + eigen_of(compensation_um));
    largest(first_order_um, (error_um - negated_um) / 2.0 + eigen_of(compensation_um));
    largest(second_order_um, (error_um + negated_um) / 2.0);
  }
};

/// Random machines, tools and places; the same in every run.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : random_(seed) {}
  double up_to(double most) { return UniformDraws(-most, most)(random_); }
  Vector3 vector(double most) { return {up_to(most), up_to(most), up_to(most)}; }
  bool one_in(std::uint32_t n) { return one_of(random_, n) == 0; }
  ShownCurve curve(double most) {
    ShownCurve c{-kTravelEachWay_mm + up_to(20.0), 20.0 + up_to(12.0), {}};
    c.hundredths.resize(static_cast<std::size_t>(1.9 * kTravelEachWay_mm / c.increment_mm));
    for (std::int16_t& value : c.hundredths) value = static_cast<std::int16_t>(std::lround(100.0 * up_to(most)));
    return c;
  }
  /// On whole um, which are the counts; an axis that does not exist stands at 0.
  Vector3 place(const std::string& chain) {
    Vector3 at{};
    for (const Axis a : kAllAxes)
      if (contains(chain, letter_of(a))) at[index_of(a)] = std::round(up_to(kTravelEachWay_mm) * 1000.0) / 1000.0;
    return at;
  }
  Standing standing(const std::string& chain) {
    Standing s{place(chain), {}, {}};
    for (Approach& approach : s.approach) approach = one_in(2) ? Approach::forward : Approach::reverse;
    for (std::size_t i = 0; i < kTemperatureInputs; ++i) s.inputs[i] = {20.0 + up_to(5.0), true, 1};
    s.inputs[kLoadInput] = {250.0 + up_to(250.0), true, 1};
    return s;
  }
  /// With rows the thermal rotations have a quarter of the angles, and the curves the rest.
  MeasuredMachine machine(const std::string& chain, double angles_um_per_m, double lengths_um, bool with_rows) {
    MeasuredMachine m{chain, {}, {}, {}};
    UnitParameters& p = m.parameters;
    set_configuration(p, chain);
    p.C0Y_um_per_m = up_to(angles_um_per_m);
    p.B0Z_um_per_m = up_to(angles_um_per_m);
    p.A0Z_um_per_m = up_to(angles_um_per_m);
    p.tool_offset_mm = one_in(3) ? Vector3{} : vector(kLongestTool_mm);
    p.tool_range_mm = {kLongestTool_mm, kLongestTool_mm, kLongestTool_mm};
    for (Vector3& line_mm : p.measurement_lines_mm) line_mm = vector(kTravelEachWay_mm);
    for (AxisParameters& axis : p.axes) {
      axis.output_scale_counts_per_um = kCountsEachUm;
      axis.output_slew_um_per_s = 1e6;
      axis.deadband_um = 1000.0;  // the counts here do not follow the output, which would look like a move back
    }
    for (std::size_t c = 0; c < kCurves; ++c)
      for (ShownCurve& side : m.curves[c])
        side = curve(!is_angular(static_cast<Component>(c)) ? lengths_um
                     : with_rows                            ? 0.75 * angles_um_per_m
                                                            : angles_um_per_m);
    if (with_rows) m.rows = rotations(0.25 * angles_um_per_m);
    return m;
  }

 private:
  /// Every rotation follows a temperature or the difference of two, up to 10 degC; EBY follows the load too.
  std::vector<ThermalRow> rotations(double most_um_per_m) {
    std::vector<ThermalRow> rows;
    for (std::size_t c = 0; c < kCurves; ++c)
      if (const auto component = static_cast<Component>(c); is_angular(component)) {
        const auto source = static_cast<std::uint8_t>(rows.size());
        const std::uint8_t minus = source % 3 == 2 ? source - 1 : kNoInput;
        rows.push_back({component, ThermalLaw::shift, source, minus, up_to(most_um_per_m / 20.0), 20.0, 0.0, 70.0});
      }
    rows.push_back(
        {Component::EBY, ThermalLaw::shift, kLoadInput, kNoInput, up_to(most_um_per_m / 1000.0), 0.0, 0.0, 0.0});
    return rows;
  }
  std::mt19937_64 random_;
};

/// The unit with the map that was measured on this machine.
struct UnitOnMachine {
  const MeasuredMachine& machine;
  std::unique_ptr<CompiledMap> map = std::make_unique<CompiledMap>();
  TickState state;
  ThermalState thermal;
  InputValues inputs{};
  PerAxis<std::int64_t> counts{};

  explicit UnitOnMachine(const MeasuredMachine& m) : machine(m) {
    std::vector<PlannedTable> tables;
    for (std::size_t c = 0; c < kCurves; ++c)
      for (const Approach approach : {Approach::reverse, Approach::forward}) {
        const ShownCurve& curve = m.curves[c][side_of(approach)];
        PlannedTable t{static_cast<Component>(c), approach, curve.start_mm, curve.increment_mm, 0.01, {}};
        for (const std::int16_t value : curve.hundredths) t.counts.push_back(static_cast<std::int16_t>(-value));
        tables.push_back(t);
      }
    const auto image = image_of(m.parameters, tables, "", m.rows, {.stuck_s = 0.0});  // inputs here stay as they are
    REQUIRE(check_image(image).fault == ImageFault::none);
    REQUIRE(compile(ImageView(image), *map).fault == Fault::none);
  }
  /// The loop begins here.
  void begin(const Standing& at) {
    place(at.position_mm);
    start(state, counts, at.position_mm, at.approach);
    inputs = at.inputs;
    thermal = {};
    (void)begin_thermal(map->thermal, thermal, inputs, at.position_mm, nullptr, 0.0);
    period();
  }
  void place(const Vector3& position_mm) {
    for (std::size_t a = 0; a < kAxes; ++a) counts[a] = std::llround(position_mm[a] * 1000.0);
  }
  void period() {
    if (machine.rows.empty()) {
      tick(*map, state, counts);
      return;
    }
    tick(*map, state, counts, thermal.acting);
    if (state.ticks % 100 == 0) slow_loop();
  }
  void slow_loop() {
    for (InputValue& input : inputs) input.number += input.present ? 1 : 0;
    (void)step_thermal(map->thermal, thermal, inputs, state.position_mm, kThermalStep_s);
  }
  bool another_tool(const Vector3& tool_mm, double most_um) {
    const bool reached = change_tool(*map, state, thermal, tool_mm, most_um);
    period();
    return reached;
  }
  /// D/A output before it is rounded, um.
  [[nodiscard]] Vector3 output_um() const {
    return {state.output_counts[0] / kCountsEachUm, state.output_counts[1] / kCountsEachUm,
            state.output_counts[2] / kCountsEachUm};
  }
};

/// A thousand places, each with another tool, at once or in steps of 0.25 um.
FromMatrices thousand_places(Draws& draws, const MeasuredMachine& m) {
  UnitOnMachine unit(m);
  FromMatrices seen;
  Vector3 tool_mm = m.parameters.tool_offset_mm;
  for (int place = 0; place < 1000; ++place) {
    const Standing at = draws.standing(m.chain);
    unit.begin(at);
    seen.note(unit.output_um(), m, at, tool_mm);  // the tool before
    tool_mm = draws.vector(kLongestTool_mm);
    const double most_um = place % 2 == 0 ? kAtOnce_um : 0.25;
    int periods = 1;
    while (!unit.another_tool(tool_mm, most_um) && periods < 10'000) ++periods;
    REQUIRE(periods < 10'000);
    if (most_um == kAtOnce_um) REQUIRE(periods == 1);
    seen.note(unit.output_um(), m, at, tool_mm);
    seen.note(unit.state.compensation_um, m, at, tool_mm);
    for (std::size_t a = 0; a < kAxes; ++a)
      REQUIRE(std::abs(unit.state.dac_counts[a] - unit.state.output_counts[a]) <= 0.5 + 1e-9);
    unit.slow_loop();
    unit.period();
    seen.note(unit.output_um(), m, at, tool_mm);  // the slow loop keeps the tool
  }
  return seen;
}

constexpr double kMostEachPeriod_um = 0.02;  // 20 um/s at 1 kHz

/// A loop that does not stop: axes go to other places, tools are changed, and some changes are overtaken by the next.
struct RunningUnit {
  UnitOnMachine unit;
  Draws& draws;
  Standing at;
  double largest_step_um = 0.0;  ///< of the output of any axis, from one period to the next, while no axis moves
  std::int32_t largest_dac_step = 0;
  int abandoned = 0;

  RunningUnit(const MeasuredMachine& m, Draws& with) : unit(m), draws(with), at(with.standing(m.chain)) {
    unit.begin(at);
  }

  /// Goes elsewhere, changes the tool, and one time in four goes on before it has changed, with another tool.
  Vector3 change_tool_on_the_way() {
    move();
    Vector3 tool_mm = draws.vector(kLongestTool_mm);
    if (draws.one_in(4) && !changes_within(tool_mm, 50)) {
      ++abandoned;
      move();
      tool_mm = draws.one_in(2) ? Vector3{} : draws.vector(kLongestTool_mm);
    }
    REQUIRE(changes_within(tool_mm, 20'000));
    const TickState before = unit.state;
    REQUIRE(unit.another_tool(tool_mm, kMostEachPeriod_um));
    CHECK(unit.state.output_counts == before.output_counts);
    return tool_mm;
  }

 private:
  bool changes_within(const Vector3& tool_mm, int periods) {
    for (int period = 0; period < periods; ++period) {
      const TickState before = unit.state;
      const bool reached = unit.another_tool(tool_mm, kMostEachPeriod_um);
      for (std::size_t a = 0; a < kAxes; ++a) {
        const double step_um = std::abs(unit.state.output_counts[a] - before.output_counts[a]) / kCountsEachUm;
        largest_step_um = std::max(largest_step_um, step_um);
        largest_dac_step = std::max(largest_dac_step, std::abs(unit.state.dac_counts[a] - before.dac_counts[a]));
      }
      if (reached) return true;
    }
    return false;
  }
  /// Each axis by more than its deadband, in one period.
  void move() {
    const Vector3 to_mm = draws.place(unit.machine.chain);
    for (std::size_t a = 0; a < kAxes; ++a) {
      if (std::abs(to_mm[a] - at.position_mm[a]) < 2.0) continue;
      at.approach[a] = to_mm[a] > at.position_mm[a] ? Approach::forward : Approach::reverse;
      at.position_mm[a] = to_mm[a];
    }
    unit.place(at.position_mm);
    unit.period();
  }
};

}  // namespace

TEST_CASE("after a change of tool the output is the error of the exact matrices negated, for every chain") {
  Draws draws(20261126);
  const auto chains = every_chain();
  REQUIRE(chains.size() == 48);
  for (const std::string& chain : chains) {
    CAPTURE(chain);
    const FromMatrices seen = thousand_places(draws, draws.machine(chain, kSmallAngles_um_per_m, 8.0, false));
    CHECK(seen.whole_um <= kAllowed_um);
    CHECK(seen.second_order_um <= kSecondOrderOfSmallAngles_um);
    CHECK(seen.first_order_um <= kThirdOrderOfSmallAngles_um);
  }
}

TEST_CASE("thermal rotations turn another tool as the exact matrices do, on every chain") {
  Draws draws(20261127);
  for (const std::string& chain : every_chain()) {
    CAPTURE(chain);
    const FromMatrices seen = thousand_places(draws, draws.machine(chain, kSmallAngles_um_per_m, 8.0, true));
    CHECK(seen.whole_um <= kAllowed_um);
    CHECK(seen.second_order_um <= kSecondOrderOfSmallAngles_um);
    CHECK(seen.first_order_um <= kThirdOrderOfSmallAngles_um);
  }
}

TEST_CASE("with angles of 50 um/m a change of tool follows the exact matrices to first order") {
  Draws draws(20261128);
  for (const char* chain : {"TXYZ", "XTYZ", "XYTZ", "XYZT", "YXTZ", "ZTXY"}) {
    CAPTURE(chain);
    const FromMatrices seen = thousand_places(draws, draws.machine(chain, kLargeAngles_um_per_m, 40.0, true));
    CHECK(seen.whole_um <= kAllowed_um);
    CHECK(seen.first_order_um <= kThirdOrderOfLargeAngles_um);
  }
}

TEST_CASE("a thousand changes of tool in a running loop keep the limit in every period and end at the matrices") {
  Draws draws(20261129);
  for (const char* chain : {"TXYZ", "XTYZ", "XYTZ", "XYZT"}) {
    CAPTURE(chain);
    const MeasuredMachine m = draws.machine(chain, kLargeAngles_um_per_m, 40.0, true);
    RunningUnit running(m, draws);
    FromMatrices seen;
    for (int change = 0; change < 1000; ++change) {
      const Vector3 tool_mm = running.change_tool_on_the_way();
      seen.note(running.unit.output_um(), m, running.at, tool_mm);
    }
    CHECK(running.largest_step_um <= kMostEachPeriod_um + 1e-9);
    CHECK(running.largest_step_um > 0.9 * kMostEachPeriod_um);
    CHECK(running.largest_dac_step <= 1);  // 0.8 counts
    CHECK(running.abandoned > 100);
    CHECK(seen.whole_um <= kAllowed_um);
    CHECK(seen.first_order_um <= kThirdOrderOfLargeAngles_um);
  }
}
