#include "ecs_emulator/hidden_cases/measure.hpp"

#include <cmath>

#include "ecs_emulator/effects/definition.hpp"
#include "ecs_emulator/errors/kinematics.hpp"
#include "ecs_emulator/random/draw.hpp"

namespace ecs::emulator {
namespace {

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
