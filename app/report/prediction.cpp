#include "app/report/prediction.hpp"

#include <cmath>
#include <memory>

#include "commissioning/unit/transfer.hpp"
#include "core/tick.hpp"
#include "laser/map/image.hpp"

namespace ecs::app {
namespace {

double rms_about_mean(const laser::MeasurementSet& set) {
  double sum = 0.0, square = 0.0;
  for (const laser::Reading& reading : set.readings) sum += reading.error;
  const double mean = sum / static_cast<double>(set.readings.size());
  for (const laser::Reading& reading : set.readings) square += (reading.error - mean) * (reading.error - mean);
  return std::sqrt(square / static_cast<double>(set.readings.size()));
}

void compensate(laser::Reading& reading, const CompiledMap& map) {
  PerAxis<Approach> approach{Approach::forward, Approach::forward, Approach::forward};
  if (reading.approach != Approach::unknown) approach[index_of(reading.axis)] = reading.approach;
  reading.error += compensation_um_at(map, reading.position_mm, approach)[index_of(direction_of(reading.sense))];
}

PredictedRow predicted_row(const TableRow& row, const CompiledMap& map) {
  PredictedRow out;
  if (row.after) out.rms_after = rms_about_mean(row.after->readings.after);
  if (!row.before || !row.after || is_rotation(row.planned.sense)) return out;
  laser::MeasurementSet set = row.before->readings.before;
  for (laser::Reading& reading : set.readings) compensate(reading, map);
  const auto groups = laser::groups_of(set);
  if (groups.size() != 1) return out;
  const auto levelled = laser::processed_readings(set, groups.front(), {row.planned.slope});
  if (!levelled) return out;
  out.band = levelled->band;
  out.rms = rms_about_mean(levelled->after);
  return out;
}

}  // namespace

Result<Predicted> predicted_rows(const std::vector<TableRow>& rows, const laser::ErrorMap& map,
                                 const UnitParameters& parameters, const protocol::Identity* unit) {
  ECS_TRY(image, laser::image_of(map, parameters));
  const ImageView view{ByteView(image.bytes)};
  const auto compiled = std::make_unique<CompiledMap>();
  if (const CompileVerdict verdict = compile(view, *compiled); verdict.fault != Fault::none)
    return problem(ProblemKind::refused, std::string(ecs::text_of(verdict.fault).meaning));
  Predicted out;
  if (unit != nullptr) {  // the image that a unit holds states the unit
    ECS_TRY(held, addressed(image.bytes, *unit, Addressee::this_unit));
    out.check = ImageView(ByteView(held)).check();
  } else if (!map.header.serial_number.empty()) {
    out.check = view.check();
  }
  for (const TableRow& row : rows) out.rows.push_back(predicted_row(row, *compiled));
  return out;
}

}  // namespace ecs::app
