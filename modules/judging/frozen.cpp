// A model frozen: what is kept of it, of its readings and of the program, as a file that shows whether it was changed.
#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "model/fit/compare.hpp"
#include "model/regression/candidates.hpp"
#include "modules/judging/judging.hpp"

namespace ecs::commissioning {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FrozenFile, file, sha256)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FittedRange, curve, column, least, greatest)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ModelWithout, effect, model)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FrozenModel, freeze, time, program, program_sha256, model, machine, map, data,
                                   limits, limits_text, machine_name, serial_number, readings, rms_um, axes, runs,
                                   ranges, without)

namespace {

namespace fs = std::filesystem;

/// As the file holds it; around it nothing may change.
std::string seal_line(const std::string& sha256) { return fmt::format("\"seal\": \"{}\"", sha256); }
std::string open_seal_line() { return seal_line(std::string(64, '0')); }

/// The name by which a file is found from the folder of another.
std::string seen_from(const std::string& output, const std::string& file) {
  std::error_code error;
  const fs::path folder = fs::absolute(output, error).parent_path();
  return fs::proximate(fs::absolute(file, error), folder, error).generic_string();
}

/// Empty name: nothing.
Result<FrozenFile> frozen_file(const std::string& file, const std::string& output) {
  if (file.empty()) return FrozenFile{};
  ECS_TRY(bytes, read_file(file));
  return FrozenFile{seen_from(output, file), sha256_hex(bytes)};
}

/// Columns that say whether a reading lies within what the model was fitted to: places, approach, feed, load and
/// temperatures whatever the model holds; others where an effect of the model reads them.
std::set<std::string> conditions_of(const model::Model& model, const model::Observations& data) {
  std::set<std::string> columns{"approach", "feed_mm_min", "load_kg"};
  for (const Axis axis : kAllAxes) columns.emplace(data.position_name(axis));
  for (const model::Path& path : data.paths) columns.emplace(model::variable_along(path));
  for (const auto& [sensor, column] : data.sensors_degC) columns.insert(sensor);
  std::set<std::string> others{"time_s", "pressure_hPa", "humidity_pct", "travel_since_reversal_mm"};
  for (const auto& [name, column] : data.extras) others.insert(name);
  for (const model::EffectInstance& effect : model.effects) {
    const model::EffectDefinition& of = effect.definition();
    if (of.has_need(model::Need::time)) columns.insert("time_s");
    if (of.has_need(model::Need::air)) columns.insert({"pressure_hPa", "humidity_pct"});
    if (of.has_need(model::Need::travel_since_reversal)) columns.insert("travel_since_reversal_mm");
    for (const model::UserFormula& formula : effect.formulas)
      for (const std::string& name : others)
        if (formula.text.find(name) != std::string::npos) columns.insert(name);
  }
  return columns;
}

std::vector<FittedRange> ranges_of(const model::Model& model, const model::Observations& data) {
  const std::set<std::string> columns = conditions_of(model, data);
  std::map<std::pair<std::string, std::string>, FittedRange> found;
  for (std::size_t k = 0; k < data.size(); ++k)
    for (const std::string& column : columns) {
      const double value = condition_of(data, k, column);
      if (std::isnan(value)) continue;
      const std::string curve = judged_curve(data, k);
      FittedRange& range = found.try_emplace({curve, column}, FittedRange{curve, column, value, value}).first->second;
      range.least = std::min(range.least, value);
      range.greatest = std::max(range.greatest, value);
    }
  std::vector<FittedRange> ranges;
  for (auto& [key, range] : found) ranges.push_back(std::move(range));
  return ranges;
}

/// The model without each effect with which no model of such readings begins and that is not known from elsewhere.
Result<std::vector<ModelWithout>> models_without(const ModelWork& work, const JudgingLimits& limits,
                                                 const std::string& limits_file) {
  const std::vector<model::EffectInstance>& effects = work.model.effects;
  const auto is = [](const JudgingLimits::Known& known, const model::EffectInstance& effect) {
    return known.effect == to_text(effect) || known.effect == place_text(effect);
  };
  for (const JudgingLimits::Known& known : limits.known)
    if (std::none_of(effects.begin(), effects.end(), [&](const auto& effect) { return is(known, effect); }))
      return problem_at(limits_file, known.line, 0, "known: the model has no effect {}", known.effect);
  const std::vector<model::EffectInstance> usual = model::usual_effects(work.data);
  std::vector<ModelWithout> all;
  for (std::size_t k = 0; k < effects.size(); ++k) {
    const auto is_known = [&](const JudgingLimits::Known& known) { return is(known, effects[k]); };
    const auto is_begun = [&](const model::EffectInstance& one) { return same_place(one, effects[k]); };
    if (effects[k].traits().is_usual || std::any_of(usual.begin(), usual.end(), is_begun) ||
        std::any_of(limits.known.begin(), limits.known.end(), is_known))
      continue;
    model::Model without = work.model;
    without.effects.erase(without.effects.begin() + static_cast<std::ptrdiff_t>(k));
    without.history.clear();
    ECS_TRY(fit, model::fit(without, work.data));
    all.push_back({place_text(effects[k]), to_toml(model::with_values(std::move(without), fit))});
  }
  return all;
}

/// Half of a travel is known where the machine file says the travel.
Result<void> has_travels(const JudgingLimits& limits, const ModelWork& work, const std::string& limits_file) {
  for (const HeldOutGroups& groups : limits.groups)
    if (groups.by == "half" && (work.data.rotary || !work.machine))
      return problem_at(limits_file, groups.line, 0,
                        work.data.rotary ? "by: half is for linear axes; for rotary axes use sector or sign"
                                         : "by: half needs the travel of the axis: give --machine");
  return {};
}

}  // namespace

