// How many sigmas a run not yet made would put between explanations: each, if true, against the best that the model
// with another can do on present and new readings together; and readings yet to be taken as observations beside the
// present ones, so that effects can be evaluated on both alike. Internal to model/ (Eigen).
// Does not live here: which runs there are (questions.hpp), their rank (next_measurement.cpp).
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "model/data/observations.hpp"
#include "model/fit/core.hpp"
#include "model/planning/run.hpp"

namespace ecs::model {

/// The present readings, then those of each proposal (one run of it, twice with a second feed). The new values of
/// `reading` mean nothing.
struct WithProposals {
  Observations data;
  std::size_t present = 0;         ///< the first readings
  std::vector<std::size_t> first;  ///< of each proposal
  std::vector<std::size_t> count;  ///< of each proposal
  /// What each extra column is taken to follow in the new readings: another column of which it is a straight line in
  /// the present ones, "" where it is constant. Of one that is missing here nothing is known: kNotMeasured.
  std::map<std::string, std::string, std::less<>> extras_follow;
};
/// The present readings alone.
[[nodiscard]] Observations present_of(const WithProposals& all);
[[nodiscard]] WithProposals with_proposals(const Observations& present,
                                           const std::vector<MeasurementProposal>& proposals);

/// One thing that may be true, over present and new readings.
struct Explanation {
  std::string name;
  Eigen::MatrixXd columns;  ///< what its refit may use
  Eigen::VectorXd fixed;    ///< part of it that no coefficient scales
  Eigen::VectorXd truth;    ///< its contribution at the sizes that the present readings give
};

/// What is believed whatever is true: the model, fitted to the present readings.
struct Belief {
  Eigen::MatrixXd columns;  ///< over present and new readings; slopes of nonlinear parameters included
  Eigen::VectorXd target;   ///< present readings less what the model holds
  NoiseModel noise;         ///< of the present readings
  std::vector<bool> left_out;
};

/// The model with the effects `known` fitted, and noise taken with the effects `likely` added to it.
[[nodiscard]] Result<Belief> belief_of(const Model& model, const std::vector<EffectInstance>& known,
                                       const std::vector<EffectInstance>& likely, const Observations& present,
                                       const Regressors& all);

/// An effect at the size that the present readings give it beside the belief.
[[nodiscard]] Explanation explained_by(const std::string& name, const EffectInstance& effect, const Belief& belief,
                                       const WithProposals& all, const Regressors& regressors);

/// Separations by each proposal.
class Separations {
 public:
  /// @param zero_matters  explanations differ where the readout was zeroed: a new zero then tells nothing
  Separations(const WithProposals& all, const std::vector<MeasurementProposal>& proposals, const Belief& belief,
              const std::vector<Explanation>& explanations, bool zero_matters);

  /// [i][j]: explanation i true, j refitted; the last column: the model alone. What `runs` runs of the proposal add to
  /// what the present readings say.
  /// @param between  from each other; else the last column alone, 0 in the others
  [[nodiscard]] Eigen::MatrixXd of(std::size_t proposal, int runs, bool between = true) const;

 private:
  [[nodiscard]] Eigen::MatrixXd squares(const Eigen::MatrixXd& rows, bool own_zero, bool between) const;

  const WithProposals& all_;
  const std::vector<MeasurementProposal>& proposals_;
  bool zero_matters_ = false;
  Eigen::Index base_ = 0;                    ///< columns of the belief
  std::vector<Eigen::Index> first_, count_;  ///< columns of each explanation, then fixed and truth
  Eigen::MatrixXd white_;                    ///< everything, new rows only
  Eigen::MatrixXd present_;                  ///< everything, present rows compressed to a triangle
  Eigen::MatrixXd present_squares_;          ///< separations so far, squared
  std::vector<double> sigma_;                ///< of one reading of each proposal
};

}  // namespace ecs::model
