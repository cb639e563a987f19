#include "volume/joint_volume.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ecs::volume {
namespace {

using kinematics::Angles;

constexpr double kWholeTurn_deg = 360.0;

Vector3 mean_at_reference(const Field& field) {
  const Vector3 a = field.at_reference(0), b = field.at_reference(1);
  return {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])};
}

Vector3 minus(const Vector3& v) { return {-v[0], -v[1], -v[2]}; }

std::vector<double> angles_over(const std::array<double, 2>& travel_deg, std::size_t count) {
  const double span = travel_deg[1] - travel_deg[0];
  const bool turns = span >= kWholeTurn_deg;
  std::vector<double> angles;
  for (std::size_t i = 0; i < count; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(turns ? count : count - 1);
    angles.push_back(travel_deg[0] + part * (turns ? kWholeTurn_deg : span));
  }
  return angles;
}

/// The rotary axis next to the tool, where one carries it: the one that tilts a head.
std::optional<kinematics::Joint> tilting_joint(const kinematics::JointChain& chain) {
  const kinematics::ChainJoint* last = nullptr;
  for (const kinematics::ChainJoint& one : chain)
    if (is_rotary(one.joint)) last = &one;
  if (last == nullptr || last->carries_workpiece) return std::nullopt;
  return last->joint;
}

/// Along X, Y, Z at that tilt. @param sizes  as in RotaryBending
Vector3 bent(const std::array<double, 6>& sizes, double tilt_deg) {
  const double tilt_rad = tilt_deg * std::numbers::pi / (kWholeTurn_deg / 2.0);
  Vector3 out{};
  for (std::size_t d = 0; d < kAxes; ++d)
    out[d] = sizes[d] * std::sin(tilt_rad) + sizes[kAxes + d] * (1.0 - std::cos(tilt_rad));
  return out;
}

}  // namespace

Vector3 along_axes(const std::array<Vector3, kAxes>& along, const Vector3& v) {
  Vector3 out{};
  for (std::size_t d = 0; d < kAxes; ++d)
    for (std::size_t l = 0; l < kAxes; ++l) out[d] += along[l][d] * v[l];
  return out;
}

std::vector<Angles> settings_over(const RotaryAxes& rotary, std::size_t on_each) {
  std::vector<Angles> settings{reference_angles(rotary)};
  for (std::size_t r = 0; r < kAxes; ++r) {
    if (!rotary.travel_deg[r]) continue;
    std::vector<Angles> more;
    for (const double angle : angles_over(*rotary.travel_deg[r], std::max<std::size_t>(2, on_each)))
      for (Angles setting : settings) {
        setting[r] = angle;
        more.push_back(setting);
      }
    settings = std::move(more);
  }
  return settings;
}

Angles reference_angles(const RotaryAxes& rotary) {
  Angles angles{};
  for (std::size_t r = 0; r < kAxes; ++r)
    if (const auto& travel = rotary.travel_deg[r]) angles[r] = std::clamp(0.0, (*travel)[0], (*travel)[1]);
  return angles;
}

ChainOver::ChainOver(kinematics::JointMachine machine, const Kinematics& linear, const Grid& grid,
                     Components components, RotaryErrors rotary, const Angles& from_deg)
    : grid_(grid), machine_(std::move(machine)), rotary_(std::move(rotary)), components_(std::move(components)) {
  machine_.lines_mm = linear.lines_mm;
  machine_.tool_offset_mm = linear.tool_offset_mm;
  at_reference_ = mean_at_reference({grid, components_, linear});
  at_zero_ = mean_at_reference(from_reference(from_deg));
}

Field ChainOver::at(const Angles& angles_deg) const {
  Field field = from_reference(angles_deg);
  field.shift(minus(at_zero_));
  return field;
}

Field ChainOver::from_reference(const Angles& angles_deg) const {
  const kinematics::MachinePose pose = pose_at(machine_, angles_deg);
  std::array<kinematics::JointValues, 2> rotary;
  for (std::size_t side = 0; side < kSides.size(); ++side)
    rotary[side] = rotary_values(rotary_, angles_deg, kSides[side]);
  Vector3 of_machine{};
  if (const auto tilting = tilting_joint(machine_.chain)) {
    constexpr double kMmPerM = 1000.0;
    const Vector3& tool_mm = machine_.tool_offset_mm;
    const double tilt_deg = angles_deg[index_of(*tilting) - kAxes],
                 length_m = std::hypot(tool_mm[0], tool_mm[1], tool_mm[2]) / kMmPerM;
    const Vector3 of_tool = bent(rotary_.bending.of_tool, tilt_deg);
    for (auto& side : rotary)
      for (std::size_t d = 0; d < kAxes; ++d) side.curve[index_of(*tilting)][d] += length_m * of_tool[d];
    of_machine = bent(rotary_.bending.of_machine, tilt_deg);
  }
  Field field(grid_, components_, pose, rotary);
  field.shift(along_axes(pose.along, of_machine));
  field.shift(minus(along_axes(pose.along, at_reference_)));
  return field;
}

