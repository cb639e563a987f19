// The name of the JSON type, for headers; json.hpp is for the .cpp files that make or read JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace ecs {

/// Keys stay in the order in which they are written.
using Json = nlohmann::ordered_json;

}  // namespace ecs
