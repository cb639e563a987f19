// The budget of a map: what its header states, its own roughness, and the settings. Linear propagation: the covariance
// of the error vector from the covariance along each curve (GUM 5.2.2, eq. 13). Monte Carlo: whole maps drawn from
// their uncertainty, and the largest and the rms error that each leaves (JCGM 101).
#include "volume/uncertainty.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.hpp"
#include "base/units.hpp"
#include "laser/groups.hpp"
#include "volume/curve_covariance.hpp"

namespace ecs::volume {
namespace {

constexpr double kLeastDegreesOfFreedom = 1.0;  ///< where a header states a scatter, but not how well it is known
constexpr double kMadToSigma = 1.4826;          ///< of a normal distribution

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
  return std::ranges::any_of(map.tables, [&](const laser::MapTable& table) {
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
  return kMadToSigma * laser::median_of(std::move(third)) / std::sqrt(20.0);
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

Gains gains_at(const Kinematics& kinematics, const Vector3& position_mm) {
  Gains gains{};
  for (const Term& term : kinematics.terms) {
    ComponentValues one{};
    one[index_of(term.component)] = 1.0;
    TermTable alone;
    alone.rows[alone.count++] = term;
    const Vector3 error = tool_error_um(alone, one, position_mm, kinematics.lines_mm, kinematics.tool_offset_mm);
    for (std::size_t d = 0; d < kAxes; ++d) gains[index_of(term.component)][d] += error[d];
  }
  return gains;
}

void add_product(Covariance& sum, const Vector3& a, const Vector3& b, double weight) {
  for (std::size_t i = 0; i < kAxes; ++i)
    for (std::size_t j = 0; j < kAxes; ++j) sum[i][j] += weight * a[i] * b[j];
}

void add_difference(Covariance& sum, const Vector3& here, const Vector3& there, const DifferenceCovariance& of) {
  add_product(sum, here, here, of.at_place);
  add_product(sum, here, there, -of.with_reference);
  add_product(sum, there, here, -of.with_reference);
  add_product(sum, there, there, of.of_reference);
}

bool is_certain(const CurveUncertainty& u) {
  return u.value == 0.0 && u.pass == 0.0 && u.between == 0.0 && u.per_m == 0.0 && u.unmeasured == 0.0;
}

Covariance covariance_at(const CompensatedMachine& machine, const UncertaintyBudget& budget, const Vector3& position_mm,
                         std::size_t side) {
  const Kinematics kinematics = errors_of_map(machine.map, machine.parameters, machine.tool_offset_mm).kinematics;
  const Vector3 reference_mm = reference_of(machine.parameters);
  const Gains here = gains_at(kinematics, position_mm), there = gains_at(kinematics, reference_mm);
  Covariance sum{};
  for (const CurveUncertainty& u : budget.curves) {
    if (is_certain(u)) continue;
    const std::size_t c = index_of(u.component);
    const Stop stop{position_mm[index_of(moving_axis(u.component))], side};
    add_difference(sum, here[c], there[c], difference_of(CurveCovariance(machine, u), stop));
  }
  for (std::size_t c = kCurves; c < kComponents; ++c) {
    Vector3 gain = here[c];
    for (std::size_t d = 0; d < kAxes; ++d) gain[d] -= there[c][d];
    add_product(sum, gain, gain, budget.squareness_um_per_m[c] * budget.squareness_um_per_m[c]);
  }
  return sum;
}

double linear_rms_um(const CompensatedMachine& machine, const UncertaintyBudget& budget, const Grid& grid) {
  double sum = 0.0;
  for (std::size_t side = 0; side < kSides.size(); ++side)
    for (const double x : grid.mm[0])
      for (const double y : grid.mm[1])
        for (const double z : grid.mm[2]) {
          const Covariance c = covariance_at(machine, budget, {x, y, z}, side);
          sum += c[0][0] + c[1][1] + c[2][2];
        }
  return std::sqrt(sum / static_cast<double>(kSides.size() * grid.places()));
}

double effective_degrees_of_freedom(const CompensatedMachine& machine, const UncertaintyBudget& budget,
                                    const Grid& grid) {
  double per_freedom = 0.0;
  for (std::size_t c = 0; c < kCurves; ++c) {
    const CurveUncertainty& u = budget.curves[c];
    if (u.pass == 0.0) continue;
    UncertaintyBudget alone;
    alone.curves[c] = {.component = u.component, .pass = u.pass};
    per_freedom += std::pow(linear_rms_um(machine, alone, grid), 4) / u.degrees_of_freedom;
  }
  return per_freedom > 0.0 ? std::pow(linear_rms_um(machine, budget, grid), 4) / per_freedom
                           : std::numeric_limits<double>::infinity();
}

std::vector<double> uncertainties_of(const laser::MapTable& table, const CompensatedMachine& machine,
                                     const UncertaintyBudget& budget) {
  const CurveUncertainty& u = budget.curves[index_of(table.component)];
  std::vector<double> out;
  const auto& travel_mm = machine.travel_mm[index_of(moving_axis(table.component))];
  if (!travel_mm) return out;
  const CurveCovariance curve(machine, u);
  const std::size_t side = side_of(table.approach);
  for (const double p : table.position_mm) out.push_back(std::sqrt(curve.of({p, side}, {p, side})));
  return out;
}

namespace {

constexpr std::size_t kMostDrawnPlaces = 14'000;  ///< of every draw; between them the largest error is climbed to
constexpr std::size_t kLinearPlaces = 125;        ///< at which linear propagation is compared with the draws
constexpr int kClimbs = 3;

/// The least value that `share` of the draws do not exceed.
double quantile_of(std::vector<double> draws, double share) {
  std::ranges::sort(draws);
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

void set_bounds(VolumeUncertainty& out, const std::vector<double>& largest, const std::vector<double>& rms) {
  if (largest.empty()) return;
  out.largest_95_um = quantile_of(largest, 0.95);
  out.rms_95_um = quantile_of(rms, 0.95);
  out.largest_50_um = quantile_of(largest, 0.5);
  out.rms_50_um = quantile_of(rms, 0.5);
}

MapDraws::MapDraws(const CompensatedMachine& machine, const UncertaintyBudget& budget, std::uint64_t seed)
    : machine_(machine),
      budget_(budget),
      kinematics_(errors_of_map(machine.map, machine.parameters, machine.tool_offset_mm).kinematics),
      generator_(seed),
      degrees_of_freedom_(effective_degrees_of_freedom(
          machine, budget, grid_over(machine.travel_mm, kLinearPlaces, reference_of(machine.parameters)))) {}

void MapDraws::next() {
  double tails = 1.0;
  if (std::isfinite(degrees_of_freedom_))
    tails = std::sqrt(degrees_of_freedom_ / ChiSquaredDraws(degrees_of_freedom_)(generator_));
  NormalDraws normal(0.0, tails);
  const auto shapes = [&](double size) {
    Shapes drawn{};
    for (double& one : drawn) one = size * normal(generator_);
    return drawn;
  };
  for (const CurveUncertainty& u : budget_.curves) {
    Curve& curve = curves_[index_of(u.component)];
    curve.unmeasured = shapes(u.unmeasured);
    curve.per_m = u.per_m * normal(generator_);
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
      drawn.pass = shapes(u.pass);
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
  set_bounds(out, largest, rms);
  return out;
}

}  // namespace ecs::volume
