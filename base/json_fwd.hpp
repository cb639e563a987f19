// The names of the JSON types, for headers; json.hpp and answer_table.hpp are for the .cpp files that make or read
// JSON.
#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace ecs {

/// Keys stay in the order in which they are written.
using Json = nlohmann::ordered_json;

struct Cell;         ///< a value, record or list as JSON and as text; answer_table.hpp
struct AnswerField;  ///< a cell and its key
using AnswerFields = std::vector<AnswerField>;

}  // namespace ecs
