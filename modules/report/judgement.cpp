// What the unit would leave of the errors measured before, and what an error model says of them; what follows: whether
// the limits hold, what is worst, what to do next.

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/words.hpp"
#include "commissioning/measurements/files.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/unit/status.hpp"
#include "commissioning/unit/transfer.hpp"
#include "core/tick.hpp"
#include "laser/map/image.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/planning/next_measurement.hpp"
#include "modules/report/content.hpp"
#include "modules/report/markup.hpp"
#include "modules/report/page.hpp"

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
  const auto after = model::as_measured(model::observations_of(readings.after, model, content.machine));
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
    return problem(ProblemKind::usage, "--model: no readings before compensation to compare with; give --data");
  if (auto judged = judge(context, arguments, readings, model, content); !judged)
    return tl::unexpected(in_file(judged.error(), files.model.string()));
  return {};
}

namespace {

constexpr double kMostlyScatter = 0.7;   ///< of the band: R, four standard deviations, is wider than few readings are
constexpr double kSystematic = 0.5;      ///< of the band: E, the part that a map can remove
constexpr double kWorse = 0.9;           ///< ratio before over after
constexpr double kSurprise = 2.0;        ///< achieved over predicted rms; repeatability after over before
constexpr double kAbovePredicted = 1.5;  ///< achieved over predicted rms: more than the noise of three runs gives

double band_after(const TableRow& row) { return row.after->readings.band; }

std::string quantity(const TableRow& row, double value) {
  return quantity_text(value, decimals_of(row), laser::unit_of(row.planned.sense));
}

const TableRow* worst_of(const std::vector<TableRow>& rows, bool by_limit) {
  const TableRow* worst = nullptr;
  const auto badness = [by_limit](const TableRow& row) {
    return by_limit ? band_after(row) / *row.planned.published_after : band_after(row);
  };
  for (const TableRow& row : rows) {
    if (!row.after || (by_limit ? !row.planned.published_after.has_value() : is_rotation(row.planned.sense))) continue;
    if (worst == nullptr || badness(row) > badness(*worst)) worst = &row;
  }
  return worst;
}

std::string named(const TableRow& row) { return fmt::format("{} ({})", row.planned.name, row.planned.title); }

/// What is left after compensation is scatter for the most part.
bool is_scatter(const TableRow& row) {
  const auto& iso = row.after->iso;
  return iso.R && iso.E && *iso.R >= kMostlyScatter * band_after(row) && *iso.E < kSystematic * band_after(row);
}

/// The repeatability is worse than before compensation: something changed.
bool scatters_more(const TableRow& row) {
  return row.before && row.before->iso.R && row.after->iso.R && *row.after->iso.R > kSurprise * *row.before->iso.R;
}

std::string scatter_sentence(const TableRow& row) {
  const auto& iso = row.after->iso;
  if (!iso.R || !iso.E) return "";
  if (is_scatter(row) && scatters_more(row))
    return fmt::format(" It is mostly scatter: repeatability R = {} (ISO 230-2), before compensation {}.",
                       quantity(row, *iso.R), quantity(row, *row.before->iso.R));
  if (is_scatter(row))
    return fmt::format(" It is mostly scatter, which no map removes (repeatability R = {}, ISO 230-2).",
                       quantity(row, *iso.R));
  return fmt::format(
      " Its systematic part is E = {}. The repeatability R of ISO 230-2 is {}{}.", quantity(row, *iso.E),
      quantity(row, *iso.R),
      *iso.R > band_after(row) ? "; it is a multiple of a standard deviation and can exceed the band" : "");
}

std::string worst_sentence_of(const TableRow& row) {
  const auto& limit = row.planned.published_after;
  return fmt::format(
      "Largest {}: {}, a band of {} after compensation{}.{}", limit ? "band relative to its limit" : "remaining band",
      named(row), quantity(row, band_after(row)),
      limit ? fmt::format(", {:.0f} % of its limit of {}", 100.0 * band_after(row) / *limit, quantity(row, *limit))
            : "",
      scatter_sentence(row));
}

std::string sentence_of(const ReportContent& content, const Judgement& j) {
  if (j.after == 0) return "Measured before compensation only: the effect of compensation is not known yet.";
  if (j.judged == 0)
    return fmt::format("{} measured after compensation. No limits are known.",
                       counted(j.after, "component was", "components were"));
  if (j.within == j.judged)
    return j.judged == 1 ? "One measurement has a limit, and it is within this limit."
                         : fmt::format("All {} measurements with a limit are within it.", j.judged);
  std::vector<std::string> above;
  for (const TableRow& row : content.rows)
    if (verdict_of(row) == RowVerdict::above || (row.after && row.exceeds_published()))
      above.push_back(row.planned.name);
  if (j.judged == 1) return fmt::format("One measurement has a limit, and it is above this limit: {}.", above.front());
  return fmt::format("{} of {} measurements {} above the limit: {}.", j.judged - j.within, j.judged,
                     j.judged - j.within == 1 ? "is" : "are", fmt::join(above, ", "));
}

void rows_to_do(const ReportContent& content, std::vector<std::string>& next) {
  for (const TableRow& row : content.rows) {
    for (const Problem& problem : row.problems) next.push_back(fmt::format("{}: {}", named(row), to_text(problem)));
    if (!row.after) continue;
    if (row.exceeds_published())
      next.push_back(fmt::format("{}: {} against a limit of {}.{}", named(row), quantity(row, band_after(row)),
                                 quantity(row, *row.planned.published_after), scatter_sentence(row)));
    const auto ratio = row.ratio();
    if (ratio && *ratio < kWorse)
      next.push_back(
          fmt::format("{}: larger after compensation than before ({} from {}); check polarity and output "
                      "scale of the axis, and that the map belongs to this set-up.",
                      named(row), quantity(row, band_after(row)), quantity(row, row.before->readings.band)));
  }
}

void predictions_to_do(const ReportContent& content, std::vector<std::string>& next) {
  for (std::size_t i = 0; i < content.predicted.size(); ++i) {
    const PredictedRow& one = content.predicted[i];
    if (verdict_of(content.rows[i]) == RowVerdict::within) continue;
    // Scatter is no change; scatter that was less before is.
    if (content.rows[i].after && is_scatter(content.rows[i]) && !scatters_more(content.rows[i])) continue;
    if (!one.rms || !one.rms_after || *one.rms <= 0.0 || *one.rms_after <= kAbovePredicted * *one.rms) continue;
    next.push_back(fmt::format(
        "{}: rms {} remains, but {} was expected with the map{}", named(content.rows[i]),
        quantity(content.rows[i], *one.rms_after), quantity(content.rows[i], *one.rms),
        *one.rms_after > kSurprise * *one.rms
            ? ". A condition changed between the two measurements (temperature, set-up, machine): find it, or measure "
              "again."
            : fmt::format(": {:.2f} times as much, more than noise gives, and {}. Measure it again. If that confirms "
                          "it, build the map from more runs or with smoothing.",
                          *one.rms_after / *one.rms,
                          verdict_of(content.rows[i]) == RowVerdict::above ? "it is above its limit"
                                                                           : "no limit is known for it")));
  }
}

void others_to_do(const ReportContent& content, std::vector<std::string>& next) {
  if (content.status && content.status->status.fault != Fault::none)
    next.push_back(fmt::format("Unit: {}", fault_sentence(content.status->status)));
  for (const Problem& problem : content.problems) next.push_back(to_text(problem));
  if (content.map)
    for (const std::string& objection : content.map->objections) next.push_back(fmt::format("Map: {}", objection));
  if (content.parameters)
    for (const params::Finding& finding : content.parameters->findings)
      if (finding.severity == params::Severity::error)
        next.push_back(fmt::format("Parameters: {}: {}", fmt::join(finding.keys, ", "), finding.message));
}

void model_to_do(const ReportContent& content, std::vector<std::string>& next) {
  if (!content.diagnosis || content.diagnosis->verdict == "adequate") return;
  const std::string& verdict = content.diagnosis->verdict;
  if (verdict == "cannot_tell" || verdict == "unexplained_structure" || verdict == "partly_explained")
    next.push_back("Error model: " + content.diagnosis->headline);
  if (verdict == "cannot_tell") return;
  for (const ReportedEffect& effect : content.diagnosis->effects)
    if (effect.named && !effect.next_measurement.empty())
      next.push_back(fmt::format("Error model: {} ({}){} is {}missing from it. {}", effect.title, effect.place,
                                 effect.rivals.empty() ? "" : ", or " + first_few(effect.rivals),
                                 effect.but.empty() ? "" : "probably ", effect.next_measurement));
}

/// What the report cannot show because it was not measured, not stated or not met.
void gaps_to_do(const ReportContent& content, std::vector<std::string>& next) {
  std::vector<std::string> few, unlimited;
  for (const TableRow& row : content.rows) {
    const auto has_notes = [](const auto& phase) { return phase && !phase->iso.notes.empty(); };
    if (is_positioning(row) && (has_notes(row.before) || has_notes(row.after))) few.push_back(row.planned.name);
    if (verdict_of(row) == RowVerdict::no_limit) unlimited.push_back(row.planned.name);
  }
  if (!few.empty())
    next.push_back(
        fmt::format("{}: some conditions of ISO 230-2 are not met; they are listed below the "
                    "curves.",
                    fmt::join(few, ", ")));
  if (!unlimited.empty())
    next.push_back(
        fmt::format("{}: no limit is known. State it in a measurement plan (plan.toml).", fmt::join(unlimited, ", ")));
  if (content.map && !content.map->map.header.declared_zero.empty()) {
    std::vector<std::string_view> zero;
    for (const laser::DeclaredZero& one : content.map->map.header.declared_zero) zero.push_back(name_of(one.component));
    next.push_back(fmt::format("{} declared zero in the map: {}. The unit does not correct {}.",
                               counted(zero.size(), "component is", "components are"), fmt::join(zero, ", "),
                               zero.size() == 1 ? "it" : "them"));
  }
  if (content.date.empty()) next.emplace_back("No file states the date of the measurements.");
}

}  // namespace

