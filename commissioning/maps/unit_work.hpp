// What the screens do with a map on the link to the unit, and on disc before it: each piece runs in the thread of a
// task.
// Files of one machine beside readings or a unit of another are said when the file is chosen, not when it is sent.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/link/unit_connection.hpp"
#include "commissioning/maps/map_in_unit.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"
#include "laser/measurement_set.hpp"
#include "params/machine.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {

/// The files that belong to a map: "out/map.csv" → "out/map-parameters.toml", "out/map-recipe.toml", "out/map-files".
struct MapFiles {
  std::string map, parameters, recipe, folder;
};
[[nodiscard]] MapFiles files_of_map(const std::string& map_file);

/// Why the unit, or its emulated machine, would refuse what is made with these parameters.
[[nodiscard]] std::string other_unit_for(const UnitParameters& parameters, const WatchedUnit& unit);

/// Why this machine is not the one that was measured; empty: as far as is known it is. @param set  what was measured
[[nodiscard]] std::string mismatch_of(const params::Machine& machine, const laser::MeasurementSet& set);
[[nodiscard]] std::string other_unit_for(const params::Machine& machine, const WatchedUnit& unit);

/// A map that passed every check here and at the unit, which has not got it yet.
struct ReadyMap {
  std::shared_ptr<const PreparedMap> map;
  MapFiles files;
  protocol::Identity unit;
  std::optional<std::uint32_t> active;  ///< checksum of what the unit holds now
  std::uint32_t check = 0;              ///< of this map
  std::string tools_beyond{};           ///< tools_beyond_range() of its parameters
};

struct SendAttempt {
  Result<SentMap> sent;
  bool begun = false;  ///< bytes left for the unit
};

/// Which unit, and which map is active in it: what a comparison holds for.
struct UnitHolding {
  std::string serial_number;
  std::optional<std::uint32_t> check;                 ///< checksum of the active map; nothing: it holds none
  std::uint32_t activations = 0;                      ///< counts the maps made active in the unit
  std::uint32_t uptime_s = 0;                         ///< since power-up
  std::chrono::steady_clock::time_point opened_at{};  ///< the link over which it was asked
};
/// Why what was found in `then` cannot be said of the unit any more; empty: it still holds.
[[nodiscard]] std::string changed_since(const UnitHolding& then, const UnitHolding& now);

struct VerifiedMap {
  MapVerdict verdict;
  UnitHolding holding;
};

/// What the unit must still hold before it may compensate: what was found the same last, or, if nothing was compared
/// since, what was sent.
struct ExpectedMap {
  explicit ExpectedMap(const SentMap& sent) : serial_number(sent.identity.serial_number), check(sent.check) {}
  explicit ExpectedMap(const UnitHolding& found)
      : serial_number(found.serial_number), check(found.check), compared(true) {}
  std::string serial_number;
  std::optional<std::uint32_t> check;
  bool compared = false;  ///< false: sent
};

/// Reads map and parameters from disc, judges them, and asks the unit who it is and whether it has room.
[[nodiscard]] Result<ReadyMap> ready_map(UnitConnection& unit, JobControl& control, const MapFiles& files);
/// Asked before sent_map(): to which unit, what it replaces, what speaks against it and does not forbid it.
/// @param remarks  findings of the map that are no objections
[[nodiscard]] Question question_before_sending(const ReadyMap& ready, const WatchedUnit& unit,
                                               const std::vector<std::string>& remarks);
/// "EMULATOR, serial number 7", "no link to a unit: …"
[[nodiscard]] std::string unit_text(const WatchedUnit& unit);
/// "sent to unit 7 and verified: 1234 bytes in 0.2 s, checksum 1234ABCD"
[[nodiscard]] std::string sent_text(const SentMap& sent);
/// Whole or not at all; the old map stays active until the new one is whole and checked in the unit.
[[nodiscard]] SendAttempt sent_map(UnitConnection& unit, JobControl& control, const ReadyMap& ready);
/// That the map was sent, as a command.
void note_sent_map(const UnitConnection& unit, const MapFiles& files);
/// Reads the unit's map back and compares it and the parameters with the files. Refused if the unit was given another
/// map while it was read.
[[nodiscard]] Result<VerifiedMap> verified_map(UnitConnection& unit, JobControl& control, const MapFiles& files);
/// Who the unit is and what is active in it: a few short transfers.
[[nodiscard]] Result<UnitHolding> holding_of_unit(UnitConnection& unit, JobControl& control);
/// The parameters that the unit holds, with its serial number as whose they are.
[[nodiscard]] Result<params::ParametersFile> parameters_of_unit(UnitConnection& unit, JobControl& control);
/// Compensation mode: the unit tests its memory, then waits for the axes to be referenced. Refused, saying why, unless
/// the unit is the one, and holds the very map, that is expected.
[[nodiscard]] Result<void> switch_to_compensation(UnitConnection& unit, JobControl& control,
                                                  const ExpectedMap& expected);

}  // namespace ecs::commissioning
