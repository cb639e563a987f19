// `ecs map send`: a complete map of this machine, with its parameters, into the unit; read back and compared.
#include <memory>

#include <fmt/format.h>

#include "app/verbs/map/menu.hpp"
#include "base/json.hpp"
#include "commissioning/link/unit_link.hpp"
#include "commissioning/maps/prepared_map.hpp"
#include "commissioning/maps/sent.hpp"
#include "commissioning/unit/transfer.hpp"

namespace ecs::app {
namespace {

constexpr std::string_view kBeforeFirstCompensation =
    "check polarity and scale of every axis with `ecs utility output` before the first compensation";

struct Arguments {
  std::string file;
  std::string params;
  bool other_machine = false;
};

Result<Outcome> send(Session& session, const Arguments& arguments) {
  const auto ready = prepared_map(arguments.file, arguments.params, arguments.other_machine);
  if (!ready) return tl::unexpected(ready.error());
  for (const std::string& note : ready->image.notes) session.face.note(note);
  for (const std::string& remark : ready->remarks) session.face.warn(remark);
  auto unit = open_unit(session, Access::writes);
  if (!unit) return tl::unexpected(unit.error());
  const auto sent =
      send_map(unit->client(), *ready, arguments.file, arguments.other_machine, {}, progress_bar(session, "map"));
  session.face.end_progress();
  if (!sent) return tl::unexpected(sent.error());
  const std::string check = fmt::format("{:08X}", sent->check);
  if (sent->check_before != sent->check && !session.face.json) session.face.note(kBeforeFirstCompensation);
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
      one_line(object), kDone};
}

}  // namespace

void add_map_send(Menu& menu) {
  const auto arguments = std::make_shared<Arguments>();
  menu.verb("send", "a complete map with its parameters to the unit: whole or not at all, read back and compared",
            "ecs map send map.csv --params mill.toml --link rtu:/dev/ttyUSB0:115200")
      .text("FILE", arguments->file, "map CSV", Need::required)
      .text("--params", arguments->params, "parameters of the unit, sent with the map", Need::required)
      .flag("--other-machine", arguments->other_machine, "send although map, parameters and unit name other machines")
      .writes_to_unit()
      .runs([arguments](Session& session) { return send(session, *arguments); });
}

}  // namespace ecs::app
