// Readings yet to be taken as observations beside the present ones, so that effects can be evaluated on both alike.
// Does not live here: which runs to propose (options.hpp).
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "model/data/observations.hpp"
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

}  // namespace ecs::model
