// This computer and its user, as units know them: the key that all programs of the user share, and a name for records.
#pragma once

#include <string>

#include "protocol/client/client.hpp"

namespace ecs::commissioning {

/// The key is kept in state_folder(); where that cannot be written, it is one by chance. Without a code.
[[nodiscard]] protocol::Host this_host();

/// $ECS_ARM_CODE; empty: not set.
[[nodiscard]] std::string arm_code_in_environment();

}  // namespace ecs::commissioning
