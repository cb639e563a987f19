// A recorded step against the simulated servo, as text, JSON and figure.
#include "commissioning/models/trace.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/json.hpp"
#include "base/paragraph.hpp"
#include "commissioning/models/view.hpp"

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

std::string shapes_text(const DriveDiagnosis& d) {
  const bool mended = !d.candidates.empty();
  const auto row = [&](const char* what, std::optional<double> StepShape::*part, double unit) {
    std::vector<std::optional<double>> values;
    for (const StepShape* shape : {&d.measured, &d.as_given, &d.mended}) {
      const auto& value = shape->*part;
      values.push_back(value ? std::optional(unit * *value) : std::nullopt);
    }
    if (!mended) values.pop_back();
    return row_of(what, values);
  };
  std::string text = "  " + padded("", 26) + fmt::format("{:>14}{:>14}", "measured", "simulated");
  text += mended ? fmt::format("{:>14}\n", "mended") : "\n";
  text += row("steady level [V]", &StepShape::steady, 1.0);
  text += row("rise 10 to 90 % [ms]", &StepShape::rise_s, 1e3);
  text += row("decay starts after [s]", &StepShape::decay_start_s, 1.0);
  text += row("fall 90 to 10 % [ms]", &StepShape::fall_s, 1e3);
  std::vector<std::optional<double>> rms{std::nullopt, d.rms_V};
  if (mended) rms.emplace_back(d.candidates.front().rms_after_V);
  return text + row_of("rms of the difference [V]", rms);
}

std::string value_of(const DriveChange& change, const model::DriveParameters& given) {
  const model::DriveConstantInfo& info = model::info_of(change.constant);
  return fmt::format("{} = {}{}{} (given {})", info.name,
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
                            faults.size() > 1 && !candidate.together ? ": this recording cannot tell which" : ""));
  for (const DriveChange& c : candidate.alternatives)
    text += paragraph(fmt::format("{}{}, rms then {} V", value_of(c, given),
                                  candidate.together ? "" : " if all the others are right", few_digits(c.rms_after, 2)),
                      2, 4);
  for (const auto& [like, which] : {std::pair(&candidate.like_first, 0U), std::pair(&candidate.like_second, 1U)})
    if (!like->empty())
      text += paragraph(
          fmt::format("{} may replace {}.", names(*like), name_of(candidate.alternatives[which].constant)), 2, 2);
  return text;
}

/// "at most 0.994 V if it is Kw, 9.93 V if it is K", for the members that this signal tells from the first.
std::string separation_by(const model::SignalDifference& difference, DriveConstant first) {
  const auto& info = model::info_of(difference.signal);
  std::vector<std::string> others;
  for (const model::MemberDifference& m : difference.members)
    if (m.relative >= model::kClearDifference)
      others.push_back(fmt::format("{} {} if it is {}", few_digits(m.peak), info.unit, name_of(m.member)));
  if (others.empty()) return "";
  return paragraph(fmt::format("To tell {} apart record {} ({}): at most {} {} if it is {}, {}.",
                               others.size() == difference.members.size() ? "them" : "some of them", info.name,
                               info.words, few_digits(difference.peak), info.unit, name_of(first),
                               fmt::join(others, ", ")));
}

std::string separation_text(const DriveCandidate& candidate) {
  if (candidate.alternatives.size() < 2 || candidate.together) return "";
  std::string text;
  for (const model::SignalDifference& s : candidate.signals)
    text += separation_by(s, candidate.alternatives.front().constant);
  return text.empty() ? "No other signal of the axis tells them apart.\n" : text;
}

std::string verdict_text(const DriveDiagnosis& d) {
  switch (d.verdict) {
    case DriveVerdict::agrees:
      return "The simulation agrees with the recording: what is left is noise.\n";
    case DriveVerdict::wrong_constant:
      return "One constant explains the difference:\n";
    case DriveVerdict::wrong_constants:
      return "No single constant explains the difference; two together do:\n";
    case DriveVerdict::unexplained:
      break;
  }
  return "Neither one constant nor two explain the difference. What comes nearest:\n";
}

std::string text_of(const DriveDiagnosis& d, const model::DriveTrace& trace, const model::DriveParameters& given) {
  std::string text = paragraph(fmt::format(
      "step of {} mm at {} mm/min, {} samples, noise {} V, the move starts at {} s", few_digits(trace.move.distance_mm),
      few_digits(trace.move.feed_mm_min, 4), d.observations, few_digits(d.noise_V, 2), few_digits(d.start_s, 3)));
  text += "\n" + shapes_text(d) + "\n" + verdict_text(d);
  std::size_t shown = 0;
  for (const DriveCandidate& candidate : d.candidates) {
    if (candidate.explains != d.candidates.front().explains || shown == 4) break;
    if (shown++ > 0) text += candidate.explains ? "or\n" : "";
    text += group_text(candidate, given) + separation_text(candidate);
  }
  std::vector<std::string> weaker;
  for (const DriveCandidate& candidate : d.candidates)
    if (!candidate.explains && d.candidates.front().explains)
      weaker.push_back(fmt::format("{} (leaves {} V)", name_of(candidate.alternatives.front().constant),
                                   few_digits(candidate.rms_after_V)));
  if (!weaker.empty()) text += "\n" + paragraph(fmt::format("Not enough alone: {}.", fmt::join(weaker, ", ")));
  if (!d.silent.empty()) text += paragraph(fmt::format("The recording says nothing about {}.", names(d.silent)));
  return d.notes.empty() ? text : text + "\n" + notes_text(d.notes);
}

