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

}  // namespace ecs::emulator
