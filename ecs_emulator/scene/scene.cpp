#include "ecs_emulator/scene/scene.hpp"

#include <algorithm>
#include <cmath>

namespace ecs::emulator {

std::optional<std::size_t> Scene::sensor(const std::string& column) const {
  const auto found = std::find(sensors.begin(), sensors.end(), column);
  if (found == sensors.end()) return std::nullopt;
  return static_cast<std::size_t>(found - sensors.begin());
}

double Scene::degC(const std::string& column, const Stop& stop, double otherwise) const {
  const auto place = sensor(column);
  return place ? stop.weather.degC[*place] : otherwise;
}

double between_points(const std::vector<double>& x, const std::vector<double>& value, double at) {
  if (at <= x.front()) return value.front();
  if (at >= x.back()) return value.back();
  const auto above = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), at) - x.begin());
  return std::lerp(value[above - 1], value[above], (at - x[above - 1]) / (x[above] - x[above - 1]));
}

Axis Ground::natural_axis(Sense sense) const {
  int moved = 0;
  Axis only = direction_of(sense);
  for (const Axis a : kAllAxes)
    if (cover(sense, a).moved) {
      ++moved;
      only = a;
    }
  return moved == 1 ? only : direction_of(sense);
}

Ground ground_of(const Scene& scene) {
  Ground ground;
  std::array<std::array<int, 3>, 6> ways{};
  for (const Stop& stop : scene.stops) {
    const auto s = static_cast<std::size_t>(stop.sense);
    if (std::find(ground.senses.begin(), ground.senses.end(), stop.sense) == ground.senses.end())
      ground.senses.push_back(stop.sense);
    for (const Axis a : kAllAxes)
      if (scene.chain.has(a)) ground.covers[s][index_of(a)].places_mm.push_back(scene.p_mm(stop, a));
    ground.covers[s][index_of(stop.axis)].moved = true;
    ways[s][index_of(stop.axis)] |= stop.approach > 0 ? 1 : 2;
  }
  for (std::size_t s = 0; s < 6; ++s)
    for (std::size_t a = 0; a < 3; ++a) {
      auto& places = ground.covers[s][a].places_mm;
      std::sort(places.begin(), places.end());
      places.erase(std::unique(places.begin(), places.end()), places.end());
      ground.covers[s][a].both_ways = ways[s][a] == 3;
    }
  return ground;
}

double refractivity(double air_degC, double pressure_hPa, double humidity_pct) {
  constexpr double kWavenumber2 = 1.0 / (0.6329908 * 0.6329908);  // um^-2
  const double standard = 1e-8 * (8342.54 + 2406147.0 / (130.0 - kWavenumber2) + 15998.0 / (38.9 - kWavenumber2));
  const double pressure_Pa = pressure_hPa * 100.0;
  const double dry = standard * pressure_Pa / 96095.43 * (1.0 + 1e-8 * (0.601 - 0.00972 * air_degC) * pressure_Pa) /
                     (1.0 + 0.003661 * air_degC);
  const double saturated_Pa = 611.2 * std::exp(17.62 * air_degC / (243.12 + air_degC));
  return dry - 0.01 * humidity_pct * saturated_Pa * (3.7345 - 0.0401 * kWavenumber2) * 1e-10;
}

double missing_refraction(const Scene& scene, const Stop& stop) {
  return refractivity(scene.degC("t_air_degC", stop, 20.0), stop.weather.pressure_hPa, stop.weather.humidity_pct) -
         refractivity(20.0, 1013.25, 50.0);
}

}  // namespace ecs::emulator
