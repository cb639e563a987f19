// The level that a score must exceed, from replicates of noise that are searched in the same way.
#pragma once

#include <vector>

#include "model/diagnosis/investigation.hpp"
#include "model/diagnosis/structure.hpp"
#include "model/fit/held_out.hpp"

namespace ecs::model {

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

/// Whether the best effect explains more of what the model leaves than any does of noise of the same size: the ratio of
/// likelihoods where the size of the noise is not known (its logarithm is that of the F test).
[[nodiscard]] bool explains_more_than_of_noise(const Search& search, const Space& space, Replicates& replicates,
                                               const Choice& best, double freedom, const DiagnoseOptions& options);

}  // namespace ecs::model
