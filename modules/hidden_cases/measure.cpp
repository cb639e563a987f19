#include <algorithm>
#include <cmath>

#include "ecs_emulator/errors/kinematics.hpp"
#include "modules/hidden_cases/case.hpp"
#include "modules/hidden_cases/compose.hpp"

namespace ecs::emulator {
namespace {

/// Value of the effect's component, or what the instrument adds, at this stop [um, um/m]; 0 where it does not act.
/// @pre its seat is not the unit
double amount(const Scene& scene, const DrawnEffect& effect, const Stop& stop) {
  if (!acts_on(effect, stop)) return 0.0;
  if (const auto adds = hiding_of(effect).adds) return adds(effect, scene, stop);
  const EffectDefinition& kind = *effect.kind;
  Conditions at{.p_mm = scene.p_mm(stop, effect.axis.value_or(Axis::X)),
                .approach = static_cast<double>(stop.approach),
                .time_s = stop.time_s,
                .feed_mm_min = stop.feed_mm_min,
                .load_kg = stop.load_kg,
                .travel_since_reversal_mm = stop.travel_since_reversal_mm};
  if (kind.curve) at.curve = value_at(effect.curve, at.p_mm);
  if (kind.of_material) at.material_degC = scene.degC("t_material_degC", stop, 20.0);
  if (kind.sensors > 0) at.degC[0] = scene.degC(effect.sensor, stop, 0.0);
  if (kind.sensors > 0) at.first_degC = scene.degC(effect.sensor, scene.stops.front(), 0.0);
  if (kind.sensors > 1) at.degC[1] = scene.degC(effect.sensor2, stop, 0.0);
  return kind.value(effect, at);
}

/// How much of a component's value reaches the sense of this reading: levers and signs of the chain.
double share_in(const Scene& scene, Component component, const Stop& stop) {
  if (is_rotation(stop.sense)) return !is_squareness(component) && sense_of(component) == stop.sense ? 1.0 : 0.0;
  ComponentValues one{};
  one[index_of(component)] = 1.0;
  return tool_error_um(scene.terms, one, stop.position_mm, scene.lines_mm, {})[index_of(direction_of(stop.sense))];
}

/// Value of one of the map's curves; 0 where the map lacks it.
double table_value(const UnitMap& map, Axis axis, Sense sense, double position_mm, int approach) {
  for (const UnitTable& table : map) {
    if (table.axis != axis || table.sense != sense) continue;
    if (table.approach == Approach::unknown || approach == 0 || static_cast<int>(table.approach) == approach)
      return between_points(table.p_mm, table.value, position_mm);
  }
  return 0.0;
}

/// The fault that concerns a curve of the map, if any does.
bool concerns(const DrawnEffect& fault, Axis axis, Sense sense) {
  return hiding_of(fault).seat == Seat::unit && (!fault.axis || *fault.axis == axis) &&
         (!fault.sense || *fault.sense == sense);
}

double faulty_value(const Scene& scene, const std::vector<DrawnEffect>& effects, const Stop& stop, Axis axis,
                    Sense sense) {
  MapReading reading{stop.position_mm[index_of(axis)], axis == stop.axis ? stop.approach : 0, 1.0};
  for (const DrawnEffect& fault : effects)
    if (concerns(fault, axis, sense)) hiding_of(fault).spoil(fault, reading);
  return reading.gain * table_value(scene.map, axis, sense, reading.position_mm, reading.approach);
}

/// Compensation that a unit adds to this reading, with the faults among `effects` [um, um/m].
double unit_compensation(const Scene& scene, const std::vector<DrawnEffect>& effects, const Stop& stop) {
  double sum = 0.0;
  for (std::size_t i = 0; i < scene.map.size(); ++i) {
    const UnitTable& table = scene.map[i];
    const bool again = i > 0 && scene.map[i - 1].axis == table.axis && scene.map[i - 1].sense == table.sense;
    if (again) continue;  // the reverse table of the same curve
    const double share = share_in(scene, curve_of(table.sense, table.axis), stop);
    if (share != 0.0) sum += share * faulty_value(scene, effects, stop, table.axis, table.sense);
  }
  return sum;
}

constexpr double kThermometer_degC = 0.004;

/// From one run to the next a zero keeps this part of itself, and a walk makes the size of its share in this many rows.
constexpr double kMemoryOfRuns = 0.6, kRowsOfWalk = 30.0;

/// What the map was made to take away: the machine errs by its negative.
void add_mapped_errors(const Scene& scene, const Stop& stop, ComponentValues& errors) {
  for (const UnitTable& table : scene.map) {
    if (table.approach == Approach::reverse) continue;  // the curve's forward table stands for both
    errors[index_of(curve_of(table.sense, table.axis))] -=
        table_value(scene.map, table.axis, table.sense, stop.position_mm[index_of(table.axis)],
                    table.axis == stop.axis ? stop.approach : 0);
  }
}

std::vector<DrawnEffect> drawn_parts_of(const DrawnEffect& effect) {
  std::vector<DrawnEffect> parts;
  for (PlacedEffect& part : parts_of(effect)) parts.push_back({std::move(part), effect.curve});
  return parts;
}

/// Student's t of three degrees of freedom, of variance 1.
double student_of_three(Random& random) {
  double squares = 0.0;
  for (int k = 0; k < 3; ++k) squares += std::pow(random.normal(), 2);
  return random.normal() / std::sqrt(squares);
}

}  // namespace

std::vector<double> contribution(const Scene& scene, const DrawnEffect& effect) {
  std::vector<double> sum(scene.stops.size());
  const std::vector<DrawnEffect> parts = drawn_parts_of(effect);
  for (std::size_t k = 0; k < sum.size(); ++k) {
    const Stop& stop = scene.stops[k];
    switch (hiding_of(effect).seat) {
      case Seat::machine:
        for (const DrawnEffect& part : parts)
          sum[k] += amount(scene, part, stop) * share_in(scene, carrier_of(part), stop);
        break;
      case Seat::instrument:
        sum[k] = amount(scene, effect, stop);
        break;
      case Seat::unit:
        sum[k] = unit_compensation(scene, {effect}, stop) - unit_compensation(scene, {}, stop);
        break;
    }
  }
  return sum;
}

std::vector<double> exact_errors(const Scene& scene, const std::vector<DrawnEffect>& effects,
                                 const std::vector<double>& extra) {
  const ChainGeometry geometry{scene.chain, scene.lines_mm, {}};
  std::vector<DrawnEffect> parts;
  for (const DrawnEffect& effect : effects)
    for (DrawnEffect& part : drawn_parts_of(effect)) parts.push_back(std::move(part));
  std::vector<double> readings;
  readings.reserve(scene.stops.size());
  for (const Stop& stop : scene.stops) {
    ComponentValues errors{};
    double laser = 0.0;
    for (const DrawnEffect& effect : parts) {
      const Seat seat = hiding_of(effect).seat;
      if (seat == Seat::machine) errors[index_of(carrier_of(effect))] += amount(scene, effect, stop);
      if (seat == Seat::instrument) laser += amount(scene, effect, stop);
    }
    add_mapped_errors(scene, stop, errors);
    if (!extra.empty()) errors[index_of(curve_of(stop.sense, stop.axis))] += extra[readings.size()];
    readings.push_back(seen(tool_pose(geometry, errors, stop.position_mm), stop.sense) +
                       unit_compensation(scene, effects, stop) + laser);
  }
  return readings;
}

std::vector<double> draw_noise(Random& random, const Scene& scene, const Noise& noise) {
  const double white_um = noise.sigma_um * std::sqrt(1.0 - noise.correlated_share);
  const double turbulence_um = noise.sigma_um * std::sqrt(noise.correlated_share);
  double turbulence = random.normal();
  const Stop* before = scene.stops.data();
  std::vector<double> drawn;
  for (const Stop& stop : scene.stops) {
    if (noise.law == NoiseLaw::random_walk) {
      turbulence += random.normal() / std::sqrt(kRowsOfWalk);
    } else if (noise.law != NoiseLaw::by_run || stop.run != before->run) {
      const double memory = noise.law == NoiseLaw::by_run
                                ? kMemoryOfRuns
                                : std::exp(-(stop.time_s - before->time_s) / noise.correlation_s);
      turbulence = memory * turbulence + std::sqrt(1.0 - memory * memory) * random.normal();
    }
    before = &stop;
    const double own = noise.law == NoiseLaw::heavy_tails ? student_of_three(random) : random.normal();
    double value = white_um * own + turbulence_um * turbulence;
    if (chance(random, noise.outlier_probability))
      value += sign_of_chance(random) * between(random, 7.0, 20.0) * noise.sigma_um;
    drawn.push_back(value);
  }
  return drawn;
}

Scene as_recorded(Random& random, Scene scene) {
  bool changes = false;
  for (const Stop& stop : scene.stops) changes = changes || stop.weather.degC != scene.stops.front().weather.degC;
  const double noise_degC = changes ? kThermometer_degC : 0.0;
  for (Stop& stop : scene.stops) {
    for (double& degC : stop.weather.degC) degC = rounded(degC + noise_degC * random.normal(), 100.0);
    stop.weather.pressure_hPa = rounded(stop.weather.pressure_hPa, 100.0);
    stop.weather.humidity_pct = rounded(stop.weather.humidity_pct, 10.0);
    stop.travel_since_reversal_mm = rounded(stop.travel_since_reversal_mm, 100.0);
  }
  return scene;
}

namespace {

constexpr double kSmallStep = 1e-4;  ///< of a parameter, for a slope
constexpr double kNothing = 1e-7;    ///< of its size: what is left of a column that is absorbed already

double distance(const Eigen::MatrixXd& left_columns, const Eigen::VectorXd& left, const Hiding& hiding) {
  if (hiding.fixed_size) return (left - left_columns.col(0)).norm();
  if (left_columns.cols() == 1) {
    const double length2 = left_columns.col(0).squaredNorm();
    const double coefficient = left_columns.col(0).dot(left) / length2;
    if (hiding.square && coefficient < 0.0) return left.norm();
    return (left - coefficient * left_columns.col(0)).norm();
  }
  Absorbed own(static_cast<std::size_t>(left.size()));
  own.add(left_columns);
  return own.left_of(left).norm();
}

/// How its contribution changes with the parameter that is searched (readings × parameters).
Eigen::MatrixXd slope_columns(const Scene& scene, const DrawnEffect& effect) {
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(scene.stops.size()), 0);
  if (hiding_of(effect).search == nullptr) return columns;
  const auto at = [&](double factor) {
    DrawnEffect moved = effect;
    moved.parameters[std::string(hiding_of(effect).searched)] *= factor;
    return vector_of(contribution(scene, moved));
  };
  columns.conservativeResize(Eigen::NoChange, 1);
  columns.rightCols(1) = at(1.0 + kSmallStep) - at(1.0 - kSmallStep);
  return columns;
}

constexpr double kLeastInFreeBase = 0.08;  ///< how often a free base holds an effect at a good place

bool same_place(const DrawnEffect& a, const DrawnEffect& b) { return name_of(a) == name_of(b); }

class Background {
 public:
  Background(Random& random, const Scene& scene, const Ground& ground, const Reserved& reserved, Absorbed& absorbed)
      : random_(random), scene_(scene), ground_(ground), reserved_(reserved), absorbed_(absorbed) {
    for (const DrawnEffect& hidden : reserved.hidden) hidden_.push_back(vector_of(contribution(scene, hidden)));
    most_functions_ = std::min<Eigen::Index>(45, static_cast<Eigen::Index>(scene.stops.size()) / 8);
  }

