// One try at each kind of hidden case; nothing comes of it where the design drawn cannot show what is to be hidden.
// What a model can absorb of a set of readings and what of an error it cannot; the base model: errors that the engineer
// knows of already. For .cpp files of this folder only (Eigen). Does not live here: trying again (case.cpp).
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Dense>

#include "modules/hidden_cases/case.hpp"
#include "modules/hidden_cases/hiding.hpp"
#include "modules/hidden_cases/scene.hpp"

namespace ecs::emulator {

/// Contributions that span an effect (readings × functions).
[[nodiscard]] Eigen::MatrixXd contribution_columns(const Scene& scene, const Ground& ground, const DrawnEffect& effect);
[[nodiscard]] Eigen::VectorXd vector_of(const std::vector<double>& values);
[[nodiscard]] double rms_of(const Eigen::VectorXd& values);

/// The space of all that some effects can produce, as an orthonormal basis: Gram-Schmidt with each projection done
/// twice (Daniel, Gragg, Kaufman, Stewart, Math. Comp. 30, 1976, 772).
class Absorbed {
 public:
  explicit Absorbed(std::size_t readings) : basis_(static_cast<Eigen::Index>(readings), 0) {}
  void add(const Eigen::MatrixXd& columns);
  /// What is left of these columns.
  [[nodiscard]] Eigen::MatrixXd left_of(const Eigen::MatrixXd& columns) const;
  [[nodiscard]] Eigen::VectorXd left_of(const Eigen::VectorXd& values) const;
  [[nodiscard]] Eigen::Index size() const { return basis_.cols(); }

 private:
  Eigen::MatrixXd basis_;
};

/// An effect that may stand in the place of another.
struct Rival {
  DrawnEffect effect;
  double separation = 0.0;  ///< length of what it cannot reproduce of the other, in standard deviations of one reading
  double size = 0.0;        ///< coefficient with which it comes closest, where it has a single one
  bool flexible = false;    ///< a smooth curve, or a nonlinear parameter that was searched
};
/// Every effect of the library, at every place, against what is left of `hidden` once `absorbed` is taken out.
/// @param hidden  contribution at its size [um]; the sign of a cosine counts
/// @param flexible  try curves and nonlinear parameters too
/// @param enough    the search ends with the first rival of which this is true
[[nodiscard]] std::vector<Rival> rivals_of(const Scene& scene, const Ground& ground, const Absorbed& absorbed,
                                           const Eigen::VectorXd& hidden, double sigma_um, bool flexible,
                                           const std::function<bool(const Rival&)>& enough = {});

/// A rival that comes this close, in sigmas, does the same.
inline constexpr double kSame = 0.3;

/// A rival that stays this far off, in sigmas, does not.
inline constexpr double kApart = 8.0;

/// What the base model must leave alone.
struct Reserved {
  std::vector<DrawnEffect> hidden;
  std::vector<DrawnEffect> needed;  ///< places that it must hold
  bool free = false;                ///< its nonlinear parameters are not given, and any effect may be in it
  Designs design = kNoDesign;       ///< effects excluded from it have no place in this base model
};

/// Share of an error's mean square that the base model must leave.
inline constexpr double kLeastShare = 0.05;

/// The effect that holds the mean and slope of a curve which has none itself.
[[nodiscard]] std::optional<DrawnEffect> line_of(const DrawnEffect& effect);

/// Draws it; sizes are about 1 um still. `absorbed` becomes what it can produce.
[[nodiscard]] std::vector<DrawnEffect> draw_background(Random& random, const Scene& scene, const Ground& ground,
                                                       const Reserved& reserved, Absorbed& absorbed);

/// A design on which different effects do the same (compose.cpp).
struct ConfoundedDesign;

/// What all tries of a case have in common.
struct Wanted {
  CaseKind kind = CaseKind::blank;
  std::vector<const EffectDefinition*> effects;    ///< hidden; of a blank: what the design is made for
  const StructureDefinition* structure = nullptr;  ///< out of library
  const ConfoundedDesign* design = nullptr;        ///< confounded
  bool free_base = false;
  const EffectDefinition* in_base = nullptr;  ///< of a free base: an effect that it must hold
  NoiseLaw law = NoiseLaw::usual;
  double snr = 3.0;
  std::size_t readings = 300;
};

[[nodiscard]] std::optional<HiddenCase> compose(Random& random, const Wanted& wanted);
[[nodiscard]] std::optional<HiddenCase> compose_confounded(Random& random, const Wanted& wanted);
[[nodiscard]] std::optional<HiddenCase> compose_xytz(Random& random, const Wanted& wanted);

[[nodiscard]] const std::vector<const ConfoundedDesign*>& confounded_designs();
/// Those that may hide this effect.
[[nodiscard]] std::vector<const ConfoundedDesign*> confounded_designs_of(const EffectDefinition& kind);

/// Sizes, noise, background, readings and truth for a scene with its hidden effects (sizes still open) and its base
/// model. Nothing where sizes or noise would be out of reach.
[[nodiscard]] std::optional<HiddenCase> finished(Random& random, HiddenCase begun, const Ground& ground,
                                                 const Absorbed& absorbed, double snr, NoiseLaw law = NoiseLaw::usual);

}  // namespace ecs::emulator
