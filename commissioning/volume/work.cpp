#include "commissioning/volume/work.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "commissioning/maps/export_source.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/volume/true_errors.hpp"
#include "laser/map/csv.hpp"
#include "params/rotary_machine.hpp"
#include "volume/joint_volume.hpp"

namespace ecs::commissioning {
namespace {

bool knows(const model::Model& model, Component component) {
  return std::any_of(model.effects.begin(), model.effects.end(), [&](const model::EffectInstance& effect) {
    if (effect.code || is_squareness(component)) return effect.code == component;
    return effect.sense == sense_of(component) && (!effect.axis || *effect.axis == moving_axis(component));
  });
}

/// What is compensated, yet has no effect in the model: there it would predict what the compensation adds.
std::vector<std::string> unknown_to(const model::Model& model, const volume::CompensatedMachine& machine) {
  std::vector<std::string> names;
  const auto add = [&](Component component) {
    const std::string name(name_of(component));
    if (!knows(model, component) && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const laser::MapTable& table : machine.map.tables)
    if (std::any_of(table.compensation.begin(), table.compensation.end(), [](double value) { return value != 0.0; }))
      add(table.component);
  for (const Component square : {Component::C0Y, Component::B0Z, Component::A0Z})
    if (squareness_um_per_m(machine.parameters, square) != 0.0) add(square);
  return names;
}

volume::ErrorSource source_of_model(const model::Model& model, const params::Machine& machine) {
  volume::ErrorSource source;
  source.vectors = [errors =
                        errors_of_model(model, machine, "the error model")](const std::vector<volume::Place>& places) {
    std::vector<controllers::MachinePlace> asked;
    asked.reserve(places.size());
    for (const volume::Place& place : places) {
      const Approach side = volume::kSides[place.side];
      asked.push_back({place.position_mm, {side, side, side}});
    }
    return errors(asked);
  };
  return source;
}

Result<Vector3> coordinates_in(const std::string& text, std::string_view option) {
  const auto words = split(text, ',');
  Vector3 place{};
  for (std::size_t a = 0; a < kAxes && words.size() == kAxes; ++a) {
    const auto number = number_in(words[a]);
    if (!number) break;
    place[a] = *number;
    if (a + 1 == kAxes) return place;
  }
  return problem(ProblemKind::usage,
                 fmt::format("{}: expected three numbers X,Y,Z in mm, such as -100,0,-250, got \"{}\"", option, text));
}

/// The machine file to take: the one given, else machine.toml beside the parameters.
std::string machine_file_for(const VolumeArguments& arguments) {
  if (!arguments.machine.empty()) return arguments.machine;
  const auto beside = std::filesystem::path(arguments.params).parent_path() / "machine.toml";
  std::error_code error;
  return std::filesystem::exists(beside, error) ? beside.string() : std::string();
}

/// One that lies there by chance is not taken.
bool is_of(const params::Machine& machine, const UnitParameters& parameters, const laser::MapHeader& header) {
  return machine.configuration == configuration_of(parameters) &&
         (header.machine.empty() || machine.name.empty() || header.machine == machine.name);
}

Result<Vector3> tool_of(const VolumeArguments& arguments, const UnitParameters& parameters) {
  if (arguments.tool_length_mm && !arguments.tool_offset.empty())
    return problem(ProblemKind::usage, "expected --tool-length or --tool-offset, got both");
  if (!arguments.tool_offset.empty()) return coordinates_in(arguments.tool_offset, "--tool-offset");
  if (arguments.tool_length_mm) return Vector3{0.0, 0.0, -*arguments.tool_length_mm};
  return parameters.tool_offset_mm;
}

Result<void> take_errors(const VolumeArguments& arguments, const std::string& machine_file,
                         const std::optional<params::Machine>& machine, VolumeWork& work) {
  if (arguments.errors.empty()) {
    if (work.prepared.remark.empty()) return {};
    return tl::unexpected(Problem{ProblemKind::refused, work.prepared.remark, arguments.model, 0, 0, {}});
  }
  auto errors = true_errors(arguments.errors, machine ? machine_file : std::string(), work.prepared.machine);
  if (!errors) return tl::unexpected(errors.error());
  work.prepared.machine.errors = std::move(*errors);
  work.prepared.errors_from = "the errors file";
  return {};
}

/// Needed components that the map lacks.
void note_missing(VolumeWork& work) {
  const laser::ErrorMap& map = work.prepared.machine.map;
  std::vector<std::string> zero, missing;
  for (const volume::CurveUncertainty& u : work.budget.curves) {
    if (u.unmeasured == 0.0) continue;
    const bool declared = std::any_of(map.header.declared_zero.begin(), map.header.declared_zero.end(),
                                      [&](const laser::DeclaredZero& z) { return z.component == u.component; });
    (declared ? zero : missing).emplace_back(name_of(u.component));
  }
  if (!missing.empty())
    work.notes.push_back(
        fmt::format("{} {} neither in the map nor declared zero: taken as zero, the volume is "
                    "incomplete",
                    fmt::join(missing, ", "), missing.size() == 1 ? "is" : "are"));
  if (!zero.empty())
    work.notes.push_back(fmt::format("{} {} declared zero: standard uncertainty {:g} um or um/m (--zero-uncertainty)",
                                     fmt::join(zero, ", "), zero.size() == 1 ? "is" : "are",
                                     work.settings.declared_zero));
}

/// Of the linear variance, by component.
void share_out(VolumeWork& work) {
  constexpr std::size_t kPlaces = 64;
  const volume::CompensatedMachine& machine = work.prepared.machine;
  const volume::Grid grid = volume::grid_over(machine.travel_mm, kPlaces, volume::reference_of(machine.parameters));
  double sum = 0.0;
  const auto add = [&](Component component, const volume::UncertaintyBudget& alone) {
    const double rms = linear_rms_um(machine, alone, grid);
    if (rms > 0.0) work.shares.push_back({component, rms * rms});
    sum += rms * rms;
  };
  for (std::size_t c = 0; c < kComponents; ++c) {
    volume::UncertaintyBudget alone;
    if (c < kCurves)
      alone.curves[c] = work.budget.curves[c];
    else
      alone.squareness_um_per_m[c] = work.budget.squareness_um_per_m[c];
    add(static_cast<Component>(c), alone);
  }
  for (ComponentShare& one : work.shares) one.share /= sum;
  std::sort(work.shares.begin(), work.shares.end(), [](const auto& a, const auto& b) { return a.share > b.share; });
}

char rotary_letter(std::size_t rotary) { return kinematics::letter_of(static_cast<kinematics::Joint>(kAxes + rotary)); }

/// X, Y, Z and behind them the angles of the rotary axes in the order A, B, C; without those: their reference.
Result<std::pair<Vector3, kinematics::Angles>> place_in(const std::string& text,
                                                        const std::optional<volume::RotaryAxes>& rotary) {
  if (!rotary || std::count(text.begin(), text.end(), ',') < static_cast<std::ptrdiff_t>(kAxes)) {
    const auto place = coordinates_in(text, "--at");
    if (!place) return tl::unexpected(place.error());
    return std::pair{*place, rotary ? reference_angles(*rotary) : kinematics::Angles{}};
  }
  std::vector<std::string> names{"X", "Y", "Z"};
  std::vector<double> numbers;
  for (const std::string_view word : split(text, ','))
    if (const auto number = number_in(word)) numbers.push_back(*number);
  for (std::size_t r = 0; r < kAxes; ++r)
    if (rotary->travel_deg[r]) names.emplace_back(1, rotary_letter(r));
  if (numbers.size() != names.size() || split(text, ',').size() != names.size())
    return problem(ProblemKind::usage, fmt::format("--at: expected {} numbers {} in mm and deg, got \"{}\"",
                                                   names.size(), fmt::join(names, ","), text));
  std::pair<Vector3, kinematics::Angles> place{{numbers[0], numbers[1], numbers[2]}, {}};
  std::size_t next = kAxes;
  for (std::size_t r = 0; r < kAxes; ++r) {
    const auto& travel = rotary->travel_deg[r];
    if (!travel) continue;
    place.second[r] = numbers[next++];
    if (place.second[r] < (*travel)[0] || place.second[r] > (*travel)[1])
      return problem(ProblemKind::usage, fmt::format("--at: expected {} within {} … {} deg, got {}", rotary_letter(r),
                                                     (*travel)[0], (*travel)[1], place.second[r]));
  }
  return place;
}

Result<void> look_at(const std::string& text, VolumeWork& work) {
  volume::CompensatedMachine machine = work.prepared.machine;
  const auto asked = place_in(text, machine.rotary);
  if (!asked) return tl::unexpected(asked.error());
  const auto& [place, angles_deg] = *asked;
  for (const Axis axis : kAllAxes)
    if (const auto& travel = machine.travel_mm[index_of(axis)];
        travel && (place[index_of(axis)] < (*travel)[0] || place[index_of(axis)] > (*travel)[1]))
      return problem(ProblemKind::usage, fmt::format("--at: expected {} within {} … {} mm, got {}", letter_of(axis),
                                                     (*travel)[0], (*travel)[1], place[index_of(axis)]));
  if (machine.rotary) machine.rotary->angles_deg = angles_deg;
  const volume::Grid grid = volume::grid_at(machine.travel_mm, place, volume::reference_of(machine.parameters));
  const auto errors = errors_over(machine, grid);
  if (!errors) return tl::unexpected(errors.error());
  PlaceAnswer answer;
  answer.position_mm = grid.at({});
  answer.angles_deg = angles_deg;
  for (std::size_t side = 0; side < volume::kSides.size(); ++side) {
    answer.before_um[side] = errors->before.at(grid, side, {});
    answer.after_um[side] = errors->after.at(grid, side, {});
  }
  if (machine.rotary) {
    const auto here = volume::JointVolume::over(machine, grid);
    if (!here) return tl::unexpected(here.error());
    answer.orientation_um_per_m = here->orientation_at(angles_deg);
    answer.standard_uncertainty_um.fill(std::numeric_limits<double>::quiet_NaN());
  } else {
    const volume::Covariance covariance =
        covariance_at(machine, work.budget, answer.position_mm, volume::kSides.size() - 1);
    for (std::size_t d = 0; d < kAxes; ++d) answer.standard_uncertainty_um[d] = std::sqrt(covariance[d][d]);
  }
  work.at = answer;
  return {};
}

/// The rotary axes of the machine file and their errors.
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

/// Error motions that nobody gave.
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

Result<void> cut(const std::string& plane, VolumeWork& work) {
  constexpr std::size_t kColumns = 9, kRows = 5;
  const volume::CompensatedMachine& machine = work.prepared.machine;
  const bool longest = plane == kLongestPlane;
  if (longest && work.answer.grid.axes() < 2) return {};
  const auto named = [&](std::size_t k) {
    if (longest) return std::optional(static_cast<Axis>(longest_plane(machine)[k]));
    return plane.size() == 2 ? axis_of(plane[k]) : std::nullopt;
  };
  const auto across = named(0), up = named(1);
  const auto exists = [&](const std::optional<Axis>& axis) {
    return axis && machine.travel_mm[index_of(*axis)].has_value();
  };
  if (!exists(across) || !exists(up) || across == up)
    return problem(ProblemKind::usage,
                   fmt::format("--slice: expected two axes of the machine, such as XY, got \"{}\"", plane));
  auto slice = slice_of(machine, work.answer.before.all.at_mm, index_of(*across), index_of(*up), kColumns, kRows);
  if (!slice) return tl::unexpected(slice.error());
  work.slice = std::move(*slice);
  return {};
}

Result<void> check_travels(const VolumeWork& work) {
  const volume::CompensatedMachine& machine = work.prepared.machine;
  for (const Axis axis : kAllAxes)
    if (machine.parameters.axis_present[index_of(axis)] && !machine.travel_mm[index_of(axis)])
      return problem(ProblemKind::refused, fmt::format("the travel of {} is not known: the map has no table of {}; "
                                                       "give the machine file with --machine",
                                                       letter_of(axis), letter_of(axis)));
  return {};
}

}  // namespace

PreparedVolume prepared_volume(const laser::ErrorMap& map, const UnitParameters& parameters,
                               const std::optional<params::Machine>& machine, const model::Model* model) {
  PreparedVolume out;
  out.machine = {map,
                 parameters,
                 travels_for(map, parameters, machine),
                 parameters.tool_offset_mm,
                 volume::errors_of_map(map, parameters, parameters.tool_offset_mm),
                 {}};
  out.errors_from = "the map";
  out.travels_of_machine = machine.has_value();
  if (model == nullptr) return out;
  if (!machine) {
    out.remark = "The error model was not used: it counts from the datum of the axes, and no machine file was given.";
    return out;
  }
  if (const auto lacking = unknown_to(*model, out.machine); !lacking.empty()) {
    out.remark = fmt::format("The error model was not used: it has no effect for {}, which {} compensated.",
                             fmt::join(lacking, ", "), lacking.size() == 1 ? "is" : "are");
    return out;
  }
  out.errors_from = "the error model";
  out.machine.errors = source_of_model(*model, *machine);
  return out;
}

std::array<std::size_t, 2> longest_plane(const volume::CompensatedMachine& machine) {
  const auto length = [&](std::size_t a) {
    const auto& travel = machine.travel_mm[a];
    return travel ? (*travel)[1] - (*travel)[0] : 0.0;
  };
  std::array<std::size_t, kAxes> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return length(a) > length(b); });
  return {std::min(order[0], order[1]), std::max(order[0], order[1])};
}

