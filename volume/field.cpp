#include "volume/field.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"

namespace ecs::volume {
namespace {

Grid empty_grid(const Travels& travel_mm, const Vector3& reference_mm) {
  Grid grid;
  grid.reference_mm = reference_mm;
  for (std::size_t a = 0; a < kAxes; ++a) grid.exists[a] = travel_mm[a].has_value();
  return grid;
}

std::vector<double> steps(const std::optional<std::array<double, 2>>& travel_mm, std::size_t count) {
  if (!travel_mm) return {0.0};
  std::vector<double> mm(count);
  for (std::size_t i = 0; i < count; ++i)
    mm[i] = std::lerp((*travel_mm)[0], (*travel_mm)[1], static_cast<double>(i) / static_cast<double>(count - 1));
  return mm;
}

}  // namespace

std::size_t Grid::axes() const { return static_cast<std::size_t>(std::ranges::count(exists, true)); }

std::size_t Grid::axes_at_an_end(const GridIndex& index) const {
  std::size_t count = 0;
  for (std::size_t a = 0; a < kAxes; ++a)
    if (exists[a] && (index[a] == 0 || index[a] + 1 == mm[a].size())) ++count;
  return count;
}

Grid grid_over(const Travels& travel_mm, std::size_t places, const Vector3& reference_mm) {
  Grid grid = empty_grid(travel_mm, reference_mm);
  std::vector<std::size_t> axes;
  for (std::size_t a = 0; a < kAxes; ++a)
    if (travel_mm[a]) axes.push_back(a);
  const auto length = [&](std::size_t a) { return (*travel_mm[a])[1] - (*travel_mm[a])[0]; };
  std::ranges::stable_sort(axes, [&](std::size_t a, std::size_t b) { return length(a) > length(b); });
  const double root =
      std::pow(static_cast<double>(places), 1.0 / static_cast<double>(std::max<std::size_t>(1, axes.size())));
  PerAxis<std::size_t> count{1, 1, 1};
  for (const std::size_t a : axes) count[a] = std::max<std::size_t>(2, static_cast<std::size_t>(root + 1e-9));
  for (const std::size_t a : axes)  // one step more while there is room
    if (count[0] * count[1] * count[2] / count[a] * (count[a] + 1) <= places) ++count[a];
  for (std::size_t a = 0; a < kAxes; ++a) grid.mm[a] = steps(travel_mm[a], count[a]);
  return grid;
}

Grid even_grid(const Travels& travel_mm, std::size_t count, const Vector3& reference_mm) {
  Grid grid = empty_grid(travel_mm, reference_mm);
  for (std::size_t a = 0; a < kAxes; ++a) grid.mm[a] = steps(travel_mm[a], count);
  return grid;
}

Grid grid_at(const Travels& travel_mm, const Vector3& place_mm, const Vector3& reference_mm) {
  Grid grid = empty_grid(travel_mm, reference_mm);
  for (std::size_t a = 0; a < kAxes; ++a) grid.mm[a] = {travel_mm[a] ? place_mm[a] : 0.0};
  return grid;
}

namespace {

/// @param sign  −1: errors, 1: compensation
Components components_in(const laser::ErrorMap& map, const UnitParameters& parameters, const Grid& grid,
                         Interpolation interpolation, double sign) {
  Components out;
  for (std::size_t c = 0; c < kCurves; ++c) {
    const auto component = static_cast<Component>(c);
    if (!grid.exists[index_of(moving_axis(component))]) continue;
    const double scale = sign * (is_angular(component) ? parameters.angular_scale : 1.0);
    for (const Approach approach : kSides) {
      const laser::MapTable* table = table_of(map, component, approach);
      if (table == nullptr || table->position_mm.empty()) continue;
      auto& values = out.curve[side_of(approach)][c];
      for (const double p : coordinates_of(grid, moving_axis(component)))
        values.push_back(scale * laser::unit_value_at(*table, interpolation, p));
    }
  }
  for (const Component square : {Component::C0Y, Component::B0Z, Component::A0Z})
    out.squareness[index_of(square)] = -sign * squareness_um_per_m(parameters, square);
  return out;
}

}  // namespace

std::vector<double> coordinates_of(const Grid& grid, Axis axis) {
  std::vector<double> mm = grid.mm[index_of(axis)];
  mm.push_back(grid.reference_mm[index_of(axis)]);
  return mm;
}

Components errors_in(const laser::ErrorMap& map, const UnitParameters& parameters, const Grid& grid) {
  return components_in(map, parameters, grid, Interpolation::linear, -1.0);
}

Components compensation_in(const laser::ErrorMap& map, const UnitParameters& parameters, const Grid& grid) {
  return components_in(map, parameters, grid, parameters.interpolation, 1.0);
}

namespace {

constexpr std::size_t kSenses = kSenseNames.size();

Vector3 turned_along(const std::array<Vector3, kAxes>& directions, const Vector3& v) {
  Vector3 out{};
  for (std::size_t d = 0; d < kAxes; ++d)
    out[d] = directions[0][d] * v[0] + directions[1][d] * v[1] + directions[2][d] * v[2];
  return out;
}

}  // namespace

Field::Field(const Grid& grid, const Components& components, const Kinematics& kinematics) : grid_(grid) {
  reserve();
  for (const Term& term : kinematics.terms) put(term, components, kinematics);
}

Field::Field(const Grid& grid, const Components& components, const kinematics::MachinePose& pose,
             const std::array<kinematics::JointValues, 2>& rotary)
    : grid_(grid) {
  reserve();
  put(pose, components);
  for (std::size_t side = 0; side < rotary.size(); ++side) put(pose, side, rotary[side]);
}

void Field::reserve() {
  for (auto& side : part_)
    for (std::size_t a = 0; a < kAxes; ++a) side[a].resize(grid_.mm[a].size() + 1);
}

void Field::put(const kinematics::MachinePose& pose, const Components& components) {
  for (std::size_t c = 0; c < kCurves; ++c) {
    const std::size_t b = c / kSenses;
    const kinematics::Gain& gain = pose.gain[b][c % kSenses];
    const std::vector<double> own_mm = coordinates_of(grid_, static_cast<Axis>(b));
    for (std::size_t side = 0; side < part_.size(); ++side) {
      const std::vector<double>& values = components.curve[side][c];
      for (std::size_t i = 0; i < values.size(); ++i) {
        Part& part = part_[side][b][i];
        for (std::size_t d = 0; d < kAxes; ++d) {
          part.constant[d] += values[i] * (gain.at_0[d] + gain.slope[b][d] * own_mm[i]);
          for (std::size_t l = 0; l < kAxes; ++l)
            if (l != b) part.slope[l][d] += values[i] * gain.slope[l][d];
        }
      }
    }
  }
  for (std::size_t q = 0; q < pose.squareness.size(); ++q)
    for (std::size_t l = 0; l < kAxes; ++l)
      for (std::size_t d = 0; d < kAxes; ++d)
        squareness_[l][d] += components.squareness[kCurves + q] * pose.squareness[q].slope[l][d];
}

void Field::put(const kinematics::MachinePose& pose, std::size_t side, const kinematics::JointValues& rotary) {
  kinematics::Gain sum;
  for (std::size_t j = kAxes; j < kinematics::kJoints; ++j)
    for (std::size_t s = 0; s < kSenses; ++s)
      for (std::size_t d = 0; d < kAxes; ++d) {
        sum.at_0[d] += rotary.curve[j][s] * pose.gain[j][s].at_0[d];
        for (std::size_t l = 0; l < kAxes; ++l) sum.slope[l][d] += rotary.curve[j][s] * pose.gain[j][s].slope[l][d];
      }
  // The same at every coordinate of X, which stands for all: X itself is its coordinate there, Y and Z are levers.
  const std::vector<double> x_mm = coordinates_of(grid_, Axis::X);
  for (std::size_t i = 0; i < x_mm.size(); ++i) {
    Part& part = part_[side][0][i];
    for (std::size_t d = 0; d < kAxes; ++d) {
      part.constant[d] += sum.at_0[d] + sum.slope[0][d] * x_mm[i];
      for (std::size_t l = 1; l < kAxes; ++l) part.slope[l][d] += sum.slope[l][d];
    }
  }
}

void Field::put(const Term& term, const Components& components, const Kinematics& kinematics) {
  const std::size_t d = index_of(term.observed), l = index_of(term.lever), c = index_of(term.component);
  if (is_squareness(term.component)) {
    if (term.uses_coordinate) squareness_[l][d] += term.sign * components.squareness[c] / kMmPerM;
    return;
  }
  const std::size_t b = index_of(moving_axis(term.component));
  double constant = 1.0, slope = 0.0;
  if (term.has_lever) {
    constant = kinematics.tool_offset_mm[l] / kMmPerM;
    if (term.uses_coordinate) {
      constant -= kinematics.lines_mm[b][l] / kMmPerM;
      slope = 1.0 / kMmPerM;
    }
  }
  const std::vector<double> own_mm = coordinates_of(grid_, static_cast<Axis>(b));
  for (std::size_t side = 0; side < part_.size(); ++side) {
    const std::vector<double>& values = components.curve[side][c];
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double value = term.sign * values[i];
      Part& part = part_[side][b][i];
      if (l == b)
        part.constant[d] += value * (constant + slope * own_mm[i]);
      else {
        part.constant[d] += value * constant;
        part.slope[l][d] += value * slope;
      }
    }
  }
}

