// What a screen says where the unit has refused a transfer because nobody has typed its code at this computer.
#pragma once

#include <string>
#include <string_view>

#include "base/result.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::commissioning {

/// The unit refused it because this host is not armed.
[[nodiscard]] inline bool is_not_armed(const Problem& why) {
  return why.message.find(protocol::text_of(protocol::UnitError::not_armed)) != std::string::npos;
}
inline constexpr std::string_view kNotArmed =
    "Not sent: the unit accepts nothing from this computer until its code is typed. The unit was not changed.";

}  // namespace ecs::commissioning
