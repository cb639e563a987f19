// The parameters screen's talk with the unit: what it holds, sending with a look afterwards. For the thread of a Job.
#pragma once

#include <optional>
#include <string>

#include "commissioning/link/unit_link.hpp"
#include "commissioning/parameters/set.hpp"
#include "commissioning/unit/transfer.hpp"
#include "core/fault.hpp"

namespace ecs::commissioning {

/// What a unit said of itself at one moment.
struct UnitContent {
  std::string name;  ///< "EMULATOR", or the link
  protocol::Identity identity;
  UnitMode mode = UnitMode::starting;
  std::optional<UnitParameters> parameters;
  std::string none_because;  ///< why there are none: the unit is new, or its memory is corrupt
};
/// "EMULATOR, unit MCM-0107"
[[nodiscard]] std::string title_of(const UnitContent& unit);

/// A short transfer: identity, state, the parameters without their map.
[[nodiscard]] Result<UnitContent> unit_content(UnitLink& link);

/// Into integration mode, where the unit takes parameters; then what it holds.
[[nodiscard]] Result<UnitContent> switched_to_integration(UnitLink& link);

struct SentParameters {
  SendReport report;
  UnitContent after;  ///< read back
};
/// @param owner  against the header of the unit's map; empty: not judged
[[nodiscard]] Result<SentParameters> sent_to_unit(UnitLink& link, const UnitParameters& parameters,
                                                  const params::Identity& owner, UnfitMap unfit,
                                                  const protocol::ProgressCallback& progress);

/// Whether sending was refused because of the map in the unit, so that dropping the map would help.
[[nodiscard]] bool refused_for_map(const Problem& why);

/// Why the parameters are not for that unit: they state another serial number. Empty: they are, or do not say.
[[nodiscard]] std::string other_unit_sentence(const ParameterSet& set, const UnitContent& unit);

}  // namespace ecs::commissioning
