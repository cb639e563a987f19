// The virtual workshop as a process: machine, unit, line and door in one single-threaded event loop.
// Does not live here: the command line (ecs_emulator/verbs).
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "base/result.hpp"
#include "ecs_emulator/unit/unit.hpp"

namespace ecs::emulator {

struct ServeOptions {
  std::filesystem::path machine;
  std::filesystem::path errors;              ///< empty: what the machine file names
  std::optional<std::filesystem::path> pty;  ///< symbolic link to make to the pseudo-terminal; empty path: none
  std::optional<std::uint16_t> tcp;          ///< port; 0: any. Neither: a pseudo-terminal
  std::string tcp_host = "127.0.0.1";        ///< address of the interface for it
  bool also_tcp = false;                     ///< beside the pseudo-terminal TCP on any free port of 127.0.0.1
  std::string token_file;                    ///< what a TCP host must show; empty: nothing, on loopback only
  int unit = 1;                              ///< Modbus unit number
  std::string serial_number;                 ///< empty: what the machine file says
  std::filesystem::path memory;              ///< the battery's file; empty: memory lasts as long as the process
  std::filesystem::path workshop;            ///< socket; empty: no door
  std::optional<std::uint64_t> seed;         ///< absent: what the machine file says
  int pace_baud = 0;                         ///< 0: as fast as the pseudo-terminal goes
  std::uint8_t memory_modules = 5;
  LinkSense mode = LinkSense::automatic;
  std::string arm_code;     ///< that the unit shows; empty: six digits by chance
  bool fixed_code = false;  ///< the code was given: too many wrong ones do not change it
  bool real_time = false;   ///< simulated time goes by the clock, what is done in the workshop too
};

/// Machine and errors, put together.
/// @param errors, seed, serial_number  in place of what the machine file says; empty: what it says
[[nodiscard]] Result<Simulation> simulation_for(const std::filesystem::path& machine,
                                                const std::filesystem::path& errors, std::optional<std::uint64_t> seed,
                                                const std::string& serial_number = {});

/// Serves until `stop` is set.
/// @param ready  gets one JSON object when everything answers: {"pty", "tcp", "workshop", "serial_number", "unit",
///               "arm_code"}; with also_tcp "second_link" as --link takes it
[[nodiscard]] Result<void> serve(const ServeOptions& options, const std::atomic<int>& stop,
                                 const std::function<void(const std::string&)>& ready);

}  // namespace ecs::emulator
