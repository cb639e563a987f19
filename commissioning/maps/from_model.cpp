#include "commissioning/maps/from_model.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/maps/map_in_unit.hpp"
#include "commissioning/maps/rotary_part.hpp"
#include "commissioning/measurements/files.hpp"
#include "commissioning/models/view.hpp"
#include "commissioning/models/what_if.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/unit/transfer.hpp"
#include "model/effects/artefact_place.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"

namespace ecs::commissioning {
namespace {

using model::EffectInstance;
using model::Model;
using model::OwnLever;

/// 1, 2 or 5 times a power of ten, at most `value`.
double round_down(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {5.0, 2.0})
    if (step * decade <= value * (1.0 + 1e-9)) return step * decade;
  return decade;
}

constexpr double kMostPoints = 5000.0;    ///< of a table that nobody asked to be finer
constexpr double kPointsPerPeriod = 4.0;  ///< fewer cannot follow a period

void note_short_periods(MapFromModel& built, const Model& model) {
  for (const laser::MapRotaryAxis& axis : built.compiled.map.header.rotary)
    for (const EffectInstance& effect : model.effects)
      if (const auto period_deg = given_or_fitted(effect, "period_mm");  // in degrees
          period_deg && effect.rotary && axis_letter(effect) == axis.axis.letter &&
          *period_deg < kPointsPerPeriod * axis.increment_deg)
        built.notes.push_back(
            fmt::format("{}: a curve with a value every {} deg, the least that the unit has, cannot follow its period "
                        "of {:.4g} deg",
                        to_text(effect), shortest(axis.increment_deg), *period_deg));
  for (const EffectInstance& effect : model.effects)
    if (const auto period = period_mm_of(effect); period && *period < kPointsPerPeriod * built.increment_mm)
      built.notes.push_back(
          fmt::format("{}: a table with a value every {} mm cannot follow its period of {:.4g} mm; give a smaller "
                      "--increment, if the unit has room for it",
                      to_text(effect), shortest(built.increment_mm), *period));
}

/// Where an effect lands in the map or among the parameters; nothing for one that stays out.
std::optional<Component> component_for(const EffectInstance& effect) {
  if (effect.definition().has_lever()) return effect.code;
  if (effect.rotary || is_of_measurement(effect) || !effect.axis || !effect.sense ||
      effect.definition().carrier != model::Carrier::error_map)
    return std::nullopt;
  return curve_of(*effect.sense, *effect.axis);
}

/// The step of the ladder at which an effect was fitted: its own, else the beginning, else the last, which fits all.
const model::LadderStep* step_of(const Model& model, const std::string& effect) {
  const model::LadderStep* start = nullptr;
  for (const model::LadderStep& step : model.history) {
    if (step.effect == effect) return &step;
    if (step.effect.empty()) start = &step;
  }
  return start != nullptr || model.history.empty() ? start : &model.history.back();
}

/// One file, or several with blanks between.
std::vector<std::string> files_of(const model::LadderStep& step) {
  if (is_there(step.data)) return {step.data};
  std::vector<std::string> files;
  for (const std::string_view word : split(step.data, ' '))
    if (!word.empty()) files.emplace_back(word);
  return files;
}

/// @param place  "EXX", or the letter of a rotary axis
void add_source(MapFromModel& built, const std::string& place, const std::string& file) {
  const auto bytes = read_file(file);
  const std::string name = std::filesystem::path(file).filename().string();
  if (!bytes) {
    const std::string note = fmt::format("{} no longer exists: the header lists it without its checksum", file);
    if (std::find(built.notes.begin(), built.notes.end(), note) == built.notes.end()) built.notes.push_back(note);
    return;
  }
  const laser::SourceFile source{place, name, sha256_hex(*bytes)};
  auto& sources = built.compiled.map.header.sources;
  if (std::find(sources.begin(), sources.end(), source) == sources.end()) sources.push_back(source);
}

/// Tables and squareness values that an effect has part in.
std::vector<Component> places_of(const EffectInstance& effect, const std::vector<model::OwnLever>& levers) {
  std::vector<Component> places;
  if (const auto component = component_for(effect)) places.push_back(*component);
  for (const model::ComponentTerm& term : components_of(effect.definition()))
    for (const auto* values : {&effect.parameters, &effect.fitted})
      if (const auto size = values->find(std::string(term.parameter)); size != values->end() && size->second != 0.0)
        places.push_back(term.component);
  for (const model::OwnLever& lever : levers)
    if (lever.effect == to_text(effect)) places.push_back(lever.table);
  return places;
}

/// The rotary axes of the map that an effect has part in.
std::vector<std::string> rotary_places_of(const MapFromModel& built, const std::string& effect) {
  std::vector<std::string> letters;
  for (const auto& [letter, effects] : built.compiled.rotary)
    if (std::find(effects.begin(), effects.end(), effect) != effects.end()) letters.emplace_back(1, letter);
  return letters;
}

/// Which model and which measurements every table, squareness and rotary axis comes from.
void trace(MapFromModel& built, const Model& model, const std::vector<model::OwnLever>& levers,
           const std::string& model_file) {
  std::vector<std::string> untraced;
  for (const EffectInstance& effect : model.effects) {
    const std::string name = to_text(effect);
    const std::vector<Component> components = places_of(effect, levers);
    std::vector<std::string> places = rotary_places_of(built, name);
    for (const Component component : components) {
      places.emplace_back(name_of(component));
      built.effects[component].push_back(name);
    }
    if (places.empty()) continue;
    const std::string_view unit = !components.empty()                      ? unit_of(components.front())
                                  : effect.definition().bending != nullptr ? effect.definition().parameters.front().unit
                                  : effect.sense                           ? laser::unit_of(*effect.sense)
                                                                           : "um";
    if (const std::string tied = name_with_alternatives(effect); tied != place_text(effect)) {
      built.notes.push_back(tied + ": the data could not distinguish them");
      built.compiled.map.header.processing.push_back(built.notes.back());
      const auto largest = built.compiled.largest.find(name);
      if (largest != built.compiled.largest.end() && !measurement_alternatives(effect).empty())
        built.notes.push_back(cost_if_of_measurement(effect, fmt::format("up to {:.3g} {}", largest->second, unit)));
    }
    const model::LadderStep* step = step_of(model, name);
    for (const std::string& place : places) {
      add_source(built, place, model_file);
      if (step == nullptr) continue;
      for (const std::string& file : files_of(*step)) add_source(built, place, file);
    }
    if (step == nullptr)
      untraced.push_back(name);
    else if (step->effect != name)
      built.compiled.map.header.processing.push_back(fmt::format("{} fitted to {}", name, step->data));
  }
  if (!untraced.empty())
    built.notes.push_back(
        fmt::format("{}: the model file does not state to which readings it was fitted; `ecs model fit -o` and `ecs "
                    "model add` record this",
                    fmt::join(untraced, ", ")));
}

Result<void> complete_header(MapFromModel& built, const FromModelArguments& arguments) {
  laser::MapHeader& header = built.compiled.map.header;
  header.customer = arguments.customer;
  header.engineer = arguments.engineer;
  header.date = arguments.date;
  if (header.machine.empty()) header.machine = built.parameters.identity.machine;
  header.serial_number = built.parameters.identity.serial_number;
  for (const std::string& word : arguments.zero) {
    ECS_TRY(zero, declared_zero_in(word));
    if (built.effects.contains(zero.component))
      return problem(
          ProblemKind::usage,
          fmt::format("--zero {}: the model has a value for this component; keep only one", name_of(zero.component)));
    header.declared_zero.push_back(zero);
  }
  return {};
}

void take_squareness(UnitParameters& parameters, const model::CompiledModel& compiled) {
  for (std::size_t i = kCurves; i < kComponents; ++i)
    squareness_um_per_m(parameters, static_cast<Component>(i)) += compiled.squareness[i];
}

/// Of a squareness the parameters hold a value, or the model does.
std::vector<Component> missing_in(const MapFromModel& built) {
  const auto& zeros = built.compiled.map.header.declared_zero;
  const ComponentSet needed = components_needed(built.parameters.parameters);
  std::vector<Component> missing;
  for (std::size_t i = 0; i < kComponents; ++i) {
    const auto c = static_cast<Component>(i);
    const bool declared =
        std::any_of(zeros.begin(), zeros.end(), [c](const auto& zero) { return zero.component == c; });
    if (!needed.contains(c) || declared || built.effects.contains(c)) continue;
    if (!is_squareness(c) || squareness_um_per_m(built.parameters.parameters, c) == 0.0) missing.push_back(c);
  }
  return missing;
}

void declare_missing_zero(MapFromModel& built, const std::string& reason) {
  built.missing = missing_in(built);
  if (reason.empty()) return;
  for (const Component c : built.missing) built.compiled.map.header.declared_zero.push_back({c, reason});
  built.missing.clear();
}

/// A rotation is one table and acts in two directions. Where its value is not determined, the readings of one of them
/// do not say what it does in the other.
void find_unmeasured_directions(MapFromModel& built, const Model& model, const params::Machine& machine) {
  const auto chain = params::chain_of(machine);
  const auto terms = chain ? terms_of(*chain, Convention::iso, CurveKind::carriage) : std::nullopt;
  if (!terms) return;
  const auto is_measured = [&](Axis direction) {
    return std::any_of(model.effects.begin(), model.effects.end(),
                       [&](const EffectInstance& effect) { return effect.sense == static_cast<Sense>(direction); });
  };
  for (const EffectInstance& effect : model.effects) {
    if (effect.definition().place != model::Place::rotation || !effect.undetermined || effect.undetermined->empty())
      continue;
    std::vector<std::string> directions;
    for (const Term& term : *terms)
      if (term.component == *effect.code && term.has_lever && term.uses_coordinate && !is_measured(term.observed) &&
          machine.axes[index_of(term.observed)])
        directions.emplace_back(1, letter_of(term.observed));
    if (!directions.empty())
      built.findings.push_back(
          {false, fmt::format("{} also moves {}, where no readings were taken, and the readings do not determine its "
                              "value: measure there before and after sending the map",
                              to_text(effect), fmt::join(directions, " and "))});
  }
}

/// Where an effect is zero; "" for one that depends on no temperature and no time, or of which no value is known.
std::string zero_at(const EffectInstance& effect, const std::optional<model::Origin>& origin) {
  const model::EffectDefinition& definition = effect.definition();
  if (definition.has_need(model::Need::material_temperature)) return "t_material_degC = 20 degC";
  if (definition.has_need(model::Need::two_sensors)) return fmt::format("{} = {}", effect.sensor, effect.sensor2);
  if (!effect.traits().from_origin || !origin) return {};
  if (definition.has_need(model::Need::time)) return "the time of the first reading";
  const auto first = origin->sensors_degC.find(effect.sensor);
  return first == origin->sensors_degC.end() ? std::string()
                                             : fmt::format("{} = {:.4g} degC", first->first, first->second);
}

/// "4.13 um/m/degC"
std::string sizes_of(const EffectInstance& effect) {
  std::vector<std::string> sizes;
  for (const model::ParameterDefinition& parameter : effect.definition().parameters)
    for (const auto* values : {&effect.parameters, &effect.fitted})
      if (const auto value = values->find(std::string(parameter.name));
          value != values->end() && !is_left_out(effect, parameter.name, value->second))
        sizes.push_back(fmt::format("{} {:.3g} {}", parameter.meaning, value->second, unit_of(effect, parameter)));
  return fmt::format("{} ({})", to_text(effect), fmt::join(sizes, ", "));
}

/// The temperatures for which the map is made, and the error at others.
void note_temperatures(MapFromModel& built, const Model& model, const params::Machine& machine) {
  std::vector<std::string> effects;
  for (const EffectInstance& effect : model.effects) {
    if (effect.undetermined || is_of_measurement(effect) || is_carried(effect, machine)) continue;
    const std::string at = zero_at(effect, model.origin);
    if (at.empty()) continue;
    if (std::find(built.holds_at.begin(), built.holds_at.end(), at) == built.holds_at.end())
      built.holds_at.push_back(at);
    effects.push_back(sizes_of(effect));
  }
  if (effects.empty()) return;
  const std::string at = fmt::format("the map holds at {}", fmt::join(built.holds_at, " and "));
  built.compiled.map.header.processing.push_back(at);
  built.notes.push_back(fmt::format(
      "{}, where {} {} zero. At other temperatures the machine keeps this error. For a map at the working temperature, "
      "measure there and fit a model without {}",
      at, fmt::join(effects, " and "), effects.size() == 1 ? "is" : "are", effects.size() == 1 ? "it" : "them"));
}

/// The errors of the rotary axes come from a file in place of the model.
void leave_rotary_axes_to(const std::string& file, Model& model, MapFromModel& built) {
  if (file.empty()) return;
  std::vector<std::string> names;
  for (const EffectInstance& effect : model.effects)
    if (is_rotary_error(effect)) names.push_back(to_text(effect));
  if (names.empty()) return;
  std::erase_if(model.effects, [](const EffectInstance& effect) { return is_rotary_error(effect); });
  built.notes.push_back(
      fmt::format("the errors of the rotary axes come from {}, not from the model: {}", file, fmt::join(names, ", ")));
}

Result<MapFromModel> built_from(MessageSink& messages, const FromModelArguments& arguments) {
  auto model = model::read_model(arguments.model);
  if (!model) return tl::unexpected(model.error());
  if (model->compensated_readings > 0)
    return tl::unexpected(
        Problem{ProblemKind::refused,
                fmt::format("the model was fitted to readings of which {} were taken with compensation active "
                            "(compensated = 1): it describes the residual of the active map, and a map made from it "
                            "would replace that map. Measure in integration mode and fit the model to those readings",
                            model->compensated_readings),
                arguments.model,
                0,
                0,
                {}});
  ECS_TRY(machine, machine_in(messages, arguments.machine));
  MapFromModel built;
  leave_rotary_axes_to(arguments.rotary, *model, built);
  built.parameters.parameters = params::default_parameters_for(*machine);
  built.parameters.identity.machine = machine->name;
  built.parameters.has_end = true;
  if (arguments.received) built.parameters = *arguments.received;
  if (!arguments.params.empty()) {
    ECS_TRY(given, arguments.params_out.empty() ? params::read_parameters(arguments.params)
                                                : params::read_whole_parameters(arguments.params));
    built.parameters = std::move(given);
  }
  built.increment_mm = arguments.increment_mm.value_or(table_increment_mm(*model, *machine));
  ECS_TRY(compiled, in_file(model::compiled(*model, *machine, built.increment_mm), arguments.model));
  built.compiled = std::move(compiled);
  const auto levers = model::add_own_levers(built.compiled, *model, *machine, built.increment_mm);
  note_short_periods(built, *model);
  trace(built, *model, levers, arguments.model);
  note_temperatures(built, *model, *machine);
  ECS_DO(complete_header(built, arguments));
  ECS_DO(add_rotary(built.compiled.map.header, arguments.rotary, arguments.machine, built.notes));
  const UnitParameters given = built.parameters.parameters;
  take_squareness(built.parameters.parameters, built.compiled);
  built.enter_squareness = arguments.params_out.empty() && squareness_differs(given, built.parameters.parameters);
  declare_missing_zero(built, arguments.zero_missing);
  built.findings = laser::findings_for(built.compiled.map, built.parameters.parameters, travels_of(*machine));
  find_unmeasured_directions(built, *model, *machine);
  for (const EffectInstance& effect : model->effects)
    if (const std::string periods = other_periods_text(effect); !periods.empty() && is_carried(effect, *machine))
      built.findings.push_back({false, periods});
  return built;
}

Problem nothing_carried(const MapFromModel& b, const std::string& model) {
  std::vector<Problem> problems{{ProblemKind::refused,
                                 "no effect of this model can be compensated by a map; no file was written",
                                 model,
                                 0,
                                 0,
                                 {}}};
  for (const std::string& one : b.compiled.not_carried)
    problems.push_back({ProblemKind::refused, one, model, 0, 0, {}});
  return folded(std::move(problems));
}

}  // namespace

