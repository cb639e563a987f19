#include "modules/investigation/ledger.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/paragraph.hpp"
#include "commissioning/models/view.hpp"
#include "modules/investigation/readings.hpp"

namespace ecs::commissioning {

std::vector<SetMember> credible_set_of(const model::Candidate& candidate) {
  std::vector<SetMember> set = candidate.set;
  std::erase_if(set, [](const SetMember& member) { return is_zero_of_run(member.name); });
  if (set.empty()) set.push_back({to_text(candidate.effect), candidate.probability});
  return set;
}

std::vector<SetMember> members_left(const model::Diagnosis& diagnosis) {
  std::vector<SetMember> left;
  for (const model::Candidate& candidate : diagnosis.candidates) {
    if (!candidate.in_answer()) continue;
    for (SetMember& member : credible_set_of(candidate))
      if (std::none_of(left.begin(), left.end(), [&](const SetMember& m) { return m.name == member.name; }))
        left.push_back(std::move(member));
  }
  return left;
}

bool causes_are_single(const model::Diagnosis& diagnosis) {
  bool any = false;
  for (const model::Candidate& candidate : diagnosis.candidates) {
    if (!candidate.in_answer()) continue;
    any = true;
    if (credible_set_of(candidate).size() > 1) return false;
  }
  return any;
}

namespace {

/// One bar a member, up to so many: a falling staircase.
std::string bar_of(std::size_t members) {
  constexpr std::size_t kMost = 8;
  return std::string(std::min(members, kMost), '#') + (members > kMost ? "+" : "");
}

std::string micrometres(const std::optional<double>& um) { return um ? fmt::format("{:.3f} um", *um) : "unknown"; }

Cell programme_cell(const IsoProgramme& programme) {
  const bool one = programme.lines == 1;
  return record_cell(
      "ISO 230-2 programme of the same {what}: {runs} bidirectional runs over {targets} targets, {dwell_s} s dwell and "
      "trigger, {set_up_minutes} min set-up a line, {minutes} min",
      {{"lines", count_cell(programme.lines)},
       {"runs", {IsoProgramme::kRuns, fmt::format("{}", IsoProgramme::kRuns)}},
       {"targets", count_cell(programme.targets)},
       {"dwell_s", {number_or_null(programme.dwell_s), fmt::format("{:g}", programme.dwell_s)}},
       {"set_up_minutes", {number_or_null(programme.set_up_minutes), fmt::format("{:g}", programme.set_up_minutes)}},
       {"what", shown_cell(one ? "line" : fmt::format("{} lines", programme.lines))},
       {"minutes", shown_cell(fmt::format("{:.0f}", programme.minutes))}});
}

Cell cause_cell(const InvestigatedCause& cause) {
  Cell parameters{Json::object(), parameters_text(cause.parameters)};
  for (const model::ParameterEstimate& one : cause.parameters) parameters.json[one.name] = number_or_null(one.value);
  Cell cell = record_cell("{name}, probability {probability}, {rms_um} um rms: {parameters}",
                          {{"name", word_cell(cause.name)},
                           {"parameters", parameters},
                           {"probability", number_cell(cause.probability, 2)},
                           {"rms_um", number_cell(cause.rms_um, 2)}});
  cell.text = paragraph(cell.text, 2, 4);
  return cell;
}

Cell micrometres_cell(const std::optional<double>& um) { return {number_or_null(um), micrometres(um)}; }

std::string verdict_text(const Investigation& investigation) {
  if (!investigation.verdict) return "Nothing was measured.";
  switch (*investigation.verdict) {
    case model::Verdict::adequate:
      return "Nothing is missing from the model: what it leaves is noise.";
    case model::Verdict::missing_effect:
      return fmt::format("{} missing from the model:",
                         investigation.causes.size() == 1 ? "One cause was" : "Causes were");
    case model::Verdict::partly_explained:
      return "A cause is proved, but more is left than it explains:";
    case model::Verdict::likely_effect:
      return "Probably missing from the model, but not proved:";
    case model::Verdict::cannot_tell:
      return "These data cannot tell whether anything is missing from the model.";
    case model::Verdict::unexplained_structure:
      if (!investigation.causes.empty()) return "Proved, but the lesser part of what the model leaves:";
      break;
  }
  return "Nothing proved explains what the model leaves, and it is no noise.";
}

}  // namespace

std::string ledger_head() {
  return fmt::format("{:>2} {:>6} {:>6} {:>8} {:>4}  {}", "", "min", "in all", "rms um", "left", "measured");
}

std::string ledger_line(std::size_t number, const InvestigationStep& step, double total_minutes) {
  const std::string head = fmt::format("{:>2} {:>6.1f} {:>6.1f} {:>8.3f} {:>4}  ", number, step.minutes, total_minutes,
                                       step.rms_um, step.set.size());
  const std::string below(columns_of(head), ' ');
  std::string text = paragraph_after(head, step.measured);
  if (step.set.empty()) {
    text += paragraph_after(below, name_of(step.verdict));
  } else {
    std::string members = bar_of(step.set.size());
    for (const SetMember& member : step.set) members += fmt::format(" {} {:.2f}", member.name, member.probability);
    text += paragraph_after(below, members);
  }
  text.pop_back();
  return text;
}

Cell step_cell(const InvestigationStep& step) {
  return record_cell({}, {{"minutes", {number_or_null(step.minutes), {}}},
                          {"measured", word_cell(step.measured)},
                          {"readings", count_cell(step.readings)},
                          {"verdict", word_cell(name_of(step.verdict))},
                          {"set", list_cell(step.set,
                                            [](const SetMember& member) {
                                              return record_cell({},
                                                                 {{"name", word_cell(member.name)},
                                                                  {"probability", number_cell(member.probability, 2)}});
                                            })},
                          {"rms_um", {number_or_null(step.rms_um), {}}}});
}

Cell investigation_cell(const Investigation& investigation) {
  const auto& verdict = investigation.verdict;
  const AnswerFields fields{
      {"steps", list_cell(investigation.steps, step_cell)},
      {"verdict", {verdict ? Json(name_of(*verdict)) : Json(nullptr), paragraph(verdict_text(investigation))}},
      {"causes", list_cell(investigation.causes, cause_cell)},
      {"minutes", number_cell(investigation.minutes, 0)},
      {"programme_minutes", {number_or_null(investigation.programme.minutes), {}}},
      {"programme", programme_cell(investigation.programme)},
      {"rms_before_um", micrometres_cell(investigation.rms_before_um)},
      {"rms_compensated_um", micrometres_cell(investigation.rms_compensated_um)},
      {"compensated_minutes", number_cell(investigation.compensated_minutes, 0)},
      {"notes", {investigation.notes, notes_text(investigation.notes)}}};
  std::string text = laid_out("{verdict}{causes}", fields);
  if (verdict)
    text += paragraph(laid_out("{minutes} min in all; {programme}", fields)) +
            paragraph(laid_out(investigation.rms_compensated_um
                                   ? "error: {rms_before_um} rms before, {rms_compensated_um} with the new map "
                                     "({compensated_minutes} min of measuring again)"
                                   : "error: {rms_before_um} rms before, {rms_compensated_um} with the new map",
                               fields));
  return {object_of(fields), text + laid_out("{notes}", fields)};
}

std::string summary_text(const Investigation& investigation) { return investigation_cell(investigation).text; }

}  // namespace ecs::commissioning
