// A frozen model judged: what is refused before a residual is looked at, groups inside and beyond the conditions to
// which it was fitted, and whether the effects that were added predict better than the model without them.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "laser/import/time.hpp"
#include "model/fit/statistics.hpp"
#include "modules/judging/judging.hpp"

namespace ecs::commissioning {
namespace {

namespace fs = std::filesystem;
using model::Observations;
using Rows = std::vector<std::size_t>;

// --- what is refused

/// Empty: there is none.
std::string there(const std::string& freeze_file, const FrozenFile& one) {
  return one.file.empty() ? "" : (fs::path(freeze_file).parent_path() / one.file).lexically_normal().string();
}

Result<void> unchanged(const std::string& freeze_file, const FrozenFile& one, const char* what) {
  const std::string file = there(freeze_file, one);
  if (file.empty()) return {};
  ECS_TRY(bytes, read_file(file));
  const std::string now = sha256_hex(bytes);
  if (now == one.sha256) return {};
  return problem_at(
      file, 0, 0,

      "the {} has changed since the freeze: expected SHA-256 {}, got {}; restore it, or freeze the present one", what,
      one.sha256, now);
}

Result<void> same_program(const FrozenModel& frozen, const std::string& freeze_file) {
  ECS_TRY(now, running_program_sha256());
  if (now == frozen.program_sha256) return {};
  return problem_at(freeze_file, 0, 0,
                    "the program has changed since the freeze ({}): expected SHA-256 {}, got {}; judge "
                    "with that program, or freeze with this one",
                    frozen.program, frozen.program_sha256, now);
}

/// The held-out files by their hash; none of them was fitted.
Result<std::map<std::string, std::string>> unseen_files(const FrozenModel& frozen,
                                                        const std::vector<std::string>& words) {
  std::map<std::string, std::string> file_of;
  std::vector<std::string> files;
  for (const std::string& word : words) {  // each alone: a copy is refused here, not left out
    ECS_TRY(given, given_files({word}, true));
    files.insert(files.end(), given.files.begin(), given.files.end());
  }
  for (const std::string& file : files) {
    ECS_TRY(bytes, read_file(file));
    const std::string sha256 = sha256_hex(bytes);
    for (const FrozenFile& fitted : frozen.data)
      if (fitted.sha256 == sha256)
        return problem_at(file, 0, 0, "the model was fitted to this file ({}): it is not held out", fitted.file);
    if (!file_of.emplace(sha256, file).second)
      return problem_at(file, 0, 0, "the same file is given twice, also as {}", file_of[sha256]);
  }
  return file_of;
}

/// Below, equal readings of two runs may be chance: rounded to 1 um, or of a machine that repeats.
constexpr std::size_t kFewestForSameRun = 10;

Result<void> of_same_machine(const FrozenModel& frozen, const ModelWork& work, const std::string& file) {
  const laser::MeasuredMachine measured = laser::measured_machine(work.set.metadata);
  if (const auto other =
          laser::other_machine(measured, {frozen.machine_name, frozen.serial_number}, "the frozen model is of"))
    return problem_at(file, 0, 0, *other);
  for (std::size_t k = 0; k < work.data.size(); ++k)
    for (const char letter : judged_axes(work.data, k))
      if (frozen.axes.find(letter) == std::string::npos)
        return problem_at(file, 0, 0, "axis {}: the model was fitted to readings of {} only", letter, frozen.axes);
  const std::set<std::string> fitted(frozen.runs.begin(), frozen.runs.end());
  for (const Rows& run : runs_of_lines(work.data))
    if (run.size() >= kFewestForSameRun && fitted.contains(sha256_of_run(work.data, run)))
      return problem_at(file, 0, 0, "run {} of {}: the model was fitted to these readings", work.data.run[run.front()],
                        judged_curve(work.data, run.front()));
  return {};
}

// --- groups

/// Of a rotary axis, or on a circle [deg]; nothing: there is none.
/// @param axis  rotary; absent: the one that moves
std::optional<double> angle_of(const Observations& data, std::size_t k, std::optional<Axis> axis) {
  if (!axis && data.on_path(k) && model::variable_along(data.path_of(k)) == "angle_deg") return data.along[k];
  return data.rotary ? std::optional(data.position_mm[k][index_of(axis.value_or(data.axis[k]))]) : std::nullopt;
}

/// "B +", "|B| 45", "B 0..90"; nothing: the reading has no angle.
std::optional<std::string> angle_group_of(const HeldOutGroups& groups, const Observations& data, std::size_t k) {
  const auto angle = angle_of(data, k, groups.axis);
  if (!angle) return std::nullopt;
  const std::string name = groups.axis       ? std::string(1, data.letter(*groups.axis))
                           : data.on_path(k) ? data.path_name(k)
                                             : std::string(1, data.letter(data.axis[k]));
  if (groups.by == "sign") return name + (*angle < 0.0 ? " -" : " +");
  if (groups.by == "magnitude") return fmt::format("|{}| {}", name, shortest(std::abs(*angle)));
  const double turn = *angle - 360.0 * std::floor(*angle / 360.0);
  const double from = groups.sector_deg * std::floor(turn / groups.sector_deg);
  return fmt::format("{} {}..{}", name, from, from + groups.sector_deg);
}

std::optional<std::string> day_of(const Observations& data, std::size_t k) {
  const auto origin_s = data.origin.date.empty() ? std::nullopt : laser::seconds_in(data.origin.date);
  if (!origin_s || data.time_s.empty() || !data.clock_note.empty()) return std::nullopt;
  return laser::date_time_text(*origin_s + data.since_origin_s(k)).substr(0, 10);
}

/// The group of a reading; nothing: it has no such value.
std::optional<std::string> value_of(const HeldOutGroups& groups, const ModelWork& work, std::size_t k) {
  const Observations& data = work.data;
  const std::string& by = groups.by;
  const std::string letter(1, data.letter(data.axis[k]));
  if (by == "all") return by;
  if (by == "sense") return data.on_path(k) ? data.path_name(k) : std::string(name_of(data.sense[k]));
  if (by == "day") return day_of(data, k);
  if (by == "half") {
    const auto& axis = data.machine.axes[index_of(data.axis[k])];
    if (!axis || data.on_path(k)) return std::nullopt;
    return letter + (2.0 * data.position_mm[k][index_of(data.axis[k])] < axis->travel_mm[0] + axis->travel_mm[1]
                         ? " lower"
                         : " upper");
  }
  if (by == "sector" || by == "sign" || by == "magnitude") return angle_group_of(groups, data, k);
  const laser::Reading& reading = work.set.readings[data.file_order[k]];
  if (const auto text = reading.text_extras.find(by); text != reading.text_extras.end() && !text->second.empty())
    return text->second;
  const double value = condition_of(data, k, by);
  return std::isnan(value) ? std::nullopt : std::optional(shortest(value));
}

/// Beyond the range by so much of it is rounding, or a sensor that settles.
constexpr double kSlack = 0.01;

class Conditions {
 public:
  Conditions(const FrozenModel& frozen, const JudgingLimits& limits) {
    for (const FittedRange& range : frozen.ranges) {
      const auto wider = limits.inside.find(range.column);
      of_curve_[range.curve].push_back(range);
      if (wider == limits.inside.end()) continue;
      of_curve_[range.curve].back().least = wider->second.least;
      of_curve_[range.curve].back().greatest = wider->second.greatest;
    }
  }
  /// Why a reading lies beyond: column and the range; empty: it lies inside.
  [[nodiscard]] std::vector<std::string> beyond(const Observations& data, std::size_t k) const {
    const auto curve = of_curve_.find(judged_curve(data, k));
    if (curve == of_curve_.end()) return {judged_curve(data, k) + " was not fitted"};
    std::vector<std::string> why;
    for (const FittedRange& range : curve->second) {
      const double value = condition_of(data, k, range.column), slack = kSlack * (range.greatest - range.least);
      if (value < range.least - slack || value > range.greatest + slack)
        why.push_back(fmt::format("{} outside {:.6g} to {:.6g}", range.column, range.least, range.greatest));
    }
    return why;
  }
  /// Columns of the held-out readings that the fitted ones lack.
  [[nodiscard]] std::vector<std::string> unknown(const Observations& data) const {
    std::set<std::string> fitted, here;
    for (const auto& [curve, ranges] : of_curve_)
      for (const FittedRange& range : ranges) fitted.insert(range.column);
    if (!data.feed_mm_min.empty()) here.insert("feed_mm_min");
    if (!data.load_kg.empty()) here.insert("load_kg");
    for (const auto& [sensor, column] : data.sensors_degC) here.insert(sensor);
    std::vector<std::string> missing;
    std::set_difference(here.begin(), here.end(), fitted.begin(), fitted.end(), std::back_inserter(missing));
    return missing;
  }

