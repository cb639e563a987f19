// Whether what is left depends on anything: position, approach, run, time, sensors, feed, load, compensation.
// Internal to model/ (Eigen). Does not live here: what effect that may be (search.hpp).
#pragma once

#include <string>
#include <vector>

#include <Eigen/Dense>

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
  std::vector<Variable> variables_;
  std::vector<Eigen::MatrixXd> white_;
  double noise_freedom_;
};

/// The tests of what each variable explains beyond the position along the measured line. @param tests  those of
/// `space`, kept where they show nothing
[[nodiscard]] std::vector<StructureTest> tests_beyond_position(const Observations& data, const Whitener& whitener,
                                                               const Structure& structure, const Space& space,
                                                               std::vector<StructureTest> tests);

/// −log10 of the chance that χ² of `freedom` degrees, over a noise known to `noise_freedom`, exceeds `gain`.
[[nodiscard]] double minus_log_p(double gain, double freedom, double noise_freedom);

}  // namespace ecs::model
