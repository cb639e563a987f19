// Terms of a case as they are drawn: hidden effects and base models.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/foreign/case.hpp"

namespace foreign {

inline constexpr double kLeastSnr = 1.5;
inline constexpr double kGreatestSnr = 8.0;

/// Adds what a set must have so that the effect can show.
void wish_for(Random& random, const std::string& id, Wishes& wishes);
/// The effect at a place where it can act, its size still arbitrary; nothing where the set has none.
[[nodiscard]] std::optional<Term> draw_term(Random& random, const Setup& setup, const std::string& id);
/// Root mean square of what the base model cannot take of `um`.
[[nodiscard]] double free_rms(const Setup& setup, const std::vector<Term>& base, const Column& um);
/// The user's model: linear terms that are truly there. @param without  ids that it lacks
void draw_base(Random& random, Case& drawn, const std::vector<std::string>& without);
/// Adds a term with free nonlinear or curve parameters that is truly there and mistaken for no other effect.
[[nodiscard]] bool add_free_base(Random& random, Case& drawn, const std::string& id);
/// Brings the hidden effect, or the noise where the effect has no free size, to a drawn ratio of signal to noise.
[[nodiscard]] bool set_size(Random& random, Case& drawn, Term& term);

}  // namespace foreign
