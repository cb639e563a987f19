// Coordinate ascent: an error is a sum over axes but for its levers, so one or two rounds find the place.
#include "volume/between.hpp"

namespace ecs::volume {
namespace {

constexpr int kMostRounds = 4;

}  // namespace

Result<ErrorSize> largest_between(const CompensatedMachine& machine, const ErrorSize& from,
                                  VolumeError BeforeAfter::*of) {
  const Vector3 reference_mm = reference_of(machine.parameters);
  const Grid lines = even_grid(machine.travel_mm, kPlacesOfLine, reference_mm);
  ErrorSize largest = from;
  for (int round = 0; round < kMostRounds; ++round) {
    const double before_um = largest.largest_um;
    for (std::size_t a = 0; a < kAxes; ++a) {
      if (!lines.exists[a]) continue;
      Grid line = grid_at(machine.travel_mm, largest.at_mm, reference_mm);
      line.mm[a] = lines.mm[a];
      ECS_TRY(errors, errors_over(machine, line));
      const ErrorSize here = size_of(line, errors.*of);
      if (here.largest_um > largest.largest_um) largest = here;
    }
    if (largest.largest_um <= before_um) break;
  }
  return largest;
}

}  // namespace ecs::volume
