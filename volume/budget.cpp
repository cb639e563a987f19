// The budget of a map: what its header states, its own roughness, and the settings.
#include <algorithm>
#include <cmath>

#include "volume/roughness.hpp"
#include "volume/uncertainty.hpp"

namespace ecs::volume {
namespace {

constexpr double kLeastDegreesOfFreedom = 3.0;  ///< below, Student's distribution has no variance
constexpr double kMadToSigma = 1.4826;          ///< of a normal distribution

double median_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The error midway between two values, from the curvature that second differences show above their noise.
double between_of(const std::vector<double>& values, double noise) {
  double squares = 0.0;
  for (std::size_t i = 0; i + 2 < values.size(); ++i) {
    const double second = values[i + 2] - 2.0 * values[i + 1] + values[i];
    squares += second * second;
  }
  if (values.size() < 3) return 0.0;
  return std::sqrt(std::max(0.0, squares / static_cast<double>(values.size() - 2) - 6.0 * noise * noise)) / 8.0;
}

bool is_known(const laser::ErrorMap& map, Component component) {
  return std::any_of(map.tables.begin(), map.tables.end(), [&](const laser::MapTable& table) {
    return table.component == component && !table.position_mm.empty();
  });
}

const laser::StatedUncertainty* stated_for(const laser::MapHeader& header, Component component) {
  for (const laser::StatedUncertainty& one : header.uncertainty)
    if (one.component == component) return &one;
  return nullptr;
}

void take_repeatability(CurveUncertainty& curve, const CompensatedMachine& machine,
                        const UncertaintySettings& settings) {
  const laser::StatedUncertainty* stated = stated_for(machine.map.header, curve.component);
  if (settings.repeatability) {
    curve.from = RepeatabilityFrom::option;
    curve.value = *settings.repeatability;
  } else if (stated != nullptr) {
    curve.from = RepeatabilityFrom::header;
    curve.value = stated->value;
    curve.pass = stated->pass;
    curve.degrees_of_freedom = std::max(kLeastDegreesOfFreedom, static_cast<double>(stated->degrees_of_freedom));
  } else {
    curve.from = RepeatabilityFrom::roughness;
    for (const laser::MapTable& table : machine.map.tables)
      if (table.component == curve.component) curve.value = std::max(curve.value, roughness_of(table.compensation));
  }
  for (const laser::MapTable& table : machine.map.tables)
    if (table.component == curve.component)
      curve.between = std::max(curve.between, between_of(table.compensation, curve.value));
}

}  // namespace

double roughness_of(const std::vector<double>& values) {
  std::vector<double> third;
  for (std::size_t i = 0; i + 3 < values.size(); ++i)
    third.push_back(std::abs(values[i + 3] - 3.0 * values[i + 2] + 3.0 * values[i + 1] - values[i]));
  return kMadToSigma * median_of(std::move(third)) / std::sqrt(20.0);
}

UncertaintyBudget budget_of(const CompensatedMachine& machine, const UncertaintySettings& settings) {
  UncertaintyBudget budget;
  for (std::size_t c = 0; c < kCurves; ++c) budget.curves[c].component = static_cast<Component>(c);
  const TermTable terms = terms_of_machine(machine.parameters, machine.parameters.convention, CurveKind::measured);
  for (const Term& term : terms) {
    const std::size_t c = index_of(term.component);
    // with rotary axes every rotation acts at some angle
    const bool acts = machine.rotary || !term.has_lever || term.uses_coordinate ||
                      machine.tool_offset_mm[index_of(term.lever)] != 0.0;
    if (!acts) continue;
    if (is_squareness(term.component)) {
      const laser::StatedUncertainty* stated = stated_for(machine.map.header, term.component);
      budget.squareness_um_per_m[c] = std::hypot(settings.squareness_um_per_m, stated != nullptr ? stated->value : 0.0);
      continue;
    }
    if (!machine.travel_mm[index_of(moving_axis(term.component))]) continue;
    CurveUncertainty& curve = budget.curves[c];
    if (curve.from != RepeatabilityFrom::nothing || curve.unmeasured > 0.0) continue;  // by another row already
    if (!is_known(machine.map, term.component)) {
      curve.unmeasured = settings.declared_zero;
      continue;
    }
    take_repeatability(curve, machine, settings);
    if (is_positioning(term.component))
      curve.per_m =
          std::hypot(settings.instrument_um_per_m, settings.temperature_degC * settings.expansion_um_per_m_degC);
  }
  return budget;
}

}  // namespace ecs::volume
