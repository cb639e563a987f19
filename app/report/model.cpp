#include "app/report/model.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commissioning/measurements/files.hpp"
#include "commissioning/models/work.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/planning/next_measurement.hpp"

namespace ecs::app {
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
