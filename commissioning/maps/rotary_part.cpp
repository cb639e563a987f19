#include "commissioning/maps/rotary_part.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/models/work.hpp"
#include "kinematics/machine_pose.hpp"
#include "laser/map/image.hpp"
#include "laser/map/rotary_map.hpp"
#include "model/fit/compiled_rotary.hpp"

namespace ecs::commissioning {
namespace {

using kinematics::Joint;

/// Each divides a turn into numbers of cells that the core has.
constexpr std::array kIncrements_deg{10.0, 5.0, 2.5, 2.0, 1.0, 0.5, 0.25, 0.2, 0.1};
constexpr double kOtherwise_deg = 0.5;  ///< for points on none of them

bool is_multiple(double angle_deg, double of_deg) {
  const double parts = angle_deg / of_deg;
  return std::abs(parts - std::round(parts)) * of_deg < 1e-6;
}

/// Every point of every curve of the joint is a value of the table.
double increment_for(const volume::RotaryErrors& errors, Joint joint) {
  const auto fits = [&](double increment_deg) {
    return std::ranges::all_of(errors.tables, [&](const volume::RotaryTable& table) {
      return table.joint != joint ||
             std::ranges::all_of(table.p_deg, [&](double p_deg) { return is_multiple(p_deg, increment_deg); });
    });
  };
  const auto found = std::ranges::find_if(kIncrements_deg, fits);
  return found == kIncrements_deg.end() ? kOtherwise_deg : *found;
}

/// Over the travel; no values where no curve of the joint is given.
void set_curves(laser::MapRotaryAxis& axis, const volume::RotaryErrors& errors, Joint joint,
                const params::MachineRotaryAxis& facts) {
  const bool any = std::ranges::any_of(errors.tables, [&](const auto& table) { return table.joint == joint; });
  if (!any) return;
  const std::vector<double> angles_deg = model::set_table_angles(axis, facts, increment_for(errors, joint));
  for (std::size_t side = 0; side < 2; ++side)
    for (std::size_t s = 0; s < 6; ++s) {
      const volume::RotaryTable* const table =
          volume::table_of(errors, joint, static_cast<Sense>(s), side == 1 ? Approach::forward : Approach::reverse);
      for (const double angle_deg : angles_deg) {
        const double error = table == nullptr ? 0.0 : volume::value_at(*table, angle_deg);
        axis.compensation[side][s].push_back(error == 0.0 ? 0.0 : -error);
      }
    }
}

void note_change(const laser::MapRotaryAxis& axis, const volume::RotaryErrors& errors, Joint joint,
                 std::vector<std::string>& notes) {
  for (const volume::RotaryTable& table : errors.tables) {
    if (table.joint != joint) continue;
    const auto sense = static_cast<std::size_t>(table.sense);
    double largest = 0.0;
    for (std::size_t i = 0; i < table.p_deg.size(); ++i)
      if (const auto tabled =
              laser::rotary_error_at(axis, table.approach == Approach::reverse ? 0 : 1, sense, table.p_deg[i]))
        largest = std::max(largest, std::abs(table.error[i] - *tabled));
    if (largest > laser::resolution_for(table.error))
      notes.push_back(
          fmt::format("{}: its points are not spaced as the unit needs them, resampled every {} deg, "
                      "largest change {:.2f} {}",
                      volume::rotary_name(joint, table.sense), shortest(axis.increment_deg), largest,
                      is_rotation(table.sense) ? "um/m" : "um"));
  }
}

}  // namespace

Result<std::vector<laser::MapRotaryAxis>> rotary_part_of(const volume::RotaryErrors& errors,
                                                         const params::RotaryMachine& machine,
                                                         std::vector<std::string>& notes) {
  if (!params::has_rotary_axes(machine))
    return problem(
        ProblemKind::refused,
        "--rotary: expected a machine file with rotary axes: configuration = \"XYACTZ\", [axis.A], [axis.C]");
  std::vector<laser::MapRotaryAxis> axes;
  for (const char letter : machine.configuration) {
    const auto joint = kinematics::joint_of(letter);
    if (!joint || !kinematics::is_rotary(*joint)) continue;
    const std::size_t r = kinematics::index_of(*joint) - kAxes;
    const params::MachineRotaryAxis& facts = *machine.rotary[r];
    if (!facts.resolution_deg)
      return problem(ProblemKind::refused,
                     fmt::format("[axis.{}]: expected resolution_deg, the angle for each count of the encoder input of "
                                 "the unit, found none; "
                                 "a unit without an input for this angle cannot compensate the rotary axes",
                                 letter));
    laser::MapRotaryAxis& axis = axes.emplace_back(model::rotary_axis_of(letter, facts));
    axis.axis.location = errors.location[r];
    set_curves(axis, errors, *joint, facts);
    note_change(axis, errors, *joint, notes);
  }
  return axes;
}

Result<void> add_rotary(laser::MapHeader& header, const std::string& rotary_file, const std::string& machine_file,
                        std::vector<std::string>& notes) {
  if (rotary_file.empty()) return {};
  if (machine_file.empty())
    return problem(ProblemKind::usage, "--rotary needs --machine: the machine file gives the rotary axes");
  ECS_TRY(machine, params::read_rotary_machine(machine_file));
  const auto chain = params::joint_chain_of(machine);
  if (!chain) return problem(ProblemKind::refused, fmt::format("{} describes no kinematic chain", machine_file));
  ECS_TRY(errors, volume::read_rotary_errors(rotary_file, *chain));
  ECS_TRY(bytes, read_file(rotary_file));
  ECS_TRY(axes, in_file(rotary_part_of(errors, machine, notes), machine_file));
  header.rotary = std::move(axes);
  header.rotary_configuration = machine.configuration;
  header.processing.push_back(fmt::format("rotary axes from {} sha256={}",
                                          std::filesystem::path(rotary_file).filename().string(), sha256_hex(bytes)));
  return {};
}

namespace {

/// "EXC 3.00, ECC 12.50"
std::string largest_text(const laser::MapRotaryAxis& axis) {
  std::vector<std::string> parts;
  for (const laser::RotaryPart& part : laser::parts_of(axis))
    if (part.name.front() == 'E') parts.push_back(fmt::format("{} {:.2f}", part.name, part.largest));
  return parts.empty()
             ? "no curves"
             : fmt::format("largest of the curves, {} values every {} deg: {}", axis.compensation[0][0].size(),
                           shortest(axis.increment_deg), fmt::join(parts, ", "));
}

}  // namespace

Cell rotary_cell(const laser::MapHeader& header) {
  Cell list = list_cell(header.rotary, [](const laser::MapRotaryAxis& one) {
    Cell location{Json::object(), {}};
    for (std::size_t s = 0; s < 6; ++s) {
      if (one.axis.location[s] == 0.0) continue;
      const std::string name = laser::rotary_location_name(one.axis.letter, s);
      location.json[name] = number_or_null(one.axis.location[s]);
      location.text += fmt::format("{}{} {}", location.text.empty() ? "" : ", ", name, shortest(one.axis.location[s]));
    }
    if (location.text.empty()) location.text = "none";
    return record_cell("  {letter}: {deg_per_count} deg per count, location errors {location}\n     {largest}\n",
                       "letter"_is(std::string(1, one.axis.letter)),
                       "deg_per_count"_is(one.axis.deg_per_count, shortest(one.axis.deg_per_count)),
                       "location"_is(location), "start_deg"_is(Cell{number_or_null(one.start_deg), {}}),
                       "increment_deg"_is(Cell{number_or_null(one.increment_deg), {}}),
                       "values"_is(one.compensation[0][0].size()), "largest"_shown(largest_text(one)));
  });
  if (!header.rotary.empty())
    list.text = fmt::format("rotary axes ({}), um and um/m:\n", header.rotary_configuration) + list.text +
                bending_cell(header.bending).text;
  return list;
}

Cell bending_cell(const RotaryBending& bending) {
  Cell cell{{{"machine_um", bending.of_machine}, {"tool_um_per_m", bending.of_tool}}, {}};
  for (const laser::RotaryPart& part : laser::parts_of(bending))
    if (part.largest != 0.0)
      cell.text += fmt::format("{}{} {:.2f} {}", cell.text.empty() ? "  bending of the head: " : ", ", part.name,
                               part.largest, part.unit);
  if (!cell.text.empty()) cell.text += "\n";
  return cell;
}

}  // namespace ecs::commissioning
