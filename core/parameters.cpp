#include "core/parameters.hpp"

#include <algorithm>

namespace ecs {

std::string_view configuration_of(const UnitParameters& parameters) noexcept {
  const auto end = std::find(parameters.configuration.begin(), parameters.configuration.end(), '\0');
  return {parameters.configuration.data(), static_cast<std::size_t>(end - parameters.configuration.begin())};
}

std::optional<Chain> chain_of(const UnitParameters& parameters) noexcept {
  const auto chain = chain_of(configuration_of(parameters));
  if (!chain) return std::nullopt;
  for (const Axis a : kAllAxes)
    if (parameters.axis_present[index_of(a)] && !chain->has(a)) return std::nullopt;
  const Chain present = restricted_to(*chain, parameters.axis_present);
  if (present.axis_count() == 0) return std::nullopt;
  return present;
}

std::optional<TermTable> terms_of(const UnitParameters& parameters) noexcept {
  const auto chain = chain_of(parameters);
  if (!chain) return std::nullopt;
  // The printed equations are written for whole three-axis chains; axes that do not exist drop out afterwards.
  const auto whole = chain_of(configuration_of(parameters));
  const auto terms = terms_of(parameters.convention == Convention::as_printed ? *whole : *chain, parameters.convention,
                              CurveKind::measured);
  if (!terms) return std::nullopt;
  TermTable kept;
  for (const Term& term : terms_in_scope(*terms, *chain, parameters.scope, parameters.plane)) {
    if (!is_squareness(term.component) && !chain->has(moving_axis(term.component))) continue;
    if (term.has_lever && term.uses_coordinate && !chain->has(term.lever)) continue;
    const std::size_t lever = index_of(term.lever);
    const bool by_tool = parameters.tool_offset_mm[lever] != 0.0 || parameters.tool_range_mm[lever] != 0.0;
    if (term.has_lever && !term.uses_coordinate && !by_tool) continue;
    kept.rows[kept.count++] = term;
  }
  return kept;
}

ComponentSet components_needed(const UnitParameters& parameters) noexcept {
  const auto terms = terms_of(parameters);
  if (!terms) return {};
  return components_needed(*terms, true);  // rows that no tool levers are out already
}

double& squareness_um_per_m(UnitParameters& parameters, Component component) noexcept {
  if (component == Component::C0Y) return parameters.C0Y_um_per_m;
  return component == Component::B0Z ? parameters.B0Z_um_per_m : parameters.A0Z_um_per_m;
}

double squareness_um_per_m(const UnitParameters& parameters, Component component) noexcept {
  if (component == Component::C0Y) return parameters.C0Y_um_per_m;
  return component == Component::B0Z ? parameters.B0Z_um_per_m : parameters.A0Z_um_per_m;
}

}  // namespace ecs