 private:
  std::map<std::string, std::vector<FittedRange>> of_curve_;
};

/// Rows of a group that is still to be judged.
struct GroupRows {
  JudgedGroup group;
  Rows rows;
};

/// By the number with which the last word begins, then by text: "C 60..120" before "C 120..180".
struct InOrder {
  bool operator()(const std::string& a, const std::string& b) const {
    const auto key = [](const std::string& text) {
      const std::size_t at = text.rfind(' ') + 1;
      double number = std::numeric_limits<double>::infinity();
      std::from_chars(text.data() + at, text.data() + text.size(), number);
      return std::tuple(text.substr(0, at), std::isnan(number) ? 0.0 : number, text);
    };
    return key(a) < key(b);
  }
};

Result<std::map<std::string, Rows, InOrder>> rows_by_value(const HeldOutGroups& groups, const ModelWork& work,
                                                           const std::string& limits_file) {
  std::map<std::string, Rows, InOrder> rows;
  for (const std::string& value : groups.values) rows[value];
  for (std::size_t k = 0; k < work.data.size(); ++k) {
    const auto value = value_of(groups, work, k);
    if (!value)
      return problem_at(work.set.source, 0, 0, "row {}: it has no {}, which {} needs to divide the hold-out",
                        work.data.row[k], groups.by, limits_file);
    if (groups.values.empty() || rows.contains(*value)) rows[*value].push_back(k);
  }
  return rows;
}

/// Those inside and those beyond; of so few that they cannot be judged alone, with the others.
std::vector<GroupRows> parts_of(const HeldOutGroups& groups, const std::string& value, const Rows& rows,
                                const Observations& data, const Conditions& conditions) {
  GroupRows inside, beyond;
  std::set<std::string> why;
  for (const std::size_t k : rows) {
    const std::vector<std::string> beyond_in = conditions.beyond(data, k);
    (beyond_in.empty() ? inside : beyond).rows.push_back(k);
    why.insert(beyond_in.begin(), beyond_in.end());
  }
  beyond.group.beyond = true;
  beyond.group.conditions.assign(why.begin(), why.end());
  if (beyond.rows.size() < groups.readings || inside.rows.size() < groups.readings) {
    GroupRows& most = beyond.rows.size() > inside.rows.size() ? beyond : inside;
    most.rows = rows;
    (&most == &beyond ? inside : beyond).rows.clear();
  }
  std::vector<GroupRows> parts;
  for (GroupRows& part : {std::ref(inside), std::ref(beyond)}) {
    if (part.rows.empty()) continue;
    part.group.by = groups.by;
    part.group.value = value;
    part.group.readings = part.rows.size();
    parts.push_back(std::move(part));
  }
  return parts;
}

/// Every group with its limit, before a residual is looked at.
Result<std::vector<GroupRows>> groups_to_judge(const FrozenModel& frozen, const JudgingLimits& limits,
                                               const std::string& file, const ModelWork& work) {
  const Conditions conditions(frozen, limits);
  std::vector<GroupRows> all;
  std::map<std::string, std::size_t> taken;
  for (const HeldOutGroups& groups : limits.groups) {
    ECS_TRY(by_value, rows_by_value(groups, work, file));
    std::size_t held_out = 0;
    for (const auto& [value, rows] : by_value) {
      held_out += rows.size();
      if (rows.size() < groups.readings)
        return problem_at(
            file, groups.line, 0,
            rows.empty() ? fmt::format("{} {} is held out, but the files contain no reading of it", groups.by, value)
                         : fmt::format("{} {}: expected at least {} readings to judge, got {}", groups.by, value,
                                       groups.readings, rows.size()));
      for (GroupRows& part : parts_of(groups, value, rows, work.data, conditions)) {
        const auto& limit = part.group.beyond ? groups.beyond : groups.inside;
        if (!limit)
          return problem_at(file, groups.line, 0,
                            part.group.beyond
                                ? fmt::format("{} {} lies beyond the fitted range ({}), and the file has no limit for "
                                              "that: add `beyond` to its [[group]], or extend [inside]",
                                              groups.by, value, fmt::join(part.group.conditions, ", "))
                                : fmt::format("{} {} lies inside the fitted range, and there is no limit for that",
                                              groups.by, value));
        part.group.limit = *limit;
        all.push_back(std::move(part));
      }
    }
    taken[groups.by] += held_out;
    const auto together = static_cast<double>(held_out + frozen.readings);
    if (static_cast<double>(held_out) < groups.share * together)
      return problem_at(file, groups.line, 0, "expected at least {} of {:.0f} readings held out, got {}", groups.share,
                        together, held_out);
  }
  for (const auto& [by, rows] : taken)
    if (rows < work.data.size())
      return problem_at(file, 0, 0, "{} of {} readings have a different {} from those held out: omit them",
                        work.data.size() - rows, work.data.size(), by);
  return all;
}

// --- numbers

/// About the mean of each run of a line, of these rows.
std::vector<double> about_means(std::vector<double> values, const std::vector<Rows>& runs) {
  for (const Rows& run : runs) {
    double sum = 0.0;
    for (const std::size_t k : run) sum += values[k];
    for (const std::size_t k : run) values[k] -= sum / static_cast<double>(run.size());
  }
  return values;
}

double rms_of(const std::vector<double>& values, const Rows& rows) {
  double sum = 0.0;
  for (const std::size_t k : rows) sum += values[k] * values[k];
  return rows.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(rows.size()));
}

/// Runs of lines that are taken as independent; with fewer a t-test could hardly tell anything.
constexpr std::size_t kEnoughRuns = 4;
/// Into how many stretches fewer runs are cut together (three runs into nine), and how many readings each has at least.
constexpr double kStretches = 8.0;
constexpr std::size_t kFewestInStretch = 4;
/// Shorter ones are not independent: twice the minute over which turbulence correlates readings (docs/statistics.md).
constexpr double kShortestStretch_s = 120.0;

/// Consecutive stretches of each run in which the predictions differ by equal squares: what acts at one place only
/// would else show in one of them.
std::vector<Rows> stretches_of(const Observations& data, const std::vector<Rows>& runs,
                               const std::vector<double>& difference) {
  std::vector<Rows> all;
  const double count = std::ceil(kStretches / static_cast<double>(runs.size()));
  for (const Rows& run : runs) {
    const std::size_t first = all.size();
    const double share = std::pow(rms_of(difference, run), 2) * static_cast<double>(run.size()) / count;
    double squares = 0.0, next = 1.0;
    Rows stretch;
    for (const std::size_t k : run) {
      stretch.push_back(k);
      squares += difference[k] * difference[k];
      const bool is_short = !data.time_s.empty() && data.time_s[k] - data.time_s[stretch.front()] < kShortestStretch_s;
      if (is_short || stretch.size() < kFewestInStretch || squares < (next - 1e-9) * share) continue;
      all.push_back(std::exchange(stretch, {}));
      next = std::floor(squares / share) + 1.0;
    }
    if (all.size() == first) all.emplace_back();
    all.back().insert(all.back().end(), stretch.begin(), stretch.end());
  }
  return all;
}

/// An effect acts in a run where it changes the prediction by this share of the most that it does in any.
constexpr double kActs = 0.01;

std::vector<Rows> runs_on_which_it_acts(const Observations& data, const std::vector<double>& difference) {
  std::vector<Rows> runs = runs_of_lines(data);
  double most = 0.0;
  for (const Rows& run : runs) most = std::max(most, rms_of(difference, run));
  std::erase_if(runs, [&](const Rows& run) { return most == 0.0 || rms_of(difference, run) < kActs * most; });
  return runs;
}

/// What the logbook knows of the held-out files, in `judgement.file_of`, and of the freeze.
void take_uses(Judgement& judgement, const FrozenModel& frozen, const std::string& freeze_sha256) {
  std::vector<std::string> hashes{freeze_sha256};
  for (const auto& [sha256, file] : judgement.file_of) hashes.push_back(sha256);
  const auto uses = recorded_uses(hashes);
  if (!uses) return;
  std::vector<RecordedUse>&openings = judgement.openings.emplace(), &seen = judgement.seen.emplace();
  bool knows_freeze = false;
  for (const RecordedUse& use : *uses) {
    knows_freeze = knows_freeze || (use.role == "output" && use.sha256 == freeze_sha256);
    if (use.role != "input") continue;
    const bool brought = use.kind == "measurement" || use.kind == "processing";
    if (use.verb != kJudgeVerb) {
      if (!brought && use.sha256 != freeze_sha256 && use.time <= frozen.time) seen.push_back(use);
    } else if (openings.empty() || openings.back().number != use.number) {
      openings.push_back(use);
    }
  }
  if (!knows_freeze)
    judgement.notes.emplace_back("the logbook does not know this freeze: it was written elsewhere, or changed");
}

/// The chance that values of mean 0 have this mean or more, by Student's t.
std::optional<double> one_sided(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  if (n < 2.0) return std::nullopt;
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  if (squares == 0.0) return mean > 0.0 ? 0.0 : 1.0;
  const double tail = 0.5 * std::exp(model::ln_f_tail(mean * mean * n * (n - 1.0) / squares, 1.0, n - 1.0));
  return mean > 0.0 ? tail : 1.0 - tail;
}

}  // namespace

