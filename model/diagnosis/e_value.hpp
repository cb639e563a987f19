// Evidence for an effect: on readings that it was not fitted to; the chance that noise lets it gain as much as it does,
// small enough to hold among many machines; the level that a score must exceed, from replicates of noise that are
// searched in the same way. Internal to model/ (Eigen).
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "model/diagnosis/investigation.hpp"
#include "model/diagnosis/structure.hpp"
#include "model/fit/held_out.hpp"
#include "model/fit/noise.hpp"
#include "model/fit/search.hpp"

namespace ecs::model {

/// What an effect is weighed against: columns and target of the model with every other named effect, not whitened.
struct Evidence {
  const Regressors& regressors;
  const NoiseModel& noise;
  const std::vector<bool>& left_out;
};

/// What the readings may be without the effect: white noise and turbulence of seconds, or a wander as well.
enum class NullHypothesis { noise, noise_or_wander };

/// e-value of an effect: mean over splits by runs and by targets of how much likelier it makes readings that it was not
/// fitted to than the best the model can do when fitted to these very readings, each with its own size of the noise.
/// At most 1/α of data sets without the effect exceed α on average over them (Markov). Nothing where no split shows the
/// effect on both sides.
/// Beside a wander or turbulence the readings that the effect was fitted to are given, for the others depend on them.
/// @param columns,target  of the model without the effect  @param effect  its searched parameter is searched again
[[nodiscard]] std::optional<double> e_value_of(const Evidence& on, const Eigen::MatrixXd& columns,
                                               const Eigen::VectorXd& target, const EffectInstance& effect,
                                               NullHypothesis null);

/// F test of the columns of an effect beside those of the model, for having been the best of this many tests: at most a
/// share p of data sets of noise alone has any test with a value of p or less (Bonferroni). Exact for Gaussian noise of
/// any size and of the shape given; of all shapes that the readings leave possible the one that speaks least for the
/// effect counts.
/// @param columns,target  of the model without the effect  @param effect  at a value that was fixed before the readings
/// @param tests  candidates, times values tried of this one, times its sets of columns
[[nodiscard]] double p_value_of(const Evidence& on, const Eigen::MatrixXd& columns, const Eigen::VectorXd& target,
                                const Eigen::MatrixXd& effect, double tests);

/// Replicates of noise, whitened, what the model absorbs taken off.
class Replicates {
 public:
  Replicates(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
             const Whitener& whitener, const Space& base)
      : noise_(data, noise, left_out), whitener_(whitener), base_(base), drawn_(base.y.size(), 0) {}
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(drawn_.cols()); }
  [[nodiscard]] const Eigen::MatrixXf& all() const { return drawn_; }
  void draw_up_to(std::size_t count) {
    if (count <= size()) return;
    const Eigen::MatrixXf fresh = without(base_.q, whitener_(noise_.next(count - size())).cast<float>());
    drawn_.conservativeResize(Eigen::NoChange, drawn_.cols() + fresh.cols());
    drawn_.rightCols(fresh.cols()) = fresh;
  }
  /// All of them, what `space` absorbs taken off.
  [[nodiscard]] Eigen::MatrixXf beside(const Space& space) const { return without(space.q, drawn_); }

 private:
  static Eigen::MatrixXf without(const Eigen::MatrixXd& q, Eigen::MatrixXf columns) {
    if (q.cols() == 0) return columns;
    const Eigen::MatrixXf qf = q.cast<float>();
    const Eigen::MatrixXf products = qf.transpose() * columns;
    columns.noalias() -= qf * products;
    return columns;
  }
  SimulatedNoise noise_;
  const Whitener& whitener_;
  const Space& base_;
  Eigen::MatrixXf drawn_;
};

/// The score that an effect must reach; beyond all where noise explains everything.
void find_level(const Search& search, const Structure& structure, Replicates& replicates,
                const DiagnoseOptions& options, Found& found);

/// Effects that are refined where the size of the noise is open: the best under noise that is too large is the
/// simplest.
inline constexpr std::size_t kRefinedBesideNoise = 8;

/// What the best effect explains of the residual, compared with what any effect explains of noise of the same size: the
/// ratio of likelihoods where the size of the noise is not known (its logarithm is that of the F test).
struct BesideNoise {
  Choice best;          ///< of the choices
  double chance = 1.0;  ///< that any effect explains as much of noise alone; 1 where it plainly does
};
/// Readings that have one noise, of unknown size.
struct OfOneNoise {
  Eigen::VectorXf counts;  ///< 1 for each of them, else 0
  double squares = 0.0;    ///< that are left of them, in units of the noise assumed
  double freedom = 0.0;
};
/// @param choices  that act on these readings
[[nodiscard]] BesideNoise beside_noise_of_any_size(const Search& search, const OfOneNoise& readings,
                                                   Replicates& replicates, const std::vector<Choice>& choices,
                                                   const DiagnoseOptions& options);

}  // namespace ecs::model
