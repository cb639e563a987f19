#include "kinematics/machine_pose.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ecs::kinematics {

std::optional<std::string> fault_of(std::string_view configuration) {
  for (const char letter : configuration)
    if (letter != 'T' && !joint_of(letter))
      return "the letter T and letters of X, Y, Z, A, B, C, each once, such as \"XYACTZ\"";
  if (std::ranges::count(configuration, 'T') != 1)
    return "exactly one T: letters before it are on the workpiece side, letters after it on the tool side";
  std::size_t linear = 0, rotary = 0;
  for (std::size_t i = 0; i < configuration.size(); ++i) {
    const auto joint = joint_of(configuration[i]);
    if (!joint) continue;
    if (configuration.find(configuration[i], i + 1) != std::string_view::npos) return "each letter once";
    ++(is_rotary(*joint) ? rotary : linear);
  }
  if (rotary > kMostRotary) return "at most two rotary axes of A, B, C";
  if (linear == 0) return "at least one linear axis of X, Y, Z";
  return std::nullopt;
}

std::optional<JointChain> joint_chain_of(std::string_view configuration) {
  if (fault_of(configuration)) return std::nullopt;
  JointChain chain;
  const std::size_t tool = configuration.find('T');
  for (std::size_t i = tool; i-- > 0;) chain.joints[chain.count++] = {*joint_of(configuration[i]), true};
  for (const char letter : configuration.substr(tool + 1)) chain.joints[chain.count++] = {*joint_of(letter), false};
  return chain;
}

std::string linear_configuration(std::string_view configuration) {
  std::string letters;
  for (const char letter : configuration)
    if (const auto joint = joint_of(letter); !joint || !is_rotary(*joint)) letters += letter;
  return letters;
}

std::string iso_notation(const JointChain& chain) {
  std::string text = "w";
  bool before_bed = true;
  for (const ChainJoint& one : chain) {
    if (before_bed && !one.carries_workpiece) {
      text += " b";
      before_bed = false;
    }
    text += ' ';
    text += letter_of(one.joint);
    if (one.carries_workpiece) text += '\'';
  }
  return text + (before_bed ? " b t" : " t");
}

namespace {

void add_translations(JointTable& table, Joint moving) {
  for (const Axis direction : kAllAxes)
    table.rows[table.count++] = {direction, moving, static_cast<Sense>(direction), false, Axis::X, 1};
}

/// ε × L: (ε × L)_{i+1} = −ε_i L_{i+2}, (ε × L)_{i+2} = ε_i L_{i+1}.
void add_rotations(JointTable& table, Joint moving) {
  for (const Sense sense : {Sense::EA, Sense::EB, Sense::EC}) {
    const std::size_t about = ecs::index_of(ecs::direction_of(sense));
    for (const Axis observed : kAllAxes) {
      const std::size_t o = ecs::index_of(observed);
      if (o == about) continue;
      const auto lever = static_cast<Axis>(3 - about - o);
      const auto sign = static_cast<std::int8_t>(o == (about + 1) % kAxes ? -1 : 1);
      table.rows[table.count++] = {observed, moving, sense, true, lever, sign};
    }
  }
}

std::size_t place_of(const JointChain& chain, Joint joint) {
  std::size_t place = 0;
  while (place < chain.count && chain.joints[place].joint != joint) ++place;
  return place;
}

}  // namespace

JointTable terms_of(const JointChain& chain) {
  JointTable table;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const auto joint = static_cast<Joint>(j);
    if (!chain.has(joint)) continue;
    add_translations(table, joint);
    add_rotations(table, joint);
  }
  for (const SquarenessTerm& term :
       {SquarenessTerm{Axis::X, Component::C0Y, Axis::Y, -1}, SquarenessTerm{Axis::X, Component::B0Z, Axis::Z, 1},
        SquarenessTerm{Axis::Y, Component::A0Z, Axis::Z, -1}})
    if (chain.has(joint_of(term.observed)) && chain.has(joint_of(term.lever)))
      table.squareness[table.squareness_count++] = term;
  return table;
}

bool is_beyond(const JointChain& chain, Joint b, Joint other, CurveKind curves) {
  const std::size_t place_b = place_of(chain, b), place_other = place_of(chain, other);
  if (place_b == chain.count || place_other == chain.count) return false;
  if (place_b != place_other) return place_other > place_b;
  const bool workpiece = chain.joints[place_b].carries_workpiece;
  return is_rotary(b) ? !workpiece : workpiece && curves == CurveKind::carriage;
}

