// What does not repeat, as lengths see it: noise of each reading, scatter of every component at a stop, and a shape of
// every pass of an axis. Translations and angles scatter alike, and act through the levers of the carriage that moves;
// an axis that is parked keeps the scatter of its last stop. Does not live here: how large it is (noise_fit.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model/lengths/curves.hpp"
#include "model/lengths/length_test.hpp"

namespace ecs::model {

enum class Scatter : std::uint8_t {
  reading,     ///< of each reading by itself [um]
  stop,        ///< of each translation of each axis at a stop [um]
  stop_angle,  ///< of each angle of each axis at a stop [um/m]
  pass,        ///< shape of each translation of each axis in a pass [um]
  pass_angle,  ///< shape of each angle of each axis in a pass [um/m]
};
inline constexpr std::size_t kScatters = 5;
/// um², of angles (um/m)²
using ScatterVariances = std::array<double, kScatters>;
[[nodiscard]] constexpr std::size_t index_of(Scatter scatter) { return static_cast<std::size_t>(scatter); }

/// The covariance of readings, block by block: readings of different blocks share nothing.
class SharedNoise {
 public:
  /// @param direction  of each reading, a row each
  SharedNoise(const LengthTest& test, const MachineCurves& curves, const Eigen::MatrixXd& direction);

  struct Block {
    std::vector<Eigen::Index> readings;                     ///< in the order in which they were taken
    std::array<Eigen::MatrixXd, kScatters - 1> covariance;  ///< of unit variance of each scatter but that of a reading
  };
  [[nodiscard]] const std::vector<Block>& blocks() const { return blocks_; }
  [[nodiscard]] static Eigen::MatrixXd covariance_of(const Block& block, const ScatterVariances& variances);
  /// Rows multiplied by the inverse Cholesky factor of their covariance.
  [[nodiscard]] Eigen::MatrixXd whitened(const Eigen::MatrixXd& rows, const ScatterVariances& variances) const;
  /// Of a single reading: all scatter together, mean over the readings.
  [[nodiscard]] double mean_variance(const ScatterVariances& variances) const;

 private:
  std::vector<Block> blocks_;
};

/// The rows of some readings, in their order.
[[nodiscard]] Eigen::MatrixXd rows_of(const Eigen::MatrixXd& all, const std::vector<Eigen::Index>& readings);

}  // namespace ecs::model
