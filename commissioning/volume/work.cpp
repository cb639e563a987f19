#include "commissioning/volume/work.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/maps/machine_map.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/volume/true_errors.hpp"
#include "laser/map/csv.hpp"
#include "laser/measurement_set.hpp"
#include "model/fit/compiled_model.hpp"
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
/// @param rotary_file  of errors of the rotary axes; empty: none
/// @return the bending that the model has
Result<RotaryBending> take_model(const model::Model& model, const params::Machine& machine,
                                 const std::string& rotary_file, VolumeWork& work) {
  constexpr double kIncrement_mm = 1.0, kMostPoints = 5000.0;
  double increment_mm = kIncrement_mm;
  for (const auto& axis : machine.axes)
    if (axis) increment_mm = std::max(increment_mm, (axis->travel_mm[1] - axis->travel_mm[0]) / kMostPoints);
  ECS_TRY(compiled, model::compiled(model, machine, increment_mm));
  volume::CompensatedMachine& evaluated_machine = work.prepared.machine;
  evaluated_machine.errors =
      components_of_model(compiled, evaluated_machine.parameters, machine, evaluated_machine.tool_offset_mm);
  for (const std::string& left_out : compiled.not_carried)
    work.notes.push_back(fmt::format("not included in the volume: {}", left_out));
  for (const model::EffectInstance& effect : model.effects) {
    if (effect.definition().bending == nullptr) continue;
    for (auto& [letter, effects] : compiled.rotary) std::erase(effects, to_text(effect));
  }
  for (const auto& [letter, effects] : compiled.rotary)
    if (rotary_file.empty() && !effects.empty())
      work.notes.push_back(
          fmt::format("not included in the volume: {}: write the errors of {} to a file with `ecs model fit --rotary`, "
                      "and give it with --rotary",
                      fmt::join(effects, ", "), letter));
  return compiled.map.header.bending;
}

}  // namespace