void Field::add(const Field& other) {
  for (std::size_t side = 0; side < part_.size(); ++side)
    for (std::size_t a = 0; a < kAxes; ++a)
      for (std::size_t i = 0; i < part_[side][a].size(); ++i)
        for (std::size_t d = 0; d < kAxes; ++d) {
          part_[side][a][i].constant[d] += other.part_[side][a][i].constant[d];
          for (std::size_t l = 0; l < kAxes; ++l) part_[side][a][i].slope[l][d] += other.part_[side][a][i].slope[l][d];
        }
  for (std::size_t l = 0; l < kAxes; ++l)
    for (std::size_t d = 0; d < kAxes; ++d) squareness_[l][d] += other.squareness_[l][d];
}

void Field::count_from_reference() {
  const Vector3 reverse = at_reference(0), forward = at_reference(1);
  Vector3 back{};
  for (std::size_t d = 0; d < kAxes; ++d) back[d] = -0.5 * (reverse[d] + forward[d]);
  shift(back);
}

void Field::shift(const Vector3& by_um) {
  for (auto& side : part_)
    for (Part& part : side[0])
      for (std::size_t d = 0; d < kAxes; ++d) part.constant[d] += by_um[d];
}

Field Field::along(const std::array<Vector3, kAxes>& directions) const {
  Field out = *this;
  for (auto& side : out.part_)
    for (auto& axis : side)
      for (Part& part : axis) {
        part.constant = turned_along(directions, part.constant);
        for (Vector3& slope : part.slope) slope = turned_along(directions, slope);
      }
  for (Vector3& slope : out.squareness_) slope = turned_along(directions, slope);
  return out;
}

