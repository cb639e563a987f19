#include "volume/volume.hpp"

#include "volume/joint_volume.hpp"

namespace ecs::volume {

Field compensation_over(const CompensatedMachine& machine, const Grid& grid) {
  const UnitParameters& p = machine.parameters;
  const auto terms = terms_of(p);
  return {grid,
          compensation_in(machine.map, p, grid),
          {terms ? *terms : TermTable{}, p.measurement_lines_mm, p.tool_offset_mm}};
}

namespace {

std::vector<Place> all_places(const Grid& grid) {
  std::vector<Place> places;
  places.reserve(kSides.size() * grid.places());
  for (std::size_t side = 0; side < kSides.size(); ++side)
    for (const double x : grid.mm[0])
      for (const double y : grid.mm[1])
        for (const double z : grid.mm[2]) places.push_back({{x, y, z}, side});
  return places;
}

std::vector<Place> diagonal_places(const Grid& diagonals) {
  std::vector<Place> places;
  for (std::size_t side = 0; side < kSides.size(); ++side)
    for_each_diagonal_place(diagonals, [&](std::size_t, const GridIndex& index) {
      places.push_back({diagonals.at(index), side});
    });
  return places;
}

/// Vectors at places, counted from the reference.
Result<std::vector<Vector3>> vectors_at(const ErrorSource& errors, std::vector<Place> places,
                                        const Vector3& reference_mm) {
  for (std::size_t side = 0; side < kSides.size(); ++side) places.push_back({reference_mm, side});
  auto vectors = errors.vectors(places);
  if (!vectors) return vectors;
  const Vector3 reverse = (*vectors)[vectors->size() - 2], forward = vectors->back();
  vectors->resize(vectors->size() - kSides.size());
  for (Vector3& error : *vectors)
    for (std::size_t d = 0; d < kAxes; ++d) error[d] -= 0.5 * (reverse[d] + forward[d]);
  return vectors;
}

/// @param places  of the grid, where the source gives vectors
Result<BeforeAfter> errors_at(const CompensatedMachine& machine, const Grid& grid,
                              const std::function<std::vector<Place>(const Grid&)>& places) {
  Field compensation = compensation_over(machine, grid);
  BeforeAfter out;
  if (machine.errors.components) {
    ECS_TRY(components, machine.errors.components(grid));
    out.before.field.emplace(grid, components, machine.errors.kinematics);
    out.before.field->count_from_reference();
  } else {
    ECS_TRY(vectors, vectors_at(machine.errors, places(grid), grid.reference_mm));
    out.before.vectors = std::move(vectors);
  }
  compensation.count_from_reference();
  if (out.before.field) compensation.add(*out.before.field);
  out.after.field = std::move(compensation);
  out.after.vectors = out.before.vectors;
  return out;
}

}  // namespace

TermTable terms_of_machine(const UnitParameters& parameters, Convention convention, CurveKind curves) {
  const auto chain = chain_of(parameters);
  if (!chain) return {};
  // The printed equations are written for whole three-axis chains.
  const auto whole = convention == Convention::as_printed ? chain_of(configuration_of(parameters)) : chain;
  const auto terms = terms_of(*whole, convention, curves);
  return terms ? terms_in_scope(*terms, *chain, Scope::volumetric, {}) : TermTable{};
}

ErrorSource errors_of_map(const laser::ErrorMap& map, const UnitParameters& parameters, const Vector3& tool_offset_mm) {
  ErrorSource source;
  source.components = [map, parameters](const Grid& grid) {
    return Result<Components>(errors_in(map, parameters, grid));
  };
  source.kinematics = {terms_of_machine(parameters, parameters.convention, CurveKind::measured),
                       parameters.measurement_lines_mm, tool_offset_mm};
  return source;
}

Vector3 reference_of(const UnitParameters& parameters) {
  Vector3 reference_mm{};
  for (std::size_t a = 0; a < kAxes; ++a)
    if (parameters.axis_present[a]) reference_mm[a] = parameters.axes[a].datum.reference_position_mm;
  return reference_mm;
}

Result<BeforeAfter> errors_over(const CompensatedMachine& machine, const Grid& grid) {
  if (machine.rotary) {
    ECS_TRY(over, JointVolume::over(machine, grid));
    return over.at(machine.rotary->angles_deg);
  }
  return errors_at(machine, grid, all_places);
}

Result<VolumeAnswer> evaluated(const CompensatedMachine& machine, std::size_t places) {
  if (machine.rotary) return evaluated_with_rotary(machine, places);
  const Vector3 reference_mm = reference_of(machine.parameters);
  VolumeAnswer answer;
  answer.grid = grid_over(machine.travel_mm, places, reference_mm);
  ECS_TRY(errors, errors_over(machine, answer.grid));
  const Grid diagonals = even_grid(machine.travel_mm, kDiagonalPlaces, reference_mm);
  ECS_TRY(on_diagonals, errors_at(machine, diagonals, diagonal_places));
  answer.errors = std::move(errors);
  answer.before = size_of(answer.grid, answer.errors.before, diagonals, on_diagonals.before);
  answer.after = size_of(answer.grid, answer.errors.after, diagonals, on_diagonals.after);
  return answer;
}

}  // namespace ecs::volume
