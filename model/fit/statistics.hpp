// Tail probabilities that the tests of this room need.
#pragma once

#include <vector>

namespace ecs::model {

/// ln of the chance that a χ² variable of k degrees of freedom exceeds x.
[[nodiscard]] double ln_chi2_tail(double x, double k);
/// ln of the chance that F(k, v) exceeds f.
[[nodiscard]] double ln_f_tail(double f, double k, double v);
/// Two-sided chance of a normal variable beyond ±z.
[[nodiscard]] double normal_two_sided(double z);

/// Chance that a blank reaches `value`: the share of blanks that do, and beyond them an exponential tail fitted to the
/// upper fifth of them.
[[nodiscard]] double tail_probability(std::vector<double> blanks, double value);

/// Clopper-Pearson interval of a share.
struct Interval {
  double low = 0.0;
  double high = 1.0;
};
[[nodiscard]] Interval clopper_pearson(unsigned hits, unsigned trials, double confidence = 0.95);

/// √(mean of squares); 0 for none.
[[nodiscard]] double rms_of(const std::vector<double>& values);

}  // namespace ecs::model
