#include "modules/controllers/curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include <fmt/format.h>

namespace ecs::controllers {
namespace {

/// Values at a place, by straight lines between points.
double joined(const std::vector<double>& p, const std::vector<double>& value, double at) {
  if (at <= p.front()) return value.front();
  if (at >= p.back()) return value.back();
  const auto above = static_cast<std::size_t>(std::upper_bound(p.begin(), p.end(), at) - p.begin());
  return std::lerp(value[above - 1], value[above], (at - p[above - 1]) / (p[above] - p[above - 1]));
}

/// Stretch between two chosen points, with the point between that its line misses by most.
struct Stretch {
  double miss = 0.0;
  std::size_t first = 0, last = 0, worst = 0;
  bool operator<(const Stretch& other) const { return miss < other.miss; }
};

Stretch stretch_of(const ControlCurve& curve, std::size_t first, std::size_t last) {
  Stretch stretch{0.0, first, last, first};
  const auto& p = curve.position_mm;
  for (std::size_t i = first + 1; i < last; ++i) {
    const double part = (p[i] - p[first]) / (p[last] - p[first]);
    for (const auto* side : {&curve.forward, &curve.reverse}) {
      const double miss = std::abs((*side)[i] - std::lerp((*side)[first], (*side)[last], part));
      if (miss > stretch.miss) stretch = {miss, first, last, i};
    }
  }
  return stretch;
}

/// Points that stay, and how far the lines between them miss the others.
struct Choice {
  std::vector<std::size_t> kept;
  double miss = 0.0;
};

/// The point that the lines miss by most is added first.
Choice greedy(const ControlCurve& curve, std::size_t most) {
  const std::size_t last = curve.position_mm.size() - 1;
  Choice choice{{0, last}, 0.0};
  std::priority_queue<Stretch> open;
  open.push(stretch_of(curve, 0, last));
  while (choice.kept.size() < most && open.top().miss > 0.0) {
    const Stretch widest = open.top();
    open.pop();
    choice.kept.push_back(widest.worst);
    open.push(stretch_of(curve, widest.first, widest.worst));
    open.push(stretch_of(curve, widest.worst, widest.last));
  }
  choice.miss = open.top().miss;
  std::ranges::sort(choice.kept);
  return choice;
}

constexpr std::size_t kMostForSearch = 5000;  ///< the search for the fewest points takes the square of the number

/// The slopes of lines from one point that miss none of the points passed so far by more than a tolerance.
struct Wedge {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  void narrow(double rise, double run, double tolerance) {
    least = std::max(least, (rise - tolerance) / run);
    most = std::min(most, (rise + tolerance) / run);
  }
  [[nodiscard]] bool holds(double slope) const { return slope >= least && slope <= most; }
};

/// The fewest points of the curve between which straight lines miss no other by more than `tolerance`.
std::vector<std::size_t> fewest_within(const ControlCurve& curve, double tolerance) {
  const std::size_t count = curve.position_mm.size();
  std::vector<std::size_t> points(count, count + 1), from(count, 0);
  points[0] = 1;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    Wedge forward, reverse;
    for (std::size_t j = i + 1; j < count; ++j) {
      const double run = curve.position_mm[j] - curve.position_mm[i];
      const double rise_forward = curve.forward[j] - curve.forward[i];
      const double rise_reverse = curve.reverse[j] - curve.reverse[i];
      if (forward.holds(rise_forward / run) && reverse.holds(rise_reverse / run) && points[i] + 1 < points[j]) {
        points[j] = points[i] + 1;
        from[j] = i;
      }
      forward.narrow(rise_forward, run, tolerance);
      reverse.narrow(rise_reverse, run, tolerance);
      if (forward.least > forward.most || reverse.least > reverse.most) break;
    }
  }
  std::vector<std::size_t> kept;
  for (std::size_t j = count - 1; j > 0; j = from[j]) kept.push_back(j);
  kept.push_back(0);
  std::ranges::reverse(kept);
  return kept;
}

ControlCurve chosen_of(const ControlCurve& curve, const std::vector<std::size_t>& kept) {
  ControlCurve out;
  for (const std::size_t i : kept) {
    out.position_mm.push_back(curve.position_mm[i]);
    out.forward.push_back(curve.forward[i]);
    out.reverse.push_back(curve.reverse[i]);
  }
  return out;
}

constexpr double kNanometre_mm = 1e-6;
constexpr double kNanometresPerMm = 1e6;

EvenGrid grid_with(const ControlCurve& curve, std::size_t points) {
  const double first = std::floor(curve.position_mm.front() * kNanometresPerMm + 1e-3) / kNanometresPerMm;
  const double exact = (curve.position_mm.back() - first) / static_cast<double>(points - 1);
  const double up = std::ceil(exact / kNanometre_mm - 1e-6) * kNanometre_mm;
  return {first, std::max(up, kNanometre_mm), points};
}

/// Largest difference between two joined curves; both are straight between the points of either.
double largest_difference(const ControlCurve& a, const ControlCurve& b) {
  double largest = 0.0;
  for (const Approach approach : {Approach::forward, Approach::reverse})
    for (const auto* points : {&a.position_mm, &b.position_mm})
      for (const double p : *points)
        largest = std::max(largest, std::abs(value_at(a, approach, p) - value_at(b, approach, p)));
  return largest;
}

bool is_even(const ControlCurve& curve, const EvenGrid& grid) {
  for (std::size_t i = 0; i < curve.position_mm.size(); ++i) {
    const double even = grid.first_mm + grid.step_mm * static_cast<double>(i);
    if (std::abs(curve.position_mm[i] - even) > kNanometre_mm * static_cast<double>(grid.points)) return false;
  }
  return true;
}

/// Numbers of points worth trying, at most `most`.
std::vector<std::size_t> numbers_to_try(std::size_t points_of_curve, std::size_t most) {
  constexpr std::size_t kFinest = 24;
  std::vector<std::size_t> tries;
  for (std::size_t n = most; n >= 2 && most - n < kFinest; --n) tries.push_back(n);
  for (std::size_t every = 2; every < points_of_curve && tries.size() < 2 * kFinest; ++every)
    if ((points_of_curve - 1) % every == 0 && (points_of_curve - 1) / every + 1 <= most)
      tries.push_back((points_of_curve - 1) / every + 1);
  return tries;
}

}  // namespace

