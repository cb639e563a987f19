// `ecs map send`: a complete map of this machine, with its parameters, into the unit; read back and compared.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/json.hpp"
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
  auto unit = open_unit(context, arguments.access);
  if (!unit) return tl::unexpected(unit.error());
  const auto sent =
      send_map(unit->client(), *ready, arguments.file, arguments.other_machine, {}, progress_bar(context, "map"));
  context.console.end_progress();
  if (!sent) return tl::unexpected(sent.error());
  const std::string check = fmt::format("{:08X}", sent->check);
  if (sent->check_before != sent->check && !context.console.json) context.console.note(kBeforeFirstCompensation);
  const Json object{{"map", arguments.file},
                    {"bytes", sent->report.bytes},
                    {"seconds", number_or_null(sent->seconds)},
                    {"check", check},
                    {"verified", true},
                    {"commit_sequence", sent->report.commit_sequence},
                    {"serial_number", text_or_null(sent->identity.serial_number)},
                    {"notes", ready->image.notes}};
  return Outcome{
      fmt::format("{} sent to unit {} and verified: {} bytes in {:.1f} s, block check {}, commit {}", arguments.file,
                  sent->identity.serial_number, sent->report.bytes, sent->seconds, check, sent->report.commit_sequence),
      one_line(object), kDone, true};
}

}  // namespace

extern const VerbDefinition kMapSend = verb<SendArguments>(
    "map send", "a complete map with its parameters to the unit: whole or not at all, read back and compared",
    "ecs map send map.csv --params mill.toml --link rtu:/dev/ttyUSB0:115200", send);

}  // namespace ecs::app