  std::vector<DrawnEffect> draw() {
    for (const EffectDefinition& kind : effects())
      if (hiding_of(kind).in_every_base)
        for (const DrawnEffect& place : places_of(kind, scene_, ground_, true)) take(place, 0.0);
    for (const DrawnEffect& place : reserved_.needed) take(place, 0.0);
    std::vector<DrawnEffect> wanted;
    for (const EffectDefinition& kind : effects())
      if (const double probability = base_probability(hiding_of(kind)); probability > 0.0)
        for (const DrawnEffect& place : places_of(kind, scene_, ground_, true))
          if (chance(random_, probability)) wanted.push_back(place);
    shuffle(random_, wanted);
    const std::size_t most = taken_.size() + static_cast<std::size_t>(whole(random_, 1, 4)) + ground_.senses.size();
    for (const DrawnEffect& place : wanted)
      if (taken_.size() < most) take_with_its_line(place);
    return std::move(taken_);
  }

 private:
  [[nodiscard]] double base_probability(const Hiding& hiding) const {
    if (!reserved_.free || hiding.seat == Seat::unit) return hiding.base_probability;
    return std::max(hiding.base_probability, kLeastInFreeBase);
  }

  /// A curve without mean and slope comes with the effect that has them.
  void take_with_its_line(const DrawnEffect& place) {
    const auto line = line_of(place);
    if (line && !holds(*line) && !take(*line, 0.1)) return;
    take(place, 0.1);
  }