double value_at(const ControlCurve& curve, Approach approach, double position_mm) {
  return joined(curve.position_mm, approach == Approach::reverse ? curve.reverse : curve.forward, position_mm);
}

double mean_at(const ControlCurve& curve, double position_mm) {
  return 0.5 * (value_at(curve, Approach::forward, position_mm) + value_at(curve, Approach::reverse, position_mm));
}

std::optional<ControlCurve> curve_of(const laser::ErrorMap& map, Component component) {
  const laser::MapTable* forward = table_of(map, component, Approach::forward);
  const laser::MapTable* reverse = table_of(map, component, Approach::reverse);
  if (forward == nullptr || reverse == nullptr || forward->position_mm.empty() || reverse->position_mm.empty())
    return std::nullopt;
  ControlCurve curve;
  std::set_union(forward->position_mm.begin(), forward->position_mm.end(), reverse->position_mm.begin(),
                 reverse->position_mm.end(), std::back_inserter(curve.position_mm));
  for (const double p : curve.position_mm) {
    curve.forward.push_back(compensation_at(*forward, p));
    curve.reverse.push_back(compensation_at(*reverse, p));
  }
  return curve;
}

ControlCurve resampled(const ControlCurve& curve, std::vector<double> position_mm) {
  ControlCurve out;
  for (const double p : position_mm) {
    out.forward.push_back(value_at(curve, Approach::forward, p));
    out.reverse.push_back(value_at(curve, Approach::reverse, p));
  }
  out.position_mm = std::move(position_mm);
  return out;
}

ControlCurve thinned(const ControlCurve& curve, std::size_t most) {
  if (curve.position_mm.size() <= most) return curve;
  Choice best = greedy(curve, most);
  if (curve.position_mm.size() > kMostForSearch) return chosen_of(curve, best.kept);
  double low = 0.0, high = best.miss;
  for (int halving = 0; halving < 24 && high - low > 1e-6; ++halving) {
    const double middle = 0.5 * (low + high);
    const auto kept = fewest_within(curve, middle);
    (kept.size() <= most ? high : low) = middle;
    if (kept.size() <= most) best.kept = kept;
  }
  return chosen_of(curve, best.kept);
}

