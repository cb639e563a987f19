// A diagnosis kept as a file and checked on its data: with the model, map and machine that it was made with, the
// answer needs the data alone.
// Does not live here: what is recomputed (model/diagnosis/check.hpp), the rest of the answer (view.hpp).
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "commissioning/models/work.hpp"
#include "model/diagnosis/check.hpp"

namespace ecs::commissioning {

/// Adds what a check needs to the JSON of diagnosis_cell(): "data_sha256" (the content of the files, one after the
/// other), "plain", "model" (text of a model file, its map apart), "map" (CSV, or null), "machine" (text of the
/// machine file, or null).
[[nodiscard]] Result<void> add_check_inputs(Cell& answer, const ModelArguments& arguments, const ModelWork& work,
                                            bool plain);

/// Recomputes a kept answer. A `bad_input` problem where it is no such answer, or the data are not those that it was
/// made from.
/// @param machine  a file in place of the machine of the answer; empty: none
[[nodiscard]] Result<model::Check> check_answer(MessageSink& messages, const std::string& answer_file,
                                                const std::vector<std::string>& data, const std::string& machine,
                                                const ImportArguments& import);

/// {"holds", "checked": [{"name", "claimed", "recomputed", "holds"}], "objections"}
[[nodiscard]] Cell check_cell(const model::Check& check);

}  // namespace ecs::commissioning
