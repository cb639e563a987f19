// A machine known by what is measured on it, and the product of its exact matrices: they are chosen so that a laser on
// the measurement line of an axis, without a tool offset and with rotary axes at 0, shows the curves of the map. So no
// lever is written down here: which arms act follows from the order of the matrices. Nothing of core/terms.cpp,
// core/rotary.cpp, kinematics/ or tests/support/exact_machine.cpp takes part. Only for tests of core/.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "base/random.hpp"
#include "core/tick.hpp"
#include "tests/core/support/image_of.hpp"
#include "tests/support/random_values.hpp"
#include "tests/support/test.hpp"

namespace ecs::test {

inline constexpr double kTravelEachWay_mm = 150.0;  // levers from a measurement line: up to 300 mm
inline constexpr double kLongestTool_mm = 300.0;    // along each axis
inline constexpr double kCountsEachUm = 40.0;
inline constexpr double kAllowed_um = 0.01;

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
  Vector3 angle_deg{};  ///< A, B, C
  PerAxis<Approach> turned{};
};

/// A rotary axis. The places of its curves are angles, deg.
struct TurningAxis {
  Vector3 direction{0.0, 0.0, 1.0};
  Vector3 pivot_mm{};
  std::array<double, 6> location{};
  std::array<std::array<ShownCurve, 2>, 6> curves;
};

struct MeasuredMachine {
  std::string chain;
  UnitParameters parameters;
  std::array<std::array<ShownCurve, 2>, kCurves> curves;  ///< reverse, forward
  std::vector<ThermalRow> rows;                           ///< rotations, law shift
  PerAxis<TurningAxis> turning;                           ///< A, B, C
  RotaryBending bending{};
};

/// Of one carriage, tool against workpiece.
struct CarriageError {
  Eigen::Vector3d shift_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();
};

inline Eigen::Vector3d eigen_of(const Vector3& v) { return {v[0], v[1], v[2]}; }