  [[nodiscard]] bool holds(const DrawnEffect& place) const {
    return std::any_of(taken_.begin(), taken_.end(), [&](const auto& t) { return same_place(t, place); });
  }
  [[nodiscard]] bool is_free(const DrawnEffect& place) const {
    return !holds(place) && (hiding_of(place).excluded_from & reserved_.design) == 0 &&
           std::none_of(reserved_.hidden.begin(), reserved_.hidden.end(),
                        [&](const auto& hidden) { return same_place(hidden, place); });
  }

  /// @param share  least part of its mean square that the model did not hold before
  bool take(const DrawnEffect& place, double share) {
    if (!is_free(place)) return false;
    const auto effect = with_shape(random_, scene_, ground_, place);
    if (!effect) return false;
    const Eigen::MatrixXd columns = contribution_columns(scene_, ground_, *effect);
    const Eigen::VectorXd own = vector_of(contribution(scene_, *effect));
    if (rms_of(own) == 0.0 || absorbed_.size() + columns.cols() > most_functions_) return false;
    if (absorbed_.left_of(own).squaredNorm() < share * own.squaredNorm()) return false;
    Absorbed more = absorbed_;
    more.add(columns);
    if (reserved_.free) more.add(slope_columns(scene_, *effect));
    for (const Eigen::VectorXd& hidden : hidden_)
      if (more.left_of(hidden).squaredNorm() < kLeastShare * hidden.squaredNorm()) return false;
    absorbed_ = more;
    taken_.push_back(*effect);
    return true;
  }

