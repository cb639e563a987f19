#include "modules/hidden_cases/measure.hpp"

#include <cmath>

#include "base/units.hpp"
#include "ecs_emulator/effects/definition.hpp"
#include "ecs_emulator/errors/kinematics.hpp"
#include "ecs_emulator/random/random.hpp"
#include "ecs_emulator/scene/scene.hpp"

namespace ecs::emulator {
namespace {

/// A stop as the effect sees it.
class StopConditions final : public Conditions {
 public:
  StopConditions(const Scene& scene, const PlacedEffect& effect, const Stop& stop)
      : scene_(scene), effect_(effect), stop_(stop) {
    p_mm = scene.p_mm(stop, effect.axis.value_or(Axis::X));
    approach = stop.approach;
    if (!effect.curve.empty()) curve = value_at(effect.curve, p_mm);
    time_s = stop.time_s;
    feed_mm_min = stop.feed_mm_min;
    load_kg = stop.load_kg;
    travel_since_reversal_mm = stop.travel_since_reversal_mm;
  }
  [[nodiscard]] double material_degC() const override { return scene_.degC("t_material_degC", stop_, 20.0); }
  [[nodiscard]] double degC(const std::string& sensor) const override { return scene_.degC(sensor, stop_, 0.0); }
  [[nodiscard]] double first_degC(const std::string& sensor) const override {
    return scene_.degC(sensor, scene_.stops.front(), 0.0);
  }
  [[nodiscard]] double missing_refraction() const override { return emulator::missing_refraction(scene_, stop_); }
  [[nodiscard]] double known_value() const override {
    for (const KnownCurve& known : scene_.known)
      if (known.code == *effect_.code)
        return between_points(known.p_mm, known.value, stop_.position_mm[index_of(moving_axis(known.code))]);
    return 0.0;
  }

 private:
  const Scene& scene_;
  const PlacedEffect& effect_;
  const Stop& stop_;
};

/// The fault that concerns a curve of the map, if any does.
bool concerns(const PlacedEffect& fault, Axis axis, Sense sense) {
  return fault.kind->seat == Seat::unit && (!fault.axis || *fault.axis == axis) &&
         (!fault.sense || *fault.sense == sense);
}

double faulty_value(const Scene& scene, const std::vector<PlacedEffect>& effects, const Stop& stop, Axis axis,
                    Sense sense) {
  MapReading reading{stop.position_mm[index_of(axis)], axis == stop.axis ? stop.approach : 0, 1.0};
  for (const PlacedEffect& fault : effects)
    if (concerns(fault, axis, sense)) fault.kind->spoil(fault, reading);
  return reading.gain * table_value(scene.map, axis, sense, reading.position_mm, reading.approach);
}

constexpr double kThermometer_degC = 0.004;

/// From one run to the next a zero keeps this part of itself, and a walk makes the size of its share in so many rows.
constexpr double kMemoryOfRuns = 0.6, kRowsOfWalk = 30.0;

double seen(const ToolPose& pose, Sense sense) {
  const std::size_t direction = index_of(direction_of(sense));
  return is_rotation(sense) ? pose.rotation_um_per_m[direction] : pose.error_um[direction];
}

/// What the map was made to take away: the machine errs by its negative.
void add_mapped_errors(const Scene& scene, const Stop& stop, ComponentValues& errors) {
  for (const UnitTable& table : scene.map) {
    if (table.approach == Approach::reverse) continue;  // the curve's forward table stands for both
    errors[index_of(curve_of(table.sense, table.axis))] -=
        table_value(scene.map, table.axis, table.sense, stop.position_mm[index_of(table.axis)],
                    table.axis == stop.axis ? stop.approach : 0);
  }
}

/// Student's t of three degrees of freedom, of variance 1.
double student_of_three(Random& random) {
  double squares = 0.0;
  for (int k = 0; k < 3; ++k) squares += std::pow(random.normal(), 2);
  return random.normal() / std::sqrt(squares);
}

}  // namespace

double amount(const Scene& scene, const PlacedEffect& effect, const Stop& stop) {
  return acts_on(effect, stop) ? effect.kind->value(effect, StopConditions(scene, effect, stop)) : 0.0;
}

double share_in(const Scene& scene, Component component, const Stop& stop) {
  if (is_rotation(stop.sense)) return !is_squareness(component) && sense_of(component) == stop.sense ? 1.0 : 0.0;
  ComponentValues one{};
  one[index_of(component)] = 1.0;
  return tool_error_um(scene.terms, one, stop.position_mm, scene.lines_mm, {})[index_of(direction_of(stop.sense))];
}

double table_value(const UnitMap& map, Axis axis, Sense sense, double position_mm, int approach) {
  for (const UnitTable& table : map) {
    if (table.axis != axis || table.sense != sense) continue;
    if (table.approach == Approach::unknown || approach == 0 || static_cast<int>(table.approach) == approach)
      return between_points(table.p_mm, table.value, position_mm);
  }
  return 0.0;
}

double unit_compensation(const Scene& scene, const std::vector<PlacedEffect>& effects, const Stop& stop) {
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

std::vector<double> contribution(const Scene& scene, const PlacedEffect& effect) {
  std::vector<double> sum(scene.stops.size());
  const std::vector<PlacedEffect> parts = parts_of(effect);
  for (std::size_t k = 0; k < sum.size(); ++k) {
    const Stop& stop = scene.stops[k];
    switch (effect.kind->seat) {
      case Seat::machine:
        for (const PlacedEffect& part : parts)
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

std::vector<double> exact_errors(const Scene& scene, const std::vector<PlacedEffect>& effects,
                                 const std::vector<double>& extra) {
  const ChainGeometry geometry{scene.chain, scene.lines_mm, {}};
  std::vector<PlacedEffect> parts;
  for (const PlacedEffect& effect : effects)
    for (PlacedEffect& part : parts_of(effect)) parts.push_back(std::move(part));
  std::vector<double> readings;
  readings.reserve(scene.stops.size());
  for (const Stop& stop : scene.stops) {
    ComponentValues errors{};
    double laser = 0.0;
    for (const PlacedEffect& effect : parts) {
      const Seat seat = effect.kind->seat;
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

}  // namespace ecs::emulator
