// Work that is not saved yet, kept on disc as it grows, so that a crash, a closed terminal or a lost link costs
// nothing: the screen that made it offers it again.
#pragma once

#include <optional>
#include <string>

#include "base/result.hpp"

namespace ecs::commissioning {

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

}  // namespace ecs::commissioning