std::string judged_curve(const model::Observations& data, std::size_t k) {
  return data.on_path(k) ? data.path_name(k) : fmt::format("{} {}", name_of(data.sense[k]), data.letter(data.axis[k]));
}

std::string judged_axes(const model::Observations& data, std::size_t k) {
  return data.on_path(k) ? axes_of(data.path_of(k)) : std::string(1, data.letter(data.axis[k]));
}

std::vector<std::vector<std::size_t>> runs_of_lines(const model::Observations& data) {
  std::map<std::tuple<std::string, std::array<double, 3>, int>, std::vector<std::size_t>> runs;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const Vector3 parked = data.parked_of(k);
    runs[{judged_curve(data, k), {parked[0], parked[1], parked[2]}, data.run[k]}].push_back(k);
  }
  std::vector<std::vector<std::size_t>> all;
  for (auto& [key, rows] : runs) all.push_back(std::move(rows));
  return all;
}

std::string sha256_of_run(const model::Observations& data, const std::vector<std::size_t>& rows) {
  std::string text;
  for (const std::size_t k : rows) {
    const Vector3& at = data.position_mm[k];
    const double time_s = data.time_s.empty() ? 0.0 : data.time_s[k] - data.time_s[rows.front()];
    text += fmt::format("{} {} {} {} {} {} {:.6f} {}\n", judged_curve(data, k), shortest(at[0]), shortest(at[1]),
                        shortest(at[2]), shortest(model::cell(data.along, k)), data.approach[k], time_s,
                        shortest(data.reading[k]));
  }
  return sha256_hex(text);
}

double condition_of(const model::Observations& data, std::size_t k, const std::string& column) {
  if (column == "approach" && data.approach[k] == 0) return model::kNotMeasured;
  if (column == "time_s") return data.time_s.empty() ? model::kNotMeasured : data.since_origin_s(k);
  return model::variable_of(data, k, column);
}

Result<model::Fit> fit_held(const model::Model& model, const model::Observations& data) {
  ECS_DO(model::predicted(model, data));  // refuses what has no values yet
  return model::fit(model::with_values_held(model), data);
}

Result<std::string> running_program_sha256() {
  static const Result<std::string> once = []() -> Result<std::string> {
    const Unwatched not_an_input;
    ECS_TRY(bytes, read_file("/proc/self/exe"));
    return sha256_hex(bytes);
  }();
  return once;
}

std::string to_json(const FrozenModel& frozen) {
  nlohmann::json top = frozen;
  top["seal"] = std::string(64, '0');
  std::string text = top.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  const std::string line = open_seal_line();
  return text.replace(text.find(line), line.size(), seal_line(sha256_hex(text)));
}

