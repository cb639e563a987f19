#include "modules/controllers/residual.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "modules/controllers/curve.hpp"

namespace ecs::controllers {
namespace {

/// Compensation of a map and its squareness, at a place.
Vector3 compensation_of(const ExportSource& source, const TermTable& terms, Interpolation interpolation,
                        const MachinePlace& place) {
  ComponentValues values{};
  for (std::size_t i = 0; i < kCurves; ++i) {
    const auto component = static_cast<Component>(i);
    const std::size_t axis = index_of(moving_axis(component));
    const bool parked = place.approach[axis] == Approach::unknown;
    for (const Approach approach : {Approach::forward, Approach::reverse}) {
      const laser::MapTable* table = table_of(source.map, component, approach);
      if (table == nullptr || table->position_mm.empty() || (!parked && approach != place.approach[axis])) continue;
      values[i] += (parked ? 0.5 : 1.0) * unit_value_at(*table, interpolation, place.position_mm[axis]);
    }
    if (is_angular(component)) values[i] *= source.parameters.angular_scale;
  }
  const auto squareness = squareness_of(source.parameters);
  for (std::size_t i = kCurves; i < kComponents; ++i) values[i] = -squareness[i];
  return tool_error_um(terms, values, place.position_mm, source.parameters.measurement_lines_mm,
                       source.parameters.tool_offset_mm);
}

/// Every term of the chain; directions in which no axis exists cannot be corrected and are left out.
TermTable whole_terms(const UnitParameters& parameters) {
  const auto chain = chain_of(parameters);
  if (!chain) return {};
  const auto terms = terms_of(*chain, parameters.convention, CurveKind::measured);
  return terms ? terms_in_scope(*terms, *chain, Scope::volumetric, {}) : TermTable{};
}

double travel_at(const ExportSource& source, Axis axis, double part) {
  const auto& travel = source.travel_mm[index_of(axis)];
  return travel ? std::lerp((*travel)[0], (*travel)[1], part) : 0.0;
}

PerAxis<Approach> all_by(Approach approach) { return {approach, approach, approach}; }

std::vector<MachinePlace> line_places(const ExportSource& source, Axis axis) {
  constexpr std::size_t kPlaces = 201;
  std::vector<MachinePlace> places;
  for (const Approach approach : {Approach::forward, Approach::reverse})
    for (std::size_t i = 0; i < kPlaces; ++i) {
      MachinePlace place{source.parameters.measurement_lines_mm[index_of(axis)], all_by(Approach::unknown)};
      place.approach[index_of(axis)] = approach;
      place.position_mm[index_of(axis)] =
          travel_at(source, axis, static_cast<double>(i) / static_cast<double>(kPlaces - 1));
      places.push_back(place);
    }
  return places;
}

std::vector<MachinePlace> volume_places(const ExportSource& source) {
  std::size_t axes = 0;
  for (const auto& travel : source.travel_mm) axes += travel ? 1u : 0u;
  const std::size_t fine = axes > 2 ? 11 : 21;
  const auto count = [&](std::size_t a) { return source.travel_mm[a] ? fine : std::size_t{1}; };
  const auto part = [&](std::size_t i) { return static_cast<double>(i) / static_cast<double>(fine - 1); };
  std::vector<MachinePlace> places;
  for (const Approach approach : {Approach::forward, Approach::reverse})
    for (std::size_t x = 0; x < count(0); ++x)
      for (std::size_t y = 0; y < count(1); ++y)
        for (std::size_t z = 0; z < count(2); ++z)
          places.push_back({{travel_at(source, Axis::X, part(x)), travel_at(source, Axis::Y, part(y)),
                             travel_at(source, Axis::Z, part(z))},
                            all_by(approach)});
  return places;
}

MachinePlace reference_place(const ExportSource& source) {
  MachinePlace place{{}, all_by(Approach::unknown)};
  for (std::size_t a = 0; a < kAxes; ++a) place.position_mm[a] = source.parameters.axes[a].datum.reference_position_mm;
  return place;
}

Vector3 plus(const Vector3& a, const Vector3& b, double weight) {
  return {a[0] + weight * b[0], a[1] + weight * b[1], a[2] + weight * b[2]};
}

/// @param residual  at the places, then at the reference point
ResidualSize size_of(const std::vector<Vector3>& residual) {
  ResidualSize size;
  const std::size_t places = residual.size() - 1;
  const Vector3 reference = residual.back();
  for (std::size_t i = 0; i < places; ++i) {
    const Vector3 left = plus(residual[i], reference, -1.0);
    const double length = std::hypot(left[0], left[1], left[2]);
    for (std::size_t d = 0; d <= kAxes; ++d) {
      const double value = d == kAxes ? length : std::abs(left[d]);
      size.largest_um[d] = std::max(size.largest_um[d], value);
      size.rms_um[d] += value * value / static_cast<double>(places);
    }
  }
  for (double& square : size.rms_um) square = std::sqrt(square);
  return size;
}

}  // namespace

ErrorsAt errors_of_map(const ExportSource& source) {
  return [&source](const std::vector<MachinePlace>& places) -> Result<std::vector<Vector3>> {
    const TermTable terms = whole_terms(source.parameters);
    std::vector<Vector3> errors;
    for (const MachinePlace& place : places)
      errors.push_back(plus({}, compensation_of(source, terms, Interpolation::linear, place), -1.0));
    return errors;
  };
}

Result<std::vector<ResidualRow>> residuals(const ExportSource& source, const ControllerTables& control,
                                           const MeasurementLines& lines, const ErrorsAt& errors) {
  const UnitParameters& p = source.parameters;
  const TermTable whole = whole_terms(p);
  const auto unit_terms = terms_of(p);
  std::vector<ResidualRow> rows;
  const auto add = [&](std::string where, std::vector<MachinePlace> places) -> Result<void> {
    const std::size_t count = places.size();
    places.push_back(reference_place(source));
    ECS_TRY(error, errors(places));
    std::vector<Vector3> with_unit, with_control;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const TermTable& terms = unit_terms ? *unit_terms : whole;
      with_unit.push_back(plus(error[i], compensation_of(source, terms, p.interpolation, places[i]), 1.0));
      with_control.push_back(plus(error[i], compensation_by(control, whole, places[i], lines, p.tool_offset_mm), 1.0));
    }
    rows.push_back({std::move(where), count, size_of(error), size_of(with_unit), size_of(with_control)});
    return {};
  };
  for (const Axis axis : kAllAxes)
    if (source.travel_mm[index_of(axis)])
      ECS_DO(add(fmt::format("line of {}", letter_of(axis)), line_places(source, axis)));
  ECS_DO(add("volume", volume_places(source)));
  return rows;
}

}  // namespace ecs::controllers