namespace {

/// The rotary axes of the machine file and their errors; nothing where it has none. Refused: --rotary without them, the
/// printed equations.
/// @param model  in place of the map's errors, where one was given
/// @param expected  gets the errors that are known; `work` the true ones where an errors file is given
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
  if (!joints) return problem(ProblemKind::refused, "the kinematic chain of the machine file has no axis left");
  RotaryBending bending = evaluated_machine.map.header.bending;
  if (model) {
    ECS_TRY(of_model, take_model(*model, machine.machine, arguments.rotary, work));
    bending = of_model;
    expected.errors = evaluated_machine.errors;
  }
  volume::RotaryAxes rotary;
  rotary.machine = *joints;
  for (std::size_t r = 0; r < kAxes; ++r)
    if (const auto& axis = machine.rotary[r]) rotary.travel_deg[r] = axis->travel_deg;
  if (!arguments.rotary.empty()) {
    ECS_TRY(errors, volume::read_rotary_errors(arguments.rotary, rotary.machine.chain));
    rotary.errors = std::move(errors);
  } else {
    rotary.errors = volume::rotary_errors_in(evaluated_machine.map.header);
  }
  rotary.errors.bending = bending;
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

/// What the unit does not compensate, and errors that nobody gave.
void note_rotary(VolumeWork& work) {
  const auto& rotary = work.prepared.machine.rotary;
  const bool in_map = !work.prepared.machine.map.header.rotary.empty();
  if (!rotary && in_map)
    work.notes.emplace_back(
        "the map also compensates the errors of rotary axes, which are at 0 here: give the machine file that has them "
        "(--machine)");
  if (!rotary) return;
  work.notes.emplace_back(
      !in_map ? "the unit compensates X, Y and Z as if the rotary axes were at 0. The errors of the rotary axes "
                "remain, and so do the effects of angular errors of X, Y and Z at other angles"
              : "the unit compensates along X, Y and Z, at all angles, the errors of the rotary axes that the map "
                "contains; the orientation of the tool is not compensated");
  std::vector<std::string> missing;
  for (const kinematics::ChainJoint& one : rotary->machine.chain) {
    if (!is_rotary(one.joint)) continue;
    for (std::size_t s = 0; s < kSenseNames.size(); ++s)
      if (table_of(rotary->errors, one.joint, static_cast<Sense>(s), Approach::forward) == nullptr)
        missing.push_back(volume::rotary_name(one.joint, static_cast<Sense>(s)));
  }
  if (!missing.empty() && !work.true_rotary)
    work.notes.push_back(
        fmt::format("not given: {0} (--rotary); assumed to be zero with a standard uncertainty of {1:g} um or {1:g} "
                    "um/m. Change it with --zero-uncertainty",
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
    work.notes.push_back(
        fmt::format("{0}: no standard uncertainty is given (column u); {1:g} um or {1:g} um/m is assumed. Change it "
                    "with --zero-uncertainty",
                    fmt::join(unstated, ", "), work.settings.declared_zero));
}

}  // namespace

std::string rotary_in_words(const VolumeWork& work) {
  const auto& rotary = work.prepared.machine.rotary;
  if (!rotary) return "";
  std::vector<std::string> travels, angles;
  for (std::size_t r = 0; r < kAxes; ++r)
    if (const auto& travel = rotary->travel_deg[r]) {
      travels.push_back(fmt::format("{} {} … {}", rotary_letter(r), shortest((*travel)[0]), shortest((*travel)[1])));
      angles.push_back(fmt::format("{} {:.4g}", rotary_letter(r), rotary->angles_deg[r]));
    }
  return fmt::format(
      "rotary axes {} deg, {} settings; chain {}; largest error before compensation at {} deg (slices and "
      "pictures show these angles)",
      fmt::join(travels, ", "), work.answer.settings.size(), kinematics::iso_notation(rotary->machine.chain),
      fmt::join(angles, ", "));
}

namespace {

/// The zero of a readout and what only the readings show say nothing of how an error depends on the position.
bool knows(const model::Model& model, Component component) {
  return std::any_of(model.effects.begin(), model.effects.end(), [&](const model::EffectInstance& effect) {
    if (effect.traits().of_measurement || effect.definition().id == "offset") return false;
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
    std::vector<MachinePlace> asked;
    asked.reserve(places.size());
    for (const volume::Place& place : places) {
      const Approach side = volume::kSides[place.side];
      asked.push_back({place.position_mm, {side, side, side}});
    }
    return errors(asked);
  };
  return source;
}

/// The machine file to take: the one given, else machine.toml beside the parameters.
std::string machine_file_for(const VolumeArguments& arguments) {
  if (!arguments.machine.empty()) return arguments.machine;
  const auto beside = std::filesystem::path(arguments.params).parent_path() / "machine.toml";
  return is_there(beside) ? beside.string() : std::string();
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
  ECS_TRY(errors, true_errors(arguments.errors, machine ? machine_file : std::string(), work.prepared.machine));
  work.prepared.machine.errors = std::move(errors.source);
  if (!errors.left_out.empty())
    work.notes.push_back(
        fmt::format("the true errors are those of the machine at rest, cold and without load; further errors of the "
                    "file are not included: {}",
                    errors.left_out));
  work.prepared.errors_from = "the errors file";
  return {};
}

/// Needed components that the map lacks.
void note_missing(VolumeWork& work) {
  const laser::ErrorMap& map = work.prepared.machine.map;
  std::vector<std::string_view> zero, missing;
  for (const volume::CurveUncertainty& u : work.budget.curves) {
    if (u.unmeasured == 0.0) continue;
    const bool declared = std::any_of(map.header.declared_zero.begin(), map.header.declared_zero.end(),
                                      [&](const laser::DeclaredZero& z) { return z.component == u.component; });
    (declared ? zero : missing).emplace_back(name_of(u.component));
  }
  for (const laser::DeclaredZero& z : map.header.declared_zero)
    if (is_squareness(z.component)) zero.emplace_back(name_of(z.component));
  std::vector<std::string_view> without_lever;
  for (const std::string_view name : missing) {
    const auto is_it = [&](const ComponentShare& one) { return one.rotary.empty() && name_of(one.component) == name; };
    if (work.prepared.errors_from == "the errors file") continue;
    (std::ranges::any_of(work.shares, is_it) ? work.unmeasured : without_lever).push_back(name);
  }
  if (!missing.empty())
    work.notes.push_back(
        fmt::format("{} {} neither in the map nor declared zero: assumed to be zero. The true error can be larger{}",
                    fmt::join(missing, ", "), missing.size() == 1 ? "is" : "are",
                    without_lever.empty() || work.unmeasured.empty()
                        ? ""
                        : fmt::format(". Of these, {} {} no lever arm here and {} not act on the error vector",
                                      fmt::join(without_lever, ", "), without_lever.size() == 1 ? "has" : "have",
                                      without_lever.size() == 1 ? "does" : "do")));
  if (!zero.empty())
    work.notes.push_back(
        fmt::format("{0} {1} declared zero: standard uncertainty {2:g} um or {2:g} um/m. Change it with "
                    "--zero-uncertainty",
                    fmt::join(zero, ", "), zero.size() == 1 ? "is" : "are", work.settings.declared_zero));
}

/// The parts of a budget of rotary axes, each alone, by name.
std::vector<std::pair<std::string, volume::RotaryBudget>> parts_of(const volume::RotaryBudget& budget) {
  std::vector<std::pair<std::string, volume::RotaryBudget>> parts;
  for (const volume::MotionUncertainty& motion : budget.motions)
    parts.emplace_back(volume::rotary_name(motion.joint, motion.sense), volume::RotaryBudget{{motion}, {}});
  for (std::size_t r = 0; r < kAxes; ++r)
    for (std::size_t s = 0; s < kSenseNames.size(); ++s) {
      if (budget.location[r][s] == 0.0) continue;
      parts.emplace_back(volume::location_name(r, s), volume::RotaryBudget{});
      parts.back().second.location[r][s] = budget.location[r][s];
    }
  return parts;
}

/// Of the linear variance, by component.
void share_out(VolumeWork& work, const volume::CompensatedMachine& machine) {
  constexpr std::size_t kPlaces = 64;
  const volume::Grid grid = volume::grid_over(machine.travel_mm, kPlaces, volume::reference_of(machine.parameters));
  double sum = 0.0;
  const auto take = [&](Component component, double rms, const std::string& rotary) {
    if (rms > 0.0) work.shares.push_back({component, rms * rms, rotary});
    sum += rms * rms;
  };
  const auto add = [&](Component component, const volume::UncertaintyBudget& alone) {
    take(component,
         machine.rotary ? linear_rms_um(machine, alone, volume::RotaryBudget{}) : linear_rms_um(machine, alone, grid),
         "");
  };
  if (machine.rotary)
    for (const auto& [name, alone] : parts_of(work.rotary_budget))
      take(Component::EXX, linear_rms_um(machine, volume::UncertaintyBudget{}, alone), name);
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

Result<void> check_travels(const VolumeWork& work) {
  const volume::CompensatedMachine& machine = work.prepared.machine;
  for (const Axis axis : kAllAxes)
    if (machine.parameters.axis_present[index_of(axis)] && !machine.travel_mm[index_of(axis)])
      return problem(ProblemKind::refused,
                     "the travel of {} is not known: the map has no table of {}; give the machine file with --machine",
                     letter_of(axis), letter_of(axis));
  return {};
}

}  // namespace

cli::Fields<VolumeArguments> VolumeArguments::fields() {
  using A = VolumeArguments;
  using S = volume::UncertaintySettings;
  using cli::Is, cli::Need, cli::Range;
  const cli::Fields<S> uncertainty{
      {"--repeatability", &S::repeatability,
       "standard uncertainty of every map value [um, um/m]; default: from the header, else from the roughness of each "
       "table"},
      {"--instrument", &S::instrument_um_per_m,
       "standard uncertainty of the measuring instrument, proportional to the length [um/m]", Range{0.0}},
      {"--temperature", &S::temperature_degC,
       "standard uncertainty of the scale temperature during the measurement [degC]", Range{0.0}},
      {"--expansion", &S::expansion_um_per_m_degC,
       "expansion coefficient that converts --temperature to a length [um/(m degC)]", Range{0.0}},
      {"--zero-uncertainty", &S::declared_zero, "standard uncertainty of a component declared zero [um, um/m]",
       Range{0.0}},
      {"--square-uncertainty", &S::squareness_um_per_m, "standard uncertainty of the squareness reference [um/m]",
       Range{0.0}},
      {"--draws", &S::draws, "number of random maps for the 95 % bound", Range{20, 100'000}},
      {"--seed", &S::seed, "seed of the random maps", Range{0, 1'000'000'000}}};
  return {
      {"MAP", &A::map, "error map (.csv)", Need::required},
      {"--params", &A::params, "parameters of the map", Need::required},
      {"--errors", &A::errors,
       "true errors of an emulated machine (errors file of ecs-emulator), used instead of the map's"},
      {"--model", &A::model, "fitted error model to use instead of the map's errors; needs the machine file"},
      {"--machine", &A::machine, "machine file: travels, datum; default: machine.toml in the folder of the parameters"},
      {"--other-machine", &A::other_machine, "continue even if map and parameters name different machines"},
      {"--points", &A::places, "maximum number of positions in the volume",
       Range{8, static_cast<double>(volume::kMostPlaces)}},
      {"--tool-length", &A::tool_length_mm,
       "tool length along -Z from the point where the curves were measured [mm]; the unit compensates for the tool of "
       "its parameters"},
      {"--tool-offset", &A::tool_offset, "tool offset along X, Y, Z from that point: 0,0,-250"},
      {"--rotary", &A::rotary,
       "errors of the rotary axes of the machine file (.csv: component, approach, p_deg, error)"},
      {"--at", &A::at, "also show one position: -1000,-200,-350; for rotary axes followed by their angles"},
      {"--slice", &A::plane, "also show the error in a plane through the position of the largest error, as numbers",
       cli::Words{"XY", "XZ", "YZ"}},
      {"--between", &A::between,
       "also search between the positions, on lines along each axis through the position of the largest error"},
      {"-o,--output", &A::picture, "picture to write (.svg or .png)", Is::output},
      {"--values", &A::values, "CSV file for every value of the map with its standard uncertainty", Is::output},
      {&A::settings, uncertainty}};
}

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
    out.remark = fmt::format("The error model was not used: none of its effects describes {}, which {} compensated.",
                             fmt::join(lacking, ", "), lacking.size() == 1 ? "is" : "are");
    return out;
  }
  out.errors_from = "the error model";
  out.machine.errors = source_of_model(*model, *machine);
  return out;
}

std::string travels_in_words(const volume::Travels& travel_mm) {
  std::vector<std::string> words;
  for (const Axis axis : kAllAxes)
    if (const auto& travel = travel_mm[index_of(axis)])
      words.push_back(fmt::format("{} {} … {}", letter_of(axis), shortest((*travel)[0]), shortest((*travel)[1])));
  return fmt::format("{} mm", fmt::join(words, ", "));
}

Result<VolumeWork> volume_work(MessageSink& messages, const VolumeArguments& arguments) {
  ECS_TRY(map, laser::read_map_csv(arguments.map));
  const bool has_tool = arguments.tool_length_mm || !arguments.tool_offset.empty();
  if (!arguments.model.empty() && !arguments.errors.empty())
    return problem(ProblemKind::usage, "expected --errors or --model, got both");
  if (!arguments.model.empty() && has_tool)
    return problem(ProblemKind::usage, "--model does not support a tool: omit --tool-length and --tool-offset");
  if (!arguments.model.empty() && arguments.places > kMostPlacesOfModel)
    return problem(ProblemKind::usage,
                   "--points: expected at most {} with --model, which predicts position by position",
                   kMostPlacesOfModel);
  std::string machine_file = machine_file_for(arguments);
  ECS_TRY(machine, machine_in(messages, machine_file));
  ExportArguments exported;
  exported.map = arguments.map;
  exported.params = arguments.params;
  exported.other_machine = arguments.other_machine;
  if (!arguments.machine.empty() && machine && !arguments.other_machine)
    if (const auto other =
            laser::other_machine({map.header.machine, ""}, {machine->name, ""}, "the machine file is of"))
      return tl::unexpected(Problem{ProblemKind::refused,
                                    fmt::format("{}: give the right one, or --other-machine", *other),
                                    arguments.map,
                                    0,
                                    0,
                                    {}});
  ECS_TRY(source, export_work(messages, exported, {std::move(map), {}, arguments.map}));
  const UnitParameters& parameters = source.source.parameters;
  if (arguments.machine.empty() && machine && !is_of(*machine, parameters, source.source.map.header)) machine.reset();

  VolumeWork work;
  work.settings = arguments.settings;
  work.notes = source.notes;
  work.machine_name = source.source.map.header.machine;
  std::optional<model::Model> model;
  if (!arguments.model.empty()) {
    ECS_TRY(read, model::read_model(arguments.model));
    model = std::move(read);
  }
  work.prepared = prepared_volume(source.source.map, parameters, machine, model ? &*model : nullptr);
  ECS_TRY(tool, tool_of(arguments, parameters));
  volume::CompensatedMachine& evaluated_machine = work.prepared.machine;
  evaluated_machine.tool_offset_mm = tool;
  if (!model) evaluated_machine.errors = volume::errors_of_map(evaluated_machine.map, parameters, tool);
  if (!model && arguments.errors.empty())
    if (auto left = laser::squareness_left_behind(evaluated_machine.map.header, parameters))
      return tl::unexpected(Problem{ProblemKind::refused,
                                    "the remaining error would not contain squareness: " + *left,
                                    arguments.params,
                                    0,
                                    0,
                                    {}});
  ECS_DO(check_travels(work));
  volume::CompensatedMachine expected = evaluated_machine;  // what is known before the true errors are
  ECS_DO(take_errors(arguments, machine_file, machine, work));

  ECS_DO(take_rotary(arguments, machine ? machine_file : std::string(), model, expected, work));

  ECS_TRY(answer, evaluated(evaluated_machine, arguments.places));
  work.answer = std::move(answer);
  work.budget = budget_of(expected, arguments.settings);
  if (expected.rotary) work.rotary_budget = rotary_budget_of(*expected.rotary, arguments.settings);
  ECS_TRY(uncertainty, expected.rotary ? uncertainty_of(expected, work.budget, work.rotary_budget, arguments.settings,
                                                        arguments.places)
                                       : uncertainty_of(expected, work.budget, arguments.settings, arguments.places));
  work.uncertainty = uncertainty;
  share_out(work, expected);
  if (auto& rotary = evaluated_machine.rotary)
    rotary->angles_deg = work.answer.settings[work.answer.before.all.setting];  // of slice and picture
  note_missing(work);
  note_rotary(work);
  if (!arguments.at.empty()) ECS_DO(look_at(arguments.at, expected, work));
  if (!arguments.plane.empty()) ECS_DO(cut(arguments.plane, work));
  if (arguments.between) ECS_DO(look_between(work));
  for (const std::string& file :
       {arguments.map, arguments.params, arguments.errors, arguments.model, arguments.rotary, machine_file})
    if (!file.empty()) work.inputs.push_back(file);
  return work;
}

}  // namespace ecs::commissioning
