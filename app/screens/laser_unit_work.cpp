#include "app/screens/laser_unit_work.hpp"

#include "app/map_checks.hpp"
#include "core/memory_image.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::app {
namespace {

protocol::ProgressCallback told_to(JobSigns& signs, SendSigns& seen) {
  return [&signs, &seen](const protocol::Progress& progress) {
    if (progress.bytes_total > 0)
      signs.part = static_cast<double>(progress.bytes_done) / static_cast<double>(progress.bytes_total);
    seen.seconds_left = progress.seconds_left;
  };
}

}  // namespace

Result<ReadyMap> ready_map(UnitDesk& unit, JobSigns& signs, const MapFiles& files) {
  auto prepared = prepared_map(files.map, files.parameters);
  if (!prepared) return tl::unexpected(prepared.error());
  return unit.on_line(signs, [&](UnitLink& line) -> Result<ReadyMap> {
    const auto identity = line.client().identity();
    if (!identity) return tl::unexpected(identity.error());
    std::vector<std::string> objections = other_unit(*prepared, identity->serial_number);
    for (std::string& why : no_room_for(prepared->image.bytes, *identity)) objections.push_back(std::move(why));
    if (auto refused = refused_map(objections, files.map)) return tl::unexpected(std::move(*refused));
    const auto active = active_check(line.client());
    if (!active) return tl::unexpected(active.error());
    const std::uint32_t check = ImageView(prepared->image.bytes).check();
    return ReadyMap{std::make_shared<const PreparedMap>(std::move(*prepared)), files, *identity, *active, check};
  });
}

Result<SentMap> sent_map(UnitDesk& unit, JobSigns& signs, const ReadyMap& ready, SendSigns& seen) {
  return unit.on_line(signs, [&](UnitLink& line) -> Result<SentMap> {
    const auto active = active_check(line.client());
    if (!active) return tl::unexpected(active.error());
    if (*active != ready.active)
      return problem(ProblemKind::refused,
                     "the unit holds another map now than when it was asked for: another host has changed it. Nothing "
                     "was sent; Enter asks again");
    const auto before = [&seen](std::optional<std::uint32_t> check) {
      seen.had_map = check.has_value();
      seen.check_before = check.value_or(0);
      seen.begun = true;
    };
    return send_map(line.client(), *ready.map, ready.files.map, false, before, told_to(signs, seen));
  });
}

Result<MapVerdict> verified_map(UnitDesk& unit, JobSigns& signs, const MapFiles& files, SendSigns& seen) {
  return unit.on_line(signs, [&](UnitLink& line) -> Result<MapVerdict> {
    const auto found = map_in(line.client(), told_to(signs, seen));
    if (!found) return tl::unexpected(found.error());
    return verdict_on(*found, files.map, files.parameters);
  });
}

Result<std::optional<std::uint32_t>> check_in_unit(UnitDesk& unit, JobSigns& signs) {
  return unit.on_line(signs, [](UnitLink& line) { return active_check(line.client()); });
}

Result<void> receive_parameters_into(UnitDesk& unit, JobSigns& signs, const std::string& file) {
  return unit.on_line(signs, [&](UnitLink& line) -> Result<void> {
    const auto identity = line.client().identity();
    if (!identity) return tl::unexpected(identity.error());
    const auto parameters = receive_parameters(line.client());
    if (!parameters) return tl::unexpected(parameters.error());
    return params::write_parameters(file, *parameters, {"", identity->serial_number});
  });
}

Result<void> switch_to_compensation(UnitDesk& unit, JobSigns& signs, std::optional<std::uint32_t> expected) {
  return unit.on_line(signs, [&](UnitLink& line) -> Result<void> {
    const auto active = active_check(line.client());
    if (!active) return tl::unexpected(active.error());
    if (expected && *active != expected)
      return problem(ProblemKind::refused,
                     "the unit no longer holds the map that was sent from here: another host has changed it. Enter "
                     "compares again, step 8 sends again");
    return line.client().enter_compensation();
  });
}

}  // namespace ecs::app