Result<FrozenModel> parse_frozen_model(std::string_view text, const std::string& file) {
  try {
    const nlohmann::json top = nlohmann::json::parse(text);
    const std::string line = seal_line(top.at("seal").get<std::string>());
    std::string unsealed(text);
    const std::size_t at = unsealed.find(line);
    if (at == std::string::npos || seal_line(sha256_hex(unsealed.replace(at, line.size(), open_seal_line()))) != line)
      return problem_at(file, 0, 0, "this freeze was changed after it was written: its SHA-256 differs");
    FrozenModel frozen = top.get<FrozenModel>();
    if (frozen.freeze == FrozenModel{}.freeze) return frozen;
    return problem_at(file, 0, 0, "expected a freeze of format {}, got {}", FrozenModel{}.freeze, frozen.freeze);
  } catch (const nlohmann::json::exception&) {
    if (kind_of_content(text) == FileKind::model)
      return problem_at(file, 0, 0,
                        "this is an error model, not a frozen one. Freeze it first: `ecs model freeze {} --data DATA "
                        "--limits limits.toml -o frozen.json`",
                        file);
    if (auto other = wrong_kind(FileKind::other, text, file)) return tl::unexpected(std::move(*other));
    return problem_at(file, 0, 0,
                      "expected a file written by `ecs model freeze -o`, found a truncated file or a file of another "
                      "kind");
  }
}

Result<FrozenModel> freeze(MessageSink& messages, const FreezeArguments& arguments) {
  const std::string& output = arguments.output;
  std::vector<std::string> inputs = arguments.of.data;
  inputs.insert(inputs.end(), {arguments.of.model, arguments.of.machine, arguments.limits});
  ECS_DO(check_output_not_input(output, inputs));
  ECS_TRY(work, model_work(messages, arguments.of));
  FrozenModel frozen;
  ECS_TRY(limits_text, read_file(arguments.limits));
  ECS_TRY(limits, parse_judging_limits(limits_text, arguments.limits));
  ECS_DO(has_travels(limits, work, arguments.limits));
  ECS_TRY(fit, in_file(fit_held(work.model, work.data), arguments.of.model));
  ECS_TRY(without, in_file(models_without(work, limits, arguments.limits), arguments.of.model));
  ECS_TRY(program, running_program_sha256());
  const fs::path beside = fs::path(arguments.of.model).parent_path();
  for (auto& [into, file] :
       {std::pair(&frozen.model, arguments.of.model), std::pair(&frozen.machine, arguments.of.machine),
        std::pair(&frozen.map, work.model.map ? (beside / work.model.map_file).string() : ""),
        std::pair(&frozen.limits, arguments.limits)}) {
    ECS_TRY(one, frozen_file(file, output));
    *into = std::move(one);
  }
  ECS_TRY(given, given_files(arguments.of.data, true));
  for (const std::string& file : given.files) {
    ECS_TRY(one, frozen_file(file, output));
    frozen.data.push_back(std::move(one));
  }
  const laser::MeasuredMachine measured = laser::measured_machine(work.set.metadata);
  frozen.time = now_utc();
  frozen.program = program_version_and_commit();
  frozen.program_sha256 = std::move(program);
  frozen.limits_text = std::move(limits_text);
  frozen.machine_name = measured.name.empty() && work.machine ? work.machine->name : measured.name;
  frozen.serial_number = measured.serial_number;
  frozen.readings = work.data.size();
  frozen.rms_um = fit.rms_um;
  std::set<char> axes;
  for (std::size_t k = 0; k < work.data.size(); ++k)
    for (const char letter : judged_axes(work.data, k)) axes.insert(letter);
  frozen.axes.assign(axes.begin(), axes.end());
  for (const std::vector<std::size_t>& run : runs_of_lines(work.data))
    frozen.runs.push_back(sha256_of_run(work.data, run));
  frozen.ranges = ranges_of(work.model, work.data);
  frozen.without = std::move(without);
  ECS_DO(write_file(output, to_json(frozen)));
  return frozen;
}

}  // namespace ecs::commissioning