bool JudgedEffect::better() const { return p_value && *p_value <= kJudgedLevel; }

bool Judgement::holds() const {
  return std::all_of(groups.begin(), groups.end(), [](const JudgedGroup& one) { return one.holds(); }) &&
         std::all_of(effects.begin(), effects.end(),
                     [](const JudgedEffect& one) { return one.readings == 0 || one.better(); });
}

JudgedEffect judged_effect(const Observations& data, const std::vector<double>& with,
                           const std::vector<double>& without) {
  std::vector<double> difference(data.size());
  for (std::size_t k = 0; k < data.size(); ++k) difference[k] = without[k] - with[k];
  const std::vector<Rows> runs = runs_on_which_it_acts(data, difference);
  JudgedEffect judged;
  if (runs.empty()) return judged;
  // An unknown zero is the same all along a run: its stretches are independent about the mean only.
  const bool by_run = runs.size() >= kEnoughRuns;
  const std::vector<double> before = by_run ? without : about_means(without, runs),
                            after = by_run ? with : about_means(with, runs);
  Rows rows;
  for (const Rows& run : runs) rows.insert(rows.end(), run.begin(), run.end());
  judged.readings = rows.size();
  judged.rms_without_um = rms_of(without, rows);
  judged.rms_um = rms_of(with, rows);
  std::map<std::string, Rows> of_curve;  // curves differ in their noise, and in their unit
  for (const std::size_t k : rows) of_curve[judged_curve(data, k)].push_back(k);
  std::transform(before.begin(), before.end(), after.begin(), difference.begin(), std::minus<>());
  std::vector<double> gains;
  for (const Rows& stretch : by_run ? runs : stretches_of(data, runs, difference)) {
    const Rows& alike = of_curve[judged_curve(data, stretch.front())];
    const double a = rms_of(before, stretch), b = rms_of(after, stretch);
    const double scale = std::hypot(rms_of(before, alike), rms_of(after, alike));
    gains.push_back(scale > 0.0 ? static_cast<double>(stretch.size()) * (a * a - b * b) / (scale * scale) : 0.0);
  }
  judged.stretches = gains.size();
  judged.p_value = one_sided(gains);
  return judged;
}

