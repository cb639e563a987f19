// What the laser screen does on the line to the unit, and on disc before it: each piece runs in the thread of a job.
// Does not live here: what is asked before (laser_send_page.cpp), the transfer itself (app/map_sent.hpp).
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/map_sent.hpp"
#include "app/screens/job.hpp"
#include "app/screens/laser_work.hpp"
#include "app/screens/unit_desk.hpp"

namespace ecs::app {

/// Seen while a map is on its way.
struct SendSigns {
  std::atomic<double> seconds_left{-1.0};  ///< below 0: not known yet
  std::atomic<bool> begun{false};          ///< bytes leave for the unit
  std::atomic<bool> had_map{false};        ///< `check_before` holds
  std::atomic<std::uint32_t> check_before{0};
};

/// A map that passed every check here and at the unit, which has not got it yet.
struct ReadyMap {
  std::shared_ptr<const PreparedMap> map;
  MapFiles files;
  protocol::Identity unit;
  std::optional<std::uint32_t> active;  ///< block check of what the unit holds now
  std::uint32_t check = 0;              ///< of this map
};

/// Reads map and parameters from disc, judges them, and asks the unit who it is and whether it has room.
[[nodiscard]] Result<ReadyMap> ready_map(UnitDesk& unit, JobSigns& signs, const MapFiles& files);
/// Whole or not at all; the old map stays active until the new one is whole and read back.
[[nodiscard]] Result<SentMap> sent_map(UnitDesk& unit, JobSigns& signs, const ReadyMap& ready, SendSigns& seen);
/// Reads the unit's map back and compares it and the parameters with the files.
[[nodiscard]] Result<MapVerdict> verified_map(UnitDesk& unit, JobSigns& signs, const MapFiles& files, SendSigns& seen);
/// The block check of what is active in the unit; nothing: no image.
[[nodiscard]] Result<std::optional<std::uint32_t>> check_in_unit(UnitDesk& unit, JobSigns& signs);
/// The parameters that the unit holds, written into a file, with the unit's serial number as whose they are.
[[nodiscard]] Result<void> receive_parameters_into(UnitDesk& unit, JobSigns& signs, const std::string& file);
/// Compensation mode: the unit tests its memory, then waits for the axes to be referenced.
/// @param expected  block check of the map that was sent from here; refused if the unit holds another one by now
[[nodiscard]] Result<void> switch_to_compensation(UnitDesk& unit, JobSigns& signs,
                                                  std::optional<std::uint32_t> expected);

}  // namespace ecs::app
