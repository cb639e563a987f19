// `ecs doctor`: the findings as a list, and storing a link that works.
#include "commissioning/link/doctor.hpp"

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "commissioning/unit/status.hpp"

namespace ecs::app {
namespace {

struct DoctorRequest {
  bool save = false;
  static Fields<DoctorRequest> fields() {
    using R = DoctorRequest;
    return {{"--save", &R::save, "store the link if it works; it is then used without --link"}};
  }
};

Cell finding_cell(const DoctorFinding& finding) {
  const std::string action = finding.action.empty() ? "" : fmt::format("\n         -> {}", finding.action);
  return record_cell("{state:<8} {check}: {message}{action}\n", "check"_is(finding.check),
                     "state"_is(name_of(finding.state)), "message"_is(finding.message),
                     "action"_is(text_or_null(finding.action), action));
}

Json statistics_json(const protocol::LinkStatistics& s) {
  return object_of("requests"_is(s.requests), "retries"_is(s.retries), "timeouts"_is(s.timeouts),
                   "crc_errors"_is(s.crc_errors), "stale_replies"_is(s.stale_replies),
                   "mean_round_trip_ms"_is(s.replies > 0 ? number_or_null(s.mean_round_trip_ms()) : Json(nullptr)),
                   "worst_round_trip_ms"_is(s.replies > 0 ? number_or_null(s.worst_round_trip_ms) : Json(nullptr)));
}

Result<Outcome> examine(VerbContext& context, const DoctorRequest& request) {
  ECS_TRY(choice, chosen_link(context.link_option));
  context.link_name = to_text(choice);
  if (request.save && context.link_option.empty())
    return problem(ProblemKind::usage, "doctor --save: give the --link to store");
  Diagnosis diagnosis = diagnosis_of(choice, [&context](const std::string& note) { context.console.note(note); });
  if (request.save && diagnosis.works) {
    ECS_DO(store_link(context.link_name));
    diagnosis.findings.push_back(
        {"stored", FindingState::ok, fmt::format("stored in {}", configuration_file().string()), {}});
  }
  std::vector<DoctorFinding> findings = diagnosis.findings;
  for (DoctorFinding& finding : surroundings()) findings.push_back(std::move(finding));
  const bool works = diagnosis.works;
  const auto& lines = diagnosis.lines;
  return outcome_of(
      record_cell("link {link} ({origin})\n{findings}{works}", "link"_is(context.link_name), "origin"_is(choice.origin),
                  "works"_is(works, "the link works\n", "the link does not work\n"),
                  "working_link"_is(text_cell(diagnosis.working_link)),
                  "serial_number"_is(diagnosis.identity ? text_cell(diagnosis.identity->serial_number) : null_cell()),
                  "battery"_is(lines ? Cell{battery_cell(*lines).json, {}} : null_cell()),
                  "battery_age_s"_is(lines ? cell_of(lines->battery_age_s) : null_cell()),
                  "control_on"_is(lines ? Cell{control_cell(*lines).json, {}} : null_cell()),
                  "statistics"_is(statistics_json(diagnosis.statistics)),
                  "findings"_is(list_cell(findings, finding_cell)),
                  "error"_is(works ? shown_cell() : Cell{problem_json(why_not(diagnosis)), {}})),
      works ? kDone : exit_code_of(ProblemKind::link));
}

}  // namespace

extern const std::vector<Action> kDoctor{
    action("doctor", "find out why a link does not work, and how to correct it; changes nothing in the unit",
           "ecs doctor --link rtu:/dev/ttyUSB0:115200\n  ecs doctor --link rtu:/dev/ttyUSB0:115200 --save", examine,
           {.link = Link::reads})};

}  // namespace ecs::app