inline Eigen::Matrix3d full_rotation(const Eigen::Vector3d& turn_rad) {
  return (Eigen::AngleAxisd(turn_rad.z(), Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(turn_rad.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(turn_rad.x(), Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

/// Direction of a guideway: C0Y turns that of Y about Z, A0Z and B0Z turn that of Z about X and Y.
inline Eigen::Vector3d guideway(Axis a, const Vector3& squareness_rad) {
  Eigen::Vector3d straight = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(index_of(a)));
  if (a == Axis::Y) return full_rotation({0.0, 0.0, squareness_rad[0]}) * straight;
  if (a == Axis::Z) return full_rotation({squareness_rad[2], squareness_rad[1], 0.0}) * straight;
  return straight;
}

/// A rotary axis at an angle.
struct Turned {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Eigen::Vector3d pivot_mm = Eigen::Vector3d::Zero();
  CarriageError error{};
};

/// The tool point in the coordinates of the workpiece. A carriage that carries the tool goes to its coordinate and
/// turns about its own frame; one that carries the workpiece goes the other way, with the errors the other way.
/// A rotary axis turns about its own pivot, with its errors on the side that does not turn.
inline Eigen::Vector3d tool_point_mm(const std::string& chain, const Vector3& position_mm,
                                     const PerAxis<CarriageError>& errors, const Vector3& squareness_rad,
                                     const Vector3& tool_mm, const PerAxis<Turned>& turned = {}) {
  Eigen::Isometry3d workpiece = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d spindle = Eigen::Isometry3d::Identity();
  bool carries_tool = false;
  for (const char letter : chain) {
    const auto a = axis_of(letter);
    if (letter == 'T') {
      carries_tool = true;
      continue;
    }
    if (!a) {
      const Turned& joint = turned[static_cast<std::size_t>(letter - 'A')];
      const Eigen::Matrix3d turn = full_rotation(joint.error.turn_rad);
      if (carries_tool) {
        spindle.translate(joint.pivot_mm + joint.error.shift_mm).rotate(turn * joint.turn).translate(-joint.pivot_mm);
      } else {
        workpiece.translate(joint.pivot_mm).rotate(turn.transpose()).translate(-joint.error.shift_mm);
        workpiece.rotate(joint.turn.transpose()).translate(-joint.pivot_mm);
      }
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
inline Eigen::Vector3d shift_that_shows_mm(const std::string& chain, Axis a, const Vector3& place_mm,
                                           const Eigen::Vector3d& turn_rad, const Eigen::Vector3d& seen_mm) {
  PerAxis<CarriageError> turned{};
  turned[index_of(a)].turn_rad = turn_rad;
  const Eigen::Vector3d not_yet_mm =
      seen_mm - (tool_point_mm(chain, place_mm, turned, {}, {}) - tool_point_mm(chain, place_mm, {}, {}, {}));
  const bool carries_workpiece = chain.find(letter_of(a)) < chain.find('T');
  return carries_workpiece ? full_rotation(turn_rad).transpose() * not_yet_mm : not_yet_mm;
}

/// The error that a thermal row takes away, um/m.
inline double thermal_turn(const ThermalRow& row, const InputValues& inputs) {
  const double less = row.minus == kNoInput ? row.reference : inputs[row.minus].value;
  return -row.coefficient * (inputs[row.source].value - less);
}

/// Curves of a moving axis were measured on its line, along its own travel. A thermal rotation turns the carriage as it
/// stood on that line, its own coordinate included. @param sign  −1: every error negated
inline CarriageError carriage_error(const MeasuredMachine& m, const Standing& at, Axis a, double sign) {
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

/// Shift by bending at an angle, mm.
inline Eigen::Vector3d bent_mm(const std::array<double, 6>& sizes, double angle_deg) {
  const double b = angle_deg * M_PI / 180.0;
  return (Eigen::Vector3d{sizes[0], sizes[1], sizes[2]} * std::sin(b) +
          Eigen::Vector3d{sizes[3], sizes[4], sizes[5]} * (1.0 - std::cos(b))) /
         1e3;
}

/// The rotary axes with their errors. Of a head the machine bends where it carries the axis next to it, the tool where
/// the axis next to the tool begins. @param sign  0: without
inline PerAxis<Turned> turned_axes(const MeasuredMachine& m, const Standing& at, double sign, const Vector3& tool_mm) {
  PerAxis<Turned> turned;
  for (std::size_t r = 0; r < kAxes; ++r) {
    const TurningAxis& axis = m.turning[r];
    turned[r].turn = Eigen::AngleAxisd(at.angle_deg[r] * M_PI / 180.0, eigen_of(axis.direction)).toRotationMatrix();
    turned[r].pivot_mm = eigen_of(axis.pivot_mm);
    const double beyond_deg = at.angle_deg[r] - axis.curves[0][0].start_mm;
    const double around_deg = at.angle_deg[r] - 360.0 * std::floor(beyond_deg / 360.0);
    for (std::size_t s = 0; s < 6 && !axis.curves[s][0].hundredths.empty(); ++s) {
      const ShownCurve& curve = axis.curves[s][at.turned[r] == Approach::forward ? 1 : 0];
      const double error = sign * (curve.at(around_deg) + axis.location[s]);
      const auto d = static_cast<Eigen::Index>(s % 3);
      if (s < 3)
        turned[r].error.shift_mm[d] = error / 1e3;
      else
        turned[r].error.turn_rad[d] = error / 1e6;
    }
  }
  const std::size_t first = m.chain.find_first_of("ABC", m.chain.find('T'));
  if (first == std::string::npos) return turned;
  const auto tilting = static_cast<std::size_t>(m.chain[m.chain.find_last_of("ABC")] - 'A');
  turned[static_cast<std::size_t>(m.chain[first] - 'A')].error.shift_mm +=
      sign * bent_mm(m.bending.of_machine, at.angle_deg[tilting]);
  turned[tilting].error.shift_mm +=
      sign * eigen_of(tool_mm).norm() / 1e3 * bent_mm(m.bending.of_tool, at.angle_deg[tilting]);
  return turned;
}

/// Actual less target at the tool point, um, along X, Y, Z: rotary axes on the side of the workpiece turn it back.
inline Eigen::Vector3d matrix_error_um(const MeasuredMachine& m, const Standing& at, const Vector3& tool_mm,
                                       double sign = 1.0) {
  PerAxis<CarriageError> errors;
  for (const Axis a : kAllAxes) errors[index_of(a)] = carriage_error(m, at, a, sign);
  const UnitParameters& p = m.parameters;
  const double rad = sign / 1e6;
  const PerAxis<Turned> nominal = turned_axes(m, at, 0.0, tool_mm);
  const Eigen::Vector3d point_mm =
      tool_point_mm(m.chain, at.position_mm, errors, {p.C0Y_um_per_m * rad, p.B0Z_um_per_m * rad, p.A0Z_um_per_m * rad},
                    tool_mm, turned_axes(m, at, sign, tool_mm));
  Eigen::Matrix3d back = Eigen::Matrix3d::Identity();
  for (const char letter : m.chain.substr(0, m.chain.find('T')))
    if (!axis_of(letter)) back = back * nominal[static_cast<std::size_t>(letter - 'A')].turn.transpose();
  return back * (point_mm - tool_point_mm(m.chain, at.position_mm, {}, {}, tool_mm, nominal)) * 1000.0;
}

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
    MeasuredMachine m;
    m.chain = chain;
    UnitParameters& p = m.parameters;
    std::string linear;
    for (const char letter : chain)
      if (letter < 'A' || letter > 'C') linear += letter;
    set_configuration(p, linear);
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
    for (TurningAxis& axis : m.turning) axis = turning_axis(angles_um_per_m, lengths_um);
    return m;
  }
  /// Values every 10 deg of a whole turn, and location errors as large.
  TurningAxis turning_axis(double angles_um_per_m, double lengths_um) {
    TurningAxis axis{{}, vector(kLongestTool_mm), {}, {}};
    for (std::size_t s = 0; s < 6; ++s) {
      const double most = s < 3 ? lengths_um : angles_um_per_m;
      axis.location[s] = up_to(most);
      for (ShownCurve& side : axis.curves[s]) {
        side = {0.0, 10.0, std::vector<std::int16_t>(37)};
        for (std::int16_t& value : side.hundredths) value = static_cast<std::int16_t>(std::lround(100.0 * up_to(most)));
        side.hundredths.back() = side.hundredths.front();
      }
    }
    return axis;
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

/// The tables of the map that was measured: the compensation is the error negated.
inline std::vector<PlannedTable> map_of(const MeasuredMachine& m) {
  std::vector<PlannedTable> tables;
  for (std::size_t c = 0; c < kCurves; ++c)
    for (const Approach approach : {Approach::reverse, Approach::forward}) {
      const ShownCurve& curve = m.curves[c][side_of(approach)];
      PlannedTable t{static_cast<Component>(c), approach, curve.start_mm, curve.increment_mm, 0.01, {}};
      for (const std::int16_t value : curve.hundredths) t.counts.push_back(static_cast<std::int16_t>(-value));
      tables.push_back(t);
    }
  return tables;
}

/// Largest differences from the matrices, um.
struct FromMatrices {
  double whole_um = 0.0;
  double first_order_um = 0.0;   ///< from half the difference between the errors and the same negated
  double second_order_um = 0.0;  ///< of the matrices themselves
  double error_um = 0.0;
  void note(const Vector3& compensation_um, const MeasuredMachine& m, const Standing& at, const Vector3& tool_mm) {
    REQUIRE(eigen_of(compensation_um).allFinite());
    const Eigen::Vector3d error_now_um = matrix_error_um(m, at, tool_mm);
    const Eigen::Vector3d negated_um = matrix_error_um(m, at, tool_mm, -1.0);
    const auto largest = [&](double& so_far, const Eigen::Vector3d& v) {
      for (const Axis a : kAllAxes)
        if (contains(m.chain, letter_of(a)))  // no axis, no direction to correct in
          so_far = std::max(so_far, std::abs(v[static_cast<Eigen::Index>(index_of(a))]));
    };
    largest(whole_um, error_now_um + eigen_of(compensation_um));
    largest(first_order_um, (error_now_um - negated_um) / 2.0 + eigen_of(compensation_um));
    largest(second_order_um, (error_now_um + negated_um) / 2.0);
    largest(error_um, error_now_um);
  }
};

}  // namespace ecs::test