Result<Judgement> judge(MessageSink& messages, const std::string& freeze_file, const std::vector<std::string>& held_out,
                        const ImportArguments& import) {
  ECS_TRY(text, read_file(freeze_file));
  Judgement judgement;
  ECS_TRY(frozen, parse_frozen_model(text, freeze_file));
  ECS_DO(same_program(frozen, freeze_file));
  ECS_DO(unchanged(freeze_file, frozen.model, "model"));
  ECS_DO(unchanged(freeze_file, frozen.machine, "machine file"));
  ECS_DO(unchanged(freeze_file, frozen.map, "map"));
  const std::string limits_file = there(freeze_file, frozen.limits);
  ECS_TRY(limits, parse_judging_limits(frozen.limits_text, limits_file));
  ECS_TRY(file_of, unseen_files(frozen, held_out));
  const std::string model_file = there(freeze_file, frozen.model);
  ECS_TRY(work, model_work(messages, {model_file, held_out, there(freeze_file, frozen.machine), import}));
  ECS_DO(of_same_machine(frozen, work, held_out.front()));
  ECS_TRY(groups, groups_to_judge(frozen, limits, limits_file, work));

  ECS_TRY(fit, in_file(fit_held(work.model, work.data), model_file));
  const std::vector<Rows> runs = runs_of_lines(work.data);
  const auto residuals = [&](const model::Fit& of) {
    return limits.zero_of_each_run ? about_means(of.residual, runs) : of.residual;
  };
  const std::vector<double> residual = residuals(fit);
  for (GroupRows& one : groups) {
    one.group.rms_um = rms_of(residual, one.rows);
    for (const std::size_t k : one.rows) one.group.max_um = std::max(one.group.max_um, std::abs(residual[k]));
    judgement.groups.push_back(std::move(one.group));
  }
  for (const ModelWithout& one : frozen.without) {
    ECS_TRY(without, model::parse_model(one.model, freeze_file, fs::path(model_file).parent_path()));
    ECS_TRY(fit_without, in_file(fit_held(without, work.data), freeze_file));
    judgement.effects.push_back(judged_effect(work.data, residual, residuals(fit_without)));
    judgement.effects.back().effect = one.effect;
  }

  judgement.file_of = std::move(file_of);
  take_uses(judgement, frozen, sha256_hex(text));
  for (const std::string& column : Conditions(frozen, limits).unknown(work.data))
    judgement.notes.push_back(fmt::format(
        "{}: the fitted readings do not state it, so it is not used to decide between inside and beyond", column));
  judgement.notes.insert(judgement.notes.end(), fit.notes.begin(), fit.notes.end());
  judgement.zero_of_each_run = limits.zero_of_each_run;
  judgement.unit = work.data.reading_unit();
  judgement.file_of.emplace(sha256_hex(text), freeze_file);
  judgement.frozen = std::move(frozen);
  return judgement;
}

}  // namespace ecs::commissioning
