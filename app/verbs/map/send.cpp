// `ecs map send`: a complete map of this machine, with its parameters, into the unit; checked there.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "commissioning/maps/prepared_map.hpp"
#include "commissioning/maps/sent.hpp"
#include "commissioning/unit/transfer.hpp"

namespace ecs::app {
namespace {

constexpr std::string_view kBeforeFirstCompensation =
    "check polarity and scale of every axis with `ecs utility output` before the first compensation";

struct SendArguments : VerbArguments {
  const std::string& file = text("FILE", "map CSV", Need::required);
  const std::string& params = text("--params", "parameters of the unit, sent with the map", Need::required);
  const bool& other_machine = flag("--other-machine", "send although map, parameters and unit name other machines");
  const bool& accept_incomplete =
      flag("--accept-incomplete", "send although the parameter file does not end with its closing line");
  const bool& accept_resampling =
      flag("--accept-resampling", "send although resampling changes a table by more than its resolution");
  const Access access = writes_to_unit();
};

Result<Outcome> send(VerbContext& context, const SendArguments& arguments) {
  const auto ready =
      prepared_map(arguments.file, arguments.params,
                   {arguments.other_machine, arguments.accept_incomplete ? Incomplete::accept : Incomplete::refuse,
                    arguments.accept_resampling});
  if (!ready) return tl::unexpected(ready.error());
  for (const std::string& note : ready->image.notes) context.console.note(note);
  for (const std::string& remark : ready->remarks) context.console.warn(remark);
  ECS_TRY(unit, open_unit(context, arguments.access));
  const auto sent =
      send_map(unit.client(), *ready, arguments.file, arguments.other_machine, {}, progress_bar(context, "map"));
  context.console.end_progress();
  if (!sent) return tl::unexpected(sent.error());
  if (sent->check_before != sent->check && !context.console.json) context.console.note(kBeforeFirstCompensation);
  return finished_outcome_of(record_cell(
      sent->report.already_held
          ? "unit {serial_number} holds {map} already, block check {check}, commit {commit_sequence}: nothing was sent"
          : "{map} sent to unit {serial_number} and verified: {bytes} bytes in {seconds} s, block check {check}, "
            "commit "
            "{commit_sequence}",
      {{"map", word_cell(arguments.file)},
       {"bytes", count_cell(sent->report.bytes)},
       {"bytes_sent", count_cell(sent->report.bytes_sent)},
       {"already_held", yes_cell(sent->report.already_held, "", "")},
       {"seconds", number_cell(sent->seconds, 1)},
       {"check", word_cell(fmt::format("{:08X}", sent->check))},
       {"verified", yes_cell(true, "", "")},
       {"commit_sequence", count_cell(sent->report.commit_sequence)},
       {"serial_number", text_cell(sent->identity.serial_number)},
       {"notes", lines_cell(ready->image.notes, "")}}));
}

}  // namespace

extern const VerbDefinition kMapSend = verb<SendArguments>(
    "map send", "a complete map with its parameters to the unit: whole or not at all, checked in the unit's memory",
    "ecs map send map.csv --params mill.toml --link rtu:/dev/ttyUSB0:115200", send);

}  // namespace ecs::app
