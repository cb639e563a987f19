// Fitting chosen constants of a servo axis to a recorded step: each as a factor on its value, by Gauss-Newton on the
// logarithms, beside the time of the trigger and the recorder's zero. Internal to this module (Eigen).
// Does not live here: which constants to try (diagnosis.hpp).
#pragma once

#include <map>
#include <vector>

#include <Eigen/Core>

#include "modules/traces/trace.hpp"

namespace ecs::model {

/// The axis as it would have to be, and how far the recording is from it.
struct DriveFit {
  std::map<DriveConstant, double> ln_factor;  ///< of the fitted constants
  std::map<DriveConstant, double> ln_sigma;   ///< standard deviation: what is left over, and whole pulses
  DriveParameters drive;                      ///< with them
  double start_s = 0.0;                       ///< of the move, on the recorder's clock
  Eigen::VectorXd zero;                       ///< of the recorder, per signal
  double cost = 0.0;                          ///< Σ of Huber's loss of residual/noise
  bool possible = false;                      ///< false: the loop is unstable
};

class DriveFitter {
 public:
  explicit DriveFitter(const DriveTrace& trace);

  /// No constant is changed, only the start of the move and the recorder's zero are found.
  [[nodiscard]] DriveFit aligned(const DriveParameters& drive) const;
  /// From `start` onward with these constants free.
  [[nodiscard]] DriveFit fitted(const DriveFit& start, const std::vector<DriveConstant>& free) const;
  /// The best factor for one constant, wherever it is between 1/100 and 100.
  [[nodiscard]] DriveFit best_factor(const DriveFit& start, DriveConstant constant) const;

  /// Change of every sample (all signals, in units of their noise) per unit of ln of each constant, what a shift of the
  /// start or of a zero can make taken out. (samples × constants)
  [[nodiscard]] Eigen::MatrixXd sensitivities(const DriveFit& at) const;

  /// Simulated samples of one signal of the recording, zero included.
  [[nodiscard]] std::vector<double> predicted(const DriveFit& at, std::size_t signal) const;
  /// √mean square of what is left of one signal, in its unit; clipped samples count by what they contradict.
  /// @param without_glitches  leave out samples (at most 1 %) beyond 8 times the noise
  [[nodiscard]] double rms(const DriveFit& at, std::size_t signal, bool without_glitches = false) const;
  /// How long to simulate so that every sample is reached [s].
  [[nodiscard]] double duration_s() const { return duration_s_; }
  [[nodiscard]] double step_s() const { return step_s_; }
  [[nodiscard]] DriveResponse response(const DriveParameters& drive) const;

 private:
  struct Descent;
  [[nodiscard]] Eigen::VectorXd residuals(const DriveResponse& response, double start_s,
                                          const Eigen::VectorXd& zero) const;
  [[nodiscard]] double difference(std::size_t signal, std::size_t sample, double simulated) const;
  [[nodiscard]] double best_start(const DriveResponse& response) const;
  [[nodiscard]] double prior_of_zero(std::size_t signal) const;

  const DriveTrace& trace_;
  double duration_s_ = 0.0;
  double step_s_ = 0.0;
  double earliest_s_ = 0.0, latest_s_ = 0.0;  ///< between which the move began
};

}  // namespace ecs::model