Vector3 Field::sum(const PerAxis<const Part*>& parts, const Vector3& place_mm) const {
  Vector3 error{};
  for (std::size_t d = 0; d < kAxes; ++d)
    for (std::size_t a = 0; a < kAxes; ++a) {
      double slope = squareness_[a][d];
      for (const Part* part : parts) slope += part->slope[a][d];
      error[d] += parts[a]->constant[d] + slope * place_mm[a];
    }
  return error;
}

Vector3 Field::at(std::size_t side, const GridIndex& index) const {
  return sum({&part_[side][0][index[0]], &part_[side][1][index[1]], &part_[side][2][index[2]]}, grid_.at(index));
}

Vector3 Field::at_reference(std::size_t side) const {
  return sum({&part_[side][0].back(), &part_[side][1].back(), &part_[side][2].back()}, grid_.reference_mm);
}

void Field::row(std::size_t side, std::size_t x, std::size_t y, std::span<Vector3> out) const {
  const Part &of_x = part_[side][0][x], &of_y = part_[side][1][y];
  const double x_mm = grid_.mm[0][x], y_mm = grid_.mm[1][y];
  Vector3 base{}, slope{};
  for (std::size_t d = 0; d < kAxes; ++d) {
    base[d] = of_x.constant[d] + of_y.constant[d] + (squareness_[0][d] + of_y.slope[0][d]) * x_mm +
              (squareness_[1][d] + of_x.slope[1][d]) * y_mm;
    slope[d] = squareness_[2][d] + of_x.slope[2][d] + of_y.slope[2][d];
  }
  const std::vector<Part>& of_z = part_[side][2];
  for (std::size_t z = 0; z < out.size(); ++z)
    for (std::size_t d = 0; d < kAxes; ++d)
      out[z][d] = base[d] + slope[d] * grid_.mm[2][z] + of_z[z].constant[d] + of_z[z].slope[0][d] * x_mm +
                  of_z[z].slope[1][d] * y_mm;
}

}  // namespace ecs::volume
