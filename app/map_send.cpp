// `ecs map send`: a complete map of this machine, with its parameters, into the unit; read back and compared.
#include <chrono>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "app/json.hpp"
#include "app/map_checks.hpp"
#include "app/map_menu.hpp"
#include "app/prepared_map.hpp"
#include "app/transfer.hpp"
#include "app/unit_link.hpp"
#include "core/memory_image.hpp"

namespace ecs::app {
namespace {

constexpr std::string_view kBeforeFirstCompensation =
    "check polarity and scale of every axis with `ecs utility output` before the first compensation";

struct Arguments {
  std::string file;
  std::string params;
  bool other_machine = false;
};

/// The block check that the active image carries; nothing if the unit holds none.
Result<std::optional<std::uint32_t>> active_check(protocol::UnitClient& client) {
  const auto status = client.status();
  if (!status) return tl::unexpected(status.error());
  if (status->active_bank == protocol::Bank::none) return std::optional<std::uint32_t>();
  return client.read_memory(address_of(status->active_bank) + prefix_at::check, sizeof(std::uint32_t))
      .map([](const std::vector<std::uint8_t>& bytes) { return std::optional(load_big<std::uint32_t>(bytes, 0)); });
}

Result<Outcome> send(Session& session, const Arguments& arguments) {
  const auto ready = prepared_map(arguments.file, arguments.params, arguments.other_machine);
  if (!ready) return tl::unexpected(ready.error());
  for (const std::string& note : ready->image.notes) session.face.note(note);
  for (const std::string& remark : ready->remarks) session.face.warn(remark);
  auto unit = open_unit(session, Access::writes);
  if (!unit) return tl::unexpected(unit.error());
  const auto identity = unit->client().identity();
  if (!identity) return tl::unexpected(identity.error());
  if (!arguments.other_machine)
    if (auto refused = refused_map(other_unit(*ready, identity->serial_number), arguments.file))
      return tl::unexpected(std::move(*refused));
  const auto before = active_check(unit->client());
  if (!before) return tl::unexpected(before.error());
  const auto start = std::chrono::steady_clock::now();
  const auto report = send_image(unit->client(), ready->image.bytes, progress_bar(session, "map"));
  session.face.end_progress();
  if (!report) return tl::unexpected(report.error());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::uint32_t block_check = ImageView(ready->image.bytes).check();
  const std::string check = fmt::format("{:08X}", block_check);
  if (*before != block_check && !session.face.json) session.face.note(kBeforeFirstCompensation);
  const Json object{{"map", arguments.file},
                    {"bytes", report->bytes},
                    {"seconds", number_or_null(seconds)},
                    {"check", check},
                    {"verified", true},
                    {"commit_sequence", report->commit_sequence},
                    {"serial_number", text_or_null(identity->serial_number)},
                    {"notes", ready->image.notes}};
  return Outcome{
      fmt::format("{} sent to unit {} and verified: {} bytes in {:.1f} s, block check {}, commit {}", arguments.file,
                  identity->serial_number, report->bytes, seconds, check, report->commit_sequence),
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
