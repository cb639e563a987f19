// Scores `ecs model diagnose` on written cases (its JSON: docs/verbs.md). The rules:
//  - Rows with hidden effects: right if the verdict is missing_effect, likely_effect or partly_explained and the
//  effects
//    proved or likely, here called named, are exactly the hidden ones. A hidden effect counts as named too where a
//    rival that the case's own algebra lists as required or allowed is named in its place and the answer's group holds
//    the truth. A cyclic must have its approach, a thermal effect its sensor.
//  - `adequate` on a hidden effect: right only where a least-squares fit that knows the effect has p > 0.01.
//  - confounded: right if the first candidate and its indistinguishable_from hold the truth and every required rival,
//    and nothing that is neither required nor allowed.
//  - outside: right if unexplained_structure. bad_run: the same with `run` in `where`.
//  - blank: right if adequate with nothing named.
//  - Parameters (where the answer is right and names the truth itself): the truth is in `parameters_set`, a member of
//    which is at most three Cramér–Rao standard deviations away, or within three of the stated standard deviations; the
//    place of a step between the same two targets. `near` counts, whatever is stated, answers within three Cramér–Rao
//    standard deviations; `unstated` those with neither a set nor a standard deviation (undetermined, or held).
#pragma once

#include <filesystem>
#include <string>

#include "base/result.hpp"

namespace foreign {

/// @return the table and one line for each wrong case
[[nodiscard]] ecs::Result<std::string> score_folder(const std::filesystem::path& folder, const std::string& ecs_program,
                                                    int jobs);

}  // namespace foreign
