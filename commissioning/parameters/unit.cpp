#include "commissioning/parameters/unit.hpp"

#include <fmt/format.h>

#include "commissioning/unit/transfer.hpp"

namespace ecs::commissioning {

std::string title_of(const UnitContent& unit) {
  return unit.identity.serial_number.empty() ? unit.name
                                             : fmt::format("{}, unit {}", unit.name, unit.identity.serial_number);
}

Result<UnitContent> unit_content(UnitLink& link) {
  UnitContent unit;
  unit.name = link.is_emulator() ? "EMULATOR" : link.name();
  ECS_TRY(identity, link.client().identity());
  unit.identity = std::move(identity);
  ECS_TRY(status, link.client().status());
  unit.mode = status.mode;
  auto parameters = receive_parameters(link.client());
  if (parameters) {
    unit.parameters = *parameters;
  } else if (parameters.error().kind == ProblemKind::refused) {
    unit.none_because =
        status.active_bank == protocol::Bank::none ? "it holds no parameters yet" : to_text(parameters.error());
  } else {
    return tl::unexpected(parameters.error());
  }
  return unit;
}

Result<UnitContent> switched_to_integration(UnitLink& link) {
  ECS_DO(link.client().enter_integration());
  return unit_content(link);
}

Result<SentParameters> sent_to_unit(UnitLink& link, const UnitParameters& parameters, const params::Identity& owner,
                                    UnfitMap unfit, const protocol::ProgressCallback& progress) {
  ECS_TRY(report, send_parameters(link.client(), parameters, owner, unfit, progress));
  auto after = unit_content(link);
  if (!after) {
    after.error().message = "the unit has taken the parameters; but looking at it afterwards: " + after.error().message;
    return tl::unexpected(std::move(after.error()));
  }
  return SentParameters{std::move(report), std::move(*after)};
}

bool refused_for_map(const Problem& why) {
  return why.kind == ProblemKind::refused && why.message.starts_with("the map in the unit does not fit");
}

std::string other_unit_sentence(const ParameterSet& set, const UnitContent& unit) {
  if (other_unit(set.identity, unit.identity.serial_number).empty()) return {};
  return fmt::format("These parameters are for unit {}, but this is unit {}.", set.identity.serial_number,
                     unit.identity.serial_number);
}

}  // namespace ecs::commissioning
