// `ecs model compare` on a recorded step of a servo axis: its drive constants against the oscilloscope, as text, JSON
// and figure; what the module brings.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/cli/module.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/models/view.hpp"
#include "modules/traces/diagnosis.hpp"

namespace ecs::commissioning {
namespace {

using model::DriveCandidate;
using model::DriveChange;
using model::DriveConstant;
using model::DriveDiagnosis;
using model::DriveVerdict;
using model::StepShape;

std::string name_of(DriveConstant constant) { return std::string(model::info_of(constant).name); }

std::string names(const std::vector<DriveConstant>& constants) {
  std::vector<std::string> words;
  for (const DriveConstant c : constants) words.push_back(name_of(c));
  return fmt::format("{}", fmt::join(words, ", "));
}

/// "10 times too large", "3.2 times too small", "4.1 % too large"
std::string fault_text(double factor) {
  const double wrong = 1.0 / factor;  // what was given, over what it would have to be
  const char* way = wrong > 1.0 ? "too large" : "too small";
  const double times = std::max(wrong, factor);
  return times < 1.5 ? fmt::format("{} % {}", few_digits(100.0 * std::abs(wrong - 1.0), 2), way)
                     : fmt::format("{} times {}", few_digits(times, 3), way);
}

std::string row_of(const char* what, const std::vector<std::optional<double>>& values) {
  std::string text = "  " + padded(what, 26);
  for (const auto& v : values) text += fmt::format("{:>14}", v ? few_digits(*v, 4) : "-");
  return text + "\n";
}

/// What describes a step, as JSON has it and as a row of the text.
struct ShapeQuantity {
  const char* key;
  const char* title;
  std::optional<double> StepShape::*part;
  double shown_in;  ///< of the unit that the title gives, in one of the key
};
constexpr ShapeQuantity kShapeQuantities[] = {
    {"steady_V", "steady level [V]", &StepShape::steady, 1.0},
    {"rise_s", "rise 10 to 90 % [ms]", &StepShape::rise_s, 1e3},
    {"decay_start_s", "decay starts after [s]", &StepShape::decay_start_s, 1.0},
    {"fall_s", "fall 90 to 10 % [ms]", &StepShape::fall_s, 1e3},
};

Json shape_json(const StepShape& shape) {
  Json object = Json::object();
  for (const ShapeQuantity& q : kShapeQuantities) object[q.key] = number_or_null(shape.*q.part);
  return object;
}

std::string shapes_text(const DriveDiagnosis& d) {
  const bool mended = !d.candidates.empty();
  std::vector<const StepShape*> shapes{&d.measured, &d.as_given};
  if (mended) shapes.push_back(&d.mended);
  std::string text = "  " + padded("", 26) + fmt::format("{:>14}{:>14}", "measured", "simulated");
  text += mended ? fmt::format("{:>14}\n", "corrected") : "\n";
  for (const ShapeQuantity& q : kShapeQuantities) {
    std::vector<std::optional<double>> values;
    for (const StepShape* shape : shapes) {
      const auto& value = shape->*q.part;
      values.push_back(value ? std::optional(q.shown_in * *value) : std::nullopt);
    }
    text += row_of(q.title, values);
  }
  std::vector<std::optional<double>> rms{std::nullopt, d.rms_V};
  if (mended) rms.emplace_back(d.candidates.front().rms_after_V);
  return text + row_of("rms of the difference [V]", rms) +
         (mended ? "  corrected: simulated with the corrected constants\n" : "");
}

std::string value_of(const DriveChange& change, const model::DriveParameters& given) {
  const model::DriveConstantInfo& info = model::info_of(change.constant);
  return fmt::format("{} = {}{}{} (k = 1; given {})", info.name,
                     value_text({std::string(info.name), "", change.value, change.sigma, false, false}),
                     info.unit.empty() ? "" : " ", info.unit, few_digits(given[change.constant], 4));
}

/// What each alternative of a group is and would have to be.
std::string group_text(const DriveCandidate& candidate, const model::DriveParameters& given) {
  std::vector<std::string> faults;
  for (const DriveChange& c : candidate.alternatives)
    faults.push_back(
        fmt::format("{} ({}) is {}", name_of(c.constant), model::info_of(c.constant).meaning, fault_text(c.factor)));
  std::string text =
      paragraph(fmt::format("{}{}.", fmt::join(faults, candidate.together ? ", and " : ", or "),
                            faults.size() > 1 && !candidate.together ? ": this recording cannot show which" : ""));
  for (const DriveChange& c : candidate.alternatives)
    text += paragraph(fmt::format("{}{}; the rms is then {} V", value_of(c, given),
                                  candidate.together ? "" : " if all the others are right", few_digits(c.rms_after, 2)),
                      2, 4);
  for (const auto& [like, which] : {std::pair(&candidate.like_first, 0U), std::pair(&candidate.like_second, 1U)})
    if (!like->empty())
      text += paragraph(
          fmt::format("{} may replace {}.", names(*like), name_of(candidate.alternatives[which].constant)), 2, 2);
  return text;
}

/// "its peak is 0.994 V if Kw is wrong, 9.93 V if K is wrong", for the members that this signal tells from the first.
std::string separation_by(const model::SignalDifference& difference, DriveConstant first) {
  const auto& info = model::info_of(difference.signal);
  std::vector<std::string> others;
  for (const model::MemberDifference& m : difference.members)
    if (m.relative >= model::kClearDifference)
      others.push_back(fmt::format("{} {} if {} is wrong", few_digits(m.peak), info.unit, name_of(m.member)));
  if (others.empty()) return "";
  return paragraph(fmt::format("To distinguish {}, record {} ({}): its peak is {} {} if {} is wrong, {}.",
                               others.size() == difference.members.size() ? "them" : "some of them", info.name,
                               info.words, few_digits(difference.peak), info.unit, name_of(first),
                               fmt::join(others, ", ")));
}

std::string separation_text(const DriveCandidate& candidate) {
  if (candidate.alternatives.size() < 2 || candidate.together) return "";
  std::string text;
  for (const model::SignalDifference& s : candidate.signals)
    text += separation_by(s, candidate.alternatives.front().constant);
  return text.empty() ? "No other signal of the axis distinguishes them.\n" : text;
}

std::string verdict_text(const DriveDiagnosis& d) {
  switch (d.verdict) {
    case DriveVerdict::agrees:
      return "The simulation agrees with the recording: the residual is noise.\n";
    case DriveVerdict::wrong_constant:
      return "One constant explains the difference:\n";
    case DriveVerdict::wrong_constants:
      return "No single constant explains the difference; two together do:\n";
    case DriveVerdict::unexplained:
      break;
  }
  return "Neither one constant nor two explain the difference. Nearest:\n";
}

Json names_json(const std::vector<DriveConstant>& constants) {
  Json list = Json::array();
  for (const DriveConstant c : constants) list.push_back(name_of(c));
  return list;
}

/// {"Kw": 1.2, "K": 3.4}: a number of each alternative.
Json by_name(const std::vector<DriveChange>& alternatives, double DriveChange::*number) {
  Json object = Json::object();
  for (const DriveChange& c : alternatives) object[name_of(c.constant)] = number_or_null(c.*number);
  return object;
}

Json units_json(const std::vector<DriveChange>& alternatives) {
  Json object = Json::object();
  for (const DriveChange& c : alternatives) object[name_of(c.constant)] = model::info_of(c.constant).unit;
  return object;
}

Json signal_json(const model::SignalDifference& signal, DriveConstant first) {
  Json members = Json::object(), peaks = Json::object();
  peaks[name_of(first)] = number_or_null(signal.peak);
  for (const model::MemberDifference& m : signal.members) {
    members[name_of(m.member)] = number_or_null(m.relative);
    peaks[name_of(m.member)] = number_or_null(m.peak);
  }
  return object_of("signal"_is(model::info_of(signal.signal).name), "relative_difference"_is(members),
                   "peak_if"_is(peaks));
}

Cell drive_candidate_cell(const DriveCandidate& candidate, double rms_V, const model::DriveParameters& given) {
  const auto& all = candidate.alternatives;
  Json parameters = Json::array(), separated = Json::array(), signals = Json::array();
  for (const DriveChange& c : all) parameters.push_back(name_of(c.constant));
  for (const model::DriveSignal s : candidate.separated_by) separated.push_back(model::info_of(s).name);
  for (const model::SignalDifference& s : candidate.signals) signals.push_back(signal_json(s, all.front().constant));
  Json object =
      object_of("parameters"_is(parameters), "together"_is(candidate.together), "explains"_is(candidate.explains),
                "factor"_is(all.front().factor), "factors"_is(by_name(all, &DriveChange::factor)),
                FieldKey(candidate.together ? "values" : "value_if_others_trusted")(by_name(all, &DriveChange::value)),
                "sigma"_is(by_name(all, &DriveChange::sigma)), "unit"_is(units_json(all)), "rms_before_V"_is(rms_V),
                "rms_after_V"_is(candidate.rms_after_V), "rms_after_each_V"_is(by_name(all, &DriveChange::rms_after)),
                "separated_by"_is(separated), "signals"_is(signals));
  if (candidate.together)
    object["instead_of"] = {{name_of(all[0].constant), names_json(candidate.like_first)},
                            {name_of(all[1].constant), names_json(candidate.like_second)}};
  return {object, group_text(candidate, given) + separation_text(candidate)};
}

constexpr std::size_t kCandidatesShown = 4;

/// All in JSON; in the text the first of those that explain the recording, or else the first.
Cell drive_candidates_cell(const DriveDiagnosis& d, const model::DriveParameters& given) {
  Cell list{Json::array(), {}};
  bool shown = true;
  std::vector<std::string> weaker;
  for (const DriveCandidate& candidate : d.candidates) {
    Cell one = drive_candidate_cell(candidate, d.rms_V, given);
    shown = shown && candidate.explains == d.candidates.front().explains && list.json.size() < kCandidatesShown;
    if (!shown) one.text.clear();
    if (shown && !list.json.empty() && candidate.explains) one.text.insert(0, "or\n");
    list.add(one);
    if (!candidate.explains && d.candidates.front().explains)
      weaker.push_back(fmt::format("{} ({} V rms would remain)", name_of(candidate.alternatives.front().constant),
                                   few_digits(candidate.rms_after_V)));
  }
  if (!weaker.empty())
    list.text +=
        "\n" + paragraph(fmt::format("None of these alone explains the difference: {}.", fmt::join(weaker, ", ")));
  return list;
}

Cell few_digits_cell(double value, int digits) { return {number_or_null(value), few_digits(value, digits)}; }

Cell drive_diagnosis_cell(const DriveDiagnosis& d, const model::DriveTrace& trace,
                          const model::DriveParameters& given) {
  const AnswerFields fields = described(
      "trace"_is(trace.source), "feed_mm_min"_is(few_digits_cell(trace.move.feed_mm_min, 4)),
      "distance_mm"_is(few_digits_cell(trace.move.distance_mm, 3)), "observations"_is(d.observations),
      "rms_V"_is(d.rms_V), "noise_V"_is(few_digits_cell(d.noise_V, 2)),
      "verdict"_is(model::name_of(d.verdict), verdict_text(d)), "move_starts_s"_is(few_digits_cell(d.start_s, 3)),
      "measured"_is(shape_json(d.measured)), "simulated"_is(shape_json(d.as_given)),
      "mended"_is(d.candidates.empty() ? Json() : shape_json(d.mended)), "shapes"_shown(shapes_text(d)),
      "candidates"_is(drive_candidates_cell(d, given)),
      "says_nothing_about"_is(
          names_json(d.silent),
          d.silent.empty()
              ? ""
              : paragraph(fmt::format("With {}, the recording hardly depends on {}: it cannot confirm these values.",
                                      d.candidates.empty() ? "the constants as given" : "the corrected constants",
                                      names(d.silent)))),
      "notes"_is(d.notes, d.notes.empty() ? "" : "\n" + notes_text(d.notes)));
  return {object_of(fields), paragraph(laid_out("step of {distance_mm} mm at {feed_mm_min} mm/min, {observations} "
                                                "samples of the D/A voltage, noise {noise_V} "
                                                "V, the move starts at {move_starts_s} s",
                                                fields)) +
                                 laid_out("\n{shapes}\n{verdict}{candidates}{says_nothing_about}{notes}", fields)};
}

PlotFigure trace_figure(const model::DriveTrace& trace, const DriveDiagnosis& diagnosis) {
  const auto series = [&](const char* name, Mark mark, const std::vector<double>& value, std::size_t most_points) {
    PlotSeries line{name, mark, {}};
    const std::size_t stride = trace.time_s.size() / most_points + 1;
    for (std::size_t k = 0; k < trace.time_s.size(); k += stride)
      if (std::isfinite(value[k])) line.points.push_back({trace.time_s[k], value[k]});
    return line;
  };
  PlotPanel panel{"output of the D/A converter", "time [s]", "dac_V [V]", {}, {}};
  panel.series.push_back(series("recorded", Mark::reading, trace.dac().value, 800));
  panel.series.push_back(series("simulated as given", Mark::level, diagnosis.as_given_V, 800));
  if (!diagnosis.candidates.empty())
    panel.series.push_back(series("simulated with corrections", Mark::both, diagnosis.mended_V, 120));
  return {fmt::format("step of {} mm at {} mm/min", few_digits(trace.move.distance_mm),
                      few_digits(trace.move.feed_mm_min, 4)),
          {panel},
          1,
          true};
}

/// True for a file whose header row has time_s and dac_V; false for any other, also one that cannot be read.
bool is_trace_file(const std::string& file) {
  const auto text = read_file(file);
  return text && model::is_drive_trace(*text);
}

/// The picture: recorded, simulated as given and simulated as mended.
/// @param model  file with a [drive] table; without the table the constants are as printed in appendix A
Result<DrawnOutcome> compare_trace(const std::string& model, const std::string& trace) {
  ECS_TRY(drive, model::read_drive(model));
  ECS_TRY(recorded, model::read_trace(trace));
  const DriveDiagnosis diagnosis = model::diagnose_drive(drive, recorded);
  return DrawnOutcome{outcome_of(drive_diagnosis_cell(diagnosis, recorded, drive)), trace_figure(recorded, diagnosis)};
}

}  // namespace
}  // namespace ecs::commissioning

namespace ecs::app {

extern const std::vector<Action> kDriveWorksheet;

const Module& traces_module() {
  static const Module module{
      .verbs = {{"model", &kDriveWorksheet}},
      .synonyms = {{"model drive", "servo tacho friction inertia worksheet appendix A spring balance"}},
      .has_data_for = commissioning::is_trace_file,
      .compare = commissioning::compare_trace};
  return module;
}

}  // namespace ecs::app
