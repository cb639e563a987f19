#include "commissioning/volume/rotary_work.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "commissioning/volume/true_errors.hpp"
#include "model/fit/compiled_model.hpp"
#include "params/machine.hpp"
#include "volume/joint_volume.hpp"

namespace ecs::commissioning {

namespace {

/// The errors that a model has along each axis, as components: at other angles its rotations act elsewhere.
volume::ErrorSource components_of_model(const model::CompiledModel& compiled, const UnitParameters& parameters,
                                        const params::Machine& machine, const Vector3& tool_offset_mm) {
  volume::ErrorSource source;
  source.components = [map = compiled.map, squareness = compiled.squareness, parameters](const volume::Grid& grid) {
    volume::Components components = errors_in(map, parameters, grid);
    components.squareness = squareness;
    return Result<volume::Components>(std::move(components));
  };
  source.kinematics = {volume::terms_of_machine(parameters, Convention::iso, CurveKind::carriage),
                       params::measurement_lines_of(machine), tool_offset_mm};
  source.curves = CurveKind::carriage;
  return source;
}

/// A model in place of the map's errors, on a machine with rotary axes.
Result<void> take_model(const model::Model& model, const params::Machine& machine, VolumeWork& work) {
  constexpr double kIncrement_mm = 1.0, kMostPoints = 5000.0;
  double increment_mm = kIncrement_mm;
  for (const auto& axis : machine.axes)
    if (axis) increment_mm = std::max(increment_mm, (axis->travel_mm[1] - axis->travel_mm[0]) / kMostPoints);
  ECS_TRY(compiled, model::compiled(model, machine, increment_mm));
  volume::CompensatedMachine& evaluated_machine = work.prepared.machine;
  evaluated_machine.errors =
      components_of_model(compiled, evaluated_machine.parameters, machine, evaluated_machine.tool_offset_mm);
  for (const std::string& left_out : compiled.not_carried)
    work.notes.push_back(fmt::format("left out of the volume: {}", left_out));
  return {};
}

}  // namespace

char rotary_letter(std::size_t rotary) { return kinematics::letter_of(static_cast<kinematics::Joint>(kAxes + rotary)); }

Result<void> take_rotary(const VolumeArguments& arguments, const std::string& machine_file,
                         const std::optional<model::Model>& model, volume::CompensatedMachine& expected,
                         VolumeWork& work) {
  ECS_TRY(machine, machine_file.empty() ? params::RotaryMachine{} : params::read_rotary_machine(machine_file));
  if (!has_rotary_axes(machine)) {
    if (arguments.rotary.empty()) return {};
    return problem(
        ProblemKind::usage,
        "--rotary: expected a machine file with rotary axes (configuration = \"XYACTZ\", [axis.A], [axis.C])");
  }
  volume::CompensatedMachine& evaluated_machine = work.prepared.machine;
  if (evaluated_machine.parameters.convention != Convention::iso)
    return problem(ProblemKind::refused, "convention as_printed: the printed equations know no rotary axes");
  const auto joints = params::joint_machine_of(machine.machine);
  if (!joints) return problem(ProblemKind::refused, "the chain of the machine file has no axis left");
  if (model) {
    ECS_DO(take_model(*model, machine.machine, work));
    expected.errors = evaluated_machine.errors;
  }
  volume::RotaryAxes rotary;
  rotary.machine = *joints;
  for (std::size_t r = 0; r < kAxes; ++r)
    if (const auto& axis = machine.rotary[r]) rotary.travel_deg[r] = axis->travel_deg;
  if (!arguments.rotary.empty()) {
    ECS_TRY(errors, volume::read_rotary_errors(arguments.rotary, rotary.machine.chain));
    rotary.errors = std::move(errors);
  }
  rotary.angles_deg = reference_angles(rotary);
  expected.rotary = rotary;
  if (!arguments.errors.empty()) {
    ECS_TRY(errors, true_rotary_errors(arguments.errors, machine_file, rotary));
    rotary.errors = std::move(errors);
    work.true_rotary = true;
  }
  evaluated_machine.rotary = std::move(rotary);
  return {};
}

void note_rotary(VolumeWork& work) {
  const auto& rotary = work.prepared.machine.rotary;
  if (!rotary) return;
  work.notes.push_back(
      "the unit compensates X, Y and Z as with the rotary axes at 0: errors of the rotary axes, and what rotations of "
      "linear axes do through them, remain");
  std::vector<std::string> missing;
  for (const kinematics::ChainJoint& one : rotary->machine.chain) {
    if (!is_rotary(one.joint)) continue;
    for (std::size_t s = 0; s < kSenseNames.size(); ++s)
      if (table_of(rotary->errors, one.joint, static_cast<Sense>(s), Approach::forward) == nullptr)
        missing.push_back(volume::rotary_name(one.joint, static_cast<Sense>(s)));
  }
  if (!missing.empty() && !work.true_rotary)
    work.notes.push_back(
        fmt::format("not given: {} (--rotary); taken as without error, with a standard uncertainty of "
                    "{:g} um or um/m (--zero-uncertainty)",
                    fmt::join(missing, ", "), work.settings.declared_zero));
  std::vector<std::string> unstated;
  for (const kinematics::ChainJoint& one : rotary->machine.chain) {
    if (!is_rotary(one.joint)) continue;
    const std::size_t r = index_of(one.joint) - kAxes;
    for (std::size_t s = 0; s < kSenseNames.size(); ++s)
      if (work.rotary_budget.location[r][s] > 0.0 && !rotary->errors.location_u[r][s])
        unstated.push_back(volume::location_name(r, s));
  }
  if (!unstated.empty() && !work.true_rotary)
    work.notes.push_back(fmt::format(
        "{}: no standard uncertainty is given (column u); {:g} um or um/m is taken, as of what is not given "
        "(--zero-uncertainty)",
        fmt::join(unstated, ", "), work.settings.declared_zero));
}

std::string rotary_in_words(const VolumeWork& work) {
  const auto& rotary = work.prepared.machine.rotary;
  if (!rotary) return "";
  std::vector<std::string> travels, angles;
  for (std::size_t r = 0; r < kAxes; ++r)
    if (const auto& travel = rotary->travel_deg[r]) {
      travels.push_back(fmt::format("{} {} … {}", rotary_letter(r), shortest((*travel)[0]), shortest((*travel)[1])));
      angles.push_back(fmt::format("{} {:.4g}", rotary_letter(r), rotary->angles_deg[r]));
    }
  return fmt::format("rotary axes {} deg, {} settings; the largest error before, slice and picture at {} deg ({})",
                     fmt::join(travels, ", "), work.answer.settings.size(), fmt::join(angles, ", "),
                     kinematics::iso_notation(rotary->machine.chain));
}

}  // namespace ecs::commissioning