std::vector<double> EvenGrid::positions() const {
  std::vector<double> all;
  for (std::size_t i = 0; i < points; ++i) all.push_back(first_mm + step_mm * static_cast<double>(i));
  return all;
}

EvenGrid even_grid(const ControlCurve& curve, std::size_t most) {
  const std::size_t count = curve.position_mm.size();
  if (count <= most) {
    const EvenGrid own = grid_with(curve, count);
    if (is_even(curve, own)) return own;
  }
  EvenGrid best = grid_with(curve, most);
  double least = largest_difference(resampled(curve, best.positions()), curve);
  for (const std::size_t points : numbers_to_try(count, most)) {
    const EvenGrid tried = grid_with(curve, points);
    const double miss = largest_difference(resampled(curve, tried.positions()), curve);
    const double better = tried.points < best.points ? 0.95 * least : least;  // fewer points must be worth it
    if (miss < better - 1e-9) {
      least = miss;
      best = tried;
    }
  }
  return best;
}

double deviation_from_unit(const ControlCurve& written, const laser::ErrorMap& map, Component component,
                           Interpolation interpolation) {
  double largest = 0.0;
  for (const Approach approach : {Approach::forward, Approach::reverse}) {
    const laser::MapTable& table = *table_of(map, component, approach);
    const auto& p = table.position_mm;
    const auto look_at = [&](double position_mm, double unit) {
      largest = std::max(largest, std::abs(value_at(written, approach, position_mm) - unit));
    };
    for (const double at : written.position_mm) look_at(at, unit_value_at(table, interpolation, at));
    for (std::size_t i = 0; i < p.size(); ++i) {
      look_at(p[i], table.compensation[i]);
      if (interpolation == Interpolation::linear || i + 1 == p.size()) continue;
      const double step_mm = 0.5 * (p[i] + p[i + 1]);  // both sides of the step
      look_at(step_mm, table.compensation[i]);
      look_at(step_mm, table.compensation[i + 1]);
    }
  }
  return largest;
}

double largest_in(const ControlCurve& curve) {
  double largest = 0.0;
  for (const auto* side : {&curve.forward, &curve.reverse})
    for (const double value : *side) largest = std::max(largest, std::abs(value));
  return largest;
}

double largest_reversal(const ControlCurve& curve) {
  double most = 0.0;
  for (std::size_t i = 0; i < curve.position_mm.size(); ++i)
    most = std::max(most, std::abs(curve.forward[i] - curve.reverse[i]));
  return most;
}

ControlCurve mean_of(const ControlCurve& curve) {
  ControlCurve mean = curve;
  for (std::size_t i = 0; i < curve.position_mm.size(); ++i)
    mean.forward[i] = mean.reverse[i] = 0.5 * (curve.forward[i] + curve.reverse[i]);
  return mean;
}

std::string fixed_text(double value, int digits) {
  const std::string text = fmt::format("{:.{}f}", value, digits);
  return text.find_first_not_of("-0.") == std::string::npos && text.front() == '-' ? text.substr(1) : text;
}

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

/// Of an axis without a travel: where it was parked for the first line that has one.
double travel_at(const ExportSource& source, Axis axis, double part) {
  if (const auto& travel = source.travel_mm[index_of(axis)]) return std::lerp((*travel)[0], (*travel)[1], part);
  for (std::size_t line = 0; line < kAxes; ++line)
    if (source.travel_mm[line]) return source.parameters.measurement_lines_mm[line][index_of(axis)];
  return 0.0;
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
  const auto take_largest = [](ResidualSize& of, const ResidualSize& line) {
    for (std::size_t d = 0; d < of.largest_um.size(); ++d)
      of.largest_um[d] = std::max(of.largest_um[d], line.largest_um[d]);
  };
  for (const ResidualRow& line : rows) {  // they lie in the volume, between its places
    take_largest(rows.back().before, line.before);
    take_largest(rows.back().unit, line.unit);
    take_largest(rows.back().control, line.control);
  }
  return rows;
}

}  // namespace ecs::controllers
