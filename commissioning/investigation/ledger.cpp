#include "commissioning/investigation/ledger.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/json.hpp"
#include "base/paragraph.hpp"
#include "commissioning/models/view.hpp"

namespace ecs::commissioning {
namespace {

/// One bar a member, up to so many: a falling staircase.
std::string bar_of(std::size_t members) {
  constexpr std::size_t kMost = 8;
  return std::string(std::min(members, kMost), '#') + (members > kMost ? "+" : "");
}

std::string micrometres(const std::optional<double>& um) { return um ? fmt::format("{:.3f} um", *um) : "unknown"; }

std::string programme_text(const IsoProgramme& programme) {
  return fmt::format(
      "ISO 230-2 programme of the same {}: {} bidirectional runs over {} targets, {:g} s dwell and trigger, {:g} min "
      "set-up a line, {:.0f} min",
      programme.lines == 1 ? "line" : fmt::format("{} lines", programme.lines), IsoProgramme::kRuns, programme.targets,
      programme.dwell_s, programme.set_up_minutes, programme.minutes);
}

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
    case model::Verdict::unexplained_structure:
      break;
  }
  return "No effect of the library explains what the model leaves.";
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

std::string summary_text(const Investigation& investigation) {
  std::string text = paragraph(verdict_text(investigation));
  for (const InvestigatedCause& cause : investigation.causes)
    text += paragraph(fmt::format("{}, probability {:.2f}, {:.2f} um rms: {}", cause.name, cause.probability,
                                  cause.rms_um, parameters_text(cause.parameters)),
                      2, 4);
  if (!investigation.verdict) return text + notes_text(investigation.notes);
  text +=
      paragraph(fmt::format("{:.0f} min in all; {}", investigation.minutes, programme_text(investigation.programme)));
  text += paragraph(fmt::format("error: {} rms before, {} with the new map{}", micrometres(investigation.rms_before_um),
                                micrometres(investigation.rms_compensated_um),
                                investigation.rms_compensated_um
                                    ? fmt::format(" ({:.0f} min of measuring again)", investigation.compensated_minutes)
                                    : ""));
  return text + notes_text(investigation.notes);
}

Json json_of(const InvestigationStep& step) {
  Json set = Json::array();
  for (const SetMember& member : step.set)
    set.push_back({{"name", member.name}, {"probability", number_or_null(member.probability)}});
  return {
      {"minutes", number_or_null(step.minutes)}, {"measured", step.measured}, {"readings", step.readings},
      {"verdict", name_of(step.verdict)},        {"set", std::move(set)},     {"rms_um", number_or_null(step.rms_um)}};
}

Json json_of(const Investigation& investigation) {
  Json steps = Json::array(), causes = Json::array();
  for (const InvestigationStep& step : investigation.steps) steps.push_back(json_of(step));
  for (const InvestigatedCause& cause : investigation.causes) {
    Json parameters = Json::object();
    for (const model::ParameterEstimate& one : cause.parameters) parameters[one.name] = number_or_null(one.value);
    causes.push_back({{"name", cause.name},
                      {"parameters", std::move(parameters)},
                      {"probability", number_or_null(cause.probability)},
                      {"rms_um", number_or_null(cause.rms_um)}});
  }
  const IsoProgramme& programme = investigation.programme;
  return {{"steps", std::move(steps)},
          {"verdict", investigation.verdict ? Json(name_of(*investigation.verdict)) : Json(nullptr)},
          {"causes", std::move(causes)},
          {"minutes", number_or_null(investigation.minutes)},
          {"programme_minutes", number_or_null(programme.minutes)},
          {"programme",
           {{"lines", programme.lines},
            {"runs", IsoProgramme::kRuns},
            {"targets", programme.targets},
            {"dwell_s", number_or_null(programme.dwell_s)},
            {"set_up_minutes", number_or_null(programme.set_up_minutes)}}},
          {"rms_before_um", number_or_null(investigation.rms_before_um)},
          {"rms_compensated_um", number_or_null(investigation.rms_compensated_um)},
          {"compensated_minutes", number_or_null(investigation.compensated_minutes)},
          {"notes", investigation.notes}};
}

}  // namespace ecs::commissioning
