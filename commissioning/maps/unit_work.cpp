#include "commissioning/maps/unit_work.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commissioning/link/emulator_process.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/unit/transfer.hpp"
#include "core/memory_image.hpp"
#include "laser/map/error_map.hpp"

namespace ecs::commissioning {
namespace {

/// @param what  "The parameters are"
std::string other_than_emulated(std::string_view what, std::string_view configuration, const WatchedUnit& unit) {
  const auto file = unit.emulator ? emulated_machine() : std::nullopt;
  const auto emulated = file ? params::read_machine(*file) : Result<params::MachineFile>(params::MachineFile{});
  if (!emulated || emulated->machine.configuration.empty() || emulated->machine.configuration == configuration)
    return {};
  return fmt::format(
      "{} for the machine configuration {}, but the emulated machine \"{}\" has {}. Its unit refuses a map for another "
      "configuration.",
      what, configuration, emulated->machine.name, emulated->machine.configuration);
}

}  // namespace

MapFiles files_of_map(const std::string& map_file) {
  const std::string stem = map_file.ends_with(".csv") ? map_file.substr(0, map_file.size() - 4) : map_file;
  return {map_file, stem + "-parameters.toml", stem + "-recipe.toml", stem + "-files"};
}

std::string other_unit_for(const UnitParameters& p, const WatchedUnit& unit) {
  if (std::string other = other_than_emulated("The parameters are", configuration_of(p), unit); !other.empty())
    return other;
  if (unit.identity && unit.identity->configuration != 0 && unit.identity->configuration != configuration_hash(p))
    return fmt::format(
        "The parameters ({}) have a different configuration from the map in the unit, which refuses them.",
        configuration_of(p));
  return {};
}

std::string mismatch_of(const params::Machine& machine, const laser::MeasurementSet& set) {
  for (const laser::Reading& reading : set.readings)
    if (!machine.axes[index_of(reading.axis)])
      return fmt::format("{} was measured, but the machine file ({}) has no axis {}.", letter_of(reading.axis),
                         machine.configuration, letter_of(reading.axis));
  return {};
}

std::string other_unit_for(const params::Machine& machine, const WatchedUnit& unit) {
  return other_than_emulated("The machine file is", machine.configuration, unit);
}

namespace {

std::string check_text(const std::optional<std::uint32_t>& check) {
  return check ? fmt::format("checksum {:08X}", *check) : std::string("no map");
}

/// Who answers is known already: the connection asked before it gave the link. The status is asked once, not also by
/// active_check(): on a slow link it is what takes the time.
Result<UnitHolding> holding_over(UnitConnection& unit, UnitLink& link) {
  ECS_TRY(status, link.client().status());
  const WatchedUnit watched = unit.snapshot();
  UnitHolding holding{watched.identity ? watched.identity->serial_number : "", std::nullopt, status.commit_sequence,
                      status.uptime_s, watched.opened_at};
  if (status.active_bank == protocol::Bank::none) return holding;
  holding.check = status.block_check_expected;
  return holding;
}

/// Why the unit may not compensate with what it holds; empty: it is what is expected.
std::string other_than(const ExpectedMap& expected, const UnitHolding& now) {
  if (expected.serial_number != now.serial_number)
    return fmt::format("this is unit {}, but the map was {} unit {}", now.serial_number,
                       expected.compared ? "compared in" : "sent to", expected.serial_number);
  if (expected.check != now.check)
    return fmt::format("the unit contains {}, but {} was {}: another host has changed it", check_text(now.check),
                       expected.compared ? "the compared map" : "the sent map", check_text(expected.check));
  return {};
}

}  // namespace

std::string changed_since(const UnitHolding& then, const UnitHolding& now) {
  if (now.serial_number != then.serial_number)
    return fmt::format("unit {} answers instead of {}", now.serial_number, then.serial_number);
  if (now.check != then.check)
    return fmt::format("another host changed it: it contains {} instead of {}", check_text(now.check),
                       check_text(then.check));
  if (now.activations != then.activations) return "another host made a map or parameters active in it";
  if (now.uptime_s < then.uptime_s) return "it was restarted";
  if (now.opened_at != then.opened_at) return "the link to it was reopened";
  return {};
}

std::string unit_text(const WatchedUnit& unit) {
  if (!unit.open) return "no link to a unit: " + (unit.problem.empty() ? "it is being opened" : unit.problem);
  return fmt::format("{}, serial number {}", unit.emulator ? "EMULATOR" : unit.link,
                     unit.identity ? unit.identity->serial_number : "?");
}

Question question_before_sending(const ReadyMap& ready, const WatchedUnit& unit,
                                 const std::vector<std::string>& remarks) {
  std::string doubts;
  if (!remarks.empty())
    doubts = fmt::format("{}{} {}. ", remarks_counted(remarks.size()),
                         remarks.size() == 1 ? ":" : ", the first:", remarks.front());
  if (const auto missing = laser::missing_in(ready.map->header); !missing.empty())
    doubts += fmt::format("The header states no {}. ", fmt::join(missing, ", no "));
  if (!ready.tools_beyond.empty()) doubts += fmt::format("Note: {}. ", ready.tools_beyond);
  const std::string replaced =
      ready.active
          ? fmt::format(
                "They replace the contents of the unit ({}), which it keeps until the new map is complete and checked",
                check_text(ready.active))
          : "The unit contains no map yet, and accepts this one only as a whole";
  return {fmt::format("Send the map to {}?", unit_text(unit)),
          fmt::format("{}{} bytes with parameters, checksum {:08X}. {}; press Esc to stop the transfer.", doubts,
                      ready.map->image.bytes.size(), ready.check, replaced),
          "send", "not now"};
}

std::string sent_text(const SentMap& sent) {
  if (sent.report.already_held)
    return fmt::format("unit {} already contains this map, checksum {:08X}: not sent again",
                       sent.identity.serial_number, sent.check);
  if (sent.report.was_in_other_bank())
    return fmt::format(
        "unit {} already contained this map in its inactive bank: nothing sent, made active, checksum {:08X}",
        sent.identity.serial_number, sent.check);
  return fmt::format("sent to unit {} and verified: {} bytes in {:.1f} s, checksum {:08X}", sent.identity.serial_number,
                     sent.report.bytes, sent.seconds, sent.check);
}

Result<ReadyMap> ready_map(UnitConnection& unit, JobControl& control, const MapFiles& files) {
  ECS_TRY(prepared, prepared_map(files.map, files.parameters));
  return unit.with_link(control, [&](UnitLink& link) -> Result<ReadyMap> {
    ECS_TRY(identity, link.client().identity());
    std::vector<std::string> objections = other_unit(prepared, identity.serial_number);
    for (std::string& why : no_room_for(prepared.image.bytes, identity)) objections.push_back(std::move(why));
    if (auto refused = refused_map(objections, files.map)) return tl::unexpected(std::move(*refused));
    ECS_TRY(image, addressed(prepared.image.bytes, identity, Addressee::as_stated));
    prepared.image.bytes = std::move(image);
    ECS_TRY(active, active_check(link.client()));
    const std::uint32_t check = ImageView(prepared.image.bytes).check();
    const auto parameters = ImageView(prepared.image.bytes).parameters();
    std::string beyond = parameters ? tools_beyond_range(link.client(), *parameters) : std::string();
    return ReadyMap{
        std::make_shared<const PreparedMap>(std::move(prepared)), files, identity, active, check, std::move(beyond)};
  });
}

SendAttempt sent_map(UnitConnection& unit, JobControl& control, const ReadyMap& ready) {
  bool begun = false;
  auto sent = unit.with_link(control, [&](UnitLink& link) -> Result<SentMap> {
    ECS_TRY(active, active_check(link.client()));
    if (active != ready.active)
      return problem(ProblemKind::refused,
                     "the map in the unit changed before the confirmation: another host has changed it. Not sent; "
                     "press Enter to ask again");
    const auto before = [&begun](std::optional<std::uint32_t>) { begun = true; };
    return send_map(link.client(), *ready.map, ready.files.map, false, before, progress_into(control));
  });
  return {std::move(sent), begun};
}

void note_sent_map(const UnitConnection& unit, const MapFiles& files) {
  note_on_unit(unit, {"map", "send", path_word(files.map), "--params", path_word(files.parameters)});
}

Result<VerifiedMap> verified_map(UnitConnection& unit, JobControl& control, const MapFiles& files) {
  return unit.with_link(control, [&](UnitLink& link) -> Result<VerifiedMap> {
    ECS_TRY(before, holding_over(unit, link));
    ECS_TRY(found, map_in(link.client(), progress_into(control)));
    ECS_TRY(verdict, verdict_on(found, files.map, files.parameters));
    ECS_TRY(after, holding_over(unit, link));
    if (const std::string why = changed_since(before, after); !why.empty())
      return problem(ProblemKind::refused,
                     "the unit changed while being read (" + why + "): press Enter to compare again");
    return VerifiedMap{std::move(verdict), after};
  });
}

Result<UnitHolding> holding_of_unit(UnitConnection& unit, JobControl& control) {
  return unit.with_link(control, [&](UnitLink& link) { return holding_over(unit, link); });
}

Result<params::ParametersFile> parameters_of_unit(UnitConnection& unit, JobControl& control) {
  return unit.with_link(control, [&](UnitLink& link) -> Result<params::ParametersFile> {
    ECS_TRY(identity, link.client().identity());
    ECS_TRY(parameters, receive_parameters(link.client()));
    params::ParametersFile received;
    received.parameters = parameters;
    received.identity.serial_number = identity.serial_number;
    return received;
  });
}

Result<void> switch_to_compensation(UnitConnection& unit, JobControl& control, const ExpectedMap& expected) {
  return unit.with_link(control, [&](UnitLink& link) -> Result<void> {
    ECS_TRY(now, holding_over(unit, link));
    if (const std::string why = other_than(expected, now); !why.empty())
      return problem(
          ProblemKind::refused,
          why + ". It is not switched to compensation; press Enter to compare again, or send again in step 8");
    return link.client().enter_compensation();
  });
}

}  // namespace ecs::commissioning
