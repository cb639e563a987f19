// Unsaved parameters as the text of a draft, and back.
#pragma once

#include <string>

#include "commissioning/parameters/set.hpp"

namespace ecs::commissioning {

struct ParametersDraft {
  std::string file;     ///< they were opened from; empty: none
  std::string machine;  ///< file they were checked against; empty: none
  ParameterSet set;
  ParameterSet base;  ///< as last loaded, saved or sent
};
/// Two parameter files one after the other, so that people can read it too.
[[nodiscard]] std::string draft_text(const ParametersDraft& draft);
[[nodiscard]] Result<ParametersDraft> parsed_draft(const std::string& text);

}  // namespace ecs::commissioning
