// Effects of position against errors of single targets: on few targets, curves, waves and steps together follow any
// values. Internal to model/ (Eigen).
#pragma once

#include "model/diagnosis/investigation.hpp"

namespace ecs::model {

/// Effects of position along one line are denied where the evidence for errors of single targets, each of its own, is
/// three times that for them together, and in doubt (Alias::single_targets) where they are not a hundred times better.
/// A smooth curve is held to be smooth: neighbours are alike. Each other effect needs fewer coefficients than there are
/// targets, and pays for the choice of its position or period. Not for paths, readings of a ball, and lines of more
/// than 60 targets.
void hold_against_single_targets(const Observations& data, const Search& search, const Whitener& whitener,
                                 Found& found);

}  // namespace ecs::model
