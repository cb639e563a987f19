// The noise of a data set: white plus turbulence correlated over seconds, per sense and moving axis, from repeats where
// there are any; which mixtures of both their scatter leaves possible; the whitening that makes it independent, of size
// one; and isolated readings that agree neither with their neighbours in the pass nor with their repeats.
// Internal to model/ (Eigen). Does not live here: what is not noise (model/diagnosis/structure.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "base/random.hpp"
#include "model/data/observations.hpp"
#include "model/fit/fit.hpp"

namespace ecs::model {

/// Positions closer than this are one target: a tenth of a micrometre, finer than an axis of a machine tool resolves.
inline constexpr double kSamePlace_mm = 1e-4;

/// Least degrees of freedom that the noise is given: an inverse χ² of fewer has no variance, and the few widest
/// replicates would decide everything.
inline constexpr double kFewestNoiseFreedom = 4.0;

/// Kinds of readings, each of which has an instrument or optics of its own. Lengths read while a rotary axis turns are
/// all `across`; paths are circles, diagonals and the like.
enum class ReadingKind : std::uint8_t { position, across, angle, path };
inline constexpr std::array kReadingKinds = {ReadingKind::position, ReadingKind::across, ReadingKind::angle,
                                             ReadingKind::path};
[[nodiscard]] ReadingKind kind_of(const Observations& data, std::size_t k);

/// Readings of one sense along one moving axis: one instrument, one noise.
struct NoiseGroup {
  Sense sense = Sense::EX;
  Axis axis = Axis::X;
  std::string path{};             ///< of readings along a path its name; sense and axis are then of its first axis
  std::vector<std::size_t> rows;  ///< canonical order
  double white = 1.0;             ///< standard deviation, um
  double correlated = 0.0;        ///< standard deviation, um
  double time = 0.0;              ///< correlation time: s, or readings where there is no time
  bool of_neighbours = false;     ///< readings of other kinds were repeated, those of its kind were not
  [[nodiscard]] double sigma() const;
};

/// One mixture of white and correlated noise, and how likely the data make it.
struct NoiseShape {
  double share = 0.0;            ///< of the correlated part in the variance
  double time = 1.0;             ///< correlation time: s, or readings where there is no time
  double weight = 1.0;           ///< all weights add up to 1
  std::vector<double> variance;  ///< of one reading, per group
};

struct NoiseModel {
  std::vector<NoiseGroup> groups;
  PureError pure;                  ///< over all groups
  std::vector<NoiseShape> shapes;  ///< what the data leave possible; the groups hold the likeliest
  bool has_time = false;
  /// Size of the noise of each reading, that of its group being 1: as their standard uncertainties are to their root
  /// mean square. Empty: all the same.
  std::vector<double> relative;
  [[nodiscard]] double relative_of(std::size_t k) const { return k < relative.size() ? relative[k] : 1.0; }
  [[nodiscard]] std::vector<double> sigma_by_row(std::size_t n) const;
};

/// Number of the node of each reading: readings of one node differ in run only.
struct Repeats {
  std::vector<std::size_t> node_of;  ///< per reading
  std::size_t nodes = 0;
};
/// Same axis, sense, position, approach and conditions (feed, load, set-up, compensated).
[[nodiscard]] Repeats repeats_of(const Observations& data);
/// The same whatever the conditions were: good for the noise, not for what these do.
[[nodiscard]] Repeats places_of(const Observations& data);

/// Number of the pass of each reading: same run, approach, axis, sense and parked place.
[[nodiscard]] std::vector<std::size_t> passes_of(const Observations& data);

/// Column with the standard uncertainty (k = 1) of each reading, in its own unit.
inline constexpr std::string_view kUncertaintyColumn = "u_um";
/// What a file states of the uncertainty of its readings, beside what they show.
struct StatedUncertainty {
  double um = 0.0;           ///< standard uncertainty of one reading, root mean square over the readings that state one
  double of_residual = 0.0;  ///< root mean square of residual ÷ standard uncertainty, reading by reading
  double of_noise = 0.0;     ///< noise of one reading ÷ um: the factor by which the stated ones are too small
};
/// NoiseModel::relative from the standard uncertainties that a file states; a reading without one counts as the root
/// mean square of its group. Empty where no reading has one.
[[nodiscard]] std::vector<double> relative_uncertainty(const Observations& data);
/// What is stated of the readings beside what they show; nothing where nothing is stated.
/// @param residual  um or um/m, canonical order
[[nodiscard]] std::optional<StatedUncertainty> stated_uncertainty(const Observations& data,
                                                                  std::span<const double> residual, double noise_um);
/// The same as a sentence; "" for nothing. @param unit  of the readings
[[nodiscard]] std::string words_for(const std::optional<StatedUncertainty>& stated, std::string_view unit);

/// Gives columns that a smooth machine could produce (readings × columns); they are made when they are asked for first,
/// for where readings are repeated nobody does.
using SmoothColumns = std::function<const Eigen::MatrixXd&()>;

/// White and correlated part of each group, from repeats where at least half the readings have them, else from what
/// smooth columns leave.
/// @param residual  readings less what the model says so far, um or um/m, canonical order
/// @param smooth    used where there are no repeats
/// @param left_out  outliers
/// @param absorbed  columns fitted to the readings (readings × columns): without repeats the noise in these is gone
/// from
///                  the residual, and counts as not seen
[[nodiscard]] NoiseModel noise_of(const Observations& data, const Eigen::VectorXd& residual,
                                  const SmoothColumns& smooth, const std::vector<bool>& left_out,
                                  const Eigen::MatrixXd& absorbed = {});
[[nodiscard]] NoiseModel noise_of(const Observations& data, const Eigen::VectorXd& residual,
                                  const Eigen::MatrixXd& smooth, const std::vector<bool>& left_out);
/// The same with smooth_columns() (core.hpp).
[[nodiscard]] NoiseModel noise_of(const Observations& data, const Eigen::VectorXd& residual,
                                  const std::vector<bool>& left_out, const Eigen::MatrixXd& absorbed = {});

/// Whether what is taken for noise wanders: in some group it is more than three times what neighbouring readings of a
/// pass scatter, and it is correlated over more than a minute, or nothing says over what time.
[[nodiscard]] bool wanders(const Observations& data, const NoiseModel& noise, const Eigen::VectorXd& residual,
                           const std::vector<bool>& left_out);

/// Draws data sets of noise alone, each of one shape that the data leave possible, chosen by its weight; the same ones
/// for the same data. The references must outlive it.
class SimulatedNoise {
 public:
  /// @param seed  any number: the same one gives the same data sets
  SimulatedNoise(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                 std::uint64_t seed = 7);
  /// The next ones (readings × count); rows left out are 0.
  [[nodiscard]] Eigen::MatrixXd next(std::size_t count);

