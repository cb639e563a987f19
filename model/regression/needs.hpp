// What data must have for effects to act: the cells of a row, and whether a data set has them at all.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "model/effects/definition.hpp"

namespace ecs::model {

/// Whether the data set lacks what every instance of the effect needs.
[[nodiscard]] bool lacks_needs(const Observations& data, const EffectDefinition& definition);

/// What the data set lacks of that, as "the column load_kg" or "a machine file"; "" where nothing is lacking.
[[nodiscard]] std::string_view what_is_lacking(const Observations& data, const EffectDefinition& definition);

/// Whether row k has the cells that the effect needs.
[[nodiscard]] bool has_needs(const Observations& data, std::size_t k, const EffectInstance& effect);

/// Whether the effect follows what has gone by since the moving axis turned round: it dies away after that.
[[nodiscard]] bool follows_reversal(const EffectDefinition& definition);

/// The columns that an instance needs, as a note names them; "" if none.
[[nodiscard]] std::string needed_columns(const EffectInstance& effect);

/// Whether the condition that the effect follows takes two or three levels that coincide with runs, where the effect
/// may not (`turns_into`, tied_to_runs): it is then the offset of a run.
[[nodiscard]] bool is_tied_to_runs(const Observations& data, const EffectInstance& effect);
/// Whether it can be of any data.
[[nodiscard]] bool may_be_tied_to_runs(const EffectDefinition& definition);

/// Effects left out because the data lack what they need, in words.
[[nodiscard]] std::vector<std::string> untried_effects(const Observations& data);

}  // namespace ecs::model
