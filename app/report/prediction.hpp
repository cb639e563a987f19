// What the unit would leave of the errors measured before, by the core that it runs, beside what was measured after.
// Does not live here: predictions of an error model (model/diagnosis/ladder.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/names/commissioning.hpp"
#include "commissioning/measurements/table.hpp"
#include "laser/map/error_map.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::app {

/// One measurement. Bands and rms of all readings, slope removed as in the table; rms about their mean. um.
struct PredictedRow {
  std::optional<double> band;  ///< predicted; absent for rotations, squares and rows without readings before
  std::optional<double> rms;
  std::optional<double> rms_after;  ///< measured
};

struct Predicted {
  std::vector<PredictedRow> rows;      ///< as many as the table has
  std::optional<std::uint32_t> check;  ///< CRC-32 of the image as that unit holds it, which it reports as block check;
                                       ///< absent where neither map nor `unit` says the unit's serial number
};

/// Every reading taken before plus the compensation at its place and approach; standing axes as if moved forward last.
/// Refused with the reasons of laser::image_of(), or where the map is not for the parameters.
/// @param unit  that holds the map; nullptr: not known
[[nodiscard]] Result<Predicted> predicted_rows(const std::vector<TableRow>& rows, const laser::ErrorMap& map,
                                               const UnitParameters& parameters, const protocol::Identity* unit);

}  // namespace ecs::app