namespace {

using Frame = std::array<Vector3, kAxes>;  ///< by column: where X, Y, Z of a joint point in the frame of the workpiece

constexpr Frame kStraight{{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
constexpr double kMmOfMetre = 1000.0;

Vector3 sum_of(const Vector3& a, double factor, const Vector3& b) {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}

const RotaryGeometry& geometry_of(const JointMachine& machine, Joint joint) {
  return machine.rotary[index_of(joint) - kAxes];
}

/// N_j in front of a point that follows it.
AffineVector moved(const JointMachine& machine, Joint joint, const Angles& angles_deg, AffineVector point) {
  if (!is_rotary(joint)) {
    point.slope[index_of(joint)][index_of(joint)] += 1.0;
    return point;
  }
  const RotaryGeometry& axis = geometry_of(machine, joint);
  const double angle_deg = angles_deg[index_of(joint) - kAxes];
  point.at_0 = sum_of(turned(sum_of(point.at_0, -1.0, axis.pivot_mm), axis.direction, angle_deg), 1.0, axis.pivot_mm);
  for (Vector3& slope : point.slope) slope = turned(slope, axis.direction, angle_deg);
  return point;
}

/// r_b: the measurement line in the directions of its levers, or the pivot.
Vector3 referred_to(const JointMachine& machine, Joint b) {
  if (is_rotary(b)) return geometry_of(machine, b).pivot_mm;
  Vector3 line_mm{};
  for (const Axis lever : kAllAxes)
    if (is_beyond(machine.chain, b, joint_of(lever), machine.curves))
      line_mm[ecs::index_of(lever)] = machine.lines_mm[index_of(b)][ecs::index_of(lever)];
  return line_mm;
}

void add_row(MachinePose& pose, const JointTerm& row, const Frame& frame, const AffineVector& lever) {
  Gain& gain = pose.gain[index_of(row.moving)][static_cast<std::size_t>(row.sense)];
  const Vector3& along = frame[ecs::index_of(row.observed)];
  if (!row.has_lever) {
    gain.at_0 = sum_of(gain.at_0, row.sign, along);
    return;
  }
  const std::size_t l = ecs::index_of(row.lever);
  const double sign = row.sign / kMmOfMetre;
  gain.at_0 = sum_of(gain.at_0, sign * lever.at_0[l], along);
  for (std::size_t p = 0; p < kAxes; ++p) gain.slope[p] = sum_of(gain.slope[p], sign * lever.slope[p][l], along);
}

}  // namespace

Vector3 turned(const Vector3& v, const Vector3& n, double angle_deg) {
  const double angle = angle_deg * std::numbers::pi / 180.0, c = std::cos(angle), s = std::sin(angle);
  const double along = (1.0 - c) * (n[0] * v[0] + n[1] * v[1] + n[2] * v[2]);
  return {c * v[0] + s * (n[1] * v[2] - n[2] * v[1]) + along * n[0],
          c * v[1] + s * (n[2] * v[0] - n[0] * v[2]) + along * n[1],
          c * v[2] + s * (n[0] * v[1] - n[1] * v[0]) + along * n[2]};
}

Vector3 AffineVector::at(const Vector3& position_mm) const {
  Vector3 sum = at_0;
  for (std::size_t l = 0; l < kAxes; ++l) sum = sum_of(sum, position_mm[l], slope[l]);
  return sum;
}

MachinePose pose_at(const JointMachine& machine, const Angles& angles_deg) {
  MachinePose pose;
  PerJoint<Frame> frame{};
  PerJoint<AffineVector> lever{};
  Frame before = kStraight;
  bool before_bed = true;
  for (const ChainJoint& one : machine.chain) {
    if (before_bed && !one.carries_workpiece) pose.bed = before;
    before_bed = before_bed && one.carries_workpiece;
    Frame after = before;
    if (is_rotary(one.joint)) {
      const RotaryGeometry& axis = geometry_of(machine, one.joint);
      for (std::size_t d = 0; d < kAxes; ++d) {
        const Vector3 column = turned(kStraight[d], axis.direction, angles_deg[index_of(one.joint) - kAxes]);
        after[d] = {};
        for (std::size_t i = 0; i < kAxes; ++i) after[d] = sum_of(after[d], column[i], before[i]);
      }
    }
    frame[index_of(one.joint)] = is_rotary(one.joint) && one.carries_workpiece ? after : before;
    before = after;
  }
  if (before_bed) pose.bed = before;
  pose.tool = before;
  AffineVector point{machine.tool_offset_mm, {}};
  for (std::size_t i = machine.chain.count; i-- > 0;) {
    const Joint joint = machine.chain.joints[i].joint;
    AffineVector with_own = moved(machine, joint, angles_deg, point);
    AffineVector& arm = lever[index_of(joint)];
    arm = is_beyond(machine.chain, joint, joint, machine.curves) ? with_own : point;
    arm.at_0 = sum_of(arm.at_0, -1.0, referred_to(machine, joint));
    point = with_own;
  }
  pose.tool_mm = point;
  for (std::size_t i = 0; i < machine.terms.count; ++i) {
    const JointTerm& row = machine.terms.rows[i];
    add_row(pose, row, frame[index_of(row.moving)], lever[index_of(row.moving)]);
  }
  for (std::size_t i = 0; i < machine.terms.squareness_count; ++i) {
    const SquarenessTerm& row = machine.terms.squareness[i];
    const std::size_t l = ecs::index_of(row.lever);
    Vector3& slope = pose.squareness[ecs::index_of(row.component) - kCurves].slope[l];
    slope = sum_of(slope, row.sign / kMmOfMetre, frame[l][ecs::index_of(row.observed)]);
  }
  for (const ChainJoint& one : machine.chain) {
    const std::size_t j = index_of(one.joint);
    pose.about[j] = frame[j];
    if (!is_rotary(one.joint)) pose.along[j] = frame[j][j];
  }
  return pose;
}

ToolError tool_error(const MachinePose& pose, const JointValues& values, const Vector3& position_mm) {
  ToolError out;
  const auto add = [&](const Gain& gain, double value) {
    out.error_um = sum_of(out.error_um, value, gain.at_0);
    for (std::size_t l = 0; l < kAxes; ++l) out.error_um = sum_of(out.error_um, value * position_mm[l], gain.slope[l]);
  };
  for (std::size_t j = 0; j < kJoints; ++j)
    for (std::size_t s = 0; s < values.curve[j].size(); ++s) {
      add(pose.gain[j][s], values.curve[j][s]);
      if (s >= kAxes)
        out.orientation_um_per_m = sum_of(out.orientation_um_per_m, values.curve[j][s], pose.about[j][s - kAxes]);
    }
  for (std::size_t q = 0; q < pose.squareness.size(); ++q) add(pose.squareness[q], values.squareness[kCurves + q]);
  return out;
}

}  // namespace ecs::kinematics
