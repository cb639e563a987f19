// Whether what is left depends on anything: position, approach, run, time, sensors, feed, load, compensation; whether
// it wanders slowly: turbulence over minutes, another zero in every pass, a random walk. Internal to model/ (Eigen).
// Does not live here: what effect that may be (model/fit/search.hpp), the noise that repeats show
// (model/fit/noise.hpp).
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "model/fit/dependence.hpp"
#include "model/fit/noise.hpp"
#include "model/fit/search.hpp"

namespace ecs::model {

struct StructureTest {
  std::string variable;
  double gain = 0.0;         ///< χ² explained beyond what is absorbed
  double freedom = 0.0;      ///< functions used
  double excess = 0.0;       ///< (gain − freedom) per reading, in squares of the noise
  double minus_log_p = 0.0;  ///< nominal, base 10
};
/// The largest minus_log_p; 0 without tests.
[[nodiscard]] double largest_of(const std::vector<StructureTest>& tests);

class Structure {
 public:
  Structure(const Observations& data, const Whitener& whitener, double noise_freedom);

  /// Tests of what is left in `space`, one per variable.
  [[nodiscard]] std::vector<StructureTest> tests(const Space& space) const;
  [[nodiscard]] StructureTest test_of(const Space& space, std::size_t variable) const;
  /// The largest minus_log_p of each noise replicate (readings × replicates, whitened, what `space` absorbs taken off).
  [[nodiscard]] std::vector<double> largest_of(const Space& space, const Eigen::MatrixXf& noise_replicates) const;

  [[nodiscard]] const std::vector<Variable>& variables() const { return variables_; }

 private:
  /// What a variable adds to a space.
  struct Beyond {
    Eigen::MatrixXd q;  ///< orthonormal
    double chi2 = 0.0;  ///< that it leaves
  };
  [[nodiscard]] Beyond beyond(const Space& space, std::size_t variable) const;
  [[nodiscard]] StructureTest test_of(const Space& space, std::size_t variable, const Beyond& beyond) const;
  /// Of all variables; kept for the latest space, for its tests and replicates.
  [[nodiscard]] const std::vector<Beyond>& all_beyond(const Space& space) const;

  std::vector<Variable> variables_;
  std::vector<Eigen::MatrixXd> white_;
  double noise_freedom_;
  mutable Space latest_;
  mutable std::vector<Beyond> beyond_;
};

/// The tests of what each variable explains beyond the position along the measured line. @param tests  those of
/// `space`, kept where they show nothing
[[nodiscard]] std::vector<StructureTest> tests_beyond_position(const Observations& data, const Whitener& whitener,
                                                               const Structure& structure, const Space& space,
                                                               std::vector<StructureTest> tests);

/// −log10 of the chance that χ² of `freedom` degrees, over a noise known to `noise_freedom`, exceeds `gain`.
[[nodiscard]] double minus_log_p(double gain, double freedom, double noise_freedom);

/// The groups of a noise with this share of their variance in a process of this memory, 0 … 1: none in it is white.
[[nodiscard]] NoiseModel wandering(NoiseModel noise, double share, double memory);

/// A law of noise that wanders: the groups of `noise`, or beside them a level of its own for every run and sense.
struct Wander {
  NoiseModel noise;
  double level_um = 0.0;  ///< standard deviation of the levels of the runs
};

/// How well the readings agree with a model under one law of noise, less is better: −2 ln of their density, averaged
/// over all sizes of the model's columns and of the noise, none likelier beforehand than another, and with the sizes of
/// an effect at their best. To be compared for the same readings and columns; of all readings less that of a part of
/// them it is the density of the others.
/// @param columns  that the model may take freely, independent on the readings that are not left out
/// @param effect   columns of an effect, or none; all (readings × columns)  @param target  readings less what is held
[[nodiscard]] double deviance_of(const Observations& data, const Wander& law, const std::vector<bool>& left_out,
                                 const Eigen::MatrixXd& columns, const Eigen::MatrixXd& effect,
                                 const Eigen::VectorXd& target);

/// Levels of their own for every run and sense (readings × levels).
[[nodiscard]] Eigen::MatrixXd levels_of_runs(const Observations& data);

/// Those of the columns that do not follow from the others on the readings that are not left out.
[[nodiscard]] Eigen::MatrixXd independent_columns(const Eigen::MatrixXd& columns, const std::vector<bool>& left_out);

/// Something may wander beside an effect that leaves at most this share of the residual in squares, for its sensor may
/// be late or its law not quite that: then what wanders has at most half the size of the effect.
inline constexpr double kMostBesideEffect = 0.2;
/// Under the likeliest law: the noise as it was estimated, white, or turbulence of up to a minute; or a wander, if
/// asked.
[[nodiscard]] double least_deviance(const Observations& data, const NoiseModel& noise,
                                    const std::vector<bool>& left_out, const Eigen::MatrixXd& columns,
                                    const Eigen::MatrixXd& effect, const Eigen::VectorXd& target, bool or_wander);
/// A wander tried, and how well the readings agree with it.
struct LikelyWander {
  Wander law;
  double deviance = 0.0;
};
/// All wanders tried, the likeliest first.
[[nodiscard]] std::vector<LikelyWander> likely_wanders(const Observations& data, const NoiseModel& noise,
                                                       const std::vector<bool>& left_out,
                                                       const Eigen::MatrixXd& columns, const Eigen::VectorXd& target);

/// Whether the readings wander, and noise that wanders like them.
struct WanderingNoise {
  double probability = 0.0;    ///< that they do; beforehand all wanders together are as likely as none
  Eigen::MatrixXd replicates;  ///< readings × count, of any size: each wander as often as it is likely among all;
                               ///< empty where a wander is not likelier than none
};
/// @param columns,target  of the model
[[nodiscard]] WanderingNoise wandering_noise(const Observations& data, const NoiseModel& noise,
                                             const std::vector<bool>& left_out, const Eigen::MatrixXd& columns,
                                             const Eigen::VectorXd& target, std::size_t count);

/// Whether something wanders in what a model leaves: one of a few wanders is a hundred times likelier than
/// the noise as it is.
/// @param columns,target  of the model with all that was found
[[nodiscard]] bool is_wandering(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                                const Eigen::MatrixXd& columns, const Eigen::VectorXd& target);

/// Whether it does, and the likeliest wander is another in every pass, as a lost motion is: a zero of its own in each,
/// or one that lasts no longer than a pass.
[[nodiscard]] bool wanders_by_pass(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                                   const Eigen::MatrixXd& columns, const Eigen::VectorXd& target);

/// Whether an effect changes in time or with a condition, as a wander does.
[[nodiscard]] bool is_like_wander(const EffectInstance& effect);

/// Whether a wander can look like an effect in these readings: it changes in time or with a condition, is set by hand
/// from run to run, or nothing repeats it.
[[nodiscard]] bool may_be_wander(const NoiseModel& noise, const EffectInstance& effect);

}  // namespace ecs::model