std::optional<double> period_mm_of(const model::EffectInstance& effect) {
  const auto period = given_or_fitted(effect, "period_mm");
  return period && *period > 0.0 && !effect.rotary ? period : std::nullopt;
}

double table_increment_mm(const Model& model, const params::Machine& machine) {
  double increment = 1e9, longest = 0.0;
  for (const auto& axis : machine.axes) {
    if (!axis) continue;
    increment = std::min(increment, (axis->travel_mm[1] - axis->travel_mm[0]) / 100.0);
    longest = std::max(longest, axis->travel_mm[1] - axis->travel_mm[0]);
  }
  for (const EffectInstance& effect : model.effects)
    if (const auto period = period_mm_of(effect)) increment = std::min(increment, *period / 8.0);
  return std::max(round_down(increment), round_down(2.0 * longest / kMostPoints));
}

Result<MapFromModel> planned_map_from_model(MessageSink& messages, const FromModelArguments& arguments) {
  if (arguments.machine.empty())
    return problem(ProblemKind::usage, "--from-model needs --machine: the machine file gives the travels of the axes");
  auto built = built_from(messages, arguments);
  if (built && built->effects.empty() && built->compiled.map.header.thermal.empty() &&
      built->compiled.map.header.rotary.empty())
    return tl::unexpected(nothing_carried(*built, arguments.model));
  return built;
}