Vector3 mean_error(const volume::Grid& grid, const volume::VolumeError& error, const volume::GridIndex& index) {
  const Vector3 a = error.at(grid, 0, index), b = error.at(grid, 1, index);
  return {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])};
}

Result<VolumeSlice> slice_of(const volume::CompensatedMachine& machine, const Vector3& through_mm, std::size_t across,
                             std::size_t up, std::size_t columns, std::size_t rows) {
  VolumeSlice slice;
  slice.across = across;
  slice.up = up;
  const Vector3 reference_mm = volume::reference_of(machine.parameters);
  slice.grid = volume::grid_at(machine.travel_mm, through_mm, reference_mm);
  slice.grid.mm[across] = volume::even_grid(machine.travel_mm, columns, reference_mm).mm[across];
  slice.grid.mm[up] = volume::even_grid(machine.travel_mm, rows, reference_mm).mm[up];
  auto errors = errors_over(machine, slice.grid);
  if (!errors) return tl::unexpected(errors.error());
  slice.errors = std::move(*errors);
  return slice;
}

std::string travels_in_words(const volume::Travels& travel_mm) {
  std::vector<std::string> words;
  for (const Axis axis : kAllAxes)
    if (const auto& travel = travel_mm[index_of(axis)])
      words.push_back(fmt::format("{} {} … {}", letter_of(axis), shortest((*travel)[0]), shortest((*travel)[1])));
  return fmt::format("{} mm", fmt::join(words, ", "));
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

Result<VolumeWork> volume_work(MessageSink& messages, const VolumeArguments& arguments) {
  auto map = laser::read_map_csv(arguments.map);
  if (!map) return tl::unexpected(map.error());
  const bool has_tool = arguments.tool_length_mm || !arguments.tool_offset.empty();
  if (!arguments.model.empty() && !arguments.errors.empty())
    return problem(ProblemKind::usage, "expected --errors or --model, got both");
  if (!arguments.model.empty() && has_tool)
    return problem(ProblemKind::usage, "--model knows no tool: leave --tool-length and --tool-offset out");
  if (!arguments.model.empty() && arguments.places > kMostPlacesOfModel)
    return problem(ProblemKind::usage,
                   fmt::format("--points: expected at most {} with --model, which predicts place by "
                               "place",
                               kMostPlacesOfModel));
  std::string machine_file = machine_file_for(arguments);
  auto machine = machine_in(messages, machine_file);
  if (!machine) return tl::unexpected(machine.error());
  ExportArguments exported;
  exported.map = arguments.map;
  exported.params = arguments.params;
  exported.other_machine = arguments.other_machine;
  auto source = export_work(messages, exported, {std::move(*map), {}, arguments.map});
  if (!source) return tl::unexpected(source.error());
  const UnitParameters& parameters = source->source.parameters;
  if (arguments.machine.empty() && *machine && !is_of(**machine, parameters, source->source.map.header))
    machine->reset();

  VolumeWork work;
  work.settings = arguments.settings;
  work.notes = source->notes;
  work.machine_name = source->source.map.header.machine;
  std::optional<model::Model> model;
  if (!arguments.model.empty()) {
    auto read = model::read_model(arguments.model);
    if (!read) return tl::unexpected(read.error());
    model = std::move(*read);
  }
  work.prepared = prepared_volume(source->source.map, parameters, *machine, model ? &*model : nullptr);
  const auto tool = tool_of(arguments, parameters);
  if (!tool) return tl::unexpected(tool.error());
  volume::CompensatedMachine& evaluated_machine = work.prepared.machine;
  evaluated_machine.tool_offset_mm = *tool;
  if (!model) evaluated_machine.errors = volume::errors_of_map(evaluated_machine.map, parameters, *tool);
  if (const auto known = check_travels(work); !known) return tl::unexpected(known.error());
  volume::CompensatedMachine expected = evaluated_machine;  // what is known before the true errors are
  if (const auto taken = take_errors(arguments, machine_file, *machine, work); !taken)
    return tl::unexpected(taken.error());

  if (const auto taken = take_rotary(arguments, *machine ? machine_file : std::string(), work); !taken)
    return tl::unexpected(taken.error());

  auto answer = evaluated(evaluated_machine, arguments.places);
  if (!answer) return tl::unexpected(answer.error());
  work.answer = std::move(*answer);
  work.budget = budget_of(expected, arguments.settings);
  if (auto& rotary = evaluated_machine.rotary) {
    rotary->angles_deg = work.answer.settings[work.answer.before.all.setting];  // of slice and picture
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    work.uncertainty = {kUnknown, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown};
  } else {
    const auto uncertainty = uncertainty_of(expected, work.budget, arguments.settings, arguments.places);
    if (!uncertainty) return tl::unexpected(uncertainty.error());
    work.uncertainty = *uncertainty;
    share_out(work);
  }
  note_missing(work);
  note_rotary(work);
  if (!arguments.at.empty())
    if (const auto looked = look_at(arguments.at, work); !looked) return tl::unexpected(looked.error());
  if (!arguments.plane.empty())
    if (const auto done = cut(arguments.plane, work); !done) return tl::unexpected(done.error());
  for (const std::string& file :
       {arguments.map, arguments.params, arguments.errors, arguments.model, arguments.rotary, machine_file})
    if (!file.empty()) work.inputs.push_back(file);
  return work;
}

}  // namespace ecs::commissioning
