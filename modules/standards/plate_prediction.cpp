// The form that a surface has if the errors of a map cut it without compensation, beside the form that was measured.
#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "laser/standards/zone.hpp"
#include "modules/standards/plate.hpp"
#include "volume/volume.hpp"

namespace ecs::laser {
namespace {

/// Where the surface lay on the machine that cut it.
struct PlatePlace {
  std::array<std::size_t, 2> axis{};  ///< east and north
  Vector3 south_west_mm{};
};

Result<PlatePlace> place_of(const PlateReadings& plate) {
  PlatePlace place;
  const std::string plane = metadata_value(plate.metadata, "plane").value_or("");
  const std::string corner = metadata_value(plate.metadata, "south_west_mm").value_or("");
  const auto is_axis = [](char letter) { return letter >= 'X' && letter <= 'Z'; };
  const auto coordinates = split(corner, ' ');
  bool complete = plane.size() == 2 && is_axis(plane[0]) && is_axis(plane[1]) && plane[0] != plane[1] &&
                  coordinates.size() == kAxes;
  for (std::size_t a = 0; complete && a < kAxes; ++a) {
    const auto number = number_in(coordinates[a]);
    complete = number.has_value();
    place.south_west_mm[a] = number.value_or(0.0);
  }
  if (!complete)
    return problem_at(plate.source, 0, 0,
                      "expected where the surface lay on the machine, `# plane: XZ` and `# south_west_mm: "
                      "-2950 -1200 -875` (X, Y, Z), found {} and {}",
                      in_quotes(plane), in_quotes(corner));
  for (std::size_t i = 0; i < 2; ++i) place.axis[i] = static_cast<std::size_t>(plane[i] - 'X');
  return place;
}

/// Heights above their plane of least squares.
std::vector<double> form_of(std::vector<ZonePoint> points, double& range_um) {
  const Zone plane = least_squares_zone(points);
  range_um = plane.width();
  std::vector<double> form;
  double mean = 0.0;
  for (const ZonePoint& point : points) {
    form.push_back(point.value - plane.per_u * point.u - plane.per_v * point.v);
    mean += form.back() / static_cast<double>(points.size());
  }
  for (double& height : form) height -= mean;
  return form;
}

}  // namespace

Result<PredictedForm> predicted_form(const PlateReadings& readings, const Flatness& measured, const ErrorMap& map,
                                     const UnitParameters& parameters) {
  ECS_TRY(place, place_of(readings));
  const volume::ErrorSource errors = volume::errors_of_map(map, parameters, {});
  volume::Travels travel_mm{};
  for (std::size_t a = 0; a < kAxes; ++a)
    if (parameters.axis_present[a]) travel_mm[a] = {place.south_west_mm[a], place.south_west_mm[a]};
  std::vector<ZonePoint> seen, predicted;
  for (const PlateStation& station : measured.stations) {
    Vector3 at_mm = place.south_west_mm;
    at_mm[place.axis[0]] += station.x_mm;
    at_mm[place.axis[1]] += station.y_mm;
    const volume::Grid grid = volume::grid_at(travel_mm, at_mm, volume::reference_of(parameters));
    ECS_TRY(components, errors.components(grid));
    const volume::Field field(grid, components, errors.kinematics);
    const std::size_t normal = 3 - place.axis[0] - place.axis[1];
    const double height_um = 0.5 * (field.at(0, {})[normal] + field.at(1, {})[normal]);
    seen.push_back({station.x_mm, station.y_mm, station.height_um});
    predicted.push_back({station.x_mm, station.y_mm, height_um});
  }
  PredictedForm out;
  double ignored = 0.0;
  const std::vector<double> here = form_of(std::move(seen), ignored);
  const std::vector<double> there = form_of(std::move(predicted), out.least_squares_um);
  for (std::size_t k = 0; k < here.size(); ++k) {
    const double difference = here[k] - there[k];
    out.difference_rms_um += difference * difference / static_cast<double>(here.size());
    out.difference_most_um = std::max(out.difference_most_um, std::abs(difference));
  }
  out.difference_rms_um = std::sqrt(out.difference_rms_um);
  return out;
}

}  // namespace ecs::laser
