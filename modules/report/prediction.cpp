// What the unit would leave of the errors measured before, and what an error model says of them.

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commissioning/measurements/files.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/unit/transfer.hpp"
#include "core/tick.hpp"
#include "laser/map/image.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/planning/next_measurement.hpp"
#include "modules/report/content.hpp"

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

namespace {

/// The model has an effect of that sense along that axis.
bool acts_on(const model::Model& model, const PlannedMeasurement& planned) {
  return std::any_of(model.effects.begin(), model.effects.end(), [&](const model::EffectInstance& effect) {
    return effect.sense == planned.sense && (!effect.axis || effect.axis == planned.axis);
  });
}

struct Readings {
  laser::MeasurementSet before;
  laser::MeasurementSet after;  ///< may be empty
  std::string name;
};

Result<laser::MeasurementSet> joined_phase(const std::vector<const TableRow*>& rows,
                                           std::optional<MeasuredPhase> TableRow::*phase) {
  std::vector<laser::MeasurementSet> sets;
  int number = 0;
  for (const TableRow* row : rows) {
    if (!(row->*phase)) continue;
    laser::MeasurementSet set = (row->*phase)->readings.before;
    set.source = (row->*phase)->file.string();
    for (laser::Reading& reading : set.readings) reading.row = ++number;
    sets.push_back(std::move(set));
  }
  return joined(sets);
}

Result<Readings> readings_for(VerbContext& context, const ReportArguments& arguments, const model::Model& model,
                              const ReportContent& content) {
  std::vector<const TableRow*> rows;
  for (const TableRow& row : content.rows)
    if (row.before && acts_on(model, row.planned)) rows.push_back(&row);
  if (rows.empty())
    for (const TableRow& row : content.rows)
      if (row.before) rows.push_back(&row);
  std::vector<std::string> names;
  for (const TableRow* row : rows) names.push_back(row->planned.name);
  ECS_TRY(after, joined_phase(rows, &TableRow::after));
  if (!arguments.data.empty()) {
    ECS_TRY(before, measured_in(context.console, arguments.data, {}));
    return Readings{std::move(before), std::move(after), fmt::format("{}", fmt::join(arguments.data, ", "))};
  }
  ECS_TRY(before, joined_phase(rows, &TableRow::before));
  return Readings{std::move(before), std::move(after), fmt::format("before compensation: {}", fmt::join(names, ", "))};
}

Result<void> judge(VerbContext& context, const ReportArguments& arguments, const Readings& readings,
                   const model::Model& model, ReportContent& content) {
  const auto before = model::observations_of(readings.before, model, content.machine);
  const auto after = model::observations_of(readings.after, model, content.machine);
  ECS_TRY(fit, model::fit(model, before));
  ECS_TRY(what_if, model::what_if(model, before));
  content.model =
      ReportedModel{model,   model::with_values(model, fit),        readings.name, before.size(), fit.effects,
                    what_if, after_by_direction(fit, before, after)};
  if (content.diagnosis) return {};
  context.console.progress("diagnosing the error model", 0.6, 5.0);
  model::DiagnoseOptions options;
  options.noise_replicates = static_cast<std::size_t>(arguments.blanks);
  ECS_TRY(diagnosis, model::diagnose(model, before, options));
  (void)model::planned_next(model, before, diagnosis);  // the proposal of `ecs model next`
  content.diagnosis = reported(diagnosis);
  return {};
}

}  // namespace

Result<void> add_model(VerbContext& context, const ReportArguments& arguments, const ReportFiles& files,
                       ReportContent& content) {
  if (!files.diagnosis.empty()) {
    ECS_TRY(diagnosis, read_diagnosis(files.diagnosis));
    content.diagnosis = std::move(diagnosis);
  }
  if (files.model.empty()) return {};
  ECS_TRY(model, model::read_model(files.model));
  ECS_TRY(readings, readings_for(context, arguments, model, content));
  if (readings.before.readings.empty())
    return problem(ProblemKind::usage, "--model: no readings before compensation to put beside it; give --data");
  if (auto judged = judge(context, arguments, readings, model, content); !judged)
    return tl::unexpected(in_file(judged.error(), files.model.string()));
  return {};
}

}  // namespace ecs::app