JointVolume JointVolume::of(const CompensatedMachine& machine, const Grid& grid, Components components,
                            RotaryErrors rotary) {
  kinematics::JointMachine chain = machine.rotary->machine;
  chain.curves = machine.errors.curves;
  return JointVolume({std::move(chain), machine.errors.kinematics, grid, std::move(components), std::move(rotary),
                      reference_angles(*machine.rotary)});
}

Result<JointVolume> JointVolume::over(const CompensatedMachine& machine, const Grid& grid) {
  ECS_TRY(components, machine.errors.components(grid));
  JointVolume over = of(machine, grid, std::move(components), machine.rotary->errors);
  if (machine.map.header.rotary.empty()) {
    over.linear_.emplace(compensation_over(machine, grid));
    over.linear_->count_from_reference();
    return over;
  }
  kinematics::JointMachine chain = machine.rotary->machine;
  for (const laser::MapRotaryAxis& one : machine.map.header.rotary)
    chain.rotary[index_of(*kinematics::joint_of(one.axis.letter)) - kAxes] = {one.axis.direction, one.axis.pivot_mm};
  chain.curves = CurveKind::measured;
  const UnitParameters& unit = machine.parameters;
  over.whole_.emplace(std::move(chain),
                      Kinematics{terms_of_machine(unit, unit.convention, CurveKind::measured),
                                 unit.measurement_lines_mm, unit.tool_offset_mm},
                      grid, compensation_in(machine.map, unit, grid), rotary_errors_in(machine.map.header, -1.0),
                      reference_angles(*machine.rotary));
  return over;
}

BeforeAfter JointVolume::at(const Angles& angles_deg) const {
  BeforeAfter out;
  out.before.field.emplace(errors_.at(angles_deg));
  out.after.field.emplace(whole_ ? whole_->at(angles_deg)
                                 : linear_->along(pose_at(errors_.machine(), angles_deg).along));
  out.after.field->add(*out.before.field);
  return out;
}

std::array<Vector3, 2> ChainOver::orientation_at(const Angles& angles_deg) const {
  const kinematics::MachinePose pose = pose_at(machine_, angles_deg);
  std::array<Vector3, 2> out{};
  for (std::size_t side = 0; side < kSides.size(); ++side) {
    kinematics::JointValues values = rotary_values(rotary_, angles_deg, kSides[side]);
    for (std::size_t c = 0; c < kCurves; ++c)
      if (const auto& curve = components_.curve[side][c]; !curve.empty())
        values.curve[c / kSenseNames.size()][c % kSenseNames.size()] = curve.front();
    out[side] = tool_error(pose, values, grid_.at({})).orientation_um_per_m;
  }
  return out;
}

Result<VolumeAnswer> evaluated_with_rotary(const CompensatedMachine& machine, std::size_t places) {
  const RotaryAxes& rotary = *machine.rotary;
  const auto axes_of = [](const auto& list) {
    return static_cast<std::size_t>(std::ranges::count_if(list, [](const auto& one) { return one.has_value(); }));
  };
  const std::size_t axes = axes_of(machine.travel_mm) + axes_of(rotary.travel_deg);
  const double root = std::pow(static_cast<double>(places), 1.0 / static_cast<double>(axes));
  const Vector3 reference_mm = reference_of(machine.parameters);
  VolumeAnswer answer;
  answer.settings = settings_over(rotary, static_cast<std::size_t>(root + 1e-9));
  answer.grid = grid_over(machine.travel_mm, std::max<std::size_t>(1, places / answer.settings.size()), reference_mm);
  ECS_TRY(over, JointVolume::over(machine, answer.grid));
  const Grid diagonals = even_grid(machine.travel_mm, kDiagonalPlaces, reference_mm);
  ECS_TRY(on_diagonals, JointVolume::over(machine, diagonals));
  VolumeCounter before(answer.settings.size() * answer.grid.places()),
      after(answer.settings.size() * answer.grid.places());
  for (const Angles& setting : answer.settings) {
    const BeforeAfter here = over.at(setting), along = on_diagonals.at(setting);
    before.take(answer.grid, here.before, diagonals, along.before);
    after.take(answer.grid, here.after, diagonals, along.after);
  }
  answer.before = before.finish();
  answer.after = after.finish();
  answer.errors = over.at(answer.settings[answer.before.all.setting]);
  return answer;
}

}  // namespace ecs::volume
