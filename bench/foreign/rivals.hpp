// Which effects can stand for which, by projections of their columns: no list made by hand.
#pragma once

#include <string>
#include <vector>

#include "bench/foreign/case.hpp"

namespace foreign {

/// What one effect leaves of something, its nonlinear parameter at the best value that its limits allow.
struct Reproduction {
  Term term;
  double excess = 0.0;  ///< χ² that it leaves
  int parameters = 0;   ///< dimensions that the base model does not hold, and the nonlinear one
  /// excess + parameters · ln n (Schwarz 1978)
  double score = 0.0;
};

/// Least squares in whitened rows beside a base model.
class Projector {
 public:
  /// @param fixed_base  terms whose columns, and derivatives with respect to nonlinear parameters, are free
  Projector(const Setup& setup, const Noise& noise, const std::vector<Term>& fixed_base);
  [[nodiscard]] Column rest_of(const Column& um) const;
  /// What is left by the best value of the candidate's nonlinear parameter; 0 parameters where it may not be one.
  [[nodiscard]] Reproduction of(const Term& candidate, const Column& rest) const;
  /// Every effect that may be a candidate, best first, one a name. @param waves  cyclic too
  [[nodiscard]] std::vector<Reproduction> ranked(const Column& rest, bool waves = true) const;
  [[nodiscard]] const std::vector<Term>& library() const { return library_; }
  /// Of the term as it is: dimensions that the base model does not hold, and the nonlinear one.
  [[nodiscard]] int parameters_of(const Term& term) const;

 private:
  [[nodiscard]] Reproduction at(const Term& candidate, const Column& rest) const;
  const Setup& setup_;
  const Noise& noise_;
  Basis base_;
  std::vector<Term> library_;
};

struct Rivals {
  std::vector<std::string> required;  ///< reproduce it to within 1/50 of the noise with no more parameters
  std::vector<std::string> allowed;   ///< the same with more parameters
  bool clear = true;                  ///< every other effect is worse by a score of kClearMargin
  bool simplest = true;               ///< no rival has fewer parameters
};
inline constexpr double kClearMargin = 25.0;
inline constexpr double kSameShare = 1.0 / 50.0;

/// Whether the same holds wherever the base's free nonlinear parameter is put, so that no other effect explains `um`
/// together with another warm_up or reversal_spike of the base. A cyclic needs no such look: a wave that takes the
/// hidden effect is a rival beside the true base already.
/// @param um  what is hidden and the base's last term @param base  its last term has the nonlinear parameter
[[nodiscard]] bool clear_of_free_base(const Setup& setup, const Noise& noise, const std::vector<Term>& base,
                                      const Term& truth, const Rivals& known, const Column& um);

/// @param hidden_um  contribution of `truth` without noise
[[nodiscard]] Rivals rivals_of(const Projector& projector, const Term& truth, const Column& hidden_um);

}  // namespace foreign
