#include "commissioning/models/work.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "laser/standards/circle.hpp"
#include "laser/standards/diagonals.hpp"
#include "laser/standards/gauge_blocks.hpp"
#include "model/data/path.hpp"
#include "model/regression/candidates.hpp"

namespace ecs::commissioning {
namespace {

using laser::MeasurementSet;
using laser::Reading;

/// A file of circles, diagonals or gauge blocks; nothing where it is none. Problem: what the readers of these files
/// refuse.
Result<std::optional<MeasurementSet>> path_in(std::string_view text, const std::string& file) {
  const FileKind kind = kind_of_content(text);
  if (kind == FileKind::circle_test) {
    ECS_TRY(test, laser::parse_circle_test(text, file));
    return std::optional(model::set_of_circle(test));
  }
  if (kind == FileKind::diagonal_test) {
    ECS_TRY(test, laser::parse_diagonals(text, file));
    ECS_TRY(set, model::set_of_diagonals(test));
    return std::optional(std::move(set));
  }
  if (kind == FileKind::gauge_blocks) {
    ECS_TRY(test, laser::parse_gauge_blocks(text, file));
    return std::optional(model::set_of_blocks(test));
  }
  return std::optional<MeasurementSet>();
}

}  // namespace

Result<MeasurementSet> joined_with_paths(MeasurementSet lines, std::vector<MeasurementSet> paths) {
  if (paths.empty()) return lines;
  std::vector<MeasurementSet> heads;
  if (!lines.readings.empty()) heads.push_back(std::move(lines));
  for (const MeasurementSet& set : paths) {
    heads.push_back(set);
    heads.back().readings.clear();
  }
  auto all = joined(heads);
  if (!all) return all;
  std::map<std::string, int> last_run;  // by path
  for (MeasurementSet& set : paths) {
    std::map<std::string, int> last_of_set;
    for (Reading& reading : set.readings) {
      const std::string& path = reading.text_extras.find(model::kPathColumn)->second;
      int& last = last_of_set.try_emplace(path, 0).first->second;
      last = std::max(last, reading.run);
      reading.run += last_run[path];
      all->readings.push_back(std::move(reading));
    }
    for (const auto& [path, run] : last_of_set) {
      if (last_run[path] > 0)
        all->notes.push_back(fmt::format("{}: its runs of {} are renumbered from {}", set.source,
                                         path.substr(0, path.find(" radius")), last_run[path] + 1));
      last_run[path] += run;
    }
  }
  return all;
}

namespace {

bool is_header(std::string_view line) { return !trimmed(line).empty() && !trimmed(line).starts_with("#"); }

/// The header row names an axis and a sense, but no reading.
bool lacks_readings(std::string_view text) {
  for (const std::string_view line : lines_of(text)) {
    if (!is_header(line)) continue;
    bool axis = false, sense = false, reading = false;
    for (const std::string_view field : split(line, ',')) {
      axis = axis || trimmed(field) == "axis";
      sense = sense || trimmed(field) == "sense";
      reading = reading || trimmed(field) == "reading";
    }
    return axis && sense && !reading;
  }
  return false;
}

/// The same rows with a last column `reading` of zeros.
std::string with_readings(std::string_view text) {
  std::string out;
  bool header = true;
  for (const std::string_view line : lines_of(text)) {
    out += line;
    if (is_header(line)) {
      out += header ? ",reading" : ",0";
      header = false;
    }
    out += '\n';
  }
  return out;
}

}  // namespace

Result<Plan> plan_in(const std::string& file, const ImportArguments& import) {
  ECS_TRY(text, read_file(file));
  if (lacks_readings(text)) {
    ECS_TRY(set, laser::parse_measurement_set(with_readings(text), file));
    std::erase(set.columns, "reading");
    return Plan{std::move(set), false};
  }
  ImportArguments any_axis = import;
  any_axis.takes_rotary = true;
  ECS_TRY(imported, read_measurements(file, any_axis));
  return Plan{std::move(imported.set), true};
}

Result<std::optional<params::Machine>> machine_in(MessageSink& messages, const std::string& file) {
  if (file.empty()) return std::optional<params::Machine>();
  ECS_TRY(read, params::read_machine(file));
  for (const Problem& warning : read.warnings) messages.warn(to_text(warning));
  return std::optional(std::move(read.machine));
}

namespace {

/// Readings of linear and of rotary axes share no unit of position.
std::optional<Problem> axes_mixed(const laser::MeasurementSet& set, const std::string& file) {
  const bool rotary = set.readings.front().rotary;
  for (const laser::Reading& reading : set.readings)
    if (reading.rotary != rotary)
      return Problem{ProblemKind::bad_input,
                     fmt::format("expected readings of linear axes or of rotary ones, found both, {} and {}: use a "
                                 "separate model for each kind",
                                 laser::letter_of(set.readings.front().axis, rotary),
                                 laser::letter_of(reading.axis, reading.rotary)),
                     file,
                     reading.line,
                     reading.line > 0 ? 1 : 0,
                     {}};
  return std::nullopt;
}

/// What a model of linear axes says of readings of rotary ones, or the other way round.
std::optional<Problem> of_other_axes(const model::Model& model, const laser::MeasurementSet& set,
                                     const std::string& file) {
  const bool rotary = set.readings.front().rotary;
  const auto refused = [&](const std::string& what) {
    return Problem{ProblemKind::bad_input,
                   fmt::format("the readings are of {0} axes: expected a model of {0} axes, found {1}",
                               rotary ? "rotary" : "linear", what),
                   file,
                   0,
                   0,
                   {}};
  };
  for (const model::EffectInstance& effect : model.effects)
    if (!effect.is_user() && effect.rotary != rotary) return refused(to_text(effect));
  if (rotary && model.map) return refused("[map]: a map covers linear axes only");
  return std::nullopt;
}

constexpr std::size_t kBeginning = 64U << 10;  // bytes that say what a file is

/// A file named as MODEL that is something else, such as measurements in place of DATA.
std::optional<Problem> other_than_model(const std::string& file) {
  const std::string head = head_of(file, kBeginning);
  if (auto wrong = wrong_kind(FileKind::model, head, file)) return wrong;
  if (kind_of_content(head) == FileKind::model || !is_measurement(file, true)) return std::nullopt;
  return Problem{
      ProblemKind::bad_input, "this is a measurement, not an error model: give MODEL first, then DATA", file, 0, 0, {}};
}

/// The first of the files that is a model; empty: none is.
std::string model_among(const std::vector<std::string>& files) {
  for (const std::string& file : files)
    if (kind_of_content(head_of(file, kBeginning)) == FileKind::model) return file;
  return {};
}

/// A path along an axis that the machine does not have.
std::optional<Problem> of_other_machine(const model::Observations& data, const std::vector<std::string>& files) {
  for (const model::Path& path : data.paths)
    for (const Axis axis : kAllAxes)
      if (axes_of(path).find(letter_of(axis)) != std::string::npos && !data.machine.axes[index_of(axis)])
        return Problem{ProblemKind::bad_input,
                       fmt::format("{}: expected axes of the machine, which has no {}", name_of(path), letter_of(axis)),
                       files.front(),
                       0,
                       0,
                       {}};
  return std::nullopt;
}

/// Lines measured where the machine cannot go: the machine file may be of another one.
std::vector<std::string> warnings_of_travel(const laser::MeasurementSet& set, const params::Machine& machine) {
  std::map<Axis, std::array<double, 2>> ends_mm;
  for (const laser::Reading& reading : set.readings) {
    if (reading.rotary) continue;
    const double at_mm = target_mm(reading);
    auto& [first_mm, last_mm] = ends_mm.try_emplace(reading.axis, std::array<double, 2>{at_mm, at_mm}).first->second;
    first_mm = std::min(first_mm, at_mm);
    last_mm = std::max(last_mm, at_mm);
  }
  std::vector<std::string> warnings;
  for (const auto& [axis, ends] : ends_mm)
    if (const auto& of_machine = machine.axes[index_of(axis)])
      if (auto beyond = laser::beyond_travel(std::string(1, letter_of(axis)), axis, ends, of_machine->travel_mm))
        warnings.push_back(std::move(*beyond));
  return warnings;
}

/// What a model of readings of rotary axes cannot hold.
std::vector<std::string> warnings_of_ball(const ModelWork& work) {
  std::vector<std::string> warnings;
  const bool may_be_ball = std::ranges::any_of(work.data.sense, [](Sense sense) { return !is_rotation(sense); });
  if (work.data.rotary && work.data.through_chain.empty() && may_be_ball)
    warnings.push_back(
        fmt::format("these readings are interpreted as errors of the axis itself; readings of a ball on the table need "
                    "x_mm, y_mm, z_mm{}",
                    work.machine ? "" : ", and --machine FILE with the rotary axes"));
  const auto is_kept = [&](const std::string& name) {
    return std::any_of(work.model.effects.begin(), work.model.effects.end(), [&](const model::EffectInstance& effect) {
      return effect.tied_with.find(name) != std::string::npos;
    });
  };
  for (const model::Exchangeable& one : model::exchangeable_locations(work.data, work.model.effects))
    if (const std::string name = place_text(one.effect); !is_kept(name))
      warnings.push_back(
          fmt::format("{} is not in the model: these readings cannot distinguish it from the position of the ball or "
                      "of the probe (turn the spindle by 180 deg between two readings to determine that of the probe)",
                      name));
  return warnings;
}

}  // namespace

cli::Fields<ModelArguments> ModelArguments::fields(cli::Need data_need) {
  using A = ModelArguments;
  return {
      {"MODEL", &A::model, "model file (.toml)", cli::Need::required},
      {"DATA", &A::data,
       "measurement files of lines or of a ball on the table (in any format that `laser import` reads), of circles, "
       "diagonals or gauge blocks",
       data_need},
      {"--machine", &A::machine, kMachineHelp},
      &A::import};
}

Result<laser::MeasurementSet> measured_in(MessageSink& messages, const std::vector<std::string>& words,
                                          const ImportArguments& import, std::string* sha256) {
  ECS_TRY(given, given_files(words, true));
  for (const std::string& note : given.notes) messages.note(note);
  const std::vector<std::string>& files = given.files;
  std::vector<laser::MeasurementSet> sets, paths;
  int rows = 0;
  std::string all_bytes;
  ImportArguments any_axis = import;
  any_axis.takes_rotary = true;
  for (const std::string& file : files) {
    ECS_TRY(bytes, read_file(file));
    if (sha256 != nullptr) all_bytes += bytes;
    ECS_TRY(path, import.columns.empty() && import.profile.empty() ? path_in(bytes, file)
                                                                   : std::optional<laser::MeasurementSet>());
    if (path && files.size() > 1 && !path->notes.empty())
      return problem_at(file, 0, 0,
                        path->notes.front() +
                            ". To use it with other files, add the position of the centre to the heading of the file, "
                            "as in `# centre_x_mm: 400`");
    if (!path) {
      ECS_TRY(imported, measurements_in(bytes, file, any_axis));
      sets.push_back(std::move(imported.set));
    }
    laser::MeasurementSet& read = path ? paths.emplace_back(std::move(*path)) : sets.back();
    for (const std::string& note : read.notes) messages.note(fmt::format("{}: {}", file, note));
    if (read.readings.empty()) return problem_at(file, 0, 0, "expected readings, found none");
    for (laser::Reading& reading : read.readings) reading.row = ++rows;
    read.notes.clear();
  }
  if (sha256 != nullptr) *sha256 = sha256_hex(all_bytes);
  auto all = joined(sets);
  if (all) all = joined_with_paths(std::move(*all), std::move(paths));
  if (all)
    if (auto mixed = axes_mixed(*all, files.front()); mixed) return tl::unexpected(std::move(*mixed));
  if (all)
    for (const std::string& note : all->notes) messages.note(note);
  return all;
}

Result<ModelWork> model_work(MessageSink& messages, const ModelArguments& arguments) {
  auto model = model::read_model(arguments.model);
  if (!model && !model_among(arguments.data).empty())
    return problem(
        ProblemKind::usage,

        "MODEL and DATA are swapped: {} is a model and {} is not; give the model first, then the measurements",
        model_among(arguments.data), arguments.model);
  if (!model) return tl::unexpected(model.error());
  ECS_TRY(machine, machine_in(messages, arguments.machine));
  std::string sha256;
  ECS_TRY(set, measured_in(messages, arguments.data, arguments.import, &sha256));
  if (auto other = of_other_axes(*model, set, arguments.model)) return tl::unexpected(std::move(*other));
  if (machine)
    if (const auto other = other_machine(measured_machine(set.metadata), {machine->name, ""}, "the machine file is of"))
      messages.warn(fmt::format("{}: {}", fmt::join(arguments.data, " "), *other));
  if (machine)
    for (const std::string& warning : warnings_of_travel(set, *machine)) messages.warn(warning);
  ModelWork work{
      std::move(*model), std::move(machine), std::move(set), {}, fmt::format("{}", fmt::join(arguments.data, " ")),
      std::move(sha256)};
  work.data = model::observations_of(work.set, work.model, work.machine);
  const auto& steps = work.model.history;
  if (std::any_of(steps.begin(), steps.end(), [&](const auto& step) { return step.data == work.data_name; }))
    work.data.clock_note.clear();  // the readings of the fit
  if (!work.data.clock_note.empty()) work.data.notes.push_back(work.data.clock_note);
  if (!work.data.not_followed.empty()) return problem_at(arguments.data.front(), 0, 0, work.data.not_followed);
  if (work.machine)
    if (auto other = of_other_machine(work.data, arguments.data)) return tl::unexpected(std::move(*other));
  return work;
}

Result<ModelWork> begun_model(MessageSink& messages, const ModelArguments& arguments) {
  if (is_there(arguments.model)) {
    if (auto other = other_than_model(arguments.model)) return tl::unexpected(std::move(*other));
    return problem(ProblemKind::usage,
                   "{0} already exists. Give another name, or continue with `ecs model diagnose {0} DATA`",
                   arguments.model);
  }
  ECS_DO(model::write_model(arguments.model, model::Model{}));
  auto work = model_work(messages, arguments);
  if (work) {
    work->model.effects = model::usual_effects(work->data);
    for (const std::string& warning : warnings_of_ball(*work)) messages.warn(warning);
    if (const auto written = model::write_model(arguments.model, work->model); !written)
      work = tl::unexpected(written.error());
  }
  const FileWatch* watch = FileWatch::current();
  if (!work && (watch == nullptr || !watch->replaces_disc())) disc::remove(arguments.model);
  return work;
}

std::string usual_in_words(const ModelWork& work) {
  const model::Observations& data = work.data;
  if (!data.through_chain.empty())
    return "the position of the ball, the location errors of the rotary axes that its readings show, and their "
           "backlash where "
           "both approaches were measured";
  if (work.model.effects.empty()) return "no effects yet";
  std::set<std::pair<Sense, Axis>> measured;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!data.on_path(k)) measured.emplace(data.sense[k], data.axis[k]);
  const auto slopes = std::count_if(work.model.effects.begin(), work.model.effects.end(),
                                    [](const auto& effect) { return effect.id == model::effect_named("scale"); });
  return fmt::format("an offset{} for each error and axis measured,{} backlash where both approaches were measured",
                     !data.rotary && static_cast<std::size_t>(slopes) >= measured.size() ? " and a slope" : "",
                     !data.rotary && static_cast<std::size_t>(slopes) < measured.size()
                         ? " a slope where there are three targets or more,"
                         : "");
}

Problem in_file(Problem why, const std::string& file) {
  if (why.kind == ProblemKind::bad_input && why.file.empty()) why.file = file;
  for (Problem& other : why.also) other = in_file(std::move(other), file);
  return why;
}

model::Model model_to_keep(const model::Model& model, const model::Fit& fit, const model::Observations& data,
                           const std::string& data_name) {
  model::Model kept = with_values(model, fit);
  take_compensation(kept, data);
  if (!kept.history.empty()) return kept;
  kept.history.push_back(rung_of("", data_name, data.reading, fit, data));
  return kept;
}

Result<void> keep_model(const std::string& output, const model::Model& model, const std::string& read_from) {
  std::error_code error;
  if (is_there(output) && !std::filesystem::equivalent(output, read_from, error)) {
    const auto content = read_file(output);
    if (!content || (!content->empty() && *content != to_toml(model)))
      return problem(ProblemKind::usage, "{} exists and is not {}: give another name, or remove it first", output,
                     read_from);
  }
  return model::write_model(output, model, read_from);
}

}  // namespace ecs::commissioning
