// Why a link does not work, found out without writing to the unit; and whether the other programs are there.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/interrupt.hpp"
#include "commissioning/link/choice.hpp"
#include "protocol/client/client.hpp"

namespace ecs::commissioning {

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
