#include "commissioning/volume/rotary_work.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "params/rotary_machine.hpp"
#include "volume/joint_volume.hpp"

namespace ecs::commissioning {

char rotary_letter(std::size_t rotary) { return kinematics::letter_of(static_cast<kinematics::Joint>(kAxes + rotary)); }

Result<void> take_rotary(const VolumeArguments& arguments, const std::string& machine_file, VolumeWork& work) {
  const auto machine = machine_file.empty() ? params::RotaryMachine{} : params::read_rotary_machine(machine_file);
  if (!machine) return tl::unexpected(machine.error());
  if (!has_rotary_axes(*machine)) {
    if (arguments.rotary.empty()) return {};
    return problem(
        ProblemKind::usage,
        "--rotary: expected a machine file with rotary axes (configuration = \"XYACTZ\", [axis.A], [axis.C])");
  }
  if (!arguments.model.empty())
    return problem(ProblemKind::refused,
                   "--model: predicts errors with the rotary axes at 0, not how the rotations of its axes act at other "
                   "angles; leave it out, or take a machine file without rotary axes");
  volume::CompensatedMachine& evaluated_machine = work.prepared.machine;
  if (evaluated_machine.parameters.convention != Convention::iso)
    return problem(ProblemKind::refused, "convention as_printed: the printed equations know no rotary axes");
  const auto chain = joint_chain_of(*machine);
  if (!chain) return problem(ProblemKind::refused, "the chain of the machine file has no axis left");
  volume::RotaryAxes rotary;
  rotary.machine.chain = *chain;
  rotary.machine.terms = kinematics::terms_of(*chain);
  for (std::size_t r = 0; r < kAxes; ++r) {
    if (!machine->rotary[r]) continue;
    rotary.machine.rotary[r] = {machine->rotary[r]->direction, machine->rotary[r]->pivot_mm};
    rotary.travel_deg[r] = machine->rotary[r]->travel_deg;
  }
  if (!arguments.rotary.empty()) {
    auto errors = volume::read_rotary_errors(arguments.rotary, *chain);
    if (!errors) return tl::unexpected(errors.error());
    rotary.errors = std::move(*errors);
  }
  rotary.angles_deg = reference_angles(rotary);
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
  if (!missing.empty())
    work.notes.push_back(fmt::format("not given: {} (--rotary); taken as without error", fmt::join(missing, ", ")));
  work.notes.emplace_back("how certain the volume is, is not stated for machines with rotary axes");
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