Json json_of(const StepShape& shape) {
  return {{"steady_V", number_or_null(shape.steady)},
          {"rise_s", number_or_null(shape.rise_s)},
          {"decay_start_s", number_or_null(shape.decay_start_s)},
          {"fall_s", number_or_null(shape.fall_s)}};
}

Json names_json(const std::vector<DriveConstant>& constants) {
  Json list = Json::array();
  for (const DriveConstant c : constants) list.push_back(name_of(c));
  return list;
}

Json json_of(const DriveCandidate& candidate, double rms_V) {
  Json parameters = Json::array(), factors = Json::object(), values = Json::object(), sigmas = Json::object(),
       units = Json::object(), each = Json::object(), separated = Json::array(), signals = Json::array();
  for (const DriveChange& c : candidate.alternatives) {
    const std::string name = name_of(c.constant);
    parameters.push_back(name);
    factors[name] = number_or_null(c.factor);
    values[name] = number_or_null(c.value);
    sigmas[name] = number_or_null(c.sigma);
    units[name] = model::info_of(c.constant).unit;
    each[name] = number_or_null(c.rms_after);
  }
  for (const model::DriveSignal s : candidate.separated_by) separated.push_back(model::info_of(s).name);
  for (const model::SignalDifference& s : candidate.signals) {
    Json members = Json::object(), peaks = Json::object();
    peaks[name_of(candidate.alternatives.front().constant)] = number_or_null(s.peak);
    for (const model::MemberDifference& m : s.members) {
      members[name_of(m.member)] = number_or_null(m.relative);
      peaks[name_of(m.member)] = number_or_null(m.peak);
    }
    signals.push_back(
        {{"signal", model::info_of(s.signal).name}, {"relative_difference", members}, {"peak_if", peaks}});
  }
  Json object{{"parameters", parameters},
              {"together", candidate.together},
              {"explains", candidate.explains},
              {"factor", number_or_null(candidate.alternatives.front().factor)},
              {"factors", factors},
              {candidate.together ? "values" : "value_if_others_trusted", values},
              {"sigma", sigmas},
              {"unit", units},
              {"rms_before_V", number_or_null(rms_V)},
              {"rms_after_V", number_or_null(candidate.rms_after_V)},
              {"rms_after_each_V", each},
              {"separated_by", separated},
              {"signals", signals}};
  if (candidate.together)
    object["instead_of"] = {{name_of(candidate.alternatives[0].constant), names_json(candidate.like_first)},
                            {name_of(candidate.alternatives[1].constant), names_json(candidate.like_second)}};
  return object;
}

Json json_of(const DriveDiagnosis& d, const model::DriveTrace& trace) {
  Json candidates = Json::array();
  for (const DriveCandidate& candidate : d.candidates) candidates.push_back(json_of(candidate, d.rms_V));
  return {{"trace", trace.source},
          {"feed_mm_min", number_or_null(trace.move.feed_mm_min)},
          {"distance_mm", number_or_null(trace.move.distance_mm)},
          {"observations", d.observations},
          {"rms_V", number_or_null(d.rms_V)},
          {"noise_V", number_or_null(d.noise_V)},
          {"verdict", model::name_of(d.verdict)},
          {"move_starts_s", number_or_null(d.start_s)},
          {"measured", json_of(d.measured)},
          {"simulated", json_of(d.as_given)},
          {"mended", d.candidates.empty() ? Json() : json_of(d.mended)},
          {"candidates", candidates},
          {"says_nothing_about", names_json(d.silent)},
          {"notes", d.notes}};
}

}  // namespace

bool is_trace_file(const std::string& file) {
  const auto text = read_file(file);
  return text && model::is_drive_trace(*text);
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
    panel.series.push_back(series("simulated as mended", Mark::both, diagnosis.mended_V, 120));
  return {fmt::format("step of {} mm at {} mm/min", few_digits(trace.move.distance_mm),
                      few_digits(trace.move.feed_mm_min, 4)),
          {panel},
          1,
          true};
}

Result<TraceComparison> compare_trace(const std::string& model, const std::string& trace) {
  const auto drive = model::read_drive(model);
  if (!drive) return tl::unexpected(drive.error());
  const auto recorded = model::read_trace(trace);
  if (!recorded) return tl::unexpected(recorded.error());
  const DriveDiagnosis diagnosis = model::diagnose_drive(*drive, *recorded);
  return TraceComparison{{text_of(diagnosis, *recorded, *drive), one_line(json_of(diagnosis, *recorded)), kDone},
                         trace_figure(*recorded, diagnosis)};
}

}  // namespace ecs::commissioning
