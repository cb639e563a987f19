// Monte Carlo: whole maps drawn from their uncertainty, and the largest and the rms error that each leaves (JCGM 101).
#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "base/units.hpp"
#include "volume/shapes.hpp"
#include "volume/uncertainty.hpp"

namespace ecs::volume {
namespace {

constexpr std::size_t kMostDrawnPlaces = 14'000;  ///< of every draw; between them the largest error is climbed to
constexpr std::size_t kLinearPlaces = 125;        ///< at which linear propagation is compared with the draws
constexpr int kClimbs = 3;

double square_of(const Vector3& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

/// The least value that `share` of the draws do not exceed.
double quantile_of(std::vector<double> draws, double share) {
  std::sort(draws.begin(), draws.end());
  const double rank = std::ceil(share * (static_cast<double>(draws.size()) + 1.0)) - 1.0;
  return draws[std::min(draws.size() - 1, static_cast<std::size_t>(std::max(0.0, rank)))];
}

/// From one place of a grid along the axes, one after the other, to where the error is largest.
double climbed(const VolumeError& error, std::size_t side, GridIndex index) {
  const Grid& grid = error.field->grid();
  double largest = square_of(error.at(grid, side, index));
  for (int climb = 0; climb < kClimbs; ++climb)
    for (std::size_t a = 0; a < kAxes; ++a) {
      GridIndex tried = index;
      for (tried[a] = 0; tried[a] < grid.mm[a].size(); ++tried[a]) {
        const double square = square_of(error.at(grid, side, tried));
        if (square <= largest) continue;
        largest = square;
        index = tried;
      }
    }
  return std::sqrt(largest);
}

/// The number of the coordinate nearest to a place.
GridIndex nearest(const Grid& grid, const Vector3& place_mm) {
  GridIndex index{};
  for (std::size_t a = 0; a < kAxes; ++a) {
    const auto& mm = grid.mm[a];
    const auto above = std::lower_bound(mm.begin(), mm.end(), place_mm[a]);
    index[a] = above == mm.end() ? mm.size() - 1 : static_cast<std::size_t>(above - mm.begin());
  }
  return index;
}

VolumeError sum_of(Field drawn, const VolumeError& known) {
  if (known.field) drawn.add(*known.field);
  return {std::move(drawn), known.vectors};
}

}  // namespace

MapDraws::MapDraws(const CompensatedMachine& machine, const UncertaintyBudget& budget, std::uint64_t seed)
    : machine_(machine),
      budget_(budget),
      kinematics_(errors_of_map(machine.map, machine.parameters, machine.tool_offset_mm).kinematics),
      generator_(seed) {}

void MapDraws::next() {
  NormalDraws normal;
  const auto shapes = [&](double size) {
    Shapes drawn{};
    for (double& one : drawn) one = size * normal(generator_);
    return drawn;
  };
  for (const CurveUncertainty& u : budget_.curves) {
    Curve& curve = curves_[index_of(u.component)];
    curve.unmeasured = shapes(u.unmeasured);
    curve.per_m = u.per_m * normal(generator_);
    double heavy_tails = 1.0;  // a few passes tell their own scatter badly: Student's t
    if (u.pass > 0.0) heavy_tails = std::sqrt(u.degrees_of_freedom / ChiSquaredDraws(u.degrees_of_freedom)(generator_));
    const laser::MapTable* before = nullptr;
    for (std::size_t side = 0; side < kSides.size(); ++side) {
      const laser::MapTable* table = table_of(machine_.map, u.component, kSides[side]);
      if (table == nullptr) continue;
      if (table == before) {
        curve.side[side] = curve.side[0];
        continue;
      }
      before = table;
      Table& drawn = curve.side[side];
      drawn.value.resize(table->position_mm.size());
      drawn.between.resize(table->position_mm.size());
      for (double& one : drawn.value) one = u.value * normal(generator_);
      for (double& one : drawn.between) one = u.between * normal(generator_);
      drawn.pass = shapes(heavy_tails * u.pass);
    }
  }
  for (std::size_t c = kCurves; c < kComponents; ++c)
    squareness_[c] = budget_.squareness_um_per_m[c] * normal(generator_);
}

Components MapDraws::components_over(const Grid& grid) const {
  Components components;
  components.squareness = squareness_;
  for (std::size_t c = 0; c < kCurves; ++c) {
    const Axis axis = moving_axis(static_cast<Component>(c));
    const auto& travel_mm = machine_.travel_mm[index_of(axis)];
    if (!travel_mm) continue;
    const Curve& curve = curves_[c];
    for (const double p : coordinates_of(grid, axis)) {
      const Shapes shapes = shapes_at(*travel_mm, p);
      double common = curve.per_m * (p - grid.reference_mm[index_of(axis)]) / kMmPerM;
      for (std::size_t i = 0; i < shapes.size(); ++i) common += shapes[i] * curve.unmeasured[i];
      for (std::size_t side = 0; side < kSides.size(); ++side) {
        double value = common;
        const laser::MapTable* table = table_of(machine_.map, static_cast<Component>(c), kSides[side]);
        if (table != nullptr && !table->position_mm.empty()) {
          const Table& drawn = curve.side[side];
          const TablePlace place = place_in(*table, p);
          const std::size_t above = std::min(place.below + 1, drawn.value.size() - 1);
          value += std::lerp(drawn.value[place.below], drawn.value[above], place.part) +
                   place.bow() * drawn.between[place.below];
          for (std::size_t i = 0; i < shapes.size(); ++i) value += shapes[i] * drawn.pass[i];
        }
        components.curve[side][c].push_back(value);
      }
    }
  }
  return components;
}

Field MapDraws::over(const Grid& grid) const {
  Field field(grid, components_over(grid), kinematics_);
  field.count_from_reference();
  return field;
}

Result<VolumeUncertainty> uncertainty_of(const CompensatedMachine& machine, const UncertaintyBudget& budget,
                                         const UncertaintySettings& settings, std::size_t places) {
  VolumeUncertainty out;
  const Vector3 reference_mm = reference_of(machine.parameters);
  const Grid few = grid_over(machine.travel_mm, kLinearPlaces, reference_mm);
  out.linear_rms_um = linear_rms_um(machine, budget, few);
  const Grid coarse = grid_over(machine.travel_mm, std::min(places, kMostDrawnPlaces), reference_mm);
  const auto known = errors_over(machine, coarse);
  if (!known) return tl::unexpected(known.error());
  const bool climbs = places > kMostDrawnPlaces && known->after.vectors.empty();
  const Grid fine = climbs ? grid_over(machine.travel_mm, places, reference_mm) : coarse;
  const auto known_between = climbs ? errors_over(machine, fine) : known;
  if (!known_between) return tl::unexpected(known_between.error());

  double drawn = 0.0;
  std::vector<double> largest, rms;
  MapDraws draws(machine, budget, settings.seed);
  for (std::size_t k = 0; k < settings.draws; ++k) {
    draws.next();
    drawn += std::pow(size_of(few, {draws.over(few), {}}).rms_um, 2) / static_cast<double>(settings.draws);
    const ErrorSize size = size_of(coarse, sum_of(draws.over(coarse), known->after));
    rms.push_back(size.rms_um);
    largest.push_back(climbs ? climbed(sum_of(draws.over(fine), known_between->after), side_of(size.approach),
                                       nearest(fine, size.at_mm))
                             : size.largest_um);
  }
  out.drawn_rms_um = std::sqrt(drawn);
  if (largest.empty()) return out;
  out.largest_95_um = quantile_of(largest, 0.95);
  out.rms_95_um = quantile_of(rms, 0.95);
  out.largest_50_um = quantile_of(largest, 0.5);
  out.rms_50_um = quantile_of(rms, 0.5);
  return out;
}

}  // namespace ecs::volume
