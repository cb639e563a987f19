#include "app/report/volume.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/names/commissioning.hpp"
#include "app/report/markup.hpp"
#include "commissioning/maps/export_source.hpp"

namespace ecs::app {
namespace {

bool knows(const model::Model& model, Component component) {
  return std::any_of(model.effects.begin(), model.effects.end(), [&](const model::EffectInstance& effect) {
    if (effect.code || is_squareness(component)) return effect.code == component;
    return effect.sense == sense_of(component) && (!effect.axis || *effect.axis == moving_axis(component));
  });
}

/// What is compensated, yet has no effect in the model: there it would predict what the compensation adds.
std::vector<std::string> unknown_to(const model::Model& model, const controllers::ExportSource& source) {
  std::vector<std::string> names;
  const auto add = [&](Component component) {
    const std::string name(name_of(component));
    if (!knows(model, component) && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const laser::MapTable& table : source.map.tables)
    if (std::any_of(table.compensation.begin(), table.compensation.end(), [](double value) { return value != 0.0; }))
      add(table.component);
  const auto squareness = controllers::squareness_of(source.parameters);
  for (const Component square : {Component::C0Y, Component::B0Z, Component::A0Z})
    if (squareness[index_of(square)] != 0.0) add(square);
  return names;
}

std::string travels_in_words(const controllers::ExportSource& source) {
  std::vector<std::string> words;
  for (const Axis axis : kAllAxes)
    if (const auto& travel = source.travel_mm[index_of(axis)])
      words.push_back(
          fmt::format("{} {} … {}", letter_of(axis), plain_number((*travel)[0]), plain_number((*travel)[1])));
  return fmt::format("{} mm", fmt::join(words, ", "));
}

}  // namespace

Result<PredictedVolume> predicted_volume(const laser::ErrorMap& map, const UnitParameters& parameters,
                                         const std::optional<params::Machine>& machine, const model::Model* model) {
  controllers::ExportSource source{map, parameters, travels_for(map, parameters, machine)};
  PredictedVolume out;
  out.from = "the map";
  out.present = parameters.axis_present;
  out.travels = travels_in_words(source);
  out.travels_of_machine = machine.has_value();
  controllers::ErrorsAt errors = controllers::errors_of_map(source);
  if (model != nullptr && !machine) {
    out.remark = "The error model was not used: it counts from the datum of the axes, and no machine file was given.";
  } else if (model != nullptr) {
    if (const auto lacking = unknown_to(*model, source); !lacking.empty()) {
      out.remark = fmt::format("The error model was not used: it has no effect for {}, which {} compensated.",
                               fmt::join(lacking, ", "), lacking.size() == 1 ? "is" : "are");
    } else {
      out.from = "the error model";
      errors = errors_of_model(*model, *machine, "the error model");
    }
  }
  const auto rows = controllers::residuals(source, {}, parameters.measurement_lines_mm, errors);
  if (!rows) return tl::unexpected(rows.error());
  const controllers::ResidualRow& volume = rows->back();
  out.places = volume.places;
  out.before = volume.before;
  out.after = volume.unit;
  return out;
}

}  // namespace ecs::app
