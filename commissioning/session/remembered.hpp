// What outlives a screen. What forms and choosers propose: the files opened or saved last, where the measurements
// before and after compensation lie. Work that is not saved yet, kept on disc as it grows, so that a crash, a closed
// terminal or a lost link costs nothing: the screen that made it offers it again.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"

namespace ecs::commissioning {

/// Puts it first. What cannot be written is not remembered. @param path  made absolute
void remember_file(const std::string& path);
/// Absolute paths that still exist, the newest first.
[[nodiscard]] std::vector<std::string> recent_files();

struct MeasuredPhases {
  std::string plan;    ///< file
  std::string before;  ///< folder; empty: not known
  std::string after;   ///< folder
};

/// Kept as long as the program runs.
void remember_measured_phases(const MeasuredPhases& phases);
/// Those remembered last; empty: none.
[[nodiscard]] MeasuredPhases measured_phases();

struct Draft {
  std::string kept;  ///< when, local time: "2026-05-04 14:05"
  std::string text;
};

/// @param name  of the screen: "parameters"; one draft each, in state_folder()/drafts
[[nodiscard]] Result<void> keep_draft(const std::string& name, const std::string& text);
/// Whether the draft kept last could not be written: what is not saved would be lost.
[[nodiscard]] bool drafts_fail();
/// Nothing: there is none, or it cannot be read.
[[nodiscard]] std::optional<Draft> draft_of(const std::string& name);
void drop_draft(const std::string& name);

// Several drafts of one screen: one is in work, the others are set aside.

/// Makes room for new work: the draft is kept and offered again when there is no other.
void set_draft_aside(const std::string& name);
[[nodiscard]] std::size_t drafts_aside(const std::string& name);
/// The draft that was set aside first takes the place of the one in work, which is set aside.
void exchange_draft(const std::string& name);
/// What a screen offers at its beginning: the draft in work, else the one set aside last, which is in work from then
/// on.
[[nodiscard]] std::optional<Draft> offered_draft(const std::string& name);

}  // namespace ecs::commissioning