RowVerdict verdict_of(const TableRow& row) {
  if (!row.problems.empty()) return RowVerdict::missing;
  if (!row.after) return RowVerdict::before_only;
  if (!row.planned.published_after) return RowVerdict::no_limit;
  return row.exceeds_published() ? RowVerdict::above : RowVerdict::within;
}

std::string_view word_for(RowVerdict verdict) {
  constexpr WordTable<RowVerdict, 5> kWords{{"within", "above", "no limit", "before only", "missing"}};
  return kWords.of(verdict);
}

int decimals_of(const TableRow& row) {
  double least = row.before ? row.before->readings.band : row.after ? row.after->readings.band : 0.0;
  if (row.after) least = std::min(least, row.after->readings.band);
  return decimals_for(least);
}

Judgement judgement_of(const ReportContent& content) {
  Judgement j;
  for (const TableRow& row : content.rows) {
    if (!row.problems.empty()) ++j.missing;
    if (!row.after) continue;
    ++j.after;
    if (!row.planned.published_after) continue;
    ++j.judged;
    if (!row.exceeds_published()) ++j.within;
  }
  j.worst = worst_of(content.rows, j.judged > 0);
  j.sentence = sentence_of(content, j);
  if (j.missing > 0)
    j.sentence += fmt::format(" {} incomplete: a file is missing or does not fit.",
                              counted(j.missing, "planned measurement is", "planned measurements are"));
  if (j.worst != nullptr) j.worst_sentence = worst_sentence_of(*j.worst);
  rows_to_do(content, j.next);
  if (j.after == 0 && j.missing == 0) j.next.push_back("Measure the same lines again with the unit compensating.");
  others_to_do(content, j.next);
  predictions_to_do(content, j.next);
  model_to_do(content, j.next);
  gaps_to_do(content, j.next);
  return j;
}

}  // namespace ecs::app