  Random& random_;
  const Scene& scene_;
  const Ground& ground_;
  const Reserved& reserved_;
  Absorbed& absorbed_;
  std::vector<Eigen::VectorXd> hidden_;
  std::vector<DrawnEffect> taken_;
  Eigen::Index most_functions_ = 45;
};

}  // namespace

Eigen::VectorXd vector_of(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

double rms_of(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

Eigen::MatrixXd contribution_columns(const Scene& scene, const Ground& ground, const DrawnEffect& effect) {
  const auto units = unit_effects(ground, effect);
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(scene.stops.size()), static_cast<Eigen::Index>(units.size()));
  for (std::size_t k = 0; k < units.size(); ++k)
    columns.col(static_cast<Eigen::Index>(k)) = vector_of(contribution(scene, units[k]));
  return columns;
}

void Absorbed::add(const Eigen::MatrixXd& columns) {
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const double size = columns.col(k).norm();
    if (!(size > 0.0)) continue;
    Eigen::VectorXd left = columns.col(k) / size;
    for (int twice = 0; twice < 2; ++twice) left -= basis_ * (basis_.transpose() * left);
    if (left.norm() < kNothing) continue;
    basis_.conservativeResize(Eigen::NoChange, basis_.cols() + 1);
    basis_.col(basis_.cols() - 1) = left.normalized();
  }
}

Eigen::MatrixXd Absorbed::left_of(const Eigen::MatrixXd& columns) const {
  Eigen::MatrixXd left = columns;
  for (int twice = 0; twice < 2; ++twice) left -= basis_ * (basis_.transpose() * left);
  for (Eigen::Index k = 0; k < left.cols(); ++k)
    if (left.col(k).norm() < kNothing * columns.col(k).norm()) left.col(k).setZero();
  return left;
}

Eigen::VectorXd Absorbed::left_of(const Eigen::VectorXd& values) const {
  Eigen::VectorXd left = values;
  for (int twice = 0; twice < 2; ++twice) left -= basis_ * (basis_.transpose() * left);
  return left;
}

std::vector<Rival> rivals_of(const Scene& scene, const Ground& ground, const Absorbed& absorbed,
                             const Eigen::VectorXd& hidden, double sigma_um, bool flexible,
                             const std::function<bool(const Rival&)>& enough) {
  const Eigen::VectorXd left = absorbed.left_of(hidden);
  std::vector<Rival> rivals;
  for (const EffectDefinition& kind : effects()) {
    const Hiding& hiding = hiding_of(kind);
    if (hiding.is_flexible() && !flexible) continue;
    for (const DrawnEffect& place : places_of(kind, scene, ground)) {
      Rival rival{place, left.norm() / sigma_um, 0.0, hiding.is_flexible()};
      for (const DrawnEffect& trial : trials_of(scene, ground, place)) {
        const Eigen::MatrixXd columns = contribution_columns(scene, ground, trial);
        if (columns.cols() == 0) continue;
        const Eigen::MatrixXd left_columns = absorbed.left_of(columns);
        if (left_columns.norm() == 0.0) continue;
        const double separation = distance(left_columns, left, hiding) / sigma_um;
        if (separation < rival.separation) {
          rival.separation = separation;
          rival.effect = trial;
          rival.size =
              left_columns.cols() == 1 ? left_columns.col(0).dot(left) / left_columns.col(0).squaredNorm() : 1.0;
        }
      }
      rivals.push_back(rival);
      if (enough && enough(rival)) return rivals;
    }
  }
  return rivals;
}

std::optional<DrawnEffect> line_of(const DrawnEffect& effect) {
  if (hiding_of(effect).line.empty()) return std::nullopt;
  return at_place(*effect_named(hiding_of(effect).line), effect.axis, effect.sense);
}

std::vector<DrawnEffect> draw_background(Random& random, const Scene& scene, const Ground& ground,
                                         const Reserved& reserved, Absorbed& absorbed) {
  return Background(random, scene, ground, reserved, absorbed).draw();
}

}  // namespace ecs::emulator