 private:
  const Observations& data_;
  const NoiseModel& noise_;
  const std::vector<bool>& left_out_;
  std::vector<std::size_t> pass_;
  std::mt19937_64 random_;
  NormalDraws normal_;
  WeightedDraws any_;
  ChiSquaredDraws spread_;
};

/// The same noise everywhere, independent: ordinary least squares.
[[nodiscard]] NoiseModel plain_noise(const Observations& data, double sigma_um);

/// Makes the noise white with standard deviation 1; rows left out become 0. A linear map, O(rows) per column.
class Whitener {
 public:
  Whitener(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out);
  [[nodiscard]] Eigen::MatrixXd operator()(const Eigen::MatrixXd& columns) const;
  [[nodiscard]] Eigen::VectorXd operator()(const Eigen::VectorXd& column) const;
  /// The transposed map: products with whitened columns become products with the columns as they are.
  [[nodiscard]] Eigen::MatrixXd transposed(const Eigen::MatrixXd& white) const;
  /// Whether no reading tells of another one: each is scaled alone.
  [[nodiscard]] bool is_white() const;
  /// ln of the determinant of the covariance, rows left out apart.
  [[nodiscard]] double ln_determinant() const;

 private:
  struct Step {
    std::size_t row = 0;
    double memory = 0.0;  ///< of the correlated part since the step before
    double gain = 0.0;
    double scale = 0.0;  ///< 1/standard deviation of the innovation; 0: left out
    double share = 1.0;  ///< 1/relative size of the noise of this reading
  };
  std::vector<Step> steps_;  ///< group after group; memory 0 at the start of each
  /// So many columns of this many rows, one behind the other.
  template <int kColumns>
  void apply(const double* from, double* to, Eigen::Index rows) const;
  template <int kColumns>
  void apply_transposed(const double* from, double* to, Eigen::Index rows) const;
};

/// Mean of squares without those beyond twenty times the variance that their median shows; 0 for none.
[[nodiscard]] double robust_mean_square(const std::vector<double>& squares);

/// Shapes of noise on a grid with their likelihoods (restricted maximum likelihood over all passes together).
/// @param deviation    per reading, kNotMeasured where there is none
/// @param information  independent deviations per deviation
[[nodiscard]] std::vector<NoiseShape> likely_shapes(const Observations& data, const std::vector<NoiseGroup>& groups,
                                                    const std::vector<double>& deviation, double information);

/// One flag per reading, canonical order; none is set below 12 readings, nor where three follow each other in a pass,
/// and in a sense at most one in twenty: of more only the oddest that stand apart from the rest. Source: outliers.cpp.
/// @param residual  readings less what the model says, um or um/m
[[nodiscard]] std::vector<bool> isolated_outliers(const Observations& data, const Eigen::VectorXd& residual);

/// Readings of unknown approach in a run whose other readings, four fifths or more, have one, as its first reading: an
/// effect of approach acts on them with a sign that nobody knows, so they judge none.
[[nodiscard]] std::vector<bool> of_unknown_approach(const Observations& data);
/// Readings without the temperature of a sensor that two thirds or more of those of their channel along their axis
/// have: what follows that sensor cannot be computed for them.
[[nodiscard]] std::vector<bool> without_sensor(const Observations& data);
/// All other readings: those that a diagnosis, and a check of it, use.
[[nodiscard]] Observations with_sensors(const Observations& data);
/// Readings of unknown approach and without a temperature, which no fit uses.
[[nodiscard]] std::vector<bool> rows_unusable(const Observations& data);
/// How many lack a temperature; nothing where none does.
[[nodiscard]] std::optional<std::string> note_of_missing_sensors(const Observations& data);

/// Outliers, and those that are unusable.
[[nodiscard]] std::vector<bool> rows_left_out(const Observations& data, const Eigen::VectorXd& residual);

}  // namespace ecs::model