Result<MapFromModel> map_from_model(MessageSink& messages, const FromModelArguments& arguments) {
  for (const std::string& output : {arguments.output, arguments.params_out, arguments.image})
    ECS_DO(check_output_not_input(output, {arguments.model, arguments.machine, arguments.rotary}));
  auto built = planned_map_from_model(messages, arguments);
  if (!built) return built;
  const params::ParametersFile& parameters = built->parameters;
  ECS_TRY(image, image_to_write(messages, arguments.image, built->compiled.map, parameters,
                                arguments.params.empty() ? "the parameters" : arguments.params));
  built->image = std::move(image);
  ECS_DO(write_map(arguments.output, built->compiled.map, arguments.params_out, parameters.parameters,
                   parameters.identity));
  ECS_DO(write_image(arguments.image, built->image));
  for (const std::string& objection : made_for_two_machines(built->compiled.map.header, parameters.identity))
    messages.warn(objection);
  return built;
}

namespace {

std::size_t points_in(const std::vector<laser::MapTable>& tables, Component component) {
  for (const laser::MapTable& table : tables)
    if (table.component == component) return table.position_mm.size();
  return 0;
}

Cell component_cell(const MapFromModel& b, Component component, const std::vector<std::string>& effects) {
  return record_cell("{component:<4} {description:<38} {unit:<4} {largest:>8} {points:>6}\n{effects}",
                     "component"_is(name_of(component)), "description"_is(laser::description_of(component)),
                     "unit"_is(unit_of(component)),
                     "effects"_is(effects, paragraph(fmt::format("from {}", fmt::join(effects, " + ")), 5, 10)),
                     "largest"_is(largest_in(b.compiled.map.tables, component), 2),
                     "points"_is(points_in(b.compiled.map.tables, component)));
}

Cell components_cell(const MapFromModel& b) {
  Cell list{Json::array(),
            fmt::format("{:<4} {:<38} {:<4} {:>8} {:>6}\n", "", "component", "unit", "largest", "points")};
  for (const auto& [component, effects] : b.effects)
    if (!is_squareness(component)) list.add(component_cell(b, component, effects));
  return list;
}

Cell squareness_of_model(const MapFromModel& b, const FromModelArguments& arguments) {
  std::vector<std::pair<Component, double>> values;
  for (const auto& each : b.effects)
    if (is_squareness(each.first)) values.emplace_back(each.first, b.compiled.squareness[index_of(each.first)]);
  return squareness_cell(values, "of the model", arguments.params_out);
}

/// "  C from location:C:XOC + cyclic:C:EC"
std::string rotary_effects_text(const MapFromModel& b) {
  std::string text;
  for (const auto& [letter, effects] : b.compiled.rotary)
    if (!effects.empty()) text += paragraph(fmt::format("{} from {}", letter, fmt::join(effects, " + ")), 2, 5);
  return text;
}

std::string declared_text(const MapFromModel& b) {
  std::string text;
  for (const laser::DeclaredZero& zero : b.compiled.map.header.declared_zero)
    text += paragraph(fmt::format("{} declared zero: {}", name_of(zero.component), zero.reason), 0, 5);
  return text;
}

}  // namespace

