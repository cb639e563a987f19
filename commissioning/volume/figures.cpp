#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include <fmt/format.h>

#include "base/units.hpp"
#include "commissioning/volume/view.hpp"

namespace ecs::commissioning {
namespace {

using volume::BeforeAfter;
using volume::Grid;
using volume::GridIndex;
using volume::VolumeError;

constexpr std::size_t kPlacesAlongAWire = 21;
constexpr double kDrawn_um = 0.01;   ///< below, arrows would show rounding
constexpr double kDrawnPart = 0.12;  ///< of the longest travel that the largest error is drawn as

double length_of(const Vector3& v) { return std::hypot(v[0], v[1], v[2]); }

/// Seen from the front right above: X to the right, Z up, Y away from the eye.
PlotPoint projected(const Vector3& mm) {
  constexpr double kDepthX = 0.45, kDepthY = 0.32;
  return {mm[0] + kDepthX * mm[1], mm[2] + kDepthY * mm[1]};
}

Vector3 displaced(const Vector3& mm, const Vector3& error_um, double larger) {
  Vector3 out = mm;
  for (std::size_t d = 0; d < kAxes; ++d) out[d] += larger * error_um[d] / kUmPerMm;
  return out;
}

double longest_of(const volume::Travels& travel_mm) {
  double longest = 0.0;
  for (const auto& travel : travel_mm)
    if (travel) longest = std::max(longest, (*travel)[1] - (*travel)[0]);
  return longest;
}

/// A round factor that draws the largest error as a part of the longest travel.
double enlargement(double largest_um, double longest_mm) {
  if (largest_um <= 0.0) return 1.0;
  const double exact = kDrawnPart * longest_mm * kUmPerMm / largest_um;
  const double decade = std::pow(10.0, std::floor(std::log10(exact)));
  for (const double step : {5.0, 2.0, 1.0})
    if (step * decade <= exact) return step * decade;
  return decade;
}

/// The numbers at which wires cross: both ends and the middle.
std::vector<std::size_t> crossings(const Grid& grid, std::size_t axis) {
  if (!grid.exists[axis]) return {0};
  return {0, grid.mm[axis].size() / 2, grid.mm[axis].size() - 1};
}

/// Calls `each(from, to)` for every piece of the wires on the surface.
template <class Each>
void for_each_wire(const Grid& grid, const Each& each) {
  for (std::size_t along = 0; along < kAxes; ++along) {
    if (!grid.exists[along]) continue;
    const std::size_t u = (along + 1) % kAxes, v = (along + 2) % kAxes;
    for (const std::size_t i : crossings(grid, u))
      for (const std::size_t j : crossings(grid, v)) {
        const bool inside =
            grid.exists[u] && grid.exists[v] && i == crossings(grid, u)[1] && j == crossings(grid, v)[1];
        if (inside) continue;
        GridIndex from{};
        from[u] = i;
        from[v] = j;
        for (from[along] = 0; from[along] + 1 < grid.mm[along].size(); ++from[along]) {
          GridIndex to = from;
          ++to[along];
          each(from, to);
        }
      }
  }
}

std::vector<GridIndex> corners_of(const Grid& grid) {
  const auto ends = [&](std::size_t a) {
    return grid.exists[a] ? std::vector<std::size_t>{0, grid.mm[a].size() - 1} : std::vector<std::size_t>{0};
  };
  std::vector<GridIndex> corners;
  for (const std::size_t x : ends(0))
    for (const std::size_t y : ends(1))
      for (const std::size_t z : ends(2)) corners.push_back({x, y, z});
  return corners;
}

/// What the error at a place is below with 95 %, from either side.
struct PlaceBound {
  double length_um = 0.0;
  Vector3 along_um{};  ///< each axis on its own
};

/// What is left of what is known may be nothing: what may be there is what the uncertainty of the map allows. Not where
/// the true errors are known, nor with rotary axes, whose sizes are those over all angles.
bool shows_bound(const VolumeWork& work) {
  return work.prepared.errors_from != "the errors file" && !work.prepared.machine.rotary;
}

/// By the draws from which the bound of the whole volume comes.
std::vector<PlaceBound> bounds_at(const VolumeWork& work, const Grid& grid, const VolumeError& after,
                                  const std::vector<GridIndex>& places) {
  constexpr double kShare = 0.95;
  std::vector<std::array<std::vector<double>, kAxes + 1>> drawn(places.size());
  volume::MapDraws draws(work.prepared.machine, work.budget, work.settings.seed);
  for (std::size_t k = 0; k < work.settings.draws; ++k) {
    draws.next();
    const volume::Field field = draws.over(grid);
    for (std::size_t i = 0; i < places.size(); ++i) {
      std::array<double, kAxes + 1> most{};
      for (std::size_t side = 0; side < volume::kSides.size(); ++side) {
        Vector3 error_um = field.at(side, places[i]);
        const Vector3 known_um = after.at(grid, side, places[i]);
        for (std::size_t d = 0; d < kAxes; ++d) {
          error_um[d] += known_um[d];
          most[d] = std::max(most[d], std::abs(error_um[d]));
        }
        most[kAxes] = std::max(most[kAxes], length_of(error_um));
      }
      for (std::size_t d = 0; d < most.size(); ++d) drawn[i][d].push_back(most[d]);
    }
  }
  std::vector<PlaceBound> bounds(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto upper = [&](std::size_t d) {
      auto& values = drawn[i][d];
      const auto at = static_cast<std::ptrdiff_t>(kShare * static_cast<double>(values.size() - 1));
      std::nth_element(values.begin(), values.begin() + at, values.end());
      return values[static_cast<std::size_t>(at)];
    };
    bounds[i] = {upper(kAxes), {upper(0), upper(1), upper(2)}};
  }
  return bounds;
}

/// @param labels  of the corners, in the order of corners_of()
PlotPanel cube_panel(const std::string& title, const std::string& at_corners, const Grid& grid,
                     const VolumeError& error, double larger, std::vector<std::string> labels) {
  PlotPanel panel{title, "", "", {}, {}, true};
  PlotSeries nominal{"nominal", Mark::wire, {}},
      bent{fmt::format("errors enlarged {:.0f} times, {}", larger, at_corners), Mark::bent_wire, {}};
  for_each_wire(grid, [&](const GridIndex& from, const GridIndex& to) {
    for (const GridIndex& end : {from, to}) {
      nominal.points.push_back(projected(grid.at(end)));
      bent.points.push_back(projected(displaced(grid.at(end), mean_error(grid, error, end), larger)));
    }
  });
  PlotSeries corners{"", Mark::label, {}, std::move(labels)};
  for (const GridIndex& corner : corners_of(grid))
    corners.points.push_back(projected(displaced(grid.at(corner), mean_error(grid, error, corner), larger)));
  panel.series = {std::move(nominal), std::move(bent), std::move(corners)};
  return panel;
}

/// Sizes of the errors at the corners.
std::vector<std::string> corner_sizes(const Grid& grid, const VolumeError& error) {
  std::vector<std::string> labels;
  for (const GridIndex& corner : corners_of(grid))
    labels.push_back(fmt::format("{:.0f}", length_of(mean_error(grid, error, corner))));
  return labels;
}

PlotPanel bounded_cube_panel(const VolumeWork& work, const Grid& grid, const VolumeError& after, double larger) {
  std::vector<std::string> labels;
  for (const PlaceBound& bound : bounds_at(work, grid, after, corners_of(grid)))
    labels.push_back(fmt::format("{:.0f}", bound.length_um));
  return cube_panel(fmt::format("after: at most {:.0f} µm anywhere, rms at most {:.0f} µm (95 %)",
                                work.uncertainty.largest_95_um, work.uncertainty.rms_95_um),
                    "95 % bound at the corners, µm", grid, after, larger, std::move(labels));
}

PlotPanel slice_panel(const std::string& title, const VolumeSlice& slice, const VolumeError& error, double larger) {
  const Grid& grid = slice.grid;
  const auto name = [](std::size_t a) { return fmt::format("{} mm", letter_of(static_cast<Axis>(a))); };
  PlotPanel panel{title, name(slice.across), name(slice.up), {}};
  PlotSeries arrows{
      fmt::format("error in the plane (mean of both approaches), enlarged {:.0f} times", larger), Mark::arrow, {}};
  GridIndex index{};
  for (index[slice.across] = 0; index[slice.across] < grid.mm[slice.across].size(); ++index[slice.across])
    for (index[slice.up] = 0; index[slice.up] < grid.mm[slice.up].size(); ++index[slice.up]) {
      const Vector3 from = grid.at(index), to = displaced(from, mean_error(grid, error, index), larger);
      arrows.points.push_back({from[slice.across], from[slice.up]});
      arrows.points.push_back({to[slice.across], to[slice.up]});
    }
  panel.series = {std::move(arrows)};
  return panel;
}

std::vector<GridIndex> places_of(const Grid& grid) {
  std::vector<GridIndex> places;
  GridIndex index{};
  for (index[0] = 0; index[0] < grid.mm[0].size(); ++index[0])
    for (index[1] = 0; index[1] < grid.mm[1].size(); ++index[1])
      for (index[2] = 0; index[2] < grid.mm[2].size(); ++index[2]) places.push_back(index);
  return places;
}

/// At each place a cross as wide as the bound.
PlotPanel bounded_slice_panel(const VolumeWork& work, const std::string& title, const VolumeSlice& slice) {
  const Grid& grid = slice.grid;
  const std::vector<GridIndex> places = places_of(grid);
  const std::vector<PlaceBound> bounds = bounds_at(work, grid, slice.errors.after, places);
  double largest_um = 0.0;
  for (const PlaceBound& bound : bounds)
    largest_um = std::max({largest_um, bound.along_um[slice.across], bound.along_um[slice.up]});
  constexpr double kFiner = 4.0;  ///< the arms of one cross do not reach those of the next
  const double larger = enlargement(kFiner * largest_um, longest_of(work.prepared.machine.travel_mm));
  PlotPanel panel = slice_panel(title, slice, slice.errors.after, larger);
  PlotSeries crosses{fmt::format("95 % bound of the error, enlarged {:.0f} times", larger), Mark::bent_wire, {}};
  for (std::size_t i = 0; i < places.size(); ++i)
    for (const std::size_t axis : {slice.across, slice.up})
      for (const double sign : {-1.0, 1.0}) {
        Vector3 error_um{};
        error_um[axis] = sign * bounds[i].along_um[axis];
        const Vector3 end = displaced(grid.at(places[i]), error_um, larger);
        crosses.points.push_back({end[slice.across], end[slice.up]});
      }
  panel.series.insert(panel.series.begin(), std::move(crosses));
  return panel;
}

/// A length along every body diagonal.
/// @param length_um  at a place, in the order of for_each_diagonal_place()
PlotPanel diagonal_panel(const std::string& title, const Grid& grid,
                         const std::function<double(std::size_t, const GridIndex&)>& length_um) {
  PlotPanel panel{title, "along the body diagonal, %", "µm", {}};
  const std::size_t count = kPlacesAlongAWire;
  constexpr std::array<Mark, 4> kMarks{Mark::both, Mark::forward, Mark::reverse, Mark::level};
  for_each_diagonal_place(grid, [&](std::size_t number, const GridIndex& index) {
    if (number % count == 0) {
      const Vector3 from = grid.at(index);
      std::string name = "from";
      for (const Axis axis : kAllAxes)
        if (grid.exists[index_of(axis)])
          name += fmt::format(" {}{}", letter_of(axis),
                              from[index_of(axis)] == grid.mm[index_of(axis)].front() ? '-' : '+');
      panel.series.push_back({name, kMarks[panel.series.size() % kMarks.size()], {}});
    }
    panel.series.back().points.push_back(
        {100.0 * static_cast<double>(number % count) / static_cast<double>(count - 1), length_um(number, index)});
  });
  return panel;
}

/// Of the error vector.
PlotPanel diagonal_panel(const std::string& title, const Grid& grid, const VolumeError& error) {
  return diagonal_panel(title, grid,
                        [&](std::size_t, const GridIndex& index) { return length_of(mean_error(grid, error, index)); });
}

PlotPanel bounded_diagonal_panel(const VolumeWork& work, const Grid& grid, const VolumeError& after) {
  std::vector<GridIndex> places;
  for_each_diagonal_place(grid, [&](std::size_t, const GridIndex& index) { places.push_back(index); });
  const std::vector<PlaceBound> bounds = bounds_at(work, grid, after, places);
  return diagonal_panel("after, body diagonals: 95 % bound", grid,
                        [&](std::size_t number, const GridIndex&) { return bounds[number].length_um; });
}

std::string size_words(const volume::ErrorSize& size) {
  return fmt::format("largest {:.0f} µm, rms {:.0f} µm", size.largest_um, size.rms_um);
}

}  // namespace

Result<PlotFigure> volume_figure(const VolumeWork& work) {
  const volume::CompensatedMachine& machine = work.prepared.machine;
  const Grid wires = volume::even_grid(machine.travel_mm, kPlacesAlongAWire, work.answer.grid.reference_mm);
  ECS_TRY(on_wires, errors_over(machine, wires));
  const double larger = enlargement(work.answer.before.all.largest_um, longest_of(machine.travel_mm));
  PlotFigure figure;
  figure.title = fmt::format("Volume of {} ({}), {}", work.machine_name.empty() ? "the machine" : work.machine_name,
                             configuration_of(machine.parameters), travels_in_words(machine.travel_mm));
  figure.columns = 2;
  figure.same_scale = false;
  const bool bounded = shows_bound(work);
  const auto sizes_panel = [&](const std::string& title, const VolumeError& error) {
    return cube_panel(title, "µm at the corners", wires, error, larger, corner_sizes(wires, error));
  };
  std::string after = "after: " + size_words(work.answer.after.all);
  if (const std::string rotary = rotary_in_words(work); !rotary.empty())
    figure.title += "; " + rotary;
  else
    after += fmt::format("; at most {:.0f} µm (95 %)", work.uncertainty.largest_95_um);
  figure.panels = {
      sizes_panel("before: " + size_words(work.answer.before.all), on_wires.before),
      bounded ? bounded_cube_panel(work, wires, on_wires.after, larger) : sizes_panel(after, on_wires.after)};
  if (wires.axes() < 2) return figure;
  const auto [across, up] = longest_plane(machine);
  ECS_TRY(slice, slice_of(machine, work.answer.before.all.at_mm, across, up, 17, 11));
  std::string place;
  for (const Axis axis : kAllAxes)
    if (wires.exists[index_of(axis)] && index_of(axis) != slice.across && index_of(axis) != slice.up)
      place = fmt::format(", slice at {} {:.0f} mm", letter_of(axis), slice.grid.mm[index_of(axis)].front());
  figure.panels.push_back(slice_panel("before" + place, slice, slice.errors.before, larger));
  const double left_um = work.answer.after.all.largest_um;
  const double larger_after = left_um > kDrawn_um ? enlargement(left_um, longest_of(machine.travel_mm)) : larger;
  figure.panels.push_back(bounded ? bounded_slice_panel(work, "after" + place, slice)
                                  : slice_panel("after" + place, slice, slice.errors.after, larger_after));
  figure.panels.push_back(diagonal_panel("before, body diagonals: mean of both approaches", wires, on_wires.before));
  figure.panels.push_back(
      bounded ? bounded_diagonal_panel(work, wires, on_wires.after)
              : diagonal_panel("after, body diagonals: mean of both approaches", wires, on_wires.after));
  return figure;
}

}  // namespace ecs::commissioning
