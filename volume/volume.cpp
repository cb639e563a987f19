// Between places coordinate ascent: an error is a sum over axes but for its levers, so one or two rounds find the
// place.
#include "volume/volume.hpp"

#include <algorithm>
#include <cmath>

#include "volume/joint_volume.hpp"

namespace ecs::volume {
namespace {

double length_of(const Vector3& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/// Number of a place among those of its side, Z fastest.
std::size_t place_number(const Grid& grid, const GridIndex& index) {
  return (index[0] * grid.mm[1].size() + index[1]) * grid.mm[2].size() + index[2];
}

/// Calls `each(side, index, error)` for every place of a grid from both sides.
template <class Each>
void for_each_place(const Grid& grid, const VolumeError& error, const Each& each) {
  std::vector<Vector3> row(grid.mm[2].size());
  for (std::size_t side = 0; side < kSides.size(); ++side)
    for (std::size_t x = 0; x < grid.mm[0].size(); ++x)
      for (std::size_t y = 0; y < grid.mm[1].size(); ++y) {
        std::ranges::fill(row, Vector3{});
        if (error.field) error.field->row(side, x, y, row);
        if (!error.vectors.empty()) {
          const std::size_t first = side * grid.places() + place_number(grid, {x, y, 0});
          for (std::size_t z = 0; z < row.size(); ++z)
            for (std::size_t d = 0; d < kAxes; ++d) row[z][d] += error.vectors[first + z][d];
        }
        for (std::size_t z = 0; z < row.size(); ++z) each(side, GridIndex{x, y, z}, row[z]);
      }
}

}  // namespace

void SizeCounter::take(const Vector3& error_um, const Vector3& place_mm, std::size_t side, std::size_t setting) {
  const double length = length_of(error_um);
  lengths_.push_back(static_cast<float>(length));
  for (std::size_t d = 0; d < kAxes; ++d) {
    size_.largest_along_um[d] = std::max(size_.largest_along_um[d], std::abs(error_um[d]));
    squares_[d] += error_um[d] * error_um[d];
  }
  if (length <= size_.largest_um && lengths_.size() > 1) return;
  size_.largest_um = length;
  size_.at_mm = place_mm;
  size_.approach = kSides[side];
  size_.error_um = error_um;
  size_.setting = setting;
}

ErrorSize SizeCounter::finish() {
  if (lengths_.empty()) return size_;
  const auto count = static_cast<double>(lengths_.size());
  for (std::size_t d = 0; d < kAxes; ++d) size_.rms_along_um[d] = std::sqrt(squares_[d] / count);
  size_.rms_um = std::sqrt((squares_[0] + squares_[1] + squares_[2]) / count);
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(0.95 * count)) - 1;
  std::nth_element(lengths_.begin(), lengths_.begin() + rank, lengths_.end());
  size_.p95_um = static_cast<double>(lengths_[static_cast<std::size_t>(rank)]);
  size_.places = lengths_.size() / kSides.size();
  return size_;
}

Vector3 VolumeError::at(const Grid& grid, std::size_t side, const GridIndex& index) const {
  Vector3 error = field ? field->at(side, index) : Vector3{};
  if (!vectors.empty())
    for (std::size_t d = 0; d < kAxes; ++d) error[d] += vectors[side * grid.places() + place_number(grid, index)][d];
  return error;
}

ErrorSize size_of(const Grid& grid, const VolumeError& error) {
  SizeCounter all(kSides.size() * grid.places());
  for_each_place(grid, error, [&](std::size_t side, const GridIndex& index, const Vector3& error_um) {
    all.take(error_um, grid.at(index), side, 0);
  });
  return all.finish();
}

void for_each_diagonal_place(const Grid& diagonals, const std::function<void(std::size_t, const GridIndex&)>& each) {
  std::vector<std::size_t> axes;
  for (std::size_t a = 0; a < kAxes; ++a)
    if (diagonals.exists[a]) axes.push_back(a);
  const std::size_t count = axes.empty() ? 1 : diagonals.mm[axes.front()].size();
  std::size_t number = 0;
  for (std::size_t turned = 0; turned < (std::size_t{1} << axes.size()) / 2; ++turned)  // axes that run backwards
    for (std::size_t i = 0; i < count; ++i) {
      GridIndex index{};
      for (std::size_t k = 0; k < axes.size(); ++k) index[axes[k]] = (turned >> k & 1U) != 0 ? count - 1 - i : i;
      each(number++, index);
    }
}

void VolumeCounter::take(const Grid& grid, const VolumeError& error, const Grid& diagonals,
                         const VolumeError& error_on_diagonals) {
  const std::size_t axes = grid.axes(), setting = settings_++;
  for_each_place(grid, error, [&](std::size_t side, const GridIndex& index, const Vector3& error_um) {
    const Vector3 place_mm = grid.at(index);
    all_.take(error_um, place_mm, side, setting);
    const std::size_t ends = grid.axes_at_an_end(index);
    if (ends > 0) faces_.take(error_um, place_mm, side, setting);
    if (ends + 1 >= axes) edges_.take(error_um, place_mm, side, setting);
  });
  std::size_t places = 0;
  for_each_diagonal_place(diagonals, [&](std::size_t, const GridIndex&) { ++places; });
  for (std::size_t side = 0; side < kSides.size(); ++side)
    for_each_diagonal_place(diagonals, [&](std::size_t number, const GridIndex& index) {
      Vector3 error_um = error_on_diagonals.field ? error_on_diagonals.field->at(side, index) : Vector3{};
      if (!error_on_diagonals.vectors.empty())
        for (std::size_t d = 0; d < kAxes; ++d) error_um[d] += error_on_diagonals.vectors[side * places + number][d];
      on_diagonals_.take(error_um, diagonals.at(index), side, setting);
    });
}

VolumeSize VolumeCounter::finish() {
  VolumeSize size{all_.finish(), faces_.finish(), edges_.finish(), on_diagonals_.finish()};
  ErrorSize& all = size.all;
  const ErrorSize& on = size.diagonals;  // closer together than the grid: the largest of all may be among them
  constexpr double kRounding = 1.0 + 1e-9;
  if (on.largest_um > kRounding * all.largest_um) {
    all.largest_um = on.largest_um;
    all.at_mm = on.at_mm;
    all.approach = on.approach;
    all.error_um = on.error_um;
    all.setting = on.setting;
  }
  for (std::size_t d = 0; d < kAxes; ++d)
    if (on.largest_along_um[d] > kRounding * all.largest_along_um[d]) all.largest_along_um[d] = on.largest_along_um[d];
  return size;
}

VolumeSize size_of(const Grid& grid, const VolumeError& error, const Grid& diagonals,
                   const VolumeError& error_on_diagonals) {
  VolumeCounter counter(grid.places());
  counter.take(grid, error, diagonals, error_on_diagonals);
  return counter.finish();
}

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

namespace {

constexpr int kMostRounds = 4;

}  // namespace

Result<ErrorSize> largest_between(const CompensatedMachine& machine, const ErrorSize& from,
                                  VolumeError BeforeAfter::*of) {
  const Vector3 reference_mm = reference_of(machine.parameters);
  const Grid lines = even_grid(machine.travel_mm, kPlacesOfLine, reference_mm);
  ErrorSize largest = from;
  for (int round = 0; round < kMostRounds; ++round) {
    const double before_um = largest.largest_um;
    for (std::size_t a = 0; a < kAxes; ++a) {
      if (!lines.exists[a]) continue;
      Grid line = grid_at(machine.travel_mm, largest.at_mm, reference_mm);
      line.mm[a] = lines.mm[a];
      ECS_TRY(errors, errors_over(machine, line));
      const ErrorSize here = size_of(line, errors.*of);
      if (here.largest_um > largest.largest_um) largest = here;
    }
    if (largest.largest_um <= before_um) break;
  }
  return largest;
}

}  // namespace ecs::volume