Cell from_model_cell(const MapFromModel& b, const FromModelArguments& arguments) {
  return record_cell(
      "{components}largest: of the compensation; points: per table, every {increment_mm} "
      "mm\n{squareness}{thermal}{rotary}{rotary_effects}{not_carried}"
      "{declared}{notes}{findings}{verdict}{map}{params_out}{image}",
      "map"_is(written_cell("map", arguments.output, "not saved: give -o map.csv to save it\n")),
      "params_out"_is(written_cell("parameters", arguments.params_out)),
      "image"_is(image_cell(arguments.image, b.image)), "model"_is(arguments.model),
      "increment_mm"_is(b.increment_mm, shortest(b.increment_mm)), "complete"_is(b.complete()),
      "carried"_is(lines_cell(b.compiled.carried, "")),
      "not_carried"_is(paragraphs_cell(b.compiled.not_carried, "NOT COMPENSATED: ")),
      "components"_is(components_cell(b)), "thermal"_shown(thermal_cell(b.compiled.map.header).text),
      "rotary"_shown(rotary_cell(b.compiled.map.header).text), "rotary_effects"_shown(rotary_effects_text(b)),
      "squareness"_is(squareness_of_model(b, arguments)), "declared"_shown(declared_text(b)),
      "missing"_is(lines_cell(objections_in(b.findings), "")), "findings"_is(findings_cell(b.findings)),
      "verdict"_shown(verdict_text(b.compiled.map, b.findings,
                                   !made_for_two_machines(b.compiled.map.header, b.parameters.identity).empty(),
                                   b.enter_squareness)),
      "holds_at"_is(lines_cell(b.holds_at, "")), "notes"_is(paragraphs_cell(b.notes, "note: ")),
      "header"_is(header_cell(b.compiled.map.header)));
}

}  // namespace ecs::commissioning
