// Why a link does not work, found out without writing to the unit: what can be learnt about a serial port without
// talking Modbus, what answers on it; and whether the other programs are there.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/process.hpp"
#include "base/result.hpp"
#include "commissioning/link/choice.hpp"
#include "protocol/client/client.hpp"
#include "protocol/line/link_address.hpp"

namespace ecs::commissioning {

/// Serial ports of this computer: USB adapters and built-in ones that have hardware behind them.
[[nodiscard]] std::vector<std::string> serial_ports();

/// Why the device cannot be opened, in words with what to do; nothing if it can.
struct PortTrouble {
  std::string message;
  std::string action;
};
[[nodiscard]] std::optional<PortTrouble> trouble_with(const std::string& device);

/// One read request, byte by byte as it is, and what comes back within half a second.
struct PortAnswer {
  std::vector<std::uint8_t> sent;
  std::vector<std::uint8_t> received;
  [[nodiscard]] bool is_echo() const;  ///< the link returns what is sent
};

enum class FindingState { ok, note, problem };
[[nodiscard]] std::string_view name_of(FindingState state);

struct DoctorFinding {
  std::string check;  ///< "link", "port", "speed", "unit number", "echo", "late answers", "gnuplot", …
  FindingState state = FindingState::ok;
  std::string message;
  std::string action;  ///< what to do; empty: nothing
};

struct Diagnosis {
  bool works = false;
  std::string working_link;  ///< another link that answers, if the given one does not; empty: none found
  std::optional<protocol::Identity> identity;
  std::optional<protocol::ControlLines> lines;  ///< nothing: the unit has none (firmware before 1.1)
  protocol::LinkStatistics statistics;
  std::vector<DoctorFinding> findings;
};

using DoctorNote = std::function<void(const std::string&)>;
using FindingCallback = std::function<void(const DoctorFinding&)>;

/// The link, step by step; stops at the first cause it finds. Reads only.
/// @param note       what is being tried now
/// @param on_finding       each finding as soon as it is made
/// @param cancelled  ends it between two questions
[[nodiscard]] Diagnosis diagnosis_of(const LinkChoice& choice, const DoctorNote& note,
                                     const FindingCallback& on_finding = {},
                                     const std::atomic<bool>& cancelled = interrupted());

/// The first finding that is a problem, with what to do.
[[nodiscard]] Problem why_not(const Diagnosis& diagnosis);

/// Emulator, sample machine, gnuplot, terminal.
[[nodiscard]] std::vector<DoctorFinding> surroundings();

}  // namespace ecs::commissioning
